//! The interval that the jackknife over clusters (CR3) gives where few clusters, or some more than others, tell a coefficient.
//!
//! The change of coefficient j when cluster g is left out is linear in the errors of all rows and of the priors, Δ_g = a_gᵀe, so that CR3's variance
//! V = (G−1)/G Σ_g Δ_g² is a quadratic form. Where the errors of all rows are equal and independent, and those of priors as stated, its distribution is known. With
//! K_g = X_gᵀX_g, M = Σ K_g + P (P: what priors add), w_g = (M − K_g)⁻¹ e_j and u_g = K_g w_g,
//!
//! B_gh = a_gᵀa_h = δ_gh d_g − u_gᵀM⁻¹u_h,  d_g = w_gᵀu_g,  E V = (G−1)/G tr B σ².
//!
//! V stands for the scatter (M⁻¹ − M⁻¹PM⁻¹)_jj σ² and is above it in the mean: the ratio of both is `ratio`. Coefficient and V are independent, so that by Craig's form of
//! the normal tail
//!
//! P(|β̂_j − β_j| > c √(V/ratio)) = 2/π ∫₀^{π/2} det(1 + s B)^−½ dθ,  s = c²/(tr B sin²θ),
//!
//! det(1 + s B) = Π_g (1 + s d_g) · det(1 − s M⁻¹ Σ_g u_g u_gᵀ/(1 + s d_g)),
//!
//! which is Student's t where all of B is one number. `dof` are the degrees of freedom at which Student's t has the c of 5 %. Those of Satterthwaite, by the
//! variance of V (Bell and McCaffrey), make the interval too wide where clusters are unequal: 96.5 % with six of 2.4 degrees of freedom in a straight line.
//!
//! # Source
//!
//! Bell & McCaffrey (2002), Survey Methodology 28, 169 (equal errors as the working covariance); Craig (1991), IEEE MILCOM, 571; Sylvester's determinant identity.

use std::f64::consts::FRAC_PI_2;

use faer::Mat;

use crate::dense::{Cholesky, mul};
use crate::distribution::dof_of_factor;

/// A matrix of unit diagonal is singular where a pivot falls below this.
const SINGULAR: f64 = 1e-12;
/// A coefficient of which the data tell less than this part has no scatter.
const BY_PRIOR: f64 = 1e-9;
/// Points of the integral: it is periodic, so that they converge as fast as its smoothness at 0, which is that of sin^r, r the rank of B.
const POINTS: usize = 48;
/// Outside an interval of 95 %.
const OUTSIDE: f64 = 0.05;
/// Factors between that of a normal, less what an unequal form may lie below, and that of one degree of freedom.
const FACTORS: [f64; 2] = [1.9, 12.71];
/// The factor is found to this part.
const WITHIN: f64 = 1e-9;
/// Most steps for it.
const STEPS: usize = 60;

/// CR3 of one coefficient at equal errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtEqualErrors {
    /// Mean of CR3's variance over the variance itself.
    pub ratio: f64,
    /// Degrees of freedom at which Student's t has the 95 % interval of the coefficient over √(V/ratio).
    pub dof: f64,
}

/// CR3 at equal errors, for the first `coefficients` of p columns.
///
/// `grams` are X_gᵀX_g of the clusters, p × p; `prior` is the diagonal that priors add, in the same unit. `None` where the clusters, or all but one, do not
/// determine the coefficients, and where there are fewer than two.
///
/// # Examples
///
/// A mean of eight equal clusters: CR3 is its variance, with seven degrees of freedom.
///
/// ```
/// use froude_fit::{faer::Mat, jackknife::at_equal_errors};
///
/// let found = at_equal_errors(&vec![Mat::from_fn(1, 1, |_, _| 5.0); 8], &[0.0], 1).unwrap()[0];
/// assert!((found.ratio - 1.0).abs() < 1e-12 && (found.dof - 7.0).abs() < 1e-6);
/// ```
#[must_use]
pub fn at_equal_errors(grams: &[Mat<f64>], prior: &[f64], coefficients: usize) -> Option<Vec<AtEqualErrors>> {
    let p = prior.len();
    let count = grams.len() as f64;
    let whole = |i: usize, j: usize| grams.iter().map(|k| k[(i, j)]).sum::<f64>() + if i == j { prior[i] } else { 0.0 };
    // Ratio and degrees of freedom know no unit: all in those of a unit diagonal.
    let scale: Vec<f64> = (0..p).map(|j| whole(j, j).sqrt()).collect();
    if grams.len() < 2 || scale.iter().any(|s| s.is_nan() || *s <= 0.0) {
        return None;
    }
    let scaled = |i: usize, j: usize, value: f64| value / (scale[i] * scale[j]);
    let m = Mat::from_fn(p, p, |i, j| scaled(i, j, whole(i, j)));
    let inverse = Cholesky::new(m.as_ref(), SINGULAR)?.inverse();
    let by_prior =
        mul(Mat::from_fn(p, p, |i, j| inverse[(i, j)] * prior[j] / scale[j].powi(2)).as_ref(), inverse.as_ref());
    let half = Cholesky::new(inverse.as_ref(), 0.0)?;
    let mut forms: Vec<Form> = (0..coefficients).map(|_| Form { alone: Vec::new(), shared: Vec::new() }).collect();
    for gram in grams {
        let k = Mat::from_fn(p, p, |i, j| scaled(i, j, gram[(i, j)]));
        let rest = Mat::from_fn(p, p, |i, j| m[(i, j)] - k[(i, j)]);
        let w = Cholesky::new(rest.as_ref(), SINGULAR)?.inverse();
        let u = mul(k.as_ref(), w.as_ref());
        for (j, form) in forms.iter_mut().enumerate() {
            form.alone.push((0..p).map(|i| w[(i, j)] * u[(i, j)]).sum::<f64>());
            form.shared.push(half.transposed_times(&(0..p).map(|i| u[(i, j)]).collect::<Vec<f64>>()));
        }
    }
    let of = |(j, form): (usize, Form)| {
        let (trace, variance) = (form.trace(), inverse[(j, j)] - by_prior[(j, j)]);
        if trace.min(variance) <= BY_PRIOR * inverse[(j, j)] {
            return AtEqualErrors { ratio: 1.0, dof: f64::INFINITY };
        }
        AtEqualErrors { ratio: (count - 1.0) / count * trace / variance, dof: dof_of_factor(form.factor(trace)) }
    };
    Some(forms.into_iter().enumerate().map(of).collect())
}

/// B = diag d − VᵀV, the columns of V being v_g = Lᵀu_g with L Lᵀ = M⁻¹.
struct Form {
    /// d_g.
    alone: Vec<f64>,
    /// v_g.
    shared: Vec<Vec<f64>>,
}

impl Form {
    fn trace(&self) -> f64 {
        self.alone.iter().zip(&self.shared).map(|(d, v)| d - v.iter().map(|x| x * x).sum::<f64>()).sum()
    }

    /// The c of 5 %, by false position on the logarithm (Illinois).
    fn factor(&self, trace: f64) -> f64 {
        let above = |c: f64| (self.outside(c * c / trace) / OUTSIDE).ln();
        let [mut low, mut high] = FACTORS;
        let (mut at_low, mut at_high) = (above(low), above(high));
        if at_low <= 0.0 {
            return low;
        }
        if at_high >= 0.0 {
            return high;
        }
        for _ in 0..STEPS {
            let middle = (low * at_high - high * at_low) / (at_high - at_low);
            let found = above(middle);
            if found == 0.0 || high - low < WITHIN * high || (middle - low).min(high - middle) < WITHIN * middle {
                return middle;
            }
            if found > 0.0 {
                (low, at_low) = (middle, found);
                at_high *= 0.5;
            } else {
                (high, at_high) = (middle, found);
                at_low *= 0.5;
            }
        }
        0.5 * (low + high)
    }

    /// P(|z| > √(square · zᵀB z)) of independent standard normals.
    fn outside(&self, square: f64) -> f64 {
        let at = |k: usize| {
            let sine = (FRAC_PI_2 * (k as f64 + 0.5) / POINTS as f64).sin();
            (-0.5 * self.log_determinant(square / (sine * sine))).exp()
        };
        (0..POINTS).map(at).sum::<f64>() / POINTS as f64
    }

    /// ln det(1 + s B).
    fn log_determinant(&self, s: f64) -> f64 {
        let p = self.shared[0].len();
        let mut rest = Mat::<f64>::identity(p, p);
        let mut sum = 0.0;
        for (d, v) in self.alone.iter().zip(&self.shared) {
            let each = 1.0 + s * d;
            sum += each.ln();
            for b in 0..p {
                for a in b..p {
                    rest[(a, b)] -= s / each * v[a] * v[b];
                }
            }
        }
        sum + Cholesky::new(rest.as_ref(), 0.0).map_or(f64::INFINITY, |c| c.log_determinant())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    /// Six clusters of unequal size and place on two columns, one of which a prior tells a part of.
    fn clusters() -> (Vec<Mat<f64>>, Vec<f64>) {
        let rows = [3, 4, 9, 5, 3, 12];
        let design =
            |g: usize| Mat::from_fn(rows[g], 2, |i, j| if j == 0 { 1.0 } else { (g as f64 - 2.0) + 0.3 * i as f64 });
        ((0..6).map(design).collect(), vec![4.0, 0.0])
    }

    fn gram(x: &Mat<f64>) -> Mat<f64> {
        x.transpose() * x
    }

    /// Rows of all clusters.
    fn all(x: &[Mat<f64>]) -> Mat<f64> {
        let rows: Vec<[f64; 2]> = x.iter().flat_map(|x| (0..x.nrows()).map(|i| [x[(i, 0)], x[(i, 1)]])).collect();
        Mat::from_fn(rows.len(), 2, |i, j| rows[i][j])
    }

    /// Mean and determinant by the form written out: a_g as rows over all rows of data, and the prior as one more row that no cluster has.
    #[test]
    fn the_sums_are_those_of_the_form_written_out() {
        let (x, prior) = clusters();
        let data = all(&x);
        let n = data.nrows();
        let all = Mat::from_fn(n + 1, 2, |i, j| match i {
            _ if i < n => data[(i, j)],
            _ if j == 0 => prior[0].sqrt(),
            _ => 0.0,
        });
        let m = gram(&all);
        let inverse = Cholesky::new(m.as_ref(), 0.0).unwrap().inverse();
        let residual = Mat::<f64>::identity(n + 1, n + 1) - &all * &inverse * all.transpose();
        let found = at_equal_errors(&x.iter().map(gram).collect::<Vec<_>>(), &prior, 2).unwrap();
        for j in 0..2 {
            let mut from = 0;
            let mut a = Mat::<f64>::zeros(6, n + 1);
            for (g, x) in x.iter().enumerate() {
                let w = Cholesky::new((&m - gram(x)).as_ref(), 0.0).unwrap().inverse();
                for i in 0..=n {
                    let of = |r: usize| (w[(j, 0)] * x[(r, 0)] + w[(j, 1)] * x[(r, 1)]) * residual[(from + r, i)];
                    a[(g, i)] = (0..x.nrows()).map(of).sum();
                }
                from += x.nrows();
            }
            let b = &a * a.transpose();
            let trace: f64 = (0..6).map(|g| b[(g, g)]).sum();
            let moved = &inverse * data.transpose();
            let variance: f64 = (0..n).map(|i| moved[(j, i)] * moved[(j, i)]).sum();
            assert!((found[j].ratio / (5.0 / 6.0 * trace / variance) - 1.0).abs() < 1e-12);
            let factor = crate::distribution::coverage_factor(0.95, found[j].dof);
            let outside = |k: usize| {
                let s = (factor / (FRAC_PI_2 * (k as f64 + 0.5) / 400.0).sin()).powi(2) / trace;
                let whole = Mat::from_fn(6, 6, |g, h| s * b[(g, h)] + if g == h { 1.0 } else { 0.0 });
                whole.determinant().powf(-0.5)
            };
            // Points of the integral against eight times as many.
            assert!(((0..400).map(outside).sum::<f64>() / 400.0 - 0.05).abs() < 1e-6);
        }
    }

    /// A prior that tells nearly all of a mean: what its error does to the residuals of all clusters alike is no scatter, and the ratio takes it off.
    #[test]
    fn the_error_of_a_prior_is_in_the_mean_of_the_form() {
        let grams = vec![Mat::from_fn(1, 1, |_, _| 5.0); 8];
        let found = at_equal_errors(&grams, &[40.0], 1).unwrap()[0];
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(4);
        let mut sum = 0.0;
        for _ in 0..20_000 {
            let z: [f64; 9] = std::array::from_fn(|_| rng.sample(StandardNormal));
            let score = |g: usize| 5.0_f64.sqrt() * z[g];
            let mean = ((0..8).map(score).sum::<f64>() + 40.0_f64.sqrt() * z[8]) / 80.0;
            sum += 7.0 / 8.0 * (0..8).map(|g| ((score(g) - 5.0 * mean) / 75.0).powi(2)).sum::<f64>();
        }
        // Scatter without the prior: 40/80². The mean of 20,000 forms is known to 0.4 %; three times that.
        assert!((sum / 20_000.0 / (40.0 / 6400.0) / found.ratio - 1.0).abs() < 0.012, "{} {found:?}", sum / 20_000.0);
    }

    /// Intervals of CR3 over its ratio hold 95 % where one of six clusters tells most of a slope: 20,000 draws, three deviations of which are 0.5 %.
    #[test]
    fn intervals_hold_with_unequal_clusters() {
        let (x, _) = clusters();
        let grams: Vec<Mat<f64>> = x.iter().map(gram).collect();
        let found = at_equal_errors(&grams, &[0.0; 2], 2).unwrap()[1];
        assert!(found.ratio > 2.0 && found.dof < 3.0, "{found:?}");
        let m = grams.iter().fold(Mat::<f64>::zeros(2, 2), |sum, k| sum + k);
        let inverse = Cholesky::new(m.as_ref(), 0.0).unwrap().inverse();
        let without: Vec<Mat<f64>> =
            grams.iter().map(|k| Cholesky::new((&m - k).as_ref(), 0.0).unwrap().inverse()).collect();
        let factor = crate::distribution::coverage_factor(0.95, found.dof);
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(11);
        let mut held = 0.0;
        for _ in 0..20_000 {
            let e: Vec<Vec<f64>> =
                x.iter().map(|x| (0..x.nrows()).map(|_| rng.sample(StandardNormal)).collect()).collect();
            let score = |g: usize, beta: &[f64; 2]| -> [f64; 2] {
                let left = |i: usize| e[g][i] - x[g][(i, 0)] * beta[0] - x[g][(i, 1)] * beta[1];
                [0, 1].map(|j| (0..x[g].nrows()).map(|i| x[g][(i, j)] * left(i)).sum())
            };
            let total = (0..6).map(|g| score(g, &[0.0; 2])).fold([0.0; 2], |s, v| [s[0] + v[0], s[1] + v[1]]);
            let beta = [0, 1].map(|j| inverse[(j, 0)] * total[0] + inverse[(j, 1)] * total[1]);
            let change = |g: usize| {
                let s = score(g, &beta);
                without[g][(1, 0)] * s[0] + without[g][(1, 1)] * s[1]
            };
            let cr3 = 5.0 / 6.0 * (0..6).map(|g| change(g).powi(2)).sum::<f64>();
            held += f64::from(u8::from(beta[1].abs() <= factor * (cr3 / found.ratio).sqrt()));
        }
        assert!((held / 20_000.0 - 0.95).abs() < 0.005, "{}", held / 20_000.0);
    }

    #[test]
    fn a_cluster_that_alone_tells_a_coefficient_has_none() {
        let one = |x: f64| Mat::from_fn(2, 2, |i, j| if i == j && i == 1 { x } else { f64::from(u8::from(i == j)) });
        assert!(at_equal_errors(&[one(1.0), one(0.0), one(0.0)], &[0.0; 2], 2).is_none());
        assert!(at_equal_errors(&[one(1.0)], &[1.0; 2], 2).is_none());
    }
}
