//! Covariance of the shared parameters: of independent residuals, and with a lag.
//!
//! All of it is of the linearised model, in the coordinates `Qᵀ r` of the projected rows (see [`super::border`]): what is added up is one
//! score `q r` per row, or per pair of rows within a lag.

use faer::Mat;

use super::Solution;
use super::border::{Eliminated, eliminate};
use super::error::NonlinearError;
use crate::dense::{dot, mul, row};
use crate::determined::Indeterminacy;

/// What is known about the noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scatter {
    /// Residuals are independent and equally wide: `σ² (CᵀC)⁻¹`. Not true of a simulated time series.
    Independent,
    /// Residuals of a run are correlated over some rows: Bartlett's weights up to `lag` rows, `None` for the lag that an autoregression of the
    /// scores asks for. Newey & West (1987), Econometrica 55, 703; Andrews (1991), Econometrica 59, 817 (the lag); degrees of freedom
    /// 1.5 n/(lag + 1) of the window at frequency zero, Priestley (1981), 6.2, with `n` the rows that count for the parameter that rests on
    /// fewest, `(Σ w²)²/Σ w⁴` of their influences. For long runs.
    Serial {
        /// Largest distance of rows that are correlated.
        lag: Option<usize>,
    },
}

/// Covariance of the shared parameters; those at a bound are held there.
#[derive(Debug, Clone)]
pub struct SharedCovariance {
    /// The lag that was used, in rows.
    pub lag: Option<usize>,
    /// Degrees of freedom of Student's t.
    pub dof: f64,
    free: Vec<usize>,
    determined: Vec<bool>,
    matrix: Mat<f64>,
}

impl SharedCovariance {
    /// Covariance of two parameters, by their indices; `None` for a nuisance, for one at a bound, and for one that is not determined.
    #[must_use]
    pub fn covariance(&self, first: usize, second: usize) -> Option<f64> {
        let at = |index: usize| self.free.iter().position(|&j| j == index).filter(|&k| self.determined[k]);
        Some(self.matrix[(at(first)?, at(second)?)])
    }

    /// Standard uncertainty of a parameter, in its unit; `None` likewise.
    #[must_use]
    pub fn standard(&self, parameter: usize) -> Option<f64> {
        self.covariance(parameter, parameter).map(|variance| variance.max(0.0).sqrt())
    }
}

impl Solution {
    /// Covariance of the shared parameters, the runs' own eliminated.
    ///
    /// # Errors
    ///
    /// [`NonlinearError`] without degrees of freedom.
    pub fn covariance(&self, scatter: Scatter) -> Result<SharedCovariance, NonlinearError> {
        let rows: usize = self.residuals.iter().map(Vec::len).sum();
        let Some(sigma) = self.sigma() else {
            let rank = rows - self.dof;
            return Err(NonlinearError(format!(
                "{rows} residuals for {rank} determined parameters leave none to estimate the noise from; add data"
            )));
        };
        let linear = eliminate(&self.point(), &self.layout, |j| !self.at_bound[j], &self.residuals, None);
        let rank = linear.shared.qr.rank;
        let (core, dof, lag) = match scatter {
            Scatter::Independent => {
                (Mat::from_fn(rank, rank, |i, j| sigma * sigma * f64::from(u8::from(i == j))), self.dof as f64, None)
            }
            Scatter::Serial { lag } => {
                let scores: Vec<Vec<Vec<f64>>> = (0..linear.rows.len()).map(|run| linear.scores(run)).collect();
                let longest = scores.iter().map(Vec::len).max().unwrap_or(1);
                let lag = lag.unwrap_or_else(|| andrews_lag(&scores, rank)).min(longest - 1);
                let small_sample = rows as f64 / self.dof as f64;
                let core = bartlett(&scores, rank, lag, small_sample);
                (core, (1.5 * effective_rows(&linear) / (lag as f64 + 1.0)).min(self.dof as f64), Some(lag))
            }
        };
        let lift = linear.lift();
        let matrix = mul(mul(lift.as_ref(), core.as_ref()).as_ref(), lift.transpose());
        let determined = Indeterminacy::new(linear.shared.qr.null_space().as_ref()).determined;
        Ok(SharedCovariance { lag, dof, free: linear.free, determined, matrix })
    }
}

/// `Σ_runs Σ_|l| ≤ lag (1 − |l|/(lag+1)) Σ s_i s_{i−l}ᵀ`.
fn bartlett(scores: &[Vec<Vec<f64>>], rank: usize, lag: usize, factor: f64) -> Mat<f64> {
    let mut out = Mat::zeros(rank, rank);
    for run in scores {
        for distance in 0..=lag.min(run.len() - 1) {
            let weight = factor * (1.0 - distance as f64 / (lag as f64 + 1.0));
            for (late, early) in run[distance..].iter().zip(run) {
                add_outer(&mut out, late, early, weight);
                if distance > 0 {
                    add_outer(&mut out, early, late, weight);
                }
            }
        }
    }
    out
}

/// Andrews' lag for Bartlett's weights, from an autoregression of each rotated score: `1.1447 (α n)^⅓`, the longest.
fn andrews_lag(scores: &[Vec<Vec<f64>>], rank: usize) -> usize {
    let n: usize = scores.iter().map(Vec::len).sum();
    let of = |k: usize| {
        let moment = |distance: usize| -> f64 {
            scores.iter().flat_map(|run| run.windows(distance + 1)).map(|w| w[distance][k] * w[0][k]).sum()
        };
        let rho = (moment(1) / moment(0)).clamp(-0.99, 0.99);
        let alpha = 4.0 * rho * rho / ((1.0 - rho).powi(2) * (1.0 + rho).powi(2));
        1.1447 * (alpha * n as f64).cbrt()
    };
    (0..rank).map(of).fold(0.0, f64::max).ceil() as usize
}

/// Rows that count for the parameter that rests on fewest.
fn effective_rows(linear: &Eliminated) -> f64 {
    let lift = linear.lift();
    let of = |parameter: usize| {
        let lift = row(lift.as_ref(), parameter);
        let squares = (0..linear.rows.len()).flat_map(|run| linear.rotated(run)).map(|q| dot(&lift, &q).powi(2));
        let (sum, fourth) = squares.fold((0.0, 0.0), |(sum, fourth), s| (sum + s, fourth + s * s));
        if fourth > 0.0 { sum * sum / fourth } else { f64::INFINITY }
    };
    (0..linear.free.len()).map(of).fold(f64::INFINITY, f64::min)
}

fn add_outer(to: &mut Mat<f64>, x: &[f64], y: &[f64], factor: f64) {
    for j in 0..y.len() {
        for i in 0..x.len() {
            to[(i, j)] += factor * x[i] * y[j];
        }
    }
}
