//! Savitzky–Golay: a polynomial through the neighbours of every sample, its value or derivative kept.
//!
//! The weights come from discrete orthogonal (Gram) polynomials over the window: well conditioned at any order.
//! In the first and last half window the polynomial of the end window is evaluated where the sample is.
//!
//! # Source
//!
//! Gorry (1990), Anal. Chem. 62, 570 (weights from Gram polynomials, also at the ends); ends as in
//! `scipy.signal.savgol_filter` (its default `mode="interp"`).

use crate::convolve::{Parity, convolve};
use crate::error::{SignalError, all_finite, in_range, positive};

/// Widest window, samples.
const WIDEST: usize = 100_001;
/// Highest order of the polynomial.
const HIGHEST_ORDER: usize = 20;

/// What is fitted over how many samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Samples in the window, odd.
    pub samples: usize,
    /// Order of the polynomial, below the number of samples.
    pub order: usize,
    /// Which derivative: 0 smooths.
    pub derivative: usize,
}

impl Window {
    fn check(self, n: usize) -> Result<(), SignalError> {
        in_range("window of the Savitzky-Golay filter", self.samples, 1, WIDEST)?;
        if self.samples.is_multiple_of(2) {
            let (low, high) = (self.samples - 1, self.samples + 1);
            return Err(SignalError::OutOfRange {
                what: "even window (it must be odd)",
                found: self.samples,
                low,
                high,
            });
        }
        in_range("order of the polynomial", self.order, 0, HIGHEST_ORDER.min(self.samples - 1))?;
        in_range("derivative", self.derivative, 0, self.order)?;
        if n < self.samples {
            return Err(SignalError::TooShort { what: "the window", needed: self.samples - 1, found: n });
        }
        Ok(())
    }

    /// Weights of the samples for the derivative at `place`, counted from the window's centre, per step to the power `derivative`.
    fn weights(self, place: isize) -> Vec<f64> {
        let half = (self.samples / 2) as isize;
        let count = self.samples as f64;
        let at_place = gram(self, place as f64, self.derivative);
        (-half..=half)
            .map(|i| {
                let here = gram(self, i as f64, 0);
                let mut norm = count;
                let mut sum = 0.0;
                for k in 0..=self.order {
                    if k > 0 {
                        norm *= recurrence(self.samples, k);
                    }
                    sum += here[k] * at_place[k] / norm;
                }
                sum
            })
            .collect()
    }
}

/// `β_k` of `φ_{k+1}(t) = t φ_k(t) − β_k φ_{k−1}(t)`, the monic polynomials orthogonal over the window.
fn recurrence(samples: usize, k: usize) -> f64 {
    let (w, k) = (samples as f64, k as f64);
    k * k * (w * w - k * k) / (4.0 * (4.0 * k * k - 1.0))
}

/// Derivative `d` of `φ_0 … φ_order` at `t`.
fn gram(window: Window, t: f64, d: usize) -> Vec<f64> {
    // Row by row: derivative 0, 1, … d of all polynomials.
    let mut below: Vec<f64> = vec![0.0; window.order + 1];
    for row in 0..=d {
        let mut this = vec![0.0; window.order + 1];
        this[0] = if row == 0 { 1.0 } else { 0.0 };
        for k in 0..window.order {
            let before = if k == 0 { 0.0 } else { recurrence(window.samples, k) * this[k - 1] };
            this[k + 1] = t * this[k] + row as f64 * below[k] - before;
        }
        below = this;
    }
    below
}

/// Filters a record; a derivative is per `step_s` to its power.
///
/// # Errors
///
/// [`SignalError::OutOfRange`] for window, order or derivative, [`SignalError::NotPositive`] for the step,
/// [`SignalError::TooShort`], [`SignalError::NotFinite`].
pub fn filter(record: &[f64], window: Window, step_s: f64) -> Result<Vec<f64>, SignalError> {
    let parity = if window.derivative.is_multiple_of(2) { Parity::Even } else { Parity::Odd };
    // Ends are overwritten: any continuation will do.
    filter_by(record, window, step_s, |weights| convolve(weights, parity, |_| 0.0, record))
}

/// As [`filter`], written as its definition: the yardstick of the fast one.
///
/// # Errors
///
/// As [`filter`].
pub fn filter_reference(record: &[f64], window: Window, step_s: f64) -> Result<Vec<f64>, SignalError> {
    filter_by(record, window, step_s, |weights| {
        all_finite(record)?;
        let half = weights.len() / 2;
        let mut out = vec![0.0; record.len()];
        for (i, under) in record.windows(weights.len()).enumerate() {
            out[i + half] = weights.iter().zip(under).map(|(w, x)| w * x).sum();
        }
        Ok(out)
    })
}

fn filter_by(
    record: &[f64],
    window: Window,
    step_s: f64,
    inside: impl Fn(&[f64]) -> Result<Vec<f64>, SignalError>,
) -> Result<Vec<f64>, SignalError> {
    let n = record.len();
    window.check(n)?;
    let scale = positive("time step (s)", step_s)?.powi(-(window.derivative as i32));
    let half = window.samples / 2;
    let weights = |place: isize| window.weights(place).into_iter().map(|w| w * scale).collect::<Vec<f64>>();
    let mut out = inside(&weights(0))?;
    for i in 0..half {
        let before = weights(i as isize - half as isize);
        out[i] = before.iter().zip(record).map(|(w, x)| w * x).sum();
        let after = weights(half as isize - i as isize);
        out[n - 1 - i] = after.iter().zip(&record[n - window.samples..]).map(|(w, x)| w * x).sum();
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Savitzky & Golay (1964), table I: quadratic or cubic, 5 points: (−3, 12, 17, 12, −3)/35.
    #[test]
    fn the_printed_weights_of_five_points() {
        let w = Window { samples: 5, order: 2, derivative: 0 }.weights(0);
        for (w, printed) in w.iter().zip([-3.0, 12.0, 17.0, 12.0, -3.0]) {
            assert!((w - printed / 35.0).abs() < 1e-15);
        }
    }

    #[test]
    fn a_cubic_is_differentiated_exactly_to_its_ends() {
        let x: Vec<f64> = (0..60).map(|i| (0.1 * f64::from(i)).powi(3)).collect();
        let y = filter(&x, Window { samples: 21, order: 3, derivative: 1 }, 0.1).unwrap();
        for (i, y) in y.iter().enumerate() {
            // Weights of the end sum to some 10 in size, values to 205: 1e-11 is 50 roundings.
            assert!((y - 3.0 * (0.1 * i as f64).powi(2)).abs() < 1e-11, "{i}: {y}");
        }
    }

    proptest! {
        /// Sums of up to 41 products in another order; weights of any order are mirrored to the last bit.
        #[test]
        fn fast_and_plain_agree(
            x in prop::collection::vec(-1.0..1.0_f64, 41..4000), half in 1_usize..21, order in 0_usize..6, derivative in 0_usize..4,
        ) {
            let order = order.min(2 * half);
            let window = Window { samples: 2 * half + 1, order, derivative: derivative.min(order) };
            let fast = filter(&x, window, 1.0).unwrap();
            let plain = filter_reference(&x, window, 1.0).unwrap();
            let largest = plain.iter().fold(1.0_f64, |m, y| m.max(y.abs()));
            for (a, b) in fast.iter().zip(&plain) {
                prop_assert!((a - b).abs() < 41.0 * f64::EPSILON * largest);
            }
        }
    }
}
