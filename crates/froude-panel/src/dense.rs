//! The plain solver: every panel on every other in double precision, LU. The readable version that the fast ones are held against.
//!
//! With mirrors the unknowns are those of the mesh that is given; modes with the same signs on all images share a matrix.

use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};
use froude_mesh::Mesh;
use froude_mesh::panel::{Facet, facets};
use froude_mesh::vector::Vec3;
use rayon::prelude::*;

use crate::influence::near;
use crate::matrix::AddedMass;
use crate::mirror::{Kind, Mirror, images, signs};
use crate::modes::rigid;

/// 4π.
const FOUR_PI: f64 = 4.0 * core::f64::consts::PI;

/// Potentials of the six rigid motions.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Panels that were given.
    pub facets: Vec<Facet>,
    /// φ over each of them for unit velocity of each mode about the origin of the mesh frame, m (m² for the rotations).
    pub potentials: Vec<[f64; 6]>,
    /// Matrix over ρ of the whole body about that origin.
    pub added_mass: AddedMass,
}

/// Solves for a mesh: closed, or closed with its images in the body's planes.
#[must_use]
pub fn solve(mesh: &Mesh, mirrors: &[Mirror]) -> Solution {
    let facets = facets(mesh);
    let n = facets.len();
    let velocities: Vec<[f64; 6]> = facets.iter().map(|f| rigid(f, [0.0; 3])).collect();
    let mut potentials = vec![[0.0; 6]; n];
    for (signs, modes) in classes(mirrors) {
        // Rows: ½ δ_ij − K_ij, and −S v.
        let rows: Vec<(Vec<f64>, [f64; 6])> = facets
            .par_iter()
            .enumerate()
            .map(|(i, target)| row(&facets, &velocities, i, &images(mirrors, target.centroid), &signs))
            .collect();
        let matrix = Mat::from_fn(n, n, |i, j| rows[i].0[j]);
        let right = Mat::from_fn(n, modes.len(), |i, k| rows[i].1[modes[k]]);
        let phi = PartialPivLu::new(matrix.as_ref()).solve(&right);
        for (i, p) in potentials.iter_mut().enumerate() {
            for (k, &mode) in modes.iter().enumerate() {
                p[mode] = phi[(i, k)];
            }
        }
    }
    let added_mass = AddedMass::of(forces(&facets, &velocities, &potentials, mirrors), [0.0; 3]);
    Solution { facets, potentials, added_mass }
}

/// Signs on the images, with the modes that have them.
fn classes(mirrors: &[Mirror]) -> Vec<(Vec<f64>, Vec<usize>)> {
    let mut out: Vec<(Vec<f64>, Vec<usize>)> = Vec::new();
    for mode in 0..6 {
        let signs = signs(mirrors, mode);
        match out.iter_mut().find(|c| c.0 == signs) {
            Some(class) => class.1.push(mode),
            None => out.push((signs, vec![mode])),
        }
    }
    out
}

fn row(facets: &[Facet], velocities: &[[f64; 6]], own: usize, points: &[Vec3], signs: &[f64]) -> (Vec<f64>, [f64; 6]) {
    let mut right = [0.0; 6];
    let row = facets
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

/// A_ij = −∫ φ_j n_i dS over the whole body: force in mode i from motion in mode j.
fn forces(facets: &[Facet], velocities: &[[f64; 6]], potentials: &[[f64; 6]], mirrors: &[Mirror]) -> [[f64; 6]; 6] {
    let own: Vec<Mirror> = mirrors.iter().copied().filter(|m| m.kind == Kind::Body).collect();
    let parts: [Vec<f64>; 6] = core::array::from_fn(|mode| signs(&own, mode));
    let mut out = [[0.0; 6]; 6];
    for i in 0..6 {
        for j in 0..6 {
            // Images of different signs cancel.
            let images: f64 = parts[i].iter().zip(&parts[j]).map(|(a, b)| a * b).sum();
            let part = facets.iter().zip(velocities).zip(potentials).map(|((f, v), p)| f.area * v[i] * p[j]);
            out[i][j] = -images * part.sum::<f64>();
        }
    }
    out
}
