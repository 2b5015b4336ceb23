//! How far an axis goes after its torque is off, and how far before it can be at rest at all.
//!
//! **Setting.** One axis with inertia J, viscous friction B and Coulomb friction C, no other force: J dω/dt = −(C + Bω). A drag
//! in water only shortens the way and is left out. **Frame.** At the chain: v = Rω/n. **Units.** SI.
//!
//! With c = (C/J)(R/n) and b = B/J the way from speed v is (1/b)(v − (c/b) ln(1 + bv/c)), and v²/2c as b → 0. Since
//! ln(1 + u) ≥ 2u/(2 + u) it is never more than v²/(2c + bv): one division, no logarithm, for every tick.

use crate::config::Drive;

/// Friction as a deceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coast {
    /// c, m/s².
    pub coulomb_m_s2: f64,
    /// b, 1/s.
    pub viscous_1_s: f64,
}

/// Below this b v/c the closed form loses digits and its series takes over. The series' first dropped term is u⁵/7 of the way.
const SMALL: f64 = 1e-3;

impl Coast {
    /// With the lower bound of the drive's Coulomb friction.
    #[must_use]
    pub fn of(drive: &Drive) -> Self {
        let per_motor = drive.sprocket_radius_m / drive.gear_ratio;
        Self {
            coulomb_m_s2: drive.coulomb_lower_n_m / drive.inertia_kg_m2 * per_motor,
            viscous_1_s: drive.viscous_n_m_s_rad / drive.inertia_kg_m2,
        }
    }

    /// Coast distance from `speed_m_s` (its sign does not matter), m. Relative error below 1e-12.
    ///
    /// # Source
    ///
    /// v dv/dx = −(c + bv), integrated from v to 0.
    #[must_use]
    pub fn distance_m(&self, speed_m_s: f64) -> f64 {
        let v = libm::fabs(speed_m_s);
        let Self { coulomb_m_s2: c, viscous_1_s: b } = *self;
        let u = b * v / c;
        if u < SMALL {
            return v * v / c * (0.5 - u * (1.0 / 3.0 - u * (0.25 - u * (0.2 - u * (1.0 / 6.0)))));
        }
        if c <= 0.0 {
            return v / b;
        }
        (v - c / b * libm::log1p(u)) / b
    }

    /// An upper bound of [`Self::distance_m`], m: v²/(2c + bv). Above it by u²/12 at most, u = bv/c (1.5 % at u = 0.42, the
    /// paper's carriage at 0.55 m/s).
    #[must_use]
    pub fn bound_m(&self, speed_m_s: f64) -> f64 {
        let v = libm::fabs(speed_m_s);
        if v < 1e-9 {
            return 0.0;
        }
        v * v / (2.0 * self.coulomb_m_s2 + self.viscous_1_s * v)
    }
}

/// The way that must stay free ahead of an axis: it can then still be stopped by torque, and if the torque fails at any moment of that
/// stop it coasts to rest inside. That is ∫ v dv / min(A, c + bv), with A the acceleration of a controlled stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StoppingWay {
    coast: Coast,
    half_per_acceleration: f64,
    /// Speed above which friction alone is quicker than the controlled stop; it is braked with A there.
    crossover_m_s: f64,
    crossover_way_m: f64,
}

impl StoppingWay {
    /// For controlled stops at `acceleration_m_s2`.
    #[must_use]
    pub fn new(coast: Coast, acceleration_m_s2: f64) -> Self {
        let excess = acceleration_m_s2 - coast.coulomb_m_s2;
        let crossover_m_s = if excess <= 0.0 {
            0.0
        } else if coast.viscous_1_s > 0.0 {
            excess / coast.viscous_1_s
        } else {
            f64::MAX
        };
        let crossover_way_m = if crossover_m_s < 1e6 { coast.bound_m(crossover_m_s) } else { 0.0 };
        Self { coast, half_per_acceleration: 0.5 / acceleration_m_s2, crossover_m_s, crossover_way_m }
    }

    /// Way from `speed_m_s` (its sign does not matter), m.
    #[must_use]
    pub fn way_m(&self, speed_m_s: f64) -> f64 {
        let v = libm::fabs(speed_m_s);
        if v <= self.crossover_m_s {
            return self.coast.bound_m(v);
        }
        self.crossover_way_m + (v * v - self.crossover_m_s * self.crossover_m_s) * self.half_per_acceleration
    }

    /// How far beyond its target a move must have free way, m: the largest [`Self::way_m`] less what the move itself still has
    /// to go, over its braking from `peak_speed_m_s` at `acceleration_m_s2` or less.
    ///
    /// # Source
    ///
    /// The move still has v²/2a or more to go. The largest v²/(2c + bv) − v²/2a lies where w = 2c + bv = (a + √(a² + 8ca))/2.
    #[must_use]
    pub fn beyond_target_m(&self, peak_speed_m_s: f64, acceleration_m_s2: f64) -> f64 {
        let Coast { coulomb_m_s2: c, viscous_1_s: b } = self.coast;
        let a = acceleration_m_s2;
        let above = 0.5 * (a + libm::sqrt(a * a + 8.0 * c * a)) - 2.0 * c;
        if above <= 0.0 {
            return 0.0;
        }
        let limit = libm::fmin(peak_speed_m_s, self.crossover_m_s);
        let v = if b * limit > above { above / b } else { limit };
        libm::fmax(0.0, self.way_m(v) - v * v / (2.0 * a))
    }
}
