//! What is solved: panels, mirror planes, and the motions of the parts that they belong to.
//!
//! A part is a rigid piece: the whole body, a link of a chain, a body beside another. Its motions are along and about its own axes through
//! its own point. Panels of no part stand still: the walls of a tank.

use froude_mesh::Mesh;
use froude_mesh::panel::{Facet, facets};
use froude_mesh::vector::{Vec3, cross, dot, sub};

use crate::matrix::AddedMass;
use crate::mirror::{Kind, Mirror, signs};

/// Axes and point of a rigid part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// The point that its rotations are about, m.
    pub origin_m: Vec3,
    /// Its axes x, y, z in the mesh frame.
    pub axes: [Vec3; 3],
}

impl Frame {
    /// The axes of the mesh, about a point.
    #[must_use]
    pub const fn at(origin_m: Vec3) -> Self {
        Self { origin_m, axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }
    }

    /// Normal velocities of a panel in the six motions: surge, sway, heave (1 m/s), roll, pitch, yaw (1 rad/s).
    ///
    /// Source: Newman 1977, 4.13.
    #[must_use]
    pub fn normal_velocities(&self, facet: &Facet) -> [f64; 6] {
        let n = facet.normal;
        let m = cross(sub(facet.centroid, self.origin_m), n);
        core::array::from_fn(|mode| dot(self.axes[mode % 3], if mode < 3 { n } else { m }))
    }

    /// Motions along and about these axes (rows) of a rigid body whose motions are expressed in another frame (columns).
    ///
    /// With d from the other point to this one, the velocity here is v + ω × d.
    #[must_use]
    pub fn motions_from(&self, other: &Self) -> [[f64; 6]; 6] {
        let d = sub(self.origin_m, other.origin_m);
        core::array::from_fn(|row| {
            let own = self.axes[row % 3];
            core::array::from_fn(|column| {
                let axis = other.axes[column % 3];
                match (row < 3, column < 3) {
                    (true, true) | (false, false) => dot(own, axis),
                    (true, false) => dot(own, cross(axis, d)),
                    (false, true) => 0.0,
                }
            })
        })
    }
}

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
