//! Similar meshes of a body, each finer than the one before.
//!
//! A body of sections is cut into whole multiples of its cells. A mesh from elsewhere is subdivided: each panel becomes four in its own
//! plane, so that the meshes converge to the polyhedron that was given.

use froude_mesh::measure::Measure;
use froude_mesh::refine::subdivided;
use froude_mesh::sections::{Resolution, SectionBody, SectionError};
use froude_mesh::{Mesh, sections::PartMesh};

/// Multiples of the coarsest cells that are tried one after the other.
const MULTIPLES: [usize; 10] = [2, 3, 4, 6, 8, 12, 16, 24, 32, 48];
/// Panels around in a multiple of one.
const AROUND: usize = 8;
/// Height over width of a section, or the other way round, from which there are twice as many: with fewer the uncertainty does not hold
/// ([`crate::convergence`]).
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
    /// Of a body from its sections: its mirror planes, the number of the first multiple that resolves it, and the flatness of its section,
    /// the larger semi-axis over the smaller.
    #[must_use]
    pub fn of_sections(body: SectionBody, planes: Vec<usize>, first: usize, flatness: f64) -> Self {
        let around = if flatness > FLAT { 2 * AROUND } else { AROUND };
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
