//! Why a run gives no steady observation.

/// Why a run gives no steady observation; each message states what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SteadyError {
    /// Columns of a run differ in length, or are too short for a block.
    #[error("run {run:?}: {column} has {found} samples, {needed} are needed")]
    Length {
        /// The run.
        run: String,
        /// The column.
        column: String,
        /// Its samples.
        found: usize,
        /// Samples needed.
        needed: usize,
    },

    /// Nothing moves.
    #[error("run {run:?}: the body does not move; a run at rest has the role \"still\"")]
    NoMotion {
        /// The run.
        run: String,
    },

    /// The speed is nowhere constant for long enough.
    #[error(
        "run {run:?}: no steady window: the speed stays within ± {:.2} % for {longest_s:.2} s at most (from {from_s:.2} s, {speed_m_s:.4} m/s), and {needed_s:.2} s are \
         needed, settling included; tow longer, or allow more (tolerance, shortest and settle in [source.steady])",
        1e2 * .tolerance
    )]
    NoWindow {
        /// The run.
        run: String,
        /// Largest difference from the window's speed, as part of it.
        tolerance: f64,
        /// The longest stretch within it, s.
        longest_s: f64,
        /// Where it begins, s of the log.
        from_s: f64,
        /// Its speed, m/s.
        speed_m_s: f64,
        /// What is needed, s.
        needed_s: f64,
    },

    /// A sensor at its end.
    #[error(
        "run {run:?}: {channel} stands at {value} in {:.0} % of its steady window: the sensor is clipped; widen its range, or tow more slowly",
        1e2 * .part
    )]
    Clipped {
        /// The run.
        run: String,
        /// The channel.
        channel: String,
        /// The reading.
        value: f64,
        /// Part of the window.
        part: f64,
    },

    /// Marks in the window.
    #[error(
        "run {run:?}: its steady window holds {marks}; what is left of it is too short: tow longer, widen the sensor's range, or name a window without marks ([[segments]] name = \"steady\")"
    )]
    Marked {
        /// The run.
        run: String,
        /// The marks in words.
        marks: String,
    },

    /// A window that a person has named.
    #[error(
        "run {run:?}: the segment steady, from {from_s:.3} s to {to_s:.3} s, has {samples} samples of the log; correct it in [[segments]] of its sidecar"
    )]
    Declared {
        /// The run.
        run: String,
        /// Where it begins, s of the log.
        from_s: f64,
        /// Where it ends, s of the log.
        to_s: f64,
        /// Samples in it.
        samples: usize,
    },

    /// No zero of the load cell.
    #[error(
        "run {run:?}: nothing tells the zero of the sensor: the log has no part at rest of {needed_s} s or more, and there is no run of the role \"still\" with \
         [conditions] at = \"…\" in the folder; log some seconds at rest before each tow"
    )]
    NoZero {
        /// The run.
        run: String,
        /// Shortest part at rest, s.
        needed_s: f64,
    },

    /// A still run too long ago.
    #[error(
        "run {run:?}: the nearest still run is {away_s:.0} s away, over which the zero may drift by {drift_n:.3e} N, and {most_n:.3e} N is allowed; take a still run \
         nearer to it, or state a smaller drift (drift in [source.steady])"
    )]
    OldZero {
        /// The run.
        run: String,
        /// Time to it, s.
        away_s: f64,
        /// What it may have drifted, N.
        drift_n: f64,
        /// What is allowed, N.
        most_n: f64,
    },

    /// Nothing to subtract.
    #[error(
        "run {run:?}: no run of the role \"tare\" is at its speed and angle ({speed_m_s:.4} m/s, {angle_deg:.2} deg); the nearest is at {nearest}; tow the rig without the body there, \
         or subtract a fitted tare (tare = {{ record = \"…\" }})"
    )]
    NoTare {
        /// The run.
        run: String,
        /// Its speed, m/s.
        speed_m_s: f64,
        /// Its angle, degrees.
        angle_deg: f64,
        /// The nearest tare, in words.
        nearest: String,
    },
}
