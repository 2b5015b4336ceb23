//! Tables as CSV: `name [unit]` headers, a row per observation.
//!
//! **Form.** UTF-8 (a byte order mark is skipped), commas, lines ending with LF or
//! CRLF, cells in double quotes where they hold commas, quotes (doubled) or line
//! breaks. Spaces around unquoted cells do not count. Blank lines may stand at the
//! end only; comment lines are refused, because another program would read them as
//! observations.
//!
//! **Text is only text.** A spreadsheet takes a cell that begins with `=`, `+`, `-`, `@`, a tab or a line end for a formula and runs it.
//! Cells of text and headers that begin so are written with an apostrophe before them, as are those that begin with apostrophes and then so;
//! numbers are not. Reading takes that one apostrophe off again, so names come back as they were; another program sees it.
//!
//! The splitting is our own and not a library's: every message names the line on
//! which the row begins, also after cells with line breaks, and nothing that is not
//! a row is skipped in silence. The tests compare it with the `csv` crate.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;

use crate::assemble::{Room, Want, assemble, number, plan};
use crate::error::{Place, RecordError};
use crate::memory;
use crate::raw_column::Raw;
use crate::read;
use crate::sidecar::Sidecar;
use crate::table::{ColumnData, Table};
use crate::text::counted;
use crate::units::Unit;
use crate::write::Prepared;

/// The largest CSV table that is read into memory; longer logs are streamed.
const LARGEST_BYTES: u64 = 2 << 30;

/// Most columns of a table.
const MOST_COLUMNS: usize = 10_000;

/// Reads a CSV table, through a sidecar if there is one.
///
/// # Errors
///
/// See [`RecordError`].
pub fn read_csv(path: &Path, sidecar: Option<&Sidecar>) -> Result<Table, RecordError> {
    parse_csv(path, &read::text(path, LARGEST_BYTES, "a table")?, sidecar)
}

/// The same with empty cells of loads and of motions along axes, which [`Table::blank`] lists.
///
/// # Errors
///
/// See [`RecordError`].
pub fn read_csv_with_blanks(path: &Path, sidecar: Option<&Sidecar>) -> Result<Table, RecordError> {
    let text = read::text(path, LARGEST_BYTES, "a table")?;
    let mut blank = Vec::new();
    let table = parse(path, &text, sidecar, Some(&mut blank))?;
    Ok(Table { blank, ..table })
}

/// The same from text; `path` is for messages.
///
/// # Errors
///
/// See [`RecordError`].
pub fn parse_csv(path: &Path, text: &str, sidecar: Option<&Sidecar>) -> Result<Table, RecordError> {
    parse(path, text, sidecar, None)
}

/// The same; empty cells are an error without a place for them.
fn parse(
    path: &Path,
    text: &str,
    sidecar: Option<&Sidecar>,
    blank: Option<&mut Vec<(String, usize)>>,
) -> Result<Table, RecordError> {
    let mut records = Records::new(path, text.strip_prefix('\u{feff}').unwrap_or(text), 1);
    let head = Head::read(&mut records, sidecar)?;
    let (raws, lines) = head.rows(&mut records, blank)?;
    head.table(raws, lines)
}

/// The first row of a table: what its columns are.
pub(crate) struct Head<'a, 's> {
    path: &'a Path,
    sidecar: Option<&'s Sidecar>,
    place: Place,
    pub(crate) header: Vec<String>,
    pub(crate) wants: Vec<Want<'s>>,
}

impl<'a, 's> Head<'a, 's> {
    /// Reads it.
    pub(crate) fn read(records: &mut Records<'a, '_>, sidecar: Option<&'s Sidecar>) -> Result<Self, RecordError> {
        let path = records.path;
        let mut cells = Vec::new();
        let Some(line) = records.next(&mut cells)? else {
            let problem = "the file is empty; its first line names the columns as `name [unit]`";
            return Err(RecordError::syntax(Place::whole(path), problem));
        };
        let place = Place::line(path, line);
        let header: Vec<String> = cells.iter().map(|c| unguarded(c.trim()).to_owned()).collect();
        if let [only] = header.as_slice()
            && let Some(separator) = [';', '\t'].into_iter().find(|c| only.contains(*c))
        {
            let name = if separator == ';' { "`;`" } else { "tabs" };
            let problem = format!("the cells are separated by {name}; separate them by commas");
            return Err(RecordError::syntax(place, problem));
        }
        let wants = plan(path, &header, sidecar, &place)?;
        Ok(Self { path, sidecar, place, header, wants })
    }

    /// All further rows, with the line of each; empty cells that may be empty are 0 and listed, where there is a place for them.
    pub(crate) fn rows(
        &self,
        records: &mut Records<'_, '_>,
        mut blank: Option<&mut Vec<(String, usize)>>,
    ) -> Result<(Vec<Raw>, Vec<usize>), RecordError> {
        let path = self.path;
        let mut raws: Vec<Raw> = self
            .wants
            .iter()
            .map(|want| if want.is_number() { Raw::Numbers(Vec::new()) } else { Raw::Texts(Vec::new()) })
            .collect();
        let is_left_out: Vec<bool> = self.wants.iter().map(|want| matches!(want, Want::LeftOut)).collect();
        let (mut cells, mut lines) = (Vec::new(), Vec::new());
        let mut room = Room::new(path);
        while let Some(line) = records.next(&mut cells)? {
            if cells.len() != self.header.len() {
                let (found, expected) = (counted(cells.len(), "cell", "cells"), self.header.len());
                let problem = format!("the row has {found}, the header has {expected}");
                return Err(RecordError::syntax(Place::line(path, line), problem));
            }
            for (j, (cell, raw)) in cells.iter().zip(&mut raws).enumerate() {
                match (raw, &self.wants[j], &mut blank) {
                    (Raw::Numbers(values), want @ Want::Number { name, .. }, Some(blank))
                        if cell.trim().is_empty() && want.may_be_blank() =>
                    {
                        room.take((size_of::<(String, usize)>() + name.len()) as u64)?;
                        memory::push(blank, (name.clone(), lines.len())).map_err(|e| RecordError::memory(path, e))?;
                        room.number(values, 0.0)?;
                    }
                    (Raw::Numbers(values), ..) => {
                        let advice = || self.wants[j].advice(path, self.sidecar);
                        let value = number(cell.trim(), &self.header[j], &|| Place::line(path, line), &advice)?;
                        room.number(values, value)?;
                    }
                    (Raw::Texts(_), ..) if is_left_out[j] => {}
                    (Raw::Texts(texts), ..) => room.text(texts, unguarded(cell), &|| Place::line(path, line))?,
                }
            }
            memory::push(&mut lines, line).map_err(|e| RecordError::memory(path, e))?;
        }
        Ok((raws, lines))
    }

    /// The table of some rows.
    pub(crate) fn table(&self, raws: Vec<Raw>, lines: Vec<usize>) -> Result<Table, RecordError> {
        assemble(self.path, &self.header, &self.wants, raws, self.sidecar, &self.place, lines)
    }
}

/// The rows of a CSV text, one after the other, each with the line on which it begins.
pub(crate) struct Records<'p, 'a> {
    path: &'p Path,
    text: &'a str,
    /// Bytes that were read.
    pub(crate) at: usize,
    /// The line that is read next.
    pub(crate) line: usize,
}

impl<'p, 'a> Records<'p, 'a> {
    /// The rows of a text that begins on a line.
    pub(crate) fn new(path: &'p Path, text: &'a str, line: usize) -> Self {
        Self { path, text, at: 0, line }
    }

    fn refuse<T>(&self, line: usize, problem: &str) -> Result<T, RecordError> {
        Err(RecordError::syntax(Place::line(self.path, line), problem))
    }

    /// The next row's cells and line; `None` at the end.
    fn next(&mut self, cells: &mut Vec<Cow<'a, str>>) -> Result<Option<usize>, RecordError> {
        let mut blank = None;
        while self.at < self.text.len() {
            let line = self.line;
            let start = self.at;
            self.row(cells)?;
            let is_blank = matches!(cells.as_slice(), [Cow::Borrowed("")]) && !self.text[start..].starts_with('"');
            if is_blank {
                blank.get_or_insert(line);
                continue;
            }
            if let Some(line) = blank {
                return self.refuse(line, "the line is blank; delete it");
            }
            if self.text[start..].trim_start().starts_with('#') {
                return self.refuse(line, "a table has no comment lines; delete the line that begins with `#`");
            }
            return Ok(Some(line));
        }
        Ok(None)
    }

    /// Cells up to the end of the row; `at` stands behind its line break.
    fn row(&mut self, cells: &mut Vec<Cow<'a, str>>) -> Result<(), RecordError> {
        cells.clear();
        loop {
            if cells.len() == MOST_COLUMNS {
                return self.refuse(self.line, &format!("the row has more than {MOST_COLUMNS} cells"));
            }
            let is_quoted = self.text.as_bytes().get(self.at) == Some(&b'"');
            let cell = if is_quoted { self.quoted()? } else { self.plain() };
            cells.push(cell);
            let rest = &self.text.as_bytes()[self.at..];
            let (step, is_end) = match rest {
                [b',', ..] => (1, false),
                [b'\n', ..] => (1, true),
                [b'\r', b'\n', ..] => (2, true),
                [] => (0, true),
                [b'\r', ..] => {
                    return self.refuse(
                        self.line,
                        "a carriage return stands without a line feed; save the file with LF or CRLF line ends",
                    );
                }
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

    fn plain(&mut self) -> Cow<'a, str> {
        let rest = &self.text[self.at..];
        let end = memchr::memchr3(b',', b'\n', b'\r', rest.as_bytes()).unwrap_or(rest.len());
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

/// A table as CSV, for a file that lies among others: numbers in the units of their columns, in full precision.
///
/// # Errors
///
/// A number that is not finite.
pub fn csv_bytes(table: &Table) -> Result<Vec<u8>, RecordError> {
    all_finite(table, &table.path)?;
    let mut out = Vec::new();
    write_rows(table, &mut out).map_err(|e| RecordError::Write { path: table.path.clone(), reason: e.to_string() })?;
    Ok(out)
}

/// The same as a file, written but not yet moved into place.
pub(crate) fn prepare_csv(table: &Table, path: &Path) -> Result<Prepared, RecordError> {
    all_finite(table, path)?;
    Prepared::new(path, |file| write_rows(table, file))
}

fn all_finite(table: &Table, path: &Path) -> Result<(), RecordError> {
    for column in &table.columns {
        if let ColumnData::Number { si, .. } = &column.data
            && let Some((row, value)) = si.iter().enumerate().find(|(_, v)| !v.is_finite())
        {
            return Err(RecordError::NonFinite {
                path: path.to_owned(),
                item: format!("column {}, row {}", column.name, row + 1),
                value: value.to_string(),
            });
        }
    }
    Ok(())
}

fn write_rows(table: &Table, file: &mut dyn Write) -> std::io::Result<()> {
    let header: Vec<_> = table.columns.iter().map(|c| quoted(guarded(c.header()))).collect();
    writeln!(file, "{}", header.join(","))?;
    let blank: BTreeSet<(&str, usize)> = table.blank.iter().map(|(name, row)| (name.as_str(), *row)).collect();
    for row in 0..table.n_rows {
        for (j, column) in table.columns.iter().enumerate() {
            if j > 0 {
                file.write_all(b",")?;
            }
            if blank.contains(&(column.name.as_str(), row)) {
                continue;
            }
            match &column.data {
                ColumnData::Number { unit, si, .. } => {
                    write!(file, "{}", si.get(row).map_or_else(String::new, |si| shortest(unit, *si)))?;
                }
                ColumnData::Text(texts) => {
                    write!(file, "{}", quoted(guarded(texts.get(row).cloned().unwrap_or_default())))?;
                }
            }
        }
        writeln!(file)?;
    }
    Ok(())
}

/// A text that no spreadsheet takes for a formula.
#[must_use]
pub fn guarded(cell: String) -> String {
    if is_formula(&cell) { format!("'{cell}") } else { cell }
}

/// What [`guarded`] was made of.
fn unguarded(cell: &str) -> &str {
    cell.strip_prefix('\'').filter(|rest| is_formula(rest)).unwrap_or(cell)
}

/// True for what begins as a formula, and for that with apostrophes before it: they would be taken off when it is read.
fn is_formula(cell: &str) -> bool {
    // The wide forms are formulas in East Asian editions.
    const BEGINNINGS: [char; 11] = ['=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠'];
    cell.trim_start_matches('\'').starts_with(BEGINNINGS)
}

/// A cell in quotes where it needs them; an empty one too, so that no row is a blank line.
#[must_use]
pub fn quoted(cell: String) -> String {
    let needs = cell.is_empty()
        || cell.trim() != cell
        || cell.starts_with(['#', '\u{feff}'])
        || cell.contains([',', '"', '\n', '\r']);
    if needs { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell }
}

/// The number in its unit, in the fewest digits that read back to the same SI value.
fn shortest(unit: &Unit, si: f64) -> String {
    let value = unit.from_si(si);
    // 12 digits usually do, and hide the rounding of the unit's factor (0.3 rather than 0.30000000000000004).
    let short: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    let value = if unit.to_si(short) == si { short } else { value };
    // Display never uses an exponent: tiny and huge numbers would be hundreds of digits long.
    // A negative zero is zero.
    let value = if value == 0.0 { 0.0 } else { value };
    if value == 0.0 || (1e-5..1e15).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// What is written is no formula, and comes back as it was.
        #[test]
        fn a_guarded_cell_is_no_formula_and_comes_back(cell in "'{0,3}[-=+@\\t\\ra＝]?.{0,5}") {
            let written = guarded(cell.clone());
            prop_assert!(!written.starts_with(['=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠']));
            prop_assert_eq!(unguarded(&written), cell);
        }
    }
}
