//! Gauss–Newton with Levenberg's damping for residuals that come out of a simulation.
//!
//! Every step is a linear least-squares fit by `froude-fit`, of the residuals on their derivatives, with a row per
//! parameter that holds it where it is. Derivatives are central differences.
//!
//! Of the two-mass model alone, whose sum of squares is rough where friction reverses. On 30 logs `froude_fit::nonlinear` ends up to 0.034 of an
//! interval from here (on a twin's pulses 7e-4), takes twice as long and stalls once; rounding in the observer moves the end by up to 0.005.
//!
//! # Source
//!
//! Moré (1978), *The Levenberg–Marquardt algorithm: implementation and theory*, Lecture Notes in Mathematics 630, 105.

use froude_fit::{End, Report};

use crate::servo::error::ServoError;
use crate::servo::regression::solve;

/// Most steps.
const STEPS: usize = 50;
/// Converged when no parameter moves by more than this part of its scale.
const STEP_TOLERANCE: f64 = 1e-7;
/// Or when a nearly undamped step moves the model by less than this part of a standard deviation (Bates & Watts 1981,
/// Technometrics 23, 179: the relative offset).
const OFFSET_TOLERANCE: f64 = 0.02;
/// Damping below which a step counts as undamped.
const NEARLY_UNDAMPED: f64 = 1e-2;
/// Or when the sum of squares falls by less than this part: with 2,000 rows, 0.04 of a standard deviation.
const SUM_TOLERANCE: f64 = 1e-6;

/// Step of the differences, as a part of a scale: small against it, large against the kinks that reversals put into a simulation.
pub(crate) const DIFFERENCE: f64 = 1e-3;

/// Where the iteration ended.
pub(crate) struct Fitted {
    /// Parameters.
    pub parameters: Vec<f64>,
    /// Residuals there.
    pub residuals: Vec<f64>,
    /// `−∂residual/∂parameter`, a column per parameter: the regressors of the linearised model.
    pub columns: Vec<Vec<f64>>,
    /// How it ended.
    pub report: Report,
}

/// Minimises the sum of squared residuals from a start; `scale` is a natural step of each parameter.
pub(crate) fn minimise(
    start: &[f64],
    scale: &[f64],
    residuals: impl Fn(&[f64]) -> Result<Vec<f64>, ServoError>,
) -> Result<Fitted, ServoError> {
    let squares = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
    let mut parameters = start.to_vec();
    let mut here = residuals(&parameters)?;
    let mut sum = squares(&here);
    let mut damping = 1e-3;
    let mut end = End::IterationLimit;
    let mut iterations = 0;
    let mut columns = derivatives(&parameters, scale, &residuals)?;
    while iterations < STEPS {
        iterations += 1;
        let step = damped_step(&columns, scale, &here, damping)?;
        if damping <= NEARLY_UNDAMPED && offset(&columns, &step, here.len(), sum) <= OFFSET_TOLERANCE {
            end = End::Converged;
            break;
        }
        let trial: Vec<f64> = parameters.iter().zip(&step).map(|(p, s)| p + s).collect();
        let is_small = step.iter().zip(scale).all(|(s, scale)| s.abs() <= STEP_TOLERANCE * scale);
        // A step into the impossible counts as one that does not help.
        let there = residuals(&trial).ok();
        match there.map(|r| (squares(&r), r)) {
            Some((new, r)) if new < sum => {
                let is_flat = sum - new <= SUM_TOLERANCE * sum;
                (parameters, here, sum) = (trial, r, new);
                damping = (damping * 0.1_f64).max(1e-12);
                columns = derivatives(&parameters, scale, &residuals)?;
                if is_small || is_flat {
                    end = End::Converged;
                    break;
                }
            }
            _ if is_small => {
                end = End::Converged;
                break;
            }
            _ if damping > 1e8 => {
                end = End::Stalled;
                break;
            }
            _ => damping *= 10.0,
        }
    }
    Ok(Fitted { parameters, residuals: here, columns, report: Report { end, iterations } })
}

/// What a step moves the model by, in standard deviations of a coefficient.
fn offset(columns: &[Vec<f64>], step: &[f64], rows: usize, sum: f64) -> f64 {
    let moved = |i: usize| columns.iter().zip(step).map(|(c, s)| c[i] * s).sum::<f64>();
    let squares: f64 = (0..rows).map(|i| moved(i).powi(2)).sum();
    let p = step.len() as f64;
    (squares / p / (sum / (rows as f64 - p))).sqrt()
}

fn damped_step(columns: &[Vec<f64>], scale: &[f64], residuals: &[f64], damping: f64) -> Result<Vec<f64>, ServoError> {
    let p = columns.len();
    let mut response = residuals.to_vec();
    response.extend(std::iter::repeat_n(0.0, p));
    let damped: Vec<Vec<f64>> = (columns.iter().zip(scale).enumerate())
        .map(|(j, (column, scale))| {
            let size = column.iter().map(|c| c * c).sum::<f64>().sqrt().max(f64::MIN_POSITIVE / scale);
            let mut out = column.clone();
            out.extend((0..p).map(|k| if k == j { damping.sqrt() * size } else { 0.0 }));
            out
        })
        .collect();
    Ok(solve(&damped, &response)?.coefficients)
}

fn derivatives(
    parameters: &[f64],
    scale: &[f64],
    residuals: &impl Fn(&[f64]) -> Result<Vec<f64>, ServoError>,
) -> Result<Vec<Vec<f64>>, ServoError> {
    (0..parameters.len())
        .map(|j| {
            let step = DIFFERENCE * scale[j];
            let moved = |by: f64| {
                let mut p = parameters.to_vec();
                p[j] += by;
                residuals(&p)
            };
            let (up, down) = (moved(step)?, moved(-step)?);
            Ok(up.iter().zip(&down).map(|(u, d)| (d - u) / (2.0 * step)).collect())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exponential_without_noise_is_found_to_the_last_digits() {
        let model = |p: &[f64]| {
            Ok((0..40).map(|i| 3.0 * (-0.1 * f64::from(i)).exp() - p[0] * (-p[1] * f64::from(i)).exp()).collect())
        };
        let fitted = minimise(&[1.0, 0.3], &[1.0, 0.1], model).unwrap();
        assert!((fitted.parameters[0] - 3.0).abs() < 1e-8 && (fitted.parameters[1] - 0.1).abs() < 1e-9);
        assert_eq!(fitted.report.end, End::Converged);
    }
}
