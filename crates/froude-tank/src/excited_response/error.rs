//! Why runs in waves give no coefficients.

use froude_signal::SignalError;

/// Why runs in waves give no coefficients; each message states what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExcitedError {
    /// Nothing was given.
    #[error(
        "no run with the free body was given (role \"free\"); its motion and the force of a run with the held body give the coefficients"
    )]
    NoFree,

    /// The wavemaker does not run, or not for long.
    #[error(
        "run {run:?}: the wavemaker runs for {cycles:.1} cycles with an even stroke (start-up of {skipped} left out), and {fewest} are needed: check which column is the reference, or record longer"
    )]
    NoWave {
        /// The run.
        run: String,
        /// Cycles found.
        cycles: f64,
        /// Left out before.
        skipped: f64,
        /// Needed.
        fewest: usize,
    },

    /// A channel cannot be fitted.
    #[error("run {run:?}: the {channel} cannot be fitted by harmonics: {source}")]
    Channel {
        /// The run.
        run: String,
        /// Which.
        channel: &'static str,
        /// Why.
        #[source]
        source: SignalError,
    },

    /// Declared and found period differ.
    #[error(
        "run {run:?}: its wavemaker has a period of {found_s:.4} s, and [conditions] period says {declared_s} s; check the sidecar, or which log it belongs to"
    )]
    Period {
        /// The run.
        run: String,
        /// Of the reference, s.
        found_s: f64,
        /// Declared, s.
        declared_s: f64,
    },

    /// A free run without a held one of its wave.
    #[error(
        "run {run:?}: no run with the held body (role \"held\") has its wave of {period_s:.3} s; {there}: add the run in which the body is held in this wave, or leave this one out"
    )]
    NoHeld {
        /// The run.
        run: String,
        /// Its period, s.
        period_s: f64,
        /// The held runs that there are, in words.
        there: String,
    },

    /// The wavemaker of the held and of the free run move differently.
    #[error(
        "the wavemaker moves by {:.3} mm in run {free:?} and by {:.3} mm in run {held:?}, a ratio of {:.2}; force and motion can be scaled to one wave within {:.0} %, beyond that the response is not \
         known to be linear: repeat one of them",
        1e3 * .free_m, 1e3 * .held_m, .free_m / .held_m, 1e2 * .most
    )]
    OtherWave {
        /// The free run.
        free: String,
        /// The held run.
        held: String,
        /// Stroke in the free run.
        free_m: f64,
        /// Stroke in the held run.
        held_m: f64,
        /// Largest difference of the ratio from one.
        most: f64,
    },

    /// Free runs of one wave whose motion is measured differently.
    #[error(
        "run {run:?} shows the {other} of the body, and run {first:?}, of the same wave, its {shown}: the two have gains of their own; give each a [[source]]"
    )]
    Mixed {
        /// The run.
        run: String,
        /// What it shows.
        other: &'static str,
        /// Another of the same wave.
        first: String,
        /// What that shows.
        shown: &'static str,
    },

    /// A window outside the log.
    #[error(
        "run {run:?}: the window from {from_s} s to {to_s} s after the wavemaker's start (at {start_s:.2} s of the log) does not lie within the log, which ends {last_s:.2} s after that start; record \
         longer, or correct window in [source.excited_response]"
    )]
    WindowOutside {
        /// The run.
        run: String,
        /// From, s.
        from_s: f64,
        /// To, s.
        to_s: f64,
        /// Start of the wavemaker on the log, s.
        start_s: f64,
        /// End of the log after that, s.
        last_s: f64,
    },

    /// Too few cycles in the window.
    #[error(
        "run {run:?}: the window of {length_s:.2} s holds {found} whole cycles of {period_s:.3} s, and {fewest} are needed: widen it as far as the reflections allow, or use a longer tank"
    )]
    TooFewCycles {
        /// The run.
        run: String,
        /// Whole cycles.
        found: usize,
        /// Needed.
        fewest: usize,
        /// Their length.
        period_s: f64,
        /// Length of the window.
        length_s: f64,
    },

    /// No part in which force and motion have come up to their size.
    #[error(
        "waves of {period_s:.3} s: no window is declared, and none is found: force and motion come to nine tenths of their largest {from_s:.1} s after the wavemaker's start, which stops after {to_s:.1} s; \
         declare window = {{ from = \"…\", to = \"…\" }} in [source.excited_response], before reflections"
    )]
    NoWindow {
        /// Period, s.
        period_s: f64,
        /// Where the signals have come up, s.
        from_s: f64,
        /// Where the wavemaker stops, s.
        to_s: f64,
    },

    /// Nothing moves.
    #[error("run {run:?}: the {channel} has no part at the wave's frequency; check which column it is")]
    Nothing {
        /// The run.
        run: String,
        /// Which.
        channel: &'static str,
    },
}
