//! A body in a rectangular tank: walls and bottom as standing panels, the water surface as a mirror plane.
//!
//! **Frame.** The origin of the tank is the middle of its water surface: x along its length, y along its width, z up. The body's mesh keeps
//! its own frame, parallel to that, with its origin at a given point of the tank.
//!
//! The surface has two limits: a rigid lid (motions slow against waves; ∂φ/∂n = 0) and φ = 0 (fast ones). Under the lid the water is enclosed
//! altogether; with φ = 0 it is not.
//!
//! Cells of the walls are equal: φ is smooth in a tank's inner corners, where images continue it. Between a wall and a body there should be a
//! cell's length of water or more. A plane of symmetry of body and tank is not used.

use froude_mesh::panel::facets;
use froude_mesh::vector::Vec3;
use froude_mesh::{Mesh, Panel};

use crate::mirror::{Kind, Mirror};
use crate::problem::{FIXED, Problem, Solution};

/// A rectangular tank.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tank {
    /// Along x, m.
    pub length_m: f64,
    /// Along y, m.
    pub width_m: f64,
    /// Of the water, m.
    pub depth_m: f64,
}

/// A limit of the water surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// No flow through it: motions slow against waves.
    Lid,
    /// φ = 0: motions fast against them.
    Free,
}

/// Both limits.
#[derive(Debug, Clone, PartialEq)]
pub struct InTank {
    /// Under a rigid lid.
    pub lid: Solution,
    /// Under φ = 0.
    pub free: Solution,
}

impl Tank {
    /// Cells along length, width and depth, of about a size; whole multiples of them are a similar family.
    #[must_use]
    pub fn cells(&self, cell_m: f64) -> [usize; 3] {
        [self.length_m, self.width_m, self.depth_m].map(|l| (l / cell_m).round().max(1.0) as usize)
    }

    /// Walls and bottom in the tank's frame, normals into the water; cells along length, width and depth.
    #[must_use]
    pub fn walls(&self, cells: [usize; 3]) -> Mesh {
        let [l, w, d] = [0.5 * self.length_m, 0.5 * self.width_m, self.depth_m];
        let mut out = Mesh::default();
        // Corner, edges e₁ and e₂ with e₁ × e₂ into the water, cells along each.
        let [nx, ny, nz] = cells;
        let (ex, ey, ez) = ([2.0 * l, 0.0, 0.0], [0.0, 2.0 * w, 0.0], [0.0, 0.0, d]);
        for (corner, first, second, n) in [
            ([-l, -w, -d], ex, ey, [nx, ny]),
            ([-l, -w, -d], ey, ez, [ny, nz]),
            ([l, -w, -d], ez, ey, [nz, ny]),
            ([-l, -w, -d], ez, ex, [nz, nx]),
            ([-l, w, -d], ex, ez, [nx, nz]),
        ] {
            out = out.with(&rectangle(corner, first, second, n));
        }
        out
    }

    /// A problem in unbounded water, put into the tank with the origin of its mesh frame at a point of the tank.
    ///
    /// # Errors
    ///
    /// [`TankError`] for a panel that reaches out of the water, or a problem that has mirrors already.
    pub fn around(
        &self,
        problem: &Problem,
        origin_m: Vec3,
        cells: [usize; 3],
        surface: Surface,
    ) -> Result<Problem, TankError> {
        if !problem.mirrors.is_empty() {
            return Err(TankError::Mirrored { mirrors: problem.mirrors.len() });
        }
        let half = [0.5 * self.length_m, 0.5 * self.width_m];
        let low = [-half[0], -half[1], -self.depth_m];
        let high = [half[0], half[1], 0.0];
        let mut furthest: Option<(f64, TankError)> = None;
        for (panel, facet) in problem.facets.iter().enumerate() {
            for corner in &facet.corners[..facet.count] {
                let point_m = [0, 1, 2].map(|i| corner[i] + origin_m[i]);
                for axis in 0..3 {
                    for (side, out_m) in [low[axis] - point_m[axis], point_m[axis] - high[axis]].into_iter().enumerate()
                    {
                        if out_m >= 0.0 && furthest.as_ref().is_none_or(|f| f.0 < out_m) {
                            let boundary = BOUNDARIES[axis][side];
                            furthest = Some((out_m, TankError::Outside { panel, point_m, boundary }));
                        }
                    }
                }
            }
        }
        if let Some((_, why)) = furthest {
            return Err(why);
        }
        let walls = facets(&self.walls(cells).mapped(|v| [0, 1, 2].map(|i| v[i] - origin_m[i])));
        let mut out = problem.clone();
        out.parts.extend(vec![FIXED; walls.len()]);
        out.facets.extend(walls);
        let kind = match surface {
            Surface::Lid => Kind::Wall,
            Surface::Free => Kind::FreeSurface,
        };
        out.mirrors = vec![Mirror { axis: 2, at_m: -origin_m[2], kind }];
        out.is_enclosed = surface == Surface::Lid;
        Ok(out)
    }

    /// Solves a problem in the tank, under both limits of the surface.
    ///
    /// # Errors
    ///
    /// As [`Tank::around`].
    pub fn solve(&self, problem: &Problem, origin_m: Vec3, cells: [usize; 3]) -> Result<InTank, TankError> {
        let under = |surface| Ok(crate::solve(&self.around(problem, origin_m, cells, surface)?));
        Ok(InTank { lid: under(Surface::Lid)?, free: under(Surface::Free)? })
    }
}

/// What lies at the low and the high end of x, y, z.
const BOUNDARIES: [[&str; 2]; 3] =
    [["the wall at -x", "the wall at +x"], ["the wall at -y", "the wall at +y"], ["the bottom", "the water surface"]];

/// A rectangle in cells, its normal along the first edge times the second.
fn rectangle(corner: Vec3, first: Vec3, second: Vec3, [n, m]: [usize; 2]) -> Mesh {
    let mut out = Mesh::default();
    for i in 0..=n {
        for j in 0..=m {
            let (s, t) = (i as f64 / n as f64, j as f64 / m as f64);
            out.vertices.push([0, 1, 2].map(|k| corner[k] + s * first[k] + t * second[k]));
        }
    }
    let at = |i: usize, j: usize| (i * (m + 1) + j) as u32;
    for i in 0..n {
        for j in 0..m {
            out.panels.push(Panel::quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)));
        }
    }
    out
}

/// Why a body is not in a tank.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TankError {
    /// A panel touches or crosses a wall, the bottom or the surface; the one that is furthest out.
    #[error(
        "panel {panel} reaches {boundary}, at ({:.4}, {:.4}, {:.4}) m from the middle of the water surface; move the body or take a \
         larger tank",
        point_m[0], point_m[1], point_m[2]
    )]
    Outside {
        /// The panel, from 0.
        panel: usize,
        /// Its corner there, in the tank's frame, m.
        point_m: Vec3,
        /// What it touches.
        boundary: &'static str,
    },
    /// The problem has mirrors: the walls would have to be symmetric in them.
    #[error("the body is meshed with {mirrors} mirror planes; give the whole of it")]
    Mirrored {
        /// How many.
        mirrors: usize,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use froude_mesh::measure::Measure;
    use froude_mesh::sections::{Resolution, SectionBody};

    const POOL: Tank = Tank { length_m: 1.5, width_m: 0.9, depth_m: 1.0 };

    #[test]
    fn the_walls_with_a_lid_enclose_the_water_from_inside() {
        let walls = POOL.walls([6, 4, 5]);
        let lid = rectangle([-0.75, -0.45, 0.0], [0.0, 0.9, 0.0], [1.5, 0.0, 0.0], [4, 6]);
        let measure = Measure::of(&walls.with(&lid));
        assert!((measure.volume_m3 + 1.35).abs() < 1e-13, "normals into the water: {measure:?}");
        assert!((measure.area_m2 - (2.7 + 3.0 + 1.8)).abs() < 1e-12);
    }

    #[test]
    fn a_body_through_the_surface_is_refused_with_its_panel() {
        let body = SectionBody::ellipsoid([0.3, 0.1, 0.1], 2).mesh(Resolution { along: 1, around: 8 }).unwrap().mesh;
        let problem = Problem::rigid(&body, &[]);
        let why = POOL.around(&problem, [0.0, 0.0, -0.05], [3, 2, 2], Surface::Lid).unwrap_err();
        assert!(why.to_string().contains("reaches the water surface, at (0.0000, 0.0000, 0.0500) m"), "{why}");
        let why = POOL.around(&problem, [0.5, 0.0, -0.5], [3, 2, 2], Surface::Lid).unwrap_err();
        assert!(matches!(why, TankError::Outside { boundary: "the wall at +x", .. }), "{why}");
        let mirrored = Problem::rigid(&body, &[Mirror::body(1)]);
        assert!(POOL.around(&mirrored, [0.0, 0.0, -0.5], [3, 2, 2], Surface::Free).is_err());
    }
}
