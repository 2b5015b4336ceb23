//! Bodies as their computations need them: shape, lengths, and the O-grid about them.

use froude_mesh::panel::{Facet, facets};
use froude_mesh::sections::{Resolution, SectionBody};
use froude_mesh::{Mesh, robot};
use froude_records::body::{BodyFile, SemiAxes, Shape};
use froude_records::cfd::{CfdSpec, MeshSpec};
use froude_records::table::links_of_configuration;

use crate::case::Reference;
use crate::o_grid::OGrid;

/// Radius of a domain over the body's length, and over its width, where the campaign does not say: the larger.
const RADIUS: [f64; 2] = [3.0, 25.0];
/// Panels around a body whose plan area is measured.
const FINE: Resolution = Resolution { along: 4, around: 64 };
/// Cells along a link, for the same.
const CELLS_PER_LINK: f64 = 16.0;

/// A configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaped {
    /// `HkLT`; empty where the body has only one.
    pub configuration: String,
    /// Its shape.
    pub body: SectionBody,
    /// Lengths, its middle as the reference point.
    pub reference: Reference,
}

impl Shaped {
    /// The grid about it that a campaign asks for.
    #[must_use]
    pub fn grid(&self, spec: &CfdSpec) -> OGrid {
        self.grid_of(spec, spec.mesh)
    }

    /// The same with the cells of another mesh.
    #[must_use]
    pub fn grid_of(&self, spec: &CfdSpec, mesh: MeshSpec) -> OGrid {
        OGrid {
            stations: mesh.stations,
            layers: mesh.layers,
            around: if spec.is_half { mesh.azimuth } else { 2 * mesh.azimuth },
            first_layer_m: mesh.first_layer_m,
            outer_radius_m: domain_radius(spec, self.reference) * self.reference.length_m,
            is_half: spec.is_half,
        }
    }
}

/// Radius of the domain that a campaign asks for, in lengths of the body \[-\].
#[must_use]
pub fn domain_radius(spec: &CfdSpec, Reference { length_m, width_m, .. }: Reference) -> f64 {
    spec.radius.unwrap_or(RADIUS[0].max(RADIUS[1] * width_m / length_m))
}

/// A configuration of the body of a file.
///
/// # Errors
///
/// Why it is none, in words.
pub fn shaped(file: &BodyFile, configuration: &str) -> Result<Shaped, String> {
    let body = match (&file.shape, links_of_configuration(configuration)) {
        (Shape::Robot(robot), Some(links)) => {
            robot::sections(robot, links as usize, 2.0 * robot.link.half_length_m / CELLS_PER_LINK)
        }
        (Shape::Robot(_), None) => {
            let problem = format!(
                "is a robot, whose configurations are called HkLT for k links, and the plan names {configuration:?}; write configurations = [\"H1LT\"], for example"
            );
            return Err(problem);
        }
        (Shape::Ellipsoid { semi_axes_m }, _) => SectionBody::ellipsoid(*semi_axes_m, 32),
        (Shape::Capsule { length_m, section: SemiAxes { major_m, minor_m }, end_m }, _) => {
            SectionBody::capsule(0.5 * length_m - end_m, *minor_m, *major_m, *end_m, [32, 16])
        }
        (Shape::Cylinder { .. }, _) => {
            let problem =
                "has flat ends, whose edges an O-grid cannot follow; give it ends of a length: shape = \"capsule\""
                    .to_owned();
            return Err(problem);
        }
    };
    let mesh = body.mesh(FINE).map_err(|e| e.to_string())?.mesh;
    Ok(Shaped { configuration: configuration.to_owned(), reference: reference(&mesh), body })
}

/// Length along x, largest width across it, and the area of the side view, of a closed mesh.
fn reference(mesh: &Mesh) -> Reference {
    let extent = |k: usize| {
        let ends = mesh
            .vertices
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v[k]), high.max(v[k])]);
        ends[1] - ends[0]
    };
    // What looks to starboard, as a shadow on the xz plane.
    let shadow = |facet: &Facet| (facet.area * facet.normal[1]).max(0.0);
    Reference {
        length_m: extent(0),
        width_m: extent(1),
        area_m2: facets(mesh).iter().map(shadow).sum(),
        point_m: [0.0; 3],
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;
    use std::path::Path;

    use froude_records::body::parse_body;

    use super::*;

    #[test]
    fn a_capsule_refers_to_its_length_its_width_and_the_side_that_it_shows() {
        let text = "schema = 1\n[body]\nshape = \"capsule\"\nlength = \"1 m\"\nmajor_semi_axis = \"45 mm\"\nminor_semi_axis = \"30 mm\"\nends = { length = \"45 mm\" }\n";
        let body = parse_body(Path::new("body.toml"), text).unwrap();
        let found = shaped(&body, "").unwrap();
        // 25 widths are less than three lengths.
        assert!((found.grid(&CfdSpec::default()).outer_radius_m - 3.0).abs() < 1e-12);
        let found = found.reference;
        let side = 0.91 * 0.09 + PI * 0.045 * 0.045;
        assert!((found.length_m - 1.0).abs() < 1e-12 && (found.width_m - 0.06).abs() < 1e-12, "{found:?}");
        // Polygons within the curves.
        assert!((found.area_m2 / side - 1.0).abs() < 2e-3, "{found:?} {side}");
    }
}
