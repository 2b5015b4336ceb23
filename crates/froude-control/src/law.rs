//! Constants of an axis, worked out once, so that a tick neither divides nor calls a library.

use crate::coast::{Coast, StoppingWay};
use crate::config::{AxisConfig, Limits};
use crate::shaper::Shaper;

/// Corner of the speed estimate that limits and fault detection use, Hz. Its delay (2 ms) at the paper's largest acceleration is
/// 2 mm/s; a count is then 1.2 mm/s, not 9.9.
pub const SPEED_FILTER_HZ: f64 = 80.0;

/// What one tick needs to know of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Law {
    pub limits: Limits,
    pub tick_s: f64,
    /// Signed: position per count.
    pub m_per_count: f64,
    pub counts_per_m: f64,
    /// n/R.
    pub rad_per_m: f64,
    pub proportional: f64,
    pub derivative: f64,
    /// K_i times the tick.
    pub integral_per_tick: f64,
    /// e of one count.
    pub count_rad: f64,
    pub derivative_share: f64,
    pub speed_share: f64,
    pub per_tick_s: f64,
    /// Feed-forward in volts per m/s², per m/s, whole, per m²/s².
    pub volts_inertia: f64,
    pub volts_viscous: f64,
    pub volts_coulomb: f64,
    pub volts_drag: f64,
    pub volts_coulomb_lower: f64,
    pub held_band: f64,
    /// The command never leaves ± this, V: the amplifier's range or the peak current, whichever is less.
    pub limit_v: f64,
    pub amplifier_a_v: f64,
    /// Longest time between ticks that is not late, µs.
    pub late_us: f64,
    /// How much the counts of a tick may change, per µs² of tick.
    pub jump_counts_us2: f64,
    /// How many counts the axis can go at all, per µs.
    pub top_counts_us: f64,
    /// What the speed estimate may lag behind for every volt above friction, m/s.
    pub lag_m_s_v: f64,
    /// Speed that a volt gives the whole inertia in a tick, m/s.
    pub m_s_per_v_tick: f64,
    /// Share of the thermal model's lag in a tick.
    pub heat_share: f64,
    pub per_continuous_a: f64,
    /// The limits' and the monitor's times in ticks.
    pub ticks: TickCounts,
    pub stopping: StoppingWay,
    pub coast: Coast,
    pub shaper: Shaper,
    /// Mode that is left unexcited, Hz; 0 is none.
    pub mode_hz: f64,
    /// Where targets may lie, m.
    pub soft_low_m: f64,
    pub soft_high_m: f64,
}

/// Times of an axis in ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TickCounts {
    pub second: u32,
    pub rest: u32,
    pub over_current: u32,
    pub mismatch: u32,
    pub stuck: u32,
    pub quiet: u32,
    pub astray: u32,
    pub saturation: u32,
}

/// How much more than J_eff and the peak current say the motor's acceleration may change in a tick: reaction of chain and load on the
/// motor alone, and torque ripple.
const ACCELERATION_MARGIN: f64 = 10.0;
/// The axis is at rest when it stays within a count for this long, s.
const REST_S: f64 = 0.1;
/// Without a count for this long it stands, or passes zero speed, s: at 1 m/s² a count either side of a reversal takes 4.5 ms.
const QUIET_S: f64 = 10e-3;
/// Running from the reference against the torque for this long is reversed polarity, s.
const ASTRAY_S: f64 = 5e-3;
/// Above the peak current for this long is over-current, s.
const OVER_CURRENT_S: f64 = 1e-3;
/// Off the commanded current for this long is over-current, s.
const MISMATCH_S: f64 = 10e-3;

impl Law {
    pub(crate) fn new(config: &AxisConfig, tick_us: u32, late_us: u32) -> Self {
        let AxisConfig { gains, drive, limits, .. } = config;
        let tick_s = f64::from(tick_us) * 1e-6;
        let rad_per_m = drive.gear_ratio / drive.sprocket_radius_m;
        let count_rad = 2.0 * core::f64::consts::PI / drive.counts_per_revolution;
        let n_m_per_v = drive.torque_constant_n_m_a * drive.amplifier_a_v;
        let coast = Coast::of(drive);
        let motor_m_s2 = drive.torque_constant_n_m_a * limits.current_a / (drive.inertia_kg_m2 * rad_per_m);
        let volts_inertia = drive.inertia_kg_m2 * rad_per_m / n_m_per_v;
        let ticks = |time_s: f64| ticks_in(time_s, 1.0 / tick_s);
        let share = |corner_hz: f64| 1.0 - libm::exp(-2.0 * core::f64::consts::PI * corner_hz * tick_s);
        Self {
            limits: *limits,
            tick_s,
            m_per_count: drive.encoder_sign * count_rad / rad_per_m,
            counts_per_m: rad_per_m / count_rad,
            rad_per_m,
            proportional: gains.proportional_v_rad,
            derivative: gains.derivative_v_s_rad,
            integral_per_tick: gains.integral_v_rad_s * tick_s,
            count_rad,
            derivative_share: share(gains.derivative_filter_hz),
            speed_share: share(SPEED_FILTER_HZ),
            per_tick_s: 1.0 / tick_s,
            volts_inertia,
            volts_viscous: drive.viscous_n_m_s_rad * rad_per_m / n_m_per_v,
            volts_coulomb: drive.coulomb_n_m / n_m_per_v,
            volts_drag: drive.drag_n_s2_m2 / (rad_per_m * n_m_per_v),
            volts_coulomb_lower: drive.coulomb_lower_n_m / n_m_per_v,
            held_band: drive.held_band,
            limit_v: libm::fmin(limits.command_v, limits.current_a / drive.amplifier_a_v),
            amplifier_a_v: drive.amplifier_a_v,
            late_us: f64::from(late_us),
            jump_counts_us2: ACCELERATION_MARGIN * motor_m_s2 * rad_per_m / count_rad * 1e-12,
            top_counts_us: 2.0 * limits.speed_m_s * rad_per_m / count_rad * 1e-6,
            lag_m_s_v: tick_s / (share(SPEED_FILTER_HZ) * volts_inertia),
            m_s_per_v_tick: tick_s / volts_inertia,
            heat_share: tick_s / limits.thermal_time_s,
            per_continuous_a: 1.0 / limits.continuous_current_a,
            ticks: TickCounts {
                second: ticks(1.0),
                rest: ticks(REST_S),
                over_current: ticks(OVER_CURRENT_S),
                mismatch: ticks(MISMATCH_S),
                stuck: ticks(limits.stuck_s),
                quiet: ticks(QUIET_S),
                astray: ticks(ASTRAY_S),
                saturation: ticks(limits.saturation_s),
            },
            stopping: StoppingWay::new(coast, limits.acceleration_m_s2),
            coast,
            shaper: config.shaper(),
            mode_hz: config.mode_hz,
            soft_low_m: libm::fmax(limits.hard_low_m, limits.low_switch_m) + limits.following_error_m,
            soft_high_m: libm::fmin(limits.hard_high_m, limits.high_switch_m) - limits.following_error_m,
        }
    }

    /// Drive command that the model wants for this speed and acceleration with friction against `direction`, V.
    pub(crate) fn volts_for(&self, acceleration_m_s2: f64, speed_m_s: f64, direction: f64) -> f64 {
        self.volts_inertia * acceleration_m_s2
            + self.volts_viscous * speed_m_s
            + self.volts_coulomb * direction
            + self.volts_drag * speed_m_s * libm::fabs(speed_m_s)
    }

    /// Ticks in `time_s`, at least one.
    pub(crate) fn ticks(&self, time_s: f64) -> u32 {
        ticks_in(time_s, self.per_tick_s)
    }
}

fn ticks_in(time_s: f64, per_tick_s: f64) -> u32 {
    let ticks = (time_s * per_tick_s + 0.5) as u32; // saturating
    if ticks < 1 { 1 } else { ticks }
}

/// The value within ± `limit`; NaN stays NaN.
pub(crate) fn held_within(value: f64, limit: f64) -> f64 {
    if value > limit {
        limit
    } else if value < -limit {
        -limit
    } else {
        value
    }
}

/// Far below anything that a volt or a metre per second can mean here, far above subnormal numbers, which cost a processor without
/// hardware for them hundreds of cycles.
const NOTHING: f64 = 1e-30;

/// The value, or zero before it becomes subnormal.
pub(crate) fn settled(value: f64) -> f64 {
    if libm::fabs(value) < NOTHING { 0.0 } else { value }
}
