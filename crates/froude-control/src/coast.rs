//! How far an axis goes after its torque is off, and how far before it can be at rest at all.
//!
//! **Setting.** One axis with inertia J, viscous friction B and Coulomb friction C, no other force: J dω/dt = −(C + Bω). A drag
//! in water only shortens the way and is left out. **Frame.** At the chain: v = Rω/n. **Units.** SI.
//!
//! With c = (C/J)(R/n) and b = B/J the way from speed v is (1/b)(v − (c/b) ln(1 + u)), u = bv/c, and v²/2c as b → 0. Since
//! ln(1 + u) ≥ 3u(2 + u)/(6 + 6u + u²) it is never more than v²(3c + bv)/(6c² + 6c bv + (bv)²): one division and no logarithm, for
//! every tick.

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
    /// With the lower bounds of the drive's friction.
    #[must_use]
    pub fn of(drive: &Drive) -> Self {
        let per_motor = drive.sprocket_radius_m / drive.gear_ratio;
        Self {
            coulomb_m_s2: drive.coulomb_lower_n_m / drive.coast_inertia_kg_m2 * per_motor,
            viscous_1_s: drive.viscous_lower_n_m_s_rad / drive.coast_inertia_kg_m2,
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
        if c <= 0.0 {
            return v / b;
        }
        let u = b * v / c;
        if u < SMALL {
            return v * v / c * (0.5 - u * (1.0 / 3.0 - u * (0.25 - u * (0.2 - u * (1.0 / 6.0)))));
        }
        (v - c / b * libm::log1p(u)) / b
    }

    /// An upper bound of [`Self::distance_m`], m. Above it by a part of u³/90 at most, u = bv/c (0.1 % at 0.55 m/s on the
    /// paper's carriage, u = 0.42).
    ///
    /// # Source
    ///
    /// The diagonal Padé approximants of ln(1 + u) lie below it for u > 0; this is the one of order 2.
    #[must_use]
    pub fn bound_m(&self, speed_m_s: f64) -> f64 {
        let v = libm::fabs(speed_m_s);
        if v < NO_SPEED_M_S {
            return 0.0;
        }
        let Self { coulomb_m_s2: c, viscous_1_s: b } = *self;
        let bv = b * v;
        v * v * (3.0 * c + bv) / (6.0 * c * (c + bv) + bv * bv)
    }
}

/// Faster than any carriage.
const FASTEST_M_S: f64 = 1e3;
/// A count in a day.
const NO_SPEED_M_S: f64 = 1e-11;

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
        } else if coast.viscous_1_s * FASTEST_M_S > excess {
            excess / coast.viscous_1_s
        } else {
            FASTEST_M_S
        };
        let crossover_way_m = coast.bound_m(crossover_m_s);
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
    /// The move still has v²/2a or more to go. The largest coast less that lies where friction brakes as hard as the move, at
    /// c + bv = a. What [`Coast::bound_m`] is above the coast is added where it is largest, at the top.
    #[must_use]
    pub fn beyond_target_m(&self, peak_speed_m_s: f64, acceleration_m_s2: f64) -> f64 {
        let Coast { coulomb_m_s2: c, viscous_1_s: b } = self.coast;
        let a = acceleration_m_s2;
        let top = libm::fmin(peak_speed_m_s, self.crossover_m_s);
        let excess = libm::fmax(0.0, a - c);
        let v = if b * top > excess {
            excess / b
        } else if excess > 0.0 {
            top
        } else {
            0.0
        };
        let coast_m = libm::fmax(0.0, self.coast.distance_m(v) - v * v / (2.0 * a));
        coast_m + (self.coast.bound_m(top) - self.coast.distance_m(top))
    }
}
