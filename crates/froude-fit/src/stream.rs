//! Least squares of more rows than one wants to keep: one pass, bounded memory.
//!
//! Everything here is a triangle. A [`Factor`] is the upper triangle `R` of
//! `[X | Y] = Q·R`: it holds all that a least-squares fit needs of its rows, and
//! two factors merge into the factor of all their rows. Rows are folded in by
//! Householder reflections, a block at a time (tall-skinny QR); the products
//! `XᵀX` are never formed, so a design of condition number κ loses κ, not κ².
//!
//! **Setting.** `X` is `n × p` with `n ≫ p` (p to a few dozen), `Y` is `n × q`:
//! `q` responses of the same regressors. Weighted rows are scaled by the square
//! root of their weight before they come here.
//! **Order.** Sums are taken in blocks of rows fixed by row number, then merged in
//! order: the result is the same, bit for bit, however the rows are cut into
//! chunks and however many threads there are.
//!
//! | rows come | use |
//! | --- | --- |
//! | as columns in memory | [`reduce_columns`] |
//! | chunk after chunk | [`Accumulator`] |
//! | with a cluster each | [`ClusterAccumulator`] |
//!
//! Then [`Factor::solve`] gives coefficients, σ and classical covariance. A cluster's
//! triangle replaces its rows exactly, so that it is enough for CR3 too. HC3 and HAC
//! weigh each row by its final residual, hence need a second pass over the rows:
//! they are not here.
//!
//! # Accuracy
//!
//! Measured against a QR factorisation of the whole design (tests beside this
//! module): at κ from 1e1 to 1e7 the largest relative coefficient error stays
//! within 10 times that of `faer`'s Householder QR, most often below it.
//!
//! # Source
//!
//! Golub & Van Loan (2013), *Matrix Computations*, 4th ed., algorithm 5.2.1
//! (Householder QR); Demmel, Grigori, Hoemmen & Langou (2012), SIAM J. Sci. Comput.
//! 34, A206 (tall-skinny QR).
//!
//! # Example
//!
//! ```
//! # use froude_fit::stream::{Accumulator, Shape};
//! let mut rows = Accumulator::new(Shape { regressors: 2, responses: 1 });
//! for chunk in 0..10 {
//!     let u: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(100 * chunk + i)).collect();
//!     let quadratic: Vec<f64> = u.iter().map(|u| u * u.abs()).collect();
//!     let force: Vec<f64> = u.iter().map(|u| 3.0 * u + 0.5 * u * u.abs()).collect();
//!     rows.push(&[&u, &quadratic], &[&force])?;
//! }
//! let fit = rows.finish().solve(0)?;
//! assert!((fit.coefficients[1] - 0.5).abs() < 1e-12);
//! # Ok::<(), froude_fit::stream::StreamError>(())
//! ```

mod accumulator;
mod error;
mod factor;
mod folder;
mod in_memory;

use std::ops::Range;

use froude_lanes::LANES;
use kernel::groups_per_block;

pub use accumulator::Accumulator;
pub use cluster::ClusterAccumulator;
pub use error::StreamError;
pub use factor::{Factor, Solution};
pub use in_memory::reduce_columns;

mod cluster;
mod kernel;
#[cfg(test)]
mod reference;
#[cfg(test)]
mod tests;

/// Blocks in a segment: the unit that one thread factors on its own.
const BLOCKS_PER_SEGMENT: usize = 256;

/// How many columns there are of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Columns of the design, `p`.
    pub regressors: usize,
    /// Responses of the same regressors, `q`.
    pub responses: usize,
}

impl Shape {
    /// Regressors and responses together.
    #[must_use]
    pub fn width(self) -> usize {
        self.regressors + self.responses
    }

    /// Rows in a block.
    fn block_rows(self) -> usize {
        groups_per_block(self.width()) * LANES
    }

    /// Rows in a segment.
    fn segment_rows(self) -> usize {
        self.block_rows() * BLOCKS_PER_SEGMENT
    }
}

/// Checks a count against the shape.
fn check_count(what: &str, found: usize, expected: usize) -> Result<(), StreamError> {
    if found == expected {
        return Ok(());
    }
    Err(StreamError::Refused(format!("{found} {what} were given where the shape says {expected}")))
}

fn check_lengths(columns: &[&[f64]]) -> Result<usize, StreamError> {
    let expected = columns.first().map_or(0, |column| column.len());
    match columns.iter().position(|column| column.len() != expected) {
        None => Ok(expected),
        Some(column) => Err(StreamError::Refused(format!(
            "column {column} has {} rows, column 0 has {expected}; give equal lengths",
            columns[column].len()
        ))),
    }
}

/// The largest entry whose square, summed over any number of rows, stays finite.
const LARGEST: f64 = 1e150;

/// The first row of `rows` with a bad entry; `before` rows came earlier.
fn check_finite(columns: &[&[f64]], rows: Range<usize>, before: u64) -> Result<(), StreamError> {
    let good = |column: &&[f64]| {
        // Without an early exit, so that it runs in lanes.
        (column[rows.clone()].iter()).fold(true, |good, value| good & (value.abs() <= LARGEST))
    };
    if columns.iter().all(good) {
        return Ok(());
    }
    for row in rows {
        for (column, values) in columns.iter().enumerate() {
            let value = values[row];
            if value.is_nan() || value.abs() > LARGEST {
                return Err(StreamError::NotFinite { row: before + row as u64, column, value });
            }
        }
    }
    Ok(())
}
