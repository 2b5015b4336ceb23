//! σ of the components, by restricted maximum likelihood of the linearised model.
//!
//! With `V = diag(σ²) + F S² Fᵀ` and `P = V⁻¹ − V⁻¹X(XᵀV⁻¹X)⁻¹XᵀV⁻¹`, the score for
//! `σ_c²` is `½ (eᵀP D_c P e − tr P D_c)`, `D_c` picking the rows of the
//! component, and the expected information `½ tr P D_c P D_d`.

use faer::Mat;

use super::model::{OdrProblem, Sigma};
use crate::dense::{Cholesky, dot, mul, mul_vec};
use crate::odr::whitened::{Linear, backward, cholesky, effective_variance, forward, whiten};

/// σ below this part of its start is explained by the input errors alone.
const FLOOR: f64 = 1e-4;
/// Fisher steps for one linearisation.
const STEPS: usize = 3;
const STEP_TOLERANCE: f64 = 1e-11;

#[derive(Debug, Clone)]
pub(super) struct Variance {
    pub sigma: Vec<f64>,
    floor: Vec<f64>,
    /// Components whose σ is estimated.
    estimated: Vec<usize>,
}

/// Information about the estimated `σ²`, and how `β` depends on them.
pub(super) struct Spread {
    estimated: Vec<usize>,
    /// Covariance of the `σ²` that are estimated.
    covariance: Mat<f64>,
    /// `∂ Var(β_j)/∂σ_c²`, one vector over coefficients per component.
    slope: Vec<Vec<f64>>,
    /// `Σ W_cd (Q_cd − B_c C B_d)`: by twice this, between `C`, the covariance of
    /// `β` grows because σ is estimated (Kenward & Roger 1997, equation 3).
    pub excess: Mat<f64>,
}

impl Variance {
    /// `size` is the rms response of each component.
    pub(super) fn new(problem: &OdrProblem, sigma: &[f64], size: &[f64]) -> Self {
        let floor: Vec<f64> =
            sigma.iter().zip(size).map(|(s, size)| (FLOOR * s).max(1e-12 * size).max(1e-150)).collect();
        Self {
            sigma: sigma.iter().zip(&floor).map(|(s, f)| s.max(*f)).collect(),
            floor,
            estimated: (0..problem.sigma.len()).filter(|&k| problem.sigma[k] == Sigma::Estimated).collect(),
        }
    }

    pub(super) fn has_estimated(&self) -> bool {
        !self.estimated.is_empty()
    }

    pub(super) fn is_at_floor(&self, k: usize) -> bool {
        self.estimated.contains(&k) && self.sigma[k] <= self.floor[k]
    }

    /// Maximises over the σ that are estimated; returns the largest relative change.
    pub(super) fn update(&mut self, problem: &OdrProblem, linear: &Linear) -> f64 {
        let before = self.sigma.clone();
        for _ in 0..STEPS {
            let moments = Moments::new(problem, linear, &self.sigma);
            let score: Vec<f64> = self.estimated.iter().map(|&k| 0.5 * moments.score(k)).collect();
            let information = moments.information(&self.estimated);
            let mut step = score.clone();
            if let Some(factor) = Cholesky::new(information.as_ref(), 0.0) {
                factor.solve(&mut step);
            } else {
                return 0.0;
            }
            let mut change = 0.0_f64;
            for (&k, step) in self.estimated.iter().zip(step) {
                let old = self.sigma[k] * self.sigma[k];
                let new = (old + step).max(0.1 * old).min(10.0 * old).sqrt().max(self.floor[k]);
                change = change.max((new / self.sigma[k] - 1.0).abs());
                self.sigma[k] = new;
            }
            if change < STEP_TOLERANCE {
                break;
            }
        }
        before.iter().zip(&self.sigma).map(|(old, new)| (new / old - 1.0).abs()).fold(0.0, f64::max)
    }

    pub(super) fn spread(&self, problem: &OdrProblem, linear: &Linear, covariance: &Mat<f64>) -> Spread {
        let p = covariance.nrows();
        // At its floor, σ does not matter any more.
        let estimated: Vec<usize> = self.estimated.iter().copied().filter(|&k| !self.is_at_floor(k)).collect();
        let e = estimated.len();
        let mut excess = Mat::zeros(p, p);
        let mut of_sigma = Mat::zeros(e, e);
        let mut slope = Vec::new();
        if e > 0 {
            let moments = Moments::new(problem, linear, &self.sigma);
            let information = moments.information(&estimated);
            of_sigma =
                Cholesky::new(information.as_ref(), 0.0).map_or_else(|| Mat::zeros(e, e), |factor| factor.inverse());
            let gram: Vec<Mat<f64>> = estimated.iter().map(|&k| moments.gram(k)).collect();
            for gram in &gram {
                let inner = mul(mul(covariance.as_ref(), gram.as_ref()).as_ref(), covariance.as_ref());
                slope.push((0..p).map(|j| inner[(j, j)]).collect());
            }
            for a in 0..e {
                for b in 0..e {
                    let cross = moments.cross(estimated[a], estimated[b]);
                    let through = mul(mul(gram[a].as_ref(), covariance.as_ref()).as_ref(), gram[b].as_ref());
                    for i in 0..p {
                        for j in 0..p {
                            excess[(i, j)] += of_sigma[(a, b)] * (cross[(i, j)] - through[(i, j)]);
                        }
                    }
                }
            }
        }
        Spread { estimated, covariance: of_sigma, slope, excess }
    }
}

impl Spread {
    /// Satterthwaite: `2 Var² / Var(Var)`.
    pub(super) fn coefficient_dof(&self, j: usize, variance: f64) -> f64 {
        let slope: Vec<f64> = self.slope.iter().map(|s| s[j]).collect();
        let spread = dot(&slope, &mul_vec(self.covariance.as_ref(), &slope));
        if spread > 0.0 { 2.0 * variance * variance / spread } else { f64::INFINITY }
    }

    pub(super) fn sigma_dof(&self, k: usize, sigma: f64) -> f64 {
        self.estimated
            .iter()
            .position(|&e| e == k)
            .map_or(f64::INFINITY, |e| 2.0 * sigma.powi(4) / self.covariance[(e, e)])
    }
}

/// Products of `V⁻¹` with everything, for one σ.
struct Moments {
    c: usize,
    n: usize,
    p: usize,
    /// `(XᵀV⁻¹X)⁻¹`, a generalised inverse.
    covariance: Mat<f64>,
    /// `V⁻¹ X`, `n` blocks of `c × p`.
    design: Vec<f64>,
    /// `(XᵀV⁻¹X)⁻¹ (V⁻¹ X)ᵀ`, `n` blocks of `c × p`.
    moved: Vec<f64>,
    /// `V⁻¹ (e − X dβ) = P e`, `n × c`.
    residual: Vec<f64>,
    /// `V⁻¹`, `n` blocks of `c × c`.
    inverse: Vec<f64>,
}

impl Moments {
    fn new(problem: &OdrProblem, linear: &Linear, sigma: &[f64]) -> Self {
        let (n, c, p) = (linear.n, linear.c, linear.p);
        let rows = whiten(problem, linear, sigma);
        let factored = rows.factor();
        let d_beta = factored.solve(&rows.response);
        let covariance = factored.covariance();
        let moved = mul_vec(rows.design.as_ref(), &d_beta);
        let mut residual: Vec<f64> = rows.response.iter().zip(moved).map(|(y, f)| y - f).collect();
        let mut design = vec![0.0; n * c * p];
        let mut inverse = vec![0.0; n * c * c];
        let mut l = vec![0.0; c * c];
        let mut column = vec![0.0; c];
        for i in 0..n {
            effective_variance(problem, linear, sigma, i, &mut l);
            cholesky(&mut l, c);
            backward(&l, c, &mut residual[i * c..(i + 1) * c]);
            for j in 0..p {
                for (k, column) in column.iter_mut().enumerate() {
                    *column = linear.design[(i * c + k) * p + j];
                }
                forward(&l, c, &mut column);
                backward(&l, c, &mut column);
                for (k, column) in column.iter().enumerate() {
                    design[(i * c + k) * p + j] = *column;
                }
            }
            for j in 0..c {
                column.fill(0.0);
                column[j] = 1.0;
                forward(&l, c, &mut column);
                backward(&l, c, &mut column);
                for (k, column) in column.iter().enumerate() {
                    inverse[(i * c + k) * c + j] = *column;
                }
            }
        }
        let mut projected = vec![0.0; n * c * p];
        for (out, x) in projected.chunks_exact_mut(p).zip(design.chunks_exact(p)) {
            for (j, &x) in x.iter().enumerate() {
                for (k, out) in out.iter_mut().enumerate() {
                    *out += covariance[(k, j)] * x;
                }
            }
        }
        Self { c, n, p, covariance, design, moved: projected, residual, inverse }
    }

    fn design_row(&self, i: usize, k: usize) -> &[f64] {
        let start = (i * self.c + k) * self.p;
        &self.design[start..start + self.p]
    }

    fn moved_row(&self, i: usize, k: usize) -> &[f64] {
        let start = (i * self.c + k) * self.p;
        &self.moved[start..start + self.p]
    }

    /// `XᵀV⁻¹ D_k V⁻¹X`.
    fn gram(&self, k: usize) -> Mat<f64> {
        self.products(k, k, |_| 1.0)
    }

    /// `XᵀV⁻¹ D_k V⁻¹ D_l V⁻¹X`.
    fn cross(&self, k: usize, l: usize) -> Mat<f64> {
        self.products(k, l, |i| self.inverse[(i * self.c + k) * self.c + l])
    }

    /// `Σ_i factor_i (V⁻¹X)_ik (V⁻¹X)_ilᵀ`.
    fn products(&self, k: usize, l: usize, factor: impl Fn(usize) -> f64) -> Mat<f64> {
        let mut out = Mat::zeros(self.p, self.p);
        for i in 0..self.n {
            let (x, y) = (self.design_row(i, k), self.design_row(i, l));
            let factor = factor(i);
            for a in 0..self.p {
                for b in 0..self.p {
                    out[(a, b)] += factor * x[a] * y[b];
                }
            }
        }
        out
    }

    /// `eᵀP D_k P e − tr P D_k`.
    fn score(&self, k: usize) -> f64 {
        (0..self.n)
            .map(|i| {
                let x = self.design_row(i, k);
                let trace = self.inverse[(i * self.c + k) * self.c + k] - dot(x, self.moved_row(i, k));
                self.residual[i * self.c + k].powi(2) - trace
            })
            .sum()
    }

    /// `½ tr P D_k P D_l` over the estimated components.
    fn information(&self, estimated: &[usize]) -> Mat<f64> {
        let e = estimated.len();
        let projected: Vec<Mat<f64>> =
            estimated.iter().map(|&k| mul(self.covariance.as_ref(), self.gram(k).as_ref())).collect();
        Mat::from_fn(e, e, |a, b| {
            let (k, l) = (estimated[a], estimated[b]);
            let mut sum = 0.0;
            for i in 0..self.n {
                let v = self.inverse[(i * self.c + k) * self.c + l];
                sum += v * v - 2.0 * v * dot(self.design_row(i, k), self.moved_row(i, l));
            }
            for i in 0..self.p {
                for j in 0..self.p {
                    sum += projected[a][(i, j)] * projected[b][(j, i)];
                }
            }
            0.5 * sum
        })
    }
}
