//! Quantiles and tail probabilities that intervals and tests need.

use statrs::distribution::{Continuous, ContinuousCDF, Normal, StudentsT};
use statrs::function::beta::beta_reg;
use statrs::function::gamma::gamma_ur;

/// Above this many degrees of freedom the tail of Student's t is taken as
/// normal: they differ by less than 1e-8 of themselves up to |t| = 6.
const NORMAL_ABOVE: f64 = 1e9;
/// Above this many, quantiles come from Fisher's series in 1/dof, whose first
/// dropped term is below 1e-11; the incomplete beta function loses digits there.
const SERIES_ABOVE: f64 = 1e5;

/// Two-sided coverage factor of Student's t: `P(|t| ≤ factor) = confidence`.
///
/// `dof` may be a fraction, or infinite (normal). `confidence` in (0, 1). NaN
/// outside these ranges. Relative error below 1e-10.
///
/// # Example
///
/// ```
/// // Any table of Student's t: 10 degrees of freedom, 95 %, two-sided.
/// assert!((froude_fit::distribution::coverage_factor(0.95, 10.0) - 2.228139).abs() < 1e-6);
/// ```
#[must_use]
pub fn coverage_factor(confidence: f64, dof: f64) -> f64 {
    if dof.is_nan() || dof <= 0.0 || !(confidence > 0.0 && confidence < 1.0) {
        return f64::NAN;
    }
    if dof > SERIES_ABOVE {
        // Abramowitz & Stegun (1964), 26.7.5.
        let z = normal_quantile(0.5 + 0.5 * confidence);
        let z2 = z * z;
        let first = z * (z2 + 1.0) / 4.0;
        let second = z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
        return z + (first + second / dof) / dof;
    }
    let Ok(t) = StudentsT::new(0.0, 1.0, dof) else {
        return f64::NAN;
    };
    let tail = 0.5 * (1.0 - confidence);
    // Newton on the logarithm of the tail, which is smooth and nearly straight,
    // from the normal quantile, which is always below.
    let mut x = normal_quantile(1.0 - tail);
    for _ in 0..200 {
        let upper = 0.5 * t_two_sided(x, dof);
        let step = (upper / tail).ln() * upper / t.pdf(x);
        let next = (x + step).clamp(0.5 * x, 2.0 * x);
        let is_done = (next - x).abs() <= 1e-14 * x;
        x = next;
        if is_done {
            break;
        }
    }
    x
}

/// Two-sided tail probability `P(|T| ≥ |t|)` of Student's t.
#[must_use]
pub fn t_two_sided(t: f64, dof: f64) -> f64 {
    if dof > NORMAL_ABOVE {
        return 2.0 * normal_upper(t.abs());
    }
    if t.is_infinite() {
        return 0.0;
    }
    beta_reg(0.5 * dof, 0.5, dof / (dof + t * t))
}

/// Upper tail probability `P(F ≥ f)` of Fisher's F.
#[must_use]
pub fn f_upper(f: f64, dof_1: f64, dof_2: f64) -> f64 {
    if f.is_nan() || f <= 0.0 {
        return 1.0;
    }
    if f.is_infinite() {
        return 0.0;
    }
    beta_reg(0.5 * dof_2, 0.5 * dof_1, dof_2 / (dof_2 + dof_1 * f))
}

/// Upper tail probability `P(χ² ≥ x)`.
#[must_use]
pub fn chi_squared_upper(x: f64, dof: f64) -> f64 {
    if x.is_nan() || x <= 0.0 { 1.0 } else { gamma_ur(0.5 * dof, 0.5 * x) }
}

/// Quantile of the standard normal distribution.
#[must_use]
pub fn normal_quantile(probability: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(f64::NAN, |normal| normal.inverse_cdf(probability))
}

/// Upper tail probability of the standard normal distribution.
#[must_use]
pub fn normal_upper(x: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(f64::NAN, |normal| normal.sf(x))
}

/// `P(B ≤ x)` for a beta variable.
pub(crate) fn beta_lower(x: f64, a: f64, b: f64) -> f64 {
    beta_reg(a, b, x.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Standard tables, two-sided 95 % (and 99 %), as printed.
    #[test]
    fn coverage_factors_match_the_printed_table() {
        for (confidence, dof, printed) in [
            (0.95, 1.0, 12.706),
            (0.95, 2.0, 4.303),
            (0.95, 3.0, 3.182),
            (0.95, 5.0, 2.571),
            (0.95, 9.0, 2.262),
            (0.95, 30.0, 2.042),
            (0.95, 120.0, 1.980),
            (0.99, 4.0, 4.604),
            (0.99, 60.0, 2.660),
        ] {
            let k = coverage_factor(confidence, dof);
            assert!((k - printed).abs() <= 0.0005, "{confidence} {dof}: {k}");
        }
    }

    #[test]
    fn the_factor_of_one_and_two_degrees_has_a_closed_form() {
        for confidence in [0.5, 0.9, 0.95, 0.999] {
            let cauchy = (0.5 * std::f64::consts::PI * confidence).tan();
            assert!((coverage_factor(confidence, 1.0) / cauchy - 1.0).abs() < 1e-10);
            let two = confidence * (2.0_f64 / (1.0 - confidence * confidence)).sqrt();
            assert!((coverage_factor(confidence, 2.0) / two - 1.0).abs() < 1e-10);
        }
    }

    #[test]
    fn many_degrees_of_freedom_approach_the_normal_factor() {
        let normal = coverage_factor(0.95, f64::INFINITY);
        assert!((normal - 1.959963984540054).abs() < 1e-10);
        for dof in [1e4, 1e6, 1e8] {
            // Cornish–Fisher, first term: z + (z³ + z)/(4 dof).
            let expected = normal + (normal.powi(3) + normal) / (4.0 * dof);
            let k = coverage_factor(0.95, dof);
            assert!((k - expected).abs() < 10.0 / (dof * dof) + 1e-12, "{dof}");
        }
    }

    #[test]
    fn the_series_meets_the_iteration() {
        for confidence in [0.5, 0.95, 0.9999] {
            let below = coverage_factor(confidence, 0.9999 * SERIES_ABOVE);
            let above = coverage_factor(confidence, 1.0001 * SERIES_ABOVE);
            let slope = 0.0002 * (below.powi(3) + below) / (4.0 * SERIES_ABOVE);
            assert!((below - above - slope).abs() < 1e-10, "{confidence}");
        }
    }

    #[test]
    fn f_with_one_degree_is_the_square_of_t() {
        let p = f_upper(2.5 * 2.5, 1.0, 7.0);
        assert!((p - t_two_sided(2.5, 7.0)).abs() < 1e-13);
    }

    #[test]
    fn chi_squared_with_two_degrees_is_exponential() {
        assert!((chi_squared_upper(3.0, 2.0) - (-1.5_f64).exp()).abs() < 1e-13);
    }
}
