//! The linearised fit of planned runs.
//!
//! With X the regressors of a load at the truth and S the variances of its rows,
//!
//! C = (XᵀX)⁻¹ Xᵀ S X (XᵀX)⁻¹ + Σ_e (XᵀX)⁻¹ Xᵀ J_e s_e² J_eᵀ X (XᵀX)⁻¹
//!
//! over the declared errors e that all runs share; what each run has for itself goes into S.
//!
//! **Source.** As [`crate::driven::forecast`].

use froude_fit::budget::Kind;
use froude_fit::faer::Mat;
use froude_identify::method::MethodError;
use froude_records::campaign::{BudgetEntry, SensorSpec, Shared};

use super::settings::{Plan, loads_at};
use crate::error::undeclared;
use crate::inverted::inverted;
use crate::joint::part;
use crate::plan::Expected;

/// What a taper over a window costs in independent samples ([`froude_fit::series`]).
const TAPER_COST: f64 = 0.6875 / 0.5625;
/// Step of differences by speed and angle, as part of the standard uncertainty.
const STEP: f64 = 1e-3;

/// An error that all runs share, in a plan: what it moves each load of each run by, in the order of the law's responses.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedError {
    /// Its name.
    pub name: String,
    /// Degrees of freedom of its standard uncertainty.
    pub dof: f64,
    /// By response, by run, N or N m.
    pub moves: Vec<Vec<f64>>,
}

/// What a budget does to a plan: the errors that all runs share, and the variances that each run has for itself, by response.
///
/// # Errors
///
/// A law that cannot be evaluated.
pub(crate) fn declared(plan: &Plan, budget: &[BudgetEntry]) -> Result<(Vec<PlannedError>, Vec<Vec<f64>>), MethodError> {
    let truth = plan.law.predict(&plan.data, &plan.values)?;
    let n_r = plan.law.responses.len();
    let mut rows = vec![vec![0.0; plan.data.rows]; n_r];
    let mut errors = Vec::new();
    for entry in budget {
        let moves: Vec<Vec<f64>> =
            (0..n_r).map(|r| direction(plan, entry, r, &truth).unwrap_or_else(|| vec![0.0; plan.data.rows])).collect();
        if entry.shared == Shared::Campaign {
            let name = entry.name.clone().unwrap_or_else(|| entry.quantity.clone());
            errors.push(PlannedError { name, dof: entry.dof.unwrap_or(f64::INFINITY), moves });
        } else {
            for (row, moved) in rows.iter_mut().flatten().zip(moves.iter().flatten()) {
                *row += moved * moved;
            }
        }
    }
    Ok((errors, rows))
}

/// Linear propagation at the truth; `variance` is that of a response in a run. Weighted by those variances where `is_weighted`, as a fit that knows
/// them does.
///
/// # Errors
///
/// Coefficients that the plan does not determine.
pub(crate) fn linearised(
    plan: &Plan,
    variance: &dyn Fn(usize, usize) -> f64,
    errors: &[PlannedError],
    is_weighted: bool,
) -> Result<Vec<Expected>, MethodError> {
    let (n, p) = (plan.data.rows, plan.law.coefficients.len());
    let x = plan.law.regressors(&plan.data, &plan.values)?;
    let mut out: Vec<Option<Expected>> = vec![None; p];
    for (r, response) in plan.law.responses.iter().enumerate() {
        let own: Vec<usize> = (0..p).filter(|&j| (0..n).any(|i| x[(r * n + i, j)] != 0.0)).collect();
        let q = own.len();
        let variances: Vec<f64> = (0..n).map(|i| variance(r, i)).collect();
        let weight = |i: usize| if is_weighted && variances[i] > 0.0 { 1.0 / variances[i] } else { 1.0 };
        let design = Mat::from_fn(n, q, |i, j| x[(r * n + i, own[j])]);
        let weighed = Mat::from_fn(n, q, |i, j| weight(i) * design[(i, j)]);
        let gram = design.transpose() * &weighed;
        let undetermined = || {
            let what = format!(
                "the planned runs do not tell the coefficients of {response} apart in {}: plan more speeds, angles or configurations, or another law",
                plan.law.name
            );
            undeclared("", what)
        };
        let inverse = inverted(&gram).ok_or_else(undetermined)?;
        let spread = Mat::from_fn(n, q, |i, j| variances[i] * weight(i) * design[(i, j)]);
        let scatter = &inverse * (weighed.transpose() * spread) * &inverse;
        let mut parts = vec![part("scatter", Kind::A, scatter, (n as f64 - q as f64).max(1.0))];
        for error in errors {
            let moves = Mat::from_fn(n, 1, |i, _| error.moves[r][i]);
            let moved = &inverse * (weighed.transpose() * moves);
            let covariance = Mat::from_fn(q, q, |i, j| moved[(i, 0)] * moved[(j, 0)]);
            parts.push(part(&error.name, Kind::B, covariance, error.dof));
        }
        for (at, &j) in own.iter().enumerate() {
            let c = &plan.law.coefficients[j];
            out[j] = Some(Expected::of(&plan.law.name, (&c.name, &c.unit), plan.values[j], &parts, at));
        }
    }
    Ok(out.into_iter().flatten().collect())
}

/// Variance of the observation of a load: of its mean over the window and of the line between the parts at rest at its middle.
pub(crate) fn variance(sensors: &[SensorSpec], load: &str, [window_s, still_s]: [f64; 2], step_s: f64) -> f64 {
    let Some(sensor) = sensors.iter().find(|s| s.quantity == load) else { return 0.0 };
    let keep = sensor.correlation_s.map_or(0.0, |time| (-step_s / time).exp());
    // Samples lie so far apart as if they were independent.
    let apart_s = step_s * (1.0 + keep) / (1.0 - keep);
    let resolution = sensor.resolution.unwrap_or(0.0).powi(2) / 12.0 * step_s / window_s;
    let noise = sensor.noise.unwrap_or(0.0).powi(2) * apart_s * TAPER_COST;
    noise / window_s + 0.5 * noise / still_s + resolution
}

/// What an error of one standard uncertainty does to a load, in each row; `None` where it does nothing to it.
fn direction(plan: &Plan, entry: &BudgetEntry, r: usize, truth: &[f64]) -> Option<Vec<f64>> {
    let n = plan.data.rows;
    let own = &truth[r * n..(r + 1) * n];
    if entry.quantity == plan.law.responses[r] {
        return Some(own.iter().map(|f| if entry.relative { entry.standard * f } else { entry.standard }).collect());
    }
    if entry.quantity == "density" {
        let part = |i: usize| {
            let rho = plan.data.values("density").map_or(f64::NAN, |d| d[i]);
            if entry.relative { entry.standard } else { entry.standard / rho }
        };
        // Loads of the water are proportional to it.
        return Some((0..n).map(|i| -part(i) * own[i]).collect());
    }
    let is_speed = entry.quantity == "speed";
    if !is_speed && entry.quantity != "angle" {
        return None;
    }
    let value = |name: &str, i: usize| plan.data.values(name).map_or(0.0, |v| v[i]);
    let one = |i: usize| {
        let (speed, angle) = (value("speed", i), value("angle", i));
        let at = if is_speed { speed } else { angle };
        let standard = if entry.relative { entry.standard * at.abs() } else { entry.standard };
        let load = |by: f64| {
            let (u, a) = if is_speed { (speed + by, angle) } else { (speed, angle + by) };
            loads_at(plan, i, u, a)[r]
        };
        let h = STEP * standard;
        // What is fitted is taken at q + e, what was there was made by q.
        if h > 0.0 { -(load(h) - load(-h)) / (2.0 * STEP) } else { 0.0 }
    };
    Some((0..n).map(one).collect())
}
