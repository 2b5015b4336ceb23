//! Pairs bootstrap: what would other draws of the same rows have given?
//!
//! A resample draws as many rows as there are, with replacement. That is an integer
//! weight on each row, so a resample needs only the weighted sums of products of
//! columns. They are taken in the orthonormal basis of the whole data, where the
//! small systems are well conditioned whatever the design is, and for the residuals
//! of the whole fit, so that a resample yields its own small correction:
//!
//! `β* = β̂ + R⁻¹ (QᵀWQ)⁻¹ QᵀW e`, with `X = Q·R`, `e = y − X β̂`, `W` the counts.
//!
//! **Exact.** Counts come from independent uniform draws of rows (multinomial), not
//! from a Poisson approximation. **Seeded.** Each resample has a generator of its
//! own, so the result depends on the seed alone, not on how many threads there are.
//!
//! With [`cluster_pairs`] whole clusters are drawn in place of rows.
//!
//! Not here: bias-corrected intervals (BCa), and the wild cluster bootstrap, which
//! keeps the design and is better where clusters are few: [`wild`](crate::wild).
//!
//! # Source
//!
//! Efron & Tibshirani (1993), *An Introduction to the Bootstrap*, section 9.5
//! (bootstrapping pairs) and chapter 13 (percentile interval).

mod kernel;
#[cfg(test)]
mod tests;

use faer::Mat;
use rayon::prelude::*;

use crate::stream::{Accumulator, Factor, Shape, StreamError};
use kernel::{BATCH, Sums, Table};

/// How to resample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Resampling {
    /// How many resamples.
    pub resamples: usize,
    /// Seed: the same seed gives the same resamples.
    pub seed: u64,
}

impl Default for Resampling {
    fn default() -> Self {
        Self { resamples: 10_000, seed: 1 }
    }
}

/// Why a bootstrap could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BootstrapError {
    /// The data themselves cannot be fitted.
    #[error(transparent)]
    Fit(#[from] StreamError),

    /// Weights or clusters in another number than rows.
    #[error("{found} {what} are given for {expected} rows; give one for each row")]
    Length {
        /// Weights or clusters.
        what: &'static str,
        /// How many were given.
        found: usize,
        /// How many rows there are.
        expected: usize,
    },

    /// A weight is not a positive number.
    #[error("weight of row {row} is {weight}; a weight is positive and finite")]
    Weight {
        /// The row.
        row: usize,
        /// Its weight.
        weight: f64,
    },

    /// Too few resamples to say anything.
    #[error("{found} of {asked} resamples determine the coefficients; at least 2 are needed")]
    TooFewResamples {
        /// How many determine the coefficients.
        found: usize,
        /// How many were asked for.
        asked: usize,
    },

    /// More rows to draw from than the generator's 32 bits can name.
    #[error("{rows} rows or clusters are more than 2^32; thin them, or bootstrap clusters")]
    TooManyRows {
        /// How many there are.
        rows: usize,
    },

    /// Not a probability.
    #[error("confidence is {confidence}; it must lie between 0 and 1, such as 0.95")]
    Confidence {
        /// What was given.
        confidence: f64,
    },
}

/// Coefficients of every resample.
#[derive(Debug, Clone)]
pub struct Bootstrap {
    /// Least-squares coefficients of the data themselves.
    pub estimate: Vec<f64>,
    /// A row per resample, a column per coefficient.
    ///
    /// Resamples that do not determine the coefficients are left out.
    pub coefficients: Mat<f64>,
    /// How many resamples were left out: where it is not 0, the data hang by few rows,
    /// and the spread below is too small.
    pub undetermined: usize,
}

impl Bootstrap {
    /// Standard deviation of each coefficient over the resamples.
    #[must_use]
    pub fn standard(&self) -> Vec<f64> {
        let n = self.coefficients.nrows() as f64;
        self.coefficients
            .col_iter()
            .map(|column| {
                let mean = column.iter().sum::<f64>() / n;
                let squares: f64 = column.iter().map(|value| (value - mean).powi(2)).sum();
                (squares / (n - 1.0)).sqrt()
            })
            .collect()
    }

    /// Percentile interval of each coefficient.
    ///
    /// The ends are the `(1 ∓ confidence)/2` quantiles of the resamples, linear between
    /// neighbours (type 7 of Hyndman & Fan 1996).
    ///
    /// # Errors
    ///
    /// [`BootstrapError::Confidence`] when it is not between 0 and 1.
    pub fn interval(&self, confidence: f64) -> Result<Vec<[f64; 2]>, BootstrapError> {
        if !(confidence > 0.0 && confidence < 1.0) {
            return Err(BootstrapError::Confidence { confidence });
        }
        let tail = 0.5 * (1.0 - confidence);
        Ok(self
            .coefficients
            .col_iter()
            .map(|column| {
                let mut values: Vec<f64> = column.iter().copied().collect();
                [quantile(&mut values, tail), quantile(&mut values, 1.0 - tail)]
            })
            .collect())
    }
}

/// Quantile of values, which it puts in another order.
fn quantile(values: &mut [f64], probability: f64) -> f64 {
    let place = probability * (values.len() - 1) as f64;
    let (below, part) = (place.floor() as usize, place.fract());
    let (_, &mut low, above) = values.select_nth_unstable_by(below, f64::total_cmp);
    let high = above.iter().copied().fold(f64::INFINITY, f64::min);
    if part == 0.0 || above.is_empty() { low } else { low + part * (high - low) }
}

/// Resamples rows of `(regressors, response)`.
///
/// `weight` is a relative 1/variance per row; a row keeps its weight when drawn.
///
/// # Errors
///
/// [`BootstrapError`]: see its variants.
///
/// # Example
///
/// ```
/// # use froude_fit::bootstrap::{pairs, Resampling};
/// let u: Vec<f64> = (1..=40).map(|i| 0.05 * f64::from(i)).collect();
/// let quadratic: Vec<f64> = u.iter().map(|u| u * u).collect();
/// let force: Vec<f64> = (1..=40).zip(&quadratic).map(|(i, q)| 3.0 * q + f64::from(i % 5) - 2.0).collect();
/// let result = pairs(&[&quadratic], &force, None, Resampling { resamples: 2000, seed: 7 })?;
/// let [low, high] = result.interval(0.95)?[0];
/// assert!(low < 3.0 && 3.0 < high);
/// # Ok::<(), froude_fit::bootstrap::BootstrapError>(())
/// ```
pub fn pairs(
    regressors: &[&[f64]],
    response: &[f64],
    weight: Option<&[f64]>,
    options: Resampling,
) -> Result<Bootstrap, BootstrapError> {
    let whole = Whole::new(regressors, response, weight)?;
    whole.resample(&whole.products(whole.rows, |row| row), options)
}

/// Resamples whole clusters of rows: as many clusters as there are, with replacement.
///
/// `cluster` names each row's cluster; the numbers need not be contiguous. A cluster
/// drawn twice counts twice. With fewer than some twenty clusters the spread is too
/// small; see [`wild`](crate::wild).
///
/// # Errors
///
/// [`BootstrapError`]: see its variants.
pub fn cluster_pairs(
    regressors: &[&[f64]],
    response: &[f64],
    weight: Option<&[f64]>,
    cluster: &[usize],
    options: Resampling,
) -> Result<Bootstrap, BootstrapError> {
    let whole = Whole::new(regressors, response, weight)?;
    if cluster.len() != whole.rows {
        return Err(BootstrapError::Length { what: "clusters", found: cluster.len(), expected: whole.rows });
    }
    let mut names = cluster.to_vec();
    names.sort_unstable();
    names.dedup();
    let place: Vec<usize> = cluster.iter().map(|name| names.partition_point(|other| other < name)).collect();
    whole.resample(&whole.products(names.len(), |row| place[row]), options)
}

/// The fit of all rows, and each row in the orthonormal basis.
struct Whole {
    rows: usize,
    estimate: Vec<f64>,
    factor: Factor,
    /// `n × (p + 1)`, row-major: a row of `Q`, then the residual.
    basis: Vec<f64>,
}

impl Whole {
    fn new(regressors: &[&[f64]], response: &[f64], weight: Option<&[f64]>) -> Result<Self, BootstrapError> {
        let (p, rows) = (regressors.len(), response.len());
        let mut columns: Vec<Vec<f64>> = regressors.iter().map(|column| column.to_vec()).collect();
        columns.push(response.to_vec());
        if let Some(weight) = weight {
            if weight.len() != rows {
                return Err(BootstrapError::Length { what: "weights", found: weight.len(), expected: rows });
            }
            let bad = weight.iter().position(|w| !(w.is_finite() && *w > 0.0));
            if let Some(row) = bad {
                return Err(BootstrapError::Weight { row, weight: weight[row] });
            }
            for column in &mut columns {
                for (value, weight) in column.iter_mut().zip(weight) {
                    *value *= weight.sqrt();
                }
            }
        }
        let mut rows_in = Accumulator::new(Shape { regressors: p, responses: 1 });
        let slices: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        rows_in.push(&slices[..p], &slices[p..])?;
        let factor = rows_in.finish();
        let estimate = factor.solve(0)?.coefficients;
        let mut basis = Vec::with_capacity(rows * (p + 1));
        for i in 0..rows {
            let (start, y) = (basis.len(), slices[p][i]);
            let mut residual = y;
            // q·R = x, by substitution.
            for (j, column) in slices[..p].iter().enumerate() {
                let known: f64 = (0..j).map(|l| basis[start + l] * factor.entry(l, j)).sum();
                basis.push((column[i] - known) / factor.entry(j, j));
                residual -= column[i] * estimate[j];
            }
            basis.push(residual);
        }
        Ok(Self { rows, estimate, factor, basis })
    }

    /// Products of the columns of each row, summed by unit of drawing.
    fn products(&self, units: usize, unit_of: impl Fn(usize) -> usize) -> Table {
        let p = self.estimate.len();
        let mut table = Table::new(units, p);
        for (row, basis) in self.basis.chunks_exact(p + 1).enumerate() {
            table.add(unit_of(row), basis);
        }
        table
    }

    fn resample(&self, table: &Table, options: Resampling) -> Result<Bootstrap, BootstrapError> {
        let p = self.estimate.len();
        let Ok(units) = u32::try_from(table.units()) else {
            return Err(BootstrapError::TooManyRows { rows: table.units() });
        };
        let mut all = vec![0.0; options.resamples * p];
        all.par_chunks_mut(BATCH * p).enumerate().for_each_init(
            || Sums::new(table),
            |sums, (batch, out)| {
                sums.draw(units, options.seed, (batch * BATCH) as u64);
                sums.solve(table, &self.factor, &self.estimate, out);
            },
        );
        let good: Vec<&[f64]> =
            (all.chunks_exact(p)).filter(|resample| resample.iter().all(|value| value.is_finite())).collect();
        if good.len() < 2 {
            return Err(BootstrapError::TooFewResamples { found: good.len(), asked: options.resamples });
        }
        Ok(Bootstrap {
            estimate: self.estimate.clone(),
            coefficients: Mat::from_fn(good.len(), p, |i, j| good[i][j]),
            undetermined: options.resamples - good.len(),
        })
    }
}
