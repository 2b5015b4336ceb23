//! Huber's estimate: the scale and the pieces of its covariance.
//!
//! **Source.** Huber (1981), *Robust Statistics*, sections 7.6 to 7.8.

/// 1 / Φ⁻¹(3/4): makes the median absolute deviation estimate σ of a normal.
pub const MAD_FACTOR: f64 = 1.482_602_218_505_602;

/// `1.4826 · median |r|`: the scale of residuals that are centred at zero.
///
/// Half of the residuals may be arbitrarily large. Zero for no residuals.
#[must_use]
pub fn mad_scale(mut absolute: Vec<f64>) -> f64 {
    let n = absolute.len();
    if n == 0 {
        return 0.0;
    }
    for value in &mut absolute {
        *value = value.abs();
    }
    absolute.sort_by(f64::total_cmp);
    let median = if n % 2 == 1 { absolute[n / 2] } else { 0.5 * (absolute[n / 2 - 1] + absolute[n / 2]) };
    MAD_FACTOR * median
}

/// Huber's ψ: the residual itself, cut at ±k.
pub(crate) fn psi(residual: f64, k: f64) -> f64 {
    residual.clamp(-k, k)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_ignores_one_wild_residual() {
        let scale = mad_scale(vec![1.0, -1.0, 1.0, -1.0, 1e9]);
        assert!((scale - MAD_FACTOR).abs() < 1e-15);
        assert_eq!(mad_scale(Vec::new()), 0.0);
    }
}
