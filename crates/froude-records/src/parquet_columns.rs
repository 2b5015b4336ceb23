//! The columns of a Parquet file before a cell is read: names, types, and whether the header agrees with the type.

use std::path::Path;

use parquet::basic::Compression;
use parquet::file::metadata::{FileMetaData, ParquetMetaData, RowGroupMetaData};
use parquet::schema::types::Type;

use crate::arrow_schema;
use crate::assemble::Want;
use crate::error::{Place, RecordError};
use crate::heading::split_header;
use crate::known_columns::is_text_column;
use crate::parquet_types::{CellType, TimeUnit};
use crate::raw_column::Raw;
use crate::units::{Dimension, Unit};

/// A column of a file.
pub(crate) struct FileColumn {
    /// Its header; the unit that its type implies is behind its name where it states none.
    pub header: String,
    /// What it holds; the name of its type where that is not read.
    kind: Result<CellType, String>,
    /// Its first column of cells: a structure has several.
    pub leaf: usize,
    /// The unit in which its times are wanted.
    pub time_unit: TimeUnit,
    /// Whether its integers may be durations in a unit that cannot be read.
    may_be_duration: bool,
}

impl FileColumn {
    /// Those of a file; headers stay as they are where a sidecar maps them.
    pub fn all(file: &FileMetaData, has_sidecar: bool) -> Vec<Self> {
        let entries = file.key_value_metadata();
        let arrow = entries.into_iter().flatten().find(|entry| entry.key == arrow_schema::KEY);
        let durations = arrow.and_then(|entry| arrow_schema::durations(entry.value.as_deref()?));
        let is_unreadable = arrow.is_some() && durations.is_none();
        let durations = durations.unwrap_or_default();
        let mut leaf = 0;
        let of = |field: &std::sync::Arc<Type>| {
            let duration = durations.iter().find(|(name, _)| name == field.name()).map(|(_, unit)| *unit);
            let kind = CellType::of(field, duration);
            let name = field.name().trim();
            let implied = kind.as_ref().ok().and_then(|kind| implied_unit(name, *kind)).filter(|_| !has_sidecar);
            let own = kind.as_ref().ok().and_then(|kind| kind.time_unit());
            let column = Self {
                header: implied.map_or_else(|| name.to_owned(), |unit| format!("{name} [{unit}]")),
                time_unit: own.filter(|_| implied.is_none()).unwrap_or(TimeUnit::Seconds),
                may_be_duration: is_unreadable && kind == Ok(CellType::Number),
                kind,
                leaf,
            };
            leaf += leaves(field);
            column
        };
        file.schema().get_fields().iter().map(of).collect()
    }

    /// What it holds.
    ///
    /// # Errors
    ///
    /// A type that is not read, or one that is not what the header states.
    pub fn checked(&self, path: &Path, want: &Want<'_>) -> Result<CellType, RecordError> {
        let refuse = |problem: String| RecordError::column(Place::whole(path), &self.header, problem);
        let kind = match &self.kind {
            Ok(kind) => *kind,
            Err(kind) => {
                return Err(refuse(format!(
                    " is of the type {kind}; expected numbers, truth values, times or text: write it as such, a column for each \
                     number, or name only the other columns in a sidecar"
                )));
            }
        };
        let unit = match want {
            Want::Number { unit, .. } => Some(unit),
            Want::Mapped(mapping) => mapping.unit.as_ref(),
            Want::Text { .. } | Want::LeftOut => None,
        };
        let is_time = unit.is_some_and(|unit| unit.dimension == Dimension::TIME);
        if is_time && self.may_be_duration {
            let problem = " holds integers that may be durations: the unit of such a type stands in the file's ARROW:schema, which \
                           cannot be read; write the column as double";
            return Err(refuse(problem.to_owned()));
        }
        let stated = || unit.map_or_else(|| "no unit".to_owned(), |unit| format!("the unit {unit}"));
        match (kind.time_unit(), kind) {
            (Some(own), _) if !is_that(unit, self.time_unit) => {
                let advice = match want {
                    Want::Mapped(mapping) => format!("write unit = \"{}\" in {}", own.symbol(), mapping.place),
                    Want::Number { name, .. } if is_time => {
                        format!("head the column `{name} [{}]`, or `{name}` alone", own.symbol())
                    }
                    _ => "write it as numbers in that unit, or as text".to_owned(),
                };
                Err(refuse(format!(" is of the type {}, and {} is stated; {advice}", kind.name(), stated())))
            }
            (None, CellType::Date) if want.is_number() => Err(refuse(format!(
                " is of the type date, which has whole days, and {} is stated; write a column of timestamps or of numbers",
                stated()
            ))),
            _ => Ok(kind),
        }
    }

    /// A place for its cells.
    pub fn raw(&self) -> Raw {
        match self.kind {
            Ok(kind) if !kind.is_text() => Raw::Numbers(Vec::new()),
            _ => Raw::Texts(Vec::new()),
        }
    }

    /// Whether it is the row number that pandas adds to a table whose rows were chosen or sorted.
    pub fn is_index(&self) -> bool {
        self.header.starts_with("__index_level_") && matches!(self.kind, Ok(CellType::Number | CellType::Unsigned))
    }
}

/// Columns of cells in a field.
fn leaves(field: &Type) -> usize {
    if field.is_primitive() { 1 } else { field.get_fields().iter().map(|field| leaves(field)).sum() }
}

/// The unit that a type gives to a column whose header is a name alone.
fn implied_unit(name: &str, kind: CellType) -> Option<&'static str> {
    let is_name = name.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '-'));
    if !is_name || is_text_column(name) || !matches!(split_header(name), Ok((_, None))) {
        return None;
    }
    match kind {
        CellType::Boolean if name != "repeat" => Some("1"),
        kind => kind.time_unit().map(|_| "s"),
    }
}

fn is_that(unit: Option<&Unit>, wanted: TimeUnit) -> bool {
    let per_second = wanted.nanoseconds() as f64 / 1e9;
    unit.is_some_and(|unit| {
        unit.dimension == Dimension::TIME && (unit.factor / per_second - 1.0).abs() < 1e-9 && unit.offset == 0.0
    })
}

/// Refuses columns that are packed in a way that is not read.
pub(crate) fn check_packing(path: &Path, metadata: &ParquetMetaData) -> Result<(), RecordError> {
    let chunks = metadata.row_groups().iter().flat_map(RowGroupMetaData::columns);
    for chunk in chunks {
        match chunk.compression() {
            Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::ZSTD(_) => {}
            other => {
                let problem = format!(
                    " is packed with {}; write the table with snappy or zstd (pandas: to_parquet(…, compression=\"zstd\"))",
                    other.to_string().split('(').next().unwrap_or_default()
                );
                return Err(RecordError::column(Place::whole(path), &chunk.column_path().string(), problem));
            }
        }
    }
    Ok(())
}
