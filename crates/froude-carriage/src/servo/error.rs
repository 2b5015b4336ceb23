//! Why an axis could not be identified.

use froude_fit::nonlinear::NonlinearError;
use froude_fit::stream::StreamError;
use froude_records::number::plain;
use froude_signal::SignalError;

/// Why an axis could not be identified; each message states what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ServoError {
    /// A column of another length than the time.
    #[error("{column} has {found} samples, time has {expected}; give one of each per sample")]
    Length {
        /// The column.
        column: &'static str,
        /// Its length.
        found: usize,
        /// Length of the time.
        expected: usize,
    },

    /// Samples that are not equidistant.
    #[error(
        "the step after {} s is {} ms where the mean is {} ms; resample the record or cut it at the gap",
        plain(*time_s, 6),
        plain(1e3 * step_s, 5),
        plain(1e3 * mean_s, 5)
    )]
    Uneven {
        /// Before the step.
        time_s: f64,
        /// The step.
        step_s: f64,
        /// Mean step.
        mean_s: f64,
    },

    /// Too little is left to fit.
    #[error(
        "{} left after decimation and trimming, {needed} are needed; record longer or decimate less",
        froude_records::text::counted(*rows, "row is", "rows are")
    )]
    TooFewRows {
        /// Rows left.
        rows: usize,
        /// Rows needed.
        needed: usize,
    },

    /// A motion that is all rest and reversal.
    #[error(
        "only {rows} rows are away from rest and reversal, but {needed} are needed: the axis hardly moves or reverses too often; record a longer or slower motion"
    )]
    AtRest {
        /// Rows that move.
        rows: usize,
        /// Rows that are needed.
        needed: usize,
    },

    /// A setting that cannot be.
    #[error("{what} is {found}; {must}")]
    Setting {
        /// Which setting.
        what: &'static str,
        /// What was given.
        found: f64,
        /// What it must be.
        must: &'static str,
    },

    /// The simulation ran away: the parameters are far off, or the loop is not the one that was recorded.
    #[error("the simulated axis diverges at {time_s} s; check the loop's gains and the starting values")]
    RanAway {
        /// When.
        time_s: f64,
    },

    /// A run, or a stretch of a record, that decides something alone: nothing tells its error.
    #[error("run or stretch {} alone determines a coefficient, so its scatter cannot be estimated; record more like it", cluster + 1)]
    Alone {
        /// Which, from 0.
        cluster: usize,
    },

    /// Columns of the fit that are combinations of each other.
    #[error("the record does not distinguish the coefficients; use more excitation, or fit fewer")]
    Dependent,

    /// A filter refused.
    #[error(transparent)]
    Signal(#[from] SignalError),

    /// The fit refused.
    #[error(transparent)]
    Fit(#[from] StreamError),

    /// The search refused.
    #[error(transparent)]
    Search(#[from] NonlinearError),
}
