//! What a verb returns: blocks, declared once and shown by every front end.
//!
//! A column of a table is declared in one line: its key for programs, its head for people, and how it follows from a row. Terminal, page,
//! JSON, CSV and schema follow from that.
//!
//! **Units.** Numbers are in SI, and a key ends in the SI unit of its numbers (`speed_m_s`). A head may name another unit in brackets
//! (`speed [kn]`): people read the number in that one. **Missing numbers.** NaN and `None` are shown as "—", and are null in JSON.

mod builder;
mod cell;
mod json;
mod laid_out;
mod schema;
#[cfg(test)]
mod tests;

pub use builder::{TableBuilder, facts};
pub use json::Tree;
pub(crate) use json::tree;
pub use laid_out::{LaidOut, laid_out};
pub use schema::Schema;

use crate::estimate::Estimate;
use crate::page::{Chart, Field, Map};
use crate::units::Unit;

/// One part of an answer.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// Sentences; with a key, a program reads them as a list.
    Text {
        /// Their place in JSON; empty: not in JSON.
        key: String,
        /// One a paragraph.
        texts: Vec<String>,
    },
    /// A table.
    Table(ResultTable),
    /// A figure.
    Chart(Chart),
    /// One quantity over two.
    Map(Map),
    /// A quantity over a plane.
    Field(Field),
    /// Blocks under a heading.
    Section(Section),
    /// Estimates as records have them: JSON only, at the key `estimates`.
    Estimates(Vec<Estimate>),
}

/// Blocks under a heading.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// An object of JSON that holds the blocks; `draws[]` is one of a list of such, an empty key adds them to what the section lies in.
    pub key: String,
    /// Heading.
    pub title: String,
    /// In order.
    pub blocks: Vec<Block>,
    /// Pages alone show it.
    pub is_detail: bool,
}

/// A table of results, column by column.
///
/// **JSON.** A list of objects at its key, or an object for a table of facts. A key with `/` nests: `added_mass/surge_kg`. Tables of one
/// key are one list, of which each holds some columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ResultTable {
    /// Its place in JSON; empty: a table of facts adds them to what it lies in, and another table is not in JSON.
    pub key: String,
    /// Caption.
    pub caption: String,
    /// Columns, each with a cell per row.
    pub columns: Vec<ResultColumn>,
    /// How many.
    pub n_rows: usize,
    /// A table of one row, which people read as quantity, value and unit; what is missing is left out for them.
    pub are_facts: bool,
    /// How many of the first columns name a row, beside the first: those that are repeated where a table is too wide.
    pub more_names: usize,
    /// Rows that people see; `None`: all of them.
    pub shown_rows: Option<Vec<usize>>,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultColumn {
    /// Its place in the object of a row; empty: not in JSON.
    pub key: String,
    /// What people read above it, without its unit; empty: JSON only.
    pub head: String,
    /// The unit that people read, where there is one.
    pub unit: Option<Unit>,
    /// A cell per row.
    pub cells: Cells,
    /// Standard uncertainties of its numbers, SI, with their place in JSON.
    pub standard: Option<(String, Vec<f64>)>,
    /// How its numbers are written.
    pub digits: Digits,
}

/// The cells of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// SI.
    Number(Vec<f64>),
    /// How many.
    Count(Vec<Option<usize>>),
    /// Ends of an interval, SI.
    Interval(Vec<Option<[f64; 2]>>),
    /// Numbers of one kind, SI.
    Numbers(Vec<Option<Vec<f64>>>),
    /// Words.
    Text(Vec<Option<String>>),
    /// Several words.
    Texts(Vec<Vec<String>>),
    /// Whether it is so.
    Flag(Vec<Option<bool>>),
}

/// How a number is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Digits {
    /// n significant digits.
    Significant(u8),
    /// As a person would type it, with at most n significant digits.
    Plain(u8),
    /// Decimal places.
    Places(u8),
    /// A part of the whole in percent.
    Percent,
    /// A probability.
    PValue,
    /// The least and the largest, which are no interval of uncertainty.
    Range,
    /// A time as a person says it.
    Duration,
    /// A size in bytes.
    Bytes,
    /// A normalised difference E_n, which a page marks where it is beyond 1.
    Normalised,
    /// A name, which a page sets as a symbol.
    Symbol,
}

impl Block {
    /// Sentences; with a key, a program reads them as a list.
    #[must_use]
    pub fn text(key: &str, texts: Vec<String>) -> Self {
        Self::Text { key: key.to_owned(), texts }
    }

    /// Sentences that are not in JSON.
    pub fn words(texts: impl IntoIterator<Item = String>) -> Self {
        Self::text("", texts.into_iter().collect())
    }
}

impl Section {
    /// Blocks under a heading, for people; in JSON they belong to what the section lies in.
    pub fn new(title: impl Into<String>, blocks: impl IntoIterator<Item = Block>) -> Self {
        Self { title: title.into(), blocks: blocks.into_iter().collect(), ..Self::default() }
    }
}

impl From<Chart> for Block {
    fn from(chart: Chart) -> Self {
        Self::Chart(chart)
    }
}

impl From<ResultTable> for Block {
    fn from(table: ResultTable) -> Self {
        Self::Table(table)
    }
}

impl From<Section> for Block {
    fn from(section: Section) -> Self {
        Self::Section(section)
    }
}
