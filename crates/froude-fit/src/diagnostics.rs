//! Diagnostics of what the coefficients of a fit do not show by themselves.
//!
//! | what                      | function                 | source                        |
//! |---------------------------|--------------------------|-------------------------------|
//! | correlation of neighbours | [`durbin_watson`]        | Durbin & Watson (1950)        |
//! | its probability           | [`durbin_watson_p`]      | Durbin & Watson (1951), beta approximation |
//! | correlation at any lag    | [`ljung_box`]            | Ljung & Box (1978)            |
//! | collinearity              | [`condition_number`]     | Belsley, Kuh & Welsch (1980)  |

use faer::linalg::svd::{ComputeSvdVectors, svd, svd_scratch};
use faer::{Mat, MatRef, Par};

use crate::dense::{dot, mul};
use crate::distribution::{beta_lower, chi_squared_upper};
use crate::rank::{PivotedQr, RANK_TOLERANCE};

/// Residuals count as serially correlated when independent errors would give a
/// Durbin–Watson statistic this far out more rarely than this.
///
/// One in a hundred: a campaign fits several models to several components, and
/// one false alarm in twenty would be one in most reports.
pub const SERIAL_P: f64 = 0.01;

/// Durbin–Watson statistic `Σ (r_i − r_{i−1})² / Σ r_i²` of residuals in order.
///
/// 2 for independent neighbours, 0 for a slow drift, 4 for an alternation.
/// `None` for fewer than two residuals, or none that differ from zero.
#[must_use]
pub fn durbin_watson(residuals: &[f64]) -> Option<f64> {
    let size = dot(residuals, residuals);
    if residuals.len() < 2 || size == 0.0 {
        return None;
    }
    let steps: f64 = residuals.windows(2).map(|pair| (pair[1] - pair[0]) * (pair[1] - pair[0])).sum();
    Some(steps / size)
}

/// Probability that independent normal errors give a Durbin–Watson statistic
/// as far from its mean, on either side.
///
/// `q` (`n × rank`) is an orthonormal basis of the columns that were fitted:
/// mean and variance under independence follow from it exactly, and `d/4` is
/// taken as a beta variable with these. `None` without two degrees of freedom.
///
/// # Source
///
/// Durbin & Watson (1951), *Testing for serial correlation in least squares
/// regression II*, section 4.
#[must_use]
pub fn durbin_watson_p(statistic: f64, q: MatRef<'_, f64>) -> Option<f64> {
    let (n, rank) = q.shape();
    if n < rank + 2 || n < 3 {
        return None;
    }
    let aq = second_difference(q);
    let aaq = second_difference(aq.as_ref());
    let qaq = mul(q.transpose(), aq.as_ref());
    let qaaq = mul(q.transpose(), aaq.as_ref());
    let n = n as f64;
    let dof = n - rank as f64;
    let mut trace_1 = 2.0 * (n - 1.0);
    let mut trace_2 = 2.0 * (3.0 * n - 4.0);
    for i in 0..rank {
        trace_1 -= qaq[(i, i)];
        trace_2 -= 2.0 * qaaq[(i, i)];
        for j in 0..rank {
            trace_2 += qaq[(i, j)] * qaq[(j, i)];
        }
    }
    let mean = trace_1 / dof;
    let variance = 2.0 * (trace_2 - trace_1 * mean) / (dof * (dof + 2.0));
    let (m, v) = (mean / 4.0, variance / 16.0);
    let sum = m * (1.0 - m) / v - 1.0;
    if !(m > 0.0 && m < 1.0 && sum.is_finite() && sum > 0.0) {
        return None;
    }
    let lower = beta_lower(statistic / 4.0, m * sum, (1.0 - m) * sum);
    Some((2.0 * lower.min(1.0 - lower)).clamp(0.0, 1.0))
}

/// `A X` with the matrix `A` of the Durbin–Watson numerator `rᵀ A r`.
fn second_difference(x: MatRef<'_, f64>) -> Mat<f64> {
    let n = x.nrows();
    Mat::from_fn(n, x.ncols(), |i, j| {
        let mut sum = 0.0;
        if i > 0 {
            sum += x[(i, j)] - x[(i - 1, j)];
        }
        if i + 1 < n {
            sum += x[(i, j)] - x[(i + 1, j)];
        }
        sum
    })
}

/// Ljung–Box statistic of the first `lags` autocorrelations, and its
/// probability under independence (χ² with `lags` degrees of freedom).
///
/// `None` when `lags` is zero or not below the number of residuals, or when
/// all residuals are zero. The residuals are taken to have mean zero.
#[must_use]
pub fn ljung_box(residuals: &[f64], lags: usize) -> Option<(f64, f64)> {
    let n = residuals.len();
    let size = dot(residuals, residuals);
    if lags == 0 || lags >= n || size == 0.0 {
        return None;
    }
    let count = n as f64;
    let sum: f64 = (1..=lags)
        .map(|lag| {
            let r = dot(&residuals[lag..], &residuals[..n - lag]) / size;
            r * r / (count - lag as f64)
        })
        .sum();
    let statistic = count * (count + 2.0) * sum;
    Some((statistic, chi_squared_upper(statistic, lags as f64)))
}

/// Largest and smallest singular value of a matrix; `None` when it is
/// rank-deficient by [`RANK_TOLERANCE`] or has no columns.
#[must_use]
pub fn condition_number(a: MatRef<'_, f64>) -> Option<(f64, f64)> {
    let qr = PivotedQr::new(a);
    let n = a.ncols();
    if n == 0 || qr.rank < n {
        return None;
    }
    let mut values = faer::diag::Diag::<f64>::zeros(n);
    svd(
        qr.r.as_ref(),
        values.as_mut(),
        None,
        None,
        Par::Seq,
        faer::dyn_stack::MemStack::new(&mut faer::dyn_stack::MemBuffer::new(svd_scratch::<f64>(
            n,
            n,
            ComputeSvdVectors::No,
            ComputeSvdVectors::No,
            Par::Seq,
            faer::prelude::default(),
        ))),
        faer::prelude::default(),
    )
    .ok()?;
    let (mut high, mut low) = (0.0_f64, f64::INFINITY);
    for i in 0..n {
        high = high.max(values[i]);
        low = low.min(values[i]);
    }
    (low > RANK_TOLERANCE * high * 1e-3).then_some((high, low))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_statistic_of_a_drift_and_of_an_alternation() {
        let alternating = [1.0, -1.0, 1.0, -1.0];
        assert_eq!(durbin_watson(&alternating), Some(3.0));
        let drift = [-1.0, -1.0, 1.0, 1.0];
        assert_eq!(durbin_watson(&drift), Some(1.0));
        assert_eq!(durbin_watson(&[0.0, 0.0]), None);
    }

    /// Savin & White (1977), 5 % points with an intercept and one regressor;
    /// for n = 15: d_L = 1.077, d_U = 1.361. Whatever the regressor, a
    /// statistic of d_L is at or below the 5 % point on one side, d_U at or above.
    #[test]
    fn the_probability_respects_the_printed_bounds() {
        let a = Mat::from_fn(15, 2, |i, j| if j == 0 { 1.0 } else { (i as f64).powi(2) });
        let q = PivotedQr::new(a.as_ref()).q;
        let at_lower = durbin_watson_p(1.077, q.as_ref()).unwrap();
        let at_upper = durbin_watson_p(1.361, q.as_ref()).unwrap();
        assert!(0.5 * at_lower < 0.05 + 5e-4, "{at_lower}");
        assert!(0.5 * at_upper > 0.05 - 5e-4, "{at_upper}");
    }

    #[test]
    fn ljung_box_of_one_lag_by_hand() {
        let r = [1.0, 2.0, -1.0, -2.0];
        // r1 = (2 − 2 + 2)/10 = 0.2; Q = 4·6·0.04/3.
        let (q, p) = ljung_box(&r, 1).unwrap();
        assert!((q - 0.32).abs() < 1e-14);
        assert!(p > 0.5 && p < 0.6);
        assert_eq!(ljung_box(&r, 4), None);
    }

    #[test]
    fn the_condition_of_two_columns_at_an_angle() {
        // cos = 0.6: singular values √1.6 and √0.4.
        let a = Mat::from_fn(2, 2, |i, j| [[1.0, 0.6], [0.0, 0.8]][i][j]);
        let (high, low) = condition_number(a.as_ref()).unwrap();
        assert!((high / low - 2.0).abs() < 1e-14);
    }
}
