//! The pressure on the body, for a viewer.

use froude_mesh::Mesh;
use froude_mesh::files::vtk::vtp;
use froude_panel::mirror::{Kind, Mirror, signs};
use froude_panel::problem::Frame;
use froude_panel::refine::Finest;

use super::record::MOTIONS;

/// Pressure over unit acceleration on the whole body, −ρ φ, for each motion in the frame asked for; the points are those of the mesh.
pub(super) fn pressure(finest: &Finest, density_kg_m3: f64, frame: &Frame) -> String {
    let own: Vec<Mirror> = finest.mirrors.iter().copied().filter(|m| m.kind == Kind::Body).collect();
    // Motions of the mesh's frame, about its origin, from those of the frame asked for.
    let t = Frame::at([0.0; 3]).motions_from(frame);
    let mut whole = Mesh::default();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); 6];
    for set in 0..1_usize << own.len() {
        let mirrored = own.iter().enumerate().filter(|(bit, _)| set >> bit & 1 == 1);
        let part = mirrored.fold(finest.mesh.clone(), |mesh, (_, m)| mesh.mirrored(m.axis));
        whole = whole.with(&part);
        for phi in &finest.solution.potentials {
            let phi: [f64; 6] = core::array::from_fn(|mode| signs(&own, mode)[set] * phi[mode]);
            for (mode, values) in values.iter_mut().enumerate() {
                let there: f64 = phi.iter().zip(&t).map(|(phi, row)| phi * row[mode]).sum();
                values.push(-density_kg_m3 * there);
            }
        }
    }
    let names: Vec<String> = MOTIONS
        .iter()
        .enumerate()
        .map(|(i, m)| format!("pressure {m} [Pa/({}/s^2)]", if i < 3 { "m" } else { "rad" }))
        .collect();
    let scalars: Vec<(&str, &[f64])> = names.iter().map(String::as_str).zip(values.iter().map(Vec::as_slice)).collect();
    vtp(&whole, &scalars)
}
