//! The controller's configuration of the rig. Checked once, in [`crate::Controller`]'s `new`.

mod check;

use core::fmt;

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
        if is_homed {
            OVER_SPEED_FACTOR * self.speed_m_s + SPEED_NOISE_M_S
        } else {
            UNHOMED_OVER_SPEED_FACTOR * self.unhomed_speed_m_s + SPEED_NOISE_M_S
        }
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

/// Gains per encoder count and, for the integral, per tick, in volts; the paper prints them so, times a scale that it does not give.
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
}

impl CountGains {
    /// From SI, for a motor with `counts_per_revolution` and a tick of `tick_us`.
    #[must_use]
    pub fn from_si(gains: &Gains, counts_per_revolution: f64, tick_us: u32) -> Self {
        let scale = 2.0 * core::f64::consts::PI / counts_per_revolution;
        Self {
            proportional: scale * gains.proportional_v_rad,
            derivative: scale * gains.derivative_v_s_rad,
            integral: scale * gains.integral_v_rad_s * f64::from(tick_us) * 1e-6,
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

/// Over-speed is called at this factor of the speed limit plus what quantisation may add.
pub(crate) const OVER_SPEED_FACTOR: f64 = 1.1;

/// Before homing the cap is low and friction may let go suddenly.
pub(crate) const UNHOMED_OVER_SPEED_FACTOR: f64 = 1.5;

/// Four counts of the speed estimate at 4 kHz, m/s.
pub(crate) const SPEED_NOISE_M_S: f64 = 5e-3;
