//! What a ramp does to the loop: following error and speed of the motor, on the two masses that the response showed.
//!
//! The margins say whether a loop is stable, not whether it holds. A soft loop lets the motor swing on its chain: the feed-forward for the
//! inertia of both masses meets the motor alone first. So the ramps of homing and towing are run through the identified drive
//! (MCD eq. 2 in units of the motor: acceleration k per volt, inertia ratio R, load mode ω_l), friction at the load that sticks, a held
//! command, counts, and the controller of MCD eq. 6 with feed-forward, tick by tick.
//!
//! **Units.** Motor angle, rad. Not here: drag of the body; a shaped reference, which only gets gentler.

use froude_signal::two_mass::TwoMasses;

use super::LoopGains;
use super::resonance::TwoMassModes;
use crate::servo::flexible::{Moment, Stepper, TwoMass};

/// A trapezoid of speed from rest to rest, and the friction that it meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// Speed reached, rad/s.
    pub speed_rad_s: f64,
    /// Acceleration, rad/s².
    pub acceleration_rad_s2: f64,
    /// Time at the speed, and at rest afterwards, s.
    pub hold_s: f64,
    /// Friction at the load, as the command that it takes, V.
    pub friction_v: f64,
}

/// The controller's reference, as command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forward {
    /// Inertia, V per rad/s².
    pub inertia_v_s2_rad: f64,
    /// Viscous friction, V per rad/s.
    pub viscous_v_s_rad: f64,
    /// Coulomb friction, V.
    pub coulomb_v: f64,
    /// Reference speed at which Coulomb friction is whole, rad/s.
    pub full_friction_rad_s: f64,
    /// Range of the command, V.
    pub limit_v: f64,
    /// One encoder count, rad.
    pub count_rad: f64,
    /// Corner of the speed estimate that the limits look at, Hz.
    pub speed_filter_hz: f64,
}

/// The worst of a ramp.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tracking {
    /// Largest following error, rad.
    pub error_rad: f64,
    /// Largest speed of the motor, as the limits see it, rad/s.
    pub speed_rad_s: f64,
}

impl Tracking {
    /// The worse of both.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self { error_rad: self.error_rad.max(other.error_rad), speed_rad_s: self.speed_rad_s.max(other.speed_rad_s) }
    }
}

/// Of a loop that runs away.
const NOWHERE: Tracking = Tracking { error_rad: f64::INFINITY, speed_rad_s: f64::INFINITY };

/// Follows a ramp. Infinite where the loop runs away.
#[must_use]
pub fn follow(modes: &TwoMassModes, gains: &LoopGains, forward: &Forward, ramp: &Ramp) -> Tracking {
    let tick_s = gains.tick_s.max(1e-5);
    let Ok(drive) = Stepper::new(&axis(modes, ramp), tick_s, tick_s) else {
        return NOWHERE;
    };
    let mut moment = Moment::AT_REST;
    let ramp_s = ramp.speed_rad_s / ramp.acceleration_rad_s2;
    let ticks = ((2.0 * (ramp_s + ramp.hold_s)) / tick_s).ceil() as usize;
    // Half a tick of the delay is the held command's own.
    let late = ((modes.delay_s / tick_s - 0.5).round().clamp(0.0, 8.0)) as usize;
    let mut pending = vec![0.0; late];
    let speed_share = 1.0 - (-std::f64::consts::TAU * forward.speed_filter_hz * tick_s).exp();
    let (mut integral_v, mut slope_rad_s, mut last_error, mut last_counted) = (0.0, 0.0, 0.0, 0.0);
    let (mut target_rad, mut seen_rad_s) = (0.0, 0.0);
    let mut out = Tracking::default();
    for i in 0..ticks {
        let (speed, acceleration) = trapezoid(ramp, ramp_s, i as f64 * tick_s);
        target_rad += speed * tick_s;
        let counted = (moment.motor_m() / forward.count_rad).round() * forward.count_rad;
        let error = target_rad - counted;
        seen_rad_s += speed_share * ((counted - last_counted) / tick_s - seen_rad_s);
        last_counted = counted;
        out = out.or(Tracking { error_rad: error.abs(), speed_rad_s: seen_rad_s.abs() });
        slope_rad_s += gains.filter_share() * ((error - last_error) / tick_s - slope_rad_s);
        last_error = error;
        integral_v += gains.integral_v_rad_s * tick_s * error;
        let wanted = gains.proportional_v_rad * error
            + gains.derivative_v_s_rad * slope_rad_s
            + integral_v
            + forward.inertia_v_s2_rad * acceleration
            + forward.viscous_v_s_rad * speed
            + forward.coulomb_v * (speed / forward.full_friction_rad_s).clamp(-1.0, 1.0);
        pending.push(wanted.max(-forward.limit_v).min(forward.limit_v));
        drive.sample(&mut moment, modes.gain_rad_s2_v * pending.remove(0));
        if !moment.motor_m().is_finite() {
            return NOWHERE;
        }
    }
    out
}

/// Both masses in units of the motor: its mass is 1, a metre is a radian, a force an acceleration.
fn axis(modes: &TwoMassModes, ramp: &Ramp) -> TwoMass {
    let load_rad_s = std::f64::consts::TAU * modes.load.frequency_hz;
    let ratio = modes.inertia_ratio;
    let masses = TwoMasses {
        motor_mass_kg: 1.0,
        load_mass_kg: ratio,
        stiffness_n_m: ratio * load_rad_s * load_rad_s,
        damping_n_s_m: ratio * 2.0 * modes.load.damping * load_rad_s,
        motor_viscous_n_s_m: 0.0,
        load_viscous_n_s_m: ratio * modes.viscous_1_s,
    };
    TwoMass { load_coulomb_n: modes.gain_rad_s2_v * ramp.friction_v, ..TwoMass::of(masses) }
}

/// Speed and acceleration of the reference.
fn trapezoid(ramp: &Ramp, ramp_s: f64, t: f64) -> (f64, f64) {
    let down_s = ramp_s + ramp.hold_s;
    if t < ramp_s {
        (ramp.acceleration_rad_s2 * t, ramp.acceleration_rad_s2)
    } else if t < down_s {
        (ramp.speed_rad_s, 0.0)
    } else if t < down_s + ramp_s {
        (ramp.speed_rad_s - ramp.acceleration_rad_s2 * (t - down_s), -ramp.acceleration_rad_s2)
    } else {
        (0.0, 0.0)
    }
}
