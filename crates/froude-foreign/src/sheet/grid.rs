//! Cells of a sheet, their names, and the rectangle that holds them.

use std::fmt;
use std::str::FromStr;

use crate::{ForeignError, MAX_CELLS};

/// A cell as the sheet shows it. A formula counts as the value that its program stored with it.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Cell {
    /// Nothing, or the text `""` of a formula.
    #[default]
    Empty,
    /// A number.
    Number(f64),
    /// A number that the sheet shows in percent, as a fraction: 0.12 for a cell that reads `12 %`.
    Percent(f64),
    /// A number behind which the sheet shows a word, as a unit: `1.5 kN`.
    Shown(f64, String),
    /// A text; a number that is stored as text, too.
    Text(String),
    /// A date, a time of day or a duration as in ISO 8601: `2024-03-01`, `2024-03-01T12:30:00.250`, `12:30:00`, `PT90.5S`.
    Date(String),
    /// True or false.
    Bool(bool),
    /// An error of a formula, such as `#DIV/0!`.
    Error(String),
}

/// A rectangle of cells; rows and columns count from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    /// Row and column of its upper left cell.
    pub first: (usize, usize),
    /// Row and column of its lower right cell.
    pub last: (usize, usize),
}

impl Region {
    /// Whether it holds the cell.
    pub(crate) fn contains(&self, (row, column): (usize, usize)) -> bool {
        (self.first.0..=self.last.0).contains(&row) && (self.first.1..=self.last.1).contains(&column)
    }

    fn n_cells(&self) -> usize {
        (self.last.0.saturating_sub(self.first.0) + 1).saturating_mul(self.last.1.saturating_sub(self.first.1) + 1)
    }
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", cell_name(self.first.0, self.first.1), cell_name(self.last.0, self.last.1))
    }
}

impl FromStr for Region {
    type Err = ForeignError;

    /// Reads `B3:H40`, also `$B$3:$H$40`.
    fn from_str(text: &str) -> Result<Self, ForeignError> {
        let corners = text.split_once(':').and_then(|(first, last)| Some((corner(first)?, corner(last)?)));
        match corners {
            Some((first, last)) if first.0 <= last.0 && first.1 <= last.1 => Ok(Self { first, last }),
            Some(_) => Err(ForeignError(format!(
                "{text:?}: a range names its upper left cell first and its lower right cell last, as in B3:H40"
            ))),
            None => Err(ForeignError(format!(
                "{text:?} is not a range of cells; write its upper left and its lower right cell, as in B3:H40"
            ))),
        }
    }
}

/// Row and column of `H40` or `$H$40`.
fn corner(text: &str) -> Option<(usize, usize)> {
    let text = text.trim().strip_prefix('$').unwrap_or(text.trim());
    let digits = text.find(|c: char| !c.is_ascii_alphabetic())?;
    let (letters, number) = text.split_at_checked(digits)?;
    let number = number.strip_prefix('$').unwrap_or(number);
    let is_number = (1..=7).contains(&number.len()) && number.bytes().all(|b| b.is_ascii_digit());
    if !(1..=3).contains(&letters.len()) || !is_number {
        return None;
    }
    let column = letters.bytes().fold(0, |sum, b| sum * 26 + usize::from(b.to_ascii_uppercase() - b'A') + 1);
    let row: usize = number.parse().ok()?;
    (row > 0).then_some((row, column))
}

/// Name of a cell, `C7` for row 7 and column 3; both count from 1.
#[must_use]
pub fn cell_name(row: usize, column: usize) -> String {
    let (mut letters, mut rest) = (Vec::new(), column);
    while rest > 0 {
        rest -= 1;
        letters.push(char::from(b'A' + u8::try_from(rest % 26).unwrap_or(0)));
        rest /= 26;
    }
    letters.iter().rev().collect::<String>() + &row.to_string()
}

/// A sheet, or a range of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sheet {
    /// Its name.
    pub name: String,
    /// Row of the sheet that the first of `rows` is; counts from 1.
    pub first_row: usize,
    /// Column of the sheet that the first cell of each row is; counts from 1.
    pub first_column: usize,
    /// Its cells, all rows of one length: the smallest rectangle that holds every cell with content.
    pub rows: Vec<Vec<Cell>>,
    /// Merged cells. Only the first cell of each has the content; [`head`](Self::head) gives it for the others, too.
    pub merged: Vec<Region>,
}

impl Sheet {
    /// The cell at `row` and `column` of `rows`, both from 0; inside of merged cells that of their first cell.
    ///
    /// For lines of names and units, where one name often spans several columns. In lines of data a merged cell is one value, and the
    /// others of its span were not written.
    #[must_use]
    pub fn head(&self, row: usize, column: usize) -> &Cell {
        const EMPTY: &Cell = &Cell::Empty;
        let place = (row + self.first_row, column + self.first_column);
        let (row, column) =
            self.merged.iter().find(|region| region.contains(place)).map_or(place, |region| region.first);
        let row = row.checked_sub(self.first_row).and_then(|row| self.rows.get(row));
        let cell = row.and_then(|row| row.get(column.checked_sub(self.first_column)?));
        cell.unwrap_or(EMPTY)
    }

    /// Name in the sheet of the cell at `row` and `column` of `rows`, both from 0.
    #[must_use]
    pub fn cell_name(&self, row: usize, column: usize) -> String {
        cell_name(row + self.first_row, column + self.first_column)
    }
}

/// Whether a rectangle is too large for the cells with content in it: a few far cells would fill the memory with blanks.
pub(crate) fn is_too_loose(n_cells: usize, n_written: usize) -> bool {
    n_cells > 1_000_000 + 1000 * n_written
}

/// Collects the cells of a sheet that have content and lie in a range, and watches their number.
pub(crate) struct Cells<'a> {
    sheet: &'a str,
    range: Option<Region>,
    used: Option<Region>,
    found: Vec<(usize, usize, Cell)>,
}

impl<'a> Cells<'a> {
    pub(crate) fn new(sheet: &'a str, range: Option<Region>) -> Self {
        Self { sheet, range, used: None, found: Vec::new() }
    }

    /// Whether the cell is asked for.
    pub(crate) fn wants(&self, row: usize, column: usize) -> bool {
        self.range.is_none_or(|range| range.contains((row, column)))
    }

    /// Whether one of the cells of a rectangle is asked for.
    pub(crate) fn wants_any(&self, region: Region) -> bool {
        self.range.is_none_or(|range| {
            range.first.0 <= region.last.0
                && region.first.0 <= range.last.0
                && range.first.1 <= region.last.1
                && region.first.1 <= range.last.1
        })
    }

    /// Adds a cell; row and column count from 1.
    ///
    /// # Errors
    ///
    /// If the rectangle around the cells becomes too large.
    pub(crate) fn push(&mut self, row: usize, column: usize, cell: Cell) -> Result<(), ForeignError> {
        self.repeat(Region { first: (row, column), last: (row, column) }, cell)
    }

    /// Adds one cell at all places of a region that are asked for.
    ///
    /// # Errors
    ///
    /// If the rectangle around the cells becomes too large; nothing is added then.
    pub(crate) fn repeat(&mut self, region: Region, cell: Cell) -> Result<(), ForeignError> {
        if cell == Cell::Empty || !self.wants_any(region) {
            return Ok(());
        }
        let region = self.range.map_or(region, |range| Region {
            first: (region.first.0.max(range.first.0), region.first.1.max(range.first.1)),
            last: (region.last.0.min(range.last.0), region.last.1.min(range.last.1)),
        });
        let old = self.used.unwrap_or(region);
        let new = Region {
            first: (old.first.0.min(region.first.0), old.first.1.min(region.first.1)),
            last: (old.last.0.max(region.last.0), old.last.1.max(region.last.1)),
        };
        if new.n_cells() > MAX_CELLS || self.found.len() >= MAX_CELLS {
            let (name, place) = (self.sheet, cell_name(region.last.0, region.last.1));
            return Err(ForeignError(format!(
                "sheet {name:?}: with cell {place} the cells with content span {new}, more than the limit of {} million; \
                 name the range that holds the table, as in B3:H40",
                MAX_CELLS / 1_000_000
            )));
        }
        self.used = Some(new);
        for row in region.first.0..=region.last.0 {
            self.found.extend((region.first.1..=region.last.1).map(|column| (row, column, cell.clone())));
        }
        Ok(())
    }

    /// The sheet of the cells.
    ///
    /// # Errors
    ///
    /// If one cell occurs twice, or few cells lie far from each other.
    pub(crate) fn finish(self, merged: Vec<Region>) -> Result<Sheet, ForeignError> {
        let merged = merged.into_iter().filter(|region| region.n_cells() > 1).collect();
        let name = self.sheet.to_owned();
        let Some(Region { first: (first_row, first_column), last }) = self.used else {
            return Ok(Sheet { name, first_row: 1, first_column: 1, rows: Vec::new(), merged });
        };
        let used = Region { first: (first_row, first_column), last };
        if is_too_loose(used.n_cells(), self.found.len()) {
            let n = self.found.len();
            return Err(ForeignError(format!(
                "sheet {name:?}: {n} cells with content are spread over {used}; name the range that holds the table, as in B3:H40"
            )));
        }
        let mut rows = vec![vec![Cell::Empty; last.1 + 1 - first_column]; last.0 + 1 - first_row];
        for (row, column, cell) in self.found {
            match rows.get_mut(row - first_row).and_then(|cells| cells.get_mut(column - first_column)) {
                Some(slot) if *slot == Cell::Empty => *slot = cell,
                _ => {
                    let place = cell_name(row, column);
                    return Err(ForeignError(format!(
                        "sheet {name:?}: cell {place} occurs twice; the file is damaged"
                    )));
                }
            }
        }
        Ok(Sheet { name, first_row, first_column, rows, merged })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_has_the_name_that_its_program_shows() {
        let names = [(1, 1, "A1"), (7, 3, "C7"), (40, 26, "Z40"), (1, 27, "AA1"), (1048576, 16384, "XFD1048576")];
        for (row, column, name) in names {
            assert_eq!(cell_name(row, column), name);
            assert_eq!(corner(name), Some((row, column)));
        }
    }

    #[test]
    fn a_range_names_its_two_corners() {
        assert_eq!("B3:H40".parse(), Ok(Region { first: (3, 2), last: (40, 8) }));
        assert_eq!("$b$3:$h$40".parse::<Region>().map(|region| region.to_string()), Ok("B3:H40".to_owned()));
        for text in ["", "B3", "B:H", "3:40", "B0:H4", "ABCD1:H4", "B3:H99999999", "B3:H4:K5", "é3:H4", "B3;H40"] {
            let error = text.parse::<Region>().unwrap_err().0;
            assert!(
                error.ends_with("is not a range of cells; write its upper left and its lower right cell, as in B3:H40")
            );
        }
        assert!("H40:B3".parse::<Region>().unwrap_err().0.contains("upper left cell first"));
    }

    #[test]
    fn a_far_cell_is_named_and_nothing_is_allocated_for_it() {
        let mut cells = Cells::new("drift", None);
        cells.push(1, 1, Cell::Number(1.0)).unwrap();
        let error = cells.push(1048576, 16384, Cell::Number(1.0)).unwrap_err().0;
        assert_eq!(
            error,
            "sheet \"drift\": with cell XFD1048576 the cells with content span A1:XFD1048576, more than the limit of 50 million; \
             name the range that holds the table, as in B3:H40"
        );
    }

    #[test]
    fn few_cells_far_from_each_other_are_no_table() {
        let mut cells = Cells::new("drift", None);
        cells.push(1, 1, Cell::Number(1.0)).unwrap();
        cells.push(50_000, 900, Cell::Number(1.0)).unwrap();
        let error = cells.finish(Vec::new()).unwrap_err().0;
        assert_eq!(
            error,
            "sheet \"drift\": 2 cells with content are spread over A1:AHP50000; name the range that holds the table, as in B3:H40"
        );
    }

    #[test]
    fn a_merged_head_counts_for_its_whole_span() {
        let mut cells = Cells::new("drift", None);
        cells.push(3, 2, Cell::Text("force".into())).unwrap();
        cells.push(4, 4, Cell::Number(1.0)).unwrap();
        let sheet = cells.finish(vec![Region { first: (3, 2), last: (3, 4) }]).unwrap();
        let force = Cell::Text("force".into());
        assert_eq!([sheet.head(0, 0), sheet.head(0, 2), sheet.head(1, 0)], [&force, &force, &Cell::Empty]);
        assert_eq!(sheet.rows[0][2], Cell::Empty);
        assert_eq!(sheet.cell_name(1, 2), "D4");
    }
}
