//! A run in memory: uniform ticks, named columns, what happened, and what is missing.

use std::ops::Range;
use std::path::PathBuf;

use indexmap::IndexMap;

use crate::error::{Place, RecordError};
use crate::nearest::suggestion;
use crate::run::channel::Meaning;
use crate::run::doubt::Doubt;
use crate::run::meta::RunMeta;
use crate::run::stamps::median;
use crate::units::{Dimension, parse_unit};

/// A whole run.
///
/// All columns have the length of `time_s`; a tick that did not arrive whole is in no column but in `lost`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunLog {
    /// The file that it was read from; empty for a run that was made in memory.
    pub path: PathBuf,
    /// Time of each tick since the start of the run, s, strictly increasing (board clock).
    pub time_s: Vec<f64>,
    /// Columns by name without unit (`y/position`, `force`, `truth/y/drag`), in the order recorded.
    pub channels: IndexMap<String, Channel>,
    /// What happened, in order of time.
    pub events: Vec<Event>,
    /// Ticks that are missing, in order of time.
    pub lost: Vec<Gap>,
    /// What is known about the run.
    pub meta: RunMeta,
    /// Faults of the log as a whole; empty for one that is as it was recorded.
    pub doubts: Vec<Doubt>,
}

/// One column of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// What its numbers are.
    pub meaning: Meaning,
    /// A value per tick.
    pub values: Vec<f64>,
}

/// Something that happened at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// When, s since the start of the run.
    pub time_s: f64,
    /// What sort of thing.
    pub kind: EventKind,
    /// The sentence a person reads.
    pub text: String,
}

/// Sort of an event.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum EventKind {
    /// A part of the run begins (steady, ramp, still wait).
    Phase,
    /// A fault was latched or cleared.
    Fault,
    /// A request was refused or a limit came near.
    Warning,
    /// The operator did or confirmed something.
    Operator,
    /// The link to the board: loss, resynchronisation.
    Link,
    /// The recorder itself: full disk, end of the run.
    Recorder,
    /// Anything else worth a line.
    Note,
    /// A sort that this version does not know.
    Other(String),
}

impl EventKind {
    const KNOWN: [Self; 7] =
        [Self::Phase, Self::Fault, Self::Warning, Self::Operator, Self::Link, Self::Recorder, Self::Note];

    /// As it stands in a log.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Phase => "phase",
            Self::Fault => "fault",
            Self::Warning => "warning",
            Self::Operator => "operator",
            Self::Link => "link",
            Self::Recorder => "recorder",
            Self::Note => "note",
            Self::Other(name) => name,
        }
    }

    /// The sort of that name.
    #[must_use]
    pub fn of_name(name: &str) -> Self {
        Self::KNOWN.into_iter().find(|kind| kind.name() == name).unwrap_or_else(|| Self::Other(name.to_owned()))
    }
}

/// Ticks that are missing.
#[derive(Debug, Clone, PartialEq)]
pub struct Gap {
    /// Time of the last tick before the gap, s; `None` where the run begins with it.
    pub from_s: Option<f64>,
    /// Time of the first tick after it, s; `None` where the run ends with it.
    pub to_s: Option<f64>,
    /// Ticks that should have been there; `None` where the end of the run is not known.
    pub ticks: Option<u64>,
    /// Why.
    pub cause: GapCause,
    /// The sentence a person reads.
    pub text: String,
}

/// Why ticks are missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GapCause {
    /// They never reached the recorder (frames lost on the link).
    Link,
    /// The file ends before the run did (power, kill, full disk).
    CutOff,
    /// A part of the file is damaged.
    Damaged,
    /// They hold a value that is not a finite number.
    NotFinite,
}

impl RunLog {
    /// Numbers of a channel, when it has the dimension asked for.
    ///
    /// # Errors
    ///
    /// No such channel (with the nearest name), or another dimension (with both units).
    pub fn channel(&self, name: &str, dimension: Dimension) -> Result<&[f64], RecordError> {
        let near = || suggestion(name, self.channels.keys().map(String::as_str));
        let unknown = || RecordError::unknown_column(self.place(), name, near());
        let channel = self.channels.get(name).ok_or_else(unknown)?;
        let header = format!("{name} [{}]", channel.meaning.unit);
        let unit = parse_unit(&channel.meaning.unit)
            .map_err(|e| RecordError::column(self.place(), &header, format!(": {e}")))?;
        if unit.dimension == dimension && unit.factor == 1.0 && unit.offset == 0.0 {
            return Ok(&channel.values);
        }
        let is_alike = unit.dimension == dimension;
        let found = if is_alike { format!("{unit}, which is not SI") } else { unit.dimension.describe() };
        Err(RecordError::wrong_dimension(self.place(), &header, &dimension.describe(), &found))
    }

    /// Where messages say that something of this run stands.
    #[must_use]
    pub fn place(&self) -> Place {
        let name = if self.path.as_os_str().is_empty() { self.meta.id.as_ref() } else { self.path.as_path() };
        Place::whole(name)
    }

    /// Number of ticks.
    #[must_use]
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Whether there is no tick.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// From the first tick to the last, s; 0 with fewer than two.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        match (self.time_s.first(), self.time_s.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// Ticks per second: the inverse of the median step, which gaps do not move. `None` with fewer than two ticks.
    #[must_use]
    pub fn sample_rate_hz(&self) -> Option<f64> {
        let mut steps: Vec<f64> = self.time_s.windows(2).map(|w| w[1] - w[0]).collect();
        median(&mut steps).filter(|median| *median > 0.0).map(|median| 1.0 / median)
    }

    /// Rows with `from_s ≤ time < to_s`.
    #[must_use]
    pub fn rows(&self, from_s: f64, to_s: f64) -> Range<usize> {
        let start = self.time_s.partition_point(|t| *t < from_s);
        let end = self.time_s.partition_point(|t| *t < to_s);
        start..end.max(start)
    }

    /// The part of the run with `from_s ≤ time < to_s`: columns, events and gaps that touch it.
    #[must_use]
    pub fn between(&self, from_s: f64, to_s: f64) -> Self {
        let rows = self.rows(from_s, to_s);
        let inside = |t: f64| from_s <= t && t < to_s;
        let cut = |(name, c): (&String, &Channel)| {
            let values = c.values.get(rows.clone()).unwrap_or_default().to_vec();
            (name.clone(), Channel { meaning: c.meaning.clone(), values })
        };
        let touches = |gap: &&Gap| gap.from_s.is_none_or(|t| t < to_s) && gap.to_s.is_none_or(|t| t > from_s);
        Self {
            path: self.path.clone(),
            time_s: self.time_s[rows.clone()].to_vec(),
            channels: self.channels.iter().map(cut).collect(),
            events: self.events.iter().filter(|e| inside(e.time_s)).cloned().collect(),
            lost: self.lost.iter().filter(touches).cloned().collect(),
            meta: self.meta.clone(),
            doubts: self.doubts.clone(),
        }
    }

    /// Ticks that are known to be missing.
    #[must_use]
    pub fn lost_ticks(&self) -> u64 {
        self.lost.iter().filter_map(|gap| gap.ticks).sum()
    }
}
