//! A servo that moves a body to and fro, and the log of motion and loads: the twin of every rig with a motor and load cells.
//!
//! The servo follows α sin ωt from rest as a second-order system, overshoot and start-up included. The loads are stamped late by a delay, each with its zero,
//! drift, white or slow noise and resolution.
//!
//! **Units.** SI: the motion is an angle, rad, or a displacement, m; loads in N or N m.
//!
//! Not here: rods that bend, waves in the tank, a motor that saturates.
//!
//! # Source
//!
//! Hairer et al. (1993), II.1 (the classical method of order four).

use core::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use crate::noise::OrnsteinUhlenbeck;
use crate::steady::{Reading, stepped};

/// Longest step of the servo, as part of its own radian: (0.05)⁵/120 = 3e-9 of the motion in a step.
const STEP_RAD: f64 = 0.05;

/// Position and its first two derivatives: rad or m, per s, per s².
pub type Motion = [f64; 3];

/// How a body is moved: φ₀ + α sin ωt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// φ₀, where the body rests, rad or m.
    pub middle: f64,
    /// α, rad or m.
    pub amplitude: f64,
    /// ω, rad/s.
    pub omega_rad_s: f64,
    /// Time at rest on the log before it begins, s.
    pub still_s: f64,
    /// Periods after that.
    pub periods: f64,
}

impl Swing {
    /// How long it is on the log, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.still_s + self.periods * TAU / self.omega_rad_s
    }
}

/// What is logged of a run, and how well. Each channel is sensed in its own unit; a gain scales all that it shows.
#[derive(Debug, Clone, PartialEq)]
pub struct SwungSensor {
    /// Samples a second.
    pub rate_hz: f64,
    /// The motion: white noise and step.
    pub motion: Reading,
    /// The loads.
    pub loads: Vec<Reading>,
    /// The loads are stamped so much later than the motion, s.
    pub delay_s: f64,
}

/// What is logged of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SwungTrace {
    /// Time, s, in even steps from 0.
    pub time_s: Vec<f64>,
    /// Motion as sensed, rad or m.
    pub motion: Vec<f64>,
    /// Loads of the rig on the body as sensed, N or N m.
    pub loads: Vec<Vec<f64>>,
}

/// The log of a run; `servo` is its natural frequency, rad/s, and its damping ratio. `loads` gives each load of the rig on the body at all samples, from the
/// motion and its first two derivatives there. The same seed gives the same log, bit for bit.
///
/// # Errors
///
/// That of `loads`.
pub fn log<E>(
    asked: Swing,
    servo: (f64, f64),
    sensor: &SwungSensor,
    loads: impl FnOnce(&[Motion]) -> Result<Vec<Vec<f64>>, E>,
    seed: u64,
) -> Result<SwungTrace, E> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let step_s = 1.0 / sensor.rate_hz;
    let noise = |reading: &Reading, rng: &mut Pcg64Mcg| {
        let (white, slow) = if reading.correlation_s.is_some() { (0.0, reading.noise) } else { (reading.noise, 0.0) };
        (white, OrnsteinUhlenbeck::new(slow, reading.correlation_s.unwrap_or(1.0), step_s, rng))
    };
    let mut of_loads: Vec<(f64, OrnsteinUhlenbeck)> = sensor.loads.iter().map(|r| noise(r, &mut rng)).collect();
    let samples = libm::round((asked.still_s + asked.periods * TAU / asked.omega_rad_s) * sensor.rate_hz) as usize;
    let time_s: Vec<f64> = (0..samples).map(|i| i as f64 * step_s).collect();
    // The motion at the time of the stamp and at that of the loads lie a fixed delay apart: two servos, one late.
    let (mut now, mut then) = (Servo::new(asked, servo), Servo::new(asked, servo));
    let late: Vec<Motion> = time_s.iter().map(|t| then.at(t - sensor.delay_s)).collect();
    let there = loads(&late)?;
    let mut out = SwungTrace { loads: vec![Vec::with_capacity(samples); there.len()], ..SwungTrace::default() };
    for (i, t) in time_s.iter().enumerate() {
        let [place, ..] = now.at(*t);
        let shown = place + sensor.motion.noise * rng.sample::<f64, _>(StandardNormal);
        out.motion.push(sensor.motion.gain * stepped(shown, sensor.motion.step));
        let white: Vec<f64> = of_loads.iter().map(|_| rng.sample(StandardNormal)).collect();
        for (k, (reading, (size, slow))) in sensor.loads.iter().zip(&mut of_loads).enumerate() {
            let drift = reading.drift_per_s * t;
            let shown = there[k][i] + reading.zero + drift + *size * white[k] + slow.step(&mut rng);
            out.loads[k].push(reading.gain * stepped(shown, reading.step));
        }
    }
    out.time_s = time_s;
    Ok(out)
}

/// The servo, stepped forward in time.
struct Servo {
    asked: Swing,
    /// Natural frequency, rad/s, and damping ratio.
    natural_and_damping: (f64, f64),
    time_s: f64,
    state: [f64; 2],
}

impl Servo {
    fn new(asked: Swing, natural_and_damping: (f64, f64)) -> Self {
        Self { asked, natural_and_damping, time_s: f64::NEG_INFINITY, state: [asked.middle, 0.0] }
    }

    fn second(&self, t: f64, [place, rate]: [f64; 2]) -> f64 {
        let (natural, damping) = self.natural_and_damping;
        let asked =
            self.asked.middle + self.asked.amplitude * libm::sin(self.asked.omega_rad_s * (t - self.asked.still_s));
        natural * natural * (asked - place) - 2.0 * damping * natural * rate
    }

    /// The motion at a time; times increase from call to call. At rest until the motion begins.
    fn at(&mut self, time_s: f64) -> Motion {
        let begins = self.asked.still_s;
        if time_s <= begins {
            return [self.asked.middle, 0.0, 0.0];
        }
        let from = self.time_s.max(begins);
        let (natural, _) = self.natural_and_damping;
        let steps = libm::ceil((time_s - from) * natural / STEP_RAD).clamp(1.0, 1e6) as u32;
        let h = (time_s - from) / f64::from(steps);
        for i in 0..steps {
            let t = from + f64::from(i) * h;
            let along = |s: [f64; 2], d: [f64; 2], h: f64| [s[0] + h * d[0], s[1] + h * d[1]];
            let slope = |t: f64, s: [f64; 2]| [s[1], self.second(t, s)];
            let s = self.state;
            let k1 = slope(t, s);
            let k2 = slope(t + 0.5 * h, along(s, k1, 0.5 * h));
            let k3 = slope(t + 0.5 * h, along(s, k2, 0.5 * h));
            let k4 = slope(t + h, along(s, k3, h));
            self.state = [0, 1].map(|j| s[j] + h / 6.0 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j]));
        }
        self.time_s = time_s;
        [self.state[0], self.state[1], self.second(time_s, self.state)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO: (f64, f64) = (30.0, 0.6);
    const SWING: Swing = Swing { middle: 0.0, amplitude: 0.2, omega_rad_s: 1.2, still_s: 1.0, periods: 6.0 };

    fn exact(rate_hz: f64, delay_s: f64) -> SwungSensor {
        let reading = Reading { gain: 1.0, ..Reading::default() };
        SwungSensor { rate_hz, motion: reading, loads: vec![reading], delay_s }
    }

    /// The log with a load of J a + D v + Q v|v|.
    fn logged(swing: Swing, sensor: &SwungSensor, [inertia, linear, square]: [f64; 3]) -> SwungTrace {
        let load = |[_, v, a]: &Motion| inertia * a + linear * v + square * v * v.abs();
        log::<()>(swing, SERVO, sensor, |all| Ok(vec![all.iter().map(load).collect()]), 1).unwrap()
    }

    /// The gain of a second-order system, 1/|1 − x² + 2iζx| at x = ω/ω_s.
    fn gain(omega_rad_s: f64) -> f64 {
        let x = omega_rad_s / SERVO.0;
        1.0 / ((1.0 - x * x).powi(2) + (2.0 * SERVO.1 * x).powi(2)).sqrt()
    }

    #[test]
    fn the_servo_settles_to_the_gain_of_its_formula() {
        let trace = logged(SWING, &exact(100.0, 0.0), [0.0; 3]);
        let late = &trace.motion[trace.motion.len() - 600..];
        let largest = late.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        // A sample may lie 5 ms from the peak: (ω·0.005)²/2 = 1.8e-5.
        assert!((largest / (0.2 * gain(1.2)) - 1.0).abs() < 3e-5, "{}", largest / (0.2 * gain(1.2)));
    }

    /// Work over a whole period: π D ω A² + (8/3) Q ω² A³; inertia takes none.
    #[test]
    fn over_a_whole_period_the_work_is_that_of_the_damping() {
        let swing = Swing { amplitude: 0.8, ..SWING };
        let [inertia, linear, square] = [10.3e-3, 2.1e-3, 3.7e-3];
        let trace = logged(swing, &exact(500.0, 0.0), [inertia, linear, square]);
        let (omega, n) = (swing.omega_rad_s, (TAU / swing.omega_rad_s * 500.0).round() as usize);
        let first = trace.time_s.len() - n - 10;
        let way = |i: usize| 0.5 * (trace.motion[i + 1] - trace.motion[i - 1]);
        let work: f64 = (first..first + n).map(|i| trace.loads[0][i] * way(i)).sum();
        let amplitude = swing.amplitude * gain(omega);
        let lost =
            0.5 * TAU * linear * omega * amplitude.powi(2) + 8.0 / 3.0 * square * omega.powi(2) * amplitude.powi(3);
        // The period is no whole number of samples: half of one in 2618 of the mean of a squared sine.
        assert!((work / lost - 1.0).abs() < 5e-4, "{work} {lost}");
    }

    #[test]
    fn a_delay_shifts_the_load_and_not_the_motion() {
        let [now, late] = [0.0, 0.05].map(|delay_s| logged(SWING, &exact(100.0, delay_s), [1.0, 4.0, 0.0]));
        assert_eq!(now.motion, late.motion);
        for i in 300..now.time_s.len() {
            // The two servos take other steps: a few times 3e-9 of the load.
            assert!((now.loads[0][i - 5] - late.loads[0][i]).abs() < 1e-6, "{i}");
        }
    }
}
