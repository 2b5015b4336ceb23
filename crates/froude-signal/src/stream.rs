//! Long records a chunk at a time, in bounded memory.
//!
//! A link takes samples in and gives samples out, in order, a little later; [`Link::finish`] gives the rest. What comes
//! out does not depend on how the record was cut. Links in a row make the chain of a position record: zero-phase
//! low-pass, central differences, decimation.
//!
//! | link               | keeps                         | against the whole record                                      |
//! |--------------------|-------------------------------|---------------------------------------------------------------|
//! | [`ZeroPhase`]      | a block and the filter's memory | equal to rounding: the backward pass starts where its start is forgotten |
//! | [`Differences`]    | two samples                   | equal, bit for bit                                              |
//! | [`Decimator`](crate::decimate::Decimator)      | its taps and a bite           | equal, bit for bit                                              |

use crate::SignalError;
use crate::butterworth::LowPass;
use crate::zero_phase::{Pass, extension};

/// A link of a chain.
pub trait Link {
    /// Takes samples in and appends what they complete.
    fn take(&mut self, samples: &[f64], out: &mut Vec<f64>);

    /// Appends what is left.
    ///
    /// # Errors
    ///
    /// [`SignalError::TooShort`] when the whole record was too short for the link.
    fn finish(self, out: &mut Vec<f64>) -> Result<(), SignalError>;
}

/// Central differences, one-sided at the ends.
#[derive(Debug, Clone)]
pub struct Differences {
    half: f64,
    last: [f64; 2],
    taken: usize,
}

impl Differences {
    /// Differences of samples `step_s` apart.
    ///
    /// # Errors
    ///
    /// [`SignalError::NotPositive`].
    pub fn new(step_s: f64) -> Result<Self, SignalError> {
        Ok(Self { half: 0.5 / crate::error::positive("time step (s)", step_s)?, last: [0.0; 2], taken: 0 })
    }
}

impl Link for Differences {
    fn take(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        for &x in samples {
            let [before, here] = self.last;
            match self.taken {
                0 => {}
                1 => out.push((x - here) * 2.0 * self.half),
                _ => out.push((x - before) * self.half),
            }
            self.last = [here, x];
            self.taken += 1;
        }
    }

    fn finish(self, out: &mut Vec<f64>) -> Result<(), SignalError> {
        if self.taken < 2 {
            return Err(SignalError::TooShort { what: "a difference", needed: 1, found: self.taken });
        }
        out.push((self.last[1] - self.last[0]) * 2.0 * self.half);
        Ok(())
    }
}

/// Streaming form of [`crate::differences::second`].
#[derive(Debug, Clone)]
pub struct SecondDifferences {
    square: f64,
    last: [f64; 2],
    /// Latest second difference, repeated for the last sample.
    newest: f64,
    taken: usize,
}

impl SecondDifferences {
    /// Of samples `step_s` apart.
    ///
    /// # Errors
    ///
    /// [`SignalError::NotPositive`].
    pub fn new(step_s: f64) -> Result<Self, SignalError> {
        let square = crate::error::positive("time step (s)", step_s)?.powi(2);
        Ok(Self { square, last: [0.0; 2], newest: 0.0, taken: 0 })
    }
}

impl Link for SecondDifferences {
    fn take(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        for &x in samples {
            let [before, here] = self.last;
            if self.taken >= 2 {
                self.newest = (x - 2.0 * here + before) / self.square;
                // The first sample has that of its neighbour.
                out.extend(std::iter::repeat_n(self.newest, if self.taken == 2 { 2 } else { 1 }));
            }
            self.last = [here, x];
            self.taken += 1;
        }
    }

    fn finish(self, out: &mut Vec<f64>) -> Result<(), SignalError> {
        if self.taken < 3 {
            return Err(SignalError::TooShort { what: "a second difference", needed: 2, found: self.taken });
        }
        out.push(self.newest);
        Ok(())
    }
}

/// Forward–backward low-pass.
///
/// Samples leave a block and the filter's memory after they came: for order 4 at 100 Hz and 10 kHz some 3,100 and 3,100.
#[derive(Debug, Clone)]
pub struct ZeroPhase {
    low_pass: LowPass,
    forward: Option<Pass>,
    /// First samples, until the record is longer than its extension.
    head: Vec<f64>,
    /// Last samples of the record, for the extension at its end.
    tail: Vec<f64>,
    /// Filtered forward, not yet backward.
    waiting: Vec<f64>,
    /// Extension samples at the front of `waiting`.
    in_front: usize,
    taken: usize,
}

impl ZeroPhase {
    /// A forward–backward filter.
    #[must_use]
    pub fn new(low_pass: LowPass) -> Self {
        Self { low_pass, forward: None, head: Vec::new(), tail: Vec::new(), waiting: Vec::new(), in_front: 0, taken: 0 }
    }

    fn feed(&mut self, samples: &[f64]) {
        let pad = extension(&self.low_pass);
        let start = self.waiting.len();
        self.waiting.extend_from_slice(samples);
        if let Some(forward) = &mut self.forward {
            forward.forward(&mut self.waiting[start..]);
        }
        self.tail.extend_from_slice(&samples[samples.len().saturating_sub(pad + 1)..]);
        self.tail.drain(..self.tail.len().saturating_sub(pad + 1));
    }

    /// Filters what waits backward; all but the last `kept` samples of it leave.
    fn emit(&mut self, kept: usize, from: f64, out: &mut Vec<f64>) {
        let leaving = self.waiting.len() - kept;
        let mut work = self.waiting.clone();
        Pass::at_rest(&self.low_pass, from).backward(&mut work);
        out.extend_from_slice(&work[self.in_front.min(leaving)..leaving]);
        self.in_front -= self.in_front.min(leaving);
        self.waiting.drain(..leaving);
    }
}

impl Link for ZeroPhase {
    fn take(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        let (pad, memory) = (extension(&self.low_pass), self.low_pass.memory());
        for bite in samples.chunks(memory.max(1024)) {
            self.taken += bite.len();
            if self.forward.is_some() {
                self.feed(bite);
            } else {
                self.head.extend_from_slice(bite);
                if self.head.len() <= pad {
                    continue;
                }
                let head = std::mem::take(&mut self.head);
                let front: Vec<f64> = (1..=pad).rev().map(|i| 2.0 * head[0] - head[i]).collect();
                self.forward = Some(Pass::at_rest(&self.low_pass, front[0]));
                self.in_front = pad;
                self.feed(&front);
                self.tail.clear();
                self.feed(&head);
            }
            // Backward over twice the memory, the younger half only to forget where it started.
            if self.waiting.len() >= 2 * memory {
                let from = self.waiting[self.waiting.len() - 1];
                self.emit(memory, from, out);
            }
        }
    }

    fn finish(mut self, out: &mut Vec<f64>) -> Result<(), SignalError> {
        let pad = extension(&self.low_pass);
        if self.forward.is_none() {
            let what = "the forward-backward filter";
            return Err(SignalError::TooShort { what, needed: pad, found: self.taken });
        }
        let last = self.tail[pad];
        let back: Vec<f64> = (1..=pad).map(|i| 2.0 * last - self.tail[pad - i]).collect();
        self.feed(&back);
        let from = self.waiting[self.waiting.len() - 1];
        let mut rest = Vec::new();
        self.emit(0, from, &mut rest);
        rest.truncate(rest.len() - pad);
        out.extend(rest);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::butterworth::low_pass;
    use crate::decimate::Decimator;
    use crate::{differences, zero_phase};
    use proptest::prelude::*;

    fn through<L: Link>(mut link: L, x: &[f64], cut: usize) -> Vec<f64> {
        let mut out = Vec::new();
        for chunk in x.chunks(cut) {
            link.take(chunk, &mut out);
        }
        link.finish(&mut out).unwrap();
        out
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn a_chunked_zero_phase_filter_is_the_whole_one(
            x in prop::collection::vec(-1.0..1.0_f64, 20..6000), cut in 1_usize..3000, order in 1_usize..6,
        ) {
            let f = low_pass(order, 100.0, 1000.0).unwrap();
            let whole = zero_phase::filter(&f, &x).unwrap();
            let parts = through(ZeroPhase::new(f), &x, cut);
            prop_assert_eq!(whole.len(), parts.len());
            for (a, b) in whole.iter().zip(&parts) {
                // Values to 3 (odd extension), a few roundings; what the start of the backward pass leaves is ε² of it.
                prop_assert!((a - b).abs() < 1e-14, "{} {}", a, b);
            }
        }

        /// The overlap follows the slowest pole: seams stay below 1e-12 of the largest number whether it is 14 samples or 20,000. Below 2.4 Hz
        /// at 1 kHz rounding itself is larger, with the whole record as without seams: ε/|1 − z|², |1 − z| ≈ 2π·corner/rate.
        #[test]
        fn seams_are_below_1e_12_or_rounding_whatever_the_slowest_pole(
            seed in 0_u64..1000, cut in 500_usize..40_000, order in 1_usize..7, corner_hz in prop::sample::select(vec![1.0, 3.0, 20.0, 150.0, 400.0]),
        ) {
            let f = low_pass(order, corner_hz, 1000.0).unwrap();
            let word = |i: usize| (i as u64 ^ seed).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40;
            let x: Vec<f64> = (0..4 * f.memory() + 5000).map(|i| word(i) as f64 / 16_777_216.0).collect();
            let whole = zero_phase::filter(&f, &x).unwrap();
            let parts = through(ZeroPhase::new(f), &x, cut);
            let largest = whole.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
            let bar = 1e-12_f64.max(f64::EPSILON * (std::f64::consts::TAU * corner_hz / 1000.0).powi(-2));
            prop_assert_eq!(whole.len(), parts.len());
            for (i, (a, b)) in whole.iter().zip(&parts).enumerate() {
                prop_assert!((a - b).abs() <= bar * largest, "{} {} {}", i, a, b);
            }
        }

        #[test]
        fn chunked_differences_are_the_whole_ones(x in prop::collection::vec(-1.0..1.0_f64, 2..300), cut in 1_usize..50) {
            prop_assert_eq!(differences::central(&x, 0.1).unwrap(), through(Differences::new(0.1).unwrap(), &x, cut));
        }
    }

    /// An hour of 10 kHz, one channel of eight: 36 million samples would be 288 MB; the links hold some thousand each.
    #[test]
    fn the_memory_of_a_chain_does_not_grow_with_the_record() {
        let f = low_pass(4, 100.0, 10_000.0).unwrap();
        let memory = f.memory();
        let mut filter = ZeroPhase::new(f);
        let mut decimator = Decimator::new(10).unwrap();
        let (mut smooth, mut out) = (Vec::new(), Vec::new());
        let chunk = vec![0.25; 10_000];
        let mut peak = 0;
        for _ in 0..300 {
            smooth.clear();
            filter.take(&chunk, &mut smooth);
            decimator.take(&smooth, &mut out);
            peak = peak.max(filter.waiting.capacity() + filter.tail.capacity());
        }
        assert!(peak < 12 * memory + 100, "{peak} samples held, memory of the filter {memory}");
        assert!(out.len() > 299_000);
    }
}
