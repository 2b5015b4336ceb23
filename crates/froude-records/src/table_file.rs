//! Tables by the ending of their file: CSV or Parquet.

use std::fs::File;
use std::path::Path;

use crate::error::RecordError;
use crate::sidecar::Sidecar;
use crate::table::Table;
use crate::write::Prepared;
use crate::{csv_table, parquet_table, parquet_write, read, sidecar};

/// Reads a table, `.csv` or `.parquet`, through `sidecar` or the `.toml` of the same name beside it.
///
/// # Errors
///
/// See [`RecordError`]: every message names file, line and column.
pub fn read_table(path: &Path, sidecar: Option<&Path>) -> Result<Table, RecordError> {
    read(path, sidecar, csv_table::read_csv, parquet_table::parse_parquet)
}

/// As [`read_table`]; a load, and a motion along or about an axis, may have empty cells, which [`Table::blank`] lists.
///
/// # Errors
///
/// As [`read_table`].
pub fn read_table_with_blanks(path: &Path, sidecar: Option<&Path>) -> Result<Table, RecordError> {
    read(path, sidecar, csv_table::read_csv_with_blanks, parquet_table::parse_parquet_with_blanks)
}

fn read(
    path: &Path,
    sidecar: Option<&Path>,
    read_csv: fn(&Path, Option<&Sidecar>) -> Result<Table, RecordError>,
    read_parquet: fn(&Path, File, Option<&Sidecar>) -> Result<Table, RecordError>,
) -> Result<Table, RecordError> {
    let mapping = sidecar_of(path, sidecar)?;
    match Format::of(path)? {
        Format::Csv => read_csv(path, mapping.as_ref()),
        Format::Parquet => read_parquet(path, read::open(path)?, mapping.as_ref()),
    }
}

/// The sidecar of a table: the one given, or the `.toml` of the same name beside it.
///
/// # Errors
///
/// A sidecar that cannot be read.
pub fn sidecar_of(path: &Path, sidecar: Option<&Path>) -> Result<Option<Sidecar>, RecordError> {
    let beside = path.with_extension("toml");
    match sidecar {
        Some(given) => sidecar::read_sidecar(given).map(Some),
        None if beside.is_file() && sidecar::is_sidecar(&beside) => sidecar::read_sidecar(&beside).map(Some),
        None => Ok(None),
    }
}

/// How a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Csv,
    Parquet,
}

impl Format {
    /// By the ending of its name.
    pub(crate) fn of(path: &Path) -> Result<Self, RecordError> {
        match path.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") => Ok(Self::Parquet),
            _ => Err(RecordError::Refused(format!("{}: tables are read from .csv and .parquet files", path.display()))),
        }
    }
}

/// Writes a table in the format that its name ends in, `.csv` or `.parquet`, up to taking its place.
///
/// # Errors
///
/// Another ending, a number that is not finite, or a file that cannot be written.
pub fn prepare_table(table: &Table, path: &Path) -> Result<Prepared, RecordError> {
    match Format::of(path)? {
        Format::Csv => csv_table::prepare_csv(table, path),
        Format::Parquet => parquet_write::prepare_parquet(table, path),
    }
}
