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
}
