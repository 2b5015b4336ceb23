//! The power law `F = k·Uⁿ`.
//!
//! **Setting.** Resistance of one body on a straight course; `n = 2` is the quadratic
//! law of MCD, `F = D_d v|v|`.
//! **Units.** `F` in N, `U` in m/s; `k` in N·(s/m)ⁿ, that is newtons at 1 m/s.
//!
//! A free exponent and `k` are strongly correlated unless the speeds surround
//! 1 m/s; both need their error model stated (newtons, or log–log).

/// A resistance `k·Uⁿ`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// `k`, newtons at 1 m/s: N·(s/m)ⁿ.
    pub k_n: f64,
    /// `n` \[-\].
    pub exponent: f64,
}

impl PowerLaw {
    /// The quadratic law `F = k U|U|`, `k` in N s²/m².
    #[must_use]
    pub const fn quadratic(k_n_s2_m2: f64) -> Self {
        Self { k_n: k_n_s2_m2, exponent: 2.0 }
    }

    /// Resistance at a speed, N, odd in the speed: `k|U|ⁿ sign U`; zero at rest.
    ///
    /// It opposes the motion, so the fluid's force on the body is its negative.
    ///
    /// # Example
    ///
    /// ```
    /// use froude_hydro::power_law::PowerLaw;
    /// let rm2 = PowerLaw::quadratic(47.83); // UNH RM2 tare drag
    /// assert!((rm2.resistance_n(0.8) - 30.61).abs() < 0.01);
    /// assert_eq!(rm2.resistance_n(-0.8), -rm2.resistance_n(0.8));
    /// ```
    #[must_use]
    pub fn resistance_n(&self, speed_m_s: f64) -> f64 {
        if speed_m_s == 0.0 {
            return 0.0;
        }
        self.k_n * libm::copysign(libm::pow(speed_m_s.abs(), self.exponent), speed_m_s)
    }

    /// `(∂F/∂k, ∂F/∂n)` at a speed: `(Uⁿ, k Uⁿ ln U)`, odd as the law; zero at rest.
    #[must_use]
    pub fn sensitivity(&self, speed_m_s: f64) -> [f64; 2] {
        if speed_m_s == 0.0 {
            return [0.0, 0.0];
        }
        let speed = speed_m_s.abs();
        let by_k = libm::copysign(libm::pow(speed, self.exponent), speed_m_s);
        [by_k, self.k_n * by_k * libm::log(speed)]
    }

    /// Drag coefficient `C_D = F / (½ρAU²)` at a speed \[-\]; constant for `n = 2`.
    #[must_use]
    pub fn drag_coefficient(&self, density_kg_m3: f64, area_m2: f64, speed_m_s: f64) -> f64 {
        self.k_n * libm::pow(speed_m_s.abs(), self.exponent - 2.0) / (0.5 * density_kg_m3 * area_m2)
    }
}
