//! What a fit in waves starts from: runs, and what is declared of the body.

use std::borrow::Cow;

use froude_fit::budget::Uncertain;
use froude_signal::SignalError;

use crate::error::TankError;

/// Channels: the wavemaker, the force on the held body, the camera's position of the free one.
pub(super) const REFERENCE: &str = "reference";
pub(super) const FORCE: &str = "f_z";
pub(super) const POSITION: &str = "heave";
/// What the names of its accelerometers begin with.
pub(super) const ACCELERATION: &str = "acceleration";

/// What the signal of a run shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shows {
    /// Force of the water on the held body, N.
    Force,
    /// Acceleration of the free one, m/s².
    Acceleration,
    /// Position of it, m.
    Position,
}

impl Shows {
    /// Unit of the signal.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Force => "N",
            Self::Acceleration => "m/s²",
            Self::Position => "m",
        }
    }

    /// In a word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Acceleration => "acceleration",
            Self::Position => "position",
        }
    }
}

/// One run in waves.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveRun<'a> {
    /// Its name.
    pub id: &'a str,
    /// Period of the wave that is declared, s.
    pub period_s: Option<f64>,
    /// Time, s, increasing.
    pub time_s: &'a [f64],
    /// Position of the wavemaker.
    pub reference: &'a [f64],
    /// What the signal shows: force where the body is held, motion where it is free.
    pub shows: Shows,
    /// The signal.
    pub signal: Cow<'a, [f64]>,
    /// Position beside an acceleration, m: a camera whose clock can be checked.
    pub camera_m: Option<&'a [f64]>,
}

impl WaveRun<'_> {
    /// Whether the body is held.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.shows == Shows::Force
    }
}

/// What is declared.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// m, all that moves, kg.
    pub mass_kg: Uncertain,
    /// C33, N/m.
    pub restoring_n_m: Uncertain,
    /// Delay of the force behind the motion, each against the wavemaker, s.
    pub delay_s: Uncertain,
    /// Standard uncertainty of the gain of the force.
    pub force_relative: f64,
    /// The same of the acceleration.
    pub acceleration_relative: f64,
    /// The same of the position.
    pub position_relative: f64,
    /// From and to, s after the wavemaker's start; `None` where no window is declared.
    pub window_s: Option<[f64; 2]>,
    /// Harmonics of every fit.
    pub harmonics: usize,
}

impl Setup {
    /// Mass and restoring force; everything else exact, no window, three harmonics.
    #[must_use]
    pub fn new(mass_kg: Uncertain, restoring_n_m: Uncertain) -> Self {
        Self {
            mass_kg,
            restoring_n_m,
            delay_s: Uncertain::new(0.0, 0.0),
            force_relative: 0.0,
            acceleration_relative: 0.0,
            position_relative: 0.0,
            window_s: None,
            harmonics: 3,
        }
    }
}

pub(super) fn not_fitted(run: &WaveRun<'_>, channel: &str, why: &SignalError) -> TankError {
    TankError::of_run(run.id, format!("the {channel} cannot be fitted by harmonics: {why}"))
}
