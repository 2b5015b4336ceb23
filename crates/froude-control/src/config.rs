//! The controller's configuration of the rig. Checked once, in [`crate::Controller`]'s `new`.

use core::fmt;

use crate::axis::over_speed_m_s;
use crate::law::Law;
use crate::shaper::Shaper;
use crate::tick::AXES;

/// Gains of eq. 6 in SI: v_c = K_p e + K_d ė + K_i ∫e dt over the motor angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains {
    /// V per rad of the motor.
    pub proportional_v_rad: f64,
    /// V s per rad.
    pub derivative_v_s_rad: f64,
    /// V per rad s.
    pub integral_v_rad_s: f64,
    /// Corner of the derivative's first-order filter, Hz.
    pub derivative_filter_hz: f64,
}

/// Friction and inertia, referred to the motor, for feed-forward and for the coast distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// J_eff, kg m²: for the feed-forward.
    pub inertia_kg_m2: f64,
    /// The largest J_eff that any body gives the axis, kg m², its water and added mass included: for the coast distance.
    pub coast_inertia_kg_m2: f64,
    /// B_eff, N m s/rad.
    pub viscous_n_m_s_rad: f64,
    /// Lower bound of B_eff for the coast distance, N m s/rad.
    pub viscous_lower_n_m_s_rad: f64,
    /// C_eff, N m.
    pub coulomb_n_m: f64,
    /// Lower bound of C_eff for the coast distance, N m (its fitted interval's lower end).
    pub coulomb_lower_n_m: f64,
    /// Part of the command by which a held load may be held looser: 1 − η η_b of the gear, which loses both ways; 0 without loss.
    pub held_band: f64,
    /// Declared drag of the body, N s²/m² at the chain; 0 when dry.
    pub drag_n_s2_m2: f64,
    /// K_T, N m/A.
    pub torque_constant_n_m_a: f64,
    /// K_amp, A/V.
    pub amplifier_a_v: f64,
    /// n.
    pub gear_ratio: f64,
    /// R, m.
    pub sprocket_radius_m: f64,
    /// Counts per revolution of the motor, after decoding (the paper: 4000).
    pub counts_per_revolution: f64,
    /// +1 or −1: sign of counts for positive motion.
    pub encoder_sign: f64,
}

/// Limits of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Hard stops, m.
    pub hard_low_m: f64,
    /// Hard stop at the far end, m.
    pub hard_high_m: f64,
    /// Where the low end switch opens, m: homing gives the axis this coordinate there. The switch must block the drive towards
    /// its end only: homing has to leave it.
    pub low_switch_m: f64,
    /// Where the high end switch opens, m.
    pub high_switch_m: f64,
    /// Largest speed, m/s.
    pub speed_m_s: f64,
    /// Speed cap before homing, m/s.
    pub unhomed_speed_m_s: f64,
    /// Largest acceleration, m/s², also that of a controlled stop.
    pub acceleration_m_s2: f64,
    /// Amplifier's input range, V.
    pub command_v: f64,
    /// Peak current, A.
    pub current_a: f64,
    /// Continuous current, A.
    pub continuous_current_a: f64,
    /// Thermal time constant of the winding, s (I²t).
    pub thermal_time_s: f64,
    /// Following error, m.
    pub following_error_m: f64,
    /// How long the command may be saturated, s.
    pub saturation_s: f64,
    /// Illegal transitions allowed in one second.
    pub encoder_errors_per_s: u32,
    /// How far the wrong way, m, before polarity is called reversed (5 mm).
    pub polarity_m: f64,
    /// How long torque above breakaway without a count means a stuck encoder, s.
    pub stuck_s: f64,
}

impl Limits {
    /// Speed at which the over-speed fault comes, m/s: before homing, and in it, the cap is low.
    #[must_use]
    pub fn over_speed_m_s(&self, is_homed: bool) -> f64 {
        over_speed_m_s(self, is_homed)
    }
}

/// One axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisConfig {
    /// Gains.
    pub gains: Gains,
    /// The drive.
    pub drive: Drive,
    /// The limits.
    pub limits: Limits,
    /// Mode that a shaped reference leaves unexcited, Hz; 0 is none.
    pub mode_hz: f64,
    /// Its damping ratio.
    pub mode_damping: f64,
    /// Use the derivative shaper (ZVD) rather than ZV.
    pub is_robust_shaper: bool,
}

/// Both axes and the clocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    /// The axes.
    pub axes: [AxisConfig; crate::tick::AXES],
    /// Nominal tick, µs (250).
    pub tick_us: u32,
    /// A tick later than this after the last one is a fault, µs.
    pub late_us: u32,
    /// Host silence that stops the carriage, µs.
    pub host_silence_us: u32,
}

/// Gains as the paper prints them: per encoder count and, for the integral, per tick; times a scale that it does not give.
///
/// K_p/(4000 K_i) = 1.003 s at 4 kHz, hence K_i sums the error each tick while K_d (K_d/K_p = 0.100 s) takes its derivative per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CountGains {
    /// Per count.
    pub proportional: f64,
    /// Per count per second.
    pub derivative: f64,
    /// Per count, summed each tick.
    pub integral: f64,
    /// Volts of drive command per unit of the controller's output.
    pub volts_per_unit: f64,
}

impl CountGains {
    /// In SI, for a motor with `counts_per_revolution` and a tick of `tick_us`.
    #[must_use]
    pub fn to_si(&self, counts_per_revolution: f64, tick_us: u32, derivative_filter_hz: f64) -> Gains {
        let scale = self.volts_per_unit * counts_per_revolution / (2.0 * core::f64::consts::PI);
        Gains {
            proportional_v_rad: scale * self.proportional,
            derivative_v_s_rad: scale * self.derivative,
            integral_v_rad_s: scale * self.integral * 1e6 / f64::from(tick_us),
            derivative_filter_hz,
        }
    }

    /// From SI; the inverse of [`Self::to_si`] to rounding.
    #[must_use]
    pub fn from_si(gains: &Gains, counts_per_revolution: f64, tick_us: u32, volts_per_unit: f64) -> Self {
        let scale = 2.0 * core::f64::consts::PI / (volts_per_unit * counts_per_revolution);
        Self {
            proportional: scale * gains.proportional_v_rad,
            derivative: scale * gains.derivative_v_s_rad,
            integral: scale * gains.integral_v_rad_s * f64::from(tick_us) * 1e-6,
            volts_per_unit,
        }
    }
}

/// Why a configuration is not accepted.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ConfigError {
    /// A number is not finite or not plausible.
    OutOfRange {
        /// Axis; [`AXES`] when it belongs to none.
        axis: usize,
        /// Its name here.
        quantity: &'static str,
        /// What was found.
        found: f64,
        /// Least that is accepted.
        low: f64,
        /// Most that is accepted.
        high: f64,
    },
    /// Neither Coulomb nor viscous friction is declared: without torque the axis would never stop.
    NoFriction {
        /// Axis.
        axis: usize,
    },
    /// Between an end switch and its hard stop the axis cannot coast to rest.
    SwitchTooClose {
        /// Axis.
        axis: usize,
        /// `low` or `high`.
        end: &'static str,
        /// Way between switch and hard stop, m.
        room_m: f64,
        /// Coast from the speed at which homing is cut, m.
        needed_m: f64,
    },
    /// The command's range, or the peak current, cannot give the acceleration limit.
    TooWeak {
        /// Axis.
        axis: usize,
        /// Command for the acceleration limit against friction, V.
        needed_v: f64,
        /// Command that range and peak current allow, V.
        available_v: f64,
    },
    /// Nothing is left between the soft limits.
    NoTravel {
        /// Axis.
        axis: usize,
        /// Lower soft limit, m.
        low_m: f64,
        /// Upper soft limit, m.
        high_m: f64,
    },
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::OutOfRange { axis, quantity, found, low, high } if axis < AXES => {
                write!(f, "axis {axis}: {quantity} is {found}, must be in {low}..={high}")
            }
            Self::OutOfRange { quantity, found, low, high, .. } => {
                write!(f, "{quantity} is {found}, must be in {low}..={high}")
            }
            Self::NoFriction { axis } => {
                write!(
                    f,
                    "axis {axis}: no friction is declared, so no coast distance; give coulomb_lower_n_m or viscous_lower_n_m_s_rad"
                )
            }
            Self::SwitchTooClose { axis, end, room_m, needed_m } => write!(
                f,
                "axis {axis}: the {end} end switch is {room_m} m before its hard stop and the axis needs {needed_m} m to coast; \
                 lower unhomed_speed_m_s or move the switch"
            ),
            Self::TooWeak { axis, needed_v, available_v } => write!(
                f,
                "axis {axis}: the acceleration limit takes {needed_v} V and {available_v} V are allowed; lower acceleration_m_s2"
            ),
            Self::NoTravel { axis, low_m, high_m } => {
                write!(f, "axis {axis}: soft limits {low_m} m and {high_m} m leave no travel; lower following_error_m")
            }
        }
    }
}

impl core::error::Error for ConfigError {}

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

fn in_range(axis: usize, quantity: &'static str, found: f64, low: f64, high: f64) -> Result<(), ConfigError> {
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
        let needed_m = law.stopping.way_m(over_speed_m_s(limits, false));
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
