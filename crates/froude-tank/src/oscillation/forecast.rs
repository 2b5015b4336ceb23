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
use froude_fit::budget::{Combined, Kind, OUTSIDE_95, Part, Shape, combine};
use froude_fit::faer::Mat;
use froude_fit::faer::prelude::*;
use froude_records::campaign::{Identify, SensorSpec};

use super::error::OscillationError;
use super::fit::{Columns, Input, Joint};
use super::forces::{Drag, LOAD};
use super::setup::{OscillationRun, Setup};
use super::simulate::{Planned, Truths, simulated};
use super::{Motion, motions};

/// A coefficient with the interval to expect.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// Its name.
    pub name: String,
    /// SI unit text.
    pub unit: String,
    /// The truth that it was computed at.
    pub value: f64,
    /// Standard uncertainty and interval.
    pub combined: Combined,
    /// Each error's part in the standard uncertainty, in the order of [`Forecast::parts`].
    pub by_part: Vec<f64>,
}

/// What a plan will determine.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// The coefficients.
    pub expected: Vec<Expected>,
    /// Names of the errors.
    pub parts: Vec<String>,
    /// Whole cycles used of each run.
    pub cycles: Vec<usize>,
}

/// Forecasts the fit of `drag` to the planned runs.
///
/// # Errors
///
/// [`OscillationError`]: runs too short for their cycles, coefficients that the plan does not determine.
pub fn forecast(
    planned: &[Planned],
    setup: &Setup,
    truth: &Truths,
    drag: &Drag,
    sensors: &[SensorSpec],
    identify: &Identify,
) -> Result<Forecast, OscillationError> {
    let exact = exactly(setup);
    let logged = simulated(planned, &exact, truth, &[], 0);
    let runs: Vec<OscillationRun<'_>> = logged.iter().map(super::simulate::Simulated::view).collect();
    let motions: Vec<Motion> = motions(&runs, setup)?;
    let joint = Joint::new(&runs, &motions, setup, drag, identify);
    let beta = true_values(&joint, setup, truth);
    let inputs = Input::all(setup, &runs);
    let of_force = sensors.iter().find(|s| ["force", LOAD].contains(&s.quantity.as_str()));
    let sigma = of_force.and_then(|s| s.noise).unwrap_or(0.0);
    let correlation_s = of_force.and_then(|s| s.correlation_s);
    let (p, q) = (joint.names.len(), inputs.len());
    let (mut gram, mut noise, mut errors) = (Mat::<f64>::zeros(p, p), Mat::<f64>::zeros(p, p), Mat::<f64>::zeros(p, q));
    let mut tau = 1.0_f64;
    for (r, motion) in motions.iter().enumerate() {
        let Columns { regressors, errors: moved, .. } = joint.columns(r, motion.samples(), &beta, &inputs)?;
        let regressors: Vec<Vec<f64>> = regressors.into_iter().map(about_mean).collect();
        let keep = correlation_s.map_or(0.0, |time| (-1.0 / (planned[r].rate_hz * time)).exp());
        tau = tau.max((1.0 + keep) / (1.0 - keep));
        let smoothed: Vec<Vec<f64>> = regressors.iter().map(|x| correlated(x, keep)).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for i in 0..p {
            for j in 0..p {
                gram[(i, j)] += dot(&regressors[i], &regressors[j]);
                noise[(i, j)] += sigma * sigma * dot(&regressors[i], &smoothed[j]);
            }
            for (k, column) in moved.iter().enumerate() {
                errors[(i, k)] += dot(&regressors[i], column);
            }
        }
    }
    // As the fit weighs them; without noise nothing is left to weigh against what is declared.
    let variance = (sigma * sigma * tau).max(f64::MIN_POSITIVE);
    let priors = joint.priors();
    let mut whole = Mat::from_fn(p, p, |i, j| gram[(i, j)] / variance);
    for (_, prior) in &priors {
        whole[(prior.index, prior.index)] += prior.standard.powi(-2);
    }
    let inverse = inverted(&whole).ok_or_else(|| OscillationError::Law {
        model: drag.law.name.clone(),
        why: "has coefficients that the planned runs do not tell apart: plan a second frequency, a second configuration for terms of head and tail, or declare the buoyancy".to_owned(),
    })?;
    let clusters =
        if runs.len() >= FEWEST_CLUSTERS { runs.len() } else { motions.iter().map(|m| m.cycles.len()).sum() };
    let scatter = &inverse * Mat::from_fn(p, p, |i, j| noise[(i, j)] / (variance * variance)) * &inverse;
    let mut parts = vec![part("scatter", Kind::A, scatter, clusters as f64 - 1.0)];
    for (name, prior) in &priors {
        let by = |i: usize| inverse[(i, prior.index)] / prior.standard;
        parts.push(part(name, Kind::B, Mat::from_fn(p, p, |i, j| by(i) * by(j)), f64::INFINITY));
    }
    let moved = &inverse * Mat::from_fn(p, q, |i, k| errors[(i, k)] / variance);
    for (k, input) in inputs.iter().enumerate() {
        let covariance = Mat::from_fn(p, p, |i, j| moved[(i, k)] * moved[(j, k)]);
        parts.push(part(&input.name(setup), Kind::B, covariance, input.dof(setup)));
    }
    let expected = joint.names.iter().enumerate().map(|(j, (name, unit))| Expected {
        name: name.clone(),
        unit: unit.clone(),
        value: beta[j],
        combined: combine(&parts, j, OUTSIDE_95),
        by_part: parts.iter().map(|part| part.standard(j)).collect(),
    });
    Ok(Forecast {
        expected: expected.collect(),
        parts: parts.iter().map(|part| part.name.clone()).collect(),
        cycles: motions.iter().map(|m| m.whole).collect(),
    })
}

/// Everything as declared, without errors: what the plan is linearised at.
fn exactly(setup: &Setup) -> Setup {
    let exact = |u: froude_fit::budget::Uncertain| froude_fit::budget::Uncertain::new(u.value, 0.0);
    let bodies = setup.bodies.iter().map(|body| super::Body {
        mass_kg: exact(body.mass_kg),
        buoyancy_n: body.buoyancy_n.map(exact),
        ..body.clone()
    });
    Setup {
        radius_m: exact(setup.radius_m),
        density_kg_m3: exact(setup.density_kg_m3),
        flow_relative: 0.0,
        angle_relative: 0.0,
        force_relative: 0.0,
        delay_s: setup.delay_s.map(exact),
        bodies: bodies.collect(),
        ..setup.clone()
    }
}

/// The truth in the order of the fit's coefficients.
fn true_values(joint: &Joint<'_>, setup: &Setup, truth: &Truths) -> Vec<f64> {
    let mut out: Vec<f64> =
        joint.names.iter().map(|(name, _)| truth.law.position(name).map_or(0.0, |j| truth.drag[j])).collect();
    out[0] = truth.added;
    for (i, body) in setup.bodies.iter().enumerate() {
        let buoyancy = truth.buoyancy_n[i].or_else(|| body.buoyancy_n.map(|b| b.value));
        if let Some(j) = joint.buoyancy[i] {
            out[j] = buoyancy.unwrap_or(0.0);
        }
        if let Some(j) = joint.mass[i] {
            out[j] = body.mass_kg.value;
        }
    }
    if let Some(j) = joint.delay {
        out[j] = truth.delay_s.or_else(|| setup.delay_s.map(|d| d.value)).unwrap_or(0.0);
    }
    out
}

pub(crate) fn part(name: &str, kind: Kind, covariance: Mat<f64>, dof: f64) -> Part {
    let p = covariance.nrows();
    Part {
        name: name.to_owned(),
        shared: "campaign",
        kind,
        covariance,
        dof: vec![dof; p],
        shape: Shape::Normal,
        in_scatter: false,
        origin: None,
    }
}

fn about_mean(mut column: Vec<f64>) -> Vec<f64> {
    let mean = column.iter().sum::<f64>() / column.len() as f64;
    for x in &mut column {
        *x -= mean;
    }
    column
}

/// Σ_j keep^|i−j| x_j, by one pass forward and one backward.
pub(crate) fn correlated(x: &[f64], keep: f64) -> Vec<f64> {
    let mut out = Vec::with_capacity(x.len());
    let mut sum = 0.0;
    for value in x {
        sum = sum * keep + value;
        out.push(sum);
    }
    sum = 0.0;
    for (value, out) in x.iter().zip(&mut out).rev() {
        *out += sum;
        sum = (sum + value) * keep;
    }
    out
}

/// The inverse of a symmetric positive matrix, its diagonal scaled to one first; `None` where it has none.
pub(crate) fn inverted(matrix: &Mat<f64>) -> Option<Mat<f64>> {
    let p = matrix.nrows();
    let scale: Vec<f64> = (0..p).map(|i| matrix[(i, i)].sqrt()).collect();
    if scale.iter().any(|s| !(*s > 0.0 && s.is_finite())) {
        return None;
    }
    let scaled = Mat::from_fn(p, p, |i, j| matrix[(i, j)] / (scale[i] * scale[j]));
    let least = scaled.self_adjoint_eigenvalues(froude_fit::faer::Side::Lower).ok()?.first().copied()?;
    if least < 1e-12 {
        return None;
    }
    let inverse = scaled.llt(froude_fit::faer::Side::Lower).ok()?.solve(Mat::<f64>::identity(p, p));
    Some(Mat::from_fn(p, p, |i, j| inverse[(i, j)] / (scale[i] * scale[j])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_passes_are_the_sum_over_all_samples() {
        let x: Vec<f64> = (0..40).map(|i| f64::from(i * i % 13) - 6.0).collect();
        let keep = 0.7_f64;
        for (i, fast) in correlated(&x, keep).into_iter().enumerate() {
            let slow: f64 = x.iter().enumerate().map(|(j, x)| keep.powi((i as i32 - j as i32).abs()) * x).sum();
            // Forty terms of some ten, each rounded.
            assert!((fast - slow).abs() < 1e-12, "{i}");
        }
    }
}
