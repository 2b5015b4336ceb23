//! Accelerated tows: a carriage that brings a body up to speed and back to rest, with a load cell between them. The twin of that tank.
//!
//! The speed is a trapezium whose corners are rounded by a constant jerk; the cell shows the force of the rig on the body along the travel,
//! f_m(t) = m a − f(v, a) at t − delay, with f the load of the water on the body, a zero, white or slow noise and resolution.
//!
//! **Setting.** Stiff drive, load of the law at the present speed and acceleration, no memory of the wake. **Units.** SI.
//!
//! Not here: waves, rods that bend, a wake that lags.

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::steady::{Channel, Reading};

/// Time over which a corner of the speed is rounded, s.
pub const JERK_S: f64 = 0.1;

/// One run: still, up to speed, steady, to rest, still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// Speed that is reached, m/s; below zero astern.
    pub speed_m_s: f64,
    /// Acceleration up to it and back to rest, m/s², larger than zero.
    pub acceleration_m_s2: f64,
    /// Time at the speed, s.
    pub steady_s: f64,
    /// Time at rest before and after, s.
    pub still_s: f64,
}

/// Position, speed and acceleration at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// m.
    pub position_m: f64,
    /// m/s.
    pub speed_m_s: f64,
    /// m/s².
    pub acceleration_m_s2: f64,
}

impl Profile {
    /// Length of the run, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        2.0 * (self.still_s + self.ramp_s()) + self.steady_s + JERK_S
    }

    /// Way of the run, m.
    #[must_use]
    pub fn travel_m(&self) -> f64 {
        self.speed_m_s.abs() * (self.ramp_s() + self.steady_s)
    }

    fn ramp_s(&self) -> f64 {
        self.speed_m_s.abs() / self.acceleration_m_s2
    }

    /// Where it is, in closed form: the trapezium's integrals, averaged over the time of a corner.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Motion {
        let up = self.still_s;
        let down = up + self.ramp_s() + self.steady_s;
        let corners = [(up, 1.0), (up + self.ramp_s(), -1.0), (down, -1.0), (down + self.ramp_s(), 1.0)];
        // Σ ± (t − t_k)ⁿ/n!: speed, position and its integral of the trapezium.
        let sum = |t: f64, n: i32, factorial: f64| -> f64 {
            corners.iter().map(|(at, sign)| sign * (t - at).max(0.0).powi(n) / factorial).sum()
        };
        let slope = self.acceleration_m_s2 * self.speed_m_s.signum();
        let over =
            |n: i32, factorial: f64| slope * (sum(time_s, n, factorial) - sum(time_s - JERK_S, n, factorial)) / JERK_S;
        Motion { position_m: over(3, 6.0), speed_m_s: over(2, 2.0), acceleration_m_s2: over(1, 1.0) }
    }
}

/// What is logged of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AcceleratedTrace {
    /// Time, s, in even steps from 0.
    pub time_s: Vec<f64>,
    /// Position as sensed, m.
    pub position_m: Vec<f64>,
    /// Force of the rig on the body along the travel as sensed, N.
    pub force_n: Vec<f64>,
}

/// One run as it is logged.
///
/// `mass_kg` moves below the cell, which shows what was there `delay_s` before; `load_n` gives the load of the water at a speed and an acceleration, N;
/// `readings` are those of position and force. The same seed gives the same log.
#[must_use]
pub fn accelerated(
    profile: Profile,
    rate_hz: f64,
    mass_kg: f64,
    delay_s: f64,
    readings: [Reading; 2],
    load_n: &dyn Fn(f64, f64) -> f64,
    seed: u64,
) -> AcceleratedTrace {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let step_s = 1.0 / rate_hz;
    let mut channels = Channel::of(&readings, step_s, &mut rng);
    let samples = libm::round(profile.duration_s() * rate_hz) as usize;
    let mut out = AcceleratedTrace::default();
    for i in 0..samples {
        let t = i as f64 * step_s;
        let then = profile.at(t - delay_s);
        let load = load_n(then.speed_m_s, then.acceleration_m_s2);
        out.time_s.push(t);
        out.position_m.push(channels[0].read(profile.at(t).position_m, t, &mut rng));
        out.force_n.push(channels[1].read(mass_kg * then.acceleration_m_s2 - load, t, &mut rng));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_profile_ends_where_it_should_and_its_derivatives_are_those() {
        let profile = Profile { speed_m_s: -0.3, acceleration_m_s2: 0.2, steady_s: 4.0, still_s: 2.0 };
        let end = profile.at(profile.duration_s());
        assert!((end.position_m + profile.travel_m()).abs() < 1e-12 && end.speed_m_s.abs() < 1e-12);
        let h = 1e-4;
        for i in 0..150 {
            let t = 0.0777 * f64::from(i);
            let [before, now, after] = [t - h, t, t + h].map(|t| profile.at(t));
            // Central differences: h²/6 of the next derivative, which a jerk of 2 m/s³ bounds, and a corner within h of few times.
            let v = (after.position_m - before.position_m) / (2.0 * h);
            let a = (after.speed_m_s - before.speed_m_s) / (2.0 * h);
            assert!((v - now.speed_m_s).abs() < 1e-8 && (a - now.acceleration_m_s2).abs() < 2e-4, "{t}");
        }
    }
}
