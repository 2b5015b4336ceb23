//! The incremental encoder on the motor and the board's counter.
//!
//! The count is ⌊θ·counts/2π⌋, signed; the board's 32-bit counter starts anywhere and wraps.
//!
//! **Frame.** Chain coordinate of the motor; zero where the plant's coordinate is zero. **Units.** counts.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// What is wrong with the encoder, from the tick at which it is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EncoderFault {
    /// Both lines are dead: the counter stays.
    Silent,
    /// One line is dead: the counter toggles between two neighbours with the other.
    Stuck,
    /// Direction is reversed.
    Reversed,
    /// About `per_second` illegal transitions a second, each losing a count or two.
    BitFlips {
        /// How many.
        per_second: u32,
    },
}

/// Encoder and counter of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encoder {
    counts_per_m: f64,
    /// What is added to the true count: start value, jumps, lost counts.
    offset: u32,
    fault: Option<EncoderFault>,
    frozen: u32,
    pivot: i64,
    errors: u32,
}

impl Encoder {
    /// A counter that reads `start` at count zero; `counts_per_m` carries the sign.
    #[must_use]
    pub fn new(counts_per_m: f64, start: u32) -> Self {
        Self { counts_per_m, offset: start, fault: None, frozen: start, pivot: 0, errors: 0 }
    }

    /// A counter that reads `start` where the motor stands at power-up.
    #[must_use]
    pub fn powered_up(counts_per_m: f64, start: u32, motor_position_m: f64) -> Self {
        let mut encoder = Self::new(counts_per_m, start);
        encoder.offset = start.wrapping_sub(encoder.true_count(motor_position_m) as u32);
        encoder.frozen = start;
        encoder
    }

    /// The true count at a motor position.
    #[must_use]
    pub fn true_count(&self, motor_position_m: f64) -> i64 {
        let exact = motor_position_m * self.counts_per_m;
        let truncated = exact as i64;
        truncated - i64::from((truncated as f64) > exact)
    }

    /// What the counter shows.
    pub fn read(&mut self, motor_position_m: f64, tick_s: f64, rng: &mut Pcg64Mcg) -> u32 {
        let count = self.true_count(motor_position_m);
        match self.fault {
            Some(EncoderFault::Silent) => return self.frozen,
            Some(EncoderFault::Stuck) => return self.frozen.wrapping_add((count & 1) as u32),
            Some(EncoderFault::Reversed) => return self.offset.wrapping_add((2 * self.pivot - count) as u32),
            Some(EncoderFault::BitFlips { per_second }) if rng.random::<f64>() < f64::from(per_second) * tick_s => {
                self.errors = self.errors.wrapping_add(1);
                let lost = rng.random_range(1..=2_u32);
                self.offset =
                    if rng.random() { self.offset.wrapping_add(lost) } else { self.offset.wrapping_sub(lost) };
            }
            Some(EncoderFault::BitFlips { .. }) | None => {}
        }
        self.frozen = self.offset.wrapping_add(count as u32);
        self.frozen
    }

    /// Illegal transitions seen by the decoder.
    #[must_use]
    pub fn errors(&self) -> u32 {
        self.errors
    }

    /// Breaks or repairs it; `motor_position_m` is where that happens.
    pub fn set_fault(&mut self, fault: EncoderFault, motor_position_m: f64) {
        self.pivot = self.true_count(motor_position_m);
        self.frozen = self.offset.wrapping_add(self.pivot as u32);
        self.fault = Some(fault);
    }

    /// The counter jumps.
    pub fn jump(&mut self, counts: i32) {
        self.offset = self.offset.wrapping_add_signed(counts);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn the_count_is_the_floor_on_both_sides_of_zero() {
        let e = Encoder::new(1000.0, 0);
        for (m, count) in [(0.0, 0), (0.9e-3, 0), (1.1e-3, 1), (-0.1e-3, -1), (-1.1e-3, -2), (2.5, 2500)] {
            assert_eq!(e.true_count(m), count, "{m}");
        }
    }

    #[test]
    fn the_counter_wraps_where_the_board_does() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut e = Encoder::new(1000.0, u32::MAX);
        assert_eq!(e.read(0.5e-3, 1e-3, &mut rng), u32::MAX);
        assert_eq!(e.read(1.5e-3, 1e-3, &mut rng), 0);
        assert_eq!(e.read(-0.5e-3, 1e-3, &mut rng), u32::MAX - 1);
    }

    #[test]
    fn a_reversed_encoder_counts_back_from_where_it_was() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut e = Encoder::new(1000.0, 7);
        e.set_fault(EncoderFault::Reversed, 1.0);
        assert_eq!(e.read(1.0, 1e-3, &mut rng), 1007);
        assert_eq!(e.read(1.01, 1e-3, &mut rng), 997);
    }

    #[test]
    fn bit_flips_come_at_their_rate_and_are_counted() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut e = Encoder::new(1000.0, 0);
        e.set_fault(EncoderFault::BitFlips { per_second: 400 }, 0.0);
        for _ in 0..40_000 {
            e.read(0.0, 250e-6, &mut rng);
        }
        // Poisson about 4,000 in ten seconds; four standard deviations.
        assert!((3750..=4250).contains(&e.errors()), "{}", e.errors());
    }
}
