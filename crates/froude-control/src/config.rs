//! What the controller is told about the rig. Checked once, in [`crate::Controller`]'s `new`.

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
    /// J_eff, kg m².
    pub inertia_kg_m2: f64,
    /// B_eff, N m s/rad.
    pub viscous_n_m_s_rad: f64,
    /// C_eff, N m.
    pub coulomb_n_m: f64,
    /// Lower bound of C_eff for the coast distance, N m (its fitted interval's lower end).
    pub coulomb_lower_n_m: f64,
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
