//! Where the results of a fit lie.

use std::path::{Path, PathBuf};

use froude_identify::method::Export;
use froude_records::RecordError;
use froude_records::csv_table::write_csv;
use froude_records::estimate::EstimateFile;
use froude_records::json::write_estimates;
use froude_records::table::Table;
use froude_records::write::write_atomically;
use froude_report::Figure;
use indexmap::IndexMap;

use crate::Error;
pub use froude_records::results::{can_be_written, spares};

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

/// Replaces the folder `out` by what `fill` writes into the folder that it is given; the results of an earlier job are gone then.
///
/// # Errors
///
/// Those of `fill`, said of `out`, and those of [`froude_records::results::replace`].
pub(crate) fn replace(out: &Path, fill: impl FnOnce(&Path) -> Result<(), Error>) -> Result<(), Error> {
    froude_records::results::replace(out, |folder| fill(folder).map_err(|error| error.in_finished(folder, out)))
}

/// Writes record, observations, figures, exports and report into `out`.
///
/// # Errors
///
/// As [`froude_records::results::replace`].
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
            std::fs::create_dir(&path).map_err(|source| RecordError::output(&path, &source))?;
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
