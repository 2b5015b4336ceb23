//! The linear fits of this chapter, all by `froude-fit`.

use froude_fit::faer::Mat;
use froude_fit::stream::{Solution, reduce_columns};

use crate::servo::error::ServoError;
use crate::servo::rows::Rows;

/// Least squares of the force on the columns.
pub(crate) fn least_squares(rows: &Rows) -> Result<Solution, ServoError> {
    solve(&rows.columns, &rows.force_n)
}

/// Least squares of a response on columns.
pub(crate) fn solve(columns: &[Vec<f64>], response: &[f64]) -> Result<Solution, ServoError> {
    let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    Ok(reduce_columns(&columns, &[response])?.solve(0)?)
}

/// `(XᵀX)⁻¹` from a solution.
pub(crate) fn inverse_gram(solution: &Solution) -> Mat<f64> {
    let variance = solution.sigma * solution.sigma;
    let p = solution.coefficients.len();
    Mat::from_fn(p, p, |i, j| solution.covariance[(i, j)] / variance)
}
