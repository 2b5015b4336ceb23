//! Prediction of a declared range from the rest.

use super::{ComponentScore, Score, predicting, training};
use crate::error::FitError;
use crate::linear::fit;
use crate::options::Options;
use crate::outcome::Fit;
use crate::problem::{Problem, size};

/// How well the rows outside the training range are predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockScore {
    /// Root mean square error, unit of the response.
    pub rmse: f64,
    /// The row predicted worst.
    pub worst_row: usize,
    /// Measured less predicted there.
    pub worst_error: f64,
    /// Its error as part of the measured value; infinite where that is zero.
    pub worst_relative: f64,
    /// Rows trained on.
    pub n_train: usize,
    /// Rows predicted.
    pub n_test: usize,
}

/// A fit to one range, and its prediction of the rest.
#[derive(Debug, Clone)]
pub struct RangeBlock {
    /// One per component.
    pub scores: Vec<ComponentScore<BlockScore>>,
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
/// As [`fit`]; [`FitError::Size`] when `train` has not an entry per row;
/// [`FitError::NoRows`] when it is false everywhere.
pub fn range_block(problem: &Problem, options: &Options, train: &[bool]) -> Result<RangeBlock, FitError> {
    problem.check()?;
    options.check(problem)?;
    let n = problem.n_rows();
    size("train", train.len(), n, "one per row of the design")?;
    let rows: Vec<usize> = (0..n).filter(|&i| train[i]).collect();
    let refit = fit(&training(problem, &rows), &predicting(options))?;
    let predicted: Vec<Option<f64>> =
        (0..n).map(|i| refit.predict(&crate::dense::row(problem.design.as_ref(), i)).map(|p| p.value)).collect();
    let scores = problem
        .components
        .iter()
        .enumerate()
        .map(|(c, name)| {
            let (inside, test): (Vec<usize>, Vec<usize>) = problem.rows_of(c).into_iter().partition(|&i| train[i]);
            let n_train = inside.len();
            ComponentScore { component: name.clone(), score: score(problem, &predicted, n_train, &test) }
        })
        .collect();
    Ok(RangeBlock { scores, refit, predicted })
}

fn score(problem: &Problem, predicted: &[Option<f64>], n_train: usize, test: &[usize]) -> Score<BlockScore> {
    let not = |reason: &str| Score::NotScorable { reason: reason.to_owned() };
    if n_train == 0 {
        return not("no row lies inside the training range");
    }
    if test.is_empty() {
        return not("no row lies outside the training range");
    }
    let mut sum = 0.0;
    let mut worst = (test[0], 0.0_f64);
    for &i in test {
        let Some(predicted) = predicted[i] else {
            return not("the training range does not determine the prediction outside it");
        };
        let error = problem.response[i] - predicted;
        sum += error * error;
        if error.abs() > worst.1.abs() {
            worst = (i, error);
        }
    }
    Score::Scored(BlockScore {
        rmse: (sum / test.len() as f64).sqrt(),
        worst_row: worst.0,
        worst_error: worst.1,
        worst_relative: if worst.1 == 0.0 { 0.0 } else { (worst.1 / problem.response[worst.0]).abs() },
        n_train,
        n_test: test.len(),
    })
}
