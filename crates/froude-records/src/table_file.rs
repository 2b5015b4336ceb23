//! Tables by the ending of their file.

use std::io::Read as _;
use std::path::Path;

use froude_foreign::refused::refusal_for;

use crate::csv_table::Blanks;
use crate::error::RecordError;
use crate::run::join::join;
use crate::sidecar::Sidecar;
use crate::sidecar_file::{joined, sidecar_of};
use crate::table::Table;
use crate::write::Prepared;
use crate::{container_table, csv_table, parquet_table, parquet_write, read, sheet_table};

/// Reads a table, `.csv` or `.parquet`, through `sidecar` or the `.toml` of the same name beside it.
///
/// # Errors
///
/// See [`RecordError`]: every message names file, line and column.
pub fn read_table(path: &Path, sidecar: Option<&Path>) -> Result<Table, RecordError> {
    read(path, sidecar, None)
}

/// As [`read_table`]; a load, and a motion along or about an axis, may have empty cells, which [`Table::blank`] lists.
///
/// # Errors
///
/// As [`read_table`].
pub fn read_table_with_blanks(path: &Path, sidecar: Option<&Path>) -> Result<Table, RecordError> {
    let mut blank = Blanks::new();
    let table = read(path, sidecar, Some(&mut blank))?;
    Ok(Table { blank, ..table })
}

fn read(path: &Path, sidecar: Option<&Path>, mut blank: Option<&mut Blanks>) -> Result<Table, RecordError> {
    let mapping = sidecar_of(path, sidecar)?;
    let mut table = by_format(path, mapping.as_ref(), blank.as_deref_mut())?;
    let Some(mapping) = mapping else { return Ok(table) };
    for ((other, own), (declared, _)) in joined(&mapping, path)?.into_iter().zip(&mapping.joins) {
        let log = by_format(&other, own.as_ref(), None)?;
        let rows = join(&mut table, mapping.run.declared.jumps, &log, own.as_ref(), declared)?;
        if let Some(blank) = &mut blank {
            blank.retain_mut(|(_, row)| rows.binary_search(row).map(|kept| *row = kept).is_ok());
        }
    }
    Ok(table)
}

fn by_format(path: &Path, mapping: Option<&Sidecar>, blank: Option<&mut Blanks>) -> Result<Table, RecordError> {
    match Format::of(path)? {
        Format::Text => csv_table::read_text(path, mapping, blank),
        Format::Parquet => match blank {
            None => parquet_table::parse_parquet(path, read::open(path)?, mapping),
            Some(blank) => {
                let mut table = parquet_table::parse_parquet_with_blanks(path, read::open(path)?, mapping)?;
                blank.append(&mut table.blank);
                Ok(table)
            }
        },
        Format::Sheet => sheet_table::read_sheet(path, mapping, blank),
        Format::Columns => container_table::read_columns(path, mapping, blank),
    }
}

/// Whether a file is one of those that tables are read from, by its ending.
#[must_use]
pub fn is_table(path: &Path) -> bool {
    Format::of(path).is_ok()
}

/// The beginning of a file; nothing where it cannot be read.
fn first_bytes(path: &Path) -> Vec<u8> {
    let mut first = Vec::new();
    if let Ok(file) = read::open(path) {
        let _ = file.take(64).read_to_end(&mut first);
    }
    first
}

/// Endings of tables of text.
const TEXT_ENDINGS: [&str; 12] = ["csv", "txt", "dat", "tsv", "out", "exp", "asc", "prn", "lvm", "tab", "xy", "dlm"];

/// How a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    /// Text, in whatever form.
    Text,
    Parquet,
    Sheet,
    /// MAT, HDF5, TDMS, ULog, MCAP.
    Columns,
}

impl Format {
    /// By the ending of its name.
    pub(crate) fn of(path: &Path) -> Result<Self, RecordError> {
        match path.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
            Some(ending) if TEXT_ENDINGS.contains(&ending) => Ok(Self::Text),
            Some("parquet") => Ok(Self::Parquet),
            Some("xlsx" | "xlsm" | "xls" | "ods") => Ok(Self::Sheet),
            Some("mat" | "h5" | "hdf5" | "tdms" | "ulg" | "mcap") => Ok(Self::Columns),
            ending => {
                let first = first_bytes(path);
                let what = refusal_for(ending.unwrap_or_default(), &first).unwrap_or_else(|| {
                    let is_text = !first.is_empty() && !first.iter().any(|b| *b < b' ' && !b.is_ascii_whitespace());
                    let rename = if is_text { "; a table of text under another ending is renamed to .txt" } else { "" };
                    format!("unknown file type; tables are read from text (.csv, .txt, .dat, .tsv, .out), .parquet, spreadsheets (.xlsx, .xls, .ods), .mat, .h5, .tdms, .ulg and .mcap files{rename}")
                });
                Err(RecordError::Refused(format!("{}: {what}", path.display())))
            }
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
        Format::Text => csv_table::prepare_csv(table, path),
        Format::Parquet => parquet_write::prepare_parquet(table, path),
        Format::Sheet | Format::Columns => {
            Err(RecordError::Refused(format!("{}: tables are written as .csv and .parquet files", path.display())))
        }
    }
}
