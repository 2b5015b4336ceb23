//! The plain solver: every panel on every other in double precision, LU. The readable version that the fast ones are held against.
//!
//! With mirrors the unknowns are those of the panels that are given; motions with the same signs on all images share a matrix.

use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};
use froude_mesh::vector::Vec3;
use rayon::prelude::*;

use crate::influence::near;
use crate::mirror::images;
use crate::problem::{Problem, Report, Solution};

/// 4π.
const FOUR_PI: f64 = 4.0 * core::f64::consts::PI;

/// Solves for all motions.
#[must_use]
pub fn solve(problem: &Problem) -> Solution {
    let n = problem.facets.len();
    let columns = problem.columns();
    let velocities: Vec<Vec<f64>> = (0..n).map(|p| (0..columns).map(|c| problem.velocity(p, c)).collect()).collect();
    let mut potentials = vec![vec![0.0; columns]; n];
    let area: f64 = problem.facets.iter().map(|f| f.area).sum();
    for (signs, members) in classes(problem) {
        // Rows: ½ δ_ij − K_ij, and −S v.
        let rows: Vec<(Vec<f64>, Vec<f64>)> = (0..n)
            .into_par_iter()
            .map(|i| row(problem, &velocities, i, &images(&problem.mirrors, problem.facets[i].centroid), &signs))
            .collect();
        // In an enclosed fluid the mean of φ is added to each row: it makes the matrix regular, and the mean zero.
        let mean = |j: usize| if problem.is_enclosed { problem.facets[j].area / area } else { 0.0 };
        let matrix = Mat::from_fn(n, n, |i, j| rows[i].0[j] + mean(j));
        let right = Mat::from_fn(n, members.len(), |i, k| rows[i].1[members[k]]);
        let phi = PartialPivLu::new(matrix.as_ref()).solve(&right);
        for (i, p) in potentials.iter_mut().enumerate() {
            for (k, &column) in members.iter().enumerate() {
                p[column] = phi[(i, k)];
            }
        }
    }
    problem.solution(potentials, Report { unknowns: n, near_pairs: n * n, ..Report::default() })
}

/// Signs on the images, with the motions that have them.
fn classes(problem: &Problem) -> Vec<(Vec<f64>, Vec<usize>)> {
    let mut out: Vec<(Vec<f64>, Vec<usize>)> = Vec::new();
    for column in 0..problem.columns() {
        let signs = problem.signs(column);
        match out.iter_mut().find(|c| c.0 == signs) {
            Some(class) => class.1.push(column),
            None => out.push((signs, vec![column])),
        }
    }
    out
}

fn row(problem: &Problem, velocities: &[Vec<f64>], own: usize, points: &[Vec3], signs: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut right = vec![0.0; problem.columns()];
    let row = problem
        .facets
        .iter()
        .zip(velocities)
        .enumerate()
        .map(|(j, (source, v))| {
            let (mut s, mut k) = (0.0, 0.0);
            for (image, (point, sign)) in points.iter().zip(signs).enumerate() {
                let on = near(source, *point);
                s += sign * on.source / FOUR_PI;
                // A panel does not turn its own potential.
                k += if image == 0 && j == own { 0.0 } else { sign * on.dipole / FOUR_PI };
            }
            right.iter_mut().zip(v).for_each(|(r, v)| *r -= s * v);
            if j == own { 0.5 - k } else { -k }
        })
        .collect();
    (row, right)
}
