//! Forward and backward: a filter without phase.
//!
//! The record is filtered, turned round, filtered again and turned back: phases cancel, gains square (so
//! the power is a quarter, not a half, at the corner). At both ends the record is continued by its odd
//! reflection over three times the filter's length, and both passes start in the steady state of the first value.
//!
//! # Source
//!
//! Gustafsson (1996), IEEE Trans. Signal Process. 44, 988, on why the ends matter; ends as in
//! `scipy.signal.sosfiltfilt` (its defaults `padtype="odd"`, `padlen=None`).

use crate::butterworth::{LowPass, Section};
use crate::error::{SignalError, all_finite};

/// Filters a record forward and backward.
///
/// # Errors
///
/// [`SignalError::TooShort`] for a record not longer than its extension, 3 (order + 1) samples;
/// [`SignalError::NotFinite`].
///
/// # Example
///
/// A ramp is not delayed:
///
/// ```
/// use froude_signal::{butterworth::low_pass, zero_phase::filter};
/// let line: Vec<f64> = (0..1000).map(f64::from).collect();
/// let smooth = filter(&low_pass(4, 50.0, 1000.0)?, &line)?;
/// assert!((smooth[500] - 500.0).abs() < 1e-6);
/// # Ok::<(), froude_signal::SignalError>(())
/// ```
pub fn filter(low_pass: &LowPass, record: &[f64]) -> Result<Vec<f64>, SignalError> {
    all_finite(record)?;
    let pad = extension(low_pass);
    let n = record.len();
    if n <= pad {
        return Err(SignalError::TooShort { what: "the forward-backward filter", needed: pad, found: n });
    }
    let mut work = Vec::with_capacity(n + 2 * pad);
    work.extend((1..=pad).rev().map(|i| 2.0 * record[0] - record[i]));
    work.extend_from_slice(record);
    work.extend((1..=pad).map(|i| 2.0 * record[n - 1] - record[n - 1 - i]));
    let mut forward = Pass::at_rest(low_pass, work[0]);
    forward.forward(&mut work);
    let mut backward = Pass::at_rest(low_pass, work[work.len() - 1]);
    backward.backward(&mut work);
    work.truncate(pad + n);
    work.drain(..pad);
    Ok(work)
}

/// Samples by which a record is continued at each end.
#[must_use]
pub fn extension(low_pass: &LowPass) -> usize {
    3 * (low_pass.order() + 1)
}

/// A filter on its way through a record.
#[derive(Debug, Clone)]
pub(crate) struct Pass {
    stages: Vec<(Section, [f64; 2])>,
}

impl Pass {
    /// In the steady state of a constant `value`.
    pub(crate) fn at_rest(low_pass: &LowPass, value: f64) -> Self {
        let at = |s: &Section| (*s, s.steady_state().map(|z| z * value));
        Self { stages: low_pass.sections.iter().map(at).collect() }
    }

    /// Filters in place, first sample first.
    pub(crate) fn forward(&mut self, record: &mut [f64]) {
        for pair in self.stages.chunks_mut(2) {
            through(pair, record.iter_mut());
        }
    }

    /// Filters in place, last sample first.
    pub(crate) fn backward(&mut self, record: &mut [f64]) {
        for pair in self.stages.chunks_mut(2) {
            through(pair, record.iter_mut().rev());
        }
    }
}

/// Two sections at a time: their recursions overlap, so a pair costs little more than one.
fn through<'a>(stages: &mut [(Section, [f64; 2])], samples: impl Iterator<Item = &'a mut f64>) {
    match stages {
        [(one, state)] => {
            let mut z = *state;
            for x in samples {
                *x = one.step(*x, &mut z);
            }
            *state = z;
        }
        [(one, state_1), (two, state_2)] => {
            let (mut z_1, mut z_2) = (*state_1, *state_2);
            for x in samples {
                *x = two.step(one.step(*x, &mut z_1), &mut z_2);
            }
            (*state_1, *state_2) = (z_1, z_2);
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::butterworth::low_pass;

    #[test]
    fn a_constant_stays_what_it_is() {
        let smooth = filter(&low_pass(4, 20.0, 1000.0).unwrap(), &[3.5; 200]).unwrap();
        // Rounding through two passes of two sections whose states are some 1/(1 − |z|) ≈ 10 times the value.
        assert!(smooth.iter().all(|y| (y - 3.5).abs() < 1e-12));
    }

    #[test]
    fn the_filter_turned_round_is_the_record_turned_round() {
        let record: Vec<f64> =
            (0..2000).map(|i| (0.05 * f64::from(i)).sin() + 0.3 * (1.1 * f64::from(i)).cos()).collect();
        let f = low_pass(4, 60.0, 1000.0).unwrap();
        let reversed: Vec<f64> = record.iter().rev().copied().collect();
        let there = filter(&f, &record).unwrap();
        let back = filter(&f, &reversed).unwrap();
        // Forward–backward and backward–forward differ only by what the ends leave, gone after the memory.
        let m = f.memory();
        for i in m..2000 - m {
            assert!((there[i] - back[1999 - i]).abs() < 1e-13);
        }
    }

    #[test]
    fn too_short_a_record_is_refused_with_both_lengths() {
        let error = filter(&low_pass(4, 20.0, 1000.0).unwrap(), &[0.0; 15]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the forward-backward filter needs more than 15 samples, the record has 15; record longer or filter less"
        );
    }
}
