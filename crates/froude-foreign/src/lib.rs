//! Files of other programs as named columns. Nothing is interpreted here: names, units and numbers are those of the file.
//!
//! | files | module | read by |
//! |---|---|---|
//! | `.xlsx`, `.xls`, `.ods` | [`sheet`] | the crate calamine; `.ods` and the checks before it by this crate |
//! | `.mat` of MATLAB 5 to 7.2 and Octave | [`mat5`] | this crate |
//! | `.mat` of MATLAB 7.3, HDF5 | [`hdf5`] | the crate hdf5-pure |
//! | `.mcap` with ROS 2 or JSON messages | [`mod@mcap`] | records by the crate mcap; messages by this crate |
//! | `.tdms` of LabVIEW, DAQmx, DIAdem | [`tdms`] | this crate |
//! | `.ulg` of PX4 | [`ulog`] | this crate |
//!
//! Nothing is repaired: what cannot be read is named with its place and with what to do. Files of more than 2 GiB and tables of more
//! than 50 million cells are rejected, and no file makes a reader panic or allocate what its size does not justify.
//!
//! Not covered: writing, and what a column means.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod compound;
mod guard;
pub mod hdf5;
pub mod mat5;
pub mod mcap;
pub mod sheet;
pub mod tdms;
pub mod ulog;
mod variables;

/// Largest file that is read, and the most that a compressed file may unpack to, bytes.
pub const MAX_BYTES: u64 = 2 << 30;
/// Most cells that a table may have.
pub const MAX_CELLS: usize = 50_000_000;

pub mod decode;
pub mod layout;
pub mod marks;
pub mod split;

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

impl Cells {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Texts(texts) => texts.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The tables of a file, and what of it is not in them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Contents {
    /// Its tables.
    pub parts: Vec<Part>,
    /// What is in the file and in no table: to be named to the user.
    pub left_out: Vec<LeftOut>,
    /// What else was passed over or is missing, and which clock times are of; each a sentence.
    pub notes: Vec<String>,
}

/// A variable or dataset that is in no table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// Its name in the file.
    pub name: String,
    /// Why, and what to do: "is complex; save real(z) and imag(z)".
    pub reason: String,
}

/// Why a file cannot be read. The caller names the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct ForeignError(pub String);
