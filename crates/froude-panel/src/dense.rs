//! The plain solver: every panel on every other in double precision, LU. The readable version that the fast ones are compared with.
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
    let area: f64 = problem.facets.iter().map(|f| f.area).sum();
    // In an enclosed fluid a constant may be added to φ where no mirror turns its sign: there the mean is added to each row, which makes the
    // matrix regular and the mean zero.
    let is_open = |class: &Class| !problem.is_enclosed || class.signs.iter().any(|s| *s < 0.0);
    let classes = classes(problem);
    let rows: Vec<Vec<Row>> = (0..n).into_par_iter().map(|i| rows(problem, &velocities, i, &classes)).collect();
    let mut potentials = vec![vec![0.0; columns]; n];
    for (number, class) in classes.iter().enumerate() {
        let mean = |j: usize| if is_open(class) { 0.0 } else { problem.facets[j].area / area };
        let matrix = Mat::from_fn(n, n, |i, j| rows[i][number].left[j] + mean(j));
        let right = Mat::from_fn(n, class.columns.len(), |i, k| rows[i][number].right[k]);
        let phi = PartialPivLu::new(matrix.as_ref()).solve(&right);
        for (i, p) in potentials.iter_mut().enumerate() {
            for (k, &column) in class.columns.iter().enumerate() {
                p[column] = phi[(i, k)];
            }
        }
    }
    problem.solution(potentials, Report { unknowns: n, near_pairs: n * n, ..Report::default() })
}

/// Motions with the same signs on the images: they share a matrix.
struct Class {
    signs: Vec<f64>,
    columns: Vec<usize>,
}

fn classes(problem: &Problem) -> Vec<Class> {
    let mut out: Vec<Class> = Vec::new();
    for column in 0..problem.columns() {
        let signs = problem.signs(column);
        match out.iter_mut().find(|c| c.signs == signs) {
            Some(class) => class.columns.push(column),
            None => out.push(Class { signs, columns: vec![column] }),
        }
    }
    out
}

/// ½ δ_ij − K_ij over j, and −S v for the motions of a class.
struct Row {
    left: Vec<f64>,
    right: Vec<f64>,
}

/// The row of a panel in the matrix of each class.
fn rows(problem: &Problem, velocities: &[Vec<f64>], own: usize, classes: &[Class]) -> Vec<Row> {
    let points: Vec<Vec3> = images(&problem.mirrors, problem.facets[own].centroid);
    let n = problem.facets.len();
    let mut out: Vec<Row> =
        classes.iter().map(|c| Row { left: vec![0.0; n], right: vec![0.0; c.columns.len()] }).collect();
    for (j, (source, v)) in problem.facets.iter().zip(velocities).enumerate() {
        for (image, point) in points.iter().enumerate() {
            let on = near(source, *point);
            // A panel does not turn its own potential.
            let turned = if image == 0 && j == own { 0.0 } else { on.dipole };
            for (row, class) in out.iter_mut().zip(classes) {
                let sign = class.signs[image] / FOUR_PI;
                row.left[j] -= sign * turned;
                for (r, column) in row.right.iter_mut().zip(&class.columns) {
                    *r -= sign * on.source * v[*column];
                }
            }
        }
    }
    for row in &mut out {
        row.left[own] += 0.5;
    }
    out
}
