//! What is in a run, in a folder of runs or of other programs' logs, and everything doubtful about it.

use std::path::{Path, PathBuf};

use froude_identify::inspect::{ChannelFacts, ColumnFacts, Inspection};
use froude_identify::method::MethodError;
use froude_identify::runs::{files, logs_in};
use froude_records::RecordError;
use froude_records::finding::{Finding, Severity};
use froude_records::number;
use froude_records::run::{
    Block, BodyState, Doubt, DoubtKind, ImportedRun, Mounted, Role, RunMeta, RunReader, RunStatus, TOW, import_run,
    read_run, read_run_meta,
};
use froude_records::sidecar_file::to_be_named;
use froude_records::text::counted;
use froude_rig::carriage::{CarriageCampaign, Directions, RigKind};
use indexmap::IndexMap;

use super::set::{Member, doubles, is_put_aside, strangers, summed_up};
use super::topics;
use super::whole::Complete;
use super::{gone, put_aside};

/// The run that a sidecar is of, where its log is not beside it: why there is none.
///
/// # Errors
///
/// The file is no sidecar of a run.
pub fn without_log(sidecar: &Path) -> Result<MethodError, RecordError> {
    let meta = read_run_meta(sidecar)?;
    let log = sidecar.with_extension("mcap");
    let found = if is_put_aside(&log, &meta) { put_aside(&log, &meta) } else { gone(&log, &meta) };
    Ok(MethodError::NoLog { why: found.message })
}

fn times(n: usize) -> String {
    counted(n, "time", "times")
}

/// What a campaign drives and is to do; `froude run --check` has the runs one by one.
#[must_use]
pub fn driven(carriage: &CarriageCampaign) -> Vec<(String, String)> {
    let rig = match &carriage.rig.kind {
        RigKind::Twin { seed, truths } => {
            format!("twin, seed {seed}, {}", counted(truths.len(), "truth of its own", "truths of its own"))
        }
        RigKind::Serial { port, baud } => format!("board at {port}, {baud} baud"),
    };
    let [low, high] = carriage.rig.y.travel_m;
    let mut facts = vec![("rig".to_owned(), format!("{rig}; long axis from {low} m to {high} m"))];
    let Some(plan) = &carriage.plan else { return facts };
    let mut fact = |name: &str, value: String| facts.push((name.to_owned(), value));
    let speeds: Vec<String> = plan.speed_m_s.iter().map(f64::to_string).collect();
    fact("tows", format!("axis {}, {} m/s over {} m", plan.axis.name(), speeds.join(", "), plan.distance_m));
    let ways = if plan.directions == Directions::Both { "out and back" } else { "out" };
    let ballast = if plan.is_ballasted { "ballasted" } else { "not ballasted" };
    fact("pairs", format!("{} at each speed, {ways}; wet runs {ballast}", plan.repeats));
    if let Some(sweep) = &plan.friction {
        fact(
            "friction sweep",
            format!("{}, {}", counted(sweep.speed_m_s.len(), "speed", "speeds"), times(sweep.repeats)),
        );
    }
    if let Some(c) = &plan.calibration {
        let weights: Vec<String> = c.weights_n.iter().map(f64::to_string).collect();
        fact("calibration", format!("{} N over a pulley, {}", weights.join(", "), times(c.repeats)));
    }
    if let Some(part) = plan.stop_at_relative_half_width {
        fact("stops early", format!("when D_d is known within {} %", 100.0 * part));
    }
    facts
}

/// A folder of runs: how many of what, and whether the files are what they say.
///
/// # Errors
///
/// A folder that holds no runs and no logs, or cannot be read.
pub fn folder(path: &Path) -> Result<Inspection, MethodError> {
    let (mut metas, mut members, mut doubts, mut findings) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut n_aside, mut complete) = (0, Complete::default());
    let files = files(&[path.to_owned()])?;
    let shown = path.display();
    let Some(first) = files.iter().find(|file| file.exists()) else {
        let sidecars = files.iter().filter(|log| read_run_meta(&log.with_extension("toml")).is_ok()).count();
        if sidecars > 0 {
            let what = format!(
                "{} and no log: copy the .mcap files back, or froude run drives them again",
                counted(sidecars, "sidecar of a run", "sidecars of runs")
            );
            return Err(MethodError::input(path, what));
        }
        let others = logs_in(path)?;
        if !others.is_empty() {
            return Ok(logs(&others));
        }
        return Err(MethodError::input(
            path,
            format!(
                "a folder without runs; name a table (.csv, .parquet), a campaign (.toml), a record (.json) or a run (.mcap){}",
                to_be_named(path)
            ),
        ));
    };
    for file in &files {
        if !file.exists() {
            // Another file of TOML may lie in the folder.
            if let Ok(meta) = read_run_meta(&file.with_extension("toml")) {
                let is_aside = is_put_aside(file, &meta);
                n_aside += usize::from(is_aside);
                findings.push(if is_aside { put_aside(file, &meta) } else { gone(file, &meta) });
            }
            continue;
        }
        let read = RunReader::open(file).and_then(|mut reader| {
            let mut block = Block::default();
            while reader.read_block(&mut block)? {}
            Ok(reader)
        });
        match read {
            Ok(reader) if is_put_aside(file, reader.meta()) => n_aside += 1,
            Ok(reader) => {
                if reader.meta().status == RunStatus::Complete {
                    members.push(Member::of(file, reader.meta())?);
                    let is_damaged = |doubt: &Doubt| matches!(doubt.kind, DoubtKind::Damaged | DoubtKind::Exchanged);
                    if !reader.doubts().iter().any(is_damaged) {
                        complete.add(file, reader.meta());
                    }
                }
                metas.push(reader.meta().clone());
                doubts.extend_from_slice(reader.doubts());
            }
            Err(error) => findings.push(Finding::new(Severity::Error, "run-unreadable", error.to_string())),
        }
    }
    let is_grave = |doubt: &&Doubt| matches!(doubt.kind, DoubtKind::Damaged | DoubtKind::Exchanged);
    findings.extend(doubts.iter().filter(is_grave).map(Doubt::finding));
    findings.extend(doubles(&members));
    findings.extend(strangers(&members)?);
    findings.extend(summed_up(&doubts));
    findings.extend(complete.against_plan(path, &Role::ALL));
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    let each = |name: &dyn Fn(&RunMeta) -> String| {
        let mut counts: IndexMap<String, usize> = IndexMap::new();
        for meta in &metas {
            *counts.entry(name(meta)).or_default() += 1;
        }
        counts.iter().map(|(name, n)| format!("{n} {name}")).collect::<Vec<_>>().join(", ")
    };
    let aside = counted(n_aside, "more was set aside", "more were set aside");
    let aside = if n_aside == 0 { String::new() } else { format!("; {aside}") };
    let is_towed = metas.iter().any(|meta| meta.method == TOW);
    let together =
        if is_towed { format!("froude carriage drag {shown} reduces them together; ") } else { String::new() };
    let mut facts = vec![
        ("campaign".to_owned(), each(&|meta| format!("of {:?}", meta.campaign))),
        ("runs".to_owned(), each(&|meta| meta.status.name().to_owned()) + &aside),
        ("methods".to_owned(), each(&|meta| named(&meta.method).to_owned())),
        ("roles".to_owned(), each(&|meta| meta.role.name().to_owned())),
        ("next".to_owned(), format!("{together}froude inspect {} shows one", first.display())),
    ];
    // Of files that cannot be read, nothing is known.
    facts.retain(|(_, value)| !value.is_empty());
    Ok(Inspection::new("runs", facts, findings))
}

/// The method of a run as it stands in its files.
fn named(method: &str) -> &str {
    if method.is_empty() { "not stated" } else { method }
}

/// What is mounted, in words.
fn mounted(mounted: &Mounted) -> String {
    let Mounted { body, is_ballasted, hung_weight_n, travel } = mounted;
    let mut out = match body {
        BodyState::None => "no body".to_owned(),
        body => format!("body {}", body.name()),
    };
    if *is_ballasted && matches!(body, BodyState::Wet) {
        out += ", wheel load matched by ballast";
    }
    if let Some(weight_n) = hung_weight_n {
        out += &format!(", {weight_n} N over the pulley");
    }
    match (travel, body) {
        (Some(axis), _) => out += &format!(", its {} axis along the travel", axis.name()),
        (None, BodyState::None) => {}
        (None, _) => out += ", axis along the travel not declared",
    }
    out
}

/// Logs of other programs in a folder, as releases are: how long each is, and what it holds.
fn logs(paths: &[PathBuf]) -> Inspection {
    let (mut facts, mut findings) = (Vec::new(), Vec::new());
    let mut methods: Vec<String> = Vec::new();
    facts.push((
        "logs".to_owned(),
        format!("{} of other programs; the method that reads them states what they are", paths.len()),
    ));
    for path in paths {
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        match import_run(path, None) {
            Ok(ImportedRun { log, findings: own, .. }) => {
                let rate = log.sample_rate_hz().map_or_else(String::new, |hz| format!(" at {hz:.1} Hz"));
                let channels = log.channels.iter().map(|(name, c)| format!("{name} [{}]", c.meaning.unit));
                let channels = channels.collect::<Vec<_>>().join(", ");
                let stated = stated(&log.meta);
                facts.push((
                    name,
                    format!(
                        "{}{rate}, {:.3} s: {channels}{stated}",
                        counted(log.len(), "sample", "samples"),
                        log.duration_s()
                    ),
                ));
                methods.push(log.meta.method);
                findings.extend(own.into_iter().filter(|f| f.severity > Severity::Note || f.code == "logs-joined"));
            }
            Err(error) => findings.push(Finding::new(Severity::Error, "run-unreadable", error.to_string())),
        }
    }
    let next = match methods.first().map(String::as_str) {
        Some(TOW) => {
            let folder = paths.first().and_then(|path| path.parent()).unwrap_or(Path::new(".")).display();
            format!("froude carriage drag {folder} reduces them together")
        }
        Some(method) if !["", "free_decay"].contains(&method) => {
            format!("runs = \"FOLDER\" and method = \"{method}\" in a [[source]] take a folder of such runs")
        }
        _ => "runs = \"FOLDER\" and method = \"decay_envelope\" or \"decay_output_error\" in a [[source]] take a folder of releases".to_owned(),
    };
    facts.push(("next".to_owned(), next));
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    Inspection::new("logs", facts, findings)
}

/// What the sidecar of a log states about its run; nothing where it states none.
fn stated(meta: &RunMeta) -> String {
    if meta.method.is_empty() {
        return String::new();
    }
    let conditions =
        meta.conditions.iter().map(|(name, c)| format!(", {name} {} {}", number::significant(c.value, 4), c.unit));
    let mounted = if meta.configuration.is_empty() { String::new() } else { format!(", {}", meta.configuration) };
    format!("; {}, role {}{mounted}{}", meta.method, meta.role.name(), conditions.collect::<String>())
}

/// A run: what it was for, its channels, what happened, what is missing.
///
/// # Errors
///
/// A log that cannot be read.
pub fn run(path: &Path) -> Result<Inspection, MethodError> {
    let log = match read_run(path) {
        Err(RecordError::ForeignLog { .. }) => return topics::inspect(path),
        read => read?,
    };
    let meta = &log.meta;
    let mut facts: Vec<(String, String)> = Vec::new();
    let mut fact = |name: &str, value: String| facts.push((name.to_owned(), value));
    fact("run", format!("{} of campaign \"{}\"", meta.id, meta.campaign));
    fact("method", format!("{}, role {}", named(&meta.method), meta.role.name()));
    fact("mounted", mounted(&meta.mounted));
    fact("axis", meta.carriage.axis.name().to_owned());
    if let (Some(speed), Some(direction)) = (meta.carriage.target_speed_m_s, meta.carriage.direction) {
        fact("steady part", format!("{speed} m/s {}", direction.name()));
    }
    if let Some(pair) = meta.carriage.pair {
        fact("pair", pair.to_string());
    }
    let note = if meta.note.is_empty() { String::new() } else { format!(": {}", meta.note) };
    fact("status", format!("{}{note}", meta.status.name()));
    let rate = log.sample_rate_hz().map_or_else(String::new, |hz| format!(" at {hz:.1} Hz"));
    fact("samples", format!("{}{rate}, {:.3} s", log.len(), log.duration_s()));
    if let Some(clock) = &meta.clock {
        fact(
            "board clock",
            format!("time zero is {:.6} s of the host, ± {:.1e} s", clock.host_at_zero_s, clock.standard_uncertainty_s),
        );
    }
    for (name, version) in &meta.versions {
        fact("version", format!("{name} {version}"));
    }
    for event in &log.events {
        fact(&format!("{:.3} s", event.time_s), format!("{}: {}", event.kind.name(), event.text));
    }
    if let Some(recorded) = meta.log.as_ref().filter(|_| log.doubts.is_empty()) {
        fact(
            "log",
            format!(
                "{} bytes, as they were recorded (SHA-256 {}…)",
                recorded.bytes,
                recorded.sha256.get(..8).unwrap_or_default()
            ),
        );
    }
    let gaps = log.lost.iter().map(|gap| Finding::new(Severity::Warning, "run-gap", gap.text.clone()));
    let findings = log.doubts.iter().map(Doubt::finding).chain(gaps).collect();
    let columns = log
        .channels
        .iter()
        .map(|(name, c)| ColumnFacts {
            name: name.clone(),
            unit: c.meaning.unit.clone(),
            low: c.values.iter().copied().reduce(f64::min),
            high: c.values.iter().copied().reduce(f64::max),
            distinct: c.values.iter().map(|v| v.to_bits()).collect::<std::collections::BTreeSet<_>>().len(),
            channel: Some(ChannelFacts::of(&c.meaning)),
        })
        .collect();
    Ok(Inspection { columns, ..Inspection::new("run", facts, findings) })
}
