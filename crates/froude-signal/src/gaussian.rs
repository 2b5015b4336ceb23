//! Smoothing by a Gaussian.
//!
//! The weights are `exp(−k²/2σ²)` cut at 4σ and scaled to sum 1; the record is mirrored at its ends, the end
//! sample twice (`d c b a | a b c d | d c b a`).
//!
//! # Source
//!
//! Conventions of `scipy.ndimage.gaussian_filter1d` (its defaults `truncate=4`, `mode="reflect"`). The smoothing
//! "by a Gaussian curve" of the carriage paper states neither width nor ends.

use crate::convolve::{Parity, convolve};
use crate::error::{SignalError, all_finite, in_range, positive};

/// Standard deviations at which the weights are cut.
const TRUNCATE: f64 = 4.0;

/// Widest smoothing, samples.
const WIDEST: f64 = 1e5;

/// Smooths a record by a Gaussian of standard deviation `sigma_samples`.
///
/// A tone of frequency f at rate f_s is left with `exp(−½(2πσf/f_s)²)` of its amplitude.
///
/// # Errors
///
/// [`SignalError::NotPositive`] or [`SignalError::OutOfRange`] for the width; [`SignalError::NotFinite`].
pub fn smooth(record: &[f64], sigma_samples: f64) -> Result<Vec<f64>, SignalError> {
    let weights = weights(sigma_samples)?;
    convolve(&weights, Parity::Even, |i| mirrored(record, i), record)
}

/// As [`smooth`], written as its definition: the yardstick of the fast one.
///
/// # Errors
///
/// As [`smooth`].
pub fn smooth_reference(record: &[f64], sigma_samples: f64) -> Result<Vec<f64>, SignalError> {
    let weights = weights(sigma_samples)?;
    all_finite(record)?;
    let radius = (weights.len() / 2) as isize;
    let at = |i: isize| (weights.iter().zip(-radius..)).map(|(w, k)| w * mirrored(record, i + k)).sum();
    Ok((0..record.len() as isize).map(at).collect())
}

/// The weights, `2⌊4σ + ½⌋ + 1` of them.
fn weights(sigma_samples: f64) -> Result<Vec<f64>, SignalError> {
    let sigma = positive("width of the Gaussian (samples)", sigma_samples)?;
    in_range("width of the Gaussian (samples)", sigma.min(10.0 * WIDEST) as usize, 0, WIDEST as usize)?;
    let radius = (TRUNCATE * sigma + 0.5) as i32;
    let mut weights: Vec<f64> = (-radius..=radius).map(|k| (-0.5 * (f64::from(k) / sigma).powi(2)).exp()).collect();
    let sum: f64 = weights.iter().sum();
    for w in &mut weights {
        *w /= sum;
    }
    Ok(weights)
}

/// Sample `i` of the record continued by its mirror image, again and again.
fn mirrored(record: &[f64], i: isize) -> f64 {
    let n = record.len() as isize;
    let place = i.rem_euclid(2 * n);
    record[place.min(2 * n - 1 - place) as usize]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_tone_loses_what_the_formula_says() {
        let (sigma, omega) = (20.0_f64, 0.03_f64);
        let x: Vec<f64> = (0..4000).map(|i| (omega * f64::from(i)).cos()).collect();
        let y = smooth(&x, sigma).unwrap();
        // Cut at 4σ: the tail beyond holds 6.3e-5 of the weight.
        assert!((y[2000] / x[2000] - (-0.5 * (sigma * omega).powi(2)).exp()).abs() < 1.3e-4);
    }

    proptest! {
        /// Sums of up to 161 products, in another order: 161 roundings of values below 1.
        #[test]
        fn fast_and_plain_agree(x in prop::collection::vec(-1.0..1.0_f64, 1..3000), sigma in 0.1..20.0_f64) {
            let fast = smooth(&x, sigma).unwrap();
            let plain = smooth_reference(&x, sigma).unwrap();
            prop_assert_eq!(fast.len(), plain.len());
            for (a, b) in fast.iter().zip(&plain) {
                prop_assert!((a - b).abs() < 161.0 * f64::EPSILON);
            }
        }
    }
}
