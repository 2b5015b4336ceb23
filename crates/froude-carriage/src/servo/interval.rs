//! Intervals for rows whose residuals are not independent.
//!
//! | measure   | holds when                                    | how                                                          |
//! |-----------|-----------------------------------------------|--------------------------------------------------------------|
//! | classical | residuals are white                           | `σ²(XᵀX)⁻¹`                                                   |
//! | HAC       | correlation dies out within the lag           | Bartlett weights over an automatic lag, five correlation times or longer |
//! | blocks    | it dies out within a block                    | moving blocks of neighbours, 1 s or longer, drawn and refitted |
//!
//! | clusters  | runs, or stretches of a record, are independent | CR3 or CR2, with the degrees of freedom of each coefficient   |
//!
//! Several runs of a campaign are clusters: friction and force per volt change between them, which no block within a run shows. The
//! interval that is reported of a single record is that of the blocks, with Student's t for as many degrees of freedom as blocks
//! lie side by side less the coefficients: twenty blocks are twenty pieces of evidence, however many rows they have. Whether
//! residuals are white is judged by their first autocorrelation and by Ljung and Box's test over 25 lags.
//!
//! What neither sees: a model error that is the same in every period moves the estimate and not the interval.

use froude_fit::autocorrelation::{autocorrelation, integrated_time};
use froude_fit::diagnostics::ljung_box;
use froude_fit::faer::Mat;
use froude_fit::long_run::{self, automatic_lag};
use froude_fit::stream::Solution;
use froude_records::number::significant;
use froude_signal::blocks::MovingBlocks;
use rayon::prelude::*;

use crate::servo::chain::Chain;
use crate::servo::cluster::{Clustered, Enlarged};
use crate::servo::error::ServoError;
use crate::servo::regression::{inverse_gram, solve};
use crate::servo::rows::Rows;

/// Lags of the whiteness test.
const LAGS: usize = 25;

/// Length of a block, s: shorter ones do not contain the correlation of a servo.
pub(crate) const BLOCK_S: f64 = 1.0;

/// Fewest and most stretches of a record of simulated speeds: a disturbance lasts as long as the motion, beneath a noise that hides how long.
const STRETCHES: [f64; 2] = [8.0, 20.0];

/// Probability of the intervals.
pub(crate) const CONFIDENCE: f64 = 0.95;

/// How many resamples of blocks, and their seed.
const RESAMPLES: u64 = 2000;
const SEED: u64 = 1;

/// Whether residuals are white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Whiteness {
    /// First autocorrelation.
    pub r1: f64,
    /// Ljung–Box statistic over [`Whiteness::lags`] lags.
    pub ljung_box: f64,
    /// Its probability for white residuals.
    pub p: f64,
    /// Lags of the test.
    pub lags: usize,
    /// Integrated autocorrelation time, s; `None` where the record is too short to tell.
    pub correlation_time_s: Option<f64>,
}

impl Whiteness {
    /// Whether the classical standard deviations may be believed, at one in a hundred.
    #[must_use]
    pub fn is_white(&self) -> bool {
        self.p > 0.01
    }
}

/// Tests residuals at a rate; `None` for too few, or none that differ from zero.
#[must_use]
pub fn whiteness(residuals: &[f64], rate_hz: f64) -> Option<Whiteness> {
    let r1 = autocorrelation(residuals, 1)?[1];
    let (statistic, p) = ljung_box(residuals, LAGS)?;
    let correlation_time_s = integrated_time(residuals).map(|t| t / rate_hz);
    Some(Whiteness { r1, ljung_box: statistic, p, lags: LAGS, correlation_time_s })
}

/// How far the coefficients scatter.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// Standard deviations by HAC.
    pub hac: Vec<f64>,
    /// Lag of HAC, s.
    pub hac_lag_s: f64,
    /// Length of a block, s.
    pub block_s: f64,
    /// Runs whose scatter stands in the place of the blocks'; `None` for a single record.
    pub runs: Option<usize>,
    /// What was taken as one piece of evidence, in words.
    pub pieces: String,
    /// Degrees of freedom of each interval: blocks side by side less coefficients, or those of the clusters' variance.
    pub dof: Vec<f64>,
    /// Covariance over the blocks' resamples, or over the runs.
    pub covariance: Mat<f64>,
}

/// Scatter of a least-squares solution of `rows`.
///
/// # Errors
///
/// [`ServoError::TooFewRows`] where the record has too few blocks.
pub fn spread(rows: &Rows, solution: &Solution, chain: &Chain) -> Result<Spread, ServoError> {
    let residuals = rows.residuals_n(&solution.coefficients);
    if chain.is_simulated {
        return over_stretches(rows, solution, &residuals);
    }
    let refit = |chosen: &[usize]| {
        let pick = |column: &[f64]| chosen.iter().map(|&i| column[i]).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = rows.columns.iter().map(|c| pick(c)).collect();
        solve(&columns, &pick(&rows.force_n)).ok().map(|s| s.coefficients)
    };
    let (hac, hac_lag_s) = hac(&rows.columns, &residuals, &inverse_gram(solution), rows.rate_hz, chain.hac_lag_s);
    let over = over_blocks(residuals.len(), rows.rate_hz, solution.coefficients.len(), refit)?;
    let dof = vec![over.dof; solution.coefficients.len()];
    let pieces = format!("blocks of {:.1} s", over.block_s);
    Ok(Spread { hac, hac_lag_s, block_s: over.block_s, runs: None, pieces, dof, covariance: over.covariance })
}

/// As [`spread`], the runs (ranges of rows) being the clusters.
pub(crate) fn over_runs(
    rows: &Rows,
    solution: &Solution,
    runs: &[std::ops::Range<usize>],
    hac_lag_s: Option<f64>,
) -> Result<Spread, ServoError> {
    let residuals = rows.residuals_n(&solution.coefficients);
    let (hac, hac_lag_s) = hac(&rows.columns, &residuals, &inverse_gram(solution), rows.rate_hz, hac_lag_s);
    let clustered = Clustered::new(&rows.columns, &residuals, runs, None, Enlarged::Jackknife)?;
    let p = solution.coefficients.len();
    let of_one = |j: usize| clustered.dof(&(0..p).map(|k| f64::from(u8::from(k == j))).collect::<Vec<f64>>());
    let dof = (0..p).map(of_one).collect();
    let pieces = format!("{} clusters, one per run", runs.len());
    let covariance = clustered.covariance;
    Ok(Spread { hac, hac_lag_s, block_s: BLOCK_S, runs: Some(runs.len()), pieces, dof, covariance })
}

/// As [`spread`], stretches of the record being the clusters: twenty, or fewer that hold five correlation times each.
fn over_stretches(rows: &Rows, solution: &Solution, residuals: &[f64]) -> Result<Spread, ServoError> {
    let n = residuals.len();
    let [fewest, most] = STRETCHES;
    let times = integrated_time(residuals).unwrap_or(f64::INFINITY);
    let count = (n as f64 / (TIMES_IN_LAG * times)).clamp(fewest, most) as usize;
    let ranges: Vec<_> = (0..count).map(|k| k * n / count..(k + 1) * n / count).collect();
    let block_s = (n / count) as f64 / rows.rate_hz;
    let pieces = format!("{count} stretches of {} s", significant(block_s, 2));
    Ok(Spread { runs: None, pieces, block_s, ..over_runs(rows, solution, &ranges, None)? })
}

/// HAC standard deviations, and the lag used, s.
pub(crate) fn hac(
    columns: &[Vec<f64>],
    residuals: &[f64],
    inverse_gram: &Mat<f64>,
    rate_hz: f64,
    lag_s: Option<f64>,
) -> (Vec<f64>, f64) {
    let (covariance, lag_s) = hac_covariance(columns, residuals, inverse_gram, rate_hz, lag_s);
    (diagonal_roots(&covariance), lag_s)
}

/// HAC covariance, and the lag used, s.
pub(crate) fn hac_covariance(
    columns: &[Vec<f64>],
    residuals: &[f64],
    inverse_gram: &Mat<f64>,
    rate_hz: f64,
    lag_s: Option<f64>,
) -> (Mat<f64>, f64) {
    let scores: Vec<Vec<f64>> = columns.iter().map(|c| c.iter().zip(residuals).map(|(x, r)| x * r).collect()).collect();
    let scores: Vec<&[f64]> = scores.iter().map(Vec::as_slice).collect();
    let lag = lag_s.map_or_else(|| long_enough(&scores, residuals), |s| (s * rate_hz).round() as usize);
    (long_run::hac(&scores, inverse_gram, lag), lag as f64 / rate_hz)
}

/// Covariance of an estimator over moving blocks.
pub(crate) struct OverBlocks {
    pub covariance: Mat<f64>,
    pub block_s: f64,
    pub dof: f64,
}

/// Draws blocks of rows and estimates again; `refit` gets the rows and may fail on some.
pub(crate) fn over_blocks(
    rows: usize,
    rate_hz: f64,
    p: usize,
    refit: impl Fn(&[usize]) -> Option<Vec<f64>> + Sync,
) -> Result<OverBlocks, ServoError> {
    let block = (BLOCK_S * rate_hz).ceil() as usize;
    let needed = block * (p + 2);
    if rows < needed {
        return Err(ServoError::TooFewRows { rows, needed });
    }
    let blocks = MovingBlocks::new(rows, block, SEED)?;
    let draws: Vec<Vec<f64>> = (0..RESAMPLES).into_par_iter().filter_map(|k| refit(&blocks.resample(k))).collect();
    let n = draws.len() as f64;
    let mean: Vec<f64> = (0..p).map(|j| draws.iter().map(|d| d[j]).sum::<f64>() / n).collect();
    let covariance =
        Mat::from_fn(p, p, |i, j| draws.iter().map(|d| (d[i] - mean[i]) * (d[j] - mean[j])).sum::<f64>() / (n - 1.0));
    Ok(OverBlocks { covariance, block_s: block as f64 / rate_hz, dof: (blocks.count() - p) as f64 })
}

/// Correlation times of the residuals that the lag of HAC holds: beyond five of them Sokal's window is closed.
const TIMES_IN_LAG: f64 = 5.0;

/// The lag of Newey and West, or five correlation times of the residuals, whichever is longer.
///
/// Their rule looks at a first dozen lags only, too few where a servo's residuals repeat from move to move. A lag too
/// long costs scatter, a lag too short gives intervals too narrow.
fn long_enough(scores: &[&[f64]], residuals: &[f64]) -> usize {
    let times = integrated_time(residuals).map_or(0, |t| (TIMES_IN_LAG * t).ceil() as usize);
    automatic_lag(scores).max(times).min(residuals.len() / 4)
}

pub(crate) fn diagonal_roots(m: &Mat<f64>) -> Vec<f64> {
    (0..m.nrows()).map(|j| m[(j, j)].clamp(0.0, f64::INFINITY).sqrt()).collect()
}
