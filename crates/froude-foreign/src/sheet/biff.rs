//! The records of an `.xls` workbook, read before calamine reads them: what it would allocate, and what it does not tell.
//!
//! Microsoft, MS-XLS. Not covered: files of Excel 4 and older.

use std::collections::BTreeMap;

use super::excel::behind;
use super::grid::{Region, is_too_loose};
use super::ole::{Ole, u16_at, u32_at};
use crate::{ForeignError, MAX_CELLS};

/// Rows and columns of the format.
const MAX_ROWS: u32 = 65_536;
const MAX_COLUMNS: u16 = 256;

/// What a sheet has beside its cells.
#[derive(Debug, Default)]
pub(crate) struct SheetNotes {
    /// What the formats of cells show behind their numbers; rows and columns from 0.
    pub(crate) behind: BTreeMap<(u32, u32), String>,
    /// Cells whose formula reads another file.
    pub(crate) external: Vec<Region>,
}

/// Checks a workbook, and gives the notes of its sheets in the order of the file.
///
/// # Errors
///
/// If the workbook is protected by a password, damaged, or larger than its format allows.
pub(crate) fn check(ole: &Ole<'_>) -> Result<Vec<SheetNotes>, ForeignError> {
    let stream = ole.stream("Workbook").or_else(|| ole.stream("Book"));
    let stream = stream.ok_or_else(|| damaged("its stream \"Workbook\" cannot be read"))?;
    let globals = Globals::read(&stream)?;
    let mut n_cells = 0_usize;
    let mut notes = Vec::new();
    for position in &globals.sheets {
        let records = stream.get(*position..).ok_or_else(|| damaged("a sheet lies behind the end of the file"))?;
        let (note, size) = globals.sheet(records)?;
        n_cells = n_cells.saturating_add(size);
        if n_cells > MAX_CELLS {
            return Err(ForeignError(format!(
                "the cells with content of its sheets span more than the limit of {} million; delete what lies far from the tables, or \
                 save the sheet that is needed as CSV",
                MAX_CELLS / 1_000_000
            )));
        }
        notes.push(note);
    }
    Ok(notes)
}

fn damaged(why: &str) -> ForeignError {
    ForeignError(format!("the workbook is damaged: {why}; open it in Excel or LibreOffice and save it again"))
}

/// Type, and content, of each record.
fn records(stream: &[u8]) -> impl Iterator<Item = Result<(u16, &[u8]), ForeignError>> {
    let mut rest = stream;
    std::iter::from_fn(move || {
        let (kind, length) = (u16_at(rest, 0)?, usize::from(u16_at(rest, 2)?));
        let Some(content) = rest.get(4..4 + length) else {
            rest = &[];
            return Some(Err(damaged("a record is cut off")));
        };
        rest = rest.get(4 + length..).unwrap_or_default();
        Some(Ok((kind, content)))
    })
}

/// What the first part of the stream says about all sheets.
#[derive(Default)]
struct Globals {
    /// Places of the sheets in the stream.
    sheets: Vec<usize>,
    /// For each cell format what it shows behind a number.
    behind: Vec<Option<String>>,
    /// For each reference to sheets whether they lie in another file.
    is_elsewhere: Vec<bool>,
    /// For each name of a range or formula whether it reads another file.
    is_name_elsewhere: Vec<bool>,
}

impl Globals {
    fn read(stream: &[u8]) -> Result<Self, ForeignError> {
        let mut globals = Self::default();
        let mut formats = BTreeMap::from([(9, Some("%".to_owned())), (10, Some("%".to_owned()))]);
        let mut cell_formats = Vec::new();
        let mut is_other_file = Vec::new();
        let mut references: Vec<&[u8; 6]> = Vec::new();
        let mut is_excel_95 = false;
        let mut names = Vec::new();
        for record in records(stream) {
            let (kind, content) = record?;
            match kind {
                // FilePass
                0x002F => {
                    return Err(ForeignError(
                        "the workbook is protected by a password; open it in Excel, remove the password (File, Info, Protect Workbook, \
                         Encrypt with Password) and save it"
                            .into(),
                    ));
                }
                // BoundSheet8
                0x0085 => {
                    let position = u32_at(content, 0).filter(|_| content.len() > 7);
                    globals.sheets.push(position.ok_or_else(|| damaged("the entry of a sheet is cut off"))? as usize);
                }
                // Format: id, then length and letters of one or two bytes; the percent sign is one of both.
                0x041E => {
                    let letters = content.get(4..).unwrap_or_default().iter().map(|b| char::from(*b));
                    let format: String = letters.filter(|c| *c != '\0').collect();
                    formats.insert(u16_at(content, 0).unwrap_or(0), behind(&format));
                }
                // XF
                0x00E0 => cell_formats.push(u16_at(content, 2).unwrap_or(0)),
                // SupBook: the workbook itself, functions of add-ins, or another file
                0x01AE => is_other_file.push(!matches!(u16_at(content, 2), Some(0x0401 | 0x3A01))),
                // Bof
                0x0809 => is_excel_95 = u16_at(content, 0) == Some(0x0500),
                // ExternSheet of Excel 95: the name of a sheet, of another file where it begins with 1
                0x0017 if is_excel_95 && content.get(1) == Some(&1) => {
                    return Err(ForeignError(
                        "is a workbook of Excel 95 with links to other files; open it in Excel or LibreOffice, replace the links by their \
                         values and save it as .xlsx"
                            .into(),
                    ));
                }
                // ExternSheet: groups of three numbers, the first is the SupBook
                0x0017 => references.extend(content.get(2..).unwrap_or_default().as_chunks::<6>().0),
                // Lbl
                0x0018 => names.push(content),
                // Eof
                0x000A => break,
                _ => {}
            }
        }
        globals.behind = cell_formats.iter().map(|id| formats.get(id).cloned().flatten()).collect();
        let elsewhere = references.iter().map(|[low, high, ..]| usize::from(u16::from_le_bytes([*low, *high])));
        globals.is_elsewhere = elsewhere.map(|book| is_other_file.get(book) == Some(&true)).collect();
        // Length of the name and of its formula, then ten bytes on the name and the formula.
        let is_external = |lbl: &&[u8]| {
            let letters = usize::from(*lbl.get(3)?) * (1 + usize::from(lbl.get(14)? & 1));
            let formula = [lbl.get(4..6)?, lbl.get(15 + letters..)?].concat();
            Some(globals.is_external(&formula))
        };
        globals.is_name_elsewhere = names.iter().map(|lbl| is_external(lbl).unwrap_or(true)).collect();
        Ok(globals)
    }

    /// Notes of a sheet, and how many cells its used rectangle has.
    fn sheet(&self, stream: &[u8]) -> Result<(SheetNotes, usize), ForeignError> {
        let mut notes = SheetNotes::default();
        let (mut first, mut last) = ((u32::MAX, u32::MAX), (0, 0));
        let mut n_written = 0_usize;
        let mut depth = 0_usize;
        for record in records(stream) {
            let (kind, content) = record?;
            match kind {
                // Bof, of the sheet and of charts in it
                0x0809 => depth += 1,
                // Eof
                0x000A if depth <= 1 => break,
                0x000A => depth -= 1,
                _ if depth > 1 => {}
                // Dimensions: rows and columns that the reader reserves; shorter in Excel 95
                0x0200 => {
                    let (end_row, end_column) = match content.len() {
                        10 => (u16_at(content, 2).map(u32::from), u16_at(content, 6)),
                        _ => (u32_at(content, 4), u16_at(content, 10)),
                    };
                    if end_row.is_none_or(|end| end > MAX_ROWS) || end_column.is_none_or(|end| end > MAX_COLUMNS) {
                        return Err(damaged("a sheet announces more rows or columns than the format has"));
                    }
                }
                // Formula, Number, Label, RString, BoolErr, Rk, LabelSst, MulRk
                0x0006 | 0x0203 | 0x0204 | 0x00D6 | 0x0205 | 0x027E | 0x00FD | 0x00BD => {
                    let (Some(row), Some(column)) = (u16_at(content, 0), u16_at(content, 2)) else {
                        return Err(damaged("a cell is cut off"));
                    };
                    let last_column = match kind {
                        0x00BD => content.len().checked_sub(2).and_then(|at| u16_at(content, at)).unwrap_or(column),
                        _ => column,
                    };
                    if column.max(last_column) >= MAX_COLUMNS || last_column < column {
                        return Err(damaged("a cell lies behind the last column of the format"));
                    }
                    let (row, column, last_column) = (u32::from(row), u32::from(column), u32::from(last_column));
                    first = (first.0.min(row), first.1.min(column));
                    last = (last.0.max(row), last.1.max(last_column));
                    n_written += (last_column + 1 - column) as usize;
                    // MulRk has a format and a number of four bytes for each cell.
                    let formats = (column..=last_column).zip((4..).step_by(6));
                    notes.behind.extend(formats.filter_map(|(column, at)| {
                        let format = usize::from(u16_at(content, at)?);
                        Some(((row, column), self.behind.get(format)?.clone()?))
                    }));
                    if kind == 0x0006 && self.is_external(content.get(20..).unwrap_or_default()) {
                        let place = (row as usize + 1, column as usize + 1);
                        notes.external.push(Region { first: place, last: place });
                    }
                }
                // Array: rows and columns of the cells, then the formula
                0x0221 if self.is_external(content.get(12..).unwrap_or_default()) => {
                    if let (Some(top), Some(bottom), Some([left, right])) =
                        (u16_at(content, 0), u16_at(content, 2), content.get(4..6))
                    {
                        let first = (usize::from(top) + 1, usize::from(*left) + 1);
                        notes.external.push(Region { first, last: (usize::from(bottom) + 1, usize::from(*right) + 1) });
                    }
                }
                _ => {}
            }
        }
        let size = if first.0 > last.0 { 0 } else { (last.0 + 1 - first.0) as usize * (last.1 + 1 - first.1) as usize };
        // The reader fills the whole rectangle.
        if is_too_loose(size, n_written) {
            let (first, last) = ((first.0 as usize, first.1 as usize), (last.0 as usize, last.1 as usize));
            let used = Region { first: (first.0 + 1, first.1 + 1), last: (last.0 + 1, last.1 + 1) };
            return Err(ForeignError(format!(
                "{n_written} cells with content of a sheet are spread over {used}; delete what lies far from the tables, or save the \
                 workbook as .xlsx"
            )));
        }
        Ok((notes, size))
    }

    /// Whether a formula, its length first, reads another file. What cannot be parsed counts as such where the workbook has links at all.
    fn is_external(&self, formula: &[u8]) -> bool {
        if !self.is_elsewhere.contains(&true) {
            return false;
        }
        let length = u16_at(formula, 0).map_or(0, usize::from);
        let mut rest = formula.get(2..2 + length).unwrap_or_default();
        while let [token, after @ ..] = rest {
            // Tokens from 0x20 on occur in three classes with one meaning.
            let token = if *token >= 0x20 { *token & 0x1F | 0x20 } else { *token };
            // A name counts from 1.
            let name = u16_at(after, 0).map_or(0, usize::from).checked_sub(1);
            if token == 0x23 && name.and_then(|name| self.is_name_elsewhere.get(name)) == Some(&true) {
                return true;
            }
            let length = match token {
                0x01 | 0x02 | 0x23 | 0x24 | 0x2A | 0x2C => 4,
                0x03..=0x16 => 0,
                // A text: letters of one or two bytes.
                0x17 => match after {
                    [n, flags, ..] => 2 + usize::from(*n) * (1 + usize::from(flags & 1)),
                    _ => return true,
                },
                // An attribute; that of CHOOSE has a list.
                0x19 => match after {
                    [0x04, low, high, ..] => 3 + 2 * (usize::from(u16::from_le_bytes([*low, *high])) + 1),
                    _ => 3,
                },
                0x1C | 0x1D => 1,
                0x1E | 0x21 | 0x29 => 2,
                0x1F | 0x25 | 0x2B | 0x2D => 8,
                0x20 => 7,
                0x22 => 3,
                0x26..=0x28 => 6,
                // References to other sheets: which, then the cells.
                0x39..=0x3D => {
                    let reference = u16_at(after, 0).map_or(usize::MAX, usize::from);
                    if self.is_elsewhere.get(reference).copied().unwrap_or(true) {
                        return true;
                    }
                    if matches!(token, 0x3B | 0x3D) { 10 } else { 6 }
                }
                _ => return true,
            };
            rest = after.get(length..).unwrap_or_default();
        }
        false
    }
}
