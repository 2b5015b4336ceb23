//! A run that Froude recorded, as one that was imported: its log in SI, with what its sidecar declares of the channels.

use std::path::Path;

use indexmap::IndexMap;

use froude_records::finding::Finding;
use froude_records::run::{Doubt, Frame, RunLog, TimeSteps, Told, head_of, read_run, read_run_meta};
use froude_records::units::{Unit, parse_unit};
use froude_records::{Place, RecordError};

use crate::log::TankLog;

/// Reads `RUN.mcap` with `RUN.toml` beside it: units and signs are undone, as an importer does; what is doubtful about the log is a finding.
///
/// # Errors
///
/// As [`read_run`]; fewer than two ticks, a unit that cannot be read.
pub(crate) fn recorded_run(path: &Path) -> Result<TankLog, RecordError> {
    let sidecar = path.with_extension("toml");
    // Before the whole is read: then what is not declared has been filled in by the channels' names.
    let declared = if sidecar.exists() { Some(read_run_meta(&sidecar)?) } else { head_of(path)? }.unwrap_or_default();
    let mut log = read_run(path)?;
    if log.len() < 2 {
        let found = log.len();
        let problem = format!("has {found} values; a log needs two ticks at least");
        return Err(RecordError::value(Place::whole(path), "time", problem));
    }
    let mut told = IndexMap::new();
    for (name, channel) in &mut log.channels {
        let meaning = &mut channel.meaning;
        let unit = parse_unit(&meaning.unit).map_err(|e| {
            let header = format!("{name} [{}]", meaning.unit);
            RecordError::syntax(Place::whole(path), format!("column `{header}`: {e}"))
        })?;
        let sign = f64::from(meaning.sign);
        channel.values.iter_mut().for_each(|x| *x = sign * unit.to_si(*x));
        let stated = declared.stated.get(name).cloned().unwrap_or_default();
        let mut undeclared = stated.undeclared;
        if !declared.channels.contains_key(name) {
            undeclared = vec!["unit", "sign", "frame", "clock"];
        } else if meaning.frame == Frame::None && stated.frame.is_none() && !undeclared.contains(&"frame") {
            undeclared.push("frame");
        }
        if stated.frame.is_some() {
            meaning.frame = Frame::Sensor;
        }
        told.insert(
            name.clone(),
            Told {
                sensor: stated.sensor,
                frame: stated.frame,
                undeclared,
                column: format!("{name} [{unit}]"),
                factor: unit.factor,
                sign,
                time_standard_s: 0.0,
                scale_errors: Vec::new(),
                place: Place::whole(if sidecar.exists() { &sidecar } else { path }),
            },
        );
        meaning.unit = Unit::si(unit.dimension).text;
        meaning.sign = 1;
    }
    let steps = TimeSteps::of(&log.time_s);
    let findings: Vec<Finding> = log.doubts.iter().map(Doubt::finding).collect();
    let declared = std::mem::take(&mut log.meta.declared);
    let log = RunLog { doubts: Vec::new(), ..log };
    Ok(TankLog { log, steps, findings, told, declared, ..TankLog::default() })
}
