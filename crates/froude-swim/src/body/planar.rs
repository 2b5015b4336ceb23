//! Motion, load and inertia of a body in the plane.
//!
//! **Frame.** Axes of a link at its centre: x forward along it, y to starboard, turning about z down. A motion is (ω, u, v), a load (N, X, Y) about the same point.
//! **Units.** SI.
//!
//! # Source
//!
//! Featherstone (2008), *Rigid Body Dynamics Algorithms*, 2.16 (vectors of the plane).

/// (ω, u, v): rad/s, m/s, m/s; or its rate.
pub type Motion = [f64; 3];
/// (N, X, Y): N m, N, N; or a momentum.
pub type Load = [f64; 3];

/// A symmetric 3 × 3 inertia.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inertia {
    /// Of turning, kg m².
    pub turn: f64,
    /// Coupling of turning and surge, kg m.
    pub turn_x: f64,
    /// Coupling of turning and sway, kg m.
    pub turn_y: f64,
    /// Of surge, kg.
    pub x: f64,
    /// Coupling of surge and sway, kg.
    pub xy: f64,
    /// Of sway, kg.
    pub y: f64,
}

impl Inertia {
    /// A rigid body of mass and inertia about its centre of mass, which lies `ahead_m` on the x axis.
    #[must_use]
    pub fn rigid(mass_kg: f64, inertia_kg_m2: f64, ahead_m: f64) -> Self {
        Self {
            turn: inertia_kg_m2 + mass_kg * ahead_m * ahead_m,
            turn_y: mass_kg * ahead_m,
            x: mass_kg,
            y: mass_kg,
            ..Self::default()
        }
    }

    /// Momentum of a motion.
    #[must_use]
    #[inline(always)]
    pub fn times(&self, [w, u, v]: Motion) -> Load {
        [
            self.turn * w + self.turn_x * u + self.turn_y * v,
            self.turn_x * w + self.x * u + self.xy * v,
            self.turn_y * w + self.xy * u + self.y * v,
        ]
    }

    /// Kinetic energy, J.
    #[must_use]
    pub fn energy(&self, motion: Motion) -> f64 {
        0.5 * dot(self.times(motion), motion)
    }

    /// Sum of two.
    #[must_use]
    #[inline(always)]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            turn: self.turn + other.turn,
            turn_x: self.turn_x + other.turn_x,
            turn_y: self.turn_y + other.turn_y,
            x: self.x + other.x,
            xy: self.xy + other.xy,
            y: self.y + other.y,
        }
    }

    /// The motion that a load gives a free body at rest, I⁻¹ f; `None` where the inertia is not positive definite.
    #[must_use]
    #[inline(always)]
    pub fn solve(&self, f: Load) -> Option<Motion> {
        // L D Lᵀ, the translations first: they are the better conditioned.
        let over_x = over(self.x)?;
        let (l21, l31) = (self.xy * over_x, self.turn_x * over_x);
        let over_y = over(self.y - l21 * self.xy)?;
        let turn_y = self.turn_y - l31 * self.xy;
        let l32 = turn_y * over_y;
        let over_turn = over(self.turn - l31 * self.turn_x - l32 * turn_y)?;
        let z2 = f[2] - l21 * f[1];
        let w = (f[0] - l31 * f[1] - l32 * z2) * over_turn;
        let v = z2 * over_y - l32 * w;
        Some([w, f[1] * over_x - l21 * v - l31 * w, v])
    }
}

/// 1/x of what is positive.
#[inline(always)]
fn over(x: f64) -> Option<f64> {
    (x > 0.0).then(|| 1.0 / x)
}

/// Power of a load on a motion, W.
#[must_use]
#[inline(always)]
pub fn dot(f: Load, m: Motion) -> f64 {
    f[0] * m[0] + f[1] * m[1] + f[2] * m[2]
}

/// What the turning of the axes adds to the rate of a momentum h: ω × of its force part, and v × h of its moment.
#[must_use]
#[inline(always)]
pub fn turned([w, u, v]: Motion, h: Load) -> Load {
    [u * h[2] - v * h[1], -w * h[2], w * h[1]]
}
