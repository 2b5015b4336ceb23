//! Central differences.

use crate::error::{SignalError, in_range, positive};

/// Derivative by central differences, one-sided at both ends (as `numpy.gradient`).
///
/// Error `h²x‴/6` inside, `hx″/2` at the two ends. White noise of σ on the record becomes σ/(√2 h): filter before.
///
/// # Errors
///
/// [`SignalError::OutOfRange`] for fewer than two samples, [`SignalError::NotPositive`] for the step.
pub fn central(record: &[f64], step_s: f64) -> Result<Vec<f64>, SignalError> {
    let n = in_range("number of samples to be differentiated", record.len(), 2, usize::MAX)?;
    let half = 0.5 / positive("time step (s)", step_s)?;
    let mut out = Vec::with_capacity(n);
    out.push((record[1] - record[0]) * 2.0 * half);
    out.extend(record.windows(3).map(|w| (w[2] - w[0]) * half));
    out.push((record[n - 1] - record[n - 2]) * 2.0 * half);
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_differentiated_exactly_inside() {
        let x: Vec<f64> = (0..9).map(|i| f64::from(i * i)).collect();
        assert_eq!(central(&x, 1.0).unwrap(), [1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 15.0]);
    }
}
