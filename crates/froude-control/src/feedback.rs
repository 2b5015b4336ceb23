//! The loop of eq. 6 with feed-forward.
//!
//! v_c = K_p e + K_d ė + K_i ∫e dt + feed-forward, e the motor angle's error \[rad\]. ė is filtered (first order). Anti-windup is
//! conditional: while the command is cut, the integral takes nothing that would push it further. At a standing reference
//! it also leaves an error of one count alone: it would only hunt in the friction.
//! Beyond an open end switch the command is cut at zero: the switch blocks what goes further, and a command that no current follows
//! would look like a fault of the amplifier.
//! Feed-forward is inertia, viscous friction, drag and Coulomb friction with the sign of the *reference* speed, smoothed: the measured
//! speed's sign would chatter.
//!
//! **Source.** eq. 6 of the motor-current paper; gains in its controller counts: see [`crate::config::CountGains`].

use crate::law::{Law, held_within, settled};
use crate::profile::State;

/// Reference speed at which the friction feed-forward is whole, m/s.
pub const FULL_FRICTION_M_S: f64 = 2e-3;
const PER_FULL_FRICTION: f64 = 1.0 / FULL_FRICTION_M_S;

/// Memory of the loop.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Feedback {
    integral_v: f64,
    derivative_rad_s: f64,
    last_error_rad: f64,
    last_v: f64,
}

/// A command and what cut it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cut {
    pub volts: f64,
    /// The range did.
    pub is_saturated: bool,
    /// An open end switch did: it blocks the drive towards its end, so nothing is asked there.
    pub is_blocked: bool,
}

/// Which ends are open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Ends {
    pub is_low: bool,
    pub is_high: bool,
}

impl Feedback {
    /// The last command without feed-forward, V.
    pub(crate) fn last_v(&self) -> f64 {
        self.last_v
    }

    pub(crate) fn step(&mut self, law: &Law, reference: State, position_m: f64, added_v: f64, ends: Ends) -> Cut {
        let error = (reference.position_m - position_m) * law.rad_per_m;
        let slope = (error - self.last_error_rad) * law.per_tick_s;
        self.last_error_rad = settled(error);
        self.derivative_rad_s = settled(self.derivative_rad_s + law.derivative_share * (slope - self.derivative_rad_s));

        let direction = held_within(reference.speed_m_s * PER_FULL_FRICTION, 1.0);
        let forward = law.volts_for(reference.acceleration_m_s2, reference.speed_m_s, direction);
        let is_standing = reference.speed_m_s == 0.0;
        let step_v =
            if is_standing && libm::fabs(error) <= 1.5 * law.count_rad { 0.0 } else { law.integral_per_tick * error };
        let integral = self.integral_v + step_v;
        self.last_v = law.proportional * error + law.derivative * self.derivative_rad_s + integral;
        let wanted = self.last_v + forward + added_v;
        let is_blocked = (ends.is_low && wanted < 0.0) || (ends.is_high && wanted > 0.0);
        let volts = if is_blocked { 0.0 } else { held_within(wanted, law.limit_v) };
        if is_blocked {
            // What the loop wanted has not acted: no detector may wait for its way.
            self.last_v = -(forward + added_v);
        }
        if volts == wanted || step_v * wanted < 0.0 {
            self.integral_v = settled(held_within(integral, law.limit_v));
        }
        Cut { volts, is_saturated: !is_blocked && volts != wanted, is_blocked }
    }
}
