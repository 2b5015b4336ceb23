//! Rows whitened by their effective variance.

use faer::Mat;

use crate::dense::{column_norm, mul};
use crate::odr::model::OdrProblem;
use crate::rank::PivotedQr;

/// Residuals and their derivatives at a state.
pub(super) struct Linear {
    pub n: usize,
    pub c: usize,
    pub p: usize,
    pub m: usize,
    /// `n` blocks of `c × p`.
    pub design: Vec<f64>,
    /// `F`, `n` blocks of `c × m`.
    pub slope: Vec<f64>,
    /// `y − x β` at `z + δ`, `n × c`.
    pub residual: Vec<f64>,
    /// `residual + F δ`, `n × c`: what is left at the measured inputs.
    pub effective: Vec<f64>,
}

/// Rows whitened by `V_i = diag(σ²) + F S² Fᵀ`.
pub(super) struct Whitened {
    pub design: Mat<f64>,
    pub response: Vec<f64>,
    /// Cholesky factors of the `V_i`, `n` blocks of `c × c`.
    pub factor: Vec<f64>,
}

/// Whitened rows, factored with columns of unit length.
pub(super) struct Factored {
    pub qr: PivotedQr,
    pub scale: Vec<f64>,
}

/// `V_i` of observation `i`, `c × c`.
pub(super) fn effective_variance(problem: &OdrProblem, linear: &Linear, sigma: &[f64], i: usize, out: &mut [f64]) {
    let (c, m) = (linear.c, linear.m);
    for k in 0..c {
        for l in 0..c {
            let mut sum = if k == l { sigma[k] * sigma[k] } else { 0.0 };
            for a in 0..m {
                let s = problem.input_standard[(i, a)];
                sum += linear.slope[(i * c + k) * m + a] * linear.slope[(i * c + l) * m + a] * s * s;
            }
            out[k * c + l] = sum;
        }
    }
}

/// Cholesky factor in place, row by row (lower triangle).
pub(super) fn cholesky(a: &mut [f64], n: usize) {
    for j in 0..n {
        for k in 0..j {
            a[j * n + j] -= a[j * n + k] * a[j * n + k];
        }
        // V holds σ² > 0 on its diagonal: only rounding could get below.
        a[j * n + j] = a[j * n + j].max(f64::MIN_POSITIVE).sqrt();
        for i in j + 1..n {
            for k in 0..j {
                a[i * n + j] -= a[i * n + k] * a[j * n + k];
            }
            a[i * n + j] /= a[j * n + j];
        }
    }
}

/// `L⁻¹ x` in place.
pub(super) fn forward(l: &[f64], n: usize, x: &mut [f64]) {
    for i in 0..n {
        for k in 0..i {
            x[i] -= l[i * n + k] * x[k];
        }
        x[i] /= l[i * n + i];
    }
}

/// `L⁻ᵀ x` in place.
pub(super) fn backward(l: &[f64], n: usize, x: &mut [f64]) {
    for i in (0..n).rev() {
        for k in i + 1..n {
            x[i] -= l[k * n + i] * x[k];
        }
        x[i] /= l[i * n + i];
    }
}

pub(crate) fn whiten(problem: &OdrProblem, linear: &Linear, sigma: &[f64]) -> Whitened {
    let (n, c, p) = (linear.n, linear.c, linear.p);
    let mut design = Mat::zeros(n * c, p);
    let mut response = linear.effective.clone();
    let mut factor = vec![0.0; n * c * c];
    let mut column = vec![0.0; c];
    for i in 0..n {
        let l = &mut factor[i * c * c..(i + 1) * c * c];
        effective_variance(problem, linear, sigma, i, l);
        cholesky(l, c);
        forward(l, c, &mut response[i * c..(i + 1) * c]);
        for j in 0..p {
            for (k, column) in column.iter_mut().enumerate() {
                *column = linear.design[(i * c + k) * p + j];
            }
            forward(l, c, &mut column);
            for (k, column) in column.iter().enumerate() {
                design[(i * c + k, j)] = *column;
            }
        }
    }
    Whitened { design, response, factor }
}

impl Whitened {
    pub(super) fn factor(&self) -> Factored {
        let p = self.design.ncols();
        let scale: Vec<f64> = (0..p)
            .map(|j| match column_norm(self.design.as_ref(), j) {
                0.0 => 1.0,
                length => length,
            })
            .collect();
        let scaled = Mat::from_fn(self.design.nrows(), p, |i, j| self.design[(i, j)] / scale[j]);
        Factored { qr: PivotedQr::new(scaled.as_ref()), scale }
    }
}

impl Factored {
    /// `(XᵀX)⁻¹` on what is determined.
    pub(super) fn covariance(&self) -> Mat<f64> {
        let mut lift = self.qr.lift();
        for (j, scale) in self.scale.iter().enumerate() {
            for k in 0..lift.ncols() {
                lift[(j, k)] /= scale;
            }
        }
        mul(lift.as_ref(), lift.transpose())
    }

    pub(super) fn solve(&self, b: &[f64]) -> Vec<f64> {
        self.qr.solve(b).iter().zip(&self.scale).map(|(x, s)| x / s).collect()
    }
}
