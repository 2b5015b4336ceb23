//! Anyone's servo log as a run: a CSV, and a sidecar that says what its columns are.
//!
//! ```toml
//! schema = 1
//! [constants]
//! drive_gain = "35.15 N/V"
//! [columns]
//! t_s       = { name = "time", unit = "s" }
//! q_ref_m   = { name = "reference_position", unit = "m" }
//! q_meas_m  = { name = "position", unit = "m" }
//! u_ctrl_V  = { name = "command", unit = "V" }
//! ```
//!
//! The names of an axis (`position`, `command`, …; a sidecar may also write `y/position` or `x/position` itself) become channels of axis `y`, as in a run of the carriage; `force` and every other
//! name stay as they are. An entry may also say `quantity`, `frame` and `clock`; what it leaves out is what its name tells, as it is
//! written there (`y/position` is along the chain, `position` has no frame until somebody says it). Times are kept as they are written; steps that are not even are reported, never resampled.

use std::path::Path;

use indexmap::IndexMap;

use crate::error::{Place, RecordError};
use crate::finding::{Finding, Severity};
use crate::measured::Measured;
use crate::raw_column::TWICE;
use crate::run::channel::{LOG, Meaning};
use crate::run::declarations::{Declarations, Told};
use crate::run::layout::AXIS;
use crate::run::log::{Channel, Gap, GapCause, RunLog, median};
use crate::run::meta::{Role, RunMeta, RunStatus};
use crate::sidecar::{Mapping, Sidecar, read_sidecar};
use crate::table::{ColumnData, Table};
use crate::table_file::read_table;
use crate::table_file::sidecar_of;
use crate::text::counted;
use crate::units::{Dimension, Unit};

/// Steps that differ less than this from their median, relative to it, are even but for the clock's resolution.
pub const EVEN: f64 = 0.01;

/// A step longer than this many medians has ticks missing in it.
pub const GAP: f64 = 1.5;

/// A log that was imported, with what was found in it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ImportedRun {
    /// The run; its gaps are where ticks are missing.
    pub log: RunLog,
    /// How even its time steps are.
    pub steps: TimeSteps,
    /// What a reader should know.
    pub findings: Vec<Finding>,
    /// What its sidecar declares of the channels, by the channel's name.
    pub told: IndexMap<String, Told>,
    /// What it declares of the data beside them.
    pub declared: Declarations,
}

/// Steps between ticks, s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TimeSteps {
    /// The median: gaps do not move it.
    pub median_s: f64,
    /// The shortest.
    pub shortest_s: f64,
    /// The longest.
    pub longest_s: f64,
}

/// Channels that make a log one of a servo.
const OF_SERVO: [&str; 3] = ["time", "position", "command"];

/// Whether the sidecar of a table says that it is the log of a servo: time, position and command of an axis, and no load on a body.
///
/// # Errors
///
/// A sidecar that cannot be read.
pub fn is_servo_log(table: &Path, sidecar: Option<&Path>) -> Result<bool, RecordError> {
    let Some(sidecar) = sidecar_of(table, sidecar)? else { return Ok(false) };
    let has = |name: &str| sidecar.columns.values().any(|column| column.name.trim_start_matches("y/") == name);
    Ok(OF_SERVO.into_iter().all(has))
}

/// Reads a CSV (or Parquet) log through its sidecar; `None` for the `.toml` beside it, or for headers `name [unit]`.
///
/// # Errors
///
/// See [`RecordError`]; a time column that is missing or does not increase names its line.
pub fn import_run(path: &Path, sidecar: Option<&Path>) -> Result<ImportedRun, RecordError> {
    let table = read_table(path, sidecar)?;
    let own = table.sidecar.as_deref().map(read_sidecar).transpose()?;
    run_of_table(&table, own.as_ref())
}

/// The same from a table in memory.
///
/// # Errors
///
/// As [`import_run`].
pub fn run_of_table(table: &Table, sidecar: Option<&Sidecar>) -> Result<ImportedRun, RecordError> {
    let time_s = times(table)?;
    let steps = TimeSteps::of(&time_s);
    let lost = gaps(&time_s, steps);
    run_of(table, sidecar, time_s, steps, lost)
}

/// A run of a table whose times, steps and gaps are known.
///
/// # Errors
///
/// Two columns that are one channel.
pub fn run_of(
    table: &Table,
    sidecar: Option<&Sidecar>,
    time_s: Vec<f64>,
    steps: TimeSteps,
    lost: Vec<Gap>,
) -> Result<ImportedRun, RecordError> {
    let mut channels = IndexMap::new();
    let mut told = IndexMap::new();
    for column in &table.columns {
        let ColumnData::Number { si, dimension, .. } = &column.data else { continue };
        if column.name == "time" {
            continue;
        }
        let mut meaning = Meaning::of(&column.name, &Unit::si(*dimension).text, LOG);
        let entry = sidecar.and_then(|s| s.columns.iter().find(|(_, entry)| entry.name == column.name));
        if let Some((header, entry)) = entry {
            entry.words.set(&mut meaning);
            told.insert(channel_name(&column.name), entry.told(header));
        }
        if channels.insert(channel_name(&column.name), Channel { meaning, values: si.clone() }).is_some() {
            return Err(RecordError::column(Place::whole(&table.path), &column.name, TWICE));
        }
    }
    let constants = sidecar.map(|s| &s.constants).into_iter().flatten().map(|(name, quantity)| {
        let unit = quantity.unit.dimension.to_string();
        (name.clone(), Measured::of(quantity.value_si, unit))
    });
    let meta = RunMeta {
        id: table.path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()),
        method: sidecar.and_then(|s| s.run.method.clone()).unwrap_or_default(),
        role: sidecar.and_then(|s| s.run.role).unwrap_or(Role::Excitation),
        configuration: sidecar.map_or_else(String::new, |s| s.run.configuration.clone()),
        conditions: sidecar.map(|s| s.run.conditions.clone()).unwrap_or_default(),
        status: RunStatus::Complete,
        constants: constants.collect(),
        channels: channels.iter().map(|(name, channel)| (name.clone(), channel.meaning.clone())).collect(),
        log_rate_hz: 1.0 / steps.median_s,
        ..RunMeta::default()
    };
    let findings = vec![finding(table, steps, &lost)];
    let log = RunLog { path: table.path.clone(), time_s, channels, lost, meta, ..RunLog::default() };
    let declared = sidecar.map(|s| s.run.declared.clone()).unwrap_or_default();
    Ok(ImportedRun { log, steps, findings, told, declared })
}

impl Mapping {
    /// What is declared of the channel that the column becomes.
    fn told(&self, header: &str) -> Told {
        Told {
            sensor: self.sensor.clone(),
            frame: self.words.declared_frame().map(str::to_owned),
            undeclared: self.undeclared.clone(),
            column: self.unit.as_ref().map_or_else(|| header.to_owned(), |unit| format!("{header} [{unit}]")),
            factor: self.unit.as_ref().map_or(1.0, |unit| unit.factor),
            sign: self.sign,
            time_standard_s: 0.0,
            place: self.place.clone(),
        }
    }
}

/// The channel that a column becomes.
#[must_use]
pub fn channel_name(name: &str) -> String {
    if AXIS.iter().any(|(of_axis, ..)| *of_axis == name) { format!("y/{name}") } else { name.to_owned() }
}

/// The time column, two ticks at least, increasing.
///
/// # Errors
///
/// No time column, fewer than two ticks, or times that do not increase.
pub fn times(table: &Table) -> Result<Vec<f64>, RecordError> {
    let time_s = time_column(table)?;
    if time_s.len() < 2 {
        let problem = "has one value; a log needs two ticks at least".to_owned();
        return Err(RecordError::value(table.place_of_row(0), "time", problem));
    }
    match time_s.windows(2).position(|w| w[1] <= w[0]) {
        Some(row) => Err(not_increasing(table.place_of_row(row + 1), time_s[row], time_s[row + 1])),
        None => Ok(time_s.to_vec()),
    }
}

/// The times of a table, s.
///
/// # Errors
///
/// No such column, or one of another dimension.
pub fn time_column(table: &Table) -> Result<&[f64], RecordError> {
    if !table.columns.iter().any(|column| column.name == "time") {
        let advice = "a log needs its times: head the column `time [s]`, or map it with { name = \"time\", unit = \"s\" } in the sidecar";
        return Err(RecordError::unknown_column(Place::whole(&table.path), "time", advice));
    }
    table.number("time", Dimension::TIME)
}

/// The error for times that go back or stand still.
#[must_use]
pub fn not_increasing(place: Place, before: f64, now: f64) -> RecordError {
    let problem = format!("is {now} s after {before} s; it must increase: sort the rows, or delete doubled ones");
    RecordError::value(place, "time", problem)
}

impl TimeSteps {
    /// The steps between increasing times.
    #[must_use]
    pub fn of(time_s: &[f64]) -> Self {
        let mut steps: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
        let median_s = median(&mut steps).unwrap_or(f64::NAN);
        let (shortest_s, longest_s) =
            steps.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), step| (low.min(*step), high.max(*step)));
        Self { median_s, shortest_s, longest_s }
    }
}

/// Where a step is so long that ticks are missing in it.
fn gaps(time_s: &[f64], steps: TimeSteps) -> Vec<Gap> {
    let long = time_s.windows(2).filter(|w| w[1] - w[0] > GAP * steps.median_s);
    long.map(|w| gap(w[0], w[1], steps.median_s)).collect()
}

/// Ticks that are missing between two times.
#[must_use]
pub fn gap(from_s: f64, to_s: f64, step_s: f64) -> Gap {
    let ticks = ((to_s - from_s) / step_s).round() as u64 - 1;
    Gap {
        from_s: Some(from_s),
        to_s: Some(to_s),
        ticks: Some(ticks),
        cause: GapCause::Link,
        text: format!(
            "{} missing between {from_s} s and {to_s} s of the log",
            counted(ticks as usize, "tick is", "ticks are")
        ),
    }
}

fn finding(table: &Table, steps: TimeSteps, lost: &[Gap]) -> Finding {
    let TimeSteps { median_s, shortest_s, longest_s } = steps;
    let off = (longest_s - median_s).max(median_s - shortest_s);
    let numbers = format!(
        "time steps have a median of {:.6} ms, from {:.6} ms to {:.6} ms",
        1e3 * median_s,
        1e3 * shortest_s,
        1e3 * longest_s
    );
    let (severity, code, message) = if !lost.is_empty() {
        let ticks: u64 = lost.iter().filter_map(|gap| gap.ticks).sum();
        let text = format!(
            "{numbers}: {} missing in {}; filters must not run across them",
            counted(ticks as usize, "tick is", "ticks are"),
            counted(lost.len(), "gap", "gaps")
        );
        (Severity::Warning, "time-gaps", text)
    } else if off > EVEN * median_s {
        let text = format!(
            "{numbers}: the log is not evenly sampled; filters assume every step to be {:.6} ms, so check the logger, or resample it",
            1e3 * median_s
        );
        (Severity::Warning, "uneven-time-steps", text)
    } else {
        let text = format!("{numbers}: uniform to {:.1e} of a step", off / median_s);
        (Severity::Note, "time-steps", text)
    };
    let mut finding = Finding::new(severity, code, message);
    finding.place = Some(table.path.display().to_string());
    finding
}
