//! The results of a job are written all or none: into a folder of their own beside the target, then moved.

use std::path::{Path, PathBuf};

use froude_records::csv_table::write_csv;
use froude_records::estimate::EstimateFile;
use froude_records::json::write_estimates;
use froude_records::table::Table;
use froude_records::write::write_atomically;
use froude_report::Figure;

use crate::Error;

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
    /// What else the job makes.
    pub others: Vec<PathBuf>,
}

/// Says before a long computation whether its results can be written; nothing is made.
///
/// # Errors
///
/// The folder is a file, or nothing can be written where it is or would be.
pub fn can_be_written(out: &Path) -> Result<(), Error> {
    let failed = |source| Error::Output { path: out.to_owned(), source };
    let there = out.ancestors().map(|p| if p.as_os_str().is_empty() { Path::new(".") } else { p }).find(|p| p.exists());
    let there = there.unwrap_or(Path::new("."));
    if !there.is_dir() {
        return Err(failed(std::io::ErrorKind::NotADirectory.into()));
    }
    tempfile::tempfile_in(there).map(|_| ()).map_err(failed)
}

/// Writes record, observations, figures and report into `out`.
///
/// # Errors
///
/// A folder that cannot be made, or a full disk: then nothing of this job is left, and older results are untouched.
pub fn write(
    out: &Path,
    file: &EstimateFile,
    observations: &[Table],
    figures: &[Figure],
    html: &str,
) -> Result<Written, Error> {
    write_also(out, file, observations, figures, html, &|_| Ok(Vec::new()))
}

/// The same with files of the job's own: `also` writes them into the folder that it is given, and returns their names.
///
/// # Errors
///
/// As [`write`], and those of `also`.
pub fn write_also(
    out: &Path,
    file: &EstimateFile,
    observations: &[Table],
    figures: &[Figure],
    html: &str,
    also: &dyn Fn(&Path) -> Result<Vec<PathBuf>, Error>,
) -> Result<Written, Error> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| Error::Output { path, source }
    };
    let parent = match out.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(parent).map_err(failed(out))?;
    // Dropped on every early return, and with it all that was written.
    let staged = tempfile::Builder::new().prefix(".froude-").tempdir_in(parent).map_err(failed(out))?;
    let mut names = vec![PathBuf::from("estimate.json")];
    write_estimates(&staged.path().join(&names[0]), file)?;
    for table in observations {
        write_csv(table, &staged.path().join(&table.path))?;
        names.push(table.path.clone());
    }
    if !figures.is_empty() {
        std::fs::create_dir(staged.path().join("figures")).map_err(failed(out))?;
    }
    for figure in figures {
        let name = Path::new("figures").join(&figure.file_name);
        write_atomically(&staged.path().join(&name), figure.svg.as_bytes())?;
        names.push(name);
    }
    names.push(PathBuf::from("report.html"));
    write_atomically(&staged.path().join("report.html"), html.as_bytes())?;
    let others = also(staged.path())?;
    names.extend(others.iter().cloned());
    let folder = if figures.is_empty() { out.to_owned() } else { out.join("figures") };
    std::fs::create_dir_all(folder).map_err(failed(out))?;
    for name in &names {
        std::fs::rename(staged.path().join(name), out.join(name)).map_err(failed(out))?;
    }
    Ok(Written {
        estimate: out.join("estimate.json"),
        report: out.join("report.html"),
        figures: names.iter().filter(|n| n.starts_with("figures")).map(|n| out.join(n)).collect(),
        observations: observations.iter().map(|t| out.join(&t.path)).collect(),
        others: others.iter().map(|n| out.join(n)).collect(),
    })
}
