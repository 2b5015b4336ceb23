//! Exact probabilities of ratios of quadratic forms of least-squares residuals.
//!
//! With independent normal errors of one variance the residuals of some rows are `r = √M e`, `M = 1 − Q Qᵀ` over these rows, and a statistic `rᵀA r/rᵀr` lies below `s` where
//! `eᵀ √M (A − s) √M e < 0`: a sum of χ² of one degree of freedom each, weighted by the eigenvalues `λ` of that matrix. By Imhof's inversion
//!
//! `P(Σ λ χ² > 0) = 1/2 + 1/π ∫₀^∞ sin θ/(u ρ) du`, `θ = ½ Σ atan(λ u)`, `ρ = Π (1 + λ²u²)^¼`.
//!
//! The rows may be those of one of several components that share coefficients: `Q` are then their rows of the whole basis. Of more than [`EXACT`] rows the statistic is taken
//! for a beta variable of its own mean and variance (Durbin & Watson 1951), which is what it then nearly is.
//!
//! # Source
//!
//! Imhof (1961), Biometrika 48, 419; Durbin & Watson (1951), Biometrika 38, 159; King (1985) and Evans & King (1985) for such tests of variances.

use faer::{Mat, MatRef, Side};

use crate::dense::mul;
use crate::distribution::beta_lower;

/// Rows up to which eigenvalues are taken.
pub const EXACT: usize = 400;
/// Intervals of the integral, an even number: the integrand is smooth after the map to (0, 1).
const INTERVALS: usize = 400;
/// Fewest degrees of freedom: with fewer the integrand does not vanish at its end.
const FEWEST_DOF: f64 = 4.0 - 1e-9;
/// Eigenvalues below this part of the largest are none.
const ROUNDING: f64 = 1e-10;

/// The matrix A of a statistic `rᵀA r/rᵀr`.
#[derive(Debug, Clone, Copy)]
pub enum Form<'a> {
    /// Σ (r_i − r_{i−1})²: that of Durbin and Watson, rows in their order.
    Steps,
    /// Σ z_i r_i²: a variance that goes with z.
    Weighted(&'a [f64]),
}

impl Form<'_> {
    /// The statistic of residuals; `None` where there are none that differ from zero.
    #[must_use]
    pub fn statistic(self, residual: &[f64]) -> Option<f64> {
        let size: f64 = residual.iter().map(|r| r * r).sum();
        let sum: f64 = match self {
            Self::Steps => residual.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum(),
            Self::Weighted(z) => residual.iter().zip(z).map(|(r, z)| z * r * r).sum(),
        };
        (size > 0.0).then_some(sum / size)
    }

    /// A X.
    fn times(self, x: MatRef<'_, f64>) -> Mat<f64> {
        let n = x.nrows();
        Mat::from_fn(n, x.ncols(), |i, j| match self {
            Self::Steps => {
                let before = if i > 0 { x[(i, j)] - x[(i - 1, j)] } else { 0.0 };
                let after = if i + 1 < n { x[(i, j)] - x[(i + 1, j)] } else { 0.0 };
                before + after
            }
            Self::Weighted(z) => z[i] * x[(i, j)],
        })
    }

    /// Between which numbers the statistic lies.
    fn range(self) -> [f64; 2] {
        match self {
            Self::Steps => [0.0, 4.0],
            Self::Weighted(z) => {
                z.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(*z), high.max(*z)])
            }
        }
    }

    fn traces(self, n: usize) -> [f64; 2] {
        match self {
            Self::Steps => [2.0 * (n as f64 - 1.0), 2.0 * (3.0 * n as f64 - 4.0)],
            Self::Weighted(z) => [z.iter().sum(), z.iter().map(|z| z * z).sum()],
        }
    }
}

/// Probability that independent normal errors give a statistic above `statistic`; `q` are the rows' lines of an orthonormal basis of what was fitted.
///
/// `None` without four degrees of freedom, or where the form does not distinguish rows.
#[must_use]
pub fn above(form: Form<'_>, q: MatRef<'_, f64>, statistic: f64) -> Option<f64> {
    let (n, rank) = q.shape();
    let left: f64 = n as f64 - (0..n).map(|i| (0..rank).map(|k| q[(i, k)].powi(2)).sum::<f64>()).sum::<f64>();
    if n < 3 || left.is_nan() || left < FEWEST_DOF || !statistic.is_finite() {
        return None;
    }
    if n > EXACT { by_moments(form, q, statistic, left) } else { by_inversion(form, q, statistic) }
}

fn by_inversion(form: Form<'_>, q: MatRef<'_, f64>, statistic: f64) -> Option<f64> {
    let root = root_of_residual(q)?;
    let moved = form.times(root.as_ref());
    let n = root.nrows();
    let inner = Mat::from_fn(n, n, |i, j| moved[(i, j)] - statistic * root[(i, j)]);
    let whole = mul(root.as_ref(), inner.as_ref());
    let lambda = whole.self_adjoint_eigenvalues(Side::Lower).ok()?;
    let largest = lambda.iter().fold(0.0_f64, |m, l| m.max(l.abs()));
    let lambda: Vec<f64> = lambda.into_iter().filter(|l| l.abs() > ROUNDING * largest).collect();
    (!lambda.is_empty()).then(|| positive(&lambda))
}

/// √(1 − Q Qᵀ), symmetric.
fn root_of_residual(q: MatRef<'_, f64>) -> Option<Mat<f64>> {
    let (n, rank) = q.shape();
    if rank == 0 {
        return Some(Mat::identity(n, n));
    }
    let gram = mul(q.transpose(), q);
    let evd = gram.self_adjoint_eigen(Side::Lower).ok()?;
    // 1 − √(1 − s) over s, which is ½ of nothing.
    let factor = |s: f64| 1.0 / (1.0 + (1.0 - s.clamp(0.0, 1.0)).sqrt());
    let turned = mul(q, evd.U());
    let scaled = Mat::from_fn(n, rank, |i, k| turned[(i, k)] * factor(evd.S()[k]));
    let taken = mul(scaled.as_ref(), turned.transpose());
    Some(Mat::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - 0.5 * (taken[(i, j)] + taken[(j, i)])))
}

/// P(Σ λ χ² > 0).
fn positive(lambda: &[f64]) -> f64 {
    let scale = lambda.iter().map(|l| l * l).sum::<f64>().sqrt();
    let at = |s: f64| {
        // u = s/(1 − s) in units of 1/scale; at 0 the integrand is ½ Σ λ.
        if s == 0.0 {
            return 0.5 * lambda.iter().sum::<f64>() / scale;
        }
        if s == 1.0 {
            return 0.0;
        }
        let u = s / (1.0 - s);
        // e^(−iθ)/ρ = Π (1 + iλu)^−½, each root that of positive real part: no angle is taken, and nothing is unwrapped.
        let (mut re, mut im) = (1.0, 0.0);
        for l in lambda {
            let x = l / scale * u;
            let size = (1.0 + x * x).sqrt();
            let real = 0.5 * (1.0 + size);
            let over = 1.0 / (real.sqrt() * size);
            let (c, d) = (real * over, -0.5 * x * over);
            (re, im) = (re * c - im * d, re * d + im * c);
        }
        -im / (u * (1.0 - s).powi(2))
    };
    let step = 1.0 / INTERVALS as f64;
    let sum: f64 = (0..=INTERVALS)
        .map(|k| {
            let weight = if k == 0 || k == INTERVALS {
                1.0
            } else if k % 2 == 1 {
                4.0
            } else {
                2.0
            };
            weight * at(k as f64 * step)
        })
        .sum();
    (0.5 + sum * step / 3.0 / std::f64::consts::PI).clamp(0.0, 1.0)
}

fn by_moments(form: Form<'_>, q: MatRef<'_, f64>, statistic: f64, left: f64) -> Option<f64> {
    let n = q.nrows();
    let aq = form.times(q);
    let aaq = form.times(aq.as_ref());
    let (qaq, qaaq) = (mul(q.transpose(), aq.as_ref()), mul(q.transpose(), aaq.as_ref()));
    let [mut first, mut second] = form.traces(n);
    for i in 0..q.ncols() {
        first -= qaq[(i, i)];
        second -= 2.0 * qaaq[(i, i)];
        for j in 0..q.ncols() {
            second += qaq[(i, j)] * qaq[(j, i)];
        }
    }
    let mean = first / left;
    let variance = 2.0 * (second - first * mean) / (left * (left + 2.0));
    let [low, high] = form.range();
    let (m, v) = ((mean - low) / (high - low), variance / (high - low).powi(2));
    let sum = m * (1.0 - m) / v - 1.0;
    (m > 0.0 && m < 1.0 && sum.is_finite() && sum > 0.0)
        .then(|| 1.0 - beta_lower(((statistic - low) / (high - low)).clamp(0.0, 1.0), m * sum, (1.0 - m) * sum))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rank::PivotedQr;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    /// P(F(a, b) > f) = P(χ²_a/a − f χ²_b/b > 0).
    #[test]
    fn a_difference_of_two_chi_squared_is_an_f() {
        for (a, b, f) in [(1, 5, 6.61), (3, 8, 2.0), (2, 30, 5.39), (12, 1, 0.3)] {
            let lambda: Vec<f64> =
                (0..a).map(|_| 1.0 / f64::from(a)).chain((0..b).map(|_| -f / f64::from(b))).collect();
            let expected = crate::distribution::f_upper(f, f64::from(a), f64::from(b));
            assert!((positive(&lambda) - expected).abs() < 2e-6, "{a} {b}: {} {expected}", positive(&lambda));
        }
    }

    fn basis(n: usize) -> Mat<f64> {
        PivotedQr::new(Mat::from_fn(n, 2, |i, j| (0.2 + 0.1 * i as f64).powi(j as i32 + 1)).as_ref()).q
    }

    /// Both statistics of simulated residuals: their probabilities are evenly distributed, to the tails.
    #[test]
    fn probabilities_are_even_under_independence() {
        let n = 20;
        let q = basis(n);
        let z: Vec<f64> = (0..n).map(|i| 0.1 * (1.0 + i as f64)).collect();
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        for form in [Form::Steps, Form::Weighted(&z)] {
            let mut below = [0.0; 3];
            for _ in 0..4000 {
                let e: Vec<f64> = (0..n).map(|_| rng.sample(StandardNormal)).collect();
                let onto: Vec<f64> = (0..2).map(|k| (0..n).map(|i| q[(i, k)] * e[i]).sum()).collect();
                let r: Vec<f64> = (0..n).map(|i| e[i] - q[(i, 0)] * onto[0] - q[(i, 1)] * onto[1]).collect();
                let p = above(form, q.as_ref(), form.statistic(&r).unwrap()).unwrap();
                for (count, level) in below.iter_mut().zip([0.01, 0.2, 0.9]) {
                    *count += f64::from(u8::from(p < level)) / 4000.0;
                }
            }
            // Three binomial deviations of 4000.
            for (found, (level, band)) in below.iter().zip([(0.01, 0.005), (0.2, 0.019), (0.9, 0.0143)]) {
                assert!((found - level).abs() < band, "{below:?}");
            }
        }
    }

    /// What two ways of the same number give where both hold.
    #[test]
    fn moments_are_near_the_inversion_for_many_rows() {
        let q = basis(EXACT);
        let z: Vec<f64> = (0..EXACT).map(|i| i as f64).collect();
        for (form, statistics) in [(Form::Steps, [1.75, 1.85, 2.0]), (Form::Weighted(&z), [220.0, 205.0, 180.0])] {
            for s in statistics {
                let (exact, near) = (
                    by_inversion(form, q.as_ref(), s).unwrap(),
                    by_moments(form, q.as_ref(), s, EXACT as f64 - 2.0).unwrap(),
                );
                assert!((exact - near).abs() < 2e-3 * exact.min(1.0 - exact) + 3e-4, "{s}: {exact} {near}");
            }
        }
    }

    #[test]
    fn nothing_is_said_without_degrees_of_freedom() {
        let q = Mat::<f64>::identity(4, 3);
        assert_eq!(above(Form::Steps, q.as_ref(), 2.0), None);
        assert_eq!(above(Form::Steps, Mat::zeros(4, 0).as_ref(), f64::NAN), None);
    }

    /// Of three free numbers (r₂ − r₁)² + (r₃ − r₂)² is symmetric about neither side: eigenvalues 0, 1 and 3 make P(d > 1) = P(2 χ²₁ > χ²₁) by hand.
    /// Imhof's integral as he prints it, with angles and logarithms.
    #[test]
    fn the_product_of_roots_is_the_integrand_as_printed() {
        let lambda: Vec<f64> = (0..40).map(|i| (1.7 * f64::from(i)).sin() - 0.2).collect();
        let scale = lambda.iter().map(|l| l * l).sum::<f64>().sqrt();
        let at = |s: f64| {
            let u = s / (1.0 - s);
            let theta = 0.5 * lambda.iter().map(|l| (l / scale * u).atan()).sum::<f64>();
            let log = 0.25 * lambda.iter().map(|l| (l / scale * u).powi(2).ln_1p()).sum::<f64>();
            theta.sin() * (-log).exp() / (u * (1.0 - s).powi(2))
        };
        let step = 1.0 / INTERVALS as f64;
        let inner: f64 = (1..INTERVALS).map(|k| if k % 2 == 1 { 4.0 } else { 2.0 } * at(k as f64 * step)).sum();
        let first = 0.5 * lambda.iter().sum::<f64>() / scale;
        let expected = 0.5 + (first + inner) * step / 3.0 / std::f64::consts::PI;
        let found = positive(&lambda);
        assert!((found - expected).abs() < 1e-13 && (0.01..0.99).contains(&found), "{found} {expected}");
    }

    #[test]
    fn nothing_fitted_leaves_the_errors_themselves() {
        let found = by_inversion(Form::Steps, Mat::zeros(3, 0).as_ref(), 1.0).unwrap();
        let expected = 1.0 - 2.0 / std::f64::consts::PI * 0.5_f64.sqrt().atan();
        assert!((found - expected).abs() < 2e-3, "{found} {expected}");
    }
}
