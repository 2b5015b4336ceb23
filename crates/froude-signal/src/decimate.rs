//! Zero-phase decimation by an integer factor.
//!
//! A linear-phase FIR low-pass of 20 q + 1 taps (windowed sinc, Hamming) with its corner at the new half
//! rate, centred on the samples that stay. Its delay of 10 q samples is undone, so force and every regressor stay
//! where they were in time. All columns of a regression must pass the same filter: least squares then sees
//! the same linear combination of rows on both sides, and the coefficients are not moved.
//!
//! Beyond the ends the record is taken as zero: the first and last 10 outputs are not to be used
//! ([`EDGE`]).
//!
//! # Source
//!
//! Oppenheim & Schafer (2010), 7.5 (window method); conventions of `scipy.signal.decimate(x, q, ftype="fir",
//! zero_phase=True)` and `scipy.signal.firwin`.

use std::f64::consts::PI;

use crate::error::{SignalError, all_finite, in_range};
use crate::stream::Link;

/// Outputs at each end that a record's end has touched.
pub const EDGE: usize = 10;

/// Largest factor: 20,001 taps.
const LARGEST_FACTOR: usize = 1000;

/// Taps of the low-pass for decimation by `factor`: 20 q + 1, symmetric, sum 1.
///
/// # Errors
///
/// [`SignalError::OutOfRange`] for a factor outside 1…1000.
pub fn taps(factor: usize) -> Result<Vec<f64>, SignalError> {
    let q = in_range("decimation factor", factor, 1, LARGEST_FACTOR)? as f64;
    let last = 20 * factor;
    let mut taps: Vec<f64> = (0..=last)
        .map(|i| {
            let x = (i as f64 - 0.5 * last as f64) / q;
            let sinc = if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
            let hamming = 0.54 - 0.46 * (2.0 * PI * i as f64 / last as f64).cos();
            sinc * hamming
        })
        .collect();
    let sum: f64 = taps.iter().sum();
    for tap in &mut taps {
        *tap /= sum;
    }
    Ok(taps)
}

/// Every `factor`-th sample of the low-passed record: ⌈n/q⌉ of them, the first at the record's first sample.
///
/// A factor of 1 returns the record.
///
/// # Errors
///
/// [`SignalError::OutOfRange`] for the factor; [`SignalError::NotFinite`].
pub fn decimate(record: &[f64], factor: usize) -> Result<Vec<f64>, SignalError> {
    all_finite(record)?;
    let mut stream = Decimator::new(factor)?;
    let mut out = Vec::with_capacity(record.len().div_ceil(factor));
    stream.take(record, &mut out);
    stream.finish(&mut out)?;
    Ok(out)
}

/// Decimation a chunk at a time; the outputs are those of [`decimate`], however the record is cut.
#[derive(Debug, Clone)]
pub struct Decimator {
    factor: usize,
    taps: Vec<f64>,
    /// Samples still needed, the first under the first tap of the next output.
    window: Vec<f64>,
    /// Samples taken.
    taken: usize,
    /// Outputs given.
    given: usize,
}

/// Samples taken in at a time, so that the memory does not grow with a chunk.
const BITE: usize = 4096;

impl Decimator {
    /// A decimator by `factor`.
    ///
    /// # Errors
    ///
    /// [`SignalError::OutOfRange`] for a factor outside 1…1000.
    pub fn new(factor: usize) -> Result<Self, SignalError> {
        let taps = if factor == 1 { vec![1.0] } else { taps(factor)? };
        let window = vec![0.0; taps.len() / 2];
        Ok(Self { factor, taps, window, taken: 0, given: 0 })
    }

    fn emit(&mut self, out: &mut Vec<f64>) {
        let mut start = 0;
        while let Some(under) = self.window.get(start..start + self.taps.len()) {
            out.push(dot(&self.taps, under));
            self.given += 1;
            start += self.factor;
        }
        self.window.drain(..start.min(self.window.len()));
    }
}

impl Link for Decimator {
    fn take(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        for bite in samples.chunks(BITE) {
            self.window.extend_from_slice(bite);
            self.taken += bite.len();
            self.emit(out);
        }
    }

    /// The record is continued by zeros.
    fn finish(mut self, out: &mut Vec<f64>) -> Result<(), SignalError> {
        let total = self.taken.div_ceil(self.factor);
        self.window.resize(self.window.len() + self.taps.len() / 2, 0.0);
        self.emit(out);
        debug_assert_eq!(self.given, total);
        Ok(())
    }
}

/// Sum of products in eight partial sums, which the compiler puts into lanes.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a8, a_rest) = a.as_chunks::<8>();
    let (b8, b_rest) = b.as_chunks::<8>();
    for (a, b) in a8.iter().zip(b8) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_factor_of_one_changes_nothing() {
        assert_eq!(decimate(&[1.0, -2.0, 3.0], 1).unwrap(), [1.0, -2.0, 3.0]);
    }

    #[test]
    fn a_constant_keeps_its_value_away_from_the_ends() {
        let y = decimate(&[2.0; 1000], 10).unwrap();
        assert_eq!(y.len(), 100);
        // Taps sum to one up to the rounding of 201 additions.
        assert!(y[EDGE..100 - EDGE].iter().all(|y| (y - 2.0).abs() < 1e-13));
    }

    #[test]
    fn a_tone_above_the_new_half_rate_is_taken_out() {
        // 80 Hz at 1 kHz, kept rate 100 Hz (half: 50 Hz): Hamming leaves less than 53 dB, 2.2e-3.
        let x: Vec<f64> = (0..3000).map(|i| (2.0 * PI * 0.08 * f64::from(i)).sin()).collect();
        let y = decimate(&x, 10).unwrap();
        assert!(y[EDGE..y.len() - EDGE].iter().all(|y| y.abs() < 2.2e-3));
    }

    proptest! {
        /// However a record is cut into chunks, the outputs are the same to the last bit.
        #[test]
        fn cutting_the_record_changes_nothing(
            x in prop::collection::vec(-1.0..1.0_f64, 0..400), q in 1_usize..7, cut in 1_usize..90,
        ) {
            let whole = decimate(&x, q).unwrap();
            let mut stream = Decimator::new(q).unwrap();
            let mut parts = Vec::new();
            for chunk in x.chunks(cut) {
                stream.take(chunk, &mut parts);
            }
            stream.finish(&mut parts).unwrap();
            prop_assert_eq!(whole.len(), x.len().div_ceil(q));
            prop_assert_eq!(whole, parts);
        }
    }
}
