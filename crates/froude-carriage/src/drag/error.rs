//! Why runs of a carriage give no drag.

/// Why runs of a carriage give no drag; each message states what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DragError {
    /// Columns of a run differ in length.
    #[error("run {run:?}: {column} has {found} samples where time has {expected}")]
    Length {
        /// The run.
        run: String,
        /// The column.
        column: &'static str,
        /// Its length.
        found: usize,
        /// Length of the time column.
        expected: usize,
    },

    /// A sample is NaN or infinite.
    #[error("run {run:?}: {column} at sample {index} is not finite")]
    NotFinite {
        /// The run.
        run: String,
        /// The column.
        column: &'static str,
        /// Index from 0.
        index: usize,
    },

    /// A declared number that cannot be.
    #[error("{what} is {value}; it must be {must}")]
    Declared {
        /// What was declared.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },

    /// No wet tow among the runs.
    #[error(
        "no wet run among {}: drag needs tows with the body in the water",
        froude_records::text::counted(*n, "run", "runs")
    )]
    NoWetRuns {
        /// Runs given.
        n: usize,
    },

    /// A calibration without what it needs.
    #[error("calibration: {0}")]
    Calibration(String),
}
