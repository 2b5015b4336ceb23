//! Free decay: a body on springs, displaced, held and let go. The twin of that rig.
//!
//! (M + A) q̈ + D_I q̇ + D_II q̇|q̇| + F_c sgn q̇ + C (q − q₀) = 0, or C sin(q − q₀) where a buoyancy at a radius drives the body back. Between two turning points the motion is smooth; a step that passes one is cut there,
//! so that friction stops the body where its springs no longer overcome it, and Runge and Kutta's fourth order holds throughout.
//!
//! **Setting.** One axis, water at rest, springs without mass. **Units.** SI; position in m or rad.
//!
//! | what                    | where                    | source                    |
//! | ----------------------- | ------------------------ | ------------------------- |
//! | body and water          | [`DecayRig`]             | –                         |
//! | clock, noise, steps     | [`DecaySensor`]          | –                         |
//! | one release             | [`DecayRig::release`]    | Hairer et al. (1993), II.6 |
//!
//! Not here: waves and their memory, a second mode, mass of the springs.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::steady::{Channel, Reading};

/// Longest step, rad of the undamped phase: (0.05)⁴/120 = 5e-8 rad of phase a radian.
const STEP_RAD: f64 = 0.05;

/// Body, springs and water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecayRig {
    /// M: dry inertia, kg or kg m².
    pub inertia: f64,
    /// A: added mass, kg or kg m².
    pub added: f64,
    /// D_I, N s/m or N m s.
    pub linear: f64,
    /// D_II, N s²/m² or N m s².
    pub quadratic: f64,
    /// C, N/m or N m/rad.
    pub stiffness: f64,
    /// Whether a force that keeps its direction drives the body back: C sin(q − q₀) in the place of C (q − q₀).
    pub is_pendulum: bool,
    /// F_c, N or N m.
    pub coulomb: f64,
    /// q₀, m or rad.
    pub rest: f64,
}

/// What reads the position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecaySensor {
    /// Samples a second.
    pub rate_hz: f64,
    /// Standard deviation of a sample's noise, m or rad.
    pub noise: f64,
    /// Time over which that is correlated, s; `None` for white noise.
    pub correlation_s: Option<f64>,
    /// Step, m or rad; 0 is none.
    pub step: f64,
    /// Drift of the zero, m/s or rad/s.
    pub drift_per_s: f64,
}

/// One release.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Release {
    /// Distance from rest, m or rad.
    pub displacement: f64,
    /// Time that the body is held on the log, s.
    pub held_s: f64,
    /// Time that it is free, s.
    pub free_s: f64,
}

/// Position and speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecayState {
    /// m or rad.
    pub position: f64,
    /// m/s or rad/s.
    pub speed: f64,
}

/// What is logged of a release, and what was true.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayTrace {
    /// Time, s, in even steps from 0.
    pub time_s: Vec<f64>,
    /// Position as sensed, m or rad.
    pub position: Vec<f64>,
    /// The states themselves.
    pub truth: Vec<DecayState>,
    /// Time of the release, s; it lies anywhere between two samples.
    pub released_s: f64,
}

impl DecayRig {
    /// What drives the body back at a distance from rest, N or N m.
    fn restoring(&self, off: f64) -> f64 {
        self.stiffness * if self.is_pendulum { libm::sin(off) } else { off }
    }

    /// Acceleration; `sign` is that of the speed, held over a step.
    fn acceleration(&self, s: DecayState, sign: f64) -> f64 {
        let damping = s.speed * (self.linear + self.quadratic * sign * s.speed) + sign * self.coulomb;
        -(damping + self.restoring(s.position - self.rest)) / (self.inertia + self.added)
    }

    /// Runge and Kutta's step with the sign held.
    fn smooth(&self, s: DecayState, sign: f64, h: f64) -> DecayState {
        let along = |v: f64, a: f64, h: f64| DecayState { position: s.position + h * v, speed: s.speed + h * a };
        let (v1, a1) = (s.speed, self.acceleration(s, sign));
        let s2 = along(v1, a1, 0.5 * h);
        let (v2, a2) = (s2.speed, self.acceleration(s2, sign));
        let s3 = along(v2, a2, 0.5 * h);
        let (v3, a3) = (s3.speed, self.acceleration(s3, sign));
        let s4 = along(v3, a3, h);
        let (v4, a4) = (s4.speed, self.acceleration(s4, sign));
        along((v1 + 2.0 * (v2 + v3) + v4) / 6.0, (a1 + 2.0 * (a2 + a3) + a4) / 6.0, h)
    }

    /// The sign that the speed has or is about to have; 0 where friction holds the body.
    fn sign(&self, s: DecayState) -> f64 {
        let off = s.position - self.rest;
        if s.speed != 0.0 {
            s.speed.signum()
        } else if self.restoring(off).abs() <= self.coulomb {
            0.0
        } else {
            -off.signum()
        }
    }

    /// One step, cut at the turning point where it passes one. Steps are short against the period.
    #[must_use]
    pub fn step(&self, s: DecayState, step_s: f64) -> DecayState {
        let sign = self.sign(s);
        if sign == 0.0 {
            return s;
        }
        let whole = self.smooth(s, sign, step_s);
        if whole.speed * sign >= 0.0 {
            return whole;
        }
        // Halving finds the turn to the last bit, whatever the damping.
        let (mut before, mut after) = (0.0, step_s);
        for _ in 0..60 {
            let middle = 0.5 * (before + after);
            if self.smooth(s, sign, middle).speed * sign >= 0.0 {
                before = middle;
            } else {
                after = middle;
            }
        }
        let turned = DecayState { speed: 0.0, ..self.smooth(s, sign, before) };
        match self.sign(turned) {
            0.0 => turned,
            next => self.smooth(turned, next, step_s - before),
        }
    }

    /// State after a time, in as many steps as the period asks for.
    #[must_use]
    pub fn after(&self, s: DecayState, time_s: f64) -> DecayState {
        let omega = libm::sqrt(self.stiffness / (self.inertia + self.added));
        let steps = libm::ceil(omega * time_s / STEP_RAD).clamp(1.0, 1e6) as u32;
        (0..steps).fold(s, |s, _| self.step(s, time_s / f64::from(steps)))
    }

    /// Energy of motion and springs, J.
    #[must_use]
    pub fn energy_j(&self, s: DecayState) -> f64 {
        let off = s.position - self.rest;
        let lifted = if self.is_pendulum { 1.0 - libm::cos(off) } else { 0.5 * off * off };
        0.5 * (self.inertia + self.added) * s.speed * s.speed + self.stiffness * lifted
    }

    /// One release as it is logged; the same seed gives the same log, bit for bit.
    #[must_use]
    pub fn release(&self, sensor: DecaySensor, release: Release, seed: u64) -> DecayTrace {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let step_s = 1.0 / sensor.rate_hz;
        let released_s = release.held_s + step_s * rng.random::<f64>();
        let samples = libm::ceil((release.held_s + release.free_s) * sensor.rate_hz) as usize;
        let mut state = DecayState { position: self.rest + release.displacement, speed: 0.0 };
        let mut is_held = true;
        let DecaySensor { noise, correlation_s, step, drift_per_s, .. } = sensor;
        let reading = Reading { noise, correlation_s, step, zero: 0.0, drift_per_s, gain: 1.0 };
        let mut channels = Channel::of(&[reading], step_s, &mut rng);
        let mut out = DecayTrace { time_s: Vec::new(), position: Vec::new(), truth: Vec::new(), released_s };
        for i in 0..samples {
            let t = i as f64 * step_s;
            if t > released_s {
                state = self.after(state, if is_held { t - released_s } else { step_s });
                is_held = false;
            }
            out.time_s.push(t);
            out.position.push(channels[0].read(state.position, t, &mut rng));
            out.truth.push(state);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    const RIG: DecayRig = DecayRig {
        inertia: 12.0,
        added: 8.0,
        linear: 4.0,
        quadratic: 40.0,
        stiffness: 180.0,
        is_pendulum: false,
        coulomb: 0.0,
        rest: 0.3,
    };
    const CLEAN: DecaySensor =
        DecaySensor { rate_hz: 50.0, noise: 0.0, correlation_s: None, step: 0.0, drift_per_s: 0.0 };
    const RELEASE: Release = Release { displacement: 0.1, held_s: 0.5, free_s: 12.0 };

    /// Distance from rest at the next turning point.
    fn next_turn(rig: &DecayRig, a: f64) -> f64 {
        let mut s = DecayState { position: rig.rest + a, speed: 0.0 };
        for _ in 0..100_000 {
            let next = rig.step(s, 1e-3);
            if s.speed < 0.0 && next.speed >= 0.0 {
                // The step was cut at the turn: half a step from here on the body is still within 1e-9 of it.
                return rig.rest - s.position.min(next.position);
            }
            s = next;
        }
        f64::NAN
    }

    #[test]
    fn the_linear_decay_is_its_closed_form() {
        let rig = DecayRig { quadratic: 0.0, ..RIG };
        let trace = rig.release(CLEAN, RELEASE, 1);
        let gamma = 4.0 / 40.0;
        let omega = (9.0_f64 - gamma * gamma).sqrt();
        for (t, q) in trace.time_s.iter().zip(&trace.position) {
            let s = (t - trace.released_s).max(0.0);
            let exact = 0.3 + 0.1 * (-gamma * s).exp() * ((omega * s).cos() + gamma / omega * (omega * s).sin());
            // 36 rad at 5e-8 a radian, of 0.1 m: 2e-7 m.
            assert!((q - exact).abs() < 2e-7, "{t} {q} {exact}");
        }
    }

    /// Quadratic damping alone: (1 + 2εa) e^(−2εa) of one turning point is (1 − 2εb) e^(2εb) of the next, ε = D_II/(M+A).
    #[test]
    fn quadratic_damping_extinguishes_as_its_closed_form() {
        let rig = DecayRig { linear: 0.0, ..RIG };
        for a in [0.02, 0.1, 0.3] {
            let b = next_turn(&rig, a);
            let of = |y: f64| (1.0 + y) * (-y).exp();
            let epsilon = 40.0 / 20.0;
            // Turning points from samples of 1 ms lie within ½ ω² a (0.5 ms)² of it: 1e-6 of a.
            assert!(
                (of(2.0 * epsilon * a) - of(-2.0 * epsilon * b)).abs() < 2e-6 * (2.0 * epsilon * a).powi(2),
                "{a} {b}"
            );
            let first_order = 4.0 / 3.0 * epsilon * a * a;
            assert!((a - b) < first_order && (a - b) > first_order * (1.0 - 3.0 * epsilon * a), "{a} {b}");
        }
    }

    #[test]
    fn friction_takes_the_same_from_every_swing_and_stops_the_body() {
        let rig = DecayRig { linear: 0.0, quadratic: 0.0, coulomb: 0.9, ..RIG };
        let mut s = DecayState { position: 0.4, speed: 0.0 };
        let half_s = PI / 3.0;
        for k in 1..=9 {
            s = rig.after(s, half_s);
            let expected: f64 = 0.1 - 0.01 * f64::from(k);
            assert!(((s.position - 0.3).abs() - expected).abs() < 1e-6, "{k} {s:?}");
        }
        let end = rig.after(s, 20.0);
        assert!(end.speed == 0.0 && (end.position - 0.3).abs() <= 0.9 / 180.0 + 1e-6, "{end:?}");
    }

    /// A quarter of a pendulum's period is K(k)/ω, k = sin(a/2); K by the arithmetic-geometric mean.
    #[test]
    fn a_pendulum_has_the_period_of_the_elliptic_integral() {
        let rig = DecayRig { linear: 0.0, quadratic: 0.0, is_pendulum: true, rest: 0.0, ..RIG };
        for degrees in [5.0_f64, 30.0, 90.0] {
            let a = degrees.to_radians();
            let (mut x, mut y) = (1.0, (0.5 * a).cos());
            for _ in 0..8 {
                (x, y) = (0.5 * (x + y), (x * y).sqrt());
            }
            let quarter_s = 0.5 * PI / x / 3.0;
            let there = rig.after(DecayState { position: a, speed: 0.0 }, quarter_s);
            // 1.6 rad at 5e-8 a radian, of a; and the speed there is that of the energy.
            assert!(there.position.abs() < 2e-7 * a, "{degrees} {there:?}");
            assert!((there.speed + 3.0 * (2.0 - 2.0 * a.cos()).sqrt()).abs() < 1e-6 * a, "{degrees} {there:?}");
        }
    }

    #[test]
    fn the_energy_lost_is_what_damping_and_friction_took() {
        for is_pendulum in [false, true] {
            energy_balance(is_pendulum);
        }
    }

    fn energy_balance(is_pendulum: bool) {
        let rig = DecayRig { coulomb: 0.2, is_pendulum, ..RIG };
        let lost_w = |s: DecayState| {
            let v = s.speed.abs();
            v * (rig.coulomb + v * (rig.linear + rig.quadratic * v))
        };
        let defect = |h: f64| {
            let mut s = DecayState { position: 0.4, speed: 0.0 };
            let (start, mut lost) = (rig.energy_j(s), 0.0);
            for _ in 0..(4.0 / h) as u32 {
                let (middle, next) = (rig.step(s, 0.5 * h), rig.step(s, h));
                lost += h / 6.0 * (lost_w(s) + 4.0 * lost_w(middle) + lost_w(next));
                s = next;
            }
            (start - rig.energy_j(s) - lost).abs() / start
        };
        // Simpson's rule across the kink of |q̇| at a turning point is of second order and small: friction's power there is.
        assert!(defect(1e-3) < 1e-6, "{:e}", defect(1e-3));
    }

    #[test]
    fn the_same_seed_gives_the_same_log_and_the_noise_is_that_asked_for() {
        let sensor = DecaySensor { noise: 2e-4, step: 1e-4, drift_per_s: 1e-5, ..CLEAN };
        let one = RIG.release(sensor, RELEASE, 7);
        assert_eq!(one, RIG.release(sensor, RELEASE, 7));
        assert_ne!(one, RIG.release(sensor, RELEASE, 8));
        let n = one.time_s.len() as f64;
        let error = |i: usize| one.position[i] - one.truth[i].position - 1e-5 * one.time_s[i];
        let rms = ((0..one.time_s.len()).map(|i| error(i).powi(2)).sum::<f64>() / n).sqrt();
        let expected = (2e-4_f64.powi(2) + 1e-8 / 12.0).sqrt();
        // 625 samples: a standard deviation is known to 1/√1250 = 2.8 %; four of them.
        assert!((rms / expected - 1.0).abs() < 0.113, "{rms} {expected}");
        assert!(one.position.iter().all(|q| ((q / 1e-4).round() * 1e-4 - q).abs() < 1e-12));
    }
}
