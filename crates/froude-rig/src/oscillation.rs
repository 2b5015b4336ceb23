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
//! | clock, noise, steps     | [`OscillationSensor`]       | –                           |
//! | one run                 | [`OscillationRig::swing`]   | –                           |
//!
//! Not here: rods that bend, waves in the tank, a servo that saturates.

use froude_hydro::swing::{Kinematics, Medium, Pivot};

use crate::swung::{Angle, Asked, Reading, log};

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

/// What is read, and how well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OscillationSensor {
    /// Samples a second.
    pub rate_hz: f64,
    /// Standard deviation of the angle's white noise, rad.
    pub angle_noise_rad: f64,
    /// Step of the angle, rad; 0 is none.
    pub angle_step_rad: f64,
    /// Standard deviation of the force's white noise, N.
    pub force_noise_n: f64,
    /// Standard deviation of its slow noise, N, …
    pub slow_noise_n: f64,
    /// … and the time over which that is correlated, s.
    pub correlation_s: f64,
    /// Step of the force, N; 0 is none.
    pub force_step_n: f64,
    /// Zero of the load cell, N.
    pub zero_n: f64,
    /// Drift of the zero, N/s.
    pub drift_n_s: f64,
    /// The force is stamped so much later than the angle, s.
    pub delay_s: f64,
}

impl OscillationSensor {
    /// 100 Hz without any fault.
    #[must_use]
    pub fn exact() -> Self {
        Self {
            rate_hz: 100.0,
            angle_noise_rad: 0.0,
            angle_step_rad: 0.0,
            force_noise_n: 0.0,
            slow_noise_n: 0.0,
            correlation_s: 0.5,
            force_step_n: 0.0,
            zero_n: 0.0,
            drift_n_s: 0.0,
            delay_s: 0.0,
        }
    }
}

/// One run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// In water or in air.
    pub medium: Medium,
    /// α, rad.
    pub amplitude_rad: f64,
    /// ω, rad/s.
    pub omega_rad_s: f64,
    /// U, m/s.
    pub flow_m_s: f64,
    /// Time at rest on the log before it begins, s.
    pub still_s: f64,
    /// Periods after that.
    pub periods: f64,
}

/// What is logged of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OscillationTrace {
    /// Time, s, in even steps from 0.
    pub time_s: Vec<f64>,
    /// φ as sensed, rad.
    pub angle_rad: Vec<f64>,
    /// Force of the rig on the body along +y as sensed, N.
    pub force_n: Vec<f64>,
}

impl OscillationRig {
    /// One run as it is logged; `drag_n` gives the force of the water's drag across the body at a velocity (v_x, v_y) through it, N.
    ///
    /// The same seed gives the same log, bit for bit.
    #[must_use]
    pub fn swing(
        &self,
        swing: Swing,
        sensor: OscillationSensor,
        drag_n: &dyn Fn([f64; 2]) -> f64,
        seed: u64,
    ) -> OscillationTrace {
        let asked = Asked {
            amplitude_rad: swing.amplitude_rad,
            omega_rad_s: swing.omega_rad_s,
            still_s: swing.still_s,
            periods: swing.periods,
            servo: (self.servo_rad_s, self.servo_damping),
        };
        let reading = Reading {
            rate_hz: sensor.rate_hz,
            angle_noise_rad: sensor.angle_noise_rad,
            angle_step_rad: sensor.angle_step_rad,
            load_noise: sensor.force_noise_n,
            slow_noise: sensor.slow_noise_n,
            correlation_s: sensor.correlation_s,
            load_step: sensor.force_step_n,
            zero: sensor.zero_n,
            drift_per_s: sensor.drift_n_s,
            delay_s: sensor.delay_s,
        };
        let [time_s, angle_rad, force_n] = log(asked, reading, &|angle| self.force_n(angle, swing, drag_n), seed);
        OscillationTrace { time_s, angle_rad, force_n }
    }

    /// Force of the rig on the body along +y, N.
    fn force_n(&self, angle: Angle, swing: Swing, drag_n: &dyn Fn([f64; 2]) -> f64) -> f64 {
        let k = Kinematics::of(angle, self.pivot, self.radius_m, swing.flow_m_s);
        let dry = self.mass_kg * k.per_mass(swing.medium);
        match swing.medium {
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
    const SWING: Swing = Swing {
        medium: Medium::Water,
        amplitude_rad: 0.2,
        omega_rad_s: 1.2,
        flow_m_s: 0.2,
        still_s: 1.0,
        periods: 6.0,
    };

    /// The gain of a second-order system, 1/|1 − x² + 2iζx| at x = ω/ω_s.
    #[test]
    fn the_servo_settles_to_the_gain_of_its_formula() {
        let trace = RIG.swing(SWING, OscillationSensor::exact(), &|_| 0.0, 1);
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
        let trace = RIG.swing(SWING, OscillationSensor::exact(), &drag, 1);
        let period = TAU / SWING.omega_rad_s;
        let n = (period * 100.0).round() as usize;
        let first = trace.time_s.len() - n - 10;
        let speed = |i: usize| RIG.radius_m * (trace.angle_rad[i + 1] - trace.angle_rad[i - 1]) * 50.0;
        let work: f64 = (first..first + n).map(|i| trace.force_n[i] * speed(i) * 0.01).sum();
        let lost: f64 = (first..first + n).map(|i| -drag([0.2, speed(i)]) * speed(i) * 0.01).sum();
        // The period is no whole number of samples: 0.24 of one in 524, of the mean of a squared sine.
        assert!((work / lost - 1.0).abs() < 2e-3, "{work} {lost}");
    }

    #[test]
    fn a_delay_shifts_the_force_and_not_the_angle() {
        let drag = |[_, v]: [f64; 2]| -4.0 * v;
        let now = RIG.swing(SWING, OscillationSensor::exact(), &drag, 1);
        let late = RIG.swing(SWING, OscillationSensor { delay_s: 0.05, ..OscillationSensor::exact() }, &drag, 1);
        assert_eq!(now.angle_rad, late.angle_rad);
        for i in 300..now.time_s.len() {
            // The two servos take other steps: a few times 3e-9 of some newtons.
            assert!((now.force_n[i - 5] - late.force_n[i]).abs() < 1e-6, "{i}");
        }
    }
}
