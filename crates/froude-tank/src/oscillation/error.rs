//! Why a forced oscillation gives no coefficients.

use froude_fit::FitError;
use froude_identify::IdentifyError;
use froude_signal::SignalError;

/// Why a forced oscillation gives no coefficients; each message states what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OscillationError {
    /// Nothing was given.
    #[error("no run in water was given; a forced oscillation needs at least one")]
    NoRuns,

    /// Columns of a run differ in length.
    #[error("run {run:?}: {column} has {found} samples where time has {expected}")]
    Length {
        /// The run.
        run: String,
        /// The column.
        column: &'static str,
        /// Its samples.
        found: usize,
        /// Samples of time.
        expected: usize,
    },

    /// A declared number that cannot be.
    #[error("{what} is {value}; it must be {must}")]
    Declared {
        /// What was declared.
        what: String,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },

    /// The angle has no harmonics, or is no record.
    #[error("run {run:?}: the angle cannot be fitted by harmonics: {source}")]
    Angle {
        /// The run.
        run: String,
        /// Why.
        #[source]
        source: SignalError,
    },

    /// Too few whole cycles.
    #[error(
        "run {run:?} has {found} whole cycles of {period_s:.2} s after {skipped} of start-up; {fewest} are needed: record longer, or lower \
         cycles.fewest and read the intervals with care"
    )]
    TooFewCycles {
        /// The run.
        run: String,
        /// Whole cycles.
        found: usize,
        /// Their length.
        period_s: f64,
        /// Cycles left out.
        skipped: usize,
        /// Needed.
        fewest: usize,
    },

    /// Cycles that marks touch.
    #[error(
        "run {run:?}: of its {whole} whole cycles {left} are left without a mark, and {fewest} are needed: {marks}; repeat the run, or widen the sensor's range"
    )]
    Marked {
        /// The run.
        run: String,
        /// Whole cycles.
        whole: usize,
        /// Those left.
        left: usize,
        /// Needed.
        fewest: usize,
        /// The marks in words.
        marks: String,
    },

    /// The sensor was at the end of its range.
    #[error(
        "run {run:?}: {channel} stays at {value} {unit} for {samples} samples from {from_s:.2} s on, longer than a smooth motion does: it is clipped; \
         repeat the run with a larger range, or a smaller amplitude"
    )]
    Clipped {
        /// The run.
        run: String,
        /// The channel.
        channel: &'static str,
        /// Where it stays.
        value: f64,
        /// Unit of that.
        unit: &'static str,
        /// Samples in a row.
        samples: usize,
        /// Time of the first.
        from_s: f64,
    },

    /// A law that this method cannot use.
    #[error("model {model} {why}")]
    Law {
        /// Its name.
        model: String,
        /// Why.
        why: String,
    },

    /// A law that cannot be computed at the motion.
    #[error(transparent)]
    Identify(#[from] IdentifyError),

    /// The fit refused.
    #[error("the joint fit of {model}: {source}")]
    Fit {
        /// The drag law.
        model: String,
        /// Why.
        #[source]
        source: FitError,
    },

    /// The delay runs away.
    #[error(
        "the delay of the force does not converge (last value {delay_s:.3} s, period {period_s:.2} s): check that angle and force are of one clock and of the right sign, or declare the delay"
    )]
    Delay {
        /// The last one.
        delay_s: f64,
        /// The shortest period.
        period_s: f64,
    },
}
