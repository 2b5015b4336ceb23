//! Scatter of a least-squares fit whose errors are correlated in time within runs.
//!
//! The errors of a run are taken as a stationary process whose correlation falls by a factor ρ from row to row, Ω_ij = σ² ρ^|i − j|, and those of
//! different runs as independent. Then the coefficients β = S y of a fit have the covariance S Ω Sᵀ. A fit leaves residuals that are smaller and less
//! correlated than the errors; ρ and σ are those at which the expected sum of squares and of products of neighbours are the ones that are found:
//!
//! E Σ r_i² = tr(M Ω Mᵀ),  E Σ r_i r_{i+1} = Σ (M Ω Mᵀ)_{i,i+1},  M = 1 − X S.
//!
//! It is meant for few runs; with five and more, whole runs as clusters assume nothing about the process.
//!
//! **Setting.** Rows of a run in even steps of time, one response. **Units.** Those of coefficients and response.
//!
//! # Source
//!
//! Moments of residuals of a linear model: Seber & Lee (2003), *Linear Regression Analysis*, 3.3; degrees of freedom by Satterthwaite, with
//! var ρ̂ = (1 − ρ²)/n and cov(ln σ̂², ρ̂) = 2ρ/n of a first-order process (Priestley 1981, 5.4).

use faer::Mat;

/// A correlation time of more than this part of the longest run is not told from what the law fits.
const LONGEST: f64 = 0.1;
/// Halvings of the interval that holds ρ.
const HALVINGS: usize = 40;

/// Scatter with correlation in time.
#[derive(Debug, Clone)]
pub struct Serial {
    /// Covariance of the coefficients, p × p.
    pub covariance: Mat<f64>,
    /// Degrees of freedom of its variances: those of σ², less what ρ costs.
    pub dof: f64,
    /// ρ, from one row to the next.
    pub correlation: f64,
    /// σ of a row.
    pub sigma: f64,
    /// Whether ρ is the largest that runs of this length tell: the covariance may then be too small.
    pub is_largest: bool,
}

/// The scatter of a fit.
///
/// `design` is n × p, `sensitivity` ∂β/∂y is p × n, `residual` has a number per row, and `run` tells which rows belong together; those of one run
/// stand one after the other in the order of time. `None` where no degree of freedom is left.
#[must_use]
pub fn serial(design: &Mat<f64>, sensitivity: &Mat<f64>, residual: &[f64], run: &[usize]) -> Option<Serial> {
    let n = residual.len();
    let determined = (0..design.ncols()).filter(|&j| (0..n).any(|i| sensitivity[(j, i)] != 0.0)).count();
    let squares: f64 = residual.iter().map(|r| r * r).sum();
    let pairs: Vec<usize> = (1..n).filter(|&i| run[i] == run[i - 1]).collect();
    if n <= determined + 1 || pairs.is_empty() || squares.is_nan() || squares <= 0.0 {
        return None;
    }
    let found = pairs.iter().map(|&i| residual[i] * residual[i - 1]).sum::<f64>() / squares;
    let expected = |rho: f64| {
        let left = Left::of(design, sensitivity, run, &pairs, rho);
        left.products / left.squares
    };
    let longest = run.chunk_by(|a, b| a == b).map(<[usize]>::len).max().unwrap_or(1);
    let largest = (-1.0 / (LONGEST * longest as f64)).exp();
    let (mut low, mut high) = (0.0, largest);
    if found <= expected(low) {
        high = low;
    } else if found >= expected(high) {
        low = high;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if expected(middle) < found { low = middle } else { high = middle }
    }
    let rho = 0.5 * (low + high);
    let left = Left::of(design, sensitivity, run, &pairs, rho);
    let variance = squares / left.squares;
    // Σ ρ^2|i−j| over all rows of a run, and over all runs.
    let sizes = run.chunk_by(|a, b| a == b).map(<[usize]>::len);
    let doubled: f64 = sizes.map(|m| (1..m).map(|k| 2.0 * (m - k) as f64 * rho.powi(2 * k as i32)).sum::<f64>()).sum();
    let of_variance = ((n as f64).powi(2) / (n as f64 + doubled) - determined as f64).max(1.0);
    // Of a slow coefficient's variance, σ² (1 + ρ)/(1 − ρ), with cov(ln σ̂², ρ̂) = 2ρ/n.
    let relative = 2.0 / of_variance + (4.0 + 8.0 * rho) / ((1.0 - rho * rho) * n as f64);
    let p = design.ncols();
    Some(Serial {
        covariance: Mat::from_fn(p, p, |i, j| variance * left.covariance[(i, j)]),
        dof: 2.0 / relative,
        correlation: rho,
        sigma: variance.sqrt(),
        is_largest: rho > 0.999 * largest,
    })
}

/// What is expected of residuals where σ = 1.
struct Left {
    /// S Ω Sᵀ.
    covariance: Mat<f64>,
    /// E Σ r_i².
    squares: f64,
    /// E Σ r_i r_{i+1}.
    products: f64,
}

impl Left {
    fn of(x: &Mat<f64>, s: &Mat<f64>, run: &[usize], pairs: &[usize], rho: f64) -> Self {
        let (n, p) = (x.nrows(), x.ncols());
        // Ω Sᵀ, a column for each coefficient.
        let columns: Vec<Vec<f64>> =
            (0..p).map(|j| correlated(&(0..n).map(|i| s[(j, i)]).collect::<Vec<f64>>(), run, rho)).collect();
        let covariance = Mat::from_fn(p, p, |i, j| (0..n).map(|k| s[(i, k)] * columns[j][k]).sum::<f64>());
        let cross = |i: usize, k: usize| (0..p).map(|j| x[(i, j)] * columns[j][k]).sum::<f64>();
        let both = |i: usize, k: usize| {
            (0..p).map(|a| x[(i, a)] * (0..p).map(|b| covariance[(a, b)] * x[(k, b)]).sum::<f64>()).sum::<f64>()
        };
        let squares = (0..n).map(|i| 1.0 - 2.0 * cross(i, i) + both(i, i)).sum();
        let products = pairs.iter().map(|&i| rho - cross(i, i - 1) - cross(i - 1, i) + both(i, i - 1)).sum();
        Self { covariance, squares, products }
    }
}

/// Σ_j ρ^|i−j| x_j within the runs of x, by one pass forward and one backward.
#[must_use]
pub fn correlated(x: &[f64], run: &[usize], rho: f64) -> Vec<f64> {
    let n = x.len();
    let mut out = vec![0.0; n];
    let mut sum = 0.0;
    for i in 0..n {
        let keep = if i > 0 && run[i] == run[i - 1] { rho } else { 0.0 };
        sum = sum * keep + x[i];
        out[i] = sum;
    }
    sum = 0.0;
    for i in (0..n.saturating_sub(1)).rev() {
        let keep = if run[i] == run[i + 1] { rho } else { 0.0 };
        sum = (sum + x[i + 1]) * keep;
        out[i] += sum;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    /// Two runs of 60 rows, a slow and a fast column.
    fn design() -> (Mat<f64>, Vec<usize>) {
        let x = Mat::from_fn(120, 2, |i, j| {
            let t = (i % 60) as f64;
            if j == 0 { 1.0 } else { (0.7 * t).sin() }
        });
        (x, (0..120).map(|i| i / 60).collect())
    }

    fn sensitivity(x: &Mat<f64>) -> Mat<f64> {
        let gram = x.transpose() * x;
        gram.llt(faer::Side::Lower).unwrap().solve(x.transpose().to_owned())
    }

    #[test]
    fn two_passes_are_the_sum_within_each_run() {
        let run = [0, 0, 0, 1, 1];
        let x = [1.0, -2.0, 4.0, 8.0, -1.0];
        let slow = |i: usize| -> f64 {
            (0..5).filter(|&j| run[j] == run[i]).map(|j| 0.5_f64.powi((i as i32 - j as i32).abs()) * x[j]).sum()
        };
        for (i, fast) in correlated(&x, &run, 0.5).into_iter().enumerate() {
            // Five terms, each rounded once.
            assert!((fast - slow(i)).abs() < 1e-14);
        }
    }

    /// The interval of a slow coefficient holds the truth as often as it says: 2,000 draws of an exponential correlation over two rows, and of none.
    #[test]
    fn intervals_of_a_slow_and_a_fast_coefficient_cover() {
        let (x, run) = design();
        let s = sensitivity(&x);
        for rho in [0.0_f64, 0.6] {
            let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
            let mut held = [0.0; 2];
            let n = 2000;
            for _ in 0..n {
                let mut e = vec![0.0; 120];
                for i in 0..120 {
                    let z: f64 = rng.sample(StandardNormal);
                    e[i] =
                        if i > 0 && run[i] == run[i - 1] { rho * e[i - 1] + (1.0 - rho * rho).sqrt() * z } else { z };
                }
                let beta: Vec<f64> = (0..2).map(|j| (0..120).map(|i| s[(j, i)] * e[i]).sum()).collect();
                let residual: Vec<f64> = (0..120).map(|i| e[i] - beta[0] * x[(i, 0)] - beta[1] * x[(i, 1)]).collect();
                let found = serial(&x, &s, &residual, &run).unwrap();
                let t = crate::distribution::coverage_factor(0.95, found.dof);
                for j in 0..2 {
                    held[j] += f64::from(u8::from(beta[j].abs() < t * found.covariance[(j, j)].sqrt())) / f64::from(n);
                }
            }
            // 2,000 draws at 95 % have a standard deviation of 0.5 %, taken three times; that ρ is uncertain is counted to first order, which costs some tenths.
            assert!(held.iter().all(|h| (h - 0.95).abs() < 0.02), "{rho}: {held:?}");
        }
    }
}
