//! Input shaping: a move that leaves one mode of vibration at rest.
//!
//! **Setting.** A mode with natural frequency f and damping ratio ζ, driven by the reference. The reference is replaced by two
//! (ZV) or three (ZVD) delayed and weighted copies, whose vibrations cancel. Profiles are closed-form functions of time, so a delay is
//! an argument, not a memory. **Units.** SI.
//!
//! Weights are positive and add to one: the shaped reference keeps the bounds of the profile and ends on its target, one (ZV: half a)
//! damped period later.
//!
//! | shaper | copies | residual vibration at the mode | its slope over frequency |
//! | --- | --- | --- | --- |
//! | ZV | 1, K over half a period | 0 | not 0 |
//! | ZVD | 1, 2K, K² over a period | 0 | 0 |
//!
//! K = exp(−ζπ/√(1 − ζ²)). **Source.** Singer & Seering, J. Dyn. Syst. Meas. Control 112 (1990) 76–82.

use crate::profile::{Profile, State};

/// Weights and delays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shaper {
    /// Weight \[-\] and delay \[s\] of each copy; a copy of weight 0 is not there.
    copies: [(f64, f64); 3],
}

impl Shaper {
    /// No shaping.
    pub const NONE: Self = Self { copies: [(1.0, 0.0), (0.0, 0.0), (0.0, 0.0)] };

    /// Zero vibration at `mode_hz` (undamped natural frequency, > 0) with damping ratio `damping` in 0..1.
    #[must_use]
    pub fn zv(mode_hz: f64, damping: f64) -> Self {
        let [k, half_s] = decay_and_half_period(mode_hz, damping);
        let last = k / (1.0 + k);
        Self { copies: [(1.0 - last, 0.0), (last, half_s), (0.0, 0.0)] }
    }

    /// Zero vibration and zero slope at `mode_hz`: bears a wrong mode, and takes a whole period.
    #[must_use]
    pub fn zvd(mode_hz: f64, damping: f64) -> Self {
        let [k, half_s] = decay_and_half_period(mode_hz, damping);
        let sum = (1.0 + k) * (1.0 + k);
        let (second, third) = (2.0 * k / sum, k * k / sum);
        Self { copies: [(1.0 - second - third, 0.0), (second, half_s), (third, 2.0 * half_s)] }
    }

    /// The longest delay, s.
    #[must_use]
    pub fn delay_s(&self) -> f64 {
        let [_, (_, second), (_, third)] = self.copies;
        libm::fmax(second, third)
    }
}

fn decay_and_half_period(mode_hz: f64, damping: f64) -> [f64; 2] {
    let root = libm::sqrt(1.0 - damping * damping);
    [libm::exp(-damping * core::f64::consts::PI / root), 0.5 / (mode_hz * root)]
}

/// A profile through a shaper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapedProfile {
    profile: Profile,
    shaper: Shaper,
    duration_s: f64,
}

impl ShapedProfile {
    /// The shaped move.
    #[must_use]
    pub fn new(profile: Profile, shaper: Shaper) -> Self {
        Self { profile, shaper, duration_s: profile.duration_s() + shaper.delay_s() }
    }

    /// How long it takes, delay included, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// State at `time_s`; the target, to the last bit, from the end on.
    #[must_use]
    pub fn sample(&self, time_s: f64) -> State {
        if time_s >= self.duration_s {
            return State::at_rest(self.profile.target_m());
        }
        let start_m = self.profile.start_m();
        let mut sum = State::at_rest(start_m);
        for (weight, delay_s) in self.shaper.copies {
            if weight > 0.0 && time_s >= delay_s {
                let state = self.profile.sample(time_s - delay_s);
                sum.position_m += weight * (state.position_m - start_m);
                sum.speed_m_s += weight * state.speed_m_s;
                sum.acceleration_m_s2 += weight * state.acceleration_m_s2;
            }
        }
        sum
    }
}
