//! A servo that swings a body, and the log of angle and load: what every rig with a motor and a load cell has in common.
//!
//! The servo follows α sin ωt from rest as a second-order system, overshoot and start-up included. The load is stamped late by a delay, with its zero,
//! drift, white and slow noise and its resolution.
//!
//! **Units.** SI; angles in radians; loads in N or N m.
//!
//! # Source
//!
//! Hairer et al. (1993), II.1 (the classical method of order four).

use core::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use crate::noise::OrnsteinUhlenbeck;
use crate::steady::stepped;

/// Longest step of the servo, as part of its own radian: (0.05)⁵/120 = 3e-9 of the angle in a step.
const STEP_RAD: f64 = 0.05;

/// Angle, its rate and second derivative, rad over s.
pub(crate) type Angle = [f64; 3];

/// How a body swings: α sin ωt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// α, rad.
    pub amplitude_rad: f64,
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

/// What is read, and how well; the load in its own unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SwungSensor {
    /// Samples a second.
    pub rate_hz: f64,
    /// Standard deviation of the angle's white noise, rad.
    pub angle_noise_rad: f64,
    /// Step of the angle, rad; 0 is none.
    pub angle_step_rad: f64,
    /// Standard deviation of the load's white noise.
    pub load_noise: f64,
    /// Standard deviation of its slow noise, …
    pub slow_noise: f64,
    /// … and the time over which that is correlated, s.
    pub correlation_s: f64,
    /// Step of the load; 0 is none.
    pub load_step: f64,
    /// Zero of the load cell.
    pub zero: f64,
    /// Drift of the zero over a second.
    pub drift_per_s: f64,
    /// The load is stamped so much later than the angle, s.
    pub delay_s: f64,
}

impl SwungSensor {
    /// One that shows the truth, 100 times a second.
    #[must_use]
    pub fn exact() -> Self {
        Self {
            rate_hz: 100.0,
            angle_noise_rad: 0.0,
            angle_step_rad: 0.0,
            load_noise: 0.0,
            slow_noise: 0.0,
            correlation_s: 0.5,
            load_step: 0.0,
            zero: 0.0,
            drift_per_s: 0.0,
            delay_s: 0.0,
        }
    }
}

/// What is logged of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SwungTrace {
    /// Time, s, in even steps from 0.
    pub time_s: Vec<f64>,
    /// Angle as sensed, rad.
    pub angle_rad: Vec<f64>,
    /// Load of the rig on the body as sensed, N or N m.
    pub load: Vec<f64>,
}

impl SwungTrace {
    /// With gains of angle and load that err.
    #[must_use]
    pub fn scaled(mut self, angle: f64, load: f64) -> Self {
        self.angle_rad.iter_mut().for_each(|x| *x *= angle);
        self.load.iter_mut().for_each(|x| *x *= load);
        self
    }
}

/// The log of a run; `servo` is its natural frequency, rad/s, and its damping ratio, `load` gives that of the rig on the body. The same seed gives the same log, bit for bit.
pub(crate) fn log(
    asked: Swing,
    servo: (f64, f64),
    sensor: SwungSensor,
    load: &dyn Fn(Angle) -> f64,
    seed: u64,
) -> SwungTrace {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let step_s = 1.0 / sensor.rate_hz;
    let mut slow = OrnsteinUhlenbeck::new(sensor.slow_noise, sensor.correlation_s, step_s, &mut rng);
    let samples = libm::round((asked.still_s + asked.periods * TAU / asked.omega_rad_s) * sensor.rate_hz) as usize;
    let mut out = SwungTrace::default();
    // The angle at the time of the stamp and at that of the load lie a fixed delay apart: two servos, one late.
    let (mut now, mut then) = (Servo::new(asked, servo), Servo::new(asked, servo));
    for i in 0..samples {
        let t = i as f64 * step_s;
        let [angle, ..] = now.at(t);
        let moved = then.at(t - sensor.delay_s);
        let z: [f64; 2] = core::array::from_fn(|_| rng.sample(StandardNormal));
        let there = load(moved) + sensor.zero + sensor.drift_per_s * t + sensor.load_noise * z[1] + slow.step(&mut rng);
        out.time_s.push(t);
        out.angle_rad.push(stepped(angle + sensor.angle_noise_rad * z[0], sensor.angle_step_rad));
        out.load.push(stepped(there, sensor.load_step));
    }
    out
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
        Self { asked, natural_and_damping, time_s: f64::NEG_INFINITY, state: [0.0; 2] }
    }

    fn second(&self, t: f64, [angle, rate]: [f64; 2]) -> f64 {
        let (natural, damping) = self.natural_and_damping;
        let asked = self.asked.amplitude_rad * libm::sin(self.asked.omega_rad_s * (t - self.asked.still_s));
        natural * natural * (asked - angle) - 2.0 * damping * natural * rate
    }

    /// The angle at a time; times increase from call to call. At rest until the motion begins.
    fn at(&mut self, time_s: f64) -> Angle {
        let begins = self.asked.still_s;
        if time_s <= begins {
            return [0.0; 3];
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
