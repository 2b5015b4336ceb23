//! Why a table of numbers cannot be read.

use std::path::PathBuf;

/// Why a long CSV file cannot be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FastCsvError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },

    /// There is no header line, or it is not text.
    #[error("{}:1: {problem}; the first line must name the columns", path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: &'static str,
    },

    /// Two columns have the same name.
    #[error("{}:1: column `{column}` appears twice; rename or delete one", path.display())]
    DuplicateColumn {
        /// The file.
        path: PathBuf,
        /// The name.
        column: String,
    },

    /// No column has this name.
    #[error("{}:1: there is no column `{column}`; the columns are {known}", path.display())]
    NoSuchColumn {
        /// The file.
        path: PathBuf,
        /// The name that was asked for.
        column: String,
        /// The names that exist.
        known: String,
    },

    /// There is a header but nothing below it.
    #[error("{}: the table has no rows; at least one observation is needed", path.display())]
    NoRows {
        /// The file.
        path: PathBuf,
    },

    /// A cell is quoted.
    #[error(
        "{}:{line}: column `{column}` is quoted; long tables are read without quotes: write \
         plain numbers, or read the file as a small table", path.display()
    )]
    Quoted {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// The column.
        column: String,
    },

    /// A row has another number of cells than the header.
    #[error("{}:{line}: the row has {}, the header has {expected}", path.display(), crate::text::counted(*found, "cell", "cells"))]
    Ragged {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// Cells in the row.
        found: usize,
        /// Cells in the header.
        expected: usize,
    },

    /// A line between rows is blank.
    #[error("{}:{line}: the line is blank; delete it", path.display())]
    Blank {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: u64,
    },

    /// A cell is empty.
    #[error(
        "{}:{line}: column `{column}`: the cell is empty; fill it in or delete the row",
        path.display()
    )]
    Empty {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// The column.
        column: String,
    },

    /// A cell is not a number.
    #[error("{}:{line}: column `{column}`: `{found}` is not a number", path.display())]
    NotANumber {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// The column.
        column: String,
        /// The cell.
        found: String,
    },

    /// A cell is NaN, infinite, or beyond the range of double precision.
    #[error(
        "{}:{line}: column `{column}`: `{found}` is not a finite number; delete the row",
        path.display()
    )]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// The column.
        column: String,
        /// The cell.
        found: String,
    },

    /// A line does not fit into a chunk.
    #[error(
        "{}:{line}: the line is longer than {limit} bytes; is this a CSV file?", path.display()
    )]
    LineTooLong {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// The most that a line may have.
        limit: usize,
    },
}
