//! Observation tables: one row per observation, every number with its unit.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use crate::error::{Place, RecordError};
use crate::nearest::suggestion;
use crate::units::{Dimension, Unit};
use crate::{csv_table, parquet_table, sidecar};

/// A table in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The file.
    pub path: PathBuf,
    /// Columns in the order of the file.
    pub columns: Vec<Column>,
    /// Number of rows, at least one.
    pub n_rows: usize,
    /// Line (CSV) or row (Parquet) of each observation in its file, from 1.
    pub line_of_row: Vec<usize>,
    /// The sidecar that it was read through.
    pub sidecar: Option<PathBuf>,
}

/// One column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name without its unit.
    pub name: String,
    /// Its cells.
    pub data: ColumnData,
}

/// Cells of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum ColumnData {
    /// Numbers.
    Number {
        /// The unit as written.
        unit: Unit,
        /// What they measure.
        dimension: Dimension,
        /// Values in SI.
        si: Vec<f64>,
    },
    /// Texts.
    Text(Vec<String>),
}

impl Table {
    /// Numbers of a column in SI, when it has the dimension asked for.
    ///
    /// # Errors
    ///
    /// No such column (with the nearest name), text, or another dimension.
    pub fn number(&self, name: &str, dimension: Dimension) -> Result<&[f64], RecordError> {
        match &self.column(name)?.data {
            ColumnData::Number { si, dimension: own, .. } if *own == dimension => Ok(si),
            ColumnData::Number { dimension: own, .. } => Err(RecordError::WrongDimension {
                place: Place::whole(&self.path),
                column: name.to_owned(),
                expected: dimension.describe(),
                found: own.describe(),
            }),
            ColumnData::Text(_) => Err(self.kind(name, "text", "numbers")),
        }
    }

    /// Texts of a column.
    ///
    /// # Errors
    ///
    /// No such column, or numbers.
    pub fn text(&self, name: &str) -> Result<&[String], RecordError> {
        match &self.column(name)?.data {
            ColumnData::Text(texts) => Ok(texts),
            ColumnData::Number { .. } => Err(self.kind(name, "numbers", "text")),
        }
    }

    /// A column by name.
    ///
    /// # Errors
    ///
    /// No such column, with the nearest name.
    pub fn column(&self, name: &str) -> Result<&Column, RecordError> {
        self.columns.iter().find(|c| c.name == name).ok_or_else(|| RecordError::UnknownColumn {
            place: Place::whole(&self.path),
            column: name.to_owned(),
            advice: suggestion(name, self.columns.iter().map(|c| c.name.as_str())),
        })
    }

    fn kind(&self, name: &str, found: &'static str, expected: &'static str) -> RecordError {
        RecordError::ColumnKind { place: Place::whole(&self.path), column: name.to_owned(), found, expected }
    }
}

/// Reads a table, `.csv` or `.parquet`, through `sidecar` or the `.toml` of the same name beside it.
///
/// # Errors
///
/// See [`RecordError`]: every message names file, line and column.
pub fn read_table(path: &Path, sidecar: Option<&Path>) -> Result<Table, RecordError> {
    let beside = path.with_extension("toml");
    let sidecar = match sidecar {
        Some(given) => Some(given.to_owned()),
        None if beside.is_file() && sidecar::is_sidecar(&beside) => Some(beside),
        None => None,
    };
    let mapping = sidecar.as_deref().map(sidecar::read_sidecar).transpose()?;
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let mut table = match ending.as_deref() {
        Some("csv") => csv_table::read_csv(path, mapping.as_ref())?,
        Some("parquet") => parquet_table::read_parquet(path, mapping.as_ref())?,
        _ => return Err(RecordError::Extension { path: path.to_owned() }),
    };
    table.sidecar = sidecar;
    check(&table)?;
    Ok(table)
}

/// The dimension that a known column must have; `None` for any other name.
#[must_use]
pub fn known_dimension(name: &str) -> Option<Dimension> {
    let (base, dots) = match name.strip_suffix("_dot") {
        Some(base) => (base, 1),
        None => (name, 0),
    };
    let base = base.strip_prefix("std_").unwrap_or(base);
    let base = base.strip_prefix("zero_before_").or_else(|| base.strip_prefix("zero_after_")).unwrap_or(base);
    let dimension = match base {
        "v_x" | "v_y" | "v_z" if dots == 1 => Dimension::ACCELERATION,
        "w_x" | "w_y" | "w_z" if dots == 1 => Dimension::ANGULAR_ACCELERATION,
        _ if dots == 1 => return None,
        "v_x" | "v_y" | "v_z" | "speed" => Dimension::SPEED,
        "w_x" | "w_y" | "w_z" => Dimension::ANGULAR_SPEED,
        "f_x" | "f_y" | "f_z" => Dimension::FORCE,
        "m_x" | "m_y" | "m_z" => Dimension::MOMENT,
        "angle" | "n_links" | "repeat" => Dimension::ONE,
        "temperature" => Dimension::TEMPERATURE,
        "density" => Dimension::DENSITY,
        "kinematic_viscosity" => Dimension::KINEMATIC_VISCOSITY,
        "volume" => Dimension::VOLUME,
        _ => return None,
    };
    Some(dimension)
}

/// Columns that are text whatever stands in them.
#[must_use]
pub fn is_text_column(name: &str) -> bool {
    matches!(name, "configuration" | "setup" | "run")
}

/// What holds for every table, whatever its format.
fn check(table: &Table) -> Result<(), RecordError> {
    if table.n_rows == 0 {
        return Err(RecordError::NoRows { path: table.path.clone() });
    }
    let mut names = HashSet::new();
    for column in &table.columns {
        if !names.insert(&column.name) {
            return Err(RecordError::DuplicateColumn {
                place: Place::line(&table.path, 1),
                column: column.name.clone(),
            });
        }
    }
    let links = |c: &Column| match &c.data {
        ColumnData::Number { si, .. } if c.name == "n_links" => Some(si.clone()),
        _ => None,
    };
    if let (Some(n_links), Ok(configurations)) = (table.columns.iter().find_map(links), table.text("configuration")) {
        for (row, (found, configuration)) in n_links.iter().zip(configurations).enumerate() {
            if let Some(expected) = links_of(configuration)
                && expected != *found
            {
                return Err(RecordError::LinksContradictConfiguration {
                    place: Place::line(&table.path, table.line_of_row.get(row).copied().unwrap_or(row + 1)),
                    configuration: configuration.clone(),
                    expected,
                    found: *found,
                });
            }
        }
    }
    Ok(())
}

/// k of a configuration named HkLT.
fn links_of(configuration: &str) -> Option<f64> {
    configuration.strip_prefix('H')?.strip_suffix("LT")?.parse::<u16>().ok().map(f64::from)
}
