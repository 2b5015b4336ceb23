//! Similar meshes of a body, each finer than the one before.
//!
//! A body of sections is cut into whole multiples of its cells. A mesh from elsewhere is subdivided: each panel becomes four in its own
//! plane, so that the meshes converge to the polyhedron that was given.

use froude_mesh::measure::Measure;
use froude_mesh::refine::subdivided;
use froude_mesh::robot::ModularRobot;
use froude_mesh::sections::{Resolution, SectionBody, SectionError};
use froude_mesh::{Mesh, sections::PartMesh};
use froude_records::body::Shape;

/// Multiples of the coarsest cells that are tried one after the other.
const MULTIPLES: [usize; 10] = [2, 3, 4, 6, 8, 12, 16, 24, 32, 48];
/// Panels around in a multiple of one: with the cells below they are as long as wide; twice as many where the section is flatter than
/// this, or the uncertainty does not hold (`froude_panel::convergence`).
const AROUND: usize = 8;
const FLAT: f64 = 2.0;
/// Subdivisions of a mesh from elsewhere that are tried.
const SUBDIVISIONS: usize = 8;

/// A body that can be meshed as finely as one likes.
#[derive(Debug, Clone, PartialEq)]
pub enum Family {
    /// From its sections.
    Sections {
        /// The body.
        body: SectionBody,
        /// Axes across which it is its own mirror image, panel by panel.
        planes: Vec<usize>,
        /// Number of the first multiple that resolves it.
        first: usize,
        /// Panels around in a multiple of one.
        around: usize,
    },
    /// From a mesh.
    Mesh(Mesh),
}

/// One mesh of a family.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// Panels with their parts.
    pub mesh: PartMesh,
    /// Size of its cells over those of the coarsest.
    pub size: f64,
    /// Whole number that the cells of anything similar are multiplied by.
    pub multiple: usize,
}

impl Family {
    /// Of a shape; a robot with a number of links.
    #[must_use]
    pub fn of(shape: &Shape, links: usize) -> Self {
        let mut first = 0;
        let (body, planes) = match *shape {
            Shape::Robot { .. } => {
                let robot = robot(shape);
                // Two cells on a ramp are too few: the surge of a necked robot is then off by twice its uncertainty.
                first = 1;
                (robot.body(links, robot.pitch_m / 4.0), vec![1, 2])
            }
            Shape::Ellipsoid { semi_axes_m } => {
                let [a, b, c] = semi_axes_m;
                // Half of the meridian's length over the width of a panel around.
                let cells = (a.max(0.5 * (b + c)) / (b * c).sqrt() * 1.5).round().clamp(2.0, 40.0) as usize;
                (SectionBody::ellipsoid(semi_axes_m, cells), vec![0, 1, 2])
            }
            Shape::Capsule { length_m, section, end_m } => {
                let width = core::f64::consts::FRAC_PI_4 * (section.major_m + section.minor_m) / 2.0;
                let middle = 0.5 * length_m - end_m;
                let cells = |length: f64| (length / width).round().clamp(2.0, 60.0) as usize;
                let along = 2 * cells(middle);
                (
                    SectionBody::capsule(middle, section.minor_m, section.major_m, end_m, [cells(1.5 * end_m), along]),
                    vec![0, 1, 2],
                )
            }
            Shape::Cylinder { length_m, section } => {
                let width = core::f64::consts::FRAC_PI_4 * (section.major_m + section.minor_m) / 2.0;
                let along = 2 * (0.5 * length_m / width).round().clamp(2.0, 60.0) as usize;
                let cells = ((section.major_m / width).round() as usize).max(2);
                (
                    SectionBody::flat_cylinder(0.5 * length_m, section.minor_m, section.major_m, [cells, along]),
                    vec![0, 1, 2],
                )
            }
        };
        let around = if flatness(shape) > FLAT { 2 * AROUND } else { AROUND };
        Self::Sections { body, planes, first, around }
    }

    /// Volume of the body that the meshes stand for, m³: from its dimensions, or of the facets, which subdivision keeps.
    #[must_use]
    pub fn volume_m3(&self) -> f64 {
        match self {
            Self::Sections { body, .. } => body.volume_m3(),
            Self::Mesh(mesh) => Measure::of(mesh).volume_m3,
        }
    }

    /// Members from the coarsest on.
    #[must_use]
    pub fn members(&self) -> usize {
        match self {
            Self::Sections { first, .. } => MULTIPLES.len() - first,
            Self::Mesh(_) => SUBDIVISIONS + 1,
        }
    }

    /// Panels of a member, without making it.
    ///
    /// # Errors
    ///
    /// As [`Family::member`].
    pub fn panels(&self, number: usize) -> Result<usize, SectionError> {
        match self {
            Self::Sections { first, .. } => {
                let coarsest = self.member(0)?.mesh.mesh.panels.len();
                Ok(coarsest * MULTIPLES[first + number].pow(2) / MULTIPLES[*first].pow(2))
            }
            Self::Mesh(mesh) => Ok(mesh.panels.len() << (2 * number)),
        }
    }

    /// A member.
    ///
    /// # Errors
    ///
    /// [`SectionError`] where the dimensions give no body.
    pub fn member(&self, number: usize) -> Result<Member, SectionError> {
        match self {
            Self::Sections { body, first, around, .. } => {
                let along = MULTIPLES[first + number];
                let mesh = body.mesh(Resolution { along, around: around * along })?;
                Ok(Member { mesh, size: MULTIPLES[*first] as f64 / along as f64, multiple: along })
            }
            Self::Mesh(mesh) => {
                let finer = (0..number).fold(mesh.clone(), |m, _| subdivided(&m));
                let parts = vec![0; finer.panels.len()];
                Ok(Member {
                    mesh: PartMesh { mesh: finer, parts },
                    size: 0.5_f64.powi(number as i32),
                    multiple: 2 << number,
                })
            }
        }
    }
}

/// Height over width of the section, or the other way round.
fn flatness(shape: &Shape) -> f64 {
    let (major, minor) = match *shape {
        Shape::Robot { section, .. } | Shape::Capsule { section, .. } | Shape::Cylinder { section, .. } => {
            (section.major_m, section.minor_m)
        }
        Shape::Ellipsoid { semi_axes_m: [_, b, c] } => (b, c),
    };
    (major / minor).max(minor / major)
}

/// The robot of a shape; any other shape has none.
#[must_use]
pub fn robot(shape: &Shape) -> ModularRobot {
    let Shape::Robot { section, pitch_m, joint, end_m } = *shape else { return ModularRobot::NECKED_MAMBA };
    ModularRobot {
        half_height_m: section.major_m,
        half_width_m: section.minor_m,
        pitch_m,
        neck_m: joint.map_or(0.0, |j| j.length_m),
        neck_scale: joint.map_or(1.0, |j| j.scale),
        ramp_m: joint.map_or(0.0, |j| j.ramp_m),
        end_m,
    }
}
