//! The interval of one parameter from the sum of squares itself: all others minimised, the parameter moved until it is too large.

use super::covariance::check_confidence;
use super::error::NonlinearError;
use super::{Scatter, Solution, minimise};
use crate::distribution::coverage_factor;
use crate::nonlinear::model::{Model, Parameter};

/// An end is found when the profile is within this part of its threshold: the interval is then off by about this part of its half-width.
const END_TOLERANCE: f64 = 1e-5;
/// An end further out than this many doublings of the linear one is open.
const DOUBLINGS: usize = 40;
/// Most steps between two brackets.
const REFINEMENTS: usize = 100;
/// A fall below the solution's sum of squares by this many σ² is more than rounding.
const FALL: f64 = 1e-4;

/// The interval of one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// Its ends, in the parameter's unit; infinite where the data set none.
    pub interval: [f64; 2],
    /// Whether an end is the parameter's bound, or infinite, and not set by the data.
    pub is_open: [bool; 2],
}

/// Where the other parameters are minimised with one held, in standard deviations from the solution.
struct Held {
    at: f64,
    distance: f64,
    theta: Vec<f64>,
}

/// Interval of a parameter, shared or of one run, that holds however curved the model is along it.
///
/// Its ends are where the sum of squares, minimised over all other parameters, exceeds the least one by `σ̂² F(1, ν)`. Exact up to the
/// curvature across the solution that no change of parameters removes (small in practice); it supposes independent normal residuals of one width,
/// so a time series has to be thinned or whitened first. Each end costs several fits.
///
/// # Errors
///
/// [`NonlinearError`] without degrees of freedom, for a parameter that does not exist, or where a point of the profile lies below the solution.
///
/// # Source
///
/// Bates & Watts (1988), *Nonlinear Regression Analysis and Its Applications*, 6.1.
pub fn profile_interval(
    model: &dyn Model,
    solution: &Solution,
    parameter: usize,
    confidence: f64,
) -> Result<Profile, NonlinearError> {
    let chosen = solution.named(parameter)?;
    check_confidence(confidence)?;
    // Also refuses a fit without degrees of freedom.
    let linear = solution.covariance(Scatter::Independent)?;
    let threshold = coverage_factor(confidence, solution.dof as f64);
    let first = linear.standard(parameter).filter(|s| *s > 0.0).map_or(chosen.scale, |s| s * threshold);
    let mut out = Profile { interval: [0.0; 2], is_open: [false; 2] };
    for (side, sign) in [(0, -1.0), (1, 1.0)] {
        let bound = if side == 0 { chosen.lower } else { chosen.upper };
        let end = end_of(model, solution, parameter, threshold, sign * first, bound)?;
        out.is_open[side] = end.is_none();
        out.interval[side] = end.unwrap_or(bound);
    }
    Ok(out)
}

/// One end; `None` where the bound comes first, or nothing does.
fn end_of(
    model: &dyn Model,
    solution: &Solution,
    parameter: usize,
    threshold: f64,
    mut step: f64,
    bound: f64,
) -> Result<Option<f64>, NonlinearError> {
    let start = solution.values[parameter];
    let mut inside = Held { at: start, distance: 0.0, theta: solution.values.clone() };
    if start == bound {
        return Ok(None);
    }
    let mut outside = None;
    for _ in 0..DOUBLINGS {
        let at = if step > 0.0 { (start + step).min(bound) } else { (start + step).max(bound) };
        let held = hold(model, solution, parameter, at, &inside.theta)?;
        if held.distance >= threshold {
            outside = Some(held);
            break;
        }
        if at == bound || !at.is_finite() {
            return Ok(None);
        }
        (inside, step) = (held, 2.0 * step);
    }
    let Some(mut outside) = outside else {
        return Ok(None);
    };
    // False position, its lingering end halved (Illinois); the distance is nearly straight.
    let (mut low, mut high) = (inside.distance - threshold, outside.distance - threshold);
    for _ in 0..REFINEMENTS {
        let share = if high.is_finite() { low / (low - high) } else { 0.5 };
        let at = inside.at + share * (outside.at - inside.at);
        if at == inside.at || at == outside.at {
            break;
        }
        let held = hold(model, solution, parameter, at, &inside.theta)?;
        let excess = held.distance - threshold;
        if excess.abs() <= END_TOLERANCE * threshold {
            return Ok(Some(at));
        }
        if excess < 0.0 {
            (inside, low, high) = (held, excess, 0.5 * high);
        } else {
            (outside, high, low) = (held, excess, 0.5 * low);
        }
    }
    Ok(Some(outside.at))
}

/// Minimises with one parameter held; infinitely far where the model is impossible.
fn hold(
    model: &dyn Model,
    solution: &Solution,
    parameter: usize,
    at: f64,
    from: &[f64],
) -> Result<Held, NonlinearError> {
    let parameters: Vec<Parameter> = (solution.parameters.iter().zip(from).enumerate())
        .map(|(j, (p, &start))| {
            let p = Parameter { start, ..p.clone() };
            if j == parameter { Parameter { start: at, ..p }.within(at, at) } else { p }
        })
        .collect();
    let held = match minimise(model, &parameters, &solution.settings) {
        Ok(held) => held,
        Err(
            NonlinearError::Impossible { .. }
            | NonlinearError::ResidualNotFinite { .. }
            | NonlinearError::NoDerivative { .. }
            | NonlinearError::Number { .. },
        ) => return Ok(Held { at, distance: f64::INFINITY, theta: from.to_vec() }),
        Err(error) => return Err(error),
    };
    let expected = solution.sum_of_squares;
    let squared = (held.sum_of_squares - expected) / expected.max(f64::MIN_POSITIVE) * solution.dof as f64;
    if squared < -FALL {
        let name = solution.parameters[parameter].name.clone();
        return Err(NonlinearError::NotTheMinimum { name, value: at, found: held.sum_of_squares, expected });
    }
    Ok(Held { at, distance: squared.max(0.0).sqrt(), theta: held.values })
}
