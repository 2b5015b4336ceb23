//! How long a record remembers itself.

/// Autocorrelations `ρ₀ = 1, ρ₁, …, ρ_lags` of a record of mean zero.
///
/// `ρ_k = Σ x_i x_{i+k} / Σ x_i²`: the biased estimate, whose sequence is that of some stationary process. The mean
/// is not taken off: residuals of a fit with an intercept have none, those of a fit without must show theirs.
/// `None` for a record without power, or not longer than `lags`.
#[must_use]
pub fn autocorrelation(record: &[f64], lags: usize) -> Option<Vec<f64>> {
    let power: f64 = record.iter().map(|x| x * x).sum();
    if lags >= record.len() || power.is_nan() || power <= 0.0 {
        return None;
    }
    let at = |k: usize| record[k..].iter().zip(record).map(|(a, b)| a * b).sum::<f64>() / power;
    Some((0..=lags).map(at).collect())
}

/// Filter `1, a₁ … a_order` that leaves of a record what its past does not predict (autoregressive whitening).
///
/// From the autocorrelations by Levinson's recursion, so that its inverse is stable. `None` as [`autocorrelation`].
///
/// # Source
///
/// Box, Jenkins, Reinsel & Ljung (2016), *Time Series Analysis*, 5th ed., 3.2.5 and A3.2 (Yule–Walker, Durbin–Levinson).
#[must_use]
pub fn whitening_filter(record: &[f64], order: usize) -> Option<Vec<f64>> {
    let rho = autocorrelation(record, order)?;
    let mut filter = vec![1.0];
    let mut error = 1.0;
    for k in 1..=order {
        let reflection = -filter.iter().enumerate().map(|(i, a)| a * rho[k - i]).sum::<f64>() / error;
        filter.push(0.0);
        let turned: Vec<f64> = filter.iter().rev().copied().collect();
        filter.iter_mut().zip(&turned).for_each(|(a, b)| *a += reflection * b);
        error *= 1.0 - reflection * reflection;
    }
    Some(filter)
}

/// `y_i = Σ filter_k x_{i−k}` where all of them exist: shorter than the record by the filter's length less one.
#[must_use]
pub fn whitened(record: &[f64], filter: &[f64]) -> Vec<f64> {
    record.windows(filter.len()).map(|w| filter.iter().zip(w.iter().rev()).map(|(a, x)| a * x).sum()).collect()
}

/// Lags of the window per correlation time: Sokal's `c`.
const WINDOW: f64 = 5.0;

/// Integrated autocorrelation time `τ = 1 + 2 Σ_{k≤m} ρ_k`, in samples; `m` is the first lag with `m ≥ 5 τ(m)`.
///
/// The mean of n samples has the variance of n/τ independent ones. 1 for white noise; below 1 for an
/// alternating record. `None` where no window is wide enough within half the record: it is then too short to tell.
///
/// # Source
///
/// Sokal (1997), *Monte Carlo Methods in Statistical Mechanics*, section 3 (automatic windowing).
#[must_use]
pub fn integrated_time(record: &[f64]) -> Option<f64> {
    let power: f64 = record.iter().map(|x| x * x).sum();
    if record.len() < 4 || power.is_nan() || power <= 0.0 {
        return None;
    }
    let mut time = 1.0;
    for m in 1..record.len() / 2 {
        time += 2.0 * record[m..].iter().zip(record).map(|(a, b)| a * b).sum::<f64>() / power;
        if m as f64 >= WINDOW * time.max(1.0 / WINDOW) {
            return Some(time);
        }
    }
    None
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
    }

    #[test]
    fn whitening_a_first_order_process_finds_its_coefficient_and_leaves_nothing_to_predict() {
        let x = first_order(0.8, 50_000);
        let filter = whitening_filter(&x, 3).unwrap();
        // Standard error of an autoregressive coefficient is below 1/√n = 0.0045; four of them.
        for (a, truth) in filter.iter().zip([1.0, -0.8, 0.0, 0.0]) {
            assert!((a - truth).abs() < 0.018, "{filter:?}");
        }
        assert!(autocorrelation(&whitened(&x, &filter), 1).unwrap()[1].abs() < 0.018);
    }

    #[test]
    fn an_alternation_by_hand_and_a_record_without_power() {
        assert_eq!(autocorrelation(&[1.0, -1.0, 1.0, -1.0], 2), Some(vec![1.0, -0.75, 0.5]));
        assert_eq!(autocorrelation(&[0.0; 5], 1), None);
        assert_eq!(autocorrelation(&[1.0], 1), None);
    }
}
