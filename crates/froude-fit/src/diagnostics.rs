//! Diagnostics of what the coefficients of a fit do not show by themselves.
//!
//! | what                      | function                 | source                        |
//! |---------------------------|--------------------------|-------------------------------|
//! | correlation of neighbours | [`durbin_watson`]        | Durbin & Watson (1950)        |
//! | correlation at any lag    | [`ljung_box`]            | Ljung & Box (1978)            |
//! | collinearity              | [`condition_number`]     | Belsley, Kuh & Welsch (1980)  |

use faer::linalg::svd::{ComputeSvdVectors, svd, svd_scratch};
use faer::{MatRef, Par};

use crate::dense::dot;
use crate::distribution::chi_squared_upper;
use crate::rank::{PivotedQr, RANK_TOLERANCE};

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
    use faer::Mat;

    use super::*;

    #[test]
    fn the_statistic_of_a_drift_and_of_an_alternation() {
        let alternating = [1.0, -1.0, 1.0, -1.0];
        assert_eq!(durbin_watson(&alternating), Some(3.0));
        let drift = [-1.0, -1.0, 1.0, 1.0];
        assert_eq!(durbin_watson(&drift), Some(1.0));
        assert_eq!(durbin_watson(&[0.0, 0.0]), None);
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
