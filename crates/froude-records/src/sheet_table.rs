//! Tables in spreadsheets: a sheet, or a range of one, laid out as people lay out tables of text.

use std::borrow::Cow;
use std::path::Path;

use froude_foreign::layout::{Seen, layout};
use froude_foreign::marks::{Evidence, Marks, Undecided};
use froude_foreign::sheet::{Cell, Region, Sheet, Workbook};
use froude_foreign::split::{Row, Separator};

use crate::csv_table::{Blanks, Head};
use crate::error::{Place, RecordError};
use crate::file_words::{FileWords, sidecar_name};
use crate::heading::unit_in;
use crate::obstacles;
use crate::read;
use crate::reading::Reading;
use crate::records::{NextRow, Skipped};
use crate::sidecar::Sidecar;
use crate::table::Table;
use crate::units::{Unit, parse_unit};

/// The largest workbook that is read.
const LARGEST_BYTES: u64 = froude_foreign::MAX_BYTES;

/// Reads a sheet as a table; empty cells are an error without a place for them.
pub(crate) fn read_sheet(
    path: &Path,
    sidecar: Option<&Sidecar>,
    blank: Option<&mut Blanks>,
) -> Result<Table, RecordError> {
    let unstated = FileWords::default();
    let file = sidecar.map_or(&unstated, |sidecar| &sidecar.file);
    let (rows, reading) = look(path, file)?;
    let parse = || {
        let columns = sidecar.map(|sidecar| sidecar.fitted(&reading.headings)).transpose()?;
        let head = Head::of(path, &reading, columns.as_ref(), file)?;
        let mut below = Below { rows: rows.iter().filter(|row| row.line >= reading.line) };
        let found = head.rows(&mut below, blank)?;
        let understood = reading.understood(Skipped::default(), found.left_out());
        Ok(Table { sidecar: sidecar.map(|sidecar| sidecar.path.clone()), ..head.table(found)? }.also(understood))
    };
    parse().map_err(|first| obstacles::of(path, &rows, &reading, sidecar, first))
}

/// The rows of the sheet that is meant, and how they were understood.
pub(crate) fn look(path: &Path, file: &FileWords) -> Result<(Vec<Row<'static>>, Reading), RecordError> {
    let refuse = |e: froude_foreign::ForeignError| RecordError::syntax(Place::whole(path), format!("the file {e}"));
    let bytes = read::whole(path, LARGEST_BYTES, "a workbook")?;
    let mut book = Workbook::open(&bytes).map_err(refuse)?;
    let name = chosen(path, &mut book, file)?;
    let range: Option<Region> = file.range.as_deref().map(str::parse).transpose().map_err(refuse)?;
    let sheet = book.sheet(&name, range).map_err(refuse)?;
    let (rows, marks) = rows(&sheet, file);
    let layout = layout(&rows, &file.stated, &|unit| parse_unit(unit).is_ok());
    let seen = Seen { separator: Separator::Comma, layout, marks, is_open: false };
    let words = if book.sheets().len() > 1 { vec![format!("sheet {name:?}")] } else { Vec::new() };
    let reading = Reading::seen(path, &seen, words, file)?;
    Ok((rows, reading))
}

/// Sheets that a message names.
const MOST_SHEETS: usize = 20;

/// The sheet that is declared, or the only one; otherwise the error proposes the sheet with the most numbers.
fn chosen(path: &Path, book: &mut Workbook<'_>, file: &FileWords) -> Result<String, RecordError> {
    if let Some(name) = &file.sheet {
        return Ok(name.clone());
    }
    let shown = book.sheets().iter().filter(|sheet| !sheet.is_hidden);
    let shown: Vec<String> = shown.map(|sheet| sheet.name.clone()).collect();
    match shown.as_slice() {
        [only] => Ok(only.clone()),
        all => {
            let numbers = |name: &String| {
                let sheet = book.sheet(name, None).ok();
                let cells = sheet.iter().flat_map(|sheet| sheet.rows.iter().flatten());
                cells.filter(|cell| matches!(cell, Cell::Number(_) | Cell::Percent(_) | Cell::Shown(..))).count()
            };
            let counts: Vec<usize> = all.iter().take(MOST_SHEETS).map(numbers).collect();
            // Of equal ones the first.
            let most = (0..counts.len()).rev().max_by_key(|i| counts[*i]).and_then(|i| all.get(i));
            let names: Vec<String> = all.iter().take(MOST_SHEETS).map(|name| format!("{name:?}")).collect();
            let most = most.map_or("Sheet1", |name| name);
            let problem = format!(
                "the workbook has {} sheets: {}; write in {} which one holds the table:\n  schema = 1\n  [file]\n  sheet = {most:?}",
                all.len(),
                names.join(", "),
                sidecar_name(path)
            );
            Err(RecordError::syntax(Place::whole(path), problem))
        }
    }
}

/// The cells of a sheet as text, and the marks of those that are numbers stored as text.
fn rows(sheet: &Sheet, file: &FileWords) -> (Vec<Row<'static>>, Result<Marks, Undecided>) {
    let mut evidence = Evidence::default();
    let width = sheet.rows.iter().map(Vec::len).max().unwrap_or(0);
    for j in 0..width {
        let texts = sheet.rows.iter().enumerate().filter_map(|(i, row)| match row.get(j) {
            Some(Cell::Text(text)) => Some((text.as_str(), i + sheet.first_row)),
            _ => None,
        });
        evidence.column(texts);
    }
    let marks = file.stated.marks(&evidence, false);
    let decimal = marks.as_ref().map_or('.', |marks| marks.decimal);
    let of_number = |x: f64| x.to_string().replace('.', &decimal.to_string());
    let units: Vec<Vec<Unit>> = (0..width).map(|j| units_above(sheet, j)).collect();
    // A unit behind a number is left out where the head says the same. Any other word may scale the number: `Mio`, `x10³`.
    let is_known = |j: usize, word: &str| {
        let is_own =
            |unit: &Unit| units[j].iter().any(|own| (own.dimension, own.factor) == (unit.dimension, unit.factor));
        parse_unit(word).is_ok_and(|unit| is_own(&unit))
    };
    let text = |i: usize, j: usize| -> Cow<'static, str> {
        // A head over several columns is that of each of them.
        let cell = match sheet.rows.get(i).and_then(|row| row.get(j)) {
            Some(Cell::Empty) => match sheet.head(i, j) {
                text @ Cell::Text(_) if i < MOST_HEADS => text,
                _ => &Cell::Empty,
            },
            Some(cell) => cell,
            None => &Cell::Empty,
        };
        Cow::Owned(match cell {
            Cell::Empty => String::new(),
            Cell::Number(x) => of_number(*x),
            Cell::Shown(x, word) if is_known(j, word) => of_number(*x),
            Cell::Shown(x, word) => format!("{x} {word}"),
            // Whether it is 0.12 or 12 nobody says.
            Cell::Percent(x) => format!("{} %", x * 100.0),
            Cell::Text(text) | Cell::Date(text) | Cell::Error(text) => text.trim().to_owned(),
            Cell::Bool(is) => is.to_string(),
        })
    };
    let of = |i: usize| Row {
        line: i + sheet.first_row,
        last_line: i + sheet.first_row,
        cells: (0..width).map(|j| text(i, j)).collect(),
        is_comment: false,
    };
    ((0..sheet.rows.len()).map(of).filter(|row| !row.is_blank()).collect(), marks)
}

/// The units that the heads of a column name.
fn units_above(sheet: &Sheet, j: usize) -> Vec<Unit> {
    let text = |i: usize| match sheet.head(i, j) {
        Cell::Text(text) => unit_in(text),
        _ => None,
    };
    (0..sheet.rows.len().min(MOST_HEADS)).filter_map(text).collect()
}

/// Rows at the beginning of a sheet in which heads may span columns.
const MOST_HEADS: usize = 20;

/// The rows below the names.
struct Below<I> {
    rows: I,
}

impl<'a, I: Iterator<Item = &'a Row<'static>>> NextRow<'a> for Below<I> {
    fn next(&mut self, cells: &mut Vec<Cow<'a, str>>) -> Result<Option<usize>, RecordError> {
        let Some(row) = self.rows.next() else { return Ok(None) };
        cells.clear();
        cells.extend(row.cells.iter().map(|cell| Cow::Borrowed(cell.as_ref())));
        Ok(Some(row.line))
    }
}
