//! Tables of text: `name [unit]` headers, a row per observation.
//!
//! **Own form**, which is written: UTF-8, commas, lines ending with LF or CRLF, cells in double quotes where they hold commas, quotes (doubled) or line
//! breaks. Spaces around unquoted cells do not count. Blank rows and lines that begin with `#` or `%` are passed over and counted.
//!
//! **As others write them** ([`froude_foreign`]): any encoding, other separators and marks, names and units on lines of their own. What was understood is said
//! in one sentence ([`Table::understood`]); what can be read in two ways is asked.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use froude_foreign::decode::{Decoded, decode};
use froude_foreign::marks::{Marks, Shape, Undecided, Witness, shape};

use crate::assemble::{Room, Want, assemble, not_a_number, number, plan};
use crate::error::{Place, RecordError};
use crate::file_words::FileWords;
use crate::guard::{guarded, unguarded};
use crate::label_rows::{Labels, OddRows, advice, is_sum_in_note, label, odd};
use crate::memory;
use crate::obstacles;
use crate::raw_column::Raw;
use crate::read;
use crate::reading::{Reading, undecided};
use crate::records::{NextRow, Records};
use crate::sidecar::Sidecar;
use crate::table::{ColumnData, Table};
use crate::text::counted;
use crate::units::Unit;
use crate::write::Prepared;

/// The largest table of text that is read into memory; longer logs in Froude's own form are streamed.
const LARGEST_BYTES: u64 = 2 << 30;

/// Empty cells, as column and row.
pub(crate) type Blanks = Vec<(String, usize)>;

/// Reads a table of text, through a sidecar if there is one.
///
/// # Errors
///
/// See [`RecordError`].
pub fn read_csv(path: &Path, sidecar: Option<&Sidecar>) -> Result<Table, RecordError> {
    parse_csv(path, read::whole(path, LARGEST_BYTES, "a table")?, sidecar)
}

/// The same; empty cells of loads and of motions along axes are listed in `blank`, where there is a place for them.
pub(crate) fn read_text(
    path: &Path,
    sidecar: Option<&Sidecar>,
    blank: Option<&mut Blanks>,
) -> Result<Table, RecordError> {
    parse_bytes(path, &read::whole(path, LARGEST_BYTES, "a table")?, sidecar, blank)
}

/// The same from its bytes; `path` is for messages.
///
/// # Errors
///
/// See [`RecordError`].
pub fn parse_csv(path: &Path, bytes: impl AsRef<[u8]>, sidecar: Option<&Sidecar>) -> Result<Table, RecordError> {
    parse_bytes(path, bytes.as_ref(), sidecar, None)
}

/// The same; empty cells are an error without a place for them.
fn parse_bytes(
    path: &Path,
    bytes: &[u8],
    sidecar: Option<&Sidecar>,
    blank: Option<&mut Blanks>,
) -> Result<Table, RecordError> {
    let unstated = FileWords::default();
    let file = sidecar.map_or(&unstated, |sidecar| &sidecar.file);
    let decoded = text(path, bytes, file)?;
    let reading = Reading::of(path, &decoded, file)?;
    parse(path, &decoded.text, &reading, sidecar, file, blank)
        .map_err(|first| obstacles::all(path, &decoded.text, &reading, sidecar, first))
}

/// The text of a file, in whatever encoding.
pub(crate) fn text<'b>(path: &Path, bytes: &'b [u8], file: &FileWords) -> Result<Decoded<'b>, RecordError> {
    decode(bytes, file.encoding.as_deref())
        .map_err(|problem| RecordError::syntax(Place::whole(path), format!("the file {problem}")))
}

fn parse(
    path: &Path,
    text: &str,
    reading: &Reading,
    sidecar: Option<&Sidecar>,
    file: &FileWords,
    blank: Option<&mut Blanks>,
) -> Result<Table, RecordError> {
    let columns = sidecar.map(|sidecar| sidecar.fitted(&reading.headings)).transpose()?;
    let head = Head::of(path, reading, columns.as_ref(), file)?;
    let mut records = Records::new(path, &text[reading.at..], reading.line, reading.dialect.separator);
    records.width = head.width_of_rows();
    let rows = head.rows(&mut records, blank)?;
    let understood = reading.understood(records.skipped, rows.left_out());
    let table = head.table(rows)?;
    Ok(Table { sidecar: sidecar.map(|sidecar| sidecar.path.clone()), ..table }.also(understood))
}

/// What the columns of a table of text are.
pub(crate) struct Head<'a, 's> {
    path: &'a Path,
    /// The sidecar that takes answers about the file.
    answers: PathBuf,
    sidecar: Option<&'s Sidecar>,
    file: &'s FileWords,
    place: Place,
    marks: Marks,
    is_open: bool,
    pub(crate) header: Vec<String>,
    pub(crate) wants: Vec<Want<'s>>,
}

/// The cells of rows.
pub(crate) struct Rows {
    raws: Vec<Raw>,
    lines: Vec<usize>,
    left_out: usize,
}

impl Rows {
    /// Numbers, and the lines on which they stand.
    pub fn of(raws: Vec<Raw>, lines: Vec<usize>) -> Self {
        Self { raws, lines, left_out: 0 }
    }

    /// Rows that were left out as declared.
    pub fn left_out(&self) -> usize {
        self.left_out
    }
}

impl<'a, 's> Head<'a, 's> {
    /// Decides what each column becomes; `sidecar` is fitted to the headings.
    pub(crate) fn of(
        path: &'a Path,
        reading: &Reading,
        sidecar: Option<&'s Sidecar>,
        file: &'s FileWords,
    ) -> Result<Self, RecordError> {
        let answers = sidecar.map_or_else(|| path.with_extension("toml"), |sidecar| sidecar.path.clone());
        if let Some(found) = &reading.undecided {
            return Err(undecided(path, found, &answers));
        }
        let sidecar = sidecar.filter(|sidecar| !sidecar.columns.is_empty());
        let header: Vec<String> = reading.headings.iter().map(crate::heading::Heading::header).collect();
        let wants = plan(path, &header, sidecar, &reading.place)?;
        if sidecar.is_none() {
            obstacles::refuse_passed_over(path, reading)?;
        }
        Ok(Self {
            path,
            answers,
            sidecar,
            file,
            place: reading.place.clone(),
            marks: reading.dialect.marks,
            is_open: reading.is_open,
            header,
            wants,
        })
    }

    /// Cells of a row, where a comment with as many is to be asked about.
    pub(crate) fn width_of_rows(&self) -> Option<usize> {
        let is_declared = self.file.leaves_out("#") || self.file.leaves_out("%");
        (!is_declared).then_some(self.header.len())
    }

    /// All further rows; empty cells that may be empty are 0 and listed, where there is a place for them.
    pub(crate) fn rows(
        &self,
        records: &mut dyn NextRow<'_>,
        mut blank: Option<&mut Blanks>,
    ) -> Result<Rows, RecordError> {
        let path = self.path;
        let mut raws: Vec<Raw> = self
            .wants
            .iter()
            .map(|want| if want.is_number() { Raw::Numbers(Vec::new()) } else { Raw::Texts(Vec::new()) })
            .collect();
        let is_left_out: Vec<bool> = self.wants.iter().map(|want| matches!(want, Want::LeftOut)).collect();
        let (mut cells, mut lines) = (Vec::new(), Vec::new());
        let mut room = Room::new(path);
        let (mut left_out, mut labels) = (0, Labels::default());
        let is_asked = self.file.leave_out.is_none() && self.wants.iter().any(Want::is_number);
        let mut odd_rows = OddRows::default();
        let mut odd_notes: Vec<OddRows> = self.wants.iter().map(|_| OddRows::default()).collect();
        let refuse = |line: usize, word: &str| {
            Err(RecordError::syntax(Place::in_table(path, line), advice(path, word, odd(word))))
        };
        while let Some(line) = records.next(&mut cells)? {
            if self.is_left_out(&cells) {
                left_out += 1;
                continue;
            }
            let mut in_notes = || {
                let mut texts = self.texts(&cells);
                texts.find_map(|(at, word)| {
                    odd_notes.get_mut(at)?.see(if is_sum_in_note(word) { word } else { "" }, line)
                })
            };
            if is_asked && let Some((line, word)) = odd_rows.see(label(&cells), line).or_else(&mut in_notes) {
                return refuse(line, &word);
            }
            // Cells without content beyond the last column.
            while cells.len() > self.header.len() && cells.last().is_some_and(|cell| cell.is_empty()) {
                cells.pop();
            }
            if cells.len() != self.header.len() {
                let (found, expected) = (counted(cells.len(), "cell", "cells"), self.header.len());
                let problem = format!("the row has {found}, the header has {expected}");
                return Err(RecordError::syntax(Place::in_table(path, line), problem));
            }
            if let (Some(first), Some(Raw::Texts(_))) = (cells.first(), raws.first()) {
                labels.see(unguarded(first.trim()), line);
            }
            for (j, (cell, raw)) in cells.iter().zip(&mut raws).enumerate() {
                match raw {
                    Raw::Numbers(values) => {
                        let value = self.value(j, cell.trim(), line)?;
                        if value.is_none() {
                            let (Some(name), Some(blank)) = (self.wants[j].name_if_blank(), &mut blank) else {
                                return Err(self.empty(j, cell.trim(), line));
                            };
                            room.take((size_of::<(String, usize)>() + name.len()) as u64)?;
                            memory::push(blank, (name.to_owned(), lines.len()))
                                .map_err(|e| RecordError::memory(path, e))?;
                        }
                        room.number(values, value.unwrap_or(0.0))?;
                    }
                    Raw::Texts(_) if is_left_out[j] => {}
                    Raw::Texts(texts) => room.text(texts, unguarded(cell), &|| Place::in_table(path, line))?,
                }
            }
            memory::push(&mut lines, line).map_err(|e| RecordError::memory(path, e))?;
        }
        if let Some((line, word)) = labels
            .words()
            .next()
            .cloned()
            .or_else(|| odd_rows.end())
            .or_else(|| odd_notes.into_iter().find_map(OddRows::end))
            .filter(|_| is_asked)
        {
            return refuse(line, &word);
        }
        Ok(Rows { raws, lines, left_out })
    }

    /// The number in a cell; `None` where it is empty or stands for no measurement.
    fn value(&self, j: usize, cell: &str, line: usize) -> Result<Option<f64>, RecordError> {
        let has_words = self.file.not_measured.is_some();
        if cell.is_empty() || (has_words && self.file.is_not_measured(cell, None)) {
            return Ok(None);
        }
        let place = || Place::in_table(self.path, line);
        if self.is_open && matches!(shape(cell), Some(Shape::Either(_))) {
            let either = Undecided::Either(Witness { cell: cell.to_owned(), line });
            return Err(undecided(self.path, &either, &self.answers));
        }
        let is_plain = self.marks == Marks::default() && !cell.contains(['d', 'D', '−']);
        let value = if is_plain {
            number(cell, &self.header[j], &place)?
        } else {
            let plain = self.marks.plain(cell).ok_or_else(|| not_a_number(cell, &self.header[j], place()))?;
            number(&plain, &self.header[j], &place)?
        };
        Ok(Some(value).filter(|value| !has_words || !self.file.is_not_measured(cell, Some(*value))))
    }

    /// The error for a cell without a number in a column that needs one.
    fn empty(&self, j: usize, cell: &str, line: usize) -> RecordError {
        let advice = self.wants[j].advice(self.path, self.sidecar);
        let place = Place::in_table(self.path, line);
        if cell.is_empty() {
            RecordError::empty_cell(place, &self.header[j], &advice)
        } else {
            let problem = format!(": `{cell}` is declared as not measured; {advice}");
            RecordError::column(place, &self.header[j], problem)
        }
    }

    /// Whether a row is declared to be left out because it is no observation.
    fn is_left_out(&self, cells: &[Cow<'_, str>]) -> bool {
        std::iter::once(label(cells))
            .chain(self.texts(cells).map(|(_, cell)| cell))
            .any(|word| self.file.leaves_out(word))
    }

    /// The cells of columns of text, each with its column.
    fn texts<'c>(&self, cells: &'c [Cow<'_, str>]) -> impl Iterator<Item = (usize, &'c str)> {
        let cells = cells.iter().zip(&self.wants).enumerate();
        cells.filter(|(_, (_, want))| !want.is_number()).map(|(at, (cell, _))| (at, cell.trim()))
    }

    /// The table of some rows.
    pub(crate) fn table(&self, rows: Rows) -> Result<Table, RecordError> {
        assemble(self.path, &self.header, &self.wants, rows.raws, (self.sidecar, self.file), &self.place, rows.lines)
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

/// A cell in quotes where it needs them; an empty one too, so that no row is a blank line.
#[must_use]
pub fn quoted(cell: String) -> String {
    let needs = cell.is_empty()
        || cell.trim() != cell
        || cell.starts_with(['#', '%', '\u{feff}'])
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
