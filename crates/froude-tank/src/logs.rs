//! Logs of other programs as the runs of a tank method: a folder with one log per run, each with a sidecar that states what it is.
//!
//! Nothing about a channel is taken for granted: unit, sign, frame and clock are declared, or the run is refused.

use std::path::Path;

use froude_identify::method::MethodError;
use froude_identify::runs::{logs_in, recorded_in, refuse_others};
use froude_identify::source::ReadFile;
use froude_records::finding::{Finding, Severity};
use froude_records::run::{Channel, ImportedRun, Role};
use froude_records::units::Dimension;

use crate::long_logs::{self, LENGTHS, Lengths};

/// The logs of a folder that a method uses.
pub(crate) struct Logs {
    pub runs: Vec<ImportedRun>,
    pub files: Vec<ReadFile>,
    pub findings: Vec<Finding>,
}

/// Every log of a folder whose role is one of `roles`; `channels` says in words what a log of `method` has beside the time.
pub(crate) fn read(
    folder: &Path,
    method: &str,
    roles: &[Role],
    channels: &str,
    progress: &dyn Fn(&str),
) -> Result<Logs, MethodError> {
    read_averaging(folder, method, roles, channels, LENGTHS, progress)
}

/// The same, with other lengths of what is averaged.
pub(crate) fn read_averaging(
    folder: &Path,
    method: &str,
    roles: &[Role],
    channels: &str,
    lengths: Lengths,
    progress: &dyn Fn(&str),
) -> Result<Logs, MethodError> {
    if folder.is_file() {
        return Err(MethodError::input(
            folder,
            "`runs` is a folder with one log per run; put the logs that are meant into a folder of their own",
        ));
    }
    let paths = logs_in(folder)?;
    if paths.is_empty() {
        refuse_others(folder, method, &recorded_in(folder)?)?;
        let what = format!(
            "no runs: put one log per run there, as CSV or Parquet with {channels}, each with a sidecar (.toml)"
        );
        return Err(MethodError::input(folder, what));
    }
    let mut out = Logs { runs: Vec::new(), files: Vec::new(), findings: Vec::new() };
    let readings = long_logs::readings(&paths, lengths);
    for (path, reading) in paths.into_iter().zip(readings) {
        let log = long_logs::import(&path, reading, progress)?;
        let meta = &log.log.meta;
        if meta.method != method {
            let found = if meta.method.is_empty() {
                "states no method".to_owned()
            } else {
                format!("is a run of {}", meta.method)
            };
            let what = format!(
                "{found}; write method = \"{method}\", role = \"test\" and [mounted] configuration at the head of {}",
                path.with_extension("toml").display()
            );
            return Err(MethodError::input(path, what));
        }
        out.findings.extend(log.findings.iter().filter(|f| f.severity > Severity::Note).cloned());
        let role = meta.role;
        if !roles.contains(&role) {
            let text = format!("{}: a run of the role {} is not used by {method}", path.display(), role.name());
            out.findings.push(Finding::new(Severity::Warning, "run-left-out", text));
            continue;
        }
        out.findings.extend(long_logs::note(&log));
        let sidecar = path.with_extension("toml");
        out.files.push(ReadFile::new(path, role.name()));
        if sidecar.exists() {
            out.files.push(ReadFile::new(sidecar, "sidecar"));
        }
        out.runs.push(log);
    }
    Ok(out)
}

/// A channel that is declared in full; `why` says what a guess would cost, `along` what its sign is that of.
pub(crate) fn channel<'a>(
    log: &'a ImportedRun,
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
    let mapping = log.sidecar.iter().flat_map(|s| s.columns.values()).find(|column| column.name == name);
    let undeclared = mapping.map_or_else(|| vec!["unit", "sign", "frame", "clock"], |m| m.undeclared.clone());
    if undeclared.is_empty() {
        return Ok(channel);
    }
    let place = mapping.map_or_else(|| log.log.path.display().to_string(), |m| m.place.to_string());
    Err(MethodError::Undeclared {
        place,
        what: format!(
            "{name} states no {}; {why}: write {{ name = \"{name}\", unit = \"…\", sign = 1, frame = \"body\", clock = \"log\" }}, sign being that of \
             {along}",
            undeclared.join(", no ")
        ),
    })
}

/// A condition that a run was done in; `None` where it declares none.
pub(crate) fn condition(log: &ImportedRun, name: &str, dimension: Dimension) -> Result<Option<f64>, MethodError> {
    match log.log.meta.conditions.get(name) {
        None => Ok(None),
        Some(found) if found.unit == dimension.to_string() => Ok(Some(found.value)),
        Some(found) => Err(MethodError::input(
            &log.log.path,
            format!("[conditions] {name} is in {}, and is {}", found.unit, dimension.describe()),
        )),
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
