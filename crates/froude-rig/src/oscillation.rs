//! Forced oscillation: a body on a rod that a servo swings in a stream. The twin of that rig.
//!
//! The servo follows α sin ωt from rest as a second-order system, overshoot and start-up included (`swung`). The load cell between rod and body shows
//! f_m = m a − f_A − f_D − B sin φ (in air m a + m g sin φ), late by a delay, with its zero, drift, white and slow noise and its resolution.
//!
//! **Setting.** Rigid rod, even stream; the angle sensor is the common clock. **Units.** SI; angles in radians.
//!
//! | what                    | where                       | source                      |
//! | ----------------------- | --------------------------- | --------------------------- |
//! | body, water, servo      | [`OscillationRig`]          | USR eq. 16–20               |
//! | clock, noise, steps     | [`SwungSensor`]             | –                           |
//! | one run                 | [`OscillationRig::swing`]   | –                           |
//!
//! Not here: rods that bend, waves in the tank, a servo that saturates.

use froude_hydro::swing::{Kinematics, Medium, Pivot};

use crate::swung::{Angle, Swing, SwungSensor, SwungTrace, log};

/// Body, rod and servo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OscillationRig {
    /// How the pivot lies.
    pub pivot: Pivot,
    /// r, m.
    pub radius_m: f64,
    /// m, all below the load cell, kg.
    pub mass_kg: f64,
    /// C_A ρ V, kg.
    pub added_kg: f64,
    /// B: buoyancy less weight, N.
    pub buoyancy_n: f64,
    /// Natural frequency of the servo, rad/s.
    pub servo_rad_s: f64,
    /// Its damping ratio.
    pub servo_damping: f64,
}

impl OscillationRig {
    /// One run as it is logged, in a medium that streams at a speed, m/s; `drag_n` gives the force of the water's drag across the body at a velocity (v_x, v_y) through it, N.
    ///
    /// The same seed gives the same log, bit for bit.
    #[must_use]
    pub fn swing(
        &self,
        (medium, flow_m_s): (Medium, f64),
        swing: Swing,
        sensor: SwungSensor,
        drag_n: &dyn Fn([f64; 2]) -> f64,
        seed: u64,
    ) -> SwungTrace {
        let servo = (self.servo_rad_s, self.servo_damping);
        log(swing, servo, sensor, &|angle| self.force_n(angle, (medium, flow_m_s), drag_n), seed)
    }

    /// Force of the rig on the body along +y, N.
    fn force_n(&self, angle: Angle, (medium, flow_m_s): (Medium, f64), drag_n: &dyn Fn([f64; 2]) -> f64) -> f64 {
        let k = Kinematics::of(angle, self.pivot, self.radius_m, flow_m_s);
        let dry = self.mass_kg * k.per_mass(medium);
        match medium {
            Medium::Air => dry,
            Medium::Water => {
                dry + self.added_kg * k.sway_rate_m_s2 - drag_n(k.velocity_m_s) - self.buoyancy_n * k.upward
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;

    const RIG: OscillationRig = OscillationRig {
        pivot: Pivot::Stream,
        radius_m: 0.476,
        mass_kg: 1.6,
        added_kg: 1.7,
        buoyancy_n: 3.0,
        servo_rad_s: 30.0,
        servo_damping: 0.6,
    };
    const SWING: Swing = Swing { amplitude_rad: 0.2, omega_rad_s: 1.2, still_s: 1.0, periods: 6.0 };
    const STREAM: (Medium, f64) = (Medium::Water, 0.2);

    /// The gain of a second-order system, 1/|1 − x² + 2iζx| at x = ω/ω_s.
    #[test]
    fn the_servo_settles_to_the_gain_of_its_formula() {
        let trace = RIG.swing(STREAM, SWING, SwungSensor::exact(), &|_| 0.0, 1);
        let late: Vec<f64> = trace.angle_rad[trace.angle_rad.len() - 600..].to_vec();
        let largest = late.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let x = 1.2_f64 / 30.0;
        let gain = 1.0 / ((1.0 - x * x).powi(2) + (1.2 * x).powi(2)).sqrt();
        // A sample may lie 5 ms from the peak: (ω·0.005)²/2 = 1.8e-5.
        assert!((largest / (0.2 * gain) - 1.0).abs() < 3e-5, "{}", largest / (0.2 * gain));
    }

    /// Work of the rig over whole periods goes into drag: inertia and buoyancy take none.
    #[test]
    fn over_whole_periods_the_work_is_that_of_the_drag() {
        let drag = |[_, v]: [f64; 2]| -4.0 * v - 20.0 * v * v.abs();
        let trace = RIG.swing(STREAM, SWING, SwungSensor::exact(), &drag, 1);
        let period = TAU / SWING.omega_rad_s;
        let n = (period * 100.0).round() as usize;
        let first = trace.time_s.len() - n - 10;
        let speed = |i: usize| RIG.radius_m * (trace.angle_rad[i + 1] - trace.angle_rad[i - 1]) * 50.0;
        let work: f64 = (first..first + n).map(|i| trace.load[i] * speed(i) * 0.01).sum();
        let lost: f64 = (first..first + n).map(|i| -drag([0.2, speed(i)]) * speed(i) * 0.01).sum();
        // The period is no whole number of samples: 0.24 of one in 524, of the mean of a squared sine.
        assert!((work / lost - 1.0).abs() < 2e-3, "{work} {lost}");
    }

    #[test]
    fn a_delay_shifts_the_force_and_not_the_angle() {
        let drag = |[_, v]: [f64; 2]| -4.0 * v;
        let now = RIG.swing(STREAM, SWING, SwungSensor::exact(), &drag, 1);
        let late = RIG.swing(STREAM, SWING, SwungSensor { delay_s: 0.05, ..SwungSensor::exact() }, &drag, 1);
        assert_eq!(now.angle_rad, late.angle_rad);
        for i in 300..now.time_s.len() {
            // The two servos take other steps: a few times 3e-9 of some newtons.
            assert!((now.load[i - 5] - late.load[i]).abs() < 1e-6, "{i}");
        }
    }
}
