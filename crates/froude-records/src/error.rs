//! Why a file cannot be read or written, with the place where it went wrong.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::memory::Exhausted;
use crate::question::Question;
use crate::units::LARGEST_SI;

/// Where in a file something stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file, as it was asked for.
    pub path: PathBuf,
    /// Where in it.
    pub position: Position,
}

/// Position in a file; lines, columns and rows are counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Position {
    /// The file as a whole.
    Whole,
    /// A line of a text file.
    Line(usize),
    /// A character of a text file.
    Character {
        /// Its line.
        line: usize,
        /// Its place in the line, in characters.
        column: usize,
    },
    /// A row of a table without lines (Parquet).
    Row(usize),
    /// A byte of a binary file, counted from 0 as other tools do.
    Byte(u64),
}

/// Endings of files that are no text, and have rows.
const WITHOUT_LINES: [&str; 11] = ["parquet", "xlsx", "xlsm", "xls", "ods", "mat", "h5", "hdf5", "tdms", "ulg", "mcap"];

impl Place {
    /// The file as a whole.
    #[must_use]
    pub fn whole(path: &Path) -> Self {
        Self { path: path.to_owned(), position: Position::Whole }
    }

    /// A line, counted from 1.
    #[must_use]
    pub fn line(path: &Path, line: usize) -> Self {
        Self { path: path.to_owned(), position: Position::Line(line) }
    }

    /// A character, line and column counted from 1.
    #[must_use]
    pub fn character(path: &Path, line: usize, column: usize) -> Self {
        Self { path: path.to_owned(), position: Position::Character { line, column } }
    }

    /// A byte of a binary file, counted from 0.
    #[must_use]
    pub fn byte(path: &Path, byte: u64) -> Self {
        Self { path: path.to_owned(), position: Position::Byte(byte) }
    }

    /// A row of a table, counted from 1: a line where the file is text.
    #[must_use]
    pub fn in_table(path: &Path, number: usize) -> Self {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let has_rows = ending.is_some_and(|ending| WITHOUT_LINES.contains(&ending.as_str()));
        if has_rows { Self::row(path, number) } else { Self::line(path, number) }
    }

    /// A row, counted from 1.
    #[must_use]
    pub fn row(path: &Path, row: usize) -> Self {
        Self { path: path.to_owned(), position: Position::Row(row) }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.path.display();
        match self.position {
            Position::Whole => write!(f, "{path}"),
            Position::Line(line) => write!(f, "{path}:{line}"),
            Position::Character { line, column } => write!(f, "{path}:{line}:{column}"),
            Position::Row(row) => write!(f, "{path}, row {row}"),
            Position::Byte(byte) => write!(f, "{path}, byte {byte}"),
        }
    }
}

/// Why a record cannot be read or written.
///
/// Every message names the file and, where there is one, the line; says what was
/// found and what was expected; and ends with what to do where that is not plain.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// A log of another program where a recorded run is expected.
    #[error(
        "{}: an MCAP log of another program (topics {topics}); expected a run that `froude run` recorded. `froude inspect {}` lists its \
         topics and their fields; a sidecar with [columns] reads a topic as a table, and `froude convert` writes it as CSV",
        path.display(), path.display()
    )]
    ForeignLog {
        /// The file.
        path: PathBuf,
        /// Its first topics.
        topics: String,
    },
    /// A file that another file names does not exist.
    #[error("{place}: `{key}` names {}, which does not exist", path.display())]
    MissingFile {
        /// Where it is named.
        place: Place,
        /// The key that names it.
        key: String,
        /// The file that was looked for.
        path: PathBuf,
    },
    /// The file cannot be written; what stood there before is untouched.
    #[error("cannot write {}: {reason}; nothing was changed", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// A folder that is replaced as a whole is the one that this program works in, or holds it.
    #[error("cannot write {}: the program was started in it, and the folder is replaced as a whole; name a folder inside it", path.display())]
    StartedIn {
        /// The folder.
        path: PathBuf,
    },
    /// The file is larger than its kind should ever be.
    #[error("{} has {bytes} bytes; the limit for {what} is {limit}", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
        /// The most that is read.
        limit: u64,
        /// What kind of file it was read as.
        what: &'static str,
    },
    /// A folder or file of the output could not be made.
    #[error("{}: cannot be written: {reason}; choose another place with --out", .path.display())]
    Output {
        /// The folder or file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// The machine has not the memory that the file needs.
    #[error("{}: {source}; close other programs, or read a smaller file", path.display())]
    Memory {
        /// The file.
        path: PathBuf,
        /// How much it needs.
        source: Exhausted,
    },
    /// What stands at a place is not what its format asks for.
    #[error("{place}: {problem}")]
    Syntax {
        /// Where.
        place: Place,
        /// What is wrong and what to do.
        problem: String,
    },
    /// What stands at a place can be read in several ways, and only a person knows which is meant.
    #[error("{place}: {question}")]
    Asked {
        /// Where.
        place: Place,
        /// What is to be decided.
        #[source]
        question: Question,
    },
    /// A binary file is cut off or damaged.
    #[error(
        "{}: not a whole Parquet file ({reason}); it is truncated or damaged: copy or export it again",
        path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What the reader says.
        reason: String,
    },
    /// What a file says is not what its own `checksum` was written for.
    #[error(
        "{place}: the content is not what this checksum was written for: the file was edited or damaged. Copy it again from \
         where it was written; to adopt an edit, delete this line"
    )]
    Checksum {
        /// The line of the checksum.
        place: Place,
    },
    /// The record was written for a later version of the format.
    #[error("{place}: this is {found}; this program reads up to {known}: use a newer Froude")]
    NewerSchema {
        /// Where.
        place: Place,
        /// The version in the file.
        found: String,
        /// The newest version that is understood.
        known: String,
    },
    /// A value that the key cannot take.
    #[error("{place}: `{key}` {problem}")]
    Value {
        /// Where.
        place: Place,
        /// The key.
        key: String,
        /// What is wrong, as the rest of a sentence about the key.
        problem: String,
    },
    /// A table without observations.
    #[error("{}: the table has no rows; at least one observation is needed", path.display())]
    NoRows {
        /// The file.
        path: PathBuf,
    },
    /// A number that JSON cannot hold.
    #[error("cannot write {}: {item} is {value}, not a finite number; nothing was changed", path.display())]
    NonFinite {
        /// The file.
        path: PathBuf,
        /// Which number.
        item: String,
        /// Its value.
        value: String,
    },
    /// What is asked for cannot be done, in words.
    #[error("{0}")]
    Refused(String),
    /// A run is there already: no recording is ever overwritten.
    #[error("cannot record {}: a run of this name is there already; give the new run another id, or move the old one", path.display())]
    RunExists {
        /// The file.
        path: PathBuf,
    },
    /// Recording failed in the middle of a run: the carriage has to be stopped (category 1).
    #[error(
        "cannot go on recording {}: {reason}; the {ticks} ticks before it are kept: stop the carriage, free the disk, and repeat the run",
        path.display()
    )]
    Recording {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
        /// Ticks that lie in the file whole.
        ticks: u64,
    },
}

impl RecordError {
    /// True where writing failed: the machine is at fault, not the input.
    #[must_use]
    pub fn is_output(&self) -> bool {
        matches!(
            self,
            Self::Memory { .. }
                | Self::Write { .. }
                | Self::Output { .. }
                | Self::NonFinite { .. }
                | Self::Recording { .. }
                | Self::RunExists { .. }
        )
    }
}

impl RecordError {
    /// Whose a file is that would be replaced, and is not what Froude wrote; `problem` follows on it.
    pub(crate) fn not_ours(path: &Path, is_changed: bool, problem: impl fmt::Display) -> Self {
        let whose = if is_changed { "was changed after Froude wrote it" } else { "was not written by Froude" };
        Self::Refused(format!("{} {whose}, {problem}", path.display()))
    }

    /// What stands at a place is not what its format asks for.
    pub fn syntax(place: Place, problem: impl Into<String>) -> Self {
        Self::Syntax { place, problem: problem.into() }
    }

    /// A key cannot take its value; `problem` is the rest of a sentence about the key.
    pub fn value(place: Place, key: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Value { place, key: key.into(), problem: problem.into() }
    }

    /// A column of a table cannot be as it is; `problem` follows on its name: ` has …`, or `: the unit …`.
    pub(crate) fn column(place: Place, column: &str, problem: impl fmt::Display) -> Self {
        Self::syntax(place, format!("column `{column}`{problem}"))
    }

    /// A column that a table does not have.
    pub(crate) fn unknown_column(place: Place, column: &str, advice: impl fmt::Display) -> Self {
        Self::syntax(place, format!("there is no column `{column}`; {advice}"))
    }

    /// A column whose unit measures something else.
    pub(crate) fn wrong_dimension(place: Place, column: &str, expected: &str, found: &str) -> Self {
        Self::column(place, column, format!(": wrong unit: expected {expected}, found {found}"))
    }

    /// A cell without content; `advice` is what to do: a column that a table can do without may also be left out.
    #[must_use]
    pub fn empty_cell(place: Place, column: &str, advice: &str) -> Self {
        Self::column(place, column, format!(": the cell is empty; {advice}"))
    }

    /// A cell with NaN, an infinity, or a number beyond what is taken for a measurement.
    pub(crate) fn not_finite(place: Place, column: &str, found: &str) -> Self {
        let what = match found.parse::<f64>() {
            Ok(x) if x.is_finite() => format!("exceeds the limit of {LARGEST_SI:e} (SI)"),
            _ => "is not a finite number".to_owned(),
        };
        Self::column(place, column, format!(": `{found}` {what}; correct it or delete the row"))
    }

    /// A file that is larger than its kind should ever be.
    pub(crate) fn too_large(path: &Path, bytes: u64, limit: u64, what: &'static str) -> Self {
        Self::TooLarge { path: path.to_owned(), bytes, limit, what }
    }

    /// The file that the memory was asked for.
    pub(crate) fn memory(path: &Path, source: Exhausted) -> Self {
        Self::Memory { path: path.to_owned(), source }
    }
}

/// The system's words for a failed operation, in the words of a person where they differ.
pub(crate) fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file or folder".to_owned(),
        std::io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        std::io::ErrorKind::AlreadyExists => "something of this name is there already".to_owned(),
        std::io::ErrorKind::StorageFull => "the disk is full".to_owned(),
        std::io::ErrorKind::NotADirectory => "its folder is not a folder".to_owned(),
        std::io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        std::io::ErrorKind::ReadOnlyFilesystem => "the disk is read-only".to_owned(),
        std::io::ErrorKind::FileTooLarge => {
            "the file would be larger than the limit of this shell (ulimit -f) or of the disk".to_owned()
        }
        _ => error.to_string(),
    }
}

/// A number that may have three hundred digits.
pub(crate) fn briefly(number: f64) -> String {
    if number.is_finite() && number.abs() >= 1e15 { format!("{number:e}") } else { number.to_string() }
}

/// What to do about a number that is written with a decimal comma.
pub(crate) fn decimal_comma(found: &str) -> &'static str {
    let mut parts = found.trim().splitn(2, ',');
    let digits = |p: Option<&str>| {
        p.is_some_and(|p| !p.is_empty() && p.trim_start_matches(['-', '+']).chars().all(|c| c.is_ascii_digit()))
    };
    if digits(parts.next()) && digits(parts.next()) { "; write a decimal point, not a comma" } else { "" }
}
