//! What a sidecar declares of a run's data beside the channels: clocks, frames, a load cell's matrix, marks, segments.

use indexmap::IndexMap;

use crate::error::{Place, RecordError};
use crate::run::cell::{Cell, cell};
use crate::run::clock_jumps::ClockJumps;
use crate::run::clocks::{Clock, clocks};
use crate::run::frames::{FrameSpec, frames};
use crate::run::marks::{Mark, Segment, marks, segments};
use crate::run::sensor::Sensor;
use crate::section::Section;

/// Their sections.
pub(crate) const KEYS: [&str; 5] = ["clocks", "frames", "cell", "marks", "segments"];

/// What a sidecar declares of the data.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Declarations {
    /// What is declared of a clock that goes back.
    pub jumps: ClockJumps,
    /// Clocks beside the log's own, by name.
    pub clocks: IndexMap<String, Clock>,
    /// Frames beside the known ones, by name.
    pub frames: IndexMap<String, FrameSpec>,
    /// A load cell of several bridges.
    pub cell: Option<Cell>,
    /// What is not to be used.
    pub marks: Vec<Mark>,
    /// What a person has named.
    pub segments: Vec<Segment>,
}

/// What the sidecar of a recorded run states of a channel beside its meaning.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stated {
    /// Its sensor.
    pub sensor: Sensor,
    /// The declared frame that it is along, where it is along one.
    pub frame: Option<String>,
    /// What of sign, frame and clock is not written, and was taken from its name.
    pub undeclared: Vec<&'static str>,
}

/// What is declared of one channel beside its meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct Told {
    /// Its sensor.
    pub sensor: Sensor,
    /// The declared frame that it is along, where it is along one.
    pub frame: Option<String>,
    /// What of unit, sign, frame and clock is not written.
    pub undeclared: Vec<&'static str>,
    /// Its column in the log, with the unit there.
    pub column: String,
    /// SI units in one of the unit there.
    pub factor: f64,
    /// The sign that was undone.
    pub sign: f64,
    /// Standard uncertainty of its times, s, by clock and delay.
    pub time_standard_s: f64,
    /// Uncertain constants of its scale, each with its standard error as a part of the channel.
    pub scale_errors: Vec<(String, f64)>,
    /// Where it is written.
    pub place: Place,
}

impl Declarations {
    /// Reads the sections that are there.
    pub(crate) fn read(root: &Section<'_>) -> Result<Self, RecordError> {
        let frames = frames(root)?;
        let names: Vec<&str> = frames.keys().map(String::as_str).collect();
        let cell = cell(root, &names)?;
        Ok(Self {
            jumps: ClockJumps::read(root)?,
            clocks: clocks(root)?,
            cell,
            marks: marks(root)?,
            segments: segments(root)?,
            frames,
        })
    }

    /// Names of the declared frames.
    pub(crate) fn frame_names(&self) -> Vec<&str> {
        self.frames.keys().map(String::as_str).collect()
    }
}
