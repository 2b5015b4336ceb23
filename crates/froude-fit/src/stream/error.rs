//! Why rows could not be reduced.

use super::Shape;

/// Why rows could not be reduced, or a factor not be solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StreamError {
    /// Columns were given in another number than the shape says.
    #[error("{found} {what} were given where the shape says {expected}")]
    Shape {
        /// Regressors, responses or columns.
        what: &'static str,
        /// How many were given.
        found: usize,
        /// How many are needed.
        expected: usize,
    },

    /// Columns of one chunk differ in length.
    #[error("column {column} has {found} rows, column 0 has {expected}; give equal lengths")]
    Length {
        /// Index of the column, regressors first, then responses.
        column: usize,
        /// Its length.
        found: usize,
        /// The length of the first column.
        expected: usize,
    },

    /// An entry is NaN or infinite, or so large that its square is.
    #[error(
        "row {row}, column {column} is {value}; every entry must be finite and below 1e150 \
         in size"
    )]
    NotFinite {
        /// Row, from 0 in the order given.
        row: u64,
        /// Index of the column, regressors first, then responses.
        column: usize,
        /// The entry.
        value: f64,
    },

    /// There are not more rows than coefficients.
    #[error("{rows} rows do not determine {regressors} coefficients and their scatter")]
    TooFewRows {
        /// Rows given.
        rows: u64,
        /// Coefficients asked for.
        regressors: usize,
    },

    /// The regressors are parallel to working precision.
    #[error(
        "the data do not determine coefficient {column}: its regressor is a combination of \
         the others (condition number {condition_number:.1e}); leave one out, or add data \
         that excite it"
    )]
    Undetermined {
        /// The regressor with the largest part in the combination.
        column: usize,
        /// Condition number of the design, columns scaled to equal length.
        condition_number: f64,
    },

    /// No such response.
    #[error("response {response} is asked for, but there are {responses}")]
    NoSuchResponse {
        /// The one asked for.
        response: usize,
        /// How many there are.
        responses: usize,
    },

    /// Factors of different shapes cannot be merged.
    #[error("a factor of shape {found:?} cannot be merged into one of {expected:?}")]
    Merge {
        /// Shape of the one to be merged.
        found: Shape,
        /// Shape of the other.
        expected: Shape,
    },

    /// More clusters than memory was granted for.
    #[error(
        "cluster {cluster} is one more than the limit of {limit}: each keeps a triangle of its \
         own; raise the limit, or use longer clusters"
    )]
    TooManyClusters {
        /// The cluster that found no room.
        cluster: u64,
        /// The limit.
        limit: usize,
    },
}
