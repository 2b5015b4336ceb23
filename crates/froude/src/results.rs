//! The results of a job lie in a folder of their own, which is replaced as a whole.
//!
//! All files grow in a folder beside it and come into place by one rename, so that results of two runs are never mixed. Beside them lies
//! the list of what was written: what is not on it, or was changed since, is a person's. Then nothing is written at all.

use std::path::{Path, PathBuf};

use froude_identify::method::Export;
use froude_records::csv_table::write_csv;
use froude_records::estimate::EstimateFile;
use froude_records::folder::UnfinishedFolder;
use froude_records::json::write_estimates;
use froude_records::manifest::{first_alien, write_manifest};
use froude_records::table::Table;
use froude_records::write::write_atomically;
use froude_report::Figure;
use indexmap::IndexMap;

use crate::Error;

/// The program that makes a record.
pub(crate) fn versions() -> IndexMap<String, String> {
    IndexMap::from([("froude".to_owned(), env!("CARGO_PKG_VERSION").to_owned())])
}

/// Where the results lie.
#[derive(Debug, Clone)]
pub struct Written {
    /// `estimate.json`.
    pub estimate: PathBuf,
    /// `report.html`.
    pub report: PathBuf,
    /// The figures.
    pub figures: Vec<PathBuf>,
    /// A table of observations per fitted source.
    pub observations: Vec<PathBuf>,
    /// Files for other programs.
    pub exports: Vec<PathBuf>,
}

/// Says before a long computation whether its results can be written; nothing is left of the trial.
///
/// # Errors
///
/// The folder is a file, holds what Froude did not write, or nothing can be written where it is or would be.
pub fn can_be_written(out: &Path) -> Result<(), Error> {
    let failed = |source| Error::Output { path: out.to_owned(), source };
    let there = out.ancestors().map(|p| if p.as_os_str().is_empty() { Path::new(".") } else { p }).find(|p| p.exists());
    let there = there.unwrap_or(Path::new("."));
    if !there.is_dir() {
        return Err(failed(std::io::ErrorKind::NotADirectory.into()));
    }
    only_own(out)?;
    UnfinishedFolder::beside(out)?;
    Ok(())
}

/// Refuses a folder that holds what a person wrote.
fn only_own(out: &Path) -> Result<(), Error> {
    let alien = if out.is_dir() { first_alien(out)? } else { None };
    match alien {
        Some(alien) => Err(Error::NotOurs { out: out.to_owned(), path: alien.path, is_changed: alien.is_changed }),
        None => Ok(()),
    }
}

/// Refuses results in a folder that holds one of these inputs, or in place of one.
///
/// # Errors
///
/// [`Error::ReplacesInput`].
pub fn spares<'a>(out: &Path, inputs: impl IntoIterator<Item = &'a Path>) -> Result<(), Error> {
    let Ok(out) = std::fs::canonicalize(out) else { return Ok(()) };
    let is_replaced = |path: &&Path| std::fs::canonicalize(path).is_ok_and(|path| path.starts_with(&out));
    match inputs.into_iter().find(is_replaced) {
        None => Ok(()),
        Some(record) => Err(Error::ReplacesInput { out, record: record.to_owned() }),
    }
}

/// Replaces the folder `out` by what `fill` writes into the folder that it is given; the results of an earlier job are gone then.
///
/// # Errors
///
/// Those of `fill`; a folder that holds what a person wrote; a full disk. Then nothing of this job is left, and older results are untouched.
pub fn replace(out: &Path, fill: impl FnOnce(&Path) -> Result<(), Error>) -> Result<(), Error> {
    only_own(out)?;
    let folder = UnfinishedFolder::beside(out)?;
    fill(folder.path())
        .and_then(|()| Ok(write_manifest(folder.path())?))
        .map_err(|error| error.in_finished(folder.path(), out))?;
    // Somebody may have put a file there meanwhile.
    only_own(out)?;
    Ok(folder.take_place()?)
}

/// Writes record, observations, figures, exports and report into `out`.
///
/// # Errors
///
/// As [`replace`].
pub fn write(
    out: &Path,
    file: &EstimateFile,
    observations: &[Table],
    figures: &[Figure],
    exports: &[Export],
    html: &str,
) -> Result<Written, Error> {
    replace(out, |folder| {
        write_estimates(&folder.join("estimate.json"), file)?;
        for table in observations {
            write_csv(table, &folder.join(&table.path))?;
        }
        if !figures.is_empty() {
            let path = folder.join("figures");
            std::fs::create_dir(&path).map_err(|source| Error::Output { path, source })?;
        }
        for figure in figures {
            write_atomically(&folder.join("figures").join(&figure.file_name), figure.svg.as_bytes())?;
        }
        write_atomically(&folder.join("report.html"), html.as_bytes())?;
        for export in exports {
            write_atomically(&folder.join(&export.name), &export.content)?;
        }
        Ok(())
    })?;
    Ok(Written {
        estimate: out.join("estimate.json"),
        report: out.join("report.html"),
        figures: figures.iter().map(|f| out.join("figures").join(&f.file_name)).collect(),
        observations: observations.iter().map(|t| out.join(&t.path)).collect(),
        exports: exports.iter().map(|export| out.join(&export.name)).collect(),
    })
}
