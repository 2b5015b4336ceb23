//! Long numeric CSV files, read a chunk at a time in bounded memory.
//!
//! For logs of millions of rows that need not lie in memory: the file is read in
//! chunks of whole lines, each turned into columns of numbers and handed on. Memory
//! is a few chunks, whatever the file's length. The small tables of a campaign, with
//! units, text columns and sidecars, are read by [`csv_table`](crate::csv_table).
//!
//! **Format.** The first line names the columns, as `name` or `name [unit]`; cells are
//! separated by commas, lines end in `\n` or `\r\n`. Names may be quoted. Every cell that is read is a
//! finite decimal number. Quoted cells, rows of another length than the header, empty
//! cells, NaN and blank lines are refused with their line and column. Columns that are
//! not selected are passed over unread, so they may hold text (without quotes).
//!
//! **Exact.** Numbers are the same, bit for bit, as those of `str::parse::<f64>`: up to
//! 8 digits before the point and 16 after, below 2⁵² without the point, are an integer
//! divided by a power of ten that is exact, which rounds once (Clinger 1990); all
//! others go through `fast-float2`.
//!
//! **Order.** Chunks are cut by their place in the file and folded in that order, so a
//! result does not depend on the number of threads, not even in the last bit.
//!
//! ```
//! # use std::io::Write;
//! # let mut file = tempfile::NamedTempFile::new()?;
//! # write!(file, "speed [m/s],f_x [N]\n0.5,-1.25\n1.0,-5.0\n")?;
//! # let path = file.path();
//! use froude_records::fast_csv::{FastCsv, FastCsvError};
//!
//! let csv = FastCsv::open(path)?.select(&["f_x", "speed"])?;
//! let mut power_w = 0.0;
//! csv.for_each_chunk(|columns, _first_line| {
//!     let [force, speed] = columns else { return Ok(()) };
//!     power_w += force.iter().zip(*speed).map(|(f, u)| f * u).sum::<f64>();
//!     Ok::<(), FastCsvError>(())
//! })?;
//! assert_eq!(power_w, -5.625);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod number;
mod parallel;
#[cfg(test)]
mod tests;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use memchr::{memchr, memchr_iter, memrchr};
use number::{fast_number, separators, slow_number, without_blanks};

use crate::error::RecordError;
pub use crate::fast_csv::error::FastCsvError;

/// Bytes read at a time: raw text and columns stay in the second-level cache.
const CHUNK_BYTES: usize = 256 * 1024;

/// Readable zeros behind a chunk, so that words may be loaded at its end.
const PADDING: usize = 32;

/// What was read in the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Summary {
    /// Rows, without the header.
    pub rows: u64,
    /// Bytes, with the header.
    pub bytes: u64,
    /// Chunks.
    pub chunks: u64,
}

/// Some rows of the file.
#[derive(Debug, Clone, Copy)]
pub struct Chunk<'a> {
    /// The selected columns in the order of selection, all equally long.
    pub columns: &'a [&'a [f64]],
    /// Line of the first row, counted from 1 (the header is line 1).
    pub first_line: u64,
    /// Number of the chunk, from 0.
    pub index: u64,
}

/// A long CSV file, open at its first row.
#[derive(Debug)]
pub struct FastCsv {
    reader: Reader,
    layout: Layout,
}

impl FastCsv {
    /// Opens a file and reads its header. All columns are selected.
    ///
    /// # Errors
    ///
    /// [`FastCsvError`]: `Read`, `Header`, `DuplicateColumn`.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, FastCsvError> {
        Self::open_with(path.as_ref(), CHUNK_BYTES)
    }

    /// Opens a file that is to be read `chunk_bytes` at a time; at least 64, at most 2³⁰.
    ///
    /// No line may be longer than a chunk.
    ///
    /// # Errors
    ///
    /// As [`FastCsv::open`].
    pub fn open_with(path: &Path, chunk_bytes: usize) -> Result<Self, FastCsvError> {
        let header = |problem| FastCsvError::Header { path: path.to_owned(), problem };
        let mut reader = Reader::open(path, chunk_bytes)?;
        let mut start = reader.beginning()?;
        let Some(end) = memchr(b'\n', &start) else {
            return Err(if reader.has_ended { header("there is no line end") } else { reader.too_long() });
        };
        let line = start[..end].strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&start[..end]);
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let text = std::str::from_utf8(line).map_err(|_| header("it is not UTF-8 text"))?;
        let headers: Vec<String> = text.split(',').map(|cell| unquoted(cell.trim())).collect();
        if headers.iter().any(|column| column.contains('"')) {
            return Err(header("a name holds a comma or a quote"));
        }
        if headers.iter().any(String::is_empty) {
            return Err(header("a column has no name"));
        }
        for (i, column) in headers.iter().enumerate() {
            if headers[..i].iter().any(|other| name_of(other) == name_of(column)) {
                return Err(FastCsvError::DuplicateColumn {
                    path: path.to_owned(),
                    column: name_of(column).to_owned(),
                });
            }
        }
        reader.go_on(start.split_off(end + 1), 2);
        let slots = (0..headers.len()).map(Some).collect();
        Ok(Self { reader, layout: Layout { selected: headers.len(), headers, slots } })
    }

    /// The headers as they stand in the file, with their units, without quotes.
    #[must_use]
    pub fn headers(&self) -> &[String] {
        &self.layout.headers
    }

    /// Index of a column, by its name or by its whole header `name [unit]`.
    ///
    /// # Errors
    ///
    /// [`FastCsvError::NoSuchColumn`].
    pub fn column(&self, name: &str) -> Result<usize, FastCsvError> {
        let headers = &self.layout.headers;
        headers.iter().position(|header| header == name || name_of(header) == name).ok_or_else(|| {
            FastCsvError::NoSuchColumn {
                path: self.reader.path.clone(),
                column: name.to_owned(),
                known: headers.join(", "),
            }
        })
    }

    /// Unit of a column as it is written between the brackets, if it is.
    #[must_use]
    pub fn unit(&self, column: usize) -> Option<&str> {
        let header = self.layout.headers.get(column)?;
        header.strip_suffix(']')?.split_once('[').map(|(_, unit)| unit.trim())
    }

    /// Reads only these columns, in this order; all others are passed over.
    ///
    /// # Errors
    ///
    /// [`FastCsvError::NoSuchColumn`], and [`FastCsvError::DuplicateColumn`] for a column
    /// selected twice.
    pub fn select(mut self, names: &[&str]) -> Result<Self, FastCsvError> {
        let mut slots = vec![None; self.layout.headers.len()];
        for (slot, name) in names.iter().enumerate() {
            let column = self.column(name)?;
            if slots[column].replace(slot).is_some() {
                return Err(FastCsvError::DuplicateColumn {
                    path: self.reader.path.clone(),
                    column: (*name).to_owned(),
                });
            }
        }
        self.layout.slots = slots;
        self.layout.selected = names.len();
        Ok(self)
    }

    /// Hands on every chunk in order: the selected columns, and the line of their first
    /// row (the header is line 1).
    ///
    /// # Errors
    ///
    /// The first [`FastCsvError`] in the file's order, or what `each` returns.
    pub fn for_each_chunk<E, F>(self, mut each: F) -> Result<Summary, E>
    where
        F: FnMut(&[&[f64]], u64) -> Result<(), E>,
        E: From<FastCsvError>,
    {
        let Self { mut reader, layout } = self;
        let mut memory = Memory::default();
        while let Some(lines) = reader.next(&mut memory.text)? {
            let columns = layout.parse(&reader.path, &mut memory, &lines)?;
            each(&columns, lines.first)?;
        }
        Ok(reader.finish()?)
    }
}

/// A header cell without the quotes that some programs put around every name.
fn unquoted(cell: &str) -> String {
    let inner = cell.strip_prefix('"').and_then(|cell| cell.strip_suffix('"'));
    inner.unwrap_or(cell).trim().to_owned()
}

/// The name in front of the unit.
fn name_of(header: &str) -> &str {
    match header.strip_suffix(']').and_then(|header| header.split_once('[')) {
        Some((name, _)) if !name.trim().is_empty() => name.trim(),
        _ => header,
    }
}

/// Memory for one chunk.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    /// Whole lines, then zeros.
    pub(crate) text: Vec<u8>,
    /// Where every cell ends.
    ends: Vec<u32>,
    /// Column after column.
    numbers: Vec<f64>,
}

/// The lines of a chunk.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lines {
    index: u64,
    pub(crate) first: u64,
    pub(crate) count: usize,
    /// Their bytes, without the zeros behind them.
    pub(crate) bytes: usize,
}

/// The file, cut into chunks of whole lines.
#[derive(Debug)]
pub(crate) struct Reader {
    path: PathBuf,
    file: File,
    chunk_bytes: usize,
    /// What was read beyond the last whole line.
    carry: Vec<u8>,
    next_line: u64,
    summary: Summary,
    has_ended: bool,
}

impl Reader {
    /// Opens a file that is to be read `chunk_bytes` at a time.
    pub(crate) fn open(path: &Path, chunk_bytes: usize) -> Result<Self, FastCsvError> {
        Ok(Self {
            path: path.to_owned(),
            file: crate::read::open(path).map_err(|error| match error {
                RecordError::Read { path, reason } => FastCsvError::Read { path, reason },
                other => FastCsvError::Read { path: path.to_owned(), reason: other.to_string() },
            })?,
            chunk_bytes: chunk_bytes.clamp(64, 1 << 30),
            carry: Vec::new(),
            next_line: 1,
            summary: Summary::default(),
            has_ended: false,
        })
    }

    /// The beginning of the file, up to a chunk.
    pub(crate) fn beginning(&mut self) -> Result<Vec<u8>, FastCsvError> {
        let mut start = Vec::new();
        self.fill(&mut start)?;
        Ok(start)
    }

    /// Goes on with what is left of the beginning, from a line on.
    pub(crate) fn go_on(&mut self, rest: Vec<u8>, line: u64) {
        self.carry = rest;
        self.next_line = line;
    }

    /// Reads until `text` has a chunk's bytes or the file ends.
    fn fill(&mut self, text: &mut Vec<u8>) -> Result<(), FastCsvError> {
        let missing = self.chunk_bytes.saturating_sub(text.len());
        text.reserve(missing + PADDING);
        let got = (&mut self.file)
            .take(missing as u64)
            .read_to_end(text)
            .map_err(|error| FastCsvError::Read { path: self.path.clone(), reason: error.to_string() })?;
        self.summary.bytes += got as u64;
        self.has_ended = got < missing;
        Ok(())
    }

    /// The next whole lines, followed by padding; None at the end.
    pub(crate) fn next(&mut self, text: &mut Vec<u8>) -> Result<Option<Lines>, FastCsvError> {
        text.clear();
        text.append(&mut self.carry);
        if !self.has_ended {
            self.fill(text)?;
        }
        if self.has_ended && text.last().is_some_and(|&last| last != b'\n') {
            text.push(b'\n');
        }
        let Some(last) = memrchr(b'\n', text) else {
            return if text.is_empty() { Ok(None) } else { Err(self.too_long()) };
        };
        // Blank lines at the end of the file do not count; elsewhere they are refused.
        let mut end = last + 1;
        while let Some(before) = end_of_line_before(&text[..end]) {
            end = before;
        }
        if !self.has_ended {
            self.carry.extend_from_slice(&text[end..]);
            if end == 0 {
                return Err(FastCsvError::Blank { path: self.path.clone(), line: self.next_line });
            }
        } else if end == 0 {
            return Ok(None);
        }
        text.truncate(end);
        let lines = Lines {
            index: self.summary.chunks,
            first: self.next_line,
            count: memchr_iter(b'\n', text).count(),
            bytes: end,
        };
        text.resize(end.next_multiple_of(16) + PADDING, 0);
        self.next_line += lines.count as u64;
        self.summary.chunks += 1;
        self.summary.rows += lines.count as u64;
        Ok(Some(lines))
    }

    fn too_long(&self) -> FastCsvError {
        FastCsvError::LineTooLong { path: self.path.clone(), line: self.next_line, limit: self.chunk_bytes }
    }

    /// What was read; refuses a table without rows.
    fn finish(self) -> Result<Summary, FastCsvError> {
        if self.summary.rows == 0 {
            return Err(FastCsvError::NoRows { path: self.path });
        }
        Ok(self.summary)
    }
}

/// Where the text ends without its last line, if that line is blank.
fn end_of_line_before(text: &[u8]) -> Option<usize> {
    let line = text.strip_suffix(b"\n")?;
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    (line.is_empty() || line.ends_with(b"\n")).then_some(line.len())
}

/// Which column goes where.
#[derive(Debug)]
pub(crate) struct Layout {
    headers: Vec<String>,
    /// For every column of the file its place among the selected.
    slots: Vec<Option<usize>>,
    selected: usize,
}

impl Layout {
    /// Columns of which some are read, in their order.
    pub(crate) fn of(headers: &[String], is_read: &[bool]) -> Self {
        let mut selected = 0;
        let slots = is_read.iter().map(|&is_read| {
            selected += usize::from(is_read);
            is_read.then(|| selected - 1)
        });
        Self { slots: slots.collect(), headers: headers.to_vec(), selected }
    }

    /// Turns the lines in `memory` into columns.
    pub(crate) fn parse<'a>(
        &self,
        path: &Path,
        memory: &'a mut Memory,
        lines: &Lines,
    ) -> Result<Vec<&'a [f64]>, FastCsvError> {
        let Memory { text, ends, numbers } = memory;
        let (rows, width) = (lines.count, self.headers.len());
        numbers.resize(self.selected * rows, 0.0);
        ends.resize(rows * width + 16, 0);
        let found = separators(text, ends);
        // A quote could hide a separator in a cell that is passed over.
        let is_plain = self.selected == width || memchr(b'"', text).is_none();
        let bad_row = if is_plain { self.parse_rows(text, &ends[..found], rows, numbers).err() } else { Some(0) };
        if let Some(first) = bad_row {
            return Err(self.diagnose(path, text, lines, first));
        }
        let numbers = &memory.numbers;
        Ok((0..self.selected).map(|slot| &numbers[slot * rows..(slot + 1) * rows]).collect())
    }

    /// Reads all rows, given where their cells end; stops at the first bad row.
    fn parse_rows(&self, text: &[u8], ends: &[u32], rows: usize, numbers: &mut [f64]) -> Result<(), usize> {
        let mut start = 0;
        for (row, cells) in ends.chunks(self.slots.len()).enumerate() {
            if cells.len() != self.slots.len() || row >= rows {
                return Err(row);
            }
            for (k, (slot, &end)) in self.slots.iter().zip(cells).enumerate() {
                let end = end as usize;
                let is_last = k + 1 == cells.len();
                if text.get(end) != Some(if is_last { &b'\n' } else { &b',' }) {
                    return Err(row);
                }
                if let Some(slot) = slot {
                    let has_return = is_last && end > start && text[end - 1] == b'\r';
                    let cell_end = end - usize::from(has_return);
                    let value = match fast_number(text, start, cell_end) {
                        Some(value) => value,
                        None => text.get(start..cell_end).and_then(slow_number).ok_or(row)?,
                    };
                    *numbers.get_mut(slot * rows + row).ok_or(row)? = value;
                }
                start = end + 1;
            }
        }
        Ok(())
    }

    /// Says what is wrong with the first bad line, which is line `first` of the chunk or later.
    #[cold]
    fn diagnose(&self, path: &Path, text: &[u8], lines: &Lines, first: usize) -> FastCsvError {
        let rows = text.split(|&byte| byte == b'\n').take(lines.count);
        for (k, row) in rows.enumerate().skip(first) {
            let row = row.strip_suffix(b"\r").unwrap_or(row);
            if let Err(error) = self.check_row(path, row, lines.first + k as u64) {
                return error;
            }
        }
        // Not reached: a row that is good by itself is read.
        FastCsvError::Read { path: path.to_owned(), reason: "the rows do not add up".to_owned() }
    }

    /// Says what is wrong with a row, if anything is.
    fn check_row(&self, path: &Path, row: &[u8], line: u64) -> Result<(), FastCsvError> {
        let path = path.to_owned();
        let cells: Vec<&[u8]> = row.split(|&byte| byte == b',').collect();
        if row.is_empty() {
            return Err(FastCsvError::Blank { path, line });
        }
        let named = |k: usize| match self.headers.get(k) {
            Some(header) => name_of(header).to_owned(),
            None => format!("{}", k + 1),
        };
        if let Some(k) = cells.iter().position(|cell| cell.contains(&b'"')) {
            let column = named(k);
            return Err(FastCsvError::Quoted { path, line, column });
        }
        if cells.len() != self.headers.len() {
            return Err(FastCsvError::Ragged { path, line, found: cells.len(), expected: self.headers.len() });
        }
        for (k, cell) in cells.iter().enumerate() {
            let cell = without_blanks(cell);
            let (column, found) = (named(k), String::from_utf8_lossy(cell).into_owned());
            if self.slots[k].is_none() {
                continue;
            }
            if cell.is_empty() {
                return Err(FastCsvError::Empty { path, line, column });
            }
            match fast_float2::parse::<f64, _>(cell) {
                Err(_) => return Err(FastCsvError::NotANumber { path, line, column, found }),
                Ok(value) if !value.is_finite() => {
                    return Err(FastCsvError::NotFinite { path, line, column, found });
                }
                Ok(_) => {}
            }
        }
        Ok(())
    }
}
