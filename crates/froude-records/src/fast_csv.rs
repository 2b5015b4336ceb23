//! Long numeric CSV files, read a chunk at a time in bounded memory.
//!
//! The file is cut into chunks of whole lines ([`Reader`]), each of which becomes columns of numbers ([`Layout`]). Memory is a chunk,
//! whatever the file's length. What makes a table of them, and says what is wrong with a line, is [`chunks`](crate::chunks).
//!
//! **Format.** Cells are separated by commas, lines end in `\n` or `\r\n`. Every cell that is read is a finite decimal number. A chunk
//! with anything else (quoted or empty cells, NaN, rows of another length than the header) is not read here at all. Columns that are
//! not selected are passed over unread, so they may hold text (without quotes).
//!
//! **Exact.** Numbers are the same, bit for bit, as those of `str::parse::<f64>`: up to
//! 8 digits before the point and 16 after, below 2⁵² without the point, are an integer
//! divided by a power of ten that is exact, which rounds once (Clinger 1990); all
//! others go through `fast-float2`.

mod number;
#[cfg(test)]
mod tests;

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use memchr::{memchr, memchr_iter, memrchr};
use number::{fast_number, separators, slow_number};

use crate::error::{Place, RecordError};

/// Readable zeros behind a chunk, so that words may be loaded at its end.
const PADDING: usize = 32;

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
    pub(crate) first: usize,
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
    next_line: usize,
    has_ended: bool,
}

impl Reader {
    /// Opens a file that is to be read `chunk_bytes` at a time.
    pub(crate) fn open(path: &Path, chunk_bytes: usize) -> Result<Self, RecordError> {
        let file = crate::read::open(path)?;
        Ok(Self { path: path.to_owned(), file, chunk_bytes, carry: Vec::new(), next_line: 1, has_ended: false })
    }

    /// The beginning of the file, up to a chunk.
    pub(crate) fn beginning(&mut self) -> Result<Vec<u8>, RecordError> {
        let mut start = Vec::new();
        self.fill(&mut start)?;
        Ok(start)
    }

    /// Goes on with what is left of the beginning, from a line on.
    pub(crate) fn go_on(&mut self, rest: Vec<u8>, line: usize) {
        self.carry = rest;
        self.next_line = line;
    }

    /// Reads until `text` has a chunk's bytes or the file ends.
    fn fill(&mut self, text: &mut Vec<u8>) -> Result<(), RecordError> {
        let missing = self.chunk_bytes.saturating_sub(text.len());
        text.reserve(missing + PADDING);
        let got = (&mut self.file)
            .take(missing as u64)
            .read_to_end(text)
            .map_err(|error| RecordError::Read { path: self.path.clone(), reason: error.to_string() })?;
        self.has_ended = got < missing;
        Ok(())
    }

    /// The next whole lines, followed by padding; None at the end.
    pub(crate) fn next(&mut self, text: &mut Vec<u8>) -> Result<Option<Lines>, RecordError> {
        text.clear();
        text.append(&mut self.carry);
        if !self.has_ended {
            self.fill(text)?;
        }
        if self.has_ended && text.last().is_some_and(|&last| last != b'\n') {
            text.push(b'\n');
        }
        let Some(last) = memrchr(b'\n', text) else {
            let limit = self.chunk_bytes;
            let too_long = || format!("the line is longer than {limit} bytes; is this a CSV file?");
            return if text.is_empty() { Ok(None) } else { Err(self.refusal(too_long())) };
        };
        // Blank lines at the end of the file do not count; elsewhere they are refused.
        let mut end = last + 1;
        while let Some(before) = end_of_line_before(&text[..end]) {
            end = before;
        }
        if !self.has_ended {
            self.carry.extend_from_slice(&text[end..]);
            if end == 0 {
                return Err(self.refusal("the line is blank; delete it".to_owned()));
            }
        } else if end == 0 {
            return Ok(None);
        }
        text.truncate(end);
        let lines = Lines { first: self.next_line, count: memchr_iter(b'\n', text).count(), bytes: end };
        text.resize(end.next_multiple_of(16) + PADDING, 0);
        self.next_line += lines.count;
        Ok(Some(lines))
    }

    fn refusal(&self, problem: String) -> RecordError {
        RecordError::syntax(Place::line(&self.path, self.next_line), problem)
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
    /// For every column of the file its place among the selected.
    slots: Vec<Option<usize>>,
    selected: usize,
}

impl Layout {
    /// Columns of which some are read, in their order.
    pub(crate) fn of(is_read: &[bool]) -> Self {
        let mut selected = 0;
        let slots = is_read.iter().map(|&is_read| {
            selected += usize::from(is_read);
            is_read.then(|| selected - 1)
        });
        Self { slots: slots.collect(), selected }
    }

    /// Turns the lines in `memory` into columns, without those that are not read; `None` where one of the lines is not plain numbers.
    pub(crate) fn parse<'a>(&self, memory: &'a mut Memory, lines: &Lines) -> Option<Vec<Option<&'a [f64]>>> {
        let Memory { text, ends, numbers } = memory;
        let (rows, width) = (lines.count, self.slots.len());
        numbers.resize(self.selected * rows, 0.0);
        ends.resize(rows * width + 16, 0);
        let found = separators(text, ends);
        // A quote could hide a separator in a cell that is passed over.
        if self.selected < width && memchr(b'"', text).is_some() {
            return None;
        }
        self.parse_rows(text, &ends[..found], rows, numbers)?;
        let numbers = &memory.numbers;
        Some(self.slots.iter().map(|slot| slot.map(|slot| &numbers[slot * rows..(slot + 1) * rows])).collect())
    }

    /// Reads all rows, given where their cells end; stops at the first bad row.
    fn parse_rows(&self, text: &[u8], ends: &[u32], rows: usize, numbers: &mut [f64]) -> Option<()> {
        let mut start = 0;
        for (row, cells) in ends.chunks(self.slots.len()).enumerate() {
            if cells.len() != self.slots.len() || row >= rows {
                return None;
            }
            for (k, (slot, &end)) in self.slots.iter().zip(cells).enumerate() {
                let end = end as usize;
                let is_last = k + 1 == cells.len();
                if text.get(end) != Some(if is_last { &b'\n' } else { &b',' }) {
                    return None;
                }
                if let Some(slot) = slot {
                    let has_return = is_last && end > start && text[end - 1] == b'\r';
                    let cell_end = end - usize::from(has_return);
                    let value = match fast_number(text, start, cell_end) {
                        Some(value) => value,
                        None => text.get(start..cell_end).and_then(slow_number)?,
                    };
                    *numbers.get_mut(slot * rows + row)? = value;
                }
                start = end + 1;
            }
        }
        Some(())
    }
}
