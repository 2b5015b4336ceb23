//! Scatter of a least-squares fit whose errors are correlated in time within runs.
//!
//! The errors of a run are taken as a stationary Gaussian process whose correlation falls by a factor ρ from sample to sample, those of different runs
//! as independent, and a row as the mean of samples under weights w that move on by m samples from row to row. Rows k apart are then correlated by
//! c_k = Σ_a Σ_b w_a w_b ρ^|a − b − k m| over c_0: by the overlap of their windows, and beyond it by ρ^m from one to the next. With Ω = σ² c the
//! coefficients β = S y of a fit have the covariance S Ω Sᵀ.
//!
//! A fit leaves residuals that are smaller and less correlated than the errors. What they tell of ρ and σ is their restricted likelihood, that of all
//! contrasts of the rows that no coefficient moves:
//!
//! L(ρ) = |c|^−½ |Xᵀc⁻¹X|^−½ Q^−(n−p)/2,  Q = r̃ᵀr̃ − r̃ᵀX̃ (X̃ᵀX̃)⁻¹ X̃ᵀr̃,  σ²|ρ = Q/(n − p),
//!
//! r̃ and X̃ whitened. Few rows tell ρ badly, and one that is found too small makes an interval too narrow and its degrees of freedom too many at once.
//! So no ρ is chosen: the error of a coefficient is that of a mixture of Student's t of n − p degrees of freedom over all ρ^m from 0 to the largest that
//! the runs tell, each weighted by L. The covariance is the mean over that mixture, and the degrees of freedom are those at which Student's t has its 95 % interval.
//!
//! It is meant for few runs; with five and more, whole runs as clusters assume nothing about the process.
//!
//! **Setting.** Rows of a run in even steps of time, one response. **Units.** Those of coefficients and response.
//!
//! # Source
//!
//! Restricted likelihood: Harville (1974), Biometrika 61, 383; its use with a flat prior: Box & Tiao (1973), *Bayesian Inference in Statistical Analysis*, 8.5. Whitening by Levinson's
//! recursion: Brockwell & Davis (1991), *Time Series*, 5.2. Beforehand ([`degrees_of_freedom`]): variances of sample covariances by Bartlett (Priestley 1981, *Spectral Analysis
//! and Time Series*, 5.3.3), and a χ² whose logarithm scatters as that of the variance does.

use faer::Mat;
use faer::prelude::*;

use crate::distribution::{coverage_factor, dof_of_log_variance, t_two_sided, trigamma};

/// A correlation time of more than this part of the longest run is not told from what the law fits.
const LONGEST: f64 = 0.1;
/// Points of the mixture.
const POINTS: usize = 48;
/// Above this part of the largest correlation its mean is the largest.
const AT_THE_END: f64 = 0.9;
/// A partial correlation below this adds nothing to the whitening.
const NEGLIGIBLE: f64 = 1e-10;
/// Outside an interval of 95 %.
const OUTSIDE: f64 = 0.05;
/// Halvings of an interval that holds a root.
const HALVINGS: usize = 60;
/// Step of the derivative by ρ, as part of what is left of it.
const STEP: f64 = 1e-3;

/// How rows are made of samples: means under `weights`, which move on by `every` samples from row to row.
#[derive(Debug, Clone, PartialEq)]
pub struct RowWindow {
    /// Weights of the samples; their scale does not matter.
    pub weights: Vec<f64>,
    /// Samples from one row to the next, 1 or more.
    pub every: usize,
}

impl RowWindow {
    /// Rows that are the samples.
    #[must_use]
    pub fn single() -> Self {
        Self { weights: vec![1.0], every: 1 }
    }

    /// Correlation of rows where that of samples falls by `rho` from one to the next.
    fn correlation(&self, rho: f64) -> Correlation {
        let w = &self.weights;
        // From so many rows apart on the windows share no sample.
        let apart = w.len().div_ceil(self.every);
        let powers: Vec<f64> = (0..=w.len() + apart * self.every).map(|d| rho.powi(d as i32)).collect();
        let raw = |k: usize| -> f64 {
            let pairs = w.iter().enumerate().flat_map(|(a, x)| w.iter().enumerate().map(move |(b, y)| (a, b, x * y)));
            pairs.map(|(a, b, xy)| xy * powers[a.abs_diff(b + k * self.every)]).sum()
        };
        let alone = raw(0);
        Correlation {
            near: (0..apart).map(|k| raw(k) / alone).collect(),
            apart: raw(apart) / alone,
            ratio: rho.powi(self.every as i32),
        }
    }
}

/// Correlation of rows by how many rows they are apart.
#[derive(Debug, Clone, PartialEq)]
struct Correlation {
    /// Where their windows overlap, from 0 rows apart on.
    near: Vec<f64>,
    /// Where they first do not …
    apart: f64,
    /// … and its factor from there on.
    ratio: f64,
}

impl Correlation {
    fn at(&self, k: usize) -> f64 {
        let beyond = || self.apart * self.ratio.powi((k - self.near.len()) as i32);
        self.near.get(k).copied().unwrap_or_else(beyond)
    }

    /// Σ_j c_|i−j| x_j within the runs of x: what overlaps term by term, what lies beyond by one pass forward and one backward.
    fn times(&self, x: &[f64], run: &[usize]) -> Vec<f64> {
        let (n, apart) = (x.len(), self.near.len());
        let mut out = vec![0.0; n];
        let mut from = 0;
        for rows in run.chunk_by(|a, b| a == b) {
            let (x, out) = (&x[from..from + rows.len()], &mut out[from..from + rows.len()]);
            from += rows.len();
            let (mut before, mut after) = (0.0, 0.0);
            for i in 0..x.len() {
                let low = (i + 1).saturating_sub(apart);
                let overlap = (low..x.len().min(i + apart)).map(|j| self.near[i.abs_diff(j)] * x[j]).sum::<f64>();
                before = before * self.ratio + if i >= apart { self.apart * x[i - apart] } else { 0.0 };
                out[i] += overlap + before;
            }
            for i in (0..x.len()).rev() {
                after = after * self.ratio + x.get(i + apart).map_or(0.0, |x| self.apart * x);
                out[i] += after;
            }
        }
        out
    }
}

/// Scatter with correlation in time.
#[derive(Debug, Clone)]
pub struct Serial {
    /// Covariance of the coefficients, p × p.
    pub covariance: Mat<f64>,
    /// Degrees of freedom of each coefficient's variance: those of σ², less what ρ costs.
    pub dof: Vec<f64>,
    /// Correlation from one row to the next.
    pub correlation: f64,
    /// σ of a row.
    pub sigma: f64,
    /// Whether ρ is the largest that runs of this length tell: the covariance may then be too small.
    pub is_largest: bool,
}

/// One ρ of the mixture.
struct Point {
    /// ρ^m.
    ratio: f64,
    /// Correlation of neighbouring rows.
    neighbours: f64,
    /// σ².
    variance: f64,
    /// S c Sᵀ.
    covariance: Mat<f64>,
    /// ln L.
    likelihood: f64,
}

/// The scatter of a fit.
///
/// `design` is n × p, `sensitivity` ∂β/∂y is p × n, `residual` has a number per row, and `run` tells which rows belong together; those of one run
/// stand one after the other in the order of time. `None` where no degree of freedom is left.
#[must_use]
pub fn serial(
    design: &Mat<f64>,
    sensitivity: &Mat<f64>,
    residual: &[f64],
    run: &[usize],
    window: &RowWindow,
) -> Option<Serial> {
    let (n, p) = (residual.len(), design.ncols());
    let free: Vec<usize> = (0..p).filter(|&j| (0..n).any(|i| sensitivity[(j, i)] != 0.0)).collect();
    let squares: f64 = residual.iter().map(|r| r * r).sum();
    if n <= free.len() + 1 || neighbours(run).is_empty() || squares.is_nan() || squares <= 0.0 {
        return None;
    }
    let mut columns: Vec<Vec<f64>> = free.iter().map(|&j| (0..n).map(|i| design[(i, j)]).collect()).collect();
    columns.push(residual.to_vec());
    let dof = (n - free.len()) as f64;
    let longest = run.chunk_by(|a, b| a == b).map(<[usize]>::len).max().unwrap_or(1);
    let largest = (-1.0 / (LONGEST * longest as f64)).exp();
    let point = |k: usize| {
        let ratio = largest * (k as f64 + 0.5) / POINTS as f64;
        let c = window.correlation(ratio.powf(1.0 / window.every as f64));
        let (white, log_determinant) = whitened(&columns, run, &c)?;
        let (x, r) = white.split_at(free.len());
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let gram = Mat::from_fn(free.len(), free.len(), |a, b| dot(&x[a], &x[b]));
        let factor = gram.llt(faer::Side::Lower).ok()?;
        let toward = Mat::from_fn(free.len(), 1, |a, _| dot(&x[a], &r[0]));
        let solved = factor.solve(&toward);
        let left = dot(&r[0], &r[0]) - (0..free.len()).map(|a| toward[(a, 0)] * solved[(a, 0)]).sum::<f64>();
        let of_gram: f64 = (0..free.len()).map(|a| 2.0 * factor.L()[(a, a)].ln()).sum();
        Some(Point {
            ratio,
            neighbours: c.at(1),
            variance: left / dof,
            covariance: covariance(sensitivity, run, &c),
            likelihood: -0.5 * (log_determinant + of_gram + dof * left.ln()),
        })
    };
    let points: Vec<Point> = (0..POINTS).filter_map(point).filter(|p| p.likelihood.is_finite()).collect();
    let most = points.iter().map(|p| p.likelihood).fold(f64::NEG_INFINITY, f64::max);
    let raw: Vec<f64> = points.iter().map(|p| (p.likelihood - most).exp()).collect();
    let all: f64 = raw.iter().sum();
    let mean = |of: &dyn Fn(&Point) -> f64| points.iter().zip(&raw).map(|(p, w)| w * of(p)).sum::<f64>() / all;
    if points.is_empty() || !mean(&|p| p.variance).is_finite() {
        return None;
    }
    let total = Mat::from_fn(p, p, |i, j| mean(&|p| p.variance * p.covariance[(i, j)]));
    let dof_of = |j: usize| {
        let scale = total[(j, j)].sqrt();
        let outside =
            |factor: f64| mean(&|p| t_two_sided(factor * scale / (p.variance * p.covariance[(j, j)]).sqrt(), dof));
        if scale > 0.0 { dof_of_factor(root(0.0, 1e3, |factor| outside(factor) > OUTSIDE)) } else { dof }
    };
    Some(Serial {
        dof: (0..p).map(dof_of).collect(),
        correlation: mean(&|p| p.neighbours),
        sigma: mean(&|p| p.variance).sqrt(),
        is_largest: mean(&|p| p.ratio) > AT_THE_END * largest,
        covariance: total,
    })
}

/// Where a condition ends to hold between two numbers.
fn root(low: f64, high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Degrees of freedom with this two-sided 95 % factor of Student's t; infinite below that of a normal.
fn dof_of_factor(factor: f64) -> f64 {
    if factor <= coverage_factor(1.0 - OUTSIDE, f64::INFINITY) {
        return f64::INFINITY;
    }
    root(-2.0, 20.0, |log| coverage_factor(1.0 - OUTSIDE, log.exp()) > factor).exp()
}

/// S c Sᵀ.
fn covariance(s: &Mat<f64>, run: &[usize], c: &Correlation) -> Mat<f64> {
    let (p, n) = (s.nrows(), s.ncols());
    let columns: Vec<Vec<f64>> =
        (0..p).map(|j| c.times(&(0..n).map(|i| s[(j, i)]).collect::<Vec<f64>>(), run)).collect();
    Mat::from_fn(p, p, |i, j| (0..n).map(|k| s[(i, k)] * columns[j][k]).sum::<f64>())
}

/// Columns whose errors have the correlation c, made independent with variance one by Levinson's recursion, and ln |c|.
fn whitened(columns: &[Vec<f64>], run: &[usize], c: &Correlation) -> Option<(Vec<Vec<f64>>, f64)> {
    let mut out = columns.to_vec();
    let mut log_determinant = 0.0;
    let starts: Vec<(usize, usize)> = run
        .chunk_by(|a, b| a == b)
        .scan(0, |from, rows| {
            *from += rows.len();
            Some((*from - rows.len(), rows.len()))
        })
        .collect();
    let longest = starts.iter().map(|(_, rows)| *rows).max()?;
    // Weights of the rows before, the last first, and the variance of what they do not tell.
    let (mut weights, mut variance): (Vec<f64>, f64) = (Vec::new(), 1.0);
    let mut is_whole = false;
    for i in 0..longest {
        for &(from, _) in starts.iter().filter(|(_, rows)| *rows > i) {
            log_determinant += variance.ln();
            for (column, out) in columns.iter().zip(&mut out) {
                let told: f64 = weights.iter().enumerate().map(|(k, w)| w * column[from + i - 1 - k]).sum();
                out[from + i] = (column[from + i] - told) / variance.sqrt();
            }
        }
        if is_whole {
            continue;
        }
        let told: f64 = weights.iter().enumerate().map(|(k, w)| w * c.at(i - k)).sum();
        let partial = (c.at(i + 1) - told) / variance;
        if partial.abs() < NEGLIGIBLE {
            is_whole = true;
            continue;
        }
        let reversed: Vec<f64> = weights.iter().rev().copied().collect();
        weights.iter_mut().zip(reversed).for_each(|(w, r)| *w -= partial * r);
        weights.push(partial);
        variance *= 1.0 - partial * partial;
        if variance.is_nan() || variance <= 0.0 {
            return None;
        }
    }
    Some((out, log_determinant))
}

/// Degrees of freedom to expect of [`serial`], to first order, where the correlation of the samples falls by `rho`.
#[must_use]
pub fn degrees_of_freedom(
    design: &Mat<f64>,
    sensitivity: &Mat<f64>,
    run: &[usize],
    window: &RowWindow,
    rho: f64,
) -> Vec<f64> {
    let pairs = neighbours(run);
    let left = |rho: f64| Left::of(design, sensitivity, run, &pairs, &window.correlation(rho));
    let (below, above) = (rho - STEP * rho.min(1.0 - rho), rho + STEP * (1.0 - rho));
    let (under, at, over) = (left(below), left(rho), left(above));
    // How a variance goes with the ratio of both moments.
    let slope = |j: usize| {
        let of = |left: &Left| left.covariance[(j, j)] / left.squares;
        let relative = (of(&over) - of(&under)) / (over.ratio() - under.ratio()) / of(&at);
        if relative.is_finite() { relative } else { 0.0 }
    };
    let sizes: Vec<usize> = run.chunk_by(|a, b| a == b).map(<[usize]>::len).collect();
    let spread = Spread::of(&window.correlation(rho), &sizes);
    let determined = determined(sensitivity) as f64;
    (0..design.ncols()).map(|j| dof_of_log_variance(spread.of_log(slope(j), determined))).collect()
}

/// Coefficients that the rows determine.
fn determined(sensitivity: &Mat<f64>) -> usize {
    (0..sensitivity.nrows()).filter(|&j| (0..sensitivity.ncols()).any(|i| sensitivity[(j, i)] != 0.0)).count()
}

/// Rows that follow one of their own run.
fn neighbours(run: &[usize]) -> Vec<usize> {
    (1..run.len()).filter(|&i| run[i] == run[i - 1]).collect()
}

/// Variances of the mean square of errors and of the mean product of neighbours, σ = 1, and their covariance.
struct Spread {
    of_square: f64,
    of_product: f64,
    of_both: f64,
    correlation: f64,
}

impl Spread {
    fn of(c: &Correlation, sizes: &[usize]) -> Self {
        let n = sizes.iter().sum::<usize>() as f64;
        let (mut of_square, mut of_product, mut of_both) = (0.0, 0.0, 0.0);
        for &m in sizes {
            for k in 0..m {
                // Both signs of k, of as many pairs of rows.
                let pairs = (m - k) as f64 * if k == 0 { 1.0 } else { 2.0 } / (n * n);
                let (before, here, after) = (c.at(k.abs_diff(1)), c.at(k), c.at(k + 1));
                of_square += 2.0 * pairs * here * here;
                of_product += pairs * (here * here + before * after);
                of_both += pairs * here * (before + after);
            }
        }
        Self { of_square, of_product, of_both, correlation: c.at(1) }
    }

    /// Variance of the logarithm of σ² h(R) with `slope` d ln h/dR, R the ratio of both; `determined` coefficients were fitted.
    fn of_log(&self, slope: f64, determined: f64) -> f64 {
        let r = self.correlation;
        let of_variance = trigamma(0.5 * (2.0 / self.of_square - determined).max(1.0));
        let with_ratio = self.of_both - r * self.of_square;
        let of_ratio = self.of_product - 2.0 * r * self.of_both + r * r * self.of_square;
        of_variance + 2.0 * slope * with_ratio + slope * slope * of_ratio
    }
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
    fn of(x: &Mat<f64>, s: &Mat<f64>, run: &[usize], pairs: &[usize], c: &Correlation) -> Self {
        let (n, p) = (x.nrows(), x.ncols());
        // Ω Sᵀ, a column for each coefficient.
        let columns: Vec<Vec<f64>> =
            (0..p).map(|j| c.times(&(0..n).map(|i| s[(j, i)]).collect::<Vec<f64>>(), run)).collect();
        let covariance = Mat::from_fn(p, p, |i, j| (0..n).map(|k| s[(i, k)] * columns[j][k]).sum::<f64>());
        let cross = |i: usize, k: usize| (0..p).map(|j| x[(i, j)] * columns[j][k]).sum::<f64>();
        let both = |i: usize, k: usize| {
            (0..p).map(|a| x[(i, a)] * (0..p).map(|b| covariance[(a, b)] * x[(k, b)]).sum::<f64>()).sum::<f64>()
        };
        let squares = (0..n).map(|i| 1.0 - 2.0 * cross(i, i) + both(i, i)).sum();
        let neighbours = c.at(1);
        let products = pairs.iter().map(|&i| neighbours - cross(i, i - 1) - cross(i - 1, i) + both(i, i - 1)).sum();
        Self { covariance, squares, products }
    }

    fn ratio(&self) -> f64 {
        self.products / self.squares
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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

    /// Twelve samples under a smooth bump, a third of that apart.
    fn bump() -> RowWindow {
        let weight = |a: usize| (1.0 + (std::f64::consts::TAU * ((a as f64 + 0.5) / 12.0 - 0.5)).cos()).powi(2);
        RowWindow { weights: (0..12).map(weight).collect(), every: 4 }
    }

    #[test]
    fn two_passes_are_the_sum_within_each_run() {
        let run = [0, 0, 0, 0, 0, 0, 1, 1];
        let x = [1.0, -2.0, 4.0, 8.0, -1.0, 3.0, 0.5, -7.0];
        for window in [RowWindow::single(), bump()] {
            let c = window.correlation(0.5);
            let slow =
                |i: usize| -> f64 { (0..8).filter(|&j| run[j] == run[i]).map(|j| c.at(i.abs_diff(j)) * x[j]).sum() };
            for (i, fast) in c.times(&x, &run).into_iter().enumerate() {
                // Six terms, each rounded once.
                assert!((fast - slow(i)).abs() < 1e-14, "{i}");
            }
        }
    }

    /// Beyond the overlap the sum over both windows is its first term times ρ^m; of white noise nothing is left there.
    #[test]
    fn beyond_the_overlap_the_correlation_falls_by_one_factor() {
        let window = bump();
        let direct = |k: usize, rho: f64| -> f64 {
            let of =
                |a: usize, b: usize| rho.powi(a.abs_diff(b + 4 * k) as i32) * window.weights[a] * window.weights[b];
            (0..12).flat_map(|a| (0..12).map(move |b| (a, b))).map(|(a, b)| of(a, b)).sum()
        };
        for rho in [0.3, 0.9, 0.99] {
            for k in 0..8 {
                let expected = direct(k, rho) / direct(0, rho);
                // 144 products, each rounded.
                assert!((window.correlation(rho).at(k) / expected - 1.0).abs() < 1e-12, "{rho} {k}");
            }
        }
        let white = window.correlation(0.0);
        assert!(white.at(1) > 0.2 && white.at(3) == 0.0 && white.at(4) == 0.0, "{white:?}");
        assert_eq!(RowWindow::single().correlation(0.5).at(3), 0.125);
    }

    /// Whitened by Levinson's recursion: c⁻¹ and |c| as by Cholesky's factor.
    #[test]
    fn whitened_columns_have_the_inverse_of_the_correlation_between_them() {
        let run = [0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1];
        let x: Vec<f64> = (0..11).map(|i| f64::from(i * i % 7) - 2.5).collect();
        let y: Vec<f64> = (0..11).map(|i| f64::from(i * 5 % 11)).collect();
        for (window, rho) in [(RowWindow::single(), 0.6), (bump(), 0.9), (bump(), 0.0)] {
            let c = window.correlation(rho);
            let dense = Mat::from_fn(11, 11, |i, j| if run[i] == run[j] { c.at(usize::abs_diff(i, j)) } else { 0.0 });
            let factor = dense.llt(faer::Side::Lower).unwrap();
            let solved = factor.solve(Mat::from_fn(11, 1, |i, _| y[i]));
            let expected: f64 = (0..11).map(|i| x[i] * solved[(i, 0)]).sum();
            let (white, log_determinant) = whitened(&[x.clone(), y.clone()], &run, &c).unwrap();
            let found: f64 = white[0].iter().zip(&white[1]).map(|(a, b)| a * b).sum();
            // What is negligible is cut at 1e-10.
            assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
            let of_factor: f64 = (0..11).map(|i| 2.0 * factor.L()[(i, i)].ln()).sum();
            assert!((log_determinant - of_factor).abs() < 1e-8);
        }
    }

    /// Both intervals hold the truth as often as they say: 2,000 draws of white and of correlated samples, as rows and under overlapping windows.
    #[test]
    fn intervals_of_a_slow_and_a_fast_coefficient_cover() {
        let (x, run) = design();
        let s = sensitivity(&x);
        for (window, rho) in [(RowWindow::single(), 0.0_f64), (RowWindow::single(), 0.6), (bump(), 0.0), (bump(), 0.9)]
        {
            let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
            let mut held = [0.0; 2];
            let n = 2000;
            for _ in 0..n {
                let mut e = Vec::new();
                for _ in 0..2 {
                    let mut samples: Vec<f64> = Vec::new();
                    for i in 0..window.weights.len() + 59 * window.every {
                        let z: f64 = rng.sample(StandardNormal);
                        samples.push(if i > 0 { rho * samples[i - 1] + (1.0 - rho * rho).sqrt() * z } else { z });
                    }
                    e.extend((0..60).map(|row| -> f64 {
                        window.weights.iter().zip(&samples[row * window.every..]).map(|(w, x)| w * x).sum()
                    }));
                }
                let beta: Vec<f64> = (0..2).map(|j| (0..120).map(|i| s[(j, i)] * e[i]).sum()).collect();
                let residual: Vec<f64> = (0..120).map(|i| e[i] - beta[0] * x[(i, 0)] - beta[1] * x[(i, 1)]).collect();
                let found = serial(&x, &s, &residual, &run, &window).unwrap();
                for j in 0..2 {
                    let t = crate::distribution::coverage_factor(0.95, found.dof[j]);
                    held[j] += f64::from(u8::from(beta[j].abs() < t * found.covariance[(j, j)].sqrt())) / f64::from(n);
                }
            }
            // 2,000 draws at 95 % have a standard deviation of 0.5 %, taken three times. White noise is the end of the range of ρ: what is told of it there can
            // only lie above, and the intervals hold 97 %.
            let high = if rho == 0.0 { 0.985 } else { 0.965 };
            assert!(held.iter().all(|h| (0.935..high).contains(h)), "{rho} {}: {held:?}", window.every);
        }
    }
}
