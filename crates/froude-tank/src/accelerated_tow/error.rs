//! Why a run gives no rows of an accelerated tow.

/// Why a run gives no rows; each message states what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AcceleratedError {
    /// Too few samples in a window.
    #[error(
        "run {run:?}: a window of {window_s} s holds {found:.1} samples, and 8 are needed; log faster, or write a longer window in [source.accelerated_tow]"
    )]
    Window {
        /// The run.
        run: String,
        /// Its length, s.
        window_s: f64,
        /// Samples in it.
        found: f64,
    },

    /// It does not move, or not enough of it.
    #[error(
        "run {run:?}: {found} windows of {window_s} s show motion, and {needed} are needed; a run at rest has the role \"still\", and a short one wants a shorter window"
    )]
    NoMotion {
        /// The run.
        run: String,
        /// Windows that move.
        found: usize,
        /// Windows needed.
        needed: usize,
        /// Length of one, s.
        window_s: f64,
    },

    /// Nothing to take the zero of the cell from.
    #[error(
        "run {run:?}: the zero of the cell is unknown: the body stands still for {before_s:.2} s before and {after_s:.2} s after the tow, and {needed_s:.2} s are needed once; \
         log while it stands still"
    )]
    NoZero {
        /// The run.
        run: String,
        /// At rest before, s.
        before_s: f64,
        /// And after, s.
        after_s: f64,
        /// What is needed, s.
        needed_s: f64,
    },

    /// It never accelerates enough for its noise.
    #[error(
        "run {run:?}: its acceleration ({rms:.2e} m/s² in the mean square) is not above its noise ({noise:.2e} m/s²); accelerate harder, or write a longer window in \
         [source.accelerated_tow]"
    )]
    NoAcceleration {
        /// The run.
        run: String,
        /// Root mean square over the moving windows, m/s².
        rms: f64,
        /// The same at rest, m/s².
        noise: f64,
    },

    /// The force stands at the end of its range.
    #[error(
        "run {run:?}: force stands at {value} N in {part:.0} % of its moving part: the cell is clipped; widen its range, or accelerate less"
    )]
    Clipped {
        /// The run.
        run: String,
        /// The reading, N.
        value: f64,
        /// Part of the moving samples, %.
        part: f64,
    },

    /// A drag law that has no formula.
    #[error(
        "the law {law} is not written as a formula of the load along {axis}; an accelerated tow takes quadratic, linear_quadratic, or a law of [[identify.model]]"
    )]
    Law {
        /// Its name.
        law: String,
        /// The axis.
        axis: String,
    },
}
