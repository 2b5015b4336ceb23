//! Autocorrelation of a record, and its integrated correlation time.
//!
//! Two rules for the integrated autocorrelation time stand here, on one kernel, because they serve two questions:
//!
//! | rule                            | record                              | window | the mean             |
//! |---------------------------------|-------------------------------------|--------|----------------------|
//! | [`integrated_time`]             | residuals of a fit                  | 5 τ    | as it is             |
//! | [`integrated_time_about_mean`]  | a window whose mean was subtracted  | 4 τ    | its effect corrected |
//!
//! # Source
//!
//! Sokal (1997), *Monte Carlo Methods in Statistical Mechanics*, section 3 (automatic windowing). The correction for the mean is ours.

/// Sum of the products of samples that lie `lag` apart, `Σ x_i x_{i+lag}`.
#[must_use]
pub fn lagged_product(record: &[f64], lag: usize) -> f64 {
    record[lag..].iter().zip(record).map(|(a, b)| a * b).sum()
}

/// Autocorrelations `ρ₀ = 1, ρ₁, …, ρ_lags` of a record of mean zero.
///
/// `ρ_k = Σ x_i x_{i+k} / Σ x_i²`: the biased estimate, whose sequence is that of some stationary process. The mean
/// is not subtracted: residuals of a fit with an intercept have none, those of a fit without must show theirs.
/// `None` for a record without power, or not longer than `lags`.
#[must_use]
pub fn autocorrelation(record: &[f64], lags: usize) -> Option<Vec<f64>> {
    let power: f64 = record.iter().map(|x| x * x).sum();
    if lags >= record.len() || power.is_nan() || power <= 0.0 {
        return None;
    }
    let at = |k: usize| lagged_product(record, k) / power;
    Some((0..=lags).map(at).collect())
}

/// Lags of the window per correlation time: Sokal's `c`.
const WINDOW: f64 = 5.0;

/// Integrated autocorrelation time `τ = 1 + 2 Σ_{k≤m} ρ_k`, in samples; `m` is the first lag with `m ≥ 5 τ(m)`.
///
/// The mean of n samples has the variance of n/τ independent ones. 1 for white noise; below 1 for an
/// alternating record. `None` where no window is wide enough within half the record: it is then too short to tell.
#[must_use]
pub fn integrated_time(record: &[f64]) -> Option<f64> {
    let power: f64 = record.iter().map(|x| x * x).sum();
    if record.len() < 4 || power.is_nan() || power <= 0.0 {
        return None;
    }
    let mut time = 1.0;
    for m in 1..record.len() / 2 {
        time += 2.0 * lagged_product(record, m) / power;
        if m as f64 >= WINDOW * time.max(1.0 / WINDOW) {
            return Some(time);
        }
    }
    None
}

/// Lags of the window per correlation time where the mean was subtracted: exp(−4) of an exponential correlation is left out.
const WINDOW_ABOUT_MEAN: f64 = 4.0;

/// A correlation time is enlarged at most by the inverse of this for what the mean hides.
const LEAST_SHOWN: f64 = 0.25;

/// Integrated autocorrelation time `τ = ½ + Σ_{k≤m} ρ_k` of a record whose mean was subtracted, in samples; ½ for white noise.
///
/// The subtracted mean lowers every product by 2τ/n of the variance; over a window of w lags that hides 2(w − τ)/n of τ, which is corrected.
/// Where the record is only ten times as long as τ, that makes τ right in the mean and wide in scatter. It is half of [`integrated_time`]'s: the
/// mean of n samples has the variance of n/(2τ) independent ones.
#[must_use]
pub fn integrated_time_about_mean(left: &[f64]) -> f64 {
    let n = left.len();
    let zero = lagged_product(left, 0);
    if zero <= 0.0 {
        return 0.5;
    }
    let (mut tau, mut lags) = (0.5, 0);
    for lag in 1..n / 2 {
        tau += lagged_product(left, lag) / zero * n as f64 / (n - lag) as f64;
        lags = lag;
        if lag as f64 >= WINDOW_ABOUT_MEAN * tau {
            break;
        }
    }
    let tau = tau.max(0.5);
    let shown = 1.0 - 2.0 * (lags as f64 - (tau - 0.5)) / n as f64;
    tau / shown.max(LEAST_SHOWN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    /// `x_i = φ x_{i−1} + e_i` with uniform e.
    fn first_order(phi: f64, n: usize) -> Vec<f64> {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(7);
        let mut x = 0.0;
        std::iter::repeat_with(|| {
            x = phi * x + rng.random_range(-1.0..1.0);
            x
        })
        .skip(200)
        .take(n)
        .collect()
    }

    #[test]
    fn a_first_order_process_has_a_geometric_correlation_and_the_time_of_its_formula() {
        let n = 200_000;
        let x = first_order(0.8, n);
        let rho = autocorrelation(&x, 3).unwrap();
        for k in 0..4 {
            // Standard error of ρ is below √(τ/n) = 0.0067; four of them.
            assert!((rho[k as usize] - 0.8_f64.powi(k)).abs() < 0.027);
        }
        // τ = (1 + φ)/(1 − φ) = 9; relative standard error √(2(2m + 1)/n) = 0.03 with m = 45; the window cuts e^{−45/4.5}.
        assert!((integrated_time(&x).unwrap() / 9.0 - 1.0).abs() < 0.12);
        // The other rule gives half of it; 4 τ is cut at e^{−36/4.5}, and a mean of 200,000 samples hides nothing.
        assert!((2.0 * integrated_time_about_mean(&x) / 9.0 - 1.0).abs() < 0.12);
    }

    #[test]
    fn an_alternation_by_hand_and_a_record_without_power() {
        assert_eq!(autocorrelation(&[1.0, -1.0, 1.0, -1.0], 2), Some(vec![1.0, -0.75, 0.5]));
        assert_eq!(autocorrelation(&[0.0; 5], 1), None);
        assert_eq!(autocorrelation(&[1.0], 1), None);
    }
}
