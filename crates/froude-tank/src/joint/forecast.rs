//! The interval to expect of each coefficient, before a day in the tank is paid for.
//!
//! The planned runs are swung without noise on the twin; the joint fit is linearised at the truth; the noise of the sensors, its correlation and all
//! that is declared go through it: with N = XᵀX/s², s² = σ²τ as the fit weighs the observations, and P what is known beforehand,
//!
//! C = (N + P)⁻¹ [Xᵀ Ω X/s⁴ + P + …] (N + P)⁻¹,  Ω_ij = σ² e^{−|t_i − t_j|/τ_c}.
//!
//! **Units.** Those of the coefficients.
//!
//! # Source
//!
//! Fisher information of a linear model with correlated noise, JCGM 100:2008 (GUM), 5.2.

use froude_fit::FEWEST_CLUSTERS;
use froude_fit::budget::{Kind, Part};
use froude_fit::faer::Mat;
use froude_fit::jackknife::{AtEqualErrors, at_equal_errors};
use froude_records::campaign::SensorSpec;

use super::solve::over_first;
use super::{Equation, Known, Problem, part};
use crate::error::TankError;
use crate::inverted::inverted;
use crate::noise::correlated;

pub use crate::plan::Expected;

/// Variance of a load without noise, N² or N² m²: nothing beside that of any sensor, and its inverse still a number.
const NO_NOISE: f64 = 1e-30;

/// What a plan will determine.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// The coefficients.
    pub expected: Vec<Expected>,
    /// Covariance of the coefficients from all errors together.
    pub covariance: Mat<f64>,
    /// Whole cycles used of each run.
    pub cycles: Vec<usize>,
}

impl Forecast {
    /// Correlation of two coefficients; `None` where one of them is known.
    #[must_use]
    pub fn correlation(&self, a: &str, b: &str) -> Option<f64> {
        let at = |name: &str| self.expected.iter().position(|e| e.name == name);
        let (i, j) = (at(a)?, at(b)?);
        super::correlation(&self.covariance, i, j)
    }
}

/// Forecasts the fit of runs without noise at the truth `beta`, sampled at `rates_hz`; `None` where they do not tell the coefficients apart.
pub(crate) fn forecast<E: Equation>(
    problem: &Problem<'_, E>,
    beta: &[f64],
    rates_hz: &[f64],
    sensors: &[Option<&SensorSpec>],
) -> Result<Option<Forecast>, TankError> {
    let sigmas: Vec<f64> = sensors.iter().map(|sensor| sensor.and_then(|s| s.noise).unwrap_or(0.0)).collect();
    let keep = |load: usize, rate_hz: f64| {
        let correlation_s = sensors[load].and_then(|s| s.correlation_s);
        correlation_s.map_or(0.0, |time| (-1.0 / (rate_hz * time)).exp())
    };
    let tau_of = |load: usize| {
        let of_rate = |rate_hz: &f64| (1.0 + keep(load, *rate_hz)) / (1.0 - keep(load, *rate_hz));
        rates_hz.iter().map(of_rate).fold(1.0, f64::max)
    };
    let taus: Vec<f64> = (0..sensors.len()).map(tau_of).collect();
    let sizes: Vec<f64> = sigmas.iter().zip(&taus).map(|(sigma, tau)| sigma * tau.sqrt()).collect();
    let (weights, zeros) = (over_first(&sizes), sensors.len());
    let (held, excluded) = (problem.held(), problem.excluded());
    let is_free = |j: &usize| !excluded.contains(j) && held.iter().all(|(k, _)| k != j);
    let free: Vec<usize> = (0..problem.names.len()).filter(is_free).collect();
    let (p, q) = (free.len(), problem.inputs.len());
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut gram, mut noise, mut errors) = (Mat::<f64>::zeros(p, p), Mat::<f64>::zeros(p, p), Mat::<f64>::zeros(p, q));
    let mut cycles = Vec::new();
    for (r, run) in problem.runs.iter().enumerate() {
        let first = run.motion.samples().start;
        let mut of_cycles = vec![Mat::<f64>::zeros(p + zeros, p + zeros); run.motion.cycles.len()];
        for (l, columns) in problem.columns(r, run.motion.samples(), beta, true)?.into_iter().enumerate() {
            let weighed = |x: &[f64]| x.iter().map(|x| weights[l] * x).collect::<Vec<f64>>();
            let raw: Vec<Vec<f64>> = free.iter().map(|&j| weighed(&columns.regressors[j])).collect();
            let moved: Vec<Vec<f64>> = columns.errors.iter().map(|x| weighed(x)).collect();
            let regressors: Vec<Vec<f64>> = raw.iter().map(|x| about_mean(x.clone())).collect();
            let keep = keep(l, rates_hz[r]);
            let smoothed: Vec<Vec<f64>> = regressors.iter().map(|x| correlated(x, keep)).collect();
            let size = weights[l] * sigmas[l];
            for i in 0..p {
                for j in 0..p {
                    gram[(i, j)] += dot(&regressors[i], &regressors[j]);
                    noise[(i, j)] += size * size * dot(&regressors[i], &smoothed[j]);
                }
                for (k, column) in moved.iter().enumerate() {
                    errors[(i, k)] += dot(&regressors[i], column);
                }
            }
            for (rows, sums) in run.motion.cycles.iter().zip(&mut of_cycles) {
                let (rows, ones) = (rows.start - first..rows.end - first, vec![weights[l]; rows.len()]);
                let column = |i: usize| raw.get(i).map_or(&ones[..], |x| &x[rows.clone()]);
                let at = |i: usize| if i < p { i } else { p + l };
                for i in 0..=p {
                    for j in 0..=p {
                        sums[(at(i), at(j))] += dot(column(i), column(j));
                    }
                }
            }
        }
        cycles.extend(of_cycles.into_iter().map(|sums| (r, sums)));
    }
    // As the fit weighs them; without noise nothing is left to weigh against what is declared.
    let variance = (0..zeros).map(|k| (weights[k] * sigmas[k]).powi(2) * taus[k]).fold(NO_NOISE, f64::max);
    let mut priors = problem.known();
    let mut whole = Mat::from_fn(p, p, |i, j| gram[(i, j)] / variance);
    for Known { prior, .. } in &mut priors {
        // What is held is no prior any more, so that each stands among the free.
        prior.index = free.iter().position(|j| *j == prior.index).unwrap_or(0);
        whole[(prior.index, prior.index)] += prior.standard.powi(-2);
    }
    let Some(inverse) = inverted(&whole) else { return Ok(None) };
    // Back among all unknowns: what is held has no uncertainty.
    let n = problem.names.len();
    let place = |j: usize| free.iter().position(|k| *k == j);
    let spread =
        |small: Mat<f64>| Mat::from_fn(n, n, |i, j| place(i).zip(place(j)).map_or(0.0, |(i, j)| small[(i, j)]));
    let scatter = &inverse * Mat::from_fn(p, p, |i, j| noise[(i, j)] / (variance * variance)) * &inverse;
    let of = |i: usize| priors.iter().map(|known| &known.prior).filter(move |prior| prior.index == i);
    let weight: Vec<f64> = (0..p).map(|i| of(i).map(|p| variance / p.standard.powi(2)).sum()).collect();
    let by_run = (problem.runs.len() >= FEWEST_CLUSTERS).then(|| of_runs(&cycles, p));
    let (clusters, at_equal) = match by_run.and_then(|runs| Some((runs.len(), at_equal_errors(&runs, &weight, p)?))) {
        Some((count, found)) => (count, Some(found)),
        // As the fit does where one run alone tells a coefficient.
        None => (cycles.len(), of_cycles(&cycles, &weight)),
    };
    let equal = clusters as f64 - 1.0;
    let dof = |j: usize| at_equal.as_ref().zip(place(j)).map_or(equal, |(found, i)| found[i].dof);
    let scatter = Part { dof: (0..n).map(dof).collect(), ..part("scatter", Kind::A, spread(scatter), equal) };
    let mut parts = vec![scatter];
    for Known { name, prior, dof, .. } in &priors {
        let by = |i: usize| inverse[(i, prior.index)] / prior.standard;
        parts.push(part(name, Kind::B, spread(Mat::from_fn(p, p, |i, j| by(i) * by(j))), *dof));
    }
    let mut moved = &inverse * Mat::from_fn(p, q, |i, k| errors[(i, k)] / variance);
    for (k, input) in problem.inputs.iter().enumerate() {
        for known in &priors {
            let by = known.sensitivity_to(k) * input.declared.standard / known.prior.standard.powi(2);
            (0..p).for_each(|i| moved[(i, k)] += inverse[(i, known.prior.index)] * by);
        }
        let covariance = Mat::from_fn(p, p, |i, j| moved[(i, k)] * moved[(j, k)]);
        parts.push(part(&input.name, Kind::B, spread(covariance), input.declared.dof));
    }
    let of = problem.names.iter().zip(beta).enumerate();
    let expected = of.map(|(j, ((name, unit), value))| Expected::of(&problem.law, (name, unit), *value, &parts, j));
    Ok(Some(Forecast {
        expected: expected.collect(),
        covariance: total(&parts, n),
        cycles: problem.runs.iter().map(|run| run.motion.whole).collect(),
    }))
}

/// Covariance of the coefficients from all parts.
pub(crate) fn total(parts: &[Part], n: usize) -> Mat<f64> {
    Mat::from_fn(n, n, |i, j| parts.iter().map(|part| part.covariance[(i, j)]).sum())
}

/// Normal matrix of each run with its zeros eliminated, from those of its cycles: each has its run's number and, at the end, a column of ones for each load.
fn of_runs(cycles: &[(usize, Mat<f64>)], p: usize) -> Vec<Mat<f64>> {
    let of_run = |cycles: &[(usize, Mat<f64>)]| {
        let sum = |i: usize, j: usize| cycles.iter().map(|(_, k)| k[(i, j)]).sum::<f64>();
        let zeros = || p..cycles[0].1.nrows();
        Mat::from_fn(p, p, |i, j| sum(i, j) - zeros().map(|z| sum(i, z) * sum(z, j) / sum(z, z)).sum::<f64>())
    };
    cycles.chunk_by(|(a, _), (b, _)| a == b).map(of_run).collect()
}

/// CR3 by cycles at equal errors: each run's zero is a column beside.
fn of_cycles(cycles: &[(usize, Mat<f64>)], weight: &[f64]) -> Option<Vec<AtEqualErrors>> {
    let p = weight.len();
    let (last, sums) = cycles.last()?;
    let zeros = sums.nrows() - p;
    let all = (last + 1) * zeros;
    let placed = |(r, k): &(usize, Mat<f64>)| {
        let of_run = p + r * zeros..p + (r + 1) * zeros;
        let at = |i: usize| if i < p { Some(i) } else { of_run.contains(&i).then(|| p + i - of_run.start) };
        Mat::from_fn(p + all, p + all, |i, j| at(i).zip(at(j)).map_or(0.0, |(i, j)| k[(i, j)]))
    };
    let grams: Vec<Mat<f64>> = cycles.iter().map(placed).collect();
    at_equal_errors(&grams, &[weight, &vec![0.0; all]].concat(), p)
}

fn about_mean(mut column: Vec<f64>) -> Vec<f64> {
    let mean = column.iter().sum::<f64>() / column.len() as f64;
    for x in &mut column {
        *x -= mean;
    }
    column
}
