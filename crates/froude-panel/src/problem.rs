//! What is solved: panels, mirror planes, and the motions of the parts that they belong to.
//!
//! A part is a rigid piece: the whole body, a link of a chain, a body beside another. Its motions are along and about its own axes through
//! its own point. Panels of no part stand still: the walls of a tank.

use froude_mesh::Mesh;
use froude_mesh::panel::{Facet, facets};

use crate::matrix::AddedMass;
use crate::mirror::{Kind, Mirror, signs};

pub use crate::frame::Frame;

/// Panel of no part.
pub const FIXED: usize = usize::MAX;

/// Panels with what moves and what mirrors.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// Panels on the given side of the mirrors.
    pub facets: Vec<Facet>,
    /// Part of each panel, or [`FIXED`].
    pub parts: Vec<usize>,
    /// Frame of each part; columns are part by part, six motions each.
    pub frames: Vec<Frame>,
    /// Mirror planes.
    pub mirrors: Vec<Mirror>,
    /// Whether rigid walls enclose the fluid altogether: then the potential is known but for a constant, and its mean is set to zero.
    pub is_enclosed: bool,
}

impl Problem {
    /// One rigid body in unbounded fluid or beside mirror planes, about the origin of the mesh frame.
    #[must_use]
    pub fn rigid(mesh: &Mesh, mirrors: &[Mirror]) -> Self {
        Self::of_parts(mesh, &vec![0; mesh.panels.len()], &[Frame::at([0.0; 3])], mirrors)
    }

    /// Several rigid parts; `parts` gives that of each panel, or [`FIXED`].
    #[must_use]
    pub fn of_parts(mesh: &Mesh, parts: &[usize], frames: &[Frame], mirrors: &[Mirror]) -> Self {
        let facets = facets(mesh);
        Self { facets, parts: parts.to_vec(), frames: frames.to_vec(), mirrors: mirrors.to_vec(), is_enclosed: false }
    }

    /// Motions: six a part.
    #[must_use]
    pub fn columns(&self) -> usize {
        6 * self.frames.len()
    }

    /// Normal velocity of a panel in a motion.
    #[must_use]
    pub fn velocity(&self, panel: usize, column: usize) -> f64 {
        let part = column / 6;
        if self.parts[panel] == part {
            self.frames[part].normal_velocities(&self.facets[panel])[column % 6]
        } else {
            0.0
        }
    }

    /// Sign of a motion on each combination of mirrors.
    #[must_use]
    pub fn signs(&self, column: usize) -> Vec<f64> {
        signs(&self.mirrors, column % 6)
    }

    /// Result from the potentials, `panels × columns`.
    #[must_use]
    pub fn solution(&self, potentials: Vec<Vec<f64>>, report: Report) -> Solution {
        let own: Vec<Mirror> = self.mirrors.iter().copied().filter(|m| m.kind == Kind::Body).collect();
        let parity: Vec<Vec<f64>> = (0..6).map(|mode| signs(&own, mode)).collect();
        let n = self.columns();
        let mut matrix = vec![vec![0.0; n]; n];
        for ((facet, &part), phi) in self.facets.iter().zip(&self.parts).zip(&potentials) {
            if part == FIXED {
                continue;
            }
            for (mode, v) in self.frames[part].normal_velocities(facet).into_iter().enumerate() {
                for (a, p) in matrix[6 * part + mode].iter_mut().zip(phi) {
                    *a -= facet.area * v * p;
                }
            }
        }
        for (i, row) in matrix.iter_mut().enumerate() {
            for (j, a) in row.iter_mut().enumerate() {
                // Images of different signs cancel.
                *a *= parity[i % 6].iter().zip(&parity[j % 6]).map(|(a, b)| a * b).sum::<f64>();
            }
        }
        Solution { potentials, matrix, frames: self.frames.clone(), report }
    }
}

/// How the equations were solved.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Report {
    /// Unknowns: panels on the given side of the mirrors.
    pub unknowns: usize,
    /// Iterations of the slowest column; 0 for a direct solution.
    pub iterations: usize,
    /// Largest residual over right-hand side among the columns; 0 for a direct solution.
    pub residual: f64,
    /// Pairs of panels in closed form.
    pub near_pairs: usize,
    /// Pairs of boxes by expansion.
    pub far_pairs: usize,
}

/// Potentials and forces of unit motions.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// φ over each panel for each motion, `panels × columns`: m for translations, m² for rotations.
    pub potentials: Vec<Vec<f64>>,
    /// A_ij = −∫ φ_j v_i dS as computed: force in motion i from motion j over ρ, not made symmetric.
    pub matrix: Vec<Vec<f64>>,
    /// Frames of the parts.
    pub frames: Vec<Frame>,
    /// How it was solved.
    pub report: Report,
}

impl Solution {
    /// The 6 × 6 matrix of one part, about its own point.
    #[must_use]
    pub fn added_mass(&self, part: usize) -> AddedMass {
        let raw = core::array::from_fn(|i| core::array::from_fn(|j| self.matrix[6 * part + i][6 * part + j]));
        AddedMass::of(raw, self.frames[part])
    }
}
