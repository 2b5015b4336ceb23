//! Boxes acting on boxes: potentials on the surfaces of cubes, and the matrices between them.
//!
//! What a box's panels do far away is known from their potential on a cube around it, and what far panels do inside a box from their
//! potential on the box's own surface. Either is carried on by charges on a second cube that give the same potential there: between box and
//! the first cube for what goes out, beyond the second for what comes in. Source: Ying, Biros & Zorin 2004, J. Comput. Phys. 196.
//!
//! Only potentials are stored, times the half-width of their box: the charges, which are large and cancel, stay inside the matrices, which
//! are formed in double precision. All are of order one then, the same at every level, and kept in single precision.

use std::collections::BTreeMap;

use faer::Mat;
use froude_mesh::vector::{Vec3, norm, sub};

use crate::tree::Cell;

/// Points along an edge of a cube. With 7 the potential of a box errs by 1e-6 of itself in the mean, the matrix of a body by 3e-7.
const EDGE: i32 = 7;
/// Points on a cube.
pub(crate) const POINTS: usize = (6 * (EDGE - 1) * (EDGE - 1) + 2) as usize;
/// Half-widths of the cubes, in those of the box: charges and potential of what goes out, potential and charges of what comes in.
///
/// Panels reach out of their box by a quarter; boxes that act on each other have their centres four apart.
const OUT_CHARGES: f64 = 1.3;
const OUT: f64 = 2.95;
const IN: f64 = 1.05;
const IN_CHARGES: f64 = 2.7;
/// Singular values below this part of the largest are left out: smaller ones amplify the rounding of single precision.
const CUT: f64 = 1e-8;

/// Points of the surface of the cube from −1 to 1.
fn surface() -> Vec<Vec3> {
    let at = |i: i32| f64::from(2 * i - (EDGE - 1)) / f64::from(EDGE - 1);
    let mut out = Vec::new();
    for i in 0..EDGE {
        for j in 0..EDGE {
            for k in 0..EDGE {
                if [i, j, k].iter().any(|x| *x == 0 || *x == EDGE - 1) {
                    out.push([at(i), at(j), at(k)]);
                }
            }
        }
    }
    out
}

fn scaled(points: &[Vec3], factor: f64, shift: Vec3) -> Vec<Vec3> {
    points.iter().map(|p| core::array::from_fn(|a| factor * p[a] + shift[a])).collect()
}

/// 1/r between points, `targets × sources`.
fn inverse_distances(targets: &[Vec3], sources: &[Vec3]) -> Mat<f64> {
    Mat::from_fn(targets.len(), sources.len(), |i, j| 1.0 / norm(sub(targets[i], sources[j])))
}

/// Charges that give a potential: the pseudo-inverse.
#[allow(clippy::expect_used)]
fn charges(potential: &[Vec3], charges: &[Vec3]) -> Mat<f64> {
    let matrix = inverse_distances(potential, charges);
    // Fails only for numbers that are not finite, and these are distances of two fixed cubes.
    let svd = matrix.svd().expect("distances between two cubes are finite");
    let (u, s, v) = (svd.U(), svd.S().column_vector(), svd.V());
    let keep = (0..s.nrows()).take_while(|&k| s[k] > CUT * s[0]).count();
    let half = Mat::from_fn(v.nrows(), keep, |i, k| v[(i, k)] / s[k]);
    half * u.subcols(0, keep).transpose()
}

/// Matrices between boxes, and the surfaces that they join.
pub(crate) struct Expansion {
    /// Surface of the unit cube.
    unit: Vec<Vec3>,
    /// Charges of what comes in, from its potential.
    in_charges: Mat<f64>,
    /// From the potential of a child going out to that of the box around it, by octant.
    pub(crate) up: Vec<Mat<f32>>,
    /// From the potential coming into a box to that of its child, by octant.
    pub(crate) down: Vec<Mat<f32>>,
    /// From the potential going out of a box to that coming into another, by its offset seen from there.
    pub(crate) across: BTreeMap<Cell, Mat<f32>>,
}

/// Centre of a child in half-widths of the box around it.
fn octant_centre(octant: usize) -> Vec3 {
    core::array::from_fn(|a| if octant >> a & 1 == 1 { 0.5 } else { -0.5 })
}

fn single(matrix: &Mat<f64>) -> Mat<f32> {
    Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)] as f32)
}

impl Expansion {
    /// With the matrices for the offsets that occur.
    pub(crate) fn new(offsets: &[Cell]) -> Self {
        use rayon::prelude::*;
        let unit = surface();
        let zero = [0.0; 3];
        let (out_charges, in_charges) = rayon::join(
            || charges(&scaled(&unit, OUT, zero), &scaled(&unit, OUT_CHARGES, zero)),
            || charges(&scaled(&unit, IN, zero), &scaled(&unit, IN_CHARGES, zero)),
        );
        let up = (0..8)
            .into_par_iter()
            .map(|o| {
                let child = scaled(&unit, 0.5 * OUT_CHARGES, octant_centre(o));
                single(&(inverse_distances(&scaled(&unit, OUT, zero), &child) * &out_charges))
            })
            .collect();
        let down = (0..8)
            .into_par_iter()
            .map(|o| {
                let child = scaled(&unit, 0.5 * IN, octant_centre(o));
                let there = inverse_distances(&child, &scaled(&unit, IN_CHARGES, zero)) * &in_charges;
                single(&Mat::from_fn(there.nrows(), there.ncols(), |i, j| 0.5 * there[(i, j)]))
            })
            .collect();
        let across = offsets
            .par_iter()
            .map(|offset| {
                let centre = offset.map(|d| 2.0 * f64::from(d));
                let there = scaled(&unit, OUT_CHARGES, centre);
                (*offset, single(&(inverse_distances(&scaled(&unit, IN, zero), &there) * &out_charges)))
            })
            .collect();
        Self { unit, in_charges, up, down, across }
    }

    /// Where the potential going out of a box is taken, m.
    pub(crate) fn outside(&self, centre: Vec3, half_width: f64) -> Vec<Vec3> {
        scaled(&self.unit, OUT * half_width, centre)
    }

    /// From the potential coming into a box, times its half-width, to that at points in it: `points × POINTS`.
    pub(crate) fn inside(&self, points: &[Vec3], centre: Vec3, half_width: f64) -> Mat<f32> {
        let charges = scaled(&self.unit, IN_CHARGES * half_width, centre);
        single(&(inverse_distances(points, &charges) * &self.in_charges))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(values: &[f64]) -> Mat<f64> {
        Mat::from_fn(values.len(), 1, |i, _| values[i])
    }

    fn double(matrix: &Mat<f32>) -> Mat<f64> {
        Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| f64::from(matrix[(i, j)]))
    }

    /// A charge at the worst place, out through its box, up, across, down and in, against 1/r.
    #[test]
    fn a_charge_is_felt_through_all_the_boxes() {
        let offsets = [[2, 0, 0], [2, 1, -1], [3, 3, 3], [-2, 2, 2]];
        let e = Expansion::new(&offsets);
        let mut worst = 0.0_f64;
        for offset in offsets {
            for octant in 0..8 {
                let source = octant_centre(octant).map(|x| x + 0.62 * x.signum());
                let child = octant_centre(octant);
                let gone: Vec<f64> = e.outside(child, 0.5).iter().map(|p| 0.5 / norm(sub(*p, source))).collect();
                let out = double(&e.up[octant]) * column(&gone);
                // The box at the origin lies at `offset` as seen from the other one.
                let come = double(&e.across[&offset]) * out;
                let there = offset.map(|d| -2.0 * f64::from(d));
                for other in 0..8 {
                    let o = octant_centre(other);
                    let centre = core::array::from_fn(|a| there[a] + o[a]);
                    let point: Vec3 = core::array::from_fn(|a| centre[a] + 0.49 * o[a].signum());
                    let inner = double(&e.down[other]) * &come;
                    let found = (double(&e.inside(&[point], centre, 0.5)) * inner)[(0, 0)];
                    let exact = 1.0 / norm(sub(point, source));
                    worst = worst.max((found / exact - 1.0).abs());
                }
            }
        }
        println!("{POINTS} points: {worst:.1e}");
        assert!(worst < 1e-4, "{worst}");
    }
}
