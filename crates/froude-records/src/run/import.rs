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
//! written there (`y/position` is along the chain, `position` has no frame until somebody says it). Times are those of the stamps, or, where the stamps are
//! the rounded ones of even times, these ([`crate::run::stamps`]); what goes back is refused or treated as declared ([`crate::run::clock_jumps`]). Nothing is resampled.

use std::path::Path;

use indexmap::IndexMap;

use crate::error::{Place, RecordError};
use crate::finding::Finding;
use crate::measured::Measured;
use crate::raw_column::TWICE;
use crate::run::channel::{LOG, Meaning};
use crate::run::declarations::{Declarations, Told};
use crate::run::layout::AXIS;
use crate::run::log::{Channel, RunLog};
use crate::run::log_times::{LogTimes, TimeSteps};
use crate::run::marks::Mark;
use crate::run::meta::{Role, RunMeta, RunStatus};
use crate::run::step::Step;
use crate::sidecar::{Mapping, Sidecar};
use crate::sidecar_file::{joined, sidecar_of};
use crate::table::{ColumnData, Joined, Table};
use crate::table_file::read_table;
use crate::units::Unit;

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
    /// What was done to it while it was read.
    pub done: Vec<Step>,
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
    let others = joined(&sidecar, table)?;
    let all = || std::iter::once(&sidecar).chain(others.iter().filter_map(|(_, own)| own.as_ref()));
    let is = |own: &Sidecar, name: &str| own.columns.values().any(|c| c.name.trim_start_matches("y/") == name);
    let has = |name: &str| all().any(|own| is(own, name));
    Ok(OF_SERVO.into_iter().all(has))
}

/// Reads a CSV (or Parquet) log through its sidecar; `None` for the `.toml` beside it, or for headers `name [unit]`.
///
/// # Errors
///
/// See [`RecordError`]; a time column that is missing or does not increase names its line.
pub fn import_run(path: &Path, sidecar: Option<&Path>) -> Result<ImportedRun, RecordError> {
    let table = read_table(path, sidecar)?;
    let own = sidecar_of(path, sidecar)?;
    run_of_table(&table, own.as_ref())
}

/// The same from a table in memory.
///
/// # Errors
///
/// As [`import_run`].
pub fn run_of_table(table: &Table, sidecar: Option<&Sidecar>) -> Result<ImportedRun, RecordError> {
    let jumps = sidecar.map(|sidecar| sidecar.run.declared.jumps).unwrap_or_default();
    run_of(table, sidecar, LogTimes::of(table, jumps)?)
}

/// A run of a table whose times, steps and gaps are known.
///
/// # Errors
///
/// Two columns that are one channel; sidecars of joined logs that contradict each other.
pub fn run_of(table: &Table, sidecar: Option<&Sidecar>, times: LogTimes) -> Result<ImportedRun, RecordError> {
    let LogTimes { rows, time_s, steps, lost, mut findings } = times;
    let others = sidecar.map(|sidecar| joined(sidecar, &table.path)).transpose()?.unwrap_or_default();
    let of_join = |name: &String| table.joined.iter().position(|joined| joined.columns.contains(name));
    let mut channels = IndexMap::new();
    let mut told = IndexMap::new();
    for column in &table.columns {
        let ColumnData::Number { si, dimension, .. } = &column.data else { continue };
        if column.name == "time" {
            continue;
        }
        let mut meaning = Meaning::of(&column.name, &Unit::si(*dimension).text, LOG);
        let join = of_join(&column.name);
        let own = join.map_or(sidecar, |k| others.get(k).and_then(|(_, own)| own.as_ref()));
        let entry = own.and_then(|s| s.columns.iter().find(|(_, entry)| entry.name == column.name));
        if let Some((header, entry)) = entry {
            entry.words.set(&mut meaning);
            let scale_errors = own.map(|s| s.scale_errors(entry, table)).unwrap_or_default();
            let time_standard_s = join.and_then(|k| table.joined.get(k)).map_or(0.0, |joined| joined.lag.standard_s());
            told.insert(channel_name(&column.name), Told { time_standard_s, scale_errors, ..entry.told(header) });
        }
        if channels.insert(channel_name(&column.name), Channel { meaning, values: si[rows.clone()].to_vec() }).is_some()
        {
            return Err(RecordError::column(Place::whole(&table.path), &column.name, TWICE));
        }
    }
    let constants = sidecar.map(|s| &s.constants).into_iter().flatten().map(|(name, quantity)| {
        let unit = quantity.unit.dimension.to_string();
        (name.clone(), Measured::of(quantity.value_si, unit))
    });
    let mut meta = RunMeta {
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
    let mut declared = sidecar.map(|s| s.run.declared.clone()).unwrap_or_default();
    for ((_, own), joined) in others.iter().zip(&table.joined) {
        if let Some(own) = own {
            merge(&mut meta, &mut declared, own, joined)?;
        }
    }
    findings.extend(table.joined.iter().flat_map(|joined| joined.findings.clone()));
    let each = |joined: &Joined| {
        let step = |name: &String| Step { channel: channel_name(name), ..joined.step.clone() };
        joined.columns.iter().map(step).collect::<Vec<_>>()
    };
    let done = table.joined.iter().flat_map(each).collect();
    let log = RunLog { path: table.path.clone(), time_s, channels, lost, meta, ..RunLog::default() };
    Ok(ImportedRun { log, steps, findings, told, declared, done })
}

/// Adds what the sidecar of a joined log declares to what that of the log does.
fn merge(
    meta: &mut RunMeta,
    declared: &mut Declarations,
    own: &Sidecar,
    Joined { lag, .. }: &Joined,
) -> Result<(), RecordError> {
    let refuse = |key: &str, problem: String| {
        let place = Place::whole(&own.path);
        let what = format!(
            "{problem} in the sidecar of the log that it is joined to; leave it out of one, or make them agree"
        );
        Err(RecordError::value(place, key, what))
    };
    let theirs = &own.run.declared;
    if own.run.method.as_ref().is_some_and(|method| !meta.method.is_empty() && *method != meta.method) {
        return refuse("method", format!("is another than {:?}", meta.method));
    }
    if own.run.role.is_some_and(|role| role != meta.role) {
        return refuse("role", format!("is another than {:?}", meta.role.name()));
    }
    if !own.run.configuration.is_empty() && own.run.configuration != meta.configuration {
        return refuse("configuration", format!("is another than {:?}", meta.configuration));
    }
    let constants =
        own.constants.iter().map(|(name, q)| (name.clone(), Measured::of(q.value_si, q.unit.dimension.to_string())));
    let constants: IndexMap<String, Measured> = constants.collect();
    for (key, theirs, all) in
        [("conditions", &own.run.conditions, &mut meta.conditions), ("constants", &constants, &mut meta.constants)]
    {
        for (name, value) in theirs {
            if all.get(name).is_some_and(|known| known != value) {
                return refuse(key, format!("gives {name} another value than"));
            }
            all.insert(name.clone(), value.clone());
        }
    }
    if !theirs.clocks.is_empty() || !theirs.segments.is_empty() {
        let key = if theirs.clocks.is_empty() { "segments" } else { "clocks" };
        return Err(RecordError::value(
            Place::whole(&own.path),
            key,
            "of a log that is joined to another are not read: a joined log has one clock, and segments are those of the log that it is joined to; write them there",
        ));
    }
    for (name, frame) in &theirs.frames {
        if declared.frames.get(name).is_some_and(|known| known != frame) {
            return refuse("frames", format!("declares {name:?} otherwise than"));
        }
        declared.frames.insert(name.clone(), frame.clone());
    }
    if let Some(cell) = &theirs.cell {
        if declared.cell.as_ref().is_some_and(|known| known != cell) {
            return refuse("cell", "is another than".to_owned());
        }
        declared.cell = Some(cell.clone());
    }
    let on_log = |mark: &Mark| Mark { from_s: lag.time_s(mark.from_s), to_s: lag.time_s(mark.to_s), ..mark.clone() };
    declared.marks.extend(theirs.marks.iter().map(on_log));
    Ok(())
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
            scale_errors: Vec::new(),
            place: self.place.clone(),
        }
    }
}

/// The channel that a column becomes.
#[must_use]
pub fn channel_name(name: &str) -> String {
    if AXIS.iter().any(|(of_axis, ..)| *of_axis == name) { format!("y/{name}") } else { name.to_owned() }
}
