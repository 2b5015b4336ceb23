//! Files of other programs as named columns. Nothing is interpreted here: names, units and numbers are those of the file.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod openfast;
pub mod refused;

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
