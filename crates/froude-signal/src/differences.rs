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

/// Second derivative by `(x₊ − 2x + x₋)/h²`; both ends take the value of their neighbour.
///
/// Error `h²x⁗/12` inside. The result is the mean of the second derivative over two steps with triangular weights: if the acceleration is constant over each step, it is exactly the mean of those before and
/// after the sample.
///
/// # Errors
///
/// [`SignalError::OutOfRange`] for fewer than three samples, [`SignalError::NotPositive`] for the step.
pub fn second(record: &[f64], step_s: f64) -> Result<Vec<f64>, SignalError> {
    let n = in_range("number of samples to be differentiated twice", record.len(), 3, usize::MAX)?;
    let square = positive("time step (s)", step_s)?.powi(2);
    let mut out = Vec::with_capacity(n);
    out.push(0.0);
    out.extend(record.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]) / square));
    out.push(out[n - 2]);
    out[0] = out[1];
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_differentiated_exactly_inside() {
        let x: Vec<f64> = (0..9).map(|i| f64::from(i * i)).collect();
        assert_eq!(central(&x, 1.0).unwrap(), [1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 15.0]);
        assert_eq!(second(&x, 1.0).unwrap(), [2.0; 9]);
    }
}
