//! `.xls` by the crate calamine.

use std::io::Cursor;

use calamine::{Data, Reader, SheetType, SheetVisible, Xls};

use super::SheetName;
use super::biff::{self, SheetNotes};
use super::excel::{iso, no_cached_value, no_date, refers_elsewhere, shown};
use super::grid::{Cell, Cells, Region, Sheet};
use super::ole::Ole;
use super::package::damaged;
use crate::ForeignError;

/// An open `.xls` file.
pub(crate) struct Book<'a> {
    book: Xls<Cursor<&'a [u8]>>,
    notes: Vec<SheetNotes>,
}

impl<'a> Book<'a> {
    /// Opens an OLE file.
    ///
    /// # Errors
    ///
    /// If it holds no workbook, or one that is protected, damaged or too large.
    pub(crate) fn new(bytes: &'a [u8]) -> Result<Self, ForeignError> {
        let ole = Ole::new(bytes)?;
        if ole.has("EncryptedPackage") {
            return Err(ForeignError(
                "the workbook is protected by a password; open it in Excel, remove the password (File, Info, Protect Workbook, Encrypt \
                 with Password) and save it"
                    .into(),
            ));
        }
        if !ole.has("Workbook") && !ole.has("Book") {
            return Err(ForeignError(
                "is an OLE file without a workbook, such as a document of Word or a project of a measuring program; export the table as CSV"
                    .into(),
            ));
        }
        let notes = biff::check(&ole)?;
        let book = Xls::new(Cursor::new(bytes)).map_err(|e| damaged("", &e))?;
        Ok(Self { book, notes })
    }

    /// Its sheets with cells.
    pub(crate) fn names(&self) -> Vec<SheetName> {
        let sheets = self.book.sheets_metadata().iter().filter(|sheet| sheet.typ == SheetType::WorkSheet);
        sheets
            .map(|sheet| SheetName { name: sheet.name.clone(), is_hidden: sheet.visible != SheetVisible::Visible })
            .collect()
    }

    /// Names of ranges, and what they stand for.
    pub(crate) fn defined_names(&self) -> &[(String, String)] {
        self.book.defined_names()
    }

    /// Reads a sheet.
    ///
    /// # Errors
    ///
    /// If a formula has no trustworthy value.
    pub(crate) fn sheet(&mut self, name: &str, range: Option<Region>) -> Result<Sheet, ForeignError> {
        let index = self.book.sheets_metadata().iter().position(|sheet| sheet.name == name);
        let notes =
            index.and_then(|index| self.notes.get(index)).ok_or_else(|| damaged(name, &"its sheet is missing"))?;
        let merged = self.book.merge_cells_by_sheet_name(name).map_err(|e| damaged(name, &e))?;
        let merged = merged.iter().map(|d| Region {
            first: (d.start.0 as usize + 1, d.start.1 as usize + 1),
            last: (d.end.0 as usize + 1, d.end.1 as usize + 1),
        });
        let formulas = self.book.worksheet_formula(name).map_err(|e| damaged(name, &e))?;
        let values = self.book.worksheet_range(name).map_err(|e| damaged(name, &e))?;
        let mut cells = Cells::new(name, range);
        if let Some(region) = notes.external.iter().find(|region| cells.wants_any(**region)) {
            return Err(refers_elsewhere(name, region.first.0, region.first.1));
        }
        let start = formulas.start().unwrap_or_default();
        for (row, column, formula) in formulas.used_cells() {
            let place = (start.0 + row as u32, start.1 + column as u32);
            let is_empty = values.get_value(place).is_none_or(|value| *value == Data::Empty);
            let (row, column) = (place.0 as usize + 1, place.1 as usize + 1);
            if !formula.is_empty() && is_empty && cells.wants(row, column) {
                return Err(no_cached_value(name, row, column));
            }
        }
        let start = values.start().unwrap_or_default();
        for (row, column, value) in values.used_cells() {
            let place = (start.0 + row as u32, start.1 + column as u32);
            let (row, column) = (place.0 as usize + 1, place.1 as usize + 1);
            let behind = notes.behind.get(&place);
            let cell = match value {
                Data::Empty => Cell::Empty,
                Data::Float(x) => shown(*x, behind),
                Data::Int(i) => shown(*i as f64, behind),
                Data::Bool(is) => Cell::Bool(*is),
                Data::Error(error) => Cell::Error(error.to_string()),
                Data::DateTime(date) => match iso(date) {
                    Some(cell) => cell,
                    None if !cells.wants(row, column) => Cell::Empty,
                    None => return Err(no_date(name, row, column, date.as_f64())),
                },
                Data::DateTimeIso(date) | Data::DurationIso(date) => Cell::Date(date.clone()),
                Data::String(text) if text.is_empty() => Cell::Empty,
                Data::String(text) => Cell::Text(text.clone()),
            };
            cells.push(row, column, cell)?;
        }
        cells.finish(merged.collect())
    }
}
