//! Why releases give no coefficients.

use froude_records::text::counted;

/// Why releases give no coefficients; each message states what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DecayError {
    /// Nothing was given.
    #[error("no release was given; a decay test needs at least one")]
    NoRuns,

    /// Columns of a run differ in length.
    #[error("run {run:?}: position has {found} samples where time has {expected}")]
    Length {
        /// The run.
        run: String,
        /// Samples of position.
        found: usize,
        /// Samples of time.
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

    /// Time that does not go in equal steps.
    #[error(
        "run {run:?}: sample {index} is {late_s:.3e} s off an even step of {step_s:.3e} s; resample the log to even steps first"
    )]
    UnevenTime {
        /// The run.
        run: String,
        /// Index from 0 of the sample that is furthest off.
        index: usize,
        /// How far, s.
        late_s: f64,
        /// Mean step, s.
        step_s: f64,
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

    /// Free from a time that the log does not reach.
    #[error(
        "run {run:?}: free_from = {free_from_s} s, and the log ends at {last_s} s: it counts in the log's times, those of a calendar from the first sample"
    )]
    FreeAfterEnd {
        /// Name of the run.
        run: String,
        /// What is declared, s.
        free_from_s: f64,
        /// Its last sample, s.
        last_s: f64,
    },
    /// No motion above the noise of the sensor.
    #[error(
        "run {run:?}: the motion reaches {range:.3e} where the noise of a sample is {noise:.3e}; release from further out"
    )]
    NoMotion {
        /// The run.
        run: String,
        /// Largest distance from rest, m or rad.
        range: f64,
        /// Standard deviation of a sample's noise, m or rad.
        noise: f64,
    },

    /// The body creeps back to rest without passing it.
    #[error(
        "run {run:?}: the body returns without passing its rest position (over-damped); stiffer springs or a smaller \
         release make it swing"
    )]
    OverDamped {
        /// The run.
        run: String,
    },

    /// Fewer peaks than a method needs.
    #[error(
        "run {run:?}: {} further than {level:.3e} {unit} from rest ({over_noise} times the noise of a sample), and {method} needs {needed}; {advice}",
        counted(*found, "peak", "peaks")
    )]
    TooFewPeaks {
        /// The run.
        run: String,
        /// Peaks found.
        found: usize,
        /// The distance from rest that a peak exceeds, m or rad.
        level: f64,
        /// Its unit.
        unit: &'static str,
        /// The same in standard deviations of a sample's noise.
        over_noise: f64,
        /// The method.
        method: &'static str,
        /// Peaks needed.
        needed: usize,
        /// What to do.
        advice: &'static str,
    },

    /// A restoring moment that the formulas of a method do not hold for.
    #[error(
        "run {run:?}: a buoyancy at a radius drives back by sin φ, which at {peak_rad:.3} rad is {:.1} % less than φ, and the formulas of {method} are those of a \
         spring; use decay_output_error, or release from less and declare stiffness = B r",
        100.0 * (1.0 - peak_rad.sin() / peak_rad)
    )]
    NotASpring {
        /// The run.
        run: String,
        /// Its largest peak, rad.
        peak_rad: f64,
        /// The method.
        method: &'static str,
    },

    /// A half cycle that is no half cycle.
    #[error(
        "run {run:?}: half cycle {half_cycle} has no turning point near its middle: two modes beat, or a wave disturbs it; restrain the \
         other mode, or count swings only while they are larger (smallest over noise)"
    )]
    Irregular {
        /// The run.
        run: String,
        /// Its number, from 0.
        half_cycle: usize,
    },

    /// A half cycle of too few samples.
    #[error("run {run:?}: {found:.1} samples in a half cycle, {needed} are needed; sample faster")]
    TooCoarse {
        /// The run.
        run: String,
        /// Samples in a half cycle.
        found: f64,
        /// Samples needed.
        needed: usize,
    },

    /// The runs together leave a coefficient open.
    #[error("the half cycles do not determine {what}; release from amplitudes that differ more")]
    Undetermined {
        /// Which.
        what: String,
    },

    /// The fit of the motion did not end in a minimum.
    #[error("output error: {0}")]
    Fit(String),
}
