//! `.xlsx` by the crate calamine, cell by cell.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Cursor;

use calamine::{DataRef, Reader, SheetType, SheetVisible, Xlsx, XlsxError, XlsxFormulaMetadata};

use super::SheetName;
use super::excel::{behind, is_external, iso, no_cached_value, no_date, refers_elsewhere, shown, uses};
use super::grid::{Cell, Cells, Region, Sheet};
use super::package::{self, Archive, attribute, damaged};
use crate::{ForeignError, MAX_CELLS};

/// An open `.xlsx` file.
pub(crate) struct Book<'a> {
    xlsx: Xlsx<Cursor<&'a [u8]>>,
    /// Its values were not computed by the program that wrote the file, or not to the end.
    is_stale: bool,
    /// Names that stand for cells of other files.
    elsewhere: Vec<String>,
}

impl<'a> Book<'a> {
    /// Opens a checked zip file.
    ///
    /// # Errors
    ///
    /// If lists in it contradict each other.
    pub(crate) fn new(mut archive: Archive<'a>, bytes: &'a [u8]) -> Result<Self, ForeignError> {
        let parts = package::parts(&archive);
        let ending = |end: &str| parts.iter().find(|part| part.to_ascii_lowercase().ends_with(end));
        // The reader reserves what the file announces.
        if let Some(part) = ending("sharedstrings.xml") {
            let size = archive.by_name(part).map_err(|e| damaged(part, &e))?.size();
            let count = package::first_tag(&mut archive, part, "sst", |tag| attribute(tag, "uniqueCount"))?;
            if count.and_then(|count| count.parse::<u64>().ok()).is_some_and(|count| count > size) {
                return Err(damaged(part, &"it announces more texts than it has bytes"));
            }
        }
        let is_stale = match ending("workbook.xml") {
            Some(part) => package::first_tag(&mut archive, part, "calcPr", |tag| {
                let is = |name, values: [&str; 2]| attribute(tag, name).is_some_and(|value| values.contains(&&*value));
                Some(is("fullCalcOnLoad", ["1", "true"]) || is("calcCompleted", ["0", "false"]))
            })?
            .unwrap_or(false),
            None => false,
        };
        let xlsx = Xlsx::new(Cursor::new(bytes)).map_err(|e| damaged("", &e))?;
        let elsewhere = xlsx.defined_names().iter().filter(|(_, formula)| is_external(formula));
        let elsewhere = elsewhere.map(|(name, _)| name.clone()).collect();
        Ok(Self { xlsx, is_stale, elsewhere })
    }

    /// Its sheets with cells.
    pub(crate) fn names(&self) -> Vec<SheetName> {
        let sheets = self.xlsx.sheets_metadata().iter().filter(|sheet| sheet.typ == SheetType::WorkSheet);
        sheets
            .map(|sheet| SheetName { name: sheet.name.clone(), is_hidden: sheet.visible != SheetVisible::Visible })
            .collect()
    }

    /// Names of ranges, and what they stand for.
    pub(crate) fn defined_names(&self) -> &[(String, String)] {
        self.xlsx.defined_names()
    }

    /// Reads a sheet.
    ///
    /// # Errors
    ///
    /// If a formula has no trustworthy value, or the sheet is damaged or too large.
    pub(crate) fn sheet(&mut self, name: &str, range: Option<Region>) -> Result<Sheet, ForeignError> {
        let broken = |e: XlsxError| damaged(&format!("sheet {name}"), &e);
        let (formats, format_of_cell) = self.formats(name)?;
        let merged = self.xlsx.merge_cells_by_sheet_name(name).map_err(broken)?;
        let merged = merged.iter().map(|d| Region {
            first: (d.start.0 as usize + 1, d.start.1 as usize + 1),
            last: (d.end.0 as usize + 1, d.end.1 as usize + 1),
        });
        let merged: Vec<Region> = merged.collect();
        let mut cells = Cells::new(name, range);
        let mut external_shared = BTreeSet::new();
        let elsewhere = self.elsewhere.clone();
        let is_external = |formula: &str| is_external(formula) || uses(formula, &elsewhere);
        let mut reader = self.xlsx.worksheet_cells_reader(name).map_err(broken)?;
        while let Some(record) = reader.next_cell_with_formula_metadata().map_err(broken)? {
            let (row, column) = (record.pos.0 as usize + 1, record.pos.1 as usize + 1);
            let is_external = match &record.formula {
                Some(XlsxFormulaMetadata::Normal { formula }) => is_external(formula),
                Some(XlsxFormulaMetadata::Shared { shared_index, formula, .. }) => {
                    let found = is_external(formula);
                    if found {
                        external_shared.insert(*shared_index);
                    }
                    found
                }
                Some(XlsxFormulaMetadata::SharedDerived { shared_index }) => external_shared.contains(shared_index),
                _ => false,
            };
            if !cells.wants(row, column) {
                continue;
            }
            if is_external {
                return Err(refers_elsewhere(name, row, column));
            }
            if record.formula.is_some() && (record.value == DataRef::Empty || self.is_stale) {
                return Err(no_cached_value(name, row, column));
            }
            let behind = format_of_cell.get(&record.pos).and_then(|at| formats.get(*at)?.as_ref());
            let cell = match record.value {
                DataRef::Empty => Cell::Empty,
                DataRef::Float(x) => shown(x, behind),
                DataRef::Int(i) => shown(i as f64, behind),
                DataRef::Bool(is) => Cell::Bool(is),
                DataRef::Error(error) => Cell::Error(error.to_string()),
                DataRef::DateTime(date) => iso(&date).ok_or_else(|| no_date(name, row, column, date.as_f64()))?,
                DataRef::DateTimeIso(date) | DataRef::DurationIso(date) => Cell::Date(date),
                DataRef::String(text) if text.is_empty() => Cell::Empty,
                DataRef::String(text) => Cell::Text(text),
                DataRef::SharedString("") => Cell::Empty,
                DataRef::SharedString(text) => Cell::Text(text.to_owned()),
            };
            cells.push(row, column, cell)?;
        }
        cells.finish(merged)
    }

    /// What number formats show behind numbers, and the cells that have such a format; rows and columns from 0. Read apart from the values: the reader gives
    /// either styles or formulas.
    fn formats(&mut self, name: &str) -> Result<(Vec<Option<String>>, CellFormats), ForeignError> {
        let broken = |e: XlsxError| damaged(&format!("sheet {name}"), &e);
        let mut reader = self.xlsx.worksheet_cells_reader(name).map_err(broken)?;
        let formats: Vec<Option<String>> =
            reader.styles().iter().map(|style| behind(&style.number_format.as_ref()?.format_code)).collect();
        let mut out = CellFormats::new();
        if formats.iter().any(Option::is_some) {
            while let Some((row, column, style)) = reader.next_style_id().map_err(broken)? {
                if matches!(formats.get(style), Some(Some(_))) {
                    out.insert((row, column), style);
                }
                if out.len() > MAX_CELLS {
                    return Err(damaged(name, &"it formats more cells than are read"));
                }
            }
        }
        Ok((formats, out))
    }
}

/// Number formats of cells, by row and column from 0.
type CellFormats = BTreeMap<(u32, u32), usize>;
