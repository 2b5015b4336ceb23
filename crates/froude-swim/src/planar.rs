//! Motion, load and inertia of a body in the plane, and how they pass a joint.
//!
//! **Frame.** Axes of a link at its centre: x forward along it, y to starboard, turning about z down. A motion is (ω, u, v), a load (N, X, Y) about the same point.
//! **Units.** SI.
//!
//! A link hangs with its front end on the rear end of the one before it and is turned against that by −φ. Its centre then moves as
//! X(φ) m = S_l Q(φ) S_p m with S_d (ω, u, v) = (ω, u, v − d ω) and Q the rotation; loads and inertias pass the other way by Xᵀ.
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

    /// I − w wᵀ d.
    #[must_use]
    pub(crate) fn without(&self, w: Load, d: f64) -> Self {
        Self {
            turn: self.turn - d * w[0] * w[0],
            turn_x: self.turn_x - d * w[0] * w[1],
            turn_y: self.turn_y - d * w[0] * w[2],
            x: self.x - d * w[1] * w[1],
            xy: self.xy - d * w[1] * w[2],
            y: self.y - d * w[2] * w[2],
        }
    }

    /// S_dᵀ I S_d.
    fn shifted(&self, d: f64) -> Self {
        Self {
            turn: self.turn - d * (2.0 * self.turn_y - d * self.y),
            turn_x: self.turn_x - d * self.xy,
            turn_y: self.turn_y - d * self.y,
            ..*self
        }
    }

    /// The motion that a load gives a free body at rest, I⁻¹ f; `None` where the inertia is not positive definite.
    #[must_use]
    pub fn solve(&self, f: Load) -> Option<Motion> {
        // Cholesky, the translations first: they are the better conditioned.
        let l11 = positive(self.x)?;
        let l21 = self.xy / l11;
        let l22 = positive(self.y - l21 * l21)?;
        let l31 = self.turn_x / l11;
        let l32 = (self.turn_y - l31 * l21) / l22;
        let l33 = positive(self.turn - l31 * l31 - l32 * l32)?;
        let z1 = f[1] / l11;
        let z2 = (f[2] - l21 * z1) / l22;
        let w = (f[0] - l31 * z1 - l32 * z2) / l33 / l33;
        let v = (z2 - l32 * w) / l22;
        Some([w, (z1 - l21 * v - l31 * w) / l11, v])
    }
}

fn positive(x: f64) -> Option<f64> {
    (x > 0.0).then(|| x.sqrt())
}

/// Power of a load on a motion, W.
#[must_use]
pub fn dot(f: Load, m: Motion) -> f64 {
    f[0] * m[0] + f[1] * m[1] + f[2] * m[2]
}

/// What the turning of the axes adds to the rate of a momentum h: ω × of its force part, and v × h of its moment.
#[must_use]
pub fn turned([w, u, v]: Motion, h: Load) -> Load {
    [u * h[2] - v * h[1], -w * h[2], w * h[1]]
}

/// A joint between a link and the one before it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Joint {
    cos: f64,
    sin: f64,
    /// Half-length of the link before it, m.
    before: f64,
    /// Half-length of the link itself, m.
    own: f64,
}

impl Joint {
    pub(crate) fn new(angle: f64, before: f64, own: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { cos, sin, before, own }
    }

    /// ∂ motion of the link/∂φ̇.
    pub(crate) fn axis(&self) -> Motion {
        [-1.0, 0.0, self.own]
    }

    /// sᵀ f.
    pub(crate) fn on_axis(&self, f: Load) -> f64 {
        self.own * f[2] - f[0]
    }

    /// X m.
    pub(crate) fn forward(&self, [w, u, v]: Motion) -> Motion {
        let v = v - self.before * w;
        [w, self.cos * u - self.sin * v, self.sin * u + self.cos * v - self.own * w]
    }

    /// Ẋ m for a motion that the link has by the one before it.
    pub(crate) fn bias(&self, [w, u, v]: Motion, rate: f64) -> Motion {
        [0.0, -rate * (v + self.own * w), rate * u]
    }

    /// Xᵀ f.
    pub(crate) fn back(&self, [n, x, y]: Load) -> Load {
        let n = n - self.own * y;
        let (x, y) = (self.cos * x + self.sin * y, self.cos * y - self.sin * x);
        [n - self.before * y, x, y]
    }

    /// Xᵀ I X.
    pub(crate) fn inertia_back(&self, inertia: &Inertia) -> Inertia {
        let i = inertia.shifted(self.own);
        let (c, s) = (self.cos, self.sin);
        let (cc, cs, ss) = (c * c, c * s, s * s);
        Inertia {
            turn: i.turn,
            turn_x: c * i.turn_x + s * i.turn_y,
            turn_y: c * i.turn_y - s * i.turn_x,
            x: cc * i.x + 2.0 * cs * i.xy + ss * i.y,
            xy: cs * (i.y - i.x) + (cc - ss) * i.xy,
            y: ss * i.x - 2.0 * cs * i.xy + cc * i.y,
        }
        .shifted(self.before)
    }
}
