//! The few dense products that the fits need, on one thread.
//!
//! One thread, so that a result never depends on how many there are.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(a, b)| a * b).sum()
}

pub(crate) fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// `A B`.
pub(crate) fn mul(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(a.nrows(), b.ncols());
    matmul(out.as_mut(), Accum::Replace, a, b, 1.0, Par::Seq);
    out
}

/// `A x`.
pub(crate) fn mul_vec(a: MatRef<'_, f64>, x: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; a.nrows()];
    for (j, &xj) in x.iter().enumerate() {
        if xj != 0.0 {
            for (i, out) in out.iter_mut().enumerate() {
                *out += a[(i, j)] * xj;
            }
        }
    }
    out
}

/// `Aᵀ x`.
pub(crate) fn tr_mul_vec(a: MatRef<'_, f64>, x: &[f64]) -> Vec<f64> {
    (0..a.ncols()).map(|j| x.iter().enumerate().map(|(i, &xi)| a[(i, j)] * xi).sum()).collect()
}

/// Euclidean norm of column `j`.
pub(crate) fn column_norm(a: MatRef<'_, f64>, j: usize) -> f64 {
    (0..a.nrows()).map(|i| a[(i, j)] * a[(i, j)]).sum::<f64>().sqrt()
}

/// Row `i` as a vector.
pub(crate) fn row(a: MatRef<'_, f64>, i: usize) -> Vec<f64> {
    (0..a.ncols()).map(|j| a[(i, j)]).collect()
}

/// Cholesky factor of a small symmetric positive definite matrix, row by row.
///
/// `None` when a pivot falls to `floor` or below.
pub(crate) struct Cholesky {
    lower: Mat<f64>,
}

impl Cholesky {
    pub(crate) fn new(a: MatRef<'_, f64>, floor: f64) -> Option<Self> {
        let n = a.nrows();
        let mut lower = Mat::<f64>::zeros(n, n);
        for j in 0..n {
            let mut pivot = a[(j, j)];
            for k in 0..j {
                pivot -= lower[(j, k)] * lower[(j, k)];
            }
            if pivot.is_nan() || pivot <= floor {
                return None;
            }
            let pivot = pivot.sqrt();
            lower[(j, j)] = pivot;
            for i in j + 1..n {
                let mut sum = a[(i, j)];
                for k in 0..j {
                    sum -= lower[(i, k)] * lower[(j, k)];
                }
                lower[(i, j)] = sum / pivot;
            }
        }
        Some(Self { lower })
    }

    /// `L⁻¹ x`, in place.
    pub(crate) fn forward(&self, x: &mut [f64]) {
        for i in 0..x.len() {
            let mut sum = x[i];
            for k in 0..i {
                sum -= self.lower[(i, k)] * x[k];
            }
            x[i] = sum / self.lower[(i, i)];
        }
    }

    /// `A⁻¹ x`, in place.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        self.forward(x);
        for i in (0..x.len()).rev() {
            let mut sum = x[i];
            for k in i + 1..x.len() {
                sum -= self.lower[(k, i)] * x[k];
            }
            x[i] = sum / self.lower[(i, i)];
        }
    }

    /// `Lᵀ x`.
    pub(crate) fn transposed_times(&self, x: &[f64]) -> Vec<f64> {
        (0..x.len()).map(|i| (i..x.len()).map(|k| self.lower[(k, i)] * x[k]).sum()).collect()
    }

    /// ln det A.
    pub(crate) fn log_determinant(&self) -> f64 {
        (0..self.lower.nrows()).map(|i| 2.0 * self.lower[(i, i)].ln()).sum()
    }

    /// `A⁻¹`.
    pub(crate) fn inverse(&self) -> Mat<f64> {
        let n = self.lower.nrows();
        let mut out = Mat::zeros(n, n);
        for j in 0..n {
            let mut column = vec![0.0; n];
            column[j] = 1.0;
            self.solve(&mut column);
            for i in 0..n {
                out[(i, j)] = column[i];
            }
        }
        out
    }
}
