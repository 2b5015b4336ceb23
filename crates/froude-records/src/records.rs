//! The rows of a table of text, one after the other, with the line on which each begins.
//!
//! The splitting is our own and not a library's: every message names the line, also after cells with line breaks, and nothing that is not a row is skipped
//! without being counted. The tests compare it with the `csv` crate.

use std::borrow::Cow;
use std::path::Path;

use froude_foreign::layout::bare;
use froude_foreign::marks::{Marks, shape};
use froude_foreign::split::{Separator, comment, rows};

use crate::error::{Place, RecordError};
use crate::file_words::sidecar_name;
use crate::heading::split_header;
use crate::units::parse_unit;

/// Most columns of a table.
const MOST_COLUMNS: usize = 10_000;

/// How a table of text is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Dialect {
    /// What stands between cells.
    pub separator: Separator,
    /// How its numbers are written.
    pub marks: Marks,
}

impl Dialect {
    /// That of Froude's own tables.
    pub fn own() -> Self {
        Self { separator: Separator::Comma, marks: Marks::default() }
    }
}

/// What was passed over between the rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Skipped {
    /// Lines of comment.
    pub comments: usize,
    /// Rows without content between others.
    pub blank: usize,
}

/// Rows, one after the other.
pub(crate) trait NextRow<'a> {
    /// The next row's cells and its line, or row; `None` at the end. Blank rows and comments are passed over.
    fn next(&mut self, cells: &mut Vec<Cow<'a, str>>) -> Result<Option<usize>, RecordError>;
}

/// The rows of a text.
pub(crate) struct Records<'p, 'a> {
    pub(crate) path: &'p Path,
    text: &'a str,
    separator: Separator,
    /// Bytes that were read.
    pub(crate) at: usize,
    /// The line that is read next.
    pub(crate) line: usize,
    pub(crate) skipped: Skipped,
    /// Cells of a row: a comment with as many, and a number among them, is one that was taken out or is numbered so. None where such rows are declared.
    pub(crate) width: Option<usize>,
    /// Blank rows that count only if another row follows on them.
    pending: usize,
}

impl<'a> NextRow<'a> for Records<'_, 'a> {
    fn next(&mut self, cells: &mut Vec<Cow<'a, str>>) -> Result<Option<usize>, RecordError> {
        while self.at < self.text.len() {
            let (line, rest) = (self.line, &self.text[self.at..]);
            let end = memchr::memchr(b'\n', rest.as_bytes()).unwrap_or(rest.len());
            if let Some(comment) = comment(&rest[..end], self.separator) {
                self.refuse_row(line, comment)?;
                self.skipped.comments += 1;
                self.at += (end + 1).min(rest.len());
                self.line += 1;
                continue;
            }
            self.row(cells)?;
            if cells.iter().all(|cell| cell.is_empty()) && !rest.starts_with('"') {
                self.pending += 1;
                continue;
            }
            self.skipped.blank += std::mem::take(&mut self.pending);
            return Ok(Some(line));
        }
        Ok(None)
    }
}

impl<'p, 'a> Records<'p, 'a> {
    /// The rows of a text that begins on a line.
    pub(crate) fn new(path: &'p Path, text: &'a str, line: usize, separator: Separator) -> Self {
        Self { path, text, separator, at: 0, line, skipped: Skipped::default(), width: None, pending: 0 }
    }

    fn refuse<T>(&self, line: usize, problem: &str) -> Result<T, RecordError> {
        Err(RecordError::syntax(Place::line(self.path, line), problem))
    }

    /// Refuses a comment that may be a row.
    fn refuse_row(&self, line: usize, comment: &str) -> Result<(), RecordError> {
        let first = rows(comment, self.separator).into_iter().next().unwrap_or_default();
        let has_number = first.cells.iter().skip(1).any(|cell| shape(cell).is_some());
        let is_unit = |text: &str| parse_unit(text).is_ok();
        let states_unit =
            |cell: &str| is_unit(bare(cell)) || matches!(split_header(cell), Ok((_, Some(unit))) if is_unit(unit));
        let has_units = 2 * first.cells.iter().filter(|cell| states_unit(cell)).count() >= first.cells.len();
        if self.width.is_none_or(|width| width < 2 || first.cells.len() != width) || !(has_number || has_units) {
            return Ok(());
        }
        if !has_number {
            let problem = "the line begins as a comment and looks like names or units, below those of the table; delete it, or write the rows below it to a file of their own";
            return self.refuse(line, problem);
        }
        let problem = format!(
            "the line begins as a comment and has the cells of a row; where it is to be left out, write in {}:\n  schema = 1\n  [file]\n  leave_out = [\"#\"]\nwhere it is a row, take the mark away",
            sidecar_name(self.path)
        );
        self.refuse(line, &problem)
    }

    /// Cells up to the end of the row; `at` stands behind its line break.
    fn row(&mut self, cells: &mut Vec<Cow<'a, str>>) -> Result<(), RecordError> {
        cells.clear();
        loop {
            if cells.len() == MOST_COLUMNS {
                return self.refuse(self.line, &format!("the row has more than {MOST_COLUMNS} cells"));
            }
            self.pass_blanks();
            let is_quoted = self.text.as_bytes().get(self.at) == Some(&b'"');
            let cell = if is_quoted { self.quoted()? } else { self.plain() };
            cells.push(cell);
            self.pass_blanks();
            let rest = &self.text.as_bytes()[self.at..];
            let (step, is_end) = match rest {
                [b'\n', ..] => (1, true),
                [b'\r', b'\n', ..] => (2, true),
                [] => (0, true),
                [b'\r', ..] => {
                    return self.refuse(
                        self.line,
                        "a carriage return stands without a line feed; save the file with LF or CRLF line ends",
                    );
                }
                [byte, ..] if *byte == self.separator.byte() => (1, false),
                _ if self.separator == Separator::Blanks => (0, false),
                _ => {
                    return self.refuse(
                        self.line,
                        "text follows the closing quote of a cell; double the quotes inside a cell",
                    );
                }
            };
            self.at += step;
            if is_end {
                self.line += usize::from(step > 0);
                return Ok(());
            }
        }
    }

    /// Passes over blanks where they are what separates cells.
    fn pass_blanks(&mut self) {
        if self.separator == Separator::Blanks {
            let rest = &self.text[self.at..];
            self.at += rest.len() - rest.trim_start_matches([' ', '\t']).len();
        }
    }

    fn plain(&mut self) -> Cow<'a, str> {
        let rest = &self.text[self.at..];
        let bytes = rest.as_bytes();
        let end = match self.separator {
            Separator::Blanks => bytes.iter().position(|b| matches!(b, b' ' | b'\t' | b'\n' | b'\r')),
            other => memchr::memchr3(other.byte(), b'\n', b'\r', bytes),
        };
        let end = end.unwrap_or(rest.len());
        self.at += end;
        Cow::Borrowed(rest[..end].trim())
    }

    fn quoted(&mut self) -> Result<Cow<'a, str>, RecordError> {
        let begun = self.line;
        let start = self.at + 1;
        let mut end = start;
        let mut has_doubled = false;
        loop {
            let Some(step) = memchr::memchr(b'"', &self.text.as_bytes()[end..]) else {
                return self.refuse(begun, "a quote is opened and not closed");
            };
            end += step;
            if self.text.as_bytes().get(end + 1) != Some(&b'"') {
                break;
            }
            has_doubled = true;
            end += 2;
        }
        let cell = &self.text[start..end];
        self.line += memchr::memchr_iter(b'\n', cell.as_bytes()).count();
        self.at = end + 1;
        Ok(if has_doubled { Cow::Owned(cell.replace("\"\"", "\"")) } else { Cow::Borrowed(cell) })
    }
}
