//! β and δ for given σ: Gauss–Newton with the δ eliminated.

use faer::Mat;

use super::model::{InputModel, OdrProblem, Sigma};
use super::variance::Variance;
use crate::dense::{column_norm, dot, mul_vec, row};
use crate::error::FitError;
use crate::rank::PivotedQr;
use crate::report::{End, Report};

/// Converged when a step moves the whitened rows by less than this part.
const STEP_TOLERANCE: f64 = 1e-10;
/// Steps that cannot lower the sum are taken as converged below this size.
const ROUNDING_STEP: f64 = 1e-6;
pub(super) const ITERATIONS: usize = 200;
const HALVINGS: usize = 30;

/// Where the iteration stands.
#[derive(Debug, Clone)]
pub(super) struct State {
    pub beta: Vec<f64>,
    pub delta: Mat<f64>,
}

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

impl State {
    /// Least squares at the measured inputs; σ from its residuals where unknown.
    pub(super) fn start<M: InputModel>(model: &M, problem: &OdrProblem) -> Result<(Self, Variance), FitError> {
        let p = model.n_coefficients();
        let c = model.n_components();
        let n = problem.response.nrows();
        let mut state = Self { beta: vec![0.0; p], delta: Mat::zeros(n, model.n_inputs()) };
        let linear = linearise(model, problem, &state);
        let mut sigma = vec![1.0; c];
        let mut size = vec![0.0; c];
        for k in 0..c {
            let part = Mat::from_fn(n, p, |i, j| linear.design[(i * c + k) * p + j]);
            let scale: Vec<f64> = (0..p)
                .map(|j| Some(column_norm(part.as_ref(), j)).filter(|&s| s > 0.0))
                .map(|s| s.unwrap_or(1.0))
                .collect();
            let scaled = Mat::from_fn(n, p, |i, j| part[(i, j)] / scale[j]);
            let y: Vec<f64> = (0..n).map(|i| problem.response[(i, k)]).collect();
            let qr = PivotedQr::new(scaled.as_ref());
            let fitted = mul_vec(scaled.as_ref(), &qr.solve(&y));
            let rss: f64 = y.iter().zip(fitted).map(|(y, f)| (y - f) * (y - f)).sum();
            size[k] = (dot(&y, &y) / n as f64).sqrt();
            sigma[k] = match problem.sigma[k] {
                Sigma::Known(sigma) => sigma,
                Sigma::Estimated if n > qr.rank => (rss / (n - qr.rank) as f64).sqrt(),
                Sigma::Estimated => {
                    return Err(FitError::NoDegreesOfFreedom {
                        component: problem.components[k].clone(),
                        n,
                        rank: qr.rank,
                    });
                }
            };
        }
        let variance = Variance::new(problem, &sigma, &size);
        let mut design = Mat::zeros(n * c, p);
        let mut response = Vec::with_capacity(n * c);
        for i in 0..n {
            for k in 0..c {
                for j in 0..p {
                    design[(i * c + k, j)] = linear.design[(i * c + k) * p + j] / variance.sigma[k];
                }
                response.push(problem.response[(i, k)] / variance.sigma[k]);
            }
        }
        let plain = Whitened { design, response, factor: Vec::new() };
        state.beta = plain.factor().solve(&plain.response);
        Ok((state, variance))
    }
}

pub(super) fn linearise<M: InputModel>(model: &M, problem: &OdrProblem, state: &State) -> Linear {
    let (p, c, m) = (model.n_coefficients(), model.n_components(), model.n_inputs());
    let n = problem.response.nrows();
    let mut linear = Linear {
        n,
        c,
        p,
        m,
        design: vec![0.0; n * c * p],
        slope: vec![0.0; n * c * m],
        residual: vec![0.0; n * c],
        effective: vec![0.0; n * c],
    };
    let mut derivative = vec![0.0; m * c * p];
    for i in 0..n {
        let delta = row(state.delta.as_ref(), i);
        let inputs: Vec<f64> = row(problem.inputs.as_ref(), i).iter().zip(&delta).map(|(z, d)| z + d).collect();
        let design = &mut linear.design[i * c * p..(i + 1) * c * p];
        model.regressors(i, &inputs, design);
        model.derivatives(i, &inputs, &mut derivative);
        for k in 0..c {
            let fitted = dot(&design[k * p..(k + 1) * p], &state.beta);
            let residual = problem.response[(i, k)] - fitted;
            let mut effective = residual;
            for l in 0..m {
                let start = (l * c + k) * p;
                let slope = dot(&derivative[start..start + p], &state.beta);
                linear.slope[(i * c + k) * m + l] = slope;
                effective += slope * delta[l];
            }
            linear.residual[i * c + k] = residual;
            linear.effective[i * c + k] = effective;
        }
    }
    linear
}

/// The sum that is minimised.
pub(super) fn objective(problem: &OdrProblem, state: &State, residual: &[f64], sigma: &[f64]) -> f64 {
    let c = sigma.len();
    let mut sum: f64 = residual.iter().enumerate().map(|(k, r)| (r / sigma[k % c]).powi(2)).sum();
    for i in 0..state.delta.nrows() {
        for l in 0..state.delta.ncols() {
            let s = problem.input_standard[(i, l)];
            if s > 0.0 {
                sum += (state.delta[(i, l)] / s).powi(2);
            }
        }
    }
    sum
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

pub(super) fn whiten(problem: &OdrProblem, linear: &Linear, sigma: &[f64]) -> Whitened {
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
    pub(super) fn solve(&self, b: &[f64]) -> Vec<f64> {
        self.qr.solve(b).iter().zip(&self.scale).map(|(x, s)| x / s).collect()
    }
}

/// Minimises over β and δ, from where the state stands, in at most so many steps.
pub(super) fn minimise<M: InputModel>(
    model: &M,
    problem: &OdrProblem,
    state: &mut State,
    sigma: &[f64],
    most: usize,
) -> Report {
    let (c, m) = (model.n_components(), model.n_inputs());
    let mut linear = linearise(model, problem, state);
    let mut value = objective(problem, state, &linear.residual, sigma);
    for iterations in 1..=most {
        let rows = whiten(problem, &linear, sigma);
        let d_beta = rows.factor().solve(&rows.response);
        let moved = mul_vec(rows.design.as_ref(), &d_beta);
        // New δ: S² Fᵀ V⁻¹ (effective − X dβ).
        let mut d_delta = Mat::zeros(linear.n, m);
        let mut size = dot(&moved, &moved);
        for i in 0..linear.n {
            let l = &rows.factor[i * c * c..(i + 1) * c * c];
            let mut rest: Vec<f64> = (i * c..(i + 1) * c).map(|k| rows.response[k] - moved[k]).collect();
            backward(l, c, &mut rest);
            for a in 0..m {
                let s = problem.input_standard[(i, a)];
                if s > 0.0 {
                    let sum: f64 = (0..c).map(|k| linear.slope[(i * c + k) * m + a] * rest[k]).sum();
                    let change = s * s * sum - state.delta[(i, a)];
                    d_delta[(i, a)] = change;
                    size += (change / s).powi(2);
                }
            }
        }
        let size = size.sqrt();
        let whole = (1.0 + value).sqrt();
        let mut length = 1.0;
        let mut is_taken = false;
        for _ in 0..HALVINGS {
            let trial = State {
                beta: state.beta.iter().zip(&d_beta).map(|(b, d)| b + length * d).collect(),
                delta: Mat::from_fn(linear.n, m, |i, a| state.delta[(i, a)] + length * d_delta[(i, a)]),
            };
            let at_trial = linearise(model, problem, &trial);
            let new = objective(problem, &trial, &at_trial.residual, sigma);
            if new <= value + 1e-13 * (1.0 + value) {
                *state = trial;
                linear = at_trial;
                value = new;
                is_taken = true;
                break;
            }
            length *= 0.5;
        }
        let end = if size <= STEP_TOLERANCE * whole || (!is_taken && size <= ROUNDING_STEP * whole) {
            Some(End::Converged)
        } else if is_taken {
            None
        } else {
            Some(End::Stalled)
        };
        if let Some(end) = end {
            return Report { end, iterations };
        }
    }
    Report { end: End::IterationLimit, iterations: most }
}
