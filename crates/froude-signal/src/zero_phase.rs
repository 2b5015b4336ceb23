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
use crate::cascade;
use crate::error::{SignalError, all_finite};
use crate::pages::zeros;
use froude_lanes::LANES;

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
    let (mut before, mut after) = continued(low_pass, record)?;
    let mut out = zeros(record.len());
    let mut forward = Pass::at_rest(low_pass, before[0]);
    forward.forward(&mut before);
    if !forward.long_forward(low_pass, record, &mut out) {
        all_finite(record)?;
    }
    forward.forward(&mut after);
    let mut backward = Pass::at_rest(low_pass, after[after.len() - 1]);
    backward.backward(&mut after);
    backward.long_backward(low_pass, &mut out);
    Ok(out)
}

/// What continues a record before its first sample and after its last.
fn continued(low_pass: &LowPass, record: &[f64]) -> Result<(Vec<f64>, Vec<f64>), SignalError> {
    let (pad, n) = (extension(low_pass), record.len());
    if n <= pad {
        all_finite(record)?;
        return Err(SignalError::TooShort { what: "the forward-backward filter", needed: pad, found: n });
    }
    let before = (1..=pad).rev().map(|i| 2.0 * record[0] - record[i]).collect();
    let after = (1..=pad).map(|i| 2.0 * record[n - 1] - record[n - 1 - i]).collect();
    Ok((before, after))
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

    /// Filters a long record, first sample first; tells whether all of it was finite.
    fn long_forward(&mut self, low_pass: &LowPass, from: &[f64], to: &mut [f64]) -> bool {
        let (mut done, mut is_finite) = (0, true);
        if let Some(stretch) = cascade::stretch(low_pass, from.len()) {
            let mut states = self.states();
            is_finite = cascade::forward(low_pass, &mut states, stretch, from, to);
            self.set_states(&states);
            done = LANES * stretch;
        }
        to[done..].copy_from_slice(&from[done..]);
        self.forward(&mut to[done..]);
        // What is not finite never leaves a recursion.
        is_finite && self.stages.iter().all(|(_, state)| state.iter().all(|z| z.is_finite()))
    }

    /// Filters a long record in place, last sample first.
    fn long_backward(&mut self, low_pass: &LowPass, record: &mut [f64]) {
        let mut left = record.len();
        if let Some(stretch) = cascade::stretch(low_pass, record.len()) {
            let mut states = self.states();
            cascade::backward(low_pass, &mut states, stretch, record);
            self.set_states(&states);
            left -= LANES * stretch;
        }
        self.backward(&mut record[..left]);
    }

    fn states(&self) -> Vec<[f64; 2]> {
        self.stages.iter().map(|(_, state)| *state).collect()
    }

    fn set_states(&mut self, states: &[[f64; 2]]) {
        self.stages.iter_mut().zip(states).for_each(|((_, state), new)| *state = *new);
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
    use proptest::prelude::*;

    /// As [`filter`], sample after sample: the yardstick of the fast one.
    fn plain_filter(low_pass: &LowPass, record: &[f64]) -> Vec<f64> {
        let (before, after) = continued(low_pass, record).unwrap();
        let mut work = [&before, record, &after].concat();
        Pass::at_rest(low_pass, work[0]).forward(&mut work);
        let last = work[work.len() - 1];
        Pass::at_rest(low_pass, last).backward(&mut work);
        work[before.len()..before.len() + record.len()].to_vec()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        /// Numbers up to 3 (odd extension) and gains of 1; impulse responses of some 60 samples gather as many roundings.
        #[test]
        fn fast_and_plain_agree(
            x in prop::collection::vec(-1.0..1.0_f64, 30..12_000), order in 1_usize..8, corner_hz in 30.0..400.0_f64,
        ) {
            let f = low_pass(order, corner_hz, 1000.0).unwrap();
            let fast = filter(&f, &x).unwrap();
            let plain = plain_filter(&f, &x);
            prop_assert_eq!(fast.len(), plain.len());
            for (a, b) in fast.iter().zip(&plain) {
                prop_assert!((a - b).abs() < 60.0 * f64::EPSILON, "{} {}", a, b);
            }
        }

        #[test]
        fn a_number_that_is_none_is_named_wherever_it_stands(
            n in 30_usize..12_000, place in 0.0..1.0_f64, what in prop::sample::select(vec![f64::NAN, f64::INFINITY]),
        ) {
            let mut x = vec![1.0; n];
            let index = (place * n as f64) as usize;
            x[index] = what;
            let error = filter(&low_pass(4, 100.0, 1000.0).unwrap(), &x).unwrap_err();
            prop_assert_eq!(error, SignalError::NotFinite { index });
        }
    }

    #[test]
    fn a_filter_that_never_forgets_takes_the_record_as_one() {
        let f = low_pass(2, 1e-13, 1000.0).unwrap();
        assert_eq!(filter(&f, &vec![0.0; 5000]).unwrap(), vec![0.0; 5000]);
    }

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
