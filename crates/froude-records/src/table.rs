//! Observation tables: one row per observation, every number with its unit.

use std::path::PathBuf;

use froude_signal::lag::Lag;

use crate::error::{Place, RecordError};
use crate::finding::{Finding, Severity};
use crate::nearest::suggestion;
use crate::plausible;
use crate::raw_column::TEXT_FOR_NUMBERS;
use crate::run::step::Step;
use crate::texts::Texts;
use crate::units::{Dimension, Unit};

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
    /// Headers of the file's columns that the sidecar does not name.
    pub left_out: Vec<String>,
    /// Empty cells, as column and row: read as 0, and only by [`crate::table_file::read_table_with_blanks`].
    pub blank: Vec<(String, usize)>,
    /// How the file was understood, where it is not written as Froude writes tables.
    pub understood: Option<String>,
    /// Logs with clocks of their own whose columns were joined to it.
    pub joined: Vec<Joined>,
}

/// A log that was joined to a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Joined {
    /// Its file.
    pub path: PathBuf,
    /// Its sidecar, where it has one of its own.
    pub sidecar: Option<PathBuf>,
    /// The columns that were taken from it.
    pub columns: Vec<String>,
    /// Lag and drift of its clock.
    pub lag: Lag,
    /// What was done, with its numbers.
    pub step: Step,
    /// What a reader should know of it.
    pub findings: Vec<Finding>,
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
    Text(Texts),
}

impl Column {
    /// Name and unit as they stand in a header: `speed [m/s]`.
    #[must_use]
    pub fn header(&self) -> String {
        match &self.data {
            ColumnData::Number { unit, .. } => format!("{} [{unit}]", self.name),
            ColumnData::Text(_) => self.name.clone(),
        }
    }
}

impl Table {
    /// A table that was made and not read: `line_of_row` has an entry for each row.
    #[must_use]
    pub const fn of(path: PathBuf, columns: Vec<Column>, line_of_row: Vec<usize>) -> Self {
        let n_rows = line_of_row.len();
        Self {
            path,
            columns,
            n_rows,
            line_of_row,
            sidecar: None,
            left_out: Vec::new(),
            blank: Vec::new(),
            understood: None,
            joined: Vec::new(),
        }
    }

    /// The same with what its reader understood beside it.
    pub(crate) fn also(self, words: Option<String>) -> Self {
        let understood = match (words, self.understood) {
            (Some(words), Some(own)) => Some(format!("{words}, {own}")),
            (words, own) => words.or(own),
        };
        Self { understood, ..self }
    }

    /// How the file was understood, where it is not in Froude's own form, and what was joined to it.
    #[must_use]
    pub fn findings(&self) -> Vec<Finding> {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let told =
            |words: &String| Finding::new(Severity::Note, "foreign-table", format!("{name} was read as: {words}"));
        let joined = self.joined.iter().flat_map(|joined| joined.findings.clone());
        self.understood.as_ref().map(told).into_iter().chain(joined).collect()
    }

    /// Numbers of a column in SI, when it has the dimension asked for.
    ///
    /// # Errors
    ///
    /// No such column (with the nearest name), text, or another dimension.
    pub fn number(&self, name: &str, dimension: Dimension) -> Result<&[f64], RecordError> {
        match &self.column(name)?.data {
            ColumnData::Number { si, dimension: own, .. } if *own == dimension => Ok(si),
            ColumnData::Number { dimension: own, unit, .. } => {
                let header = format!("{name} [{unit}]");
                let [expected, found] = [dimension, *own].map(Dimension::describe);
                Err(RecordError::wrong_dimension(Place::whole(&self.path), &header, &expected, &found))
            }
            ColumnData::Text(_) => Err(RecordError::column(Place::whole(&self.path), name, TEXT_FOR_NUMBERS)),
        }
    }

    /// Texts of a column.
    ///
    /// # Errors
    ///
    /// No such column, or numbers.
    pub fn text(&self, name: &str) -> Result<&Texts, RecordError> {
        match &self.column(name)?.data {
            ColumnData::Text(texts) => Ok(texts),
            ColumnData::Number { .. } => {
                Err(RecordError::column(Place::whole(&self.path), name, " holds numbers; expected text"))
            }
        }
    }

    /// A column by name.
    ///
    /// # Errors
    ///
    /// No such column, with the nearest name.
    pub fn column(&self, name: &str) -> Result<&Column, RecordError> {
        let near = || suggestion(name, self.columns.iter().map(|c| c.name.as_str()));
        let unknown = || RecordError::unknown_column(Place::whole(&self.path), name, near());
        self.columns.iter().find(|c| c.name == name).ok_or_else(unknown)
    }

    /// Place of a row (from 0) in its file, for messages: a line of a text, a row of any other file.
    #[must_use]
    pub fn place_of_row(&self, row: usize) -> Place {
        Place::in_table(&self.path, self.line_of_row.get(row).copied().unwrap_or(row + 1))
    }

    /// What no cell alone is wrong in: values that no tank has, links that contradict the configuration.
    pub(crate) fn check(&self) -> Result<(), RecordError> {
        // In the log of a drive the angle of a joint counts on over its turns.
        let has = |names: &[&str]| self.columns.iter().any(|column| names.contains(&column.name.as_str()));
        let is_of_drive = has(&["time"]) && has(&["command", "current", "voltage", "torque"]);
        for column in self.columns.iter().filter(|column| !(is_of_drive && column.name == "angle")) {
            let ColumnData::Number { unit, si, .. } = &column.data else { continue };
            let doubtful = |(row, si): (usize, &f64)| Some((row, *si, plausible::problem(&column.name, *si, unit)?));
            if let Some((row, si, problem)) = si.iter().enumerate().find_map(doubtful) {
                let problem = format!("is {}, which {problem}", unit.from_si(si));
                return Err(RecordError::value(self.place_of_row(row), column.header(), problem));
            }
        }
        let Some(ColumnData::Number { si: n_links, .. }) =
            self.columns.iter().find(|c| c.name == "n_links").map(|c| &c.data)
        else {
            return Ok(());
        };
        let configurations = self.text("configuration").ok();
        for (row, &found) in n_links.iter().enumerate() {
            if found < 0.0 || found.fract() != 0.0 {
                let problem = format!("is {found}; it counts links: 0, 1, 2, …");
                return Err(RecordError::value(self.place_of_row(row), "n_links", problem));
            }
            if let Some(configuration) = configurations.and_then(|c| c.get(row))
                && let Some(expected) = links_of_configuration(configuration).map(f64::from)
                && expected != found
            {
                let links = if expected == 1.0 { "link" } else { "links" };
                let problem =
                    format!("{configuration} has {expected} {links}, but `n_links` is {found}; correct one of them");
                return Err(RecordError::value(self.place_of_row(row), "configuration", problem));
            }
        }
        Ok(())
    }
}

/// Links k of a configuration named HkLT; `None` for any other name.
#[must_use]
pub fn links_of_configuration(configuration: &str) -> Option<u32> {
    let digits = configuration.strip_prefix('H')?.strip_suffix("LT")?;
    let is_plain = (1..=6).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
    if is_plain { digits.parse().ok() } else { None }
}
