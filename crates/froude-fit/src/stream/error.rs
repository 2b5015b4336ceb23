//! Why rows could not be reduced.

/// Why rows could not be reduced, or a factor not be solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StreamError {
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

    /// Anything else, in words.
    #[error("{0}")]
    Refused(String),
}
