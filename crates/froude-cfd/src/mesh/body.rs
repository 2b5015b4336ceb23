//! Bodies as their computations need them: shape, lengths, and the O-grid or the cubes about them.

use crate::section::{CfdSpec, CubeSpec, MeshSpec, Mesher};
use froude_added_mass::body_file::{BodyFile, Shape};
use froude_mesh::measure::Measure;
use froude_mesh::sections::{Resolution, SectionBody};
use froude_mesh::vector::Vec3;
use froude_mesh::{Mesh, robot};
use froude_records::body::SemiAxes;
use froude_records::table::links_of_configuration;

use crate::case::Reference;
use crate::o_grid::OGrid;
use crate::snappy::{Sides, Snappy};
use crate::surface::{bounds_m, reference};

/// Radius of a domain over the body's length, and over its width, where the campaign does not say: the larger.
const RADIUS: [f64; 2] = [3.0, 25.0];
/// Edge of the cubes on a surface over that of the O-grid's cells there \[-\]: with the same edge half of the layers on a slender hull are rejected.
const CUBE: f64 = 0.5;
/// First layer over the edge of the cubes, at least \[-\]. On a SUBOFF hull at 3 m/s the flow diverges within 25 iterations with cells of 1/60; with these its drag is 89.0 N (measured 87.4 N).
const FLATTEST: f64 = 0.053;
/// Height of the last layer over the edge of the cubes \[-\]: all layers together are then some 0.65 of a cube thick at a growth of 1.3. Thicker stacks (0.5, twice a cube) leave fewer faces with all layers.
const LAST_LAYER: f64 = 0.15;
/// Far cubes from the middle of a box to its sides, at least; across a tank.
const FAR_CUBES: [f64; 2] = [4.0, 3.0];
/// Panels around a body whose plan area is measured, and that cubes are cut by.
const FINE: Resolution = Resolution { along: 4, around: 64 };
/// Cells along a link, for the same.
const CELLS_PER_LINK: f64 = 16.0;

/// A configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaped {
    /// `HkLT`; empty where the body has only one.
    pub configuration: String,
    /// Its sections, where an O-grid may go around them; `None` of a surface mesh and of flat ends.
    pub sections: Option<SectionBody>,
    /// Its surface in body axes.
    pub surface: Mesh,
    /// What was left out or changed in reading the surface, a sentence each.
    pub notes: Vec<String>,
    /// Lengths, and the point that moments are about: the origin of a body of sections.
    pub reference: Reference,
}

impl Shaped {
    /// A surface mesh in body axes, with its centre of buoyancy as the reference point.
    #[must_use]
    pub fn of_surface(configuration: &str, surface: Mesh) -> Self {
        let centre_m = Measure::of(&surface).centroid_m;
        let reference = reference(&surface, centre_m);
        Self { configuration: configuration.to_owned(), sections: None, surface, notes: Vec::new(), reference }
    }

    /// The cubes about it that a campaign asks for; `angle_rad` is that of the velocity, which a tank lies along.
    ///
    /// Where the campaign names an O-grid, cells on the surface have half the edge of its cells, and layers grow by 1.3 from its first one, or a thicker one, until `LAST_LAYER` of the edge.
    #[must_use]
    pub fn cubes(&self, spec: &CfdSpec, angle_rad: f64) -> Snappy {
        let cubes = match spec.mesher {
            Mesher::Cubes(cubes) => cubes,
            Mesher::ByBody | Mesher::OGrid => {
                let area_m2 = 0.5 * Measure::of(&self.surface).area_m2;
                let surface_cell_m = CUBE * (area_m2 / (spec.mesh.stations * spec.mesh.azimuth) as f64).sqrt();
                CubeSpec {
                    surface_cell_m,
                    first_layer_m: spec.mesh.first_layer_m.max(FLATTEST * surface_cell_m),
                    layers: None,
                    growth: CubeSpec::GROWTH,
                }
            }
        };
        let CubeSpec { surface_cell_m, first_layer_m, growth, .. } = cubes;
        let layers = cubes.layers.unwrap_or_else(|| {
            let ratio = LAST_LAYER * surface_cell_m / first_layer_m;
            1 + (ratio.ln() / growth.max(1.01).ln()).max(0.0).round() as usize
        });
        let radius_m = domain_radius(spec, self.reference) * self.reference.length_m;
        let turn_rad = if spec.tank.is_some() { angle_rad } else { 0.0 };
        let (sin, cos) = turn_rad.sin_cos();
        let [low, high] = bounds_m(&self.surface.mapped(|[x, y, z]| [cos * x - sin * y, sin * x + cos * y, z]));
        let middle: Vec3 = core::array::from_fn(|k| 0.5 * (low[k] + high[k]));
        let [mut from, mut to] = [-radius_m, radius_m].map(|r| middle.map(|m| m + r));
        let mut far_m = radius_m / FAR_CUBES[0];
        if let Some(tank) = spec.tank {
            (from[1], to[1]) = (-0.5 * tank.width_m, 0.5 * tank.width_m);
            (from[2], to[2]) = (-tank.submergence_m, tank.depth_m - tank.submergence_m);
            far_m = far_m.min(tank.width_m.min(tank.depth_m) / FAR_CUBES[1]);
        }
        if spec.is_half {
            from[2] = 0.0;
            far_m = far_m.min(to[2] / 2.0);
        }
        let levels = (far_m / surface_cell_m).log2().floor().max(1.0) as usize;
        let sides = if spec.tank.is_some() { Sides::Tank } else { Sides::Open };
        Snappy {
            surface_cell_m,
            levels,
            layers,
            first_layer_m,
            growth,
            box_m: [from, to],
            sides,
            turn_rad,
            is_half: spec.is_half,
        }
    }

    /// The O-grid about it that a campaign asks for.
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
        (Shape::Cylinder { length_m, section: SemiAxes { major_m, minor_m } }, _) => {
            SectionBody::flat_cylinder(0.5 * length_m, *minor_m, *major_m, [16, 32])
        }
    };
    let surface = body.mesh(FINE).map_err(|e| e.to_string())?.mesh;
    let reference = reference(&surface, [0.0; 3]);
    // No O-grid follows the edges of flat ends.
    let sections = Some(body).filter(|_| !matches!(file.shape, Shape::Cylinder { .. }));
    Ok(Shaped { configuration: configuration.to_owned(), sections, surface, notes: Vec::new(), reference })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;
    use std::path::Path;

    use froude_added_mass::body_file::parse_body;

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
