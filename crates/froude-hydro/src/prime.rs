//! Prime (dimensionless) derivatives and their SI values.
//!
//! **Setting.** A load written as a sum of derivatives times products of motion
//! variables, all of them dimensionless: `Y' = Y'_v v' + Y'_vvr v'² r' + …`.
//! **Units.** SI on one side, `[-]` on the other; the scale carries `ρ`, `L`, `U` and
//! the reference area, without which a prime means nothing.
//!
//! | quantity             | divisor                     |
//! |----------------------|-----------------------------|
//! | force                | `½ρ U² A`                   |
//! | moment               | `½ρ U² A L`                 |
//! | velocity             | `U`                         |
//! | angular rate         | `U / L`                     |
//! | acceleration         | `U² / L`                    |
//! | angular acceleration | `U² / L²`                   |
//! | mass, inertia        | `½ρ A L`, `½ρ A L³`         |
//!
//! The area is `L²` (SNAME 1950, "prime system I") or `L·T` (ship manoeuvring).

/// What a prime is scaled with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrimeScale {
    /// `ρ`, kg/m³.
    pub density_kg_m3: f64,
    /// `U`, m/s.
    pub speed_m_s: f64,
    /// `L`, m.
    pub length_m: f64,
    /// `A`, m².
    pub area_m2: f64,
}

/// A load that a derivative contributes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Load {
    /// X, Y or Z.
    Force,
    /// K, M or N.
    Moment,
}

/// How often each kind of motion variable stands beside a derivative.
///
/// `Y_vvr` has two velocities and one rate; `Y_0` none; angles count as numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MotionPowers {
    /// u, v, w.
    pub velocity: i32,
    /// p, q, r.
    pub rate: i32,
    /// u̇, v̇, ẇ.
    pub acceleration: i32,
    /// ṗ, q̇, ṙ.
    pub angular_acceleration: i32,
}

impl PrimeScale {
    /// Area `L²`: SNAME's prime system.
    #[must_use]
    pub fn with_length_squared(density_kg_m3: f64, speed_m_s: f64, length_m: f64) -> Self {
        Self { density_kg_m3, speed_m_s, length_m, area_m2: length_m * length_m }
    }

    /// Area `L·T`: ship manoeuvring, `T` the draught.
    #[must_use]
    pub fn with_length_draught(density_kg_m3: f64, speed_m_s: f64, length_m: f64, draught_m: f64) -> Self {
        Self { density_kg_m3, speed_m_s, length_m, area_m2: length_m * draught_m }
    }

    /// `½ρU²A`, N.
    #[must_use]
    pub fn force_n(&self) -> f64 {
        0.5 * self.density_kg_m3 * self.speed_m_s * self.speed_m_s * self.area_m2
    }

    /// `½ρU²A L`, N m.
    #[must_use]
    pub fn moment_n_m(&self) -> f64 {
        self.force_n() * self.length_m
    }

    /// `½ρAL`, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        0.5 * self.density_kg_m3 * self.area_m2 * self.length_m
    }

    /// `½ρAL³`, kg m².
    #[must_use]
    pub fn inertia_kg_m2(&self) -> f64 {
        self.mass_kg() * self.length_m * self.length_m
    }

    /// SI value of a derivative whose prime is one.
    ///
    /// `load / (U^a (U/L)^b (U²/L)^c (U²/L²)^d)`; multiply a prime by it, divide an SI
    /// value by it.
    ///
    /// # Example
    ///
    /// The scale of `Y'_v|v|` of a 2.9 m model at 1.17 m/s, area `L·T`, is free of speed:
    ///
    /// ```
    /// use froude_hydro::prime::{Load, MotionPowers, PrimeScale};
    /// let scale = PrimeScale::with_length_draught(998.8, 1.17, 2.902, 0.189);
    /// let quadratic = MotionPowers { velocity: 2, ..MotionPowers::default() };
    /// let si = scale.si_per_prime(Load::Force, quadratic);
    /// assert!((si - 0.5 * 998.8 * 2.902 * 0.189).abs() < 1e-9); // N s²/m²
    /// ```
    #[must_use]
    pub fn si_per_prime(&self, load: Load, powers: MotionPowers) -> f64 {
        let (u, l) = (self.speed_m_s, self.length_m);
        let numerator = match load {
            Load::Force => self.force_n(),
            Load::Moment => self.moment_n_m(),
        };
        numerator
            / (whole_power(u, powers.velocity)
                * whole_power(u / l, powers.rate)
                * whole_power(u * u / l, powers.acceleration)
                * whole_power(u * u / (l * l), powers.angular_acceleration))
    }
}

/// `xⁿ` for whole `n`, exact where a product of factors is.
fn whole_power(x: f64, n: i32) -> f64 {
    let product = (0..n.unsigned_abs().min(64)).fold(1.0, |p, _| p * x);
    if n < 0 { 1.0 / product } else { product }
}
