//! Which sidecar a table has: the one of its own name, or one that serves several tables of its folder.
//!
//! ```toml
//! # logs.toml
//! schema = 1
//! files = "run_*.csv"
//! list = "runs.csv"      # columns: file, role (or state), configuration, direction, repeat, and conditions such as `speed [m/s]`
//! method = "steady"
//! [columns]
//! "t (ms)" = { name = "time" }
//! ```

use std::path::{Path, PathBuf};

use wildmatch::WildMatch;

use crate::csv_table::read_csv;
use crate::error::{Place, RecordError};
use crate::join_keys::Join;
use crate::measured::Measured;
use crate::nearest::suggestion;
use crate::read;
use crate::run::meta::Role;
use crate::sidecar::{Sidecar, is_of_another_kind, is_sidecar, read_sidecar};
use crate::table::{ColumnData, Table};

/// Most files of a folder that are looked at.
const MOST_FILES: usize = 10_000;

/// The sidecar of a table: the one given, the `.toml` of the same name beside it, or the one of its folder whose `files` it fits; with what its list says of the
/// table.
///
/// # Errors
///
/// A sidecar or a list that cannot be read, two sidecars that fit, a table that is not in the list.
pub fn sidecar_of(table: &Path, given: Option<&Path>) -> Result<Option<Sidecar>, RecordError> {
    let Some(path) = given.map_or_else(|| sidecar_path(table), |given| Ok(Some(given.to_owned())))? else {
        return Ok(None);
    };
    let sidecar = read_sidecar(&path)?;
    match sidecar.list.clone() {
        Some(list) => listed(sidecar, &list, table).map(Some),
        None => Ok(Some(sidecar)),
    }
}

/// The file of the sidecar that a table has, if it has one.
///
/// # Errors
///
/// Two sidecars that fit, or one that cannot be read.
pub fn sidecar_path(table: &Path) -> Result<Option<PathBuf>, RecordError> {
    let beside = table.with_extension("toml");
    if beside.is_file() && is_sidecar(&beside) {
        return Ok(Some(beside));
    }
    let folder = table.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = table.file_name().unwrap_or_default().to_string_lossy();
    let mut found: Vec<PathBuf> = Vec::new();
    for file in std::fs::read_dir(folder).into_iter().flatten().flatten().take(MOST_FILES).map(|entry| entry.path()) {
        if file.extension().is_some_and(|e| e == "toml") && names_files(&file) {
            let pattern = read_sidecar(&file)?.files;
            found.extend(pattern.filter(|pattern| WildMatch::new(pattern).matches(&name)).map(|_| file));
        }
    }
    found.sort();
    match found.as_slice() {
        [one] if beside.is_file() && !is_of_another_kind(&beside) => Err(RecordError::Refused(format!(
            "{}: it is no sidecar (it has no [columns]), and {} describes {}: move its contents there, or make it a whole sidecar, which then replaces {} for this log",
            beside.display(),
            one.display(),
            table.display(),
            one.display()
        ))),
        [one, other, ..] => Err(RecordError::Refused(format!(
            "{}: the `files` of {} and of {} both fit it; make one of them narrower",
            table.display(),
            one.display(),
            other.display()
        ))),
        found => Ok(found.first().cloned()),
    }
}

/// Endings of logs whose columns a sidecar has to name.
const LOGS: [&str; 9] = ["mat", "h5", "hdf5", "tdms", "ulg", "txt", "dat", "tsv", "xlsx"];

/// What to write so that the files of a folder that no sidecar names are read as logs, as the rest of a sentence; empty where there are none.
#[must_use]
pub fn to_be_named(folder: &Path) -> String {
    let ending = |path: &Path| path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .take(MOST_FILES)
        .map(|entry| entry.path())
        .filter(|path| path.is_file() && LOGS.contains(&ending(path).as_str()))
        .collect();
    files.sort();
    let Some(first) = files.first() else { return String::new() };
    let sidecar = folder.join("logs.toml");
    format!(
        ". To read its {} files as logs, name their columns in a sidecar: froude inspect {} --sidecar {} --write-sidecar proposes one; then add files = \"*.{}\" at its top",
        ending(first),
        first.display(),
        sidecar.display(),
        ending(first)
    )
}

/// Whether a file has a key `files`: others beside a table do not concern it, whatever is wrong with them.
fn names_files(path: &Path) -> bool {
    let text = read::whole(path, 1 << 20, "a sidecar").unwrap_or_default();
    let is_key = |line: &str| line.split_once('=').is_some_and(|(key, _)| key.trim() == "files");
    is_sidecar(path) && String::from_utf8_lossy(&text).lines().any(is_key)
}

/// Whether a table is the list of a sidecar in its folder, or a log that one joins to another: no run itself.
#[must_use]
pub fn is_part(table: &Path) -> bool {
    let Some(folder) = table.parent() else { return false };
    let is_joined = |sidecar: &Sidecar| {
        let path = |(join, _): &(Join, _)| beside(sidecar, &join.file).to_string_lossy().into_owned();
        sidecar.joins.iter().any(|join| WildMatch::new(&path(join)).matches(&table.to_string_lossy()))
    };
    let names = |file: PathBuf| {
        file.extension().is_some_and(|e| e == "toml")
            && is_sidecar(&file)
            && read_sidecar(&file).is_ok_and(|own| own.list.as_deref() == Some(table) || is_joined(&own))
    };
    std::fs::read_dir(folder).into_iter().flatten().flatten().take(MOST_FILES).any(|entry| names(entry.path()))
}

/// A file that a sidecar names, from its own folder on.
fn beside(sidecar: &Sidecar, file: &str) -> PathBuf {
    sidecar.path.parent().unwrap_or(Path::new("")).join(file)
}

/// The logs that are joined to a table, each with its own sidecar, where it has one.
///
/// # Errors
///
/// A `*` that stands for nothing; a sidecar that cannot be read, that joins others itself, or that is the table's own.
pub fn joined(sidecar: &Sidecar, table: &Path) -> Result<Vec<(PathBuf, Option<Sidecar>)>, RecordError> {
    sidecar.joins.iter().map(|(join, inline)| one_joined(sidecar, join, inline.as_ref(), table)).collect()
}

/// The logs that are joined to a table, and the sidecars that these have of their own; none where that cannot be read.
#[must_use]
pub fn joined_files(table: &Path, given: Option<&Path>) -> Vec<PathBuf> {
    let Ok(Some(sidecar)) = sidecar_of(table, given) else { return Vec::new() };
    let files = |(path, own): (PathBuf, Option<Sidecar>)| {
        let own = own.map(|own| own.path).filter(|own| *own != sidecar.path);
        std::iter::once(path).chain(own).collect::<Vec<_>>()
    };
    joined(&sidecar, table).unwrap_or_default().into_iter().flat_map(files).collect()
}

fn one_joined(
    sidecar: &Sidecar,
    join: &Join,
    inline: Option<&Sidecar>,
    table: &Path,
) -> Result<(PathBuf, Option<Sidecar>), RecordError> {
    let refuse = |problem: String| Err(RecordError::value(join.place.clone(), "file", problem));
    let name = table.file_name().unwrap_or_default().to_string_lossy();
    let star = sidecar.files.as_deref().and_then(|files| files.split_once('*'));
    let star = star.and_then(|(before, after)| name.strip_prefix(before)?.strip_suffix(after));
    let file = match (join.file.contains('*'), star) {
        (false, _) => join.file.clone(),
        (true, Some(star)) => join.file.replace('*', star),
        (true, None) => {
            let what = "has a *, which stands for what the one * of `files` stands for; write files = \"motion_*.csv\", or name the file";
            return refuse(format!("is {:?}: it {what}", join.file));
        }
    };
    let path = beside(sidecar, &file);
    if path.as_path() == table {
        return refuse(format!("is {file:?}, the log that it is joined to; name the other log"));
    }
    if !path.is_file() {
        return refuse(format!("is {file:?}, and there is no file {}; correct the name", path.display()));
    }
    let own = inline.map_or_else(|| sidecar_of(&path, None), |own| Ok(Some(own.clone())))?;
    match &own {
        Some(own) if inline.is_none() && own.path == sidecar.path => refuse(format!(
            "is {file:?}, which `files` of this sidecar fits too; make `files` narrower, and write a sidecar for {file}, or [log.join.columns] here"
        )),
        Some(own) if !own.joins.is_empty() => refuse(format!(
            "is {file:?}, whose sidecar {} joins another log itself; write all [[log.join]] in one of them",
            own.path.display()
        )),
        _ => Ok((path, own)),
    }
}

/// A sidecar with what its list says of a table.
fn listed(mut sidecar: Sidecar, list: &Path, table: &Path) -> Result<Sidecar, RecordError> {
    // The list may have headers of its own, and a sidecar for them, which is not this one.
    let own = Some(list.with_extension("toml")).filter(|own| *own != sidecar.path && own.is_file() && is_sidecar(own));
    let own = own.map(|own| read_sidecar(&own)).transpose()?.filter(|own| own.files.is_none());
    let rows = read_csv(list, own.as_ref())?;
    let name = table.file_name().unwrap_or_default().to_string_lossy();
    let files = rows.text("file")?;
    let folder = list.parent().unwrap_or(Path::new(""));
    let is_table = |file: &str| match Path::new(file).parent() {
        Some(own) if !own.as_os_str().is_empty() => folder.join(file) == table,
        _ => Path::new(file).file_name() == table.file_name(),
    };
    let mut fitting = (0..rows.n_rows).filter(|row| files.get(*row).is_some_and(|file| is_table(file)));
    let found = fitting.next();
    if let Some(again) = fitting.next() {
        return Err(RecordError::value(
            rows.place_of_row(again),
            "file",
            format!("names {name} a second time; delete one of the rows"),
        ));
    }
    let Some(row) = found else {
        let near = suggestion(&name, files.iter().map(String::as_str));
        let problem = format!("has no row for {name}; {near}");
        return Err(RecordError::value(Place::whole(list), "file", problem));
    };
    let has_role = rows.columns.iter().any(|column| column.name == "role");
    for column in &rows.columns {
        let text = || match &column.data {
            ColumnData::Text(texts) => texts.get(row).map_or("", |text| text.trim()).to_owned(),
            ColumnData::Number { si, .. } => si.get(row).map(f64::to_string).unwrap_or_default(),
        };
        match (&column.data, column.name.as_str()) {
            (_, "direction") => sidecar.run.direction = text(),
            (_, "repeat") => sidecar.run.repeat = text(),
            (ColumnData::Number { si, dimension, .. }, name) => {
                let value = si.get(row).copied().unwrap_or(f64::NAN);
                sidecar.run.conditions.insert(name.to_owned(), Measured::of(value, dimension.to_string()));
            }
            (ColumnData::Text(_), "configuration") => sidecar.run.configuration = text(),
            (ColumnData::Text(_), "role") => sidecar.run.role = Some(role(&rows, row, "role", &text())?),
            (ColumnData::Text(_), "state") if !has_role => {
                sidecar.run.role = Some(role(&rows, row, "state", &text())?);
            }
            (ColumnData::Text(_), "file" | "note" | "comment") => {}
            (ColumnData::Text(_), other) => {
                let problem = "is no column of a list: file, role, configuration, direction, repeat, note, and conditions with a unit, such as `speed [m/s]`";
                return Err(RecordError::column(Place::whole(list), other, format!(" {problem}")));
            }
        }
    }
    Ok(sidecar)
}

/// The role of a row of a list, by its column `column`.
fn role(list: &Table, row: usize, column: &str, word: &str) -> Result<Role, RecordError> {
    Role::ALL.into_iter().find(|role| role.name() == word).ok_or_else(|| {
        let near = suggestion(word, Role::ALL.iter().map(|role| role.name()));
        RecordError::value(list.place_of_row(row), column, format!("is {word:?}; {near}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table_file::read_table;

    #[test]
    fn one_sidecar_serves_the_tables_that_it_names_each_with_its_row_of_the_list() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("run_1.csv", "t (ms),F (N)\n0,1\n10,2\n");
        write("run_2.csv", "t (ms),F (N)\n0,3\n10,4\n");
        write("other.csv", "time [s],f_x [N]\n0,3\n");
        write("runs.csv", "file,speed [m/s],role,note\nrun_1.csv,0.5,test,me\nrun_2.csv,1,still,you\n");
        write(
            "logs.toml",
            "schema = 1\nfiles = \"run_*.csv\"\nlist = \"runs.csv\"\nmethod = \"steady\"\n[columns]\n\
             \"t (ms)\" = { name = \"time\" }\n\"F (N)\" = { name = \"f_x\", sign = -1 }\n",
        );
        let of = |name: &str| sidecar_of(&folder.path().join(name), None);
        let second = of("run_2.csv").unwrap().unwrap();
        assert_eq!((second.run.conditions["speed"].value, second.run.role), (1.0, Some(Role::Still)));
        let table = read_table(&folder.path().join("run_1.csv"), None).unwrap();
        assert_eq!(table.number("time", crate::units::Dimension::TIME).unwrap(), [0.0, 0.01]);
        assert_eq!(table.number("f_x", crate::units::Dimension::FORCE).unwrap(), [-1.0, -2.0]);
        assert!(of("other.csv").unwrap().is_none());
        assert!(is_part(&folder.path().join("runs.csv")) && !is_part(&folder.path().join("run_1.csv")));
        write("run_3.csv", "t (ms),F (N)\n0,3\n10,4\n");
        assert!(of("run_3.csv").unwrap_err().to_string().contains("has no row for run_3.csv"));
        write("more.toml", "schema = 1\nfiles = \"run_3*\"\n[columns]\n\"t (ms)\" = { name = \"time\" }\n");
        assert!(of("run_3.csv").unwrap_err().to_string().contains("both fit it"));
    }
}
