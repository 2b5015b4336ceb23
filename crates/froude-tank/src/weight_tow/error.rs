//! Why a run of the weight-driven rig gives no observation.

use crate::steady::SteadyError;

/// Why a run gives no observation; each message states what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WeightTowError {
    /// The loads give none.
    #[error(transparent)]
    Loads(#[from] SteadyError),

    /// Marks where it is looked at.
    #[error(
        "run {run:?}: {}, holds {marks}; film it again, or give the camera a view without what was marked",
        if *.is_balanced { "what moves, which the equation of motion is fitted to" } else { "the last part of its way" }
    )]
    Marked {
        /// The run.
        run: String,
        /// The marks in words.
        marks: String,
        /// Whether the equation of motion is fitted.
        is_balanced: bool,
    },

    /// The wagon does not move, or not far enough.
    #[error(
        "run {run:?}: the mark moves {moved_m:.3} m, and the last {window_m:.3} m of its way are looked at; check the scale, or state a shorter window in [source.weight_tow]"
    )]
    NoMotion {
        /// The run.
        run: String,
        /// Its way, m.
        moved_m: f64,
        /// The window, m.
        window_m: f64,
    },

    /// Too few frames for a speed.
    #[error(
        "run {run:?}: {found} frames in the last {window_m:.3} m of the way, {needed} are needed; film faster, or state a longer window in [source.weight_tow]"
    )]
    TooFewFrames {
        /// The run.
        run: String,
        /// Frames found.
        found: usize,
        /// Frames needed.
        needed: usize,
        /// The window, m.
        window_m: f64,
    },

    /// Not steady, and no mass for a balance.
    #[error(
        "run {run:?}: not steady: the speed changes by {:.1} ± {:.1} % over the last {window_m:.3} m, and {:.1} % is allowed; declare moving_mass in [source.weight_tow], so that it \
         can be balanced, or use a longer way",
        1e2 * .change,
        1e2 * .standard,
        1e2 * .tolerance
    )]
    NotSteady {
        /// The run.
        run: String,
        /// Change of the speed over the window, as part of it.
        change: f64,
        /// Standard uncertainty of that.
        standard: f64,
        /// What is allowed.
        tolerance: f64,
        /// The window, m.
        window_m: f64,
    },

    /// Too far from the terminal speed.
    #[error(
        "run {run:?}: only {:.0} % of its terminal speed is reached ({speed_m_s:.3} of {terminal_m_s:.3} m/s), and {:.0} % is needed; use a longer way, a lighter wagon, or a body with \
         more drag",
        1e2 * .speed_m_s / .terminal_m_s,
        1e2 * .needed
    )]
    TooSlow {
        /// The run.
        run: String,
        /// Speed at the end, m/s.
        speed_m_s: f64,
        /// Terminal speed, m/s.
        terminal_m_s: f64,
        /// Part needed.
        needed: f64,
    },

    /// The weight does not move the wagon.
    #[error(
        "run {run:?}: the weight of {weight_n:.4} N is not above the friction of {friction_n:.4} N that is declared, and yet the wagon moves; check both"
    )]
    NoPull {
        /// The run.
        run: String,
        /// The weight, N.
        weight_n: f64,
        /// The friction, N.
        friction_n: f64,
    },

    /// The equation of motion does not follow the track.
    #[error(
        "run {run:?}: no terminal speed explains the track with this weight and mass: it goes {what}; check weight, friction and moving_mass"
    )]
    NoTerminal {
        /// The run.
        run: String,
        /// How it goes.
        what: &'static str,
    },
}
