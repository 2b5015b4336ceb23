//! Prediction of what was not fitted: the check that no in-sample figure replaces.

use crate::servo::error::ServoError;
use crate::servo::regression::least_squares;
use crate::servo::rows::{Rows, norm};

/// One choice of periods.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// Periods fitted, from 0.
    pub fitted: Vec<usize>,
    /// Periods predicted.
    pub predicted: Vec<usize>,
    /// `‖force − prediction‖/‖force‖` over the predicted periods.
    pub relative_error: f64,
}

/// Fits half of the whole periods of a record and predicts the other half, for every choice of halves.
///
/// # Errors
///
/// [`ServoError::TooFewRows`] for fewer than two whole periods; [`ServoError::Setting`] for a period that is not positive, or
/// so short that there are more than twelve.
pub fn halves(rows: &Rows, period_s: f64) -> Result<Vec<HeldOut>, ServoError> {
    let last_s = rows.time_s.last().copied().unwrap_or(0.0);
    let start_s = rows.time_s.first().copied().unwrap_or(0.0);
    // Trimmed ends belong to the first and the last period.
    let count = ((last_s - start_s) / period_s).round();
    if !(2.0..=12.0).contains(&count) {
        let must = "the record must hold two to twelve periods";
        return Err(ServoError::Setting { what: "period (s)", found: period_s, must });
    }
    let count = count as usize;
    let span = |k: &usize| {
        let from_s = if *k == 0 { f64::NEG_INFINITY } else { *k as f64 * period_s };
        [from_s, (k + 1) as f64 * period_s]
    };
    let mut out = Vec::new();
    for choice in 0_usize..1 << count {
        if choice.count_ones() as usize != count / 2 {
            continue;
        }
        let (fitted, predicted): (Vec<usize>, Vec<usize>) = (0..count).partition(|k| choice >> k & 1 == 1);
        let spans = |periods: &[usize]| periods.iter().map(span).collect::<Vec<_>>();
        let solution = least_squares(&rows.within(&spans(&fitted)))?;
        let others = rows.within(&spans(&predicted));
        let relative_error = norm(&others.residuals_n(&solution.coefficients)) / norm(&others.force_n);
        out.push(HeldOut { fitted, predicted, relative_error });
    }
    Ok(out)
}
