//! Rotation about the body's own centre: a motor swings a body in water at rest, and a torque cell between shaft and body shows the moment. The twin
//! of that rig.
//!
//! The cell shows the moment of the rig on the body, m_m = J θ̈ + λ₁ θ̈ + λ₂ θ̇ + λ₃ θ̇|θ̇| + K sin θ, and the same of the shaft alone, which stays in the
//! water when the body is off.
//!
//! **Setting.** Rigid shaft, water at rest; the angle sensor is the common clock. **Units.** SI; angles in radians.
//!
//! | what                    | where                  | source    |
//! | ----------------------- | ---------------------- | --------- |
//! | body, shaft, servo      | [`RotationRig`]        | USR eq. 7 |
//! | clock, noise, steps     | [`RotationSensor`]     | –         |
//! | one run                 | [`RotationRig::turn`]  | –         |
//!
//! Not here: shafts that twist, swirl that the body leaves in a small tank, a motor that saturates.

use crate::swung::{Angle, Asked, Reading, log};

/// What hangs on the shaft, and in what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Mounted {
    /// The body in water.
    Body,
    /// The body in air.
    BodyInAir,
    /// The shaft without the body, in water.
    Shaft,
}

/// λ₁, λ₂, λ₃: kg m², N m s, N m s².
pub type Lambdas = [f64; 3];

/// Body, shaft and servo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationRig {
    /// J of all that moves below the torque cell, kg m².
    pub inertia_kg_m2: f64,
    /// J of it without the body, kg m².
    pub shaft_inertia_kg_m2: f64,
    /// Of the water on the body.
    pub lambdas: Lambdas,
    /// Of the water on the shaft.
    pub shaft: Lambdas,
    /// K of the restoring moment K sin θ in water, N m.
    pub restoring_n_m: f64,
    /// The same in air.
    pub restoring_in_air_n_m: f64,
    /// Natural frequency of the servo, rad/s.
    pub servo_rad_s: f64,
    /// Its damping ratio.
    pub servo_damping: f64,
}

/// What is read, and how well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationSensor {
    /// Samples a second.
    pub rate_hz: f64,
    /// Standard deviation of the angle's white noise, rad.
    pub angle_noise_rad: f64,
    /// Step of the angle, rad; 0 is none.
    pub angle_step_rad: f64,
    /// Standard deviation of the torque's white noise, N m.
    pub torque_noise_n_m: f64,
    /// Standard deviation of its slow noise, N m, …
    pub slow_noise_n_m: f64,
    /// … and the time over which that is correlated, s.
    pub correlation_s: f64,
    /// Step of the torque, N m; 0 is none.
    pub torque_step_n_m: f64,
    /// Zero of the torque cell, N m.
    pub zero_n_m: f64,
    /// The torque is stamped so much later than the angle, s.
    pub delay_s: f64,
}

impl RotationSensor {
    /// 100 Hz without any fault.
    #[must_use]
    pub fn exact() -> Self {
        Self {
            rate_hz: 100.0,
            angle_noise_rad: 0.0,
            angle_step_rad: 0.0,
            torque_noise_n_m: 0.0,
            slow_noise_n_m: 0.0,
            correlation_s: 0.5,
            torque_step_n_m: 0.0,
            zero_n_m: 0.0,
            delay_s: 0.0,
        }
    }
}

/// One run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// What is mounted.
    pub mounted: Mounted,
    /// α, rad.
    pub amplitude_rad: f64,
    /// ω, rad/s.
    pub omega_rad_s: f64,
    /// Time at rest on the log before it begins, s.
    pub still_s: f64,
    /// Periods after that.
    pub periods: f64,
}

/// What is logged of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RotationTrace {
    /// Time, s, in even steps from 0.
    pub time_s: Vec<f64>,
    /// θ as sensed, rad.
    pub angle_rad: Vec<f64>,
    /// Moment of the rig on the body as sensed, N m.
    pub torque_n_m: Vec<f64>,
}

impl RotationRig {
    /// One run as it is logged. The same seed gives the same log, bit for bit.
    #[must_use]
    pub fn turn(&self, turn: Turn, sensor: RotationSensor, seed: u64) -> RotationTrace {
        let asked = Asked {
            amplitude_rad: turn.amplitude_rad,
            omega_rad_s: turn.omega_rad_s,
            still_s: turn.still_s,
            periods: turn.periods,
            servo: (self.servo_rad_s, self.servo_damping),
        };
        let reading = Reading {
            rate_hz: sensor.rate_hz,
            angle_noise_rad: sensor.angle_noise_rad,
            angle_step_rad: sensor.angle_step_rad,
            load_noise: sensor.torque_noise_n_m,
            slow_noise: sensor.slow_noise_n_m,
            correlation_s: sensor.correlation_s,
            load_step: sensor.torque_step_n_m,
            zero: sensor.zero_n_m,
            drift_per_s: 0.0,
            delay_s: sensor.delay_s,
        };
        let [time_s, angle_rad, torque_n_m] = log(asked, reading, &|angle| self.torque_n_m(angle, turn.mounted), seed);
        RotationTrace { time_s, angle_rad, torque_n_m }
    }

    /// Moment of the rig on what is mounted, N m.
    fn torque_n_m(&self, [angle, rate, second]: Angle, mounted: Mounted) -> f64 {
        let fluid = |l: Lambdas| l[0] * second + l[1] * rate + l[2] * rate * rate.abs();
        match mounted {
            Mounted::Body => {
                self.inertia_kg_m2 * second
                    + fluid(self.lambdas)
                    + fluid(self.shaft)
                    + self.restoring_n_m * libm::sin(angle)
            }
            Mounted::BodyInAir => self.inertia_kg_m2 * second + self.restoring_in_air_n_m * libm::sin(angle),
            Mounted::Shaft => self.shaft_inertia_kg_m2 * second + fluid(self.shaft),
        }
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{PI, TAU};

    use super::*;

    const RIG: RotationRig = RotationRig {
        inertia_kg_m2: 3.4e-3,
        shaft_inertia_kg_m2: 0.2e-3,
        lambdas: [6.9e-3, 2.1e-3, 3.7e-3],
        shaft: [0.0; 3],
        restoring_n_m: 0.0,
        restoring_in_air_n_m: 0.0,
        servo_rad_s: 30.0,
        servo_damping: 0.6,
    };
    const TURN: Turn =
        Turn { mounted: Mounted::Body, amplitude_rad: 0.8, omega_rad_s: 1.2, still_s: 1.0, periods: 6.0 };

    /// Work over a whole period: π λ₂ ω A² + (8/3) λ₃ ω² A³; inertia takes none.
    #[test]
    fn over_a_whole_period_the_work_is_that_of_the_damping() {
        let trace = RIG.turn(TURN, RotationSensor { rate_hz: 500.0, ..RotationSensor::exact() }, 1);
        let (omega, n) = (TURN.omega_rad_s, (TAU / TURN.omega_rad_s * 500.0).round() as usize);
        let first = trace.time_s.len() - n - 10;
        let work: f64 = (first..first + n)
            .map(|i| trace.torque_n_m[i] * 0.5 * (trace.angle_rad[i + 1] - trace.angle_rad[i - 1]))
            .sum();
        // The servo's gain, 1/|1 − x² + 2iζx| at x = ω/ω_s.
        let x = omega / 30.0;
        let amplitude = 0.8 / ((1.0 - x * x).powi(2) + (1.2 * x).powi(2)).sqrt();
        let lost = PI * 2.1e-3 * omega * amplitude * amplitude + 8.0 / 3.0 * 3.7e-3 * omega * omega * amplitude.powi(3);
        // The period is no whole number of samples: half of one in 2618 of the mean of a squared sine.
        assert!((work / lost - 1.0).abs() < 5e-4, "{work} {lost}");
    }

    #[test]
    fn the_shaft_alone_shows_its_own_inertia_and_water() {
        let rig = RotationRig { shaft: [1e-4, 2e-4, 3e-4], ..RIG };
        let angle = [0.3, 0.5, -2.0];
        let shaft = rig.torque_n_m(angle, Mounted::Shaft);
        assert!((shaft - (0.3e-3 * -2.0 + 2e-4 * 0.5 + 3e-4 * 0.25)).abs() < 1e-15);
        // With the body on, its water is added to that of the body.
        let both = rig.torque_n_m(angle, Mounted::Body) - RIG.torque_n_m(angle, Mounted::Body);
        assert!((both - (1e-4 * -2.0 + 2e-4 * 0.5 + 3e-4 * 0.25)).abs() < 1e-15);
    }
}
