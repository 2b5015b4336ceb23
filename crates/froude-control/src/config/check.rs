//! Which configurations may be driven.

use crate::config::{AxisConfig, Config, ConfigError, Drive, Gains, Limits};
use crate::law::Law;
use crate::shaper::Shaper;
use crate::tick::AXES;

impl Config {
    /// Accepts only what is finite, plausible and leaves room to coast.
    ///
    /// # Errors
    ///
    /// The first [`ConfigError`] found.
    pub fn check(&self) -> Result<(), ConfigError> {
        let tick = f64::from(self.tick_us);
        in_range(AXES, "tick_us", tick, 50.0, 10_000.0)?;
        in_range(AXES, "late_us", f64::from(self.late_us), tick, 1e6)?;
        in_range(AXES, "host_silence_us", f64::from(self.host_silence_us), tick, 60e6)?;
        self.axes.iter().enumerate().try_for_each(|(axis, config)| config.check(axis, self.tick_us, self.late_us))
    }
}

pub(crate) fn in_range(
    axis: usize,
    quantity: &'static str,
    found: f64,
    low: f64,
    high: f64,
) -> Result<(), ConfigError> {
    if found >= low && found <= high {
        Ok(())
    } else {
        Err(ConfigError::OutOfRange { axis, quantity, found, low, high })
    }
}

impl AxisConfig {
    /// What a shaped reference goes through: none without a mode.
    #[must_use]
    pub fn shaper(&self) -> Shaper {
        if self.mode_hz <= 0.0 {
            Shaper::NONE
        } else if self.is_robust_shaper {
            Shaper::zvd(self.mode_hz, self.mode_damping)
        } else {
            Shaper::zv(self.mode_hz, self.mode_damping)
        }
    }

    fn check(&self, axis: usize, tick_us: u32, late_us: u32) -> Result<(), ConfigError> {
        let Self { gains, drive, limits, .. } = self;
        let nyquist_hz = 0.5e6 / f64::from(tick_us);
        let ranges = [
            ("gains.proportional_v_rad", gains.proportional_v_rad, 0.0, 1e6),
            ("gains.derivative_v_s_rad", gains.derivative_v_s_rad, 0.0, 1e6),
            ("gains.integral_v_rad_s", gains.integral_v_rad_s, 0.0, 1e6),
            ("gains.derivative_filter_hz", gains.derivative_filter_hz, 0.1, nyquist_hz),
            ("drive.inertia_kg_m2", drive.inertia_kg_m2, 1e-9, 1e3),
            ("drive.coast_inertia_kg_m2", drive.coast_inertia_kg_m2, drive.inertia_kg_m2, 1e3),
            ("drive.viscous_n_m_s_rad", drive.viscous_n_m_s_rad, 0.0, 1e3),
            ("drive.viscous_lower_n_m_s_rad", drive.viscous_lower_n_m_s_rad, 0.0, drive.viscous_n_m_s_rad),
            ("drive.coulomb_n_m", drive.coulomb_n_m, 0.0, 1e3),
            ("drive.coulomb_lower_n_m", drive.coulomb_lower_n_m, 0.0, drive.coulomb_n_m),
            ("drive.held_band", drive.held_band, 0.0, 1.0),
            ("drive.drag_n_s2_m2", drive.drag_n_s2_m2, 0.0, 1e5),
            ("drive.torque_constant_n_m_a", drive.torque_constant_n_m_a, 1e-5, 1e3),
            ("drive.amplifier_a_v", drive.amplifier_a_v, 1e-4, 1e3),
            ("drive.gear_ratio", drive.gear_ratio, 1e-2, 1e4),
            ("drive.sprocket_radius_m", drive.sprocket_radius_m, 1e-4, 10.0),
            ("drive.counts_per_revolution", drive.counts_per_revolution, 4.0, 1e8),
            ("drive.encoder_sign squared", drive.encoder_sign * drive.encoder_sign, 1.0, 1.0),
            ("limits.hard_low_m", limits.hard_low_m, -1e3, 1e3),
            ("limits.hard_high_m", limits.hard_high_m, limits.hard_low_m, 1e3),
            ("limits.low_switch_m", limits.low_switch_m, limits.hard_low_m, limits.hard_high_m),
            ("limits.high_switch_m", limits.high_switch_m, limits.low_switch_m, limits.hard_high_m),
            ("limits.speed_m_s", limits.speed_m_s, 1e-3, 100.0),
            ("limits.unhomed_speed_m_s", limits.unhomed_speed_m_s, 1e-4, limits.speed_m_s),
            ("limits.acceleration_m_s2", limits.acceleration_m_s2, 1e-3, 1e3),
            ("limits.command_v", limits.command_v, 1e-3, 1e3),
            ("limits.current_a", limits.current_a, 1e-3, 1e3),
            ("limits.continuous_current_a", limits.continuous_current_a, 1e-3, limits.current_a),
            ("limits.thermal_time_s", limits.thermal_time_s, 0.1, 1e5),
            ("limits.following_error_m", limits.following_error_m, 1e-5, 1.0),
            ("limits.saturation_s", limits.saturation_s, 1e-3, 60.0),
            ("limits.polarity_m", limits.polarity_m, 1e-4, 1.0),
            ("limits.stuck_s", limits.stuck_s, 1e-3, 60.0),
            ("mode_hz", self.mode_hz, 0.0, nyquist_hz),
            ("mode_damping", self.mode_damping, 0.0, 0.9),
        ];
        for (quantity, found, low, high) in ranges {
            in_range(axis, quantity, found, low, high)?;
        }
        if self.mode_hz > 0.0 {
            in_range(axis, "mode_hz", self.mode_hz, 0.05, nyquist_hz)?;
        }
        if drive.coulomb_lower_n_m <= 0.0 && drive.viscous_lower_n_m_s_rad <= 0.0 {
            return Err(ConfigError::NoFriction { axis });
        }
        let law = Law::new(self, tick_us, late_us);
        let needed_v = law.volts_for(limits.acceleration_m_s2, limits.unhomed_speed_m_s, 1.0);
        if needed_v > law.limit_v {
            return Err(ConfigError::TooWeak { axis, needed_v, available_v: law.limit_v });
        }
        let needed_m = law.stopping.way_m(limits.over_speed_m_s(false));
        let rooms =
            [("low", limits.low_switch_m - limits.hard_low_m), ("high", limits.hard_high_m - limits.high_switch_m)];
        for (end, room_m) in rooms {
            if room_m < needed_m {
                return Err(ConfigError::SwitchTooClose { axis, end, room_m, needed_m });
            }
        }
        if law.soft_low_m >= law.soft_high_m {
            return Err(ConfigError::NoTravel { axis, low_m: law.soft_low_m, high_m: law.soft_high_m });
        }
        Ok(())
    }
}

impl AxisConfig {
    /// The long axis of the paper's carriage: the drive of its Table II, a 5 m tank, and gains of our own, because it gives no scale for its
    /// own (K_d/K_p = 0.1 s and T_i = 1 s are kept). Limits and switches are ours.
    ///
    /// Crossover 100 rad/s: K_d K_T K_amp / J_eff.
    pub const PUBLISHED: Self = Self {
        gains: Gains {
            proportional_v_rad: 1.6,
            derivative_v_s_rad: 0.16,
            integral_v_rad_s: 1.6,
            derivative_filter_hz: 150.0,
        },
        drive: Drive {
            inertia_kg_m2: 1.502e-5,
            coast_inertia_kg_m2: 1.502e-5,
            viscous_n_m_s_rad: 4.657e-6,
            viscous_lower_n_m_s_rad: 4.4e-6,
            coulomb_n_m: 3.9e-3,
            coulomb_lower_n_m: 3.5e-3,
            held_band: 0.0,
            drag_n_s2_m2: 0.0,
            torque_constant_n_m_a: 26.7e-3,
            amplifier_a_v: 0.352,
            gear_ratio: 34.97,
            sprocket_radius_m: 0.055,
            counts_per_revolution: 4000.0,
            encoder_sign: 1.0,
        },
        limits: Limits {
            hard_low_m: -0.05,
            hard_high_m: 4.95,
            low_switch_m: 0.0,
            high_switch_m: 4.9,
            speed_m_s: 0.6,
            unhomed_speed_m_s: 0.05,
            acceleration_m_s2: 1.0,
            command_v: 10.0,
            current_a: 5.0,
            continuous_current_a: 2.0,
            thermal_time_s: 20.0,
            following_error_m: 0.01,
            saturation_s: 0.1,
            encoder_errors_per_s: 10,
            polarity_m: 0.005,
            stuck_s: 0.05,
        },
        mode_hz: 0.0,
        mode_damping: 0.0,
        is_robust_shaper: true,
    };
}

impl Config {
    /// Both axes as [`AxisConfig::PUBLISHED`], 4 kHz.
    pub const PUBLISHED: Self =
        Self { axes: [AxisConfig::PUBLISHED; AXES], tick_us: 250, late_us: 1000, host_silence_us: 200_000 };
}
