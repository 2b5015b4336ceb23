//! Long-run covariance of correlated scores: what n correlated rows are worth.
//!
//! For scores `s_i` (regressors times residual, a row of p numbers) the covariance of their sum is n times
//! `Γ₀ + Σ_k w_k (Γ_k + Γ_kᵀ)`, `Γ_k = (1/n) Σ s_i s_{i+k}ᵀ`, with Bartlett weights `w_k = 1 − k/(lag + 1)`: never negative.
//! Between `(XᵀX)⁻¹` on both sides it is the HAC covariance of a least-squares fit ([`hac`]).
//!
//! # Source
//!
//! Newey & West (1987), Econometrica 55, 703; automatic lag: Newey & West (1994), Rev. Econ. Stud. 61, 631, without prewhitening.

use faer::Mat;

/// HAC covariance of a least-squares fit, `n/(n − p) (XᵀX)⁻¹ S (XᵀX)⁻¹`, from its scores (a column per coefficient) and `(XᵀX)⁻¹`.
///
/// # Panics
///
/// When the columns differ in length.
#[must_use]
pub fn hac(scores: &[&[f64]], inverse_gram: &Mat<f64>, lag: usize) -> Mat<f64> {
    let p = scores.len();
    let n = scores.first().map_or(0, |s| s.len()) as f64;
    let middle = covariance_of_sum(scores, lag);
    let middle = Mat::from_fn(p, p, |i, j| n / (n - p as f64) * middle[i * p + j]);
    inverse_gram * middle * inverse_gram
}

/// Sum over all lags of the scores' products, `n (Γ₀ + Σ w_k (Γ_k + Γ_kᵀ))`, `p × p`, row-major.
///
/// `scores` holds p columns of equal length n.
///
/// # Panics
///
/// When the columns differ in length.
#[must_use]
pub fn covariance_of_sum(scores: &[&[f64]], lag: usize) -> Vec<f64> {
    let p = scores.len();
    let n = scores.first().map_or(0, |s| s.len());
    assert!(scores.iter().all(|s| s.len() == n), "score columns of unequal length");
    let mut out = vec![0.0; p * p];
    for k in 0..=lag.min(n.saturating_sub(1)) {
        let weight = 1.0 - k as f64 / (lag + 1) as f64;
        for a in 0..p {
            for b in 0..p {
                let sum = weight * product(scores[a], scores[b], k);
                out[a * p + b] += sum;
                if k > 0 {
                    out[b * p + a] += sum;
                }
            }
        }
    }
    out
}

fn product(a: &[f64], b: &[f64], k: usize) -> f64 {
    a.iter().zip(&b[k..]).map(|(a, b)| a * b).sum()
}

/// Lag that Newey and West (1994) choose for Bartlett weights, from the scores' own autocovariances.
///
/// `⌊1.1447 (s₁/s₀)^{2/3} n^{1/3}⌋` with `s₀ = σ₀ + 2Σσ_j`, `s₁ = 2Σ jσ_j` over `m = ⌊4(n/100)^{2/9}⌋` lags of the sum of
/// the scores, each scaled to unit variance so that no unit decides.
#[must_use]
pub fn automatic_lag(scores: &[&[f64]]) -> usize {
    let n = scores.first().map_or(0, |s| s.len());
    if n < 2 {
        return 0;
    }
    let mut sum = vec![0.0; n];
    for score in scores {
        let size = product(score, score, 0).sqrt();
        if size > 0.0 {
            for (sum, s) in sum.iter_mut().zip(*score) {
                *sum += s / size;
            }
        }
    }
    let first = (4.0 * (n as f64 / 100.0).powf(2.0 / 9.0)) as usize;
    let sigma = |j: usize| product(&sum, &sum, j);
    let (mut s_0, mut s_1) = (sigma(0), 0.0);
    for j in 1..=first.min(n - 1) {
        s_0 += 2.0 * sigma(j);
        s_1 += 2.0 * j as f64 * sigma(j);
    }
    let ratio = s_1 / s_0;
    if !ratio.is_finite() {
        return 0;
    }
    ((1.1447 * (ratio * ratio * n as f64).cbrt()) as usize).min(n - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_lag_by_hand() {
        // Γ₀: 1 + 4 + 9 = 14; Γ₁: 2 + 6 = 8, weight 1/2, twice.
        assert_eq!(covariance_of_sum(&[&[1.0, 2.0, 3.0]], 1), [22.0]);
        assert_eq!(covariance_of_sum(&[&[1.0, 2.0, 3.0]], 0), [14.0]);
    }

    #[test]
    fn it_is_symmetric_and_without_lag_the_plain_product() {
        let a: Vec<f64> = (0..50).map(|i| f64::from(i % 7) - 3.0).collect();
        let b: Vec<f64> = (0..50).map(|i| f64::from(i * i % 11) - 5.0).collect();
        let s = covariance_of_sum(&[&a, &b], 5);
        assert_eq!(s[1], s[2]);
        assert!(s[0] > 0.0 && s[0] * s[3] - s[1] * s[2] > 0.0);
    }

    #[test]
    fn white_scores_ask_for_few_lags_and_slow_ones_for_many() {
        let white: Vec<f64> = (0..2000_u64).map(|i| ((i * 7919 + i * i * 104_729) % 1000) as f64 - 499.5).collect();
        let slow: Vec<f64> = (0..2000).map(|i| (0.02 * f64::from(i)).sin()).collect();
        assert!(automatic_lag(&[&white]) < automatic_lag(&[&slow]));
    }
}
