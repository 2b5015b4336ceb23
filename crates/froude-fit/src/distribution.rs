//! Quantiles and tail probabilities that intervals and tests need.
//!
//! The only place that calls the library of distributions: it panics on arguments outside its ranges, and a load of 1e308 N or a
//! declared 1e-300 degrees of freedom bring such arguments about. Every argument is checked here; outside its range the answer is NaN,
//! or the limit where there is one.

use statrs::distribution::{Continuous, ContinuousCDF, Normal, StudentsT};
use statrs::function::beta::beta_reg;
use statrs::function::gamma::gamma_ur;

/// Above this many degrees of freedom the tail of Student's t is taken as
/// normal: they differ by less than 1e-8 of themselves up to |t| = 6.
const NORMAL_ABOVE: f64 = 1e9;
/// Above this many, quantiles come from Fisher's series in 1/dof, whose first
/// dropped term is below 1e-11; the incomplete beta function loses digits there.
const SERIES_ABOVE: f64 = 1e5;

/// Beyond this a quantile is infinite: its square, which the tail needs, is not a number any more.
const INFINITE_ABOVE: f64 = 1e150;

/// Two-sided coverage factor of Student's t: `P(|t| ≤ factor) = confidence`.
///
/// `dof` may be a fraction, or infinite (normal). `confidence` in (0, 1). NaN
/// outside these ranges; infinite where so few degrees of freedom (0.008 at 95 %) leave it above 1e150. Relative error
/// below 1e-10.
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
    // Far out the tail is (dof/x²)^(dof/2), within a factor of four to the dof: where that matters, x is no longer representable.
    if 0.5 * dof.ln() - (2.0 * tail).ln() / dof > INFINITE_ABOVE.ln() {
        return f64::INFINITY;
    }
    // Newton on the logarithm of the tail, which is smooth and nearly straight,
    // from the normal quantile, which is always below. A step at most doubles: some 500 reach the largest.
    let mut x = normal_quantile(1.0 - tail);
    let mut last_change = f64::INFINITY;
    for _ in 0..600 {
        if x.is_nan() || x > INFINITE_ABOVE {
            return f64::INFINITY;
        }
        let upper = 0.5 * t_two_sided(x, dof);
        let step = (upper / tail).ln() * upper / t.pdf(x);
        let next = (x + step).max(0.5 * x).min(2.0 * x);
        let change = (next - x).abs();
        x = next;
        // Steps halve their digits' distance each time; one that no longer shrinks is rounding of the tail.
        if change <= 1e-14 * x || (change < 1e-9 * x && change >= last_change) {
            break;
        }
        last_change = change;
    }
    x
}

/// Two-sided tail probability `P(|T| ≥ |t|)` of Student's t; NaN where `t` is none or `dof` is not positive.
#[must_use]
pub fn t_two_sided(t: f64, dof: f64) -> f64 {
    if dof > NORMAL_ABOVE {
        return 2.0 * normal_upper(t.abs());
    }
    if t.is_infinite() && dof > 0.0 {
        return 0.0;
    }
    beta(0.5 * dof, 0.5, dof / (dof + t * t))
}

/// Degrees of freedom at which Student's t has this two-sided 95 % factor; infinite below a normal's.
#[must_use]
pub fn dof_of_factor(factor: f64) -> f64 {
    if factor <= coverage_factor(0.95, f64::INFINITY) {
        return f64::INFINITY;
    }
    root(-2.0, 20.0, |log| t_two_sided(factor, log.exp()) > 0.05).exp()
}

/// Halvings of an interval that holds a root.
const HALVINGS: usize = 40;

/// Where a condition ends to hold between two numbers.
pub(crate) fn root(low: f64, high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Upper tail probability `P(F ≥ f)` of Fisher's F; NaN where a number of degrees of freedom is not positive or `dof_1` is infinite.
///
/// 1 where `f` is no number: what cannot be computed rejects nothing.
#[must_use]
pub fn f_upper(f: f64, dof_1: f64, dof_2: f64) -> f64 {
    if f.is_nan() || f <= 0.0 {
        return 1.0;
    }
    if f.is_infinite() {
        return 0.0;
    }
    if dof_2 == f64::INFINITY {
        return chi_squared_upper(dof_1 * f, dof_1);
    }
    beta(0.5 * dof_2, 0.5 * dof_1, dof_2 / (dof_2 + dof_1 * f))
}

/// Upper tail probability `P(χ² ≥ x)`; NaN where `dof` is not positive and finite.
///
/// 1 where `x` is no number: what cannot be computed rejects nothing.
#[must_use]
pub fn chi_squared_upper(x: f64, dof: f64) -> f64 {
    let (a, half) = (0.5 * dof, 0.5 * x);
    if x.is_nan() || half <= 0.0 {
        1.0
    } else if a.is_nan() || a <= 0.0 || a.is_infinite() {
        f64::NAN
    } else if half.is_infinite() {
        0.0
    } else if dof > NORMAL_ABOVE {
        // Wilson & Hilferty (1931); the incomplete gamma function takes as many terms as there are degrees of freedom.
        let spread = 2.0 / (9.0 * dof);
        normal_upper(((x / dof).cbrt() - (1.0 - spread)) / spread.sqrt())
    } else {
        gamma_ur(a, half).clamp(0.0, 1.0)
    }
}

/// Quantile of the standard normal distribution; NaN outside 0 to 1, infinite at its ends.
#[must_use]
pub fn normal_quantile(probability: f64) -> f64 {
    if !(0.0..=1.0).contains(&probability) {
        return f64::NAN;
    }
    Normal::new(0.0, 1.0).map_or(f64::NAN, |normal| normal.inverse_cdf(probability))
}

/// Upper tail probability of the standard normal distribution.
#[must_use]
pub fn normal_upper(x: f64) -> f64 {
    if x.is_nan() {
        return f64::NAN;
    }
    Normal::new(0.0, 1.0).map_or(f64::NAN, |normal| normal.sf(x))
}

/// `P(B ≤ x)` for a beta variable; NaN where there is none of these parameters.
pub(crate) fn beta_lower(x: f64, a: f64, b: f64) -> f64 {
    beta(a, b, x.clamp(0.0, 1.0))
}

/// The regularised incomplete beta function, NaN outside its range.
fn beta(a: f64, b: f64, x: f64) -> f64 {
    let is_possible = |p: f64| p > 0.0 && p.is_finite();
    if is_possible(a) && is_possible(b) && (0.0..=1.0).contains(&x) {
        beta_reg(a, b, x).clamp(0.0, 1.0)
    } else {
        f64::NAN
    }
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

    /// Whatever comes in: no panic, and no probability outside 0 to 1.
    #[test]
    fn no_argument_makes_a_distribution_panic() {
        let odd = [
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            0.0,
            -1.0,
            5e-324,
            1e-300,
            1e-12,
            0.5,
            1.0 - 1e-16,
            1.0,
            1e9,
            1e300,
            f64::MAX,
            f64::MIN,
        ];
        let is_probability = |p: f64| p.is_nan() || (0.0..=1.0).contains(&p);
        for a in odd {
            let _ = normal_quantile(a);
            assert!(is_probability(normal_upper(a)), "{a}");
            for b in odd {
                let k = coverage_factor(a, b);
                assert!(k.is_nan() || k >= 0.0, "{a} {b}: {k}");
                assert!(is_probability(t_two_sided(a, b)), "{a} {b}");
                assert!(is_probability(chi_squared_upper(a, b)), "{a} {b}");
                for c in odd {
                    assert!(is_probability(f_upper(a, b, c)), "{a} {b} {c}");
                    assert!(is_probability(beta_lower(a, b, c)), "{a} {b} {c}");
                }
            }
        }
    }

    #[test]
    fn the_factor_of_hardly_any_degrees_of_freedom_is_infinite() {
        assert_eq!(coverage_factor(0.95, 1e-300), f64::INFINITY);
        // P(|T| > x) ≈ (dof/x²)^(dof/2) for few degrees of freedom: x = √dof · 0.05^(−1/dof), within some dof · ln 4.
        let k = coverage_factor(0.95, 0.01);
        assert!((k / (0.1 * 0.05_f64.powf(-100.0))).ln().abs() < 2.0, "{k}");
    }

    #[test]
    fn f_with_infinite_degrees_below_is_chi_squared() {
        assert!((f_upper(1.5, 4.0, f64::INFINITY) - chi_squared_upper(6.0, 4.0)).abs() < 1e-15);
        assert!((f_upper(1.5, 4.0, 1e7) - chi_squared_upper(6.0, 4.0)).abs() < 1e-6);
    }
}
