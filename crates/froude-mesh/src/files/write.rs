//! Writers for repaired and generated meshes: binary STL and OBJ.

use crate::mesh::Mesh;
use crate::panel::halves;
use crate::vector::{cross, norm, scale, sub};

/// Binary STL: triangles with their normals, coordinates rounded to `f32`; a quadrilateral is two triangles over its shorter diagonal.
///
/// The rounding is at most 6e-8 of a coordinate; [`write_obj`] keeps every bit and the quadrilaterals.
#[must_use]
pub fn write_stl_binary(mesh: &Mesh) -> Vec<u8> {
    let triangles: Vec<_> = mesh.panels.iter().flat_map(|panel| halves(mesh, *panel)).collect();
    let mut out = vec![b' '; 80];
    let title = b"Froude, binary STL";
    out[..title.len()].copy_from_slice(title);
    out.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        let [a, b, c] = corners.map(|v| mesh.vertices[v as usize]);
        let twice = cross(sub(b, a), sub(c, a));
        let normal = if norm(twice) > 0.0 { scale(twice, 1.0 / norm(twice)) } else { [0.0; 3] };
        for x in [normal, a, b, c].into_iter().flatten() {
            out.extend((x as f32).to_le_bytes());
        }
        out.extend([0, 0]);
    }
    out
}

/// Wavefront OBJ; every coordinate reads back to the same bits.
#[must_use]
pub fn write_obj(mesh: &Mesh) -> String {
    let mut out = String::new();
    for [x, y, z] in &mesh.vertices {
        out.push_str(&format!("v {x:?} {y:?} {z:?}\n"));
    }
    for panel in &mesh.panels {
        out.push('f');
        for corner in panel.corners() {
            out.push_str(&format!(" {}", u64::from(*corner) + 1));
        }
        out.push('\n');
    }
    out
}
