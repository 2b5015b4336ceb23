//! The pressure on the surface of a body, face by face.
//!
//! **Definition.** C_p = (p − p∞)/(½ρU²). Far away p is 0, and OpenFOAM's p is over the density, so that C_p = 2p/U². At a wall its gradient is 0: a face has the pressure of its cell.

use froude_mesh::vector::{Vec3, add, scale};

use crate::case::Case;
use crate::flow_field::FlowField;
use crate::quality::face;

/// A face of the surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Facet {
    /// Its corners, counter-clockwise seen from inside the body, m.
    pub corners_m: Vec<Vec3>,
    /// Area vector, into the body, m².
    pub area_m2: Vec3,
    /// C_p \[-\].
    pub pressure_coefficient: f64,
}

impl Facet {
    /// Its image in the plane z = 0.
    fn mirrored(&self) -> Self {
        let image = |[x, y, z]: Vec3| [x, y, 0.0 - z];
        Self {
            corners_m: self.corners_m.iter().rev().map(|corner| image(*corner)).collect(),
            area_m2: image(self.area_m2),
            pressure_coefficient: self.pressure_coefficient,
        }
    }
}

/// The faces of a body's whole surface; of a half domain the other half is the image of the first.
#[must_use]
pub fn facets(case: &Case, field: &FlowField) -> Vec<Facet> {
    let mesh = &field.mesh;
    let walls = mesh.patches.iter().filter(|patch| patch.is_wall());
    let mut facets: Vec<Facet> = walls
        .flat_map(|wall| wall.start..wall.start + wall.count)
        .map(|index| {
            let corners = &mesh.faces[index];
            let pressure_m2_s2 = field.pressure_m2_s2[mesh.owner[index] as usize];
            Facet {
                corners_m: corners.iter().map(|corner| mesh.points_m[*corner as usize]).collect(),
                area_m2: face(mesh, corners).1,
                pressure_coefficient: 2.0 * pressure_m2_s2 / case.flow.speed_m_s.powi(2),
            }
        })
        .collect();
    if case.is_half {
        facets.extend(facets.iter().map(Facet::mirrored).collect::<Vec<_>>());
    }
    facets
}

/// Force of the pressure on the body, ½ρU² Σ C_p S with S the area vectors into it, body axes, N.
#[must_use]
pub fn pressure_force_n(case: &Case, facets: &[Facet]) -> Vec3 {
    let head_pa = 0.5 * case.water.density_kg_m3 * case.flow.speed_m_s.powi(2);
    let sum = facets.iter().fold([0.0; 3], |sum, f| add(sum, scale(f.area_m2, f.pressure_coefficient)));
    scale(sum, head_pa)
}
