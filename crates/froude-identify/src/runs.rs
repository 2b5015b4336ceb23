//! Folders of runs, whatever method they are of: which logs lie there, and of which method they say they are.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use froude_records::manifest::MANIFEST;
use froude_records::run::{CAMPAIGN_COPY, RunMeta, RunReader, TOW, read_run_meta};
use froude_records::sidecar_file::{is_part, sidecar_path};
use froude_records::text::counted;

use crate::method::MethodError;

/// The logs, sorted by name; of a folder also those that its sidecars say should be there. A sidecar that is named stands for its log.
///
/// # Errors
///
/// A path that does not exist, a folder that cannot be listed.
pub fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, MethodError> {
    let mut out = Vec::new();
    for path in paths {
        if path.is_dir() {
            let mut own: Vec<PathBuf> = listed(path)?.into_iter().filter_map(log_of).collect();
            own.sort();
            own.dedup();
            out.append(&mut own);
        } else if path.exists() {
            match log_of_sidecar(path) {
                // `ID.*` names both.
                Some(log) if paths.contains(&log) => {}
                Some(log) => out.push(log),
                None => out.push(path.clone()),
            }
        } else {
            return Err(MethodError::input(path, "there is no such folder or run"));
        }
    }
    out.sort();
    Ok(out)
}

fn listed(folder: &Path) -> Result<Vec<PathBuf>, MethodError> {
    let entries =
        std::fs::read_dir(folder).map_err(|source| MethodError::Folder { path: folder.to_owned(), source })?;
    Ok(entries.filter_map(Result::ok).map(|e| e.path()).collect())
}

/// A file of a folder that `is_known` does not know by its name; `None` where the folder is empty or not there.
///
/// # Errors
///
/// A folder that cannot be listed.
pub fn first_other(folder: &Path, is_known: impl Fn(&str) -> bool) -> Result<Option<PathBuf>, MethodError> {
    let is_other = |path: &PathBuf| path.file_name().is_none_or(|name| !is_known(&name.to_string_lossy()));
    Ok(if folder.exists() { listed(folder)?.into_iter().find(is_other) } else { None })
}

/// The log that a sidecar belongs to; `None` for any other file.
fn log_of_sidecar(file: &Path) -> Option<PathBuf> {
    let log = file.with_extension("mcap");
    let is_toml = file.extension().is_some_and(|e| e == "toml");
    (is_toml && (log.exists() || read_run_meta(file).is_ok())).then_some(log)
}

/// The log that a file of a folder is or belongs to.
fn log_of(file: PathBuf) -> Option<PathBuf> {
    match file.extension().map(|e| e.to_string_lossy().into_owned()).as_deref() {
        Some("mcap") => Some(file),
        Some("toml") if file.file_name().is_some_and(|name| name != CAMPAIGN_COPY) => Some(file.with_extension("mcap")),
        _ => None,
    }
}

/// Endings of tables of other programs.
const OTHER_ENDINGS: [&str; 12] = ["txt", "dat", "tsv", "out", "exp", "xlsx", "xls", "ods", "mat", "h5", "tdms", "ulg"];

/// The logs of other programs in a folder, in the order of their names; none in a folder of results, whose tables are Froude's.
///
/// # Errors
///
/// A folder that cannot be listed.
pub fn logs_in(folder: &Path) -> Result<Vec<PathBuf>, MethodError> {
    if folder.join(MANIFEST).exists() {
        return Ok(Vec::new());
    }
    let has_ending = |path: &PathBuf, endings: &[&str]| {
        path.extension().is_some_and(|e| endings.iter().any(|known| e.eq_ignore_ascii_case(known)))
    };
    // Notes and workbooks lie among logs: what is no plain table counts where a sidecar says what it is.
    let is_log = |path: &PathBuf| {
        (has_ending(path, &["csv", "parquet"]) && !is_part(path))
            || (has_ending(path, &OTHER_ENDINGS) && matches!(sidecar_path(path), Ok(Some(_))))
    };
    let mut paths: Vec<PathBuf> = listed(folder)?.into_iter().filter(is_log).collect();
    paths.sort();
    Ok(paths)
}

/// The method that a run says it belongs to, in words.
#[must_use]
pub fn of_method(meta: &RunMeta) -> String {
    if meta.method.is_empty() { "no method that it states".to_owned() } else { format!("the method {}", meta.method) }
}

/// What every run in a folder states about itself, as far as it can be read.
///
/// # Errors
///
/// A folder that cannot be listed.
pub fn recorded_in(folder: &Path) -> Result<Vec<RunMeta>, MethodError> {
    let read = |log: PathBuf| {
        read_run_meta(&log.with_extension("toml"))
            .ok()
            .or_else(|| Some(RunReader::open(&log).ok()?.read_all().ok()?.meta))
    };
    Ok(files(&[folder.to_owned()])?.into_iter().filter_map(read).collect())
}

/// Refuses a folder without runs of the method that is read (`wanted`) and with others.
///
/// # Errors
///
/// [`MethodError::OfAnotherMethod`]: runs of another method, or logs of another program where tows are read.
pub fn refuse_others(folder: &Path, wanted: &str, found: &[RunMeta]) -> Result<(), MethodError> {
    let found: Vec<&RunMeta> = found.iter().filter(|meta| meta.method != wanted).collect();
    let (what, method) = match found.first() {
        Some(first) => {
            let roles: BTreeSet<&str> = found.iter().map(|meta| meta.role.name()).collect();
            let roles = roles.into_iter().collect::<Vec<_>>().join(", ");
            let runs = counted(found.len(), "run there is", "runs there are");
            (format!("{runs} of {} (role {roles})", of_method(first)), first.method.clone())
        }
        None if wanted == TOW && folder.is_dir() => match logs_in(folder)?.len() {
            0 => return Ok(()),
            n => (
                format!(
                    "{} of other programs (a table of steady runs is what froude identify FILE reads, a servo's log what froude carriage \
                     identify FILE does; wet and dry tows need a sidecar, which froude new carriage-logs begins)",
                    counted(n, "log there is", "logs there are")
                ),
                String::new(),
            ),
        },
        None => return Ok(()),
    };
    Err(MethodError::OfAnotherMethod {
        folder: folder.to_owned(),
        found: what,
        method,
        is_imported: found.is_empty(),
        wanted: wanted.to_owned(),
    })
}
