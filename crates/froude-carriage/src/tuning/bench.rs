//! The requirements that gains are held against: the measured response and the ramps to follow.

use std::f64::consts::TAU;

use froude_control::config::{AxisConfig, CountGains, Gains};
use froude_control::{FULL_FRICTION_M_S, SPEED_FILTER_HZ};

use crate::tuning::candidate::Candidate;
use crate::tuning::gains::Encoder;
use crate::tuning::margins::margins;
use crate::tuning::objections::objections;
use crate::tuning::resonance::{TwoMassModes, two_mass_modes};
use crate::tuning::tracking::{Forward, Ramp, Tracking, follow};
use crate::tuning::{LoopGains, ResponsePoint};

/// Time at the speed of a ramp that is foreseen, s: several swings of the heaviest load.
pub(crate) const HOLD_S: f64 = 1.0;

/// The loop of an axis as it is configured, and the hardest ramp that it must follow.
#[derive(Debug, Clone, Copy)]
pub struct ConfiguredLoop<'a> {
    /// The axis.
    pub axis: &'a AxisConfig,
    /// The controller's tick, µs.
    pub tick_us: u32,
    /// Fastest steady speed, m/s, and the acceleration to it, m/s².
    pub hardest_ramp: (f64, f64),
}

/// The requirements on candidates.
pub(super) struct Bench<'a> {
    plant: &'a [ResponsePoint],
    modes: Option<TwoMassModes>,
    axis: &'a AxisConfig,
    pub(super) encoder: Encoder,
    forward: Forward,
    /// The heaviest load over the bare one.
    load_factor: f64,
    ramps: Vec<(bool, f64, Ramp)>,
}

impl<'a> Bench<'a> {
    pub(super) fn new(of: ConfiguredLoop<'a>, plant: &'a [ResponsePoint]) -> Self {
        let axis = of.axis;
        let (drive, limits) = (&axis.drive, &axis.limits);
        let rad_m = drive.gear_ratio / drive.sprocket_radius_m;
        let per_v = 1.0 / (drive.torque_constant_n_m_a * drive.amplifier_a_v);
        let count_rad = TAU / drive.counts_per_revolution;
        let coulomb_v = drive.coulomb_n_m * per_v;
        let modes = two_mass_modes(plant).ok();
        // The heaviest body against the bare load.
        let motor_kg_m2 = modes.map_or(0.0, |m| drive.inertia_kg_m2 / (1.0 + m.inertia_ratio));
        let heaviest = ((drive.coast_inertia_kg_m2 - motor_kg_m2) / (drive.inertia_kg_m2 - motor_kg_m2)).max(1.0);
        let (fastest_m_s, acceleration_m_s2) = of.hardest_ramp;
        let mut ramps = Vec::new();
        for load_factor in [1.0, heaviest] {
            for friction_v in [drive.coulomb_lower_n_m * per_v, coulomb_v] {
                for (is_homing, speed_m_s, acceleration_m_s2) in [
                    (true, limits.unhomed_speed_m_s, limits.acceleration_m_s2),
                    (false, fastest_m_s, acceleration_m_s2),
                ] {
                    let (speed_rad_s, acceleration_rad_s2) = (speed_m_s * rad_m, acceleration_m_s2 * rad_m);
                    let ramp = Ramp { speed_rad_s, acceleration_rad_s2, hold_s: HOLD_S, friction_v };
                    ramps.push((is_homing, load_factor, ramp));
                }
            }
        }
        Self {
            plant,
            modes,
            axis,
            encoder: Encoder { count_rad, most_v: coulomb_v, tick_s: 1e-6 * f64::from(of.tick_us) },
            forward: Forward {
                inertia_v_s2_rad: drive.inertia_kg_m2 * per_v,
                viscous_v_s_rad: drive.viscous_n_m_s_rad * per_v,
                coulomb_v,
                full_friction_rad_s: FULL_FRICTION_M_S * rad_m,
                limit_v: limits.command_v.min(limits.current_a / drive.amplifier_a_v),
                count_rad,
                speed_filter_hz: SPEED_FILTER_HZ,
            },
            load_factor: heaviest,
            ramps,
        }
    }

    /// The model with the heaviest body.
    pub(super) fn heaviest(&self) -> Option<TwoMassModes> {
        self.modes.as_ref().map(|m| m.with_load(self.load_factor))
    }

    /// From a decade below what was measured to half the sampling rate.
    fn model_band_hz(&self) -> [f64; 2] {
        [0.1 * self.plant[0].frequency_hz, 0.5 / self.encoder.tick_s]
    }

    pub(super) fn candidate(&self, name: &str, gains: LoopGains) -> Candidate {
        let si = Gains {
            proportional_v_rad: gains.proportional_v_rad,
            derivative_v_s_rad: gains.derivative_v_s_rad,
            integral_v_rad_s: gains.integral_v_rad_s,
            derivative_filter_hz: gains.derivative_filter_hz,
        };
        let mut found = margins(self.plant, &gains);
        let mut is_extended = false;
        if let Some(modes) = self.modes.as_ref().filter(|_| !found.is_whole()) {
            let extended = modes.extended(self.plant, self.model_band_hz());
            (found, is_extended) = (margins(&extended, &gains), true);
        }
        let chain_m = self.axis.drive.sprocket_radius_m / self.axis.drive.gear_ratio;
        let worst = |is_asked: &dyn Fn(bool) -> bool| {
            let modes = self.modes.as_ref()?;
            let ramps = self.ramps.iter().filter(|r| is_asked(r.0));
            Some(
                ramps
                    .map(|r| follow(&modes.with_load(r.1), &gains, &self.forward, &r.2))
                    .fold(Tracking::default(), Tracking::or),
            )
        };
        let counts_per_revolution = self.axis.drive.counts_per_revolution;
        let tick_us = (1e6 * self.encoder.tick_s).round() as u32;
        let mut out = Candidate {
            name: name.to_owned(),
            gains,
            counts: CountGains::from_si(&si, counts_per_revolution, tick_us),
            margins: found,
            lowest_load_hz: self.heaviest().map(|m| m.load.frequency_hz),
            heaviest: self.heaviest().map(|m| margins(&m.extended(&[], self.model_band_hz()), &gains)),
            is_extended,
            volts_per_count: gains.volts_per_count(self.encoder.count_rad),
            following_error_m: worst(&|_| true).map(|t| t.error_rad * chain_m),
            homing_m_s: worst(&|is_homing| is_homing).map(|t| t.speed_rad_s * chain_m),
            objections: Vec::new(),
        };
        out.objections = objections(&out, &self.axis.limits, &self.encoder);
        out
    }
}
