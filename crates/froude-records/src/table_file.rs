//! Tables by the ending of their file.

use std::path::Path;

use froude_foreign::{ForeignError, hdf5, mat5};

use crate::csv_table::Blanks;
use crate::error::{Place, RecordError};
use crate::sidecar::Sidecar;
use crate::table::Table;
use crate::write::Prepared;
use crate::{container_table, csv_table, parquet_table, read, sheet_table, sidecar};

/// Reads a table, `.csv` or `.parquet`, through `sidecar` or the `.toml` of the same name beside it.
///
/// # Errors
///
/// See [`RecordError`]: every message names file, line and column.
pub fn read_table(path: &Path, sidecar: Option<&Path>) -> Result<Table, RecordError> {
    read(path, sidecar, None)
}

/// As [`read_table`]; in CSV a load, and a motion along or about an axis, may have empty cells, which [`Table::blank`] lists.
///
/// # Errors
///
/// As [`read_table`].
pub fn read_table_with_blanks(path: &Path, sidecar: Option<&Path>) -> Result<Table, RecordError> {
    let mut blank = Blanks::new();
    let table = read(path, sidecar, Some(&mut blank))?;
    Ok(Table { blank, ..table })
}

fn read(path: &Path, sidecar: Option<&Path>, blank: Option<&mut Blanks>) -> Result<Table, RecordError> {
    let mapping = sidecar_of(path, sidecar)?;
    let mapping = mapping.as_ref();
    match Format::of(path)? {
        Format::Text => match blank {
            None => csv_table::read_csv(path, mapping),
            Some(blank) => {
                let mut table = csv_table::read_csv_with_blanks(path, mapping)?;
                blank.append(&mut table.blank);
                Ok(table)
            }
        },
        Format::Parquet => parquet_table::parse_parquet(path, read::open(path)?, mapping),
        Format::Sheet => sheet_table::read_sheet(path, mapping, blank),
        Format::Mat => {
            let bytes = read::whole(path, LARGEST_BYTES, "a MAT file")?;
            let found = if mat5::is_mat5(&bytes) { mat5::read(&bytes) } else { hdf5::read(bytes) };
            container_table::table(path, found.map_err(|e| foreign(path, &e))?, mapping, blank)
        }
        Format::Hdf5 => {
            let bytes = read::whole(path, LARGEST_BYTES, "an HDF5 file")?;
            container_table::table(path, hdf5::read(bytes).map_err(|e| foreign(path, &e))?, mapping, blank)
        }
    }
}

/// What a reader of other programs' files says, with the file.
fn foreign(path: &Path, error: &ForeignError) -> RecordError {
    RecordError::syntax(Place::whole(path), format!("the file {error}"))
}

/// The largest file of named columns.
const LARGEST_BYTES: u64 = froude_foreign::MAX_BYTES;

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

/// Endings of tables of text.
const TEXT_ENDINGS: [&str; 8] = ["csv", "txt", "dat", "tsv", "out", "exp", "asc", "prn"];

/// How a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    /// Text, in whatever form.
    Text,
    Parquet,
    Sheet,
    /// Of MATLAB, old or new.
    Mat,
    Hdf5,
}

impl Format {
    /// By the ending of its name.
    pub(crate) fn of(path: &Path) -> Result<Self, RecordError> {
        match path.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
            Some(ending) if TEXT_ENDINGS.contains(&ending) => Ok(Self::Text),
            Some("parquet") => Ok(Self::Parquet),
            Some("xlsx" | "xlsm" | "xls" | "ods") => Ok(Self::Sheet),
            Some("mat") => Ok(Self::Mat),
            Some("h5" | "hdf5") => Ok(Self::Hdf5),
            _ => Err(RecordError::Refused(format!(
                "{}: tables are read from text (.csv, .txt, .dat, .tsv, .out), .parquet, spreadsheets (.xlsx, .xls, .ods), .mat and .h5 files",
                path.display()
            ))),
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
        Format::Parquet => parquet_table::prepare_parquet(table, path),
        Format::Sheet | Format::Mat | Format::Hdf5 => {
            Err(RecordError::Refused(format!("{}: tables are written as .csv and .parquet files", path.display())))
        }
    }
}
