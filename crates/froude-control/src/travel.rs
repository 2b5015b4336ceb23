//! What is refused before it moves, and what is still stoppable while it moves.
//!
//! A move is accepted only if, after the loss of torque at any moment of it, the coast ends before the hard stop although the axis is
//! ahead by the allowed following error and 10 mm/s faster than asked; its target keeps the following error's distance from the end
//! switches too. While it moves, a quarter of the following error is kept free.

use crate::config::SPEED_NOISE_M_S;
use crate::config::{AxisConfig, Config};
use crate::excite::{Asked, Exciter};
use crate::law::Law;
use crate::profile::{Bounds, Profile};
use crate::request::{Excitation, Move};
use crate::shaper::{ShapedProfile, Shaper};
use crate::status::Refusal;

/// Slowest, gentlest and softest that a request may ask for. Below these a move takes hours.
const SLOWEST_M_S: f64 = 1e-5;
const GENTLEST_M_S2: f64 = 1e-4;
const SOFTEST_M_S3: f64 = 1e-3;
/// Longest single move or excitation, s.
const LONGEST_S: f64 = 7200.0;
/// How much faster than its reference an axis may be without leaving the way that was checked, m/s: ringing of the chain.
const SPEED_MARGIN_M_S: f64 = 0.01;
/// Longest jog before homing, m.
const JOG_M: f64 = 0.1;

/// Whether the axis can still be brought to rest `guard_m` before the hard stop ahead, by torque or without it.
pub(crate) fn is_stoppable(law: &Law, position_m: f64, speed_m_s: f64, guard_m: f64) -> bool {
    let way_m = law.stopping.way_m(speed_m_s) + guard_m;
    if speed_m_s > 0.0 {
        position_m + way_m <= law.limits.hard_high_m
    } else {
        position_m - way_m >= law.limits.hard_low_m
    }
}

/// Whether the axis can still be brought to rest inside the range of targets.
pub(crate) fn is_inside_soft(law: &Law, position_m: f64, speed_m_s: f64) -> bool {
    let way_m = law.stopping.way_m(speed_m_s);
    if speed_m_s > SPEED_NOISE_M_S {
        position_m + way_m <= law.soft_high_m
    } else if speed_m_s < -SPEED_NOISE_M_S {
        position_m - way_m >= law.soft_low_m
    } else {
        true
    }
}

fn is_within(value: f64, low: f64, high: f64) -> bool {
    value >= low && value <= high // false for NaN
}

/// What a move would take, before anything moves. [`preflight`] gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preflight {
    /// Why the controller would refuse the move from there, if it would. What follows then stands for the move all the same, as far as its
    /// numbers are in range.
    pub refusal: Option<Refusal>,
    /// Duration with shaping, s.
    pub duration_s: f64,
    /// Largest drive command that the model foresees, V.
    pub command_v: f64,
    /// Drive command that range and peak current allow, V.
    pub available_v: f64,
    /// Where targets may lie: lower end, m.
    pub soft_low_m: f64,
    /// Upper end, m.
    pub soft_high_m: f64,
    /// Way that must be free behind the target, coast and margins included, m.
    pub needed_m: f64,
    /// Way from the target to the hard stop behind it, m.
    pub free_m: f64,
}

/// What `asked` would take from rest at `start_m`, by the same rules as the controller's.
#[must_use]
pub fn preflight(config: &Config, axis: &AxisConfig, start_m: f64, asked: &Move) -> Preflight {
    let law = Law::new(axis, config.tick_us, config.late_us);
    foresee(&law, start_m, asked).0
}

/// Why the controller would refuse `asked` on a homed axis at rest at `start_m`; `None` where it would not.
#[must_use]
pub fn preflight_excitation(config: &Config, axis: &AxisConfig, start_m: f64, asked: &Excitation) -> Option<Refusal> {
    let law = Law::new(axis, config.tick_us, config.late_us);
    checked_excitation(&law, start_m, true, asked).err()
}

/// Where an open-loop excitation takes a rigid axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excursion {
    /// When the controller ends it because it would leave the soft limits, s; `None` where it is done to its end.
    pub cut_s: Option<f64>,
    /// Where it ends or is cut, m.
    pub end_m: f64,
}

/// What moves under an open-loop excitation, referred to the motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid {
    /// Inertia with what rides along, kg m².
    pub inertia_kg_m2: f64,
    /// Viscous friction, N m s/rad.
    pub viscous_n_m_s_rad: f64,
    /// Coulomb friction, N m.
    pub coulomb_n_m: f64,
}

/// Foresees pulses, a relay or a jog that the controller accepts on a homed axis at rest at `start_m`: the controller's own signal, speed
/// cap and soft limits on a rigid axis, tick by tick. A sweep, whose loop is closed, ends where its reference does.
#[must_use]
pub fn foresee_excitation(
    config: &Config,
    axis: &AxisConfig,
    start_m: f64,
    asked: &Excitation,
    on: Rigid,
) -> Excursion {
    let law = Law::new(axis, config.tick_us, config.late_us);
    let mut exciter = Exciter::new(asked, &law, start_m);
    let mut excursion = Excursion { cut_s: None, end_m: start_m };
    if !exciter.is_open_loop() || checked_excitation(&law, start_m, true, asked).is_err() {
        return excursion;
    }
    let m_s2_per_n_m = 1.0 / (law.rad_per_m * on.inertia_kg_m2);
    let m_s2_per_v = axis.drive.torque_constant_n_m_a * axis.drive.amplifier_a_v * m_s2_per_n_m;
    let (coulomb_m_s2, viscous_1_s) = (on.coulomb_n_m * m_s2_per_n_m, on.viscous_n_m_s_rad / on.inertia_kg_m2);
    let (mut position_m, mut speed_m_s, mut ticks) = (start_m, 0.0_f64, 0_u32);
    while is_inside_soft(&law, position_m, speed_m_s) {
        let Asked::Open(volts) = exciter.step(position_m, true) else {
            excursion.end_m = position_m;
            return excursion;
        };
        let is_capped = libm::copysign(1.0, volts) * speed_m_s >= law.limits.speed_m_s;
        let free_m_s =
            speed_m_s + law.tick_s * (if is_capped { 0.0 } else { m_s2_per_v * volts } - viscous_1_s * speed_m_s);
        // Friction takes at most what there is.
        let lost_m_s = libm::fmin(coulomb_m_s2 * law.tick_s, libm::fabs(free_m_s));
        speed_m_s = free_m_s - libm::copysign(lost_m_s, free_m_s);
        position_m += speed_m_s * law.tick_s;
        ticks = ticks.saturating_add(1);
    }
    Excursion { cut_s: Some(f64::from(ticks) * law.tick_s), end_m: position_m }
}

/// Checks a move from rest at `start_m` and plans it.
pub(crate) fn checked_move(law: &Law, start_m: f64, asked: &Move) -> Result<ShapedProfile, Refusal> {
    let (preflight, shaped) = foresee(law, start_m, asked);
    preflight.refusal.map_or(Ok(shaped), Err)
}

fn foresee(law: &Law, start_m: f64, asked: &Move) -> (Preflight, ShapedProfile) {
    let limits = &law.limits;
    let is_in_range = is_within(asked.target_m, -1e6, 1e6)
        && is_within(asked.speed_m_s, SLOWEST_M_S, limits.speed_m_s)
        && is_within(asked.acceleration_m_s2, GENTLEST_M_S2, limits.acceleration_m_s2)
        && (asked.jerk_m_s3 == 0.0 || is_within(asked.jerk_m_s3, SOFTEST_M_S3, 1e9));
    let bounds =
        Bounds { speed_m_s: asked.speed_m_s, acceleration_m_s2: asked.acceleration_m_s2, jerk_m_s3: asked.jerk_m_s3 };
    let profile = if is_in_range { Profile::plan(start_m, asked.target_m, bounds) } else { Profile::none(start_m) };
    let shaped = ShapedProfile::new(profile, if asked.is_shaped { law.shaper } else { Shaper::NONE });
    let (speed, acceleration) = (profile.peak_speed_m_s(), profile.peak_acceleration_m_s2());
    // The stopping way is convex: no lower speed adds more for the margin.
    let faster_m = law.stopping.way_m(speed + SPEED_MARGIN_M_S) - law.stopping.way_m(speed);
    let way_m = if is_in_range { law.stopping.beyond_target_m(speed, asked.acceleration_m_s2) } else { 0.0 };
    let is_up = profile.direction() > 0.0;
    let target_m = profile.target_m();
    let foreseen = Preflight {
        refusal: None,
        duration_s: shaped.duration_s(),
        command_v: law.volts_for(acceleration, speed, 1.0),
        available_v: law.limit_v,
        soft_low_m: law.soft_low_m,
        soft_high_m: law.soft_high_m,
        needed_m: way_m + faster_m + limits.following_error_m,
        free_m: if is_up { limits.hard_high_m - target_m } else { target_m - limits.hard_low_m },
    };
    let is_possible = foreseen.duration_s <= LONGEST_S && foreseen.command_v <= law.limit_v;
    let is_inside = is_within(target_m, law.soft_low_m, law.soft_high_m) && foreseen.needed_m <= foreseen.free_m;
    let refusal = if !is_in_range {
        Some(Refusal::OutOfRange)
    } else if !is_inside {
        Some(Refusal::BeyondTravel)
    } else if !is_possible {
        Some(Refusal::OutOfRange)
    } else {
        None
    };
    (Preflight { refusal, ..foreseen }, shaped)
}

/// Checks an excitation at rest at `start_m`; gives the speed that the reference is to have below it, m/s.
pub(crate) fn checked_excitation(law: &Law, start_m: f64, is_homed: bool, asked: &Excitation) -> Result<f64, Refusal> {
    let is_time = |time_s: f64| is_within(time_s, law.tick_s, LONGEST_S);
    let is_volts = |volts: f64| is_within(volts, -law.limit_v, law.limit_v);
    let (is_in_range, speed_m_s) = match *asked {
        Excitation::Pulses { volts, period_s, duty, duration_s } => {
            (is_volts(volts) && is_time(period_s) && is_time(duration_s) && is_within(duty, 0.0, 1.0), 0.0)
        }
        Excitation::Relay { volts, hysteresis_m, duration_s } => {
            (is_volts(volts) && is_within(hysteresis_m, 0.0, law.limits.following_error_m) && is_time(duration_s), 0.0)
        }
        Excitation::Sweep { volts, from_hz, to_hz, duration_s, speed_m_s } => {
            let is_frequency = |hz: f64| is_within(hz, 1e-3, 0.25 * law.per_tick_s);
            let top_m_s = law.limits.speed_m_s;
            let is_all = is_volts(volts)
                && is_frequency(from_hz)
                && is_within(to_hz, from_hz, f64::MAX)
                && is_frequency(to_hz)
                && is_time(duration_s)
                && is_within(speed_m_s, -top_m_s, top_m_s);
            (is_all, speed_m_s)
        }
        Excitation::Jog { volts, distance_m, duration_s } => {
            (is_volts(volts) && is_within(distance_m, 0.0, JOG_M) && is_time(duration_s), 0.0)
        }
    };
    if !is_in_range {
        return Err(Refusal::OutOfRange);
    }
    if !is_homed {
        return Ok(speed_m_s);
    }
    // The reference's own way: ramp, constant speed, and the way that must stay free.
    let way_m = match *asked {
        Excitation::Sweep { duration_s, speed_m_s, .. } => {
            let ramp_s = libm::fabs(speed_m_s) / law.limits.acceleration_m_s2;
            let end_m = libm::copysign(law.stopping.way_m(speed_m_s), speed_m_s);
            speed_m_s * (0.5 * ramp_s + duration_s) + end_m
        }
        _ => 0.0,
    };
    let is_free = is_within(start_m, law.soft_low_m, law.soft_high_m)
        && is_within(start_m + way_m, law.soft_low_m, law.soft_high_m);
    if is_free { Ok(speed_m_s) } else { Err(Refusal::BeyondTravel) }
}
