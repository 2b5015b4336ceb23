//! Means of blocks of neighbours: a long record at a lower rate.
//!
//! Each block of q samples becomes their mean; means of times and of every channel belong together, so nothing is delayed. A tone of frequency f
//! keeps sin(πqf/f_s)/(q sin(πf/f_s)) of its amplitude, the same in every channel, and what is white stays white. Tones near a multiple of the
//! new rate, which would fall onto a slow signal, are those that a block takes out: a mean of whole periods is zero.
//!
//! Against [`decimate`](crate::decimate): a block knows only its own samples, so that a gap costs the block that it cuts and no more; tones
//! elsewhere above half the new rate are weakened less (to 0.21 between the first two multiples) and stay as noise.
//!
//! **Range.** Signals far below the new rate: 1 − gain is (πqf/f_s)²/6, 1e-4 at a 128th of it.
//!
//! # Source
//!
//! Oppenheim & Schafer (2010), *Discrete-Time Signal Processing*, 3rd ed., 2.6 (moving average).

use std::f64::consts::PI;

/// What a block of `rows` samples at `rate_hz` leaves of the amplitude of a tone below half that rate \[-\]; negative where it turns its sign.
#[must_use]
pub fn gain(rows: usize, rate_hz: f64, frequency_hz: f64) -> f64 {
    let (half, q) = (PI * frequency_hz / rate_hz, rows as f64);
    if half == 0.0 { 1.0 } else { (q * half).sin() / (q * half.sin()) }
}

/// Width of the ideal low-pass that lets as much white noise through, Hz.
#[must_use]
pub fn noise_bandwidth_hz(rows: usize, rate_hz: f64) -> f64 {
    0.5 * rate_hz / rows as f64
}

/// The means of one channel, a chunk at a time; however the record is cut, they are the same to the last bit.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockMean {
    rows: usize,
    taken: usize,
    first: f64,
    /// Of what the samples differ from the first.
    sum: f64,
}

impl BlockMean {
    /// Means of `rows` samples; of one where `rows` is 0.
    #[must_use]
    pub fn of(rows: usize) -> Self {
        Self { rows: rows.max(1), taken: 0, first: 0.0, sum: 0.0 }
    }

    /// Takes samples in and appends the means that they complete.
    pub fn push(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        for &x in samples {
            if self.taken == 0 {
                (self.first, self.sum) = (x, 0.0);
            }
            self.sum += x - self.first;
            self.taken += 1;
            if self.taken == self.rows {
                out.push(self.first + self.sum / self.rows as f64);
                self.taken = 0;
            }
        }
    }

    /// Leaves the block that is begun: what follows is no neighbour of it. Returns how many samples it had.
    pub fn leave(&mut self) -> usize {
        std::mem::take(&mut self.taken)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn means(rows: usize, record: &[f64], cut: usize) -> Vec<f64> {
        let (mut block, mut out) = (BlockMean::of(rows), Vec::new());
        for chunk in record.chunks(cut) {
            block.push(chunk, &mut out);
        }
        assert_eq!(block.leave(), record.len() % rows);
        out
    }

    proptest! {
        #[test]
        fn cutting_the_record_changes_nothing(
            x in prop::collection::vec(-1.0..1.0_f64, 0..400), rows in 1_usize..20, cut in 1_usize..90,
        ) {
            prop_assert_eq!(means(rows, &x, cut), means(rows, &x, 400));
        }

        /// The mean of a tone is the tone at the mean of the times, times the gain: exact, so rounding alone (angles of up to 600 rad).
        #[test]
        fn a_tone_keeps_its_phase_and_loses_what_is_stated(rows in 1_usize..60, hz in 0.1_f64..499.0, phase in 0.0_f64..TAU) {
            let rate = 1000.0;
            let time: Vec<f64> = (0..200).map(|i| f64::from(i) / rate).collect();
            let tone: Vec<f64> = time.iter().map(|t| (TAU * hz * t + phase).sin()).collect();
            let gain = gain(rows, rate, hz);
            for (t, x) in means(rows, &time, 7).iter().zip(means(rows, &tone, 7)) {
                prop_assert!((x - gain * (TAU * hz * t + phase).sin()).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_constant_is_itself_and_white_noise_has_the_variance_of_its_bandwidth() {
        assert!(means(7, &[0.1; 70], 70).iter().all(|x| *x == 0.1));
        // Mean square over all frequencies of the gain: 1/q, by quadrature over a period of it.
        let (rows, n) = (12, 24_000);
        let power =
            (0..n).map(|k| gain(rows, 1.0, (f64::from(k) + 0.5) / f64::from(n)).powi(2)).sum::<f64>() / f64::from(n);
        assert!((power - 2.0 * noise_bandwidth_hz(rows, 1.0)).abs() < 1e-12, "{power}");
    }

    #[test]
    fn the_range_is_as_it_is_stated() {
        let lost = 1.0 - gain(100, 12_800.0, 1.0);
        assert!((lost / 1e-4 - 1.0).abs() < 0.02, "{lost}");
        // Halfway between the first and the second multiple of the new rate.
        let between = gain(100, 10_000.0, 143.0).abs();
        assert!((between - 0.217).abs() < 2e-3, "{between}");
    }
}
