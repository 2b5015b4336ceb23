//! Scatter of a least-squares fit whose errors are correlated in time within runs.
//!
//! The errors of a run are taken as a stationary Gaussian process whose correlation falls by a factor ρ from sample to sample, those of different runs
//! as independent, and a row as the mean of samples under weights w that move on by m samples from row to row. Rows k apart are then correlated by
//! c_k = Σ_a Σ_b w_a w_b ρ^|a − b − k m| over c_0: by the overlap of their windows, and beyond it by ρ^m from one to the next. Beside it, white noise of known size κ
//! may come through other weights: that of a second derivative is opposed from row to row, and hides how slow the rest is. With Ω = σ² ((1 − s) c + s d), σ² s = κ², the
//! coefficients β = S y of a fit have the covariance S Ω Sᵀ.
//!
//! A fit leaves residuals that are smaller and less correlated than the errors. What they tell of ρ and σ is their restricted likelihood, that of all
//! contrasts of the rows that no coefficient moves, with C = Ω/σ²:
//!
//! L(ρ) = |C|^−½ |XᵀC⁻¹X|^−½ Q^−(n−p)/2,  Q = r̃ᵀr̃ − r̃ᵀX̃ (X̃ᵀX̃)⁻¹ X̃ᵀr̃,  σ²|ρ = Q/(n − p),
//!
//! r̃ and X̃ whitened, s by iteration. Few rows tell ρ badly, and one that is found too small makes an interval too narrow and its degrees of freedom too many at once.
//! So no ρ is chosen: the error of a coefficient is taken as that of a mixture of Student's t of n − p degrees of freedom over all ρ^m from 0 to the largest that
//! the runs tell, evenly and each weighted by L. The covariance is the mean over that mixture, and the degrees of freedom are those at which Student's t has its 95 % interval.
//!
//! It is meant for few runs; with five and more, whole runs as clusters assume nothing about the process.
//!
//! **Setting.** Rows of a run in even steps of time (a gap counts as none), one response. **Units.** Those of coefficients and response.
//!
//! # Source
//!
//! Restricted likelihood: Harville (1974), Biometrika 61, 383; with a flat prior for correlated errors: Zellner & Tiao (1964), JASA 59, 763. Whitening by Levinson's
//! recursion: Brockwell & Davis (1991), *Time Series*, 5.2.

use faer::prelude::*;
use faer::{Mat, MatRef};

use crate::distribution::{dof_of_factor, root, t_two_sided};

/// A correlation time of more than this part of the longest run is not told from what the law fits.
const LONGEST: f64 = 0.3;
/// The same of rows that are the samples themselves. Few rows tell a slow error badly: of sixteen whose errors follow each other by 0.8, and two coefficients, 95 % intervals hold 83 % with
/// 0.3 and 93 % with this.
const LONGEST_OF_SAMPLES: f64 = 1.5;
/// Points of the mixture.
const POINTS: usize = 48;
/// Above this part of the largest correlation …
const AT_THE_END: f64 = 0.9;
/// … no more than this of the mixture lies, where the runs tell how slow the errors are.
const BEYOND: f64 = 0.2;
/// Most that known white noise is of the variance of a row.
const MOST_WHITE: f64 = 0.95;
/// Most steps for its share; one that changes it by less than a thousandth is the last.
const STEPS: usize = 8;
/// A partial correlation below this adds nothing to the whitening.
const NEGLIGIBLE: f64 = 1e-10;
/// A point of less than this part of the most likely one's weight is nothing of the mixture.
const UNLIKELY: f64 = 1e-9;
/// Outside an interval of 95 %.
const OUTSIDE: f64 = 0.05;

/// How rows are made of samples: means under `weights`, which move on by `every` samples from row to row.
#[derive(Debug, Clone, PartialEq)]
pub struct RowWindow {
    /// Weights of the samples; their scale does not matter.
    weights: Vec<f64>,
    /// Samples from one row to the next.
    every: usize,
}

/// How the errors of rows come about.
#[derive(Debug, Clone, PartialEq)]
pub struct RowErrors {
    /// What a row makes of the noise that is correlated in time.
    pub window: RowWindow,
    /// What it makes of white noise, and the standard deviation of a row by that.
    pub white: Option<(RowWindow, f64)>,
}

impl RowWindow {
    /// Means under `weights`, which are not all zero, every so many samples (one at least).
    #[must_use]
    pub fn new(weights: Vec<f64>, every: usize) -> Self {
        Self { weights, every: every.max(1) }
    }

    /// Rows that are the samples.
    #[must_use]
    pub fn single() -> Self {
        Self::new(vec![1.0], 1)
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
    /// That of a sum of which `share` of the variance is `white`, which has none beyond its overlap.
    fn with(&self, white: &Self, share: f64) -> Self {
        let apart = self.near.len().max(white.near.len());
        let own = 1.0 - share;
        Self {
            near: (0..apart).map(|k| own * self.at(k) + share * white.near.get(k).unwrap_or(&0.0)).collect(),
            apart: own * self.at(apart),
            ratio: self.ratio,
        }
    }

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
    /// Degrees of freedom at which Student's t has the mixture's 95 % interval of each coefficient; infinite where that is below a normal's.
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
    /// What it stands for of the range of ρ^m.
    width: f64,
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
    sensitivity: MatRef<'_, f64>,
    residual: &[f64],
    run: &[usize],
    errors: &RowErrors,
) -> Option<Serial> {
    mixture(design, sensitivity, &[residual.to_vec()], run, errors)
}

/// The scatter to expect of a fit whose errors have the correlation of samples `rho` and the standard deviation `sigma` of a row, beside the white noise of `errors`.
///
/// That of [`serial`] at the expected Q.
#[must_use]
pub fn to_expect(
    design: &Mat<f64>,
    sensitivity: MatRef<'_, f64>,
    run: &[usize],
    errors: &RowErrors,
    (rho, sigma): (f64, f64),
) -> Option<Serial> {
    let n = run.len();
    let c = errors.window.correlation(rho);
    let white = errors.white.as_ref().map(|(window, standard)| (window.correlation(0.0), standard * standard));
    let omega = |i: usize, j: usize| {
        let apart = i.abs_diff(j);
        let of_white = white.as_ref().map_or(0.0, |(d, square)| square * d.near.get(apart).unwrap_or(&0.0));
        if run[i] == run[j] { sigma * sigma * c.at(apart) + of_white } else { 0.0 }
    };
    let factor = Mat::from_fn(n, n, omega).llt(faer::Side::Lower).ok()?;
    // Residuals whose squares sum to those that are expected: M times each column of the factor.
    let residual = |k: usize| {
        let e: Vec<f64> = (0..n).map(|i| if i >= k { factor.L()[(i, k)] } else { 0.0 }).collect();
        let beta: Vec<f64> =
            (0..design.ncols()).map(|j| (k..n).map(|i| sensitivity[(j, i)] * e[i]).sum::<f64>()).collect();
        (0..n).map(|i| e[i] - beta.iter().enumerate().map(|(j, b)| design[(i, j)] * b).sum::<f64>()).collect()
    };
    mixture(design, sensitivity, &(0..n).map(residual).collect::<Vec<Vec<f64>>>(), run, errors)
}

/// The mixture for residuals whose Q add up.
fn mixture(
    design: &Mat<f64>,
    sensitivity: MatRef<'_, f64>,
    residuals: &[Vec<f64>],
    run: &[usize],
    errors: &RowErrors,
) -> Option<Serial> {
    let (n, p) = (run.len(), design.ncols());
    let free: Vec<usize> = (0..p).filter(|&j| (0..n).any(|i| sensitivity[(j, i)] != 0.0)).collect();
    let squares: f64 = residuals.iter().flatten().map(|r| r * r).sum();
    let has_neighbours = run.windows(2).any(|w| w[0] == w[1]);
    if n <= free.len() + 1 || !has_neighbours || squares.is_nan() || squares <= 0.0 {
        return None;
    }
    let mut columns: Vec<Vec<f64>> = free.iter().map(|&j| (0..n).map(|i| design[(i, j)]).collect()).collect();
    columns.extend(residuals.iter().cloned());
    let dof = (n - free.len()) as f64;
    let longest = run.chunk_by(|a, b| a == b).map(<[usize]>::len).max().unwrap_or(1);
    let part = if errors.window == RowWindow::single() { LONGEST_OF_SAMPLES } else { LONGEST };
    let largest = (-1.0 / (part * longest as f64)).exp();
    let white = errors.white.as_ref().map(|(window, standard)| (window.correlation(0.0), standard * standard));
    // Even steps of artanh ρ^m lie closer where a covariance changes faster.
    let step = largest.atanh() / POINTS as f64;
    let point = |k: usize| {
        let ratio = (step * (k as f64 + 0.5)).tanh();
        let alone = errors.window.correlation(ratio.powf(1.0 / errors.window.every as f64));
        let mut found = None;
        let mut share = 0.0;
        for _ in 0..STEPS {
            let c = white.as_ref().map_or_else(|| alone.clone(), |(d, _)| alone.with(d, share));
            let (log_determinants, q) = contrasts(&columns, free.len(), run, &c)?;
            found = Some((c, log_determinants, q / dof));
            let next = white.as_ref().map_or(0.0, |(_, square)| (square / (q / dof)).min(MOST_WHITE));
            if (next - share).abs() < 1e-3 {
                break;
            }
            share = next;
        }
        let (c, log_determinants, variance) = found?;
        Some(Point {
            ratio,
            width: 1.0 - ratio * ratio,
            neighbours: c.at(1),
            variance,
            covariance: covariance(sensitivity, run, &c),
            likelihood: -0.5 * (log_determinants + dof * variance.ln()),
        })
    };
    let all: Vec<Point> = (0..POINTS).filter_map(point).filter(|p| p.likelihood.is_finite()).collect();
    let most = all.iter().map(|p| p.likelihood).fold(f64::NEG_INFINITY, f64::max);
    let points: Vec<Point> = all.into_iter().filter(|p| (p.likelihood - most).exp() > UNLIKELY).collect();
    let raw: Vec<f64> = points.iter().map(|p| p.width * (p.likelihood - most).exp()).collect();
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
        is_largest: mean(&|p| f64::from(u8::from(p.ratio > AT_THE_END * largest))) > BEYOND,
        covariance: total,
    })
}

/// ln |C| + ln |XᵀC⁻¹X|, and the sum of Q of the columns beyond the first `free`.
fn contrasts(columns: &[Vec<f64>], free: usize, run: &[usize], c: &Correlation) -> Option<(f64, f64)> {
    let (white, log_determinant) = whitened(columns, run, c)?;
    let (x, residuals) = white.split_at(free);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let factor = Mat::from_fn(free, free, |a, b| dot(&x[a], &x[b])).llt(faer::Side::Lower).ok()?;
    let toward = Mat::from_fn(free, residuals.len(), |a, k| dot(&x[a], &residuals[k]));
    let solved = factor.solve(&toward);
    let of_one =
        |k: usize| dot(&residuals[k], &residuals[k]) - (0..free).map(|a| toward[(a, k)] * solved[(a, k)]).sum::<f64>();
    let of_gram: f64 = (0..free).map(|a| 2.0 * factor.L()[(a, a)].ln()).sum();
    Some((log_determinant + of_gram, (0..residuals.len()).map(of_one).sum()))
}

/// S c Sᵀ.
fn covariance(s: MatRef<'_, f64>, run: &[usize], c: &Correlation) -> Mat<f64> {
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
        RowWindow::new((0..12).map(weight).collect(), 4)
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
        let single = || RowErrors { window: RowWindow::single(), white: None };
        let bumps = || RowErrors { window: bump(), white: None };
        // A second difference over a third of the window, whose rows oppose each other.
        let bend = || {
            let at = |a: usize| std::f64::consts::TAU * ((a as f64 + 0.5) / 12.0 - 0.5);
            RowWindow::new((0..12).map(|a| -at(a).cos() - (2.0 * at(a)).cos()).collect(), 4)
        };
        let size = |window: &RowWindow| window.weights.iter().map(|w| w * w).sum::<f64>().sqrt();
        let both = || RowErrors { white: Some((bend(), 5.0)), ..bumps() };
        for (errors, rho) in [(single(), 0.0_f64), (single(), 0.6), (bumps(), 0.0), (bumps(), 0.9), (both(), 0.9)] {
            let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
            let mut held = [0.0; 2];
            let draws = 1000;
            let rows = |window: &RowWindow, samples: &[f64]| -> Vec<f64> {
                let row = |i: usize| window.weights.iter().zip(&samples[i * window.every..]).map(|(w, x)| w * x).sum();
                (0..60).map(row).collect()
            };
            for _ in 0..draws {
                let mut e = Vec::new();
                for _ in 0..2 {
                    let samples = errors.window.weights.len() + 59 * errors.window.every;
                    let normal: Vec<f64> = (0..2 * samples).map(|_| rng.sample(StandardNormal)).collect();
                    let mut slow = vec![normal[0]; samples];
                    for i in 1..samples {
                        slow[i] = rho * slow[i - 1] + (1.0 - rho * rho).sqrt() * normal[i];
                    }
                    let mut own = rows(&errors.window, &slow);
                    if let Some((window, standard)) = &errors.white {
                        let of_white = rows(window, &normal[samples..]);
                        own.iter_mut().zip(of_white).for_each(|(a, b)| *a += standard / size(window) * b);
                    }
                    e.extend(own);
                }
                let beta: Vec<f64> = (0..2).map(|j| (0..120).map(|i| s[(j, i)] * e[i]).sum()).collect();
                let residual: Vec<f64> = (0..120).map(|i| e[i] - beta[0] * x[(i, 0)] - beta[1] * x[(i, 1)]).collect();
                let found = serial(&x, s.as_ref(), &residual, &run, &errors).unwrap();
                for j in 0..2 {
                    let t = crate::distribution::coverage_factor(0.95, found.dof[j]);
                    held[j] +=
                        f64::from(u8::from(beta[j].abs() < t * found.covariance[(j, j)].sqrt())) / f64::from(draws);
                }
            }
            // 1,000 draws at 95 % have a standard deviation of 0.7 %, taken three times. White noise is the end of the range of ρ: what is told of it there can
            // only lie above, and the intervals hold 97 %; the same three deviations above that.
            let high = if rho == 0.0 { 0.986 } else { 0.971 };
            assert!(held.iter().all(|h| (0.929..high).contains(h)), "{rho} {errors:?}: {held:?}");
        }
    }

    /// What is expected is what 400 draws give in the mean, for the covariance and for the degrees of freedom in between.
    #[test]
    fn what_is_to_be_expected_lies_in_the_middle_of_what_is_found() {
        let (x, run) = design();
        let s = sensitivity(&x);
        let errors = RowErrors { window: RowWindow::single(), white: None };
        let expected = to_expect(&x, s.as_ref(), &run, &errors, (0.6, 2.0)).unwrap();
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        let widths = |found: &Serial, j: usize| {
            crate::distribution::coverage_factor(0.95, found.dof[j]) * found.covariance[(j, j)].sqrt()
        };
        let mut mean = [0.0; 2];
        for _ in 0..400 {
            let mut e = vec![0.0; 120];
            for i in 0..120 {
                let z: f64 = rng.sample(StandardNormal);
                e[i] = if i % 60 > 0 { 0.6 * e[i - 1] + 1.6 * z } else { 2.0 * z };
            }
            let beta: Vec<f64> = (0..2).map(|j| (0..120).map(|i| s[(j, i)] * e[i]).sum()).collect();
            let residual: Vec<f64> = (0..120).map(|i| e[i] - beta[0] * x[(i, 0)] - beta[1] * x[(i, 1)]).collect();
            let found = serial(&x, s.as_ref(), &residual, &run, &errors).unwrap();
            mean.iter_mut().enumerate().for_each(|(j, m)| *m += widths(&found, j) / 400.0);
        }
        // Widths scatter by a quarter, their mean by a hundredth; the mean of a skew quantity lies beside that at the mean by as much or twice.
        for j in 0..2 {
            assert!((widths(&expected, j) / mean[j] - 1.0).abs() < 0.04, "{} {}", widths(&expected, j), mean[j]);
        }
        // σ is that of the mixture, whose slow part raises it by some hundredths.
        assert!((expected.sigma / 2.0 - 1.0).abs() < 0.1, "{}", expected.sigma);
    }
}
