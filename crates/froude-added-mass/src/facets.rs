//! The faceting error of a mesh.

use froude_mesh::refine::{rounded, without_warp};
use froude_mesh::{Mesh, Vec3};
use froude_panel::mirror::{Kind, Mirror};
use froude_panel::problem::{Frame, Problem};
use froude_panel::refine::{Wanted, forecast, memory_bytes};
use froude_records::number;
use froude_records::page::TextTable;

use super::load::WARP;
use super::record::diagonal_name;
use crate::outcome::Case;

/// Angle between facets from which an edge is an edge of the body, rad: seven segments to a circle still count as round.
const CREASE_RAD: f64 = 50.0 * core::f64::consts::PI / 180.0;

/// The faceting error of a mesh: its difference from the smooth body that the facets approximate; otherwise why it is not stated.
pub(super) fn geometry(
    mesh: &Mesh,
    case: &Case,
    wanted: &Wanted,
    frame: &Frame,
    density_kg_m3: f64,
) -> Result<TextTable, &'static str> {
    // The mesh divided once is the second of the family.
    let flat = case.refined.steps.get(1).ok_or("panels or memory do not allow a second mesh")?.added_mass.matrix;
    let round = without_warp(&rounded(mesh, CREASE_RAD), WARP);
    let mirrors: &[Mirror] = &case.refined.finest.mirrors;
    let is_through = |m: &Mirror| {
        let side = |v: &Vec3| v[m.axis] > m.at_m;
        m.kind != Kind::Body && round.vertices.iter().any(|v| side(v) != side(&mesh.vertices[0]))
    };
    if mirrors.iter().any(is_through) {
        return Err("rounded, the body would pierce the water's surface");
    }
    let problem = Problem::rigid(&round, mirrors);
    if problem.facets.len() > wanted.most_panels || forecast(&problem).memory_bytes > memory_bytes(wanted) {
        return Err("panels or memory do not allow the rounded mesh");
    }
    let round = froude_panel::solve(&problem).added_mass(0).seen_from(frame).matrix;
    let rows = (0..6)
        .map(|i| {
            // Rounding once takes three quarters of the distance to the smooth body away.
            let value = case.refined.value[i][i];
            // Less than nothing is not left of an entry.
            let apart = (4.0 / 3.0 * (round[i][i] - flat[i][i])).max(-value);
            vec![
                diagonal_name(i),
                number::plain(density_kg_m3 * value, 6),
                percent_of(case.refined.uncertainty[i][i], value).replace('+', ""),
                percent_of(apart, value),
            ]
        })
        .collect();
    Ok(TextTable {
        caption: format!(
            "Two separate uncertainties: the discretisation error of the panels (for the polyhedron as given), and the faceting error, the difference to a \
             smooth body with the same corners, should the facets approximate one. Edges of more than {:.0}° count as edges of the body.",
            CREASE_RAD.to_degrees()
        ),
        head: ["", "value [kg, kg m²]", "numerical uncertainty", "smooth body minus polyhedron"]
            .map(str::to_owned)
            .to_vec(),
        rows,
    })
}

fn percent_of(part: f64, whole: f64) -> String {
    if whole.abs() > 0.0 && part.is_finite() {
        format!("{:+.2} %", 100.0 * part / whole.abs())
    } else {
        "–".to_owned()
    }
}
