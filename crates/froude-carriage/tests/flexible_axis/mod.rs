//! Records of an axis whose parameters are known, for tests of coverage.
//!
//! The axis is stepped ten times finer than the fit does, and only what a rig records comes out: the command, and
//! the motor's position in whole counts of its encoder.

// Each user takes a part of it.
#![allow(dead_code)]

use std::f64::consts::PI;

use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use froude_carriage::servo::flexible::{Stepper, TwoMass};
use froude_carriage::servo::{MotorSide, ServoError, ServoLog};
use froude_signal::two_mass::TwoMasses;

/// Step of the simulation, s.
const STEP_S: f64 = 5e-5;

/// The long axis of the carriage: `J_eff`, `B_eff`, `C_eff` of MCD Table II, a chain whose load swings at 13 Hz.
///
/// The paper gives only the sums; the shares of motor and load are ours.
#[must_use]
pub fn carriage() -> TwoMass {
    let at_chain = MotorSide::MCD.m_rad().powi(2);
    let (mass_kg, viscous, coulomb) = (1.502e-5 / at_chain, 4.657e-6 / at_chain, 3.9e-3 / MotorSide::MCD.m_rad());
    let load_mass_kg = 0.6 * mass_kg;
    let masses = TwoMasses {
        motor_mass_kg: mass_kg - load_mass_kg,
        load_mass_kg,
        stiffness_n_m: load_mass_kg * (2.0 * PI * 13.0).powi(2),
        damping_n_s_m: 0.08 * load_mass_kg * 2.0 * PI * 13.0,
        motor_viscous_n_s_m: 0.4 * viscous,
        load_viscous_n_s_m: 0.6 * viscous,
    };
    TwoMass {
        motor_coulomb_n: 0.35 * coulomb,
        load_coulomb_n: 0.65 * coulomb,
        force_per_volt_n_v: MotorSide::MCD.force_per_volt_n_v(),
        ..TwoMass::of(masses)
    }
}

/// What disturbs a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Counts of the encoder per metre of chain.
    pub counts_per_m: f64,
    /// White force on the motor that no column records, standard deviation per sample, N.
    pub force_std_n: f64,
}

impl Noise {
    /// The paper's encoder, 4000 counts a turn of the motor, and no disturbing force.
    #[must_use]
    pub fn encoder_only() -> Self {
        Self { counts_per_m: 4000.0 / (2.0 * PI * MotorSide::MCD.m_rad()), force_std_n: 0.0 }
    }
}

/// Pulses of 60 % duty and 1 s period in turn to both sides, then a sweep from 2 to 25 Hz, each for `half_s` seconds.
///
/// The seed draws amplitudes (within 10 %), the encoder's place within a count, and the noise.
///
/// # Errors
///
/// [`ServoError`] for an axis that cannot be.
pub fn record(axis: &TwoMass, rate_hz: f64, half_s: f64, noise: &Noise, seed: u64) -> Result<ServoLog, ServoError> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let pulse_v = 1.2 * rng.random_range(0.9..1.1);
    let sweep_v = 1.5 * rng.random_range(0.9..1.1);
    let within_count: f64 = rng.random_range(0.0..1.0);
    let n = (2.0 * half_s * rate_hz).round() as usize;
    let time_s: Vec<f64> = (0..n).map(|i| i as f64 / rate_hz).collect();
    let command_v: Vec<f64> = time_s
        .iter()
        .map(|&t| {
            if t < half_s {
                let direction = if t.rem_euclid(2.0) < 1.0 { 1.0 } else { -1.0 };
                if t.rem_euclid(1.0) < 0.6 { direction * pulse_v } else { 0.0 }
            } else {
                // Frequency rises linearly with time.
                let s = t - half_s;
                sweep_v * (2.0 * PI * (2.0 * s + 0.5 * 23.0 / half_s * s * s)).sin()
            }
        })
        .collect();
    let disturbed: Vec<f64> = command_v
        .iter()
        .map(|u| {
            let white: f64 = StandardNormal.sample(&mut rng);
            u + noise.force_std_n / axis.force_per_volt_n_v * white
        })
        .collect();
    let position_m = Stepper::new(axis, rate_hz.recip(), STEP_S)?
        .run(&disturbed, 0.0)?
        .into_iter()
        .map(|p| (p * noise.counts_per_m + within_count).floor() / noise.counts_per_m)
        .collect();
    Ok(ServoLog { time_s, position_m, command_v })
}
