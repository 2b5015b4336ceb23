//! Tows from logs of other programs: the position along the rail and the motor's command or current, with a list that describes each run.
//!
//! Such logs have no reference speed. A run is steady while the speed, from differences of the position over 0.2 s, stays constant
//! ([`held`]); the mean speed of that stretch replaces the reference. The direction of a run is that of its position.

use std::path::{Path, PathBuf};

use froude_identify::method::MethodError;
use froude_identify::runs::{files, logs_in};
use froude_identify::wild;
use froude_records::finding::{Finding, Severity};
use froude_records::number::{percent, significant};
use froude_records::run::clocks::is_own;
use froude_records::run::marks::{Segment, SegmentKind};
use froude_records::run::{
    BodyState, CAMPAIGN_COPY, Channel, Declarations, Direction, ImportedRun, LOG, Meaning, Role, RunLog, TOW,
    run_of_table,
};
use froude_records::sidecar::{Sidecar, read_sidecar};
use froude_records::sidecar_file::{sidecar_of, sidecar_path};
use froude_records::table_file::read_table;
use froude_records::text::counted;
use froude_records::units::Dimension;
use froude_rig::carriage::{DrivenCampaign, LogsRig};
use indexmap::IndexMap;

use super::held::{CORNER_S, HELD_WITHIN, Held, SPAN_S, drift, held};
use super::set::{Member, doubles};
use super::whole::folder_of;
use super::{Named, Runs, attitude, column, first_folder};
use crate::drag::steady::SteadySettings;

/// A carriage slower than this part of its speed is at rest.
const AT_REST: f64 = 0.05;

/// Roles that are read.
const ROLES: [Role; 3] = [Role::Wet, Role::Dry, Role::Friction];

/// The logs of tows among what is named: files that no carriage of Froude's wrote, whose sidecar states the method `tow`.
///
/// # Errors
///
/// A sidecar cannot be read, a log in the folder has no such sidecar, or the folder also holds runs that Froude recorded.
pub(super) fn logs(paths: &[PathBuf]) -> Result<Vec<PathBuf>, MethodError> {
    let (mut tows, mut others, mut unstated) = (Vec::new(), Vec::new(), None);
    for path in paths {
        let of_froude = |path: &Path| path.extension().is_some_and(|e| e == "mcap" || e == "toml");
        let all = if path.is_dir() { logs_in(path)? } else { vec![path.clone()] };
        for log in all.into_iter().filter(|log| log.is_file() && !of_froude(log)) {
            let sidecar = sidecar_path(&log)?.map(|path| read_sidecar(&path)).transpose()?;
            match sidecar {
                Some(sidecar) if sidecar.run.method.as_deref() == Some(TOW) => tows.push(log),
                Some(sidecar) if sidecar.run.method.is_none() && sidecar.list.is_some() => {
                    unstated.get_or_insert(sidecar.path);
                }
                _ => others.push(log),
            }
        }
    }
    if let (Some(sidecar), true) = (unstated, tows.is_empty()) {
        let what = "states no method; for wet and dry tows of a carriage write method = \"tow\" at its head";
        return Err(MethodError::input(sidecar, what));
    }
    match others.first() {
        Some(other) if !tows.is_empty() => {
            let what = "lies among logs of tows, and no sidecar with method = \"tow\" describes it: widen the `files` of that sidecar, or move the file out";
            return Err(MethodError::input(other, what));
        }
        _ => {}
    }
    if let (Some(tow), Some(run)) =
        (tows.first(), files(paths)?.iter().find(|file| file.exists() && !tows.contains(file)))
    {
        let what = format!(
            "is a run that Froude recorded, beside the log {} of another program: reduce them separately",
            tow.display()
        );
        return Err(MethodError::input(run, what));
    }
    tows.sort();
    Ok(tows)
}

/// What a log states of itself.
struct Tow {
    sidecar: Sidecar,
    role: Role,
    speed_m_s: f64,
    imported: ImportedRun,
    /// How its table was read.
    foreign: Vec<Finding>,
}

/// Reads such logs in these roles; their campaign is `campaign`, or the `campaign.toml` in their folder or in the one above.
///
/// # Errors
///
/// No campaign states the force per volt or per ampere, a log lacks something that the methods need, or the list contradicts the motion.
pub(super) fn read(
    paths: &[PathBuf],
    all: &[PathBuf],
    roles: &[Role],
    campaign: Option<&Path>,
) -> Result<Runs, MethodError> {
    let campaign = campaign_of(paths, campaign)?;
    let driven = DrivenCampaign::read(&campaign)?;
    let Some(rig) = driven.logs else { return Err(MethodError::input(campaign, format!("has no rig of logs; {RIG}"))) };
    let folders: Vec<PathBuf> = {
        let mut all: Vec<PathBuf> = all.iter().map(|log| folder_of(log)).collect();
        all.dedup();
        all
    };
    let mut out = Runs { folder: first_folder(paths), declared_by: vec![campaign], ..Runs::default() };
    let (mut directions, mut settings, mut members) = (Directions::default(), Vec::new(), Vec::new());
    let mut said: IndexMap<String, (Finding, usize)> = IndexMap::new();
    for path in all {
        let mut tow = told(path)?;
        let meta = &mut tow.imported.log.meta;
        if let ([_, _, ..], Some(folder)) = (folders.as_slice(), folder_of(path).file_name()) {
            meta.id = format!("{}-{}", folder.to_string_lossy(), meta.id);
        }
        members.push(Member::of(path, meta)?);
        out.declared_by.extend([Some(tow.sidecar.path.clone()), tow.sidecar.list.clone()].into_iter().flatten());
        if !roles.contains(&tow.role) {
            continue;
        }
        let notes = tow.imported.findings.iter().chain(&tow.foreign).filter(|f| f.code != "time-steps");
        for finding in notes {
            said.entry(finding.code.clone()).or_insert_with(|| (finding.clone(), 0)).1 += 1;
        }
        let (direction, repeat) = (tow.sidecar.run.direction.clone(), tow.sidecar.run.repeat.clone());
        let list = tow.sidecar.list.clone();
        let mut log = match run_of(tow, &rig) {
            Ok(log) => log,
            Err(Unread::Refused(error)) => return Err(error),
            Err(Unread::LeftOut(why)) => {
                let text = format!("{}: left out: {why}", path.display());
                out.findings.push(Finding::new(Severity::Warning, "run-left-out", text));
                continue;
            }
        };
        directions.agree(path, &direction, log.meta.carriage.direction)?;
        settings.push((list, repeat));
        log.meta.campaign.clone_from(&driven.campaign.name);
        out.logs.push(log);
    }
    if let Some(first) = doubles(&members).into_iter().next() {
        return Err(MethodError::NoSet { first: first.message, more: 0 });
    }
    pair(&mut out.logs, &settings)?;
    for (mut finding, n) in said.into_values() {
        if n > 1 {
            finding.message += &format!(" (and {})", counted(n - 1, "more log", "more logs"));
        }
        out.findings.push(finding);
    }
    out.declared_by.sort();
    out.declared_by.dedup();
    if paths.iter().all(|path| path.is_dir()) {
        out.findings.extend(not_there(&out.declared_by, all)?);
    }
    if out.logs.is_empty() {
        let left = out
            .findings
            .iter()
            .find(|f| f.code == "run-left-out")
            .map_or_else(String::new, |f| format!("; {}", f.message));
        let names: Vec<&str> = roles.iter().map(|role| role.name()).collect();
        let what = format!(
            "none of the {} is a run of the roles {}{left}",
            counted(all.len(), "log", "logs"),
            names.join(", ")
        );
        return Err(MethodError::input(&out.folder, what));
    }
    out.findings.push(steady_by_position());
    out.findings.extend(speed_drifts(&out.logs)?);
    out.travel = attitude(&out.logs, Some(&driven.campaign))?;
    out.campaign = Some(driven);
    let named = if paths.iter().all(|path| path.is_dir()) { paths } else { all };
    out.named = Named { first: named.first().cloned().unwrap_or_default(), more: named.len().saturating_sub(1) };
    if !paths.iter().any(|path| path.is_dir()) {
        let there: usize = folders.iter().map(|folder| logs_in(folder).map_or(0, |logs| logs.len())).sum();
        out.beside = there.saturating_sub(all.len());
    }
    Ok(out)
}

/// What a campaign of logs has.
const RIG: &str = "write [rig] with kind = \"logs\", force_per_volt (or force_per_ampere), position_standard and ballasted, as froude new carriage-logs does";

fn campaign_of(paths: &[PathBuf], named: Option<&Path>) -> Result<PathBuf, MethodError> {
    if let Some(named) = named {
        return Ok(named.to_owned());
    }
    let folder = first_folder(paths);
    let above = match folder.parent() {
        Some(above) if folder.file_name().is_some() => above.to_owned(),
        _ => folder.join(".."),
    };
    let places = [folder.join(CAMPAIGN_COPY), above.join(CAMPAIGN_COPY)];
    places.iter().find(|place| place.is_file()).cloned().ok_or_else(|| {
        let what = format!(
            "no {CAMPAIGN_COPY} lies with these logs or in the folder above, and none was named: the force per volt or ampere is not known; {RIG}"
        );
        MethodError::input(folder, what)
    })
}

fn told(path: &Path) -> Result<Tow, MethodError> {
    let Some(sidecar) = sidecar_of(path, None)? else {
        return Err(MethodError::input(path, "has no sidecar that says what its columns are"));
    };
    let lacks = |what: &str| Err(MethodError::input(path, what.to_owned()));
    let role = match sidecar.run.role {
        Some(role) if ROLES.contains(&role) => role,
        Some(role) => {
            let names = ROLES.map(Role::name).join(", ");
            return lacks(&format!(
                "its role is {}; of a carriage's logs {names} are read: take it out of the folder",
                role.name()
            ));
        }
        None => {
            return lacks(
                "nothing says whether it is wet or dry: write a column role (wet, dry, friction) into the list of its sidecar",
            );
        }
    };
    let speed = sidecar.run.conditions.get("speed").filter(|speed| speed.unit == Dimension::SPEED.to_string());
    let speed_m_s = match speed.map(|speed| speed.value) {
        Some(speed) if speed > 0.0 && speed.is_finite() => speed,
        Some(speed) => {
            return lacks(&format!(
                "its listed speed is {speed} m/s; write it larger than zero, since the motion says which way it goes"
            ));
        }
        None => {
            return lacks(
                "its speed is not listed, and wet and dry runs are paired by it: write a column speed [m/s] into the list of its sidecar",
            );
        }
    };
    let table = read_table(path, None)?;
    let imported = run_of_table(&table, Some(&sidecar))?;
    let of_force = || imported.log.channels.contains_key("force").then(|| OF_FORCE.to_owned());
    let is_steady = |segment: &Segment| segment.kind == SegmentKind::Steady;
    if let Some(what) = not_applied(&imported, &|_| true, &is_steady).or_else(of_force) {
        return lacks(&format!("{what} is not applied to logs of a carriage; take it out, or apply it to the log"));
    }
    Ok(Tow { sidecar, role, speed_m_s, foreign: table.findings(), imported })
}

/// A channel that tows of other programs do not have.
const OF_FORCE: &str = "the channel force of a force sensor (method = \"steady\" reads f_x)";

/// What is declared of the data, or of the channels that are read, and would be passed over: segments that are not used among it.
pub(crate) fn not_applied(
    run: &ImportedRun,
    is_read: &dyn Fn(&str) -> bool,
    is_used: &dyn Fn(&Segment) -> bool,
) -> Option<String> {
    let Declarations { jumps: _, clocks, frames, cell, marks, segments } = &run.declared;
    let sections = [
        ("[clocks]", !clocks.is_empty()),
        ("[frames]", !frames.is_empty()),
        ("[cell]", cell.is_some()),
        ("[[marks]]", !marks.is_empty()),
        ("one of the [[segments]]", segments.iter().any(|segment| !is_used(segment))),
    ];
    let sections = sections.into_iter().find(|(_, is)| *is).map(|(section, _)| section.to_owned());
    let sensor = || {
        run.told
            .iter()
            .find(|(name, told)| is_read(name) && !told.sensor.is_silent())
            .map(|(name, _)| format!("range, resolution, filter or delay of {name}"))
    };
    let clock = || {
        let mut channels = run.log.channels.iter();
        channels
            .find(|(name, channel)| is_read(name) && !is_own(&channel.meaning.clock))
            .map(|(name, channel)| format!("the clock {:?} of {name}", channel.meaning.clock))
    };
    sections.or_else(sensor).or_else(clock)
}

/// Why a log gives no run.
enum Unread {
    /// Something is declared wrongly.
    Refused(MethodError),
    /// It alone has no steady part.
    LeftOut(String),
}

/// A log as a run of a carriage: cut to the part between gaps that holds its speed, with that stretch as the segment `steady`.
fn run_of(tow: Tow, rig: &LogsRig) -> Result<RunLog, Unread> {
    let Tow { role, speed_m_s, imported, .. } = tow;
    let ImportedRun { mut log, declared, .. } = imported;
    let refused = |what: String| Unread::Refused(MethodError::input(&log.path, what));
    let (drive, other, write) = if rig.is_current {
        ("y/current", "y/command", "i = { name = \"current\", unit = \"A\" }")
    } else {
        ("y/command", "y/current", "u = { name = \"command\", unit = \"V\" }")
    };
    for (name, write) in [
        ("y/position", "enc = { name = \"position\", scale = \"count\" } with count = \"0.1 mm\" in [constants]"),
        (drive, write),
    ] {
        if !log.channels.contains_key(name) {
            let known = name.trim_start_matches("y/");
            return Err(refused(format!(
                "no column is its {known}: write {write}, for example, in [columns] of its sidecar"
            )));
        }
    }
    if let Some(what) = wild::sample(&log, &[]) {
        return Err(Unread::LeftOut(format!("{what}; check the sensor and its cable, and repeat the run")));
    }
    log.channels.shift_remove(other);
    let position = column(&log, "y/position", Dimension::LENGTH).map_err(Unread::Refused)?;
    let dimension = if rig.is_current { Dimension::CURRENT } else { Dimension::VOLTAGE };
    let command = column(&log, drive, dimension).map_err(Unread::Refused)?;
    let segment = declared.segments.iter().find(|segment| segment.kind == SegmentKind::Steady);
    let Held { part, steady, local_m_s } =
        held(&log.time_s, position, speed_m_s, segment.map(|s| [s.from_s, s.to_s])).map_err(Unread::LeftOut)?;
    let (first, last) = (steady.start, steady.end - 1);
    let mean_m_s = (position[last] - position[first]) / (log.time_s[last] - log.time_s[first]);
    let direction = if mean_m_s > 0.0 { Direction::Forward } else { Direction::Backward };
    let drive_mean = command[steady.clone()].iter().sum::<f64>() / steady.len() as f64;
    if drive_mean * direction.sign() <= 0.0 {
        return Err(refused(format!(
            "its {} is {} {} on average while its position {}: the command opposes the motion. If this holds for all runs, set sign = -1 for one of the two columns; \
             if only for one direction, the log stores magnitudes and the sign must come from the drive",
            drive.trim_start_matches("y/"),
            significant(drive_mean, 3),
            if rig.is_current { "A" } else { "V" },
            if mean_m_s > 0.0 { "rises" } else { "falls" },
        )));
    }
    let is_steady = |i: usize| steady.contains(&(part.start + i));
    let reference = |(i, v): (usize, &f64)| match v {
        _ if is_steady(i) => mean_m_s,
        v if v.abs() < AT_REST * speed_m_s => 0.0,
        v => *v,
    };
    let values: Vec<f64> = local_m_s.iter().enumerate().map(reference).collect();
    let (from_s, to_s) = (log.time_s[first], log.time_s[last]);
    let end_s = log.time_s.get(part.end).copied().unwrap_or(f64::INFINITY);
    let mut log = log.between(log.time_s[part.start], end_s);
    let meaning = Meaning::of("y/reference_velocity", "m/s", LOG);
    log.channels.insert("y/reference_velocity".to_owned(), Channel { meaning, values });
    log.lost.clear();
    let note = if segment.is_some() { "declared" } else { "by the position" }.to_owned();
    log.meta.declared.segments = vec![Segment { kind: SegmentKind::Steady, from_s, to_s, by: String::new(), note }];
    TOW.clone_into(&mut log.meta.method);
    log.meta.role = role;
    log.meta.mounted.body = if role == Role::Wet { BodyState::Wet } else { BodyState::Dry };
    log.meta.mounted.is_ballasted = rig.is_ballasted;
    log.meta.carriage.target_speed_m_s = Some(speed_m_s);
    log.meta.carriage.direction = Some(direction);
    Ok(log)
}

/// Which way the runs of each word of a list go.
#[derive(Default)]
struct Directions {
    first: IndexMap<String, (PathBuf, Option<Direction>)>,
}

impl Directions {
    fn agree(&mut self, path: &Path, word: &str, direction: Option<Direction>) -> Result<(), MethodError> {
        if word.is_empty() {
            return Ok(());
        }
        let (first, its) = self.first.entry(word.to_owned()).or_insert_with(|| (path.to_owned(), direction));
        if *its == direction {
            return Ok(());
        }
        let words =
            |direction: &Option<Direction>| if *direction == Some(Direction::Forward) { "rises" } else { "falls" };
        Err(MethodError::input(
            path,
            format!(
                "it is listed as {word:?} and its position {}, while that of {}, also {word:?}, {}: correct the list, or the sign of the position",
                words(&direction),
                first.display(),
                words(its)
            ),
        ))
    }
}

/// Gives each run its pair: the repeat that its list states.
fn pair(logs: &mut [RunLog], settings: &[(Option<PathBuf>, String)]) -> Result<(), MethodError> {
    let mut repeats: Vec<&str> = Vec::new();
    for (log, (list, repeat)) in logs.iter_mut().zip(settings) {
        if repeat.is_empty() && settings.iter().any(|(_, other)| !other.is_empty()) {
            let place = list.as_ref().unwrap_or(&log.path);
            return Err(MethodError::input(
                place,
                format!("the repeat of {} is blank, and other runs have one", log.path.display()),
            ));
        }
        let pair = repeats.iter().position(|known| known == repeat).unwrap_or_else(|| {
            repeats.push(repeat);
            repeats.len() - 1
        });
        log.meta.carriage.pair = u32::try_from(pair + 1).ok();
    }
    let setting = |log: &RunLog| {
        let facts = &log.meta.carriage;
        (log.meta.role, facts.target_speed_m_s.map(f64::to_bits), facts.direction, facts.pair)
    };
    for (i, log) in logs.iter().enumerate() {
        if let Some(first) = logs[..i].iter().find(|other| setting(other) == setting(log)) {
            let place = settings[i].0.as_ref().unwrap_or(&log.path);
            return Err(MethodError::input(
                place,
                format!(
                    "{} and {} are both {} runs at {} m/s in one direction, and one repeat: write a column repeat (1, 2, …) that says which wet and \
                     dry runs belong together",
                    first.path.display(),
                    log.path.display(),
                    log.meta.role.name(),
                    log.meta.carriage.target_speed_m_s.unwrap_or(f64::NAN)
                ),
            ));
        }
    }
    Ok(())
}

/// Runs that a list names and that are not there.
fn not_there(declared_by: &[PathBuf], all: &[PathBuf]) -> Result<Option<Finding>, MethodError> {
    let mut missing = Vec::new();
    for list in declared_by.iter().filter(|path| path.extension().is_none_or(|e| e != "toml")) {
        let table = read_table(list, None)?;
        let is_there = |file: &str| all.iter().any(|log| log.file_name() == Path::new(file).file_name());
        missing.extend(table.text("file")?.iter().filter(|file| !is_there(file)).cloned());
    }
    Ok((!missing.is_empty()).then(|| {
        let text =
            format!("{} listed and not there: {}", counted(missing.len(), "log is", "logs are"), missing.join(", "));
        Finding::new(Severity::Warning, "campaign-unfinished", text)
    }))
}

/// Runs whose speed still changes where they are steady.
fn speed_drifts(logs: &[RunLog]) -> Result<Option<Finding>, MethodError> {
    let mut drifting: Vec<(f64, &str)> = Vec::new();
    for log in logs {
        let Some(Segment { from_s, to_s, .. }) = log.meta.declared.segments.first() else { continue };
        let rows = log.time_s.partition_point(|t| t < from_s)..log.time_s.partition_point(|t| t <= to_s);
        let position_m = column(log, "y/position", Dimension::LENGTH)?;
        drifting.extend(drift(&log.time_s[rows.clone()], &position_m[rows]).map(|part| (part, log.meta.id.as_str())));
    }
    let worst = drifting.iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    Ok(worst.map(|(part, id)| {
        let text = format!(
            "in {} of {} the speed still changes over the steady window, by up to {} ({id}); the drag is off by the difference of the forces that accelerate wet and dry (too small where the dry run accelerates more). Tow further, or hold the \
             speed with a loop",
            drifting.len(),
            counted(logs.len(), "run", "runs"),
            percent(part.abs())
        );
        Finding::new(Severity::Warning, "speed-drifts", text)
    }))
}

fn steady_by_position() -> Finding {
    let settle_s = SteadySettings::default().settle_s;
    let text = format!(
        "no reference speed is used of logs of another program: a run is steady where its position, differenced over {SPAN_S} s, keeps its median speed within {}, less {settle_s} s \
         at the start and {CORNER_S} s at the end, unless [[segments]] declare it",
        percent(HELD_WITHIN)
    );
    Finding::new(Severity::Note, "steady-by-position", text)
}
