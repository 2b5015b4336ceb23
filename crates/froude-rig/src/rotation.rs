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
//! | clock, noise, steps     | [`SwungSensor`]        | –         |
//! | one run                 | [`RotationRig::turn`]  | –         |
//!
//! Not here: shafts that twist, swirl that the body leaves in a small tank, a motor that saturates.

use crate::swung::{Angle, Swing, SwungSensor, SwungTrace, log};

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

impl RotationRig {
    /// One run as it is logged. The same seed gives the same log, bit for bit.
    #[must_use]
    pub fn turn(&self, mounted: Mounted, turn: Swing, sensor: SwungSensor, seed: u64) -> SwungTrace {
        let servo = (self.servo_rad_s, self.servo_damping);
        log(turn, servo, sensor, &|angle| self.torque_n_m(angle, mounted), seed)
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
    const TURN: Swing = Swing { amplitude_rad: 0.8, omega_rad_s: 1.2, still_s: 1.0, periods: 6.0 };

    /// Work over a whole period: π λ₂ ω A² + (8/3) λ₃ ω² A³; inertia takes none.
    #[test]
    fn over_a_whole_period_the_work_is_that_of_the_damping() {
        let trace = RIG.turn(Mounted::Body, TURN, SwungSensor { rate_hz: 500.0, ..SwungSensor::exact() }, 1);
        let (omega, n) = (TURN.omega_rad_s, (TAU / TURN.omega_rad_s * 500.0).round() as usize);
        let first = trace.time_s.len() - n - 10;
        let work: f64 =
            (first..first + n).map(|i| trace.load[i] * 0.5 * (trace.angle_rad[i + 1] - trace.angle_rad[i - 1])).sum();
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
