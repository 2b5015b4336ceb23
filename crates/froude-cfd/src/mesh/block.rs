//! A block of hexahedra, i × j × k, whose sides may be bent onto each other: the topology of every mesh of this crate.
//!
//! Corners that fall together make a prism of a hexahedron, and a face that is left with fewer than three is none. So a side may shrink to a line (the pole of an O-grid), and two sides may be one (all around).

use core::ops::Range;

use crate::poly_mesh::{PatchKind, PolyMesh, Side};

/// What a side of the block is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End<'a> {
    /// Faces of the patch of this number.
    Patch(usize),
    /// Faces of one patch within these cells along i, and of another outside of them.
    Within(&'a Range<usize>, usize, usize),
    /// The same as the opposite side.
    Around,
    /// A line.
    Line,
}

impl End<'_> {
    fn patch(&self, i: usize) -> Option<usize> {
        match *self {
            End::Patch(patch) => Some(patch),
            End::Within(cells, inside, outside) => Some(if cells.contains(&i) { inside } else { outside }),
            End::Around | End::Line => None,
        }
    }
}

/// A block.
pub struct Block<'a> {
    /// Cells along i, j, k.
    pub cells: [usize; 3],
    /// First and last side along i, j, k.
    pub ends: [[End<'a>; 2]; 3],
    /// The patches.
    pub patches: &'a [(&'a str, PatchKind)],
}

impl Block<'_> {
    /// Number of a cell; i runs slowest.
    #[must_use]
    pub fn cell(&self, [i, j, k]: [usize; 3]) -> u32 {
        ((i * self.cells[1] + j) * self.cells[2] + k) as u32
    }

    /// i, j, k of a cell.
    #[must_use]
    pub fn place(&self, cell: usize) -> [usize; 3] {
        let [_, nj, nk] = self.cells;
        [cell / (nj * nk), cell / nk % nj, cell % nk]
    }

    /// The mesh over points, the number of that at the corner i, j, k given by `point`; i, j, k are a right-handed system.
    pub fn mesh(&self, points_m: Vec<[f64; 3]>, point: impl Fn([usize; 3]) -> u32) -> PolyMesh {
        let mut between = Vec::new();
        let mut boundary: Vec<_> = self.patches.iter().map(|&(name, kind)| (name, kind, Vec::new())).collect();
        let count = self.cells.iter().product();
        for number in 0..count {
            let at = self.place(number);
            let cell = number as u32;
            for axis in 0..3 {
                let is_last = at[axis] + 1 == self.cells[axis];
                let [lower, upper] = self.ends[axis];
                let mut next = at;
                next[axis] = if is_last { 0 } else { at[axis] + 1 };
                let corners = face(&point, at, axis, true);
                if corners.len() >= 3 {
                    if !is_last || upper == End::Around {
                        between.push((Side { corners, cell }, self.cell(next)));
                    } else if let Some(patch) = upper.patch(at[0]) {
                        boundary[patch].2.push(Side { corners, cell });
                    }
                }
                if let (0, Some(patch)) = (at[axis], lower.patch(at[0])) {
                    let corners = face(&point, at, axis, false);
                    if corners.len() >= 3 {
                        boundary[patch].2.push(Side { corners, cell });
                    }
                }
            }
        }
        PolyMesh::assemble(points_m, count, between, boundary)
    }
}

/// Corners of a cell's face across an axis, counter-clockwise seen from outside, each once.
fn face(point: &impl Fn([usize; 3]) -> u32, at: [usize; 3], axis: usize, is_upper: bool) -> Vec<u32> {
    let [first, second] = [(axis + 1) % 3, (axis + 2) % 3];
    let mut corners: Vec<u32> = [(0, 0), (1, 0), (1, 1), (0, 1)]
        .into_iter()
        .map(|(p, q)| {
            let mut corner = at;
            corner[axis] += usize::from(is_upper);
            corner[first] += p;
            corner[second] += q;
            point(corner)
        })
        .collect();
    if !is_upper {
        corners.reverse();
    }
    corners.dedup();
    if corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    corners
}
