//! Workbooks: `.xlsx`, `.xls` and `.ods` as grids of cells, not yet columns.
//!
//! | in the file | here |
//! |---|---|
//! | a formula | the value that its program stored; without one, or where it reads another file, an error that names the cell |
//! | a number as text | [`Cell::Text`] |
//! | a number with a word behind it | [`Cell::Shown`] |
//! | a number shown in percent | [`Cell::Percent`], the fraction |
//! | a date, a time, a duration | [`Cell::Date`], a text |
//! | merged cells | the content in their first cell, the regions in [`Sheet::merged`] |
//! | hidden rows and columns | as any other |
//!
//! Rejected: workbooks with a password, `.xlsb`, and files that would unpack to more than the limits of this crate.
//!
//! Not covered: charts, macros, what a cell's colour says.

mod biff;
mod excel;
mod grid;
mod ods;
mod ole;
mod package;
mod xls;
mod xlsx;

pub use grid::{Cell, Region, Sheet, cell_name};

use crate::guard::guarded;
use crate::{ForeignError, MAX_BYTES};

/// A sheet of a workbook.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SheetName {
    /// Its name.
    pub name: String,
    /// Whether its program hides it.
    pub is_hidden: bool,
}

/// An open workbook.
pub struct Workbook<'a> {
    book: Book<'a>,
    sheets: Vec<SheetName>,
}

enum Book<'a> {
    Xlsx(Box<xlsx::Book<'a>>),
    Xls(Box<xls::Book<'a>>),
    Ods(Box<ods::Book<'a>>),
}

impl<'a> Workbook<'a> {
    /// Opens a workbook; its first bytes and parts say of which kind it is, whatever its name.
    ///
    /// # Errors
    ///
    /// If the file is no workbook, protected by a password, damaged, or too large.
    pub fn open(bytes: &'a [u8]) -> Result<Self, ForeignError> {
        if bytes.len() as u64 > MAX_BYTES {
            return Err(ForeignError(format!(
                "has {} MiB; workbooks of at most {} MiB are read; save the sheet that is needed as CSV",
                bytes.len() >> 20,
                MAX_BYTES >> 20
            )));
        }
        guarded("the workbook", || {
            let book = Book::open(bytes)?;
            let sheets = match &book {
                Book::Xlsx(book) => book.names(),
                Book::Xls(book) => book.names(),
                Book::Ods(book) => book.names(),
            };
            if sheets.is_empty() {
                return Err(ForeignError("the workbook has no sheet with cells".into()));
            }
            Ok(Self { book, sheets })
        })
    }

    /// Its sheets in the order of the file; chart sheets are left out, hidden sheets are marked.
    #[must_use]
    pub fn sheets(&self) -> &[SheetName] {
        &self.sheets
    }

    /// Names that the workbook gives to ranges, each with what it stands for, such as `Sheet1!$B$3:$H$40`.
    #[must_use]
    pub fn defined_names(&self) -> &[(String, String)] {
        match &self.book {
            Book::Xlsx(book) => book.defined_names(),
            Book::Xls(book) => book.defined_names(),
            Book::Ods(book) => book.defined_names(),
        }
    }

    /// Reads a sheet, or a range of it; cells outside of the range are not looked at.
    ///
    /// # Errors
    ///
    /// If there is no such sheet, a formula has no trustworthy value, or the sheet is damaged or too large.
    pub fn sheet(&mut self, name: &str, range: Option<Region>) -> Result<Sheet, ForeignError> {
        if !self.sheets.iter().any(|sheet| sheet.name == name) {
            let all: Vec<String> = self.sheets.iter().map(|sheet| format!("{:?}", sheet.name)).collect();
            return Err(ForeignError(format!("has no sheet {name:?}; its sheets are {}", all.join(", "))));
        }
        guarded("the workbook", || match &mut self.book {
            Book::Xlsx(book) => book.sheet(name, range),
            Book::Xls(book) => book.sheet(name, range),
            Book::Ods(book) => book.sheet(name, range),
        })
    }
}

impl<'a> Book<'a> {
    fn open(bytes: &'a [u8]) -> Result<Self, ForeignError> {
        if bytes.starts_with(&ole::MAGIC) {
            return Ok(Self::Xls(Box::new(xls::Book::new(bytes)?)));
        }
        if !bytes.starts_with(b"PK") {
            return Err(ForeignError(
                "is not a workbook: .xlsx and .ods begin as zip files do, .xls as OLE files do; a text with the ending .xls is renamed to \
                 .csv or .txt"
                    .into(),
            ));
        }
        let archive = package::open(bytes)?;
        let parts = package::parts(&archive);
        let has = |end: &str| parts.iter().any(|part| part.to_ascii_lowercase().ends_with(end));
        if has("workbook.bin") {
            return Err(ForeignError(
                "is a binary workbook (.xlsb), which is not read; save it in Excel as .xlsx".into(),
            ));
        }
        if has("workbook.xml") {
            return Ok(Self::Xlsx(Box::new(xlsx::Book::new(archive, bytes)?)));
        }
        if has("content.xml") {
            return Ok(Self::Ods(Box::new(ods::Book::new(archive)?)));
        }
        Err(ForeignError(
            "is a zip file without a workbook; unpack it and name the table, or export the table as .xlsx or CSV"
                .into(),
        ))
    }
}
