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
    std::fs::create_dir_all(out.join("figures")).map_err(failed(out))?;
    for name in &names {
        std::fs::rename(staged.path().join(name), out.join(name)).map_err(failed(out))?;
    }
    Ok(Written {
        estimate: out.join("estimate.json"),
        report: out.join("report.html"),
        figures: names.iter().filter(|n| n.starts_with("figures")).map(|n| out.join(n)).collect(),
        observations: observations.iter().map(|t| out.join(&t.path)).collect(),
    })
}
