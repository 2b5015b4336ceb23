//! Which model the data support.
//!
//! | question                                     | function                      |
//! |----------------------------------------------|-------------------------------|
//! | does the larger model earn its coefficients? | [`aicc`]                      |
//! | does it predict a group it has not seen?     | [`leave_one_group_out`]       |
//! | does it predict beyond the range it saw?     | [`range_block`]               |
//! | does it fit as well as the repeats allow?    | [`lack_of_fit`]               |
//!
//! A question that the data cannot answer has a reason instead of a number.

mod aicc;
mod group_out;
mod lack_of_fit;
mod range_block;

pub use aicc::{TooFewRows, aicc};
pub use group_out::leave_one_group_out;
pub use lack_of_fit::{LackOfFit, lack_of_fit};
pub use range_block::{RangeBlock, range_block};

use crate::options::{CovarianceKind, Options};
use crate::problem::Problem;

/// A score of one component.
#[derive(Debug, Clone, PartialEq)]
pub struct ComponentScore<T> {
    /// The component.
    pub component: String,
    /// Its score, or why there is none.
    pub score: Result<T, String>,
}

/// The rows to train on, as a problem without components that lost all rows.
fn training(problem: &Problem, rows: &[usize]) -> Problem {
    let observed: Vec<usize> = rows.iter().copied().filter(|&i| problem.weight_of(i) > 0.0).collect();
    let mut part = problem.rows(&observed);
    let kept: Vec<usize> = (0..problem.components.len()).filter(|c| part.component.contains(c)).collect();
    part.component = part.component.iter().filter_map(|c| kept.iter().position(|k| k == c)).collect();
    part.components = kept.iter().map(|&c| problem.components[c].clone()).collect();
    part
}

/// Options for a fit that only predicts.
fn predicting(options: &Options) -> Options {
    Options { covariance: CovarianceKind::Classical, ..options.clone() }
}
