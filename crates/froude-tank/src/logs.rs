//! Logs of other programs as the runs of a tank method: a folder with one log per run, each with a sidecar that states what it is.
//!
//! Nothing about a channel is taken for granted: unit, sign, frame and clock are declared, or the run is refused. What a sidecar declares of the data is done to
//! them when they are read ([`crate::conditioning`]), so that every method gets channels that it can use.

use std::ops::Range;
use std::path::{Path, PathBuf};

use froude_identify::dataset::distinct as distinct_texts;
use froude_identify::method::MethodError;
use froude_identify::runs::{files, logs_in, recorded_in, refuse_others};
use froude_identify::source::ReadFile;
use froude_identify::wild;
use froude_records::RecordError;
use froude_records::campaign::{BudgetEntry, Shared, Source};
use froude_records::finding::{Finding, Severity};
use froude_records::nearest::suggestion;
use froude_records::run::clocks::is_own;
use froude_records::run::step::Step;
use froude_records::run::{Channel, Role, RunReader, RunStatus, read_run_meta};
use froude_records::sidecar_file::{joined_files, sidecar_path, to_be_named};
use froude_records::text::counted;
use froude_records::units::Dimension;
use indexmap::IndexMap;

use crate::conditioning;
use crate::error::{TankError, undeclared};
use crate::findings::{note, warning};
use crate::log::TankLog;
use crate::long_logs::{self, LENGTHS, Lengths, Reading};
use crate::motion::Motion;
use crate::recorded::recorded_run;

/// The logs of a folder that a method uses.
pub(crate) struct Logs {
    pub runs: Vec<TankLog>,
    pub files: Vec<ReadFile>,
    pub findings: Vec<Finding>,
}

/// Which logs of a folder a method reads.
pub(crate) struct Wanted<'a> {
    /// The method that they are of.
    pub method: &'a str,
    /// Where a log need not state what it is: its role in the list of files of a record. It is of this method, in the first of `roles`, and used as far as it goes.
    pub assumed: Option<&'a str>,
    /// Their roles.
    pub roles: &'a [Role],
    /// What a log has, in words.
    pub channels: &'a str,
    /// What is averaged.
    pub lengths: Lengths,
}

impl<'a> Wanted<'a> {
    /// Logs that state what they are.
    pub(crate) const fn of(method: &'a str, roles: &'a [Role], channels: &'a str) -> Self {
        Self { method, assumed: None, roles, channels, lengths: LENGTHS }
    }
}

/// Every log of a folder that is wanted.
pub(crate) fn read(folder: &Path, wanted: &Wanted<'_>, progress: &dyn Fn(&str)) -> Result<Logs, MethodError> {
    let Wanted { method, assumed, roles, channels, lengths } = *wanted;
    if folder.is_file() {
        return Err(MethodError::input(
            folder,
            "`runs` is a folder with one log per run; put the logs that are meant into a folder of their own",
        ));
    }
    let paths = paths_in(folder, method)?;
    if paths.is_empty() {
        refuse_others(folder, method, &recorded_in(folder)?)?;
        let sidecar = if assumed.is_none() { ", each with a sidecar (.toml)" } else { "" };
        let named = to_be_named(folder);
        let what =
            format!("no runs: put one log per run there, as CSV, Parquet or MCAP with {channels}{sidecar}{named}");
        return Err(MethodError::input(folder, what));
    }
    let mut out = Logs { runs: Vec::new(), files: Vec::new(), findings: Vec::new() };
    let mut of_logs: Vec<(PathBuf, Finding)> = Vec::new();
    let readings = long_logs::readings(&paths, lengths);
    for (path, reading) in paths.into_iter().zip(readings) {
        let mut log = imported(&path, reading, progress)?;
        let meta = &mut log.log.meta;
        if assumed.is_some() && (meta.method.is_empty() || meta.method == method) {
            (meta.method, meta.role, meta.status) = (method.to_owned(), roles[0], RunStatus::Complete);
        }
        if meta.method.is_empty() {
            let what = format!(
                "states no method; write method = \"{method}\", role = \"{}\" and [mounted] configuration at the head of {}",
                roles.first().map_or("test", |role| role.name()),
                path.with_extension("toml").display()
            );
            return Err(MethodError::input(path, what));
        }
        if meta.method != method {
            let what = format!(
                "is a run of {}, and {method} is read here: give its folder a source of its own, or correct method at the head of its sidecar",
                meta.method
            );
            return Err(MethodError::input(path, what));
        }
        if meta.status != RunStatus::Complete {
            let text = format!("{}: its sidecar says {}, not complete; left out", path.display(), meta.status.name());
            out.findings.push(warning("run-left-out", text));
            continue;
        }
        let role = meta.role;
        if !roles.contains(&role) {
            let text = format!("{}: a run of the role {} is not used by {method}", path.display(), role.name());
            out.findings.push(warning("run-left-out", text));
            continue;
        }
        out.findings.extend(long_logs::note(&log));
        conditioning::condition(&mut log, method)?;
        log.findings.extend(
            wild::times(&log.log.time_s, wild::SLOWEST_HZ)
                .map(|what| warning("implausible-times", format!("{}: {what}", path.display()))),
        );
        let told = log.findings.iter().filter(|f| f.severity > Severity::Note || OF_STAMPS.contains(&f.code.as_str()));
        let of_this = |finding: &Finding| Finding { message: of_file(&path, &finding.message), ..finding.clone() };
        of_logs.extend(told.map(|finding| (path.clone(), of_this(finding))));
        out.files.extend(files_of(path, assumed.unwrap_or(role.name()), &log));
        out.runs.push(log);
    }
    out.findings.extend(once(of_logs));
    out.findings.extend(copies(&out.runs));
    out.findings.extend(in_another_unit(&out.runs));
    conditioning::of_one_rig(&out.runs)?;
    out.findings.extend(of_a_calendar(&out.runs));
    Ok(out)
}

/// A log with its steps, its sidecar where there is one, and the logs that are joined to it.
pub(crate) fn files_of(path: PathBuf, role: &str, log: &TankLog) -> impl Iterator<Item = ReadFile> {
    let own = Some(path.with_extension("toml")).filter(|sidecar| sidecar.exists());
    let sidecar = own.or_else(|| sidecar_path(&path).ok().flatten());
    let joined = joined_files(&path, None).into_iter().map(|file| ReadFile::new(file, "joined"));
    let log = ReadFile { steps: log.done.clone(), ..ReadFile::new(path, role) };
    std::iter::once(log).chain(sidecar.map(|sidecar| ReadFile::new(sidecar, "sidecar"))).chain(joined)
}

/// A sentence about a log, with its file.
fn of_file(path: &Path, sentence: &str) -> String {
    let file = path.display().to_string();
    if sentence.contains(&file) { sentence.to_owned() } else { format!("{file}: {sentence}") }
}

/// Notes of a log that a reader should see: what was done to its stamps.
const OF_STAMPS: [&str; 3] = ["uneven-time-steps", "clock-unwrapped", "logs-joined"];

/// Findings of logs, without repeats: findings of one code that differ only in numbers are reported for the first log, with the number of other logs.
fn once(of_logs: Vec<(PathBuf, Finding)>) -> Vec<Finding> {
    let mut causes: IndexMap<(String, Vec<String>), Vec<(PathBuf, Finding)>> = IndexMap::new();
    for (path, finding) in of_logs {
        let text = finding.message.replace(&path.display().to_string(), "");
        let is_number = |word: &str| word.trim_matches(|c: char| !c.is_ascii_digit()).parse::<f64>().is_ok();
        let words = text.split_whitespace().filter(|word| word.starts_with(char::is_alphabetic) || !is_number(word));
        let key = (finding.code.clone(), words.map(str::to_owned).collect());
        causes.entry(key).or_default().push((path, finding));
    }
    let merged = causes.into_values().flat_map(|of_cause| {
        let mut names: Vec<_> =
            of_cause.iter().filter_map(|(path, _)| path.file_name().map(std::ffi::OsStr::to_owned)).collect();
        names.dedup();
        if names.len() < MANY_LOGS {
            return of_cause.into_iter().map(|(_, finding)| finding).collect::<Vec<_>>();
        }
        let shown: Vec<_> = names[1..MANY_LOGS].iter().map(|name| name.to_string_lossy()).collect();
        let more =
            if names.len() > MANY_LOGS { format!(" and {} more", names.len() - MANY_LOGS) } else { String::new() };
        let first = of_cause.into_iter().next().map(|(_, finding)| finding);
        let add = |f: Finding| Finding {
            message: format!("{}; likewise, with other numbers, {}{more}", f.message, shown.join(", ")),
            ..f
        };
        first.map(add).into_iter().collect()
    });
    merged.collect()
}

/// Logs from which on one finding stands for all; so many are named.
const MANY_LOGS: usize = 4;

/// Refuses runs of different configurations, which have different coefficients.
pub(crate) fn one_body(logs: &[TankLog]) -> Result<(), MethodError> {
    let name = |log: &TankLog| log.log.meta.configuration.clone();
    let of_body = || logs.iter().filter(|log| log.log.meta.role != Role::Tare);
    let Some(first) = of_body().next() else { return Ok(()) };
    match of_body().find(|log| name(log) != name(first)) {
        None => Ok(()),
        Some(other) => {
            let what = format!(
                "is of the configuration {:?} where {} is of {:?}; the coefficients are of one body: give each a folder and a [[source]] of its own",
                name(other),
                first.log.meta.id,
                name(first)
            );
            Err(MethodError::input(&other.log.path, what))
        }
    }
}

/// That the times of some logs are counted from their first samples, said once.
pub(crate) fn of_a_calendar(logs: &[TankLog]) -> Option<Finding> {
    let has_it = |log: &&TankLog| log.done.iter().any(|step| step.step == conditioning::times::STEP);
    let first = logs.iter().find(has_it)?;
    let text = format!(
        "the times of {} are calendar times and are counted from the first sample of each, in the analysis and in the report",
        counted(logs.iter().filter(has_it).count(), "log", "logs")
    );
    let text = if logs.len() == 1 { format!("{}: {text}", first.log.path.display()) } else { text };
    Some(note("times-from-start", text))
}

/// Refuses an entry of the budget that not all runs share: these methods have one gain for all.
///
/// # Errors
///
/// `shared` is another than `campaign`.
pub(crate) fn is_of_all_runs(entry: &BudgetEntry) -> Result<(), MethodError> {
    if entry.shared == Shared::Campaign {
        return Ok(());
    }
    let what = format!(
        "shared = {:?} of {} is not used here: this method counts one error that all runs share, which does not average down; write shared = \"campaign\", \
         or leave the entry out where the scatter of the runs shows it",
        entry.shared.name(),
        entry.quantity
    );
    Err(undeclared(&entry.place, what))
}

/// The logs of a folder, in the order of their names: those of other programs, and those of `method` that Froude recorded.
///
/// # Errors
///
/// A folder that cannot be listed, or one run in two files.
pub(crate) fn paths_in(folder: &Path, method: &str) -> Result<Vec<PathBuf>, MethodError> {
    let mut out = logs_in(folder)?;
    for path in files(&[folder.to_owned()])? {
        if path.is_file() && recorded_of(&path)?.is_some_and(|of| of == method) {
            out.push(path);
        }
    }
    out.sort();
    if let Some(pair) = out.windows(2).find(|pair| pair[0].with_extension("") == pair[1].with_extension("")) {
        let what = format!(
            "is one run with {}: a run that counts twice makes every interval too narrow; keep one of them",
            pair[0].display()
        );
        return Err(MethodError::input(&pair[1], what));
    }
    Ok(out)
}

/// The method that a recorded run says it is of; an error where another program recorded it.
fn recorded_of(log: &Path) -> Result<Option<String>, MethodError> {
    let sidecar = log.with_extension("toml");
    let meta = if sidecar.exists() {
        read_run_meta(&sidecar).ok()
    } else {
        match RunReader::open(log) {
            Err(error @ RecordError::ForeignLog { .. }) => return Err(error.into()),
            read => read.and_then(RunReader::read_all).ok().map(|log| log.meta),
        }
    };
    Ok(meta.map(|meta| meta.method))
}

/// Reads a log of any kind; one that Froude recorded as it is.
///
/// # Errors
///
/// A log that cannot be read, one that is damaged, or another than its sidecar's.
pub(crate) fn imported(path: &Path, reading: Reading, progress: &dyn Fn(&str)) -> Result<TankLog, MethodError> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("mcap")) {
        return long_logs::import(path, reading, progress);
    }
    let log = recorded_run(path)?;
    match log.findings.iter().find(|finding| finding.severity == Severity::Error) {
        Some(doubt) => Err(MethodError::NoSet { first: doubt.message.clone(), more: 0 }),
        None => Ok(log),
    }
}

/// Adds a step to those of the file of a run.
pub(crate) fn add_step(files: &mut [ReadFile], log: &TankLog, step: Step) {
    if let Some(file) = files.iter_mut().find(|file| file.path == log.log.path) {
        file.steps.push(step);
    }
}

/// A run that moves so many times as far as every other is in another unit: mm under [m] is a factor of 1000.
const ANOTHER_UNIT: f64 = 200.0;
/// Channels that a test moves.
const MOVED: [&str; 6] = ["position", "y/position", "sway", "heave", "angle", "speed"];

/// Runs whose motion is orders of magnitude larger, or smaller, than that of every other run of their role.
fn in_another_unit(logs: &[TankLog]) -> Vec<Finding> {
    let range = |log: &TankLog, name: &str| {
        let values = &log.log.channels.get(name)?.values;
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        Some(high - low).filter(|range| *range > 0.0)
    };
    let mut out = Vec::new();
    for name in MOVED {
        for (k, log) in logs.iter().enumerate() {
            let alike =
                logs.iter().enumerate().filter(|(j, other)| *j != k && other.log.meta.role == log.log.meta.role);
            let others: Vec<f64> = alike.filter_map(|(_, other)| range(other, name)).collect();
            let (low, high) = others.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(*x), b.max(*x)));
            let Some(own) = range(log, name).filter(|_| others.len() >= FEWEST_OTHERS) else { continue };
            if own > ANOTHER_UNIT * high || own < low / ANOTHER_UNIT {
                let unit = log.log.channels.get(name).map_or("", |channel| channel.meaning.unit.as_str());
                let text = format!(
                    "{}: the range of {name} is {own:.3e} {unit}, that of the other runs {low:.3e} to {high:.3e} {unit}: check its unit (mm under [m] is a factor of 1000)",
                    log.log.path.display()
                );
                out.push(warning("run-stands-out", text));
            }
        }
    }
    out
}

/// Fewest runs that say what is usual.
const FEWEST_OTHERS: usize = 2;

/// Logs with the same samples: one run that counts as several.
fn copies(logs: &[TankLog]) -> Vec<Finding> {
    let is_copy = |a: &TankLog, b: &TankLog| {
        a.log.time_s == b.log.time_s
            && a.log.channels.len() == b.log.channels.len()
            && a.log.channels.iter().zip(&b.log.channels).all(|((_, x), (_, y))| x.values == y.values)
    };
    let of = |(k, log): (usize, &TankLog)| {
        let first = logs[..k].iter().find(|earlier| is_copy(earlier, log))?;
        let text = format!(
            "{} has the same samples as {}: one run counts twice, and every interval is too narrow; remove one of them, or put the log there that is meant",
            log.log.path.display(),
            first.log.path.display()
        );
        Some(Finding::new(Severity::Error, "copied-log", text))
    };
    logs.iter().enumerate().filter_map(of).collect()
}

/// Configurations of the runs, in order of first appearance.
pub(crate) fn configurations(logs: &[TankLog]) -> Vec<String> {
    distinct_texts(&logs.iter().map(|log| log.log.meta.configuration.clone()).collect::<Vec<_>>())
}

/// Standard uncertainty of what lies between the stamps of two channels of a run, s.
pub(crate) fn stamps_standard_s(log: &TankLog, channels: [&str; 2]) -> f64 {
    let [a, b] = channels.map(|name| log.told.get(name).map_or(0.0, |told| told.time_standard_s));
    a.hypot(b)
}

/// The clock, the delay and the join by which the stamps of a channel were moved.
pub(crate) fn lateness<'a>(log: &'a TankLog, channel: &str) -> Vec<&'a str> {
    let is_it = |step: &&Step| step.channel == channel && ["clock", "delay", "join"].contains(&step.step.as_str());
    log.done.iter().filter(is_it).map(|step| step.words.as_str()).collect()
}

/// The window of a log that is used; `words` follow its ends.
pub(crate) fn window_step(log: &TankLog, rows: &Range<usize>, words: &str) -> Step {
    let (from_s, to_s) = (log.log.time_s[rows.start], log.log.time_s[rows.end - 1]);
    let words = format!("{from_s:.3} s to {to_s:.3} s{words}");
    Step::new("window", "", words).with("from", from_s, "s").with("to", to_s, "s")
}

/// The cycles that are used of a run, as a step.
pub(crate) fn cycles_step(log: &TankLog, motion: &Motion, moved: &str) -> Step {
    let but = if motion.dropped == 0 { String::new() } else { format!(", but {} that a mark touches", motion.dropped) };
    let period_s = motion.angle.period_s();
    let words = format!(": {} whole cycles{but}; {moved} by harmonics of {period_s:.4} s", motion.whole);
    let step = window_step(log, &motion.samples(), &words).with("cycles", motion.whole as f64, "1");
    step.with("dropped", motion.dropped as f64, "1").with("period", period_s, "s")
}

/// A channel that is declared in full and has the log's times; `why` says what a guess would cost, `along` what its sign is that of.
pub(crate) fn channel<'a>(
    log: &'a TankLog,
    name: &str,
    dimension: Dimension,
    why: &str,
    along: &str,
) -> Result<&'a Channel, MethodError> {
    let channel = of_any_clock(log, name, dimension, why, along)?;
    let clock = &channel.meaning.clock;
    if is_own(clock) {
        return Ok(channel);
    }
    let place = log.told.get(name).map_or_else(|| log.log.path.display().to_string(), |told| told.place.to_string());
    let what = format!(
        "{name} has the clock {clock:?}, which cannot be aligned with that of the log: declare [clocks.{clock}] {}, or write clock = \"log\" where the log's own times are meant",
        "{ offset = \"12 ms\", skew = \"0 ms/s\", standard = \"1 ms\", found = \"by …\" }"
    );
    Err(undeclared(place, what))
}

/// The same of a channel whose clock may be one that nobody knows: to be compared with another, and for nothing else.
pub(crate) fn of_any_clock<'a>(
    log: &'a TankLog,
    name: &str,
    dimension: Dimension,
    why: &str,
    along: &str,
) -> Result<&'a Channel, MethodError> {
    let channel = log.log.channels.get(name).filter(|c| c.meaning.unit == dimension.to_string()).ok_or_else(|| {
        let there: Vec<&str> = log.log.channels.keys().map(String::as_str).collect();
        let there = if there.is_empty() { "nothing beside the time".to_owned() } else { there.join(", ") };
        MethodError::input(
            &log.log.path,
            format!("a run needs the channel {name} ({}), and has {there}", dimension.describe()),
        )
    })?;
    let told = log.told.get(name);
    let unstated = told.map_or_else(|| vec!["unit", "sign", "frame", "clock"], |told| told.undeclared.clone());
    if unstated.is_empty() {
        return Ok(channel);
    }
    let place = told.map_or_else(|| log.log.path.display().to_string(), |told| told.place.to_string());
    let what = format!(
        "{name} states no {}; {why}: write {{ name = \"{name}\", unit = \"…\", sign = 1, frame = \"body\", clock = \"log\" }}, sign being that of \
         {along}",
        unstated.join(", no ")
    );
    Err(undeclared(place, what))
}

/// A condition that a run was done in; `None` where it declares none.
pub(crate) fn condition(log: &TankLog, name: &str, dimension: Dimension) -> Result<Option<f64>, MethodError> {
    match log.log.meta.conditions.get(name) {
        None => Ok(None),
        Some(found) if found.unit == dimension.to_string() => Ok(Some(found.value)),
        Some(found) => Err(MethodError::input(
            &log.log.path,
            format!("[conditions] {name} is in {}, and is {}", found.unit, dimension.describe()),
        )),
    }
}

/// Conditions of the water, which every method's log may state.
const OF_WATER: [&str; 3] = ["temperature", "density", "kinematic_viscosity"];

/// Refuses a condition that the method does not know: passed over, a misspelt angle would be none.
///
/// # Errors
///
/// The first such condition, with the nearest name.
pub(crate) fn only_conditions<'n>(
    log: &TankLog,
    known: impl Iterator<Item = &'n str> + Clone,
) -> Result<(), MethodError> {
    let names = || known.clone().chain(OF_WATER);
    match log.log.meta.conditions.keys().find(|name| !names().any(|known| known == name.as_str())) {
        Some(unknown) => {
            let what = format!("[conditions] {unknown} is not known here; {}", suggestion(unknown, names()));
            Err(MethodError::input(&log.log.path, what))
        }
        None => Ok(()),
    }
}

/// What several fits state alike is reported once.
pub(crate) fn distinct(findings: Vec<Finding>) -> Vec<Finding> {
    let mut out: Vec<Finding> = Vec::new();
    for finding in findings {
        if !out.contains(&finding) {
            out.push(finding);
        }
    }
    out
}

/// That nothing is left to fit: why the first run was left out, or that there is none.
pub(crate) fn no_run(source: &Source, first: Option<TankError>) -> MethodError {
    let none = "no run of the role test: what is fitted has role = \"test\" in its sidecar";
    first.map_or_else(|| MethodError::input(source.input.path(), none), MethodError::refused)
}

pub(crate) fn left_out(why: &TankError) -> Finding {
    warning("run-left-out", format!("left out: {why}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 36 logs whose steps are coarser than their noise are one finding; what is of another channel, or of few logs, stands by itself.
    #[test]
    fn one_cause_in_many_logs_is_one_finding() {
        let of = |k: usize, channel: &str| {
            let path = PathBuf::from(format!("runs/{k}.csv"));
            let text = format!("{}: {channel} is read in steps of 0.{k} N", path.display());
            (path, Finding::new(Severity::Warning, "quantised", text))
        };
        let many = (1..=36).map(|k| of(k, "f_1")).chain((1..=2).map(|k| of(k, "f_2")));
        let found = once(many.collect());
        assert_eq!(found.len(), 3, "{found:?}");
        assert_eq!(
            found[0].message,
            "runs/1.csv: f_1 is read in steps of 0.1 N; likewise, with other numbers, 2.csv, 3.csv, 4.csv and 32 more"
        );
        assert!(!found[1].message.contains("likewise") && found[2].message.starts_with("runs/2.csv: f_2"), "{found:?}");
    }
}
