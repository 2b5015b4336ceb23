//! `.ods`: OpenDocument 1.3, part 3. Read here, since the crate calamine expands repeated cells without a limit and gives no merged cells.

use std::collections::BTreeSet;

use quick_xml::events::{BytesStart, Event};

use super::SheetName;
use super::excel::{no_cached_value, refers_elsewhere, shown};
use super::grid::{Cell, Cells, Region, Sheet, cell_name};
use super::package::{Archive, attribute, damaged, xml};
use crate::ForeignError;

const CONTENT: &str = "content.xml";
/// Rows and columns of the largest sheets of LibreOffice and Excel.
const MAX_ROWS: usize = 1_048_576;
const MAX_COLUMNS: usize = 16_384;
/// Most letters of a cell.
const MAX_LETTERS: usize = 1 << 20;

/// An open `.ods` file.
pub(crate) struct Book<'a> {
    archive: Archive<'a>,
    sheets: Vec<SheetName>,
    /// Named ranges, and what they stand for.
    defined_names: Vec<(String, String)>,
}

impl<'a> Book<'a> {
    /// Opens a checked zip file.
    ///
    /// # Errors
    ///
    /// If the workbook is protected by a password, or damaged.
    pub(crate) fn new(mut archive: Archive<'a>) -> Result<Self, ForeignError> {
        let manifest = "META-INF/manifest.xml";
        let is_encrypted = archive.index_for_name(manifest).is_some()
            && super::package::first_tag(&mut archive, manifest, "encryption-data", |_| Some(()))?.is_some();
        if is_encrypted {
            return Err(ForeignError(
                "the workbook is protected by a password; open it in LibreOffice and save it without one (File, Save As, clear \"Save with \
                 password\")"
                    .into(),
            ));
        }
        let mut book = Self { archive, sheets: Vec::new(), defined_names: Vec::new() };
        book.list()?;
        Ok(book)
    }

    /// Its sheets with cells.
    pub(crate) fn names(&self) -> Vec<SheetName> {
        self.sheets.clone()
    }

    /// Names of ranges, and what they stand for.
    pub(crate) fn defined_names(&self) -> &[(String, String)] {
        &self.defined_names
    }

    fn list(&mut self) -> Result<(), ForeignError> {
        let mut reader = xml(&mut self.archive, CONTENT)?;
        let (mut buffer, mut style, mut hidden) = (Vec::new(), None, BTreeSet::new());
        loop {
            buffer.clear();
            match reader.read_event_into(&mut buffer).map_err(|e| damaged(CONTENT, &e))? {
                Event::Start(tag) => match tag.name().as_ref() {
                    "style:style" => style = attribute(&tag, "style:name"),
                    "style:table-properties" if attribute(&tag, "table:display").as_deref() == Some("false") => {
                        hidden.extend(style.clone());
                    }
                    "table:table" => {
                        let is_hidden =
                            attribute(&tag, "table:style-name").is_some_and(|style| hidden.contains(&style));
                        if let Some(name) = attribute(&tag, "table:name") {
                            self.sheets.push(SheetName { name, is_hidden });
                        }
                    }
                    // What LibreOffice keeps of sheets of other files.
                    "table:table-source" => {
                        self.sheets.pop();
                    }
                    "table:named-range" => {
                        let pair = (attribute(&tag, "table:name"), attribute(&tag, "table:cell-range-address"));
                        if let (Some(name), Some(address)) = pair {
                            self.defined_names.push((name, excel_address(&address)));
                        }
                    }
                    _ => {}
                },
                Event::Eof => return Ok(()),
                _ => {}
            }
        }
    }

    /// Reads a sheet.
    ///
    /// # Errors
    ///
    /// If a formula has no trustworthy value, or the sheet is damaged or too large.
    pub(crate) fn sheet(&mut self, name: &str, range: Option<Region>) -> Result<Sheet, ForeignError> {
        let mut reader = xml(&mut self.archive, CONTENT)?;
        let mut buffer = Vec::new();
        let mut cells = Cells::new(name, range);
        let mut merged = Vec::new();
        let mut is_inside = false;
        // The place of the next row and cell, from 1; the row as it is read, to be repeated.
        let (mut row, mut column, mut row_repeats) = (1, 1, 1);
        let mut content: Vec<(usize, usize, Cell)> = Vec::new();
        let mut open: Option<Open> = None;
        loop {
            buffer.clear();
            let event = reader.read_event_into(&mut buffer).map_err(|e| damaged(CONTENT, &e))?;
            match &event {
                Event::Eof => break,
                Event::Start(tag) if tag.name().as_ref() == "table:table" => {
                    if is_inside {
                        return Err(ForeignError(format!(
                            "sheet {name:?}: row {row} has a table inside of a cell, which is not read; move it to a sheet of its own"
                        )));
                    }
                    is_inside = attribute(tag, "table:name").as_deref() == Some(name);
                }
                Event::End(tag) if is_inside && tag.name().as_ref() == "table:table" => break,
                _ if !is_inside => {}
                Event::Start(tag) if tag.name().as_ref() == "table:table-row" => {
                    (column, row_repeats) = (1, repeats(tag, "table:number-rows-repeated"));
                }
                Event::End(tag) if tag.name().as_ref() == "table:table-row" => {
                    for (first, n, cell) in content.drain(..) {
                        let last = (row + row_repeats - 1, first + n - 1);
                        place(name, last.0, last.1)?;
                        cells.repeat(Region { first: (row, first), last }, cell)?;
                    }
                    row = (row + row_repeats).min(MAX_ROWS + 1);
                }
                Event::Start(tag) if matches!(tag.name().as_ref(), "table:table-cell" | "table:covered-table-cell") => {
                    let n = repeats(tag, "table:number-columns-repeated");
                    let spans =
                        ["table:number-rows-spanned", "table:number-columns-spanned"].map(|key| repeats(tag, key));
                    if spans != [1, 1] {
                        merged.push(Region { first: (row, column), last: (row + spans[0] - 1, column + spans[1] - 1) });
                    }
                    open = Some(Open::new(tag, n));
                }
                Event::End(tag) if matches!(tag.name().as_ref(), "table:table-cell" | "table:covered-table-cell") => {
                    if let Some(done) = open.take() {
                        let n = done.repeats;
                        let last = (row + row_repeats - 1, column + n - 1);
                        if cells.wants_any(Region { first: (row, column), last }) {
                            let cell = done.finish(name, row, column)?;
                            if cell != Cell::Empty {
                                content.push((column, n, cell));
                            }
                        }
                        column = (column + n).min(MAX_COLUMNS + 1);
                    }
                }
                event => {
                    if let Some(open) = &mut open {
                        open.event(event).map_err(|why| {
                            ForeignError(format!("sheet {name:?}: cell {}: {why}", cell_name(row, column)))
                        })?;
                    }
                }
            }
        }
        cells.finish(merged)
    }
}

/// `$Runs.$B$3:.$H$40` in the way of Excel, `Runs!$B$3:$H$40`.
fn excel_address(address: &str) -> String {
    let (first, last) = address.split_once(':').unwrap_or((address, ""));
    let (sheet, first) = first.rsplit_once('.').unwrap_or(("", first));
    let last = last.rsplit_once('.').map_or(last, |(_, last)| last);
    let colon = if last.is_empty() { "" } else { ":" };
    format!("{}!{first}{colon}{last}", sheet.trim_start_matches('$'))
}

/// How often a row or cell is repeated, or how far it spans; no more than a sheet has.
fn repeats(tag: &BytesStart<'_>, key: &str) -> usize {
    attribute(tag, key).and_then(|text| text.parse().ok()).unwrap_or(1).clamp(1, MAX_ROWS)
}

/// Checks that a cell with content lies inside of a sheet.
fn place(sheet: &str, row: usize, column: usize) -> Result<(), ForeignError> {
    if row <= MAX_ROWS && column <= MAX_COLUMNS {
        return Ok(());
    }
    Err(ForeignError(format!(
        "sheet {sheet:?}: cell {} lies behind the last cell of a sheet, {}; delete what is repeated there",
        cell_name(row, column),
        cell_name(MAX_ROWS, MAX_COLUMNS)
    )))
}

/// Whether a tag begins what lies on a cell and is no part of it: a note, a picture, a text box.
fn is_beside(tag: &str) -> bool {
    tag == "office:annotation" || tag.starts_with("draw:")
}

/// What a cell shows behind its number: a unit of its format, as in `12.3 kN`.
fn unit_shown(text: &str) -> Option<String> {
    let unit =
        text.trim_start_matches(|c: char| !c.is_ascii_digit()).trim_start_matches(|c: char| !c.is_alphabetic()).trim();
    // `1.2E+03`, and hexadecimal numbers.
    (!unit.is_empty() && !unit.contains(|c: char| c.is_ascii_digit())).then(|| unit.to_owned())
}

/// A cell while it is read.
struct Open {
    repeats: usize,
    kind: String,
    value: Option<String>,
    formula: String,
    is_error: bool,
    text: String,
    n_paragraphs: usize,
    /// Depth inside of a note or picture, whose text is not the cell's.
    note: usize,
    is_paragraph: bool,
}

impl Open {
    fn new(tag: &BytesStart<'_>, repeats: usize) -> Self {
        let kind = attribute(tag, "office:value-type").unwrap_or_default();
        let value = match &*kind {
            "date" => attribute(tag, "office:date-value"),
            "time" => attribute(tag, "office:time-value"),
            "boolean" => attribute(tag, "office:boolean-value"),
            "string" => attribute(tag, "office:string-value"),
            _ => attribute(tag, "office:value"),
        };
        Self {
            repeats,
            kind,
            value,
            formula: attribute(tag, "table:formula").unwrap_or_default(),
            // An extension of LibreOffice; `office:value-type` is never that.
            is_error: tag
                .attributes()
                .filter_map(Result::ok)
                .any(|attribute| attribute.key.local_name().as_ref() == "value-type" && &*attribute.value == "error"),
            text: String::new(),
            n_paragraphs: 0,
            note: 0,
            is_paragraph: false,
        }
    }

    /// Collects the text of the cell.
    fn event(&mut self, event: &Event<'_>) -> Result<(), String> {
        match event {
            Event::Start(tag) if is_beside(tag.name().as_ref()) => self.note += 1,
            Event::End(tag) if is_beside(tag.name().as_ref()) => self.note = self.note.saturating_sub(1),
            _ if self.note > 0 => {}
            Event::Start(tag) => match tag.name().as_ref() {
                "text:p" => {
                    if self.n_paragraphs > 0 {
                        self.text.push('\n');
                    }
                    self.n_paragraphs += 1;
                    self.is_paragraph = true;
                }
                "text:s" => {
                    let n = repeats(tag, "text:c");
                    self.text.extend(std::iter::repeat_n(' ', n));
                }
                "text:tab" => self.text.push('\t'),
                "text:line-break" => self.text.push('\n'),
                _ => {}
            },
            Event::End(tag) if tag.name().as_ref() == "text:p" => self.is_paragraph = false,
            Event::Text(text) if self.is_paragraph => self.text.push_str(&text.xml10_content()),
            Event::CData(text) if self.is_paragraph => self.text.push_str(&text.xml10_content()),
            Event::GeneralRef(reference) if self.is_paragraph => {
                let named = match &*reference.xml10_content() {
                    "amp" => Some('&'),
                    "lt" => Some('<'),
                    "gt" => Some('>'),
                    "quot" => Some('"'),
                    "apos" => Some('\''),
                    _ => reference.resolve_char_ref().ok().flatten(),
                };
                self.text.push(named.ok_or("has a reference to a character that XML does not define")?);
            }
            _ => {}
        }
        if self.text.len() > MAX_LETTERS { Err(format!("has more than {MAX_LETTERS} letters")) } else { Ok(()) }
    }

    fn finish(self, sheet: &str, row: usize, column: usize) -> Result<Cell, ForeignError> {
        // Outside of quotes `'#` ends the name of another file.
        let is_external = self.formula.split('"').step_by(2).any(|part| part.contains("'#"));
        if is_external {
            return Err(refers_elsewhere(sheet, row, column));
        }
        let number = |value: Option<String>| {
            let value = value.unwrap_or_default();
            value.trim().parse::<f64>().map_err(|_| {
                let place = cell_name(row, column);
                ForeignError(format!(
                    "sheet {sheet:?}: cell {place} is a number in the file, but its value is {value:?}"
                ))
            })
        };
        if self.is_error {
            return Ok(Cell::Error(self.text));
        }
        Ok(match &*self.kind {
            "float" => shown(number(self.value)?, unit_shown(&self.text).as_ref()),
            "currency" => Cell::Number(number(self.value)?),
            "percentage" => Cell::Percent(number(self.value)?),
            "date" | "time" => self.value.map_or(Cell::Empty, Cell::Date),
            "boolean" => Cell::Bool(self.value.as_deref() == Some("true")),
            "string" => match self.value.unwrap_or(self.text) {
                text if text.is_empty() => Cell::Empty,
                text => Cell::Text(text),
            },
            "" | "void" if !self.formula.is_empty() => return Err(no_cached_value(sheet, row, column)),
            "" | "void" if self.text.is_empty() => Cell::Empty,
            "" | "void" => Cell::Text(self.text),
            other => {
                let place = cell_name(row, column);
                return Err(ForeignError(format!(
                    "sheet {sheet:?}: cell {place} has the value type {other:?}, which OpenDocument does not define"
                )));
            }
        })
    }
}
