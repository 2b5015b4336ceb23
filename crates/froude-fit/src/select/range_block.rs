//! Prediction of a declared range from the rest.

use super::{predicting, training};
use crate::error::FitError;
use crate::linear::fit;
use crate::options::Options;
use crate::outcome::Fit;
use crate::problem::{Problem, size};

/// A fit to one range, and its prediction of the rest.
#[derive(Debug, Clone)]
pub struct RangeBlock {
    /// The fit to the training rows: its coefficients, beside those of the
    /// full fit, show which ones the range decides.
    pub refit: Fit,
    /// Prediction of every row, `None` where the training rows do not determine it.
    pub predicted: Vec<Option<f64>>,
}

/// Fits the rows where `train` is true and predicts the others.
///
/// # Errors
///
/// As [`fit`]; [`FitError::Refused`] when `train` has not an entry per row;
/// [`FitError::NoRows`] when it is false everywhere.
pub fn range_block(problem: &Problem, options: &Options, train: &[bool]) -> Result<RangeBlock, FitError> {
    problem.check()?;
    options.check(problem)?;
    let n = problem.n_rows();
    size("train", train.len(), n, "one per row of the design")?;
    let rows: Vec<usize> = (0..n).filter(|&i| train[i]).collect();
    let refit = fit(&training(problem, &rows), &predicting(options))?;
    let predicted: Vec<Option<f64>> =
        (0..n).map(|i| refit.predict(&crate::dense::row(problem.design.as_ref(), i))).collect();
    Ok(RangeBlock { refit, predicted })
}
