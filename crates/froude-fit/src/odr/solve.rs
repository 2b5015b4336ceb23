//! β and δ for given σ: Gauss–Newton with the δ eliminated.

use faer::Mat;

use super::model::{InputModel, OdrProblem, Sigma};
use super::variance::Variance;
use crate::dense::{column_norm, dot, mul_vec, row};
use crate::error::FitError;
use crate::odr::whitened::{Linear, Whitened, backward, whiten};
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
                    return Err(FitError::Refused(format!(
                        "component {:?} has {n} rows for {} coefficients: none is left to estimate its standard deviation from",
                        problem.components[k], qr.rank
                    )));
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
