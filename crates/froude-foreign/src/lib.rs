//! Files of other programs as named columns. Nothing is interpreted here: names, units and numbers are those of the file.

pub mod mcap;
pub mod tdms;
pub mod ulog;

/// Most cells that a table may have.
pub const MAX_CELLS: usize = 50_000_000;

/// A table in a file: a sheet, a group of channels, a topic, a structure.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Part {
    /// Its name in the file; empty where the file has only one.
    pub name: String,
    /// Its columns, all of one length.
    pub columns: Vec<Column>,
}

/// A column as the file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// The unit as the file states it; empty where it states none.
    pub unit: String,
    /// Its cells.
    pub cells: Cells,
}

/// The cells of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// Numbers; NaN where the file has NaN.
    Numbers(Vec<f64>),
    /// Texts.
    Texts(Vec<String>),
}

/// Why a file cannot be read. The caller names the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct ForeignError(pub String);

/// What was read of a log, and what of it was not.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Contents {
    /// Its topics or groups.
    pub parts: Vec<Part>,
    /// What was passed over or is missing, and which clock the times are of; each a sentence for the user.
    pub notes: Vec<String>,
}
