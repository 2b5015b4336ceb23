//! Columns in a line each.

use super::{Cells, Digits, ResultColumn, ResultTable};
use crate::units::{Unit, parse_unit};

/// Makes the columns of a table from its rows.
pub struct TableBuilder<'r, R> {
    key: String,
    caption: String,
    rows: &'r [R],
    are_facts: bool,
}

/// A table of facts about one thing: people read it as quantity, value and unit.
#[must_use]
pub fn facts<'r, R>(key: &str, caption: impl Into<String>, of: &'r R) -> TableBuilder<'r, R> {
    TableBuilder { are_facts: true, ..TableBuilder::new(key, caption, std::slice::from_ref(of)) }
}

impl<'r, R> TableBuilder<'r, R> {
    /// A table with a row for each of these.
    #[must_use]
    pub fn new(key: &str, caption: impl Into<String>, rows: &'r [R]) -> Self {
        Self { key: key.to_owned(), caption: caption.into(), rows, are_facts: false }
    }

    fn cells<T>(&self, of: impl Fn(&'r R) -> T) -> Vec<T> {
        self.rows.iter().map(of).collect()
    }

    /// A number in SI.
    pub fn number<N: Into<Option<f64>>>(&self, key: &str, head: &str, of: impl Fn(&'r R) -> N) -> ResultColumn {
        ResultColumn::new(key, head, Cells::Number(self.cells(|row| of(row).into().unwrap_or(f64::NAN))))
    }

    /// A number in SI with its standard uncertainty, which has a key of its own.
    pub fn uncertain<N: Into<Option<f64>>, S: Into<Option<f64>>>(
        &self,
        [key, standard]: [&str; 2],
        head: &str,
        of: impl Fn(&'r R) -> N,
        standard_of: impl Fn(&'r R) -> S,
    ) -> ResultColumn {
        let standards = self.cells(|row| standard_of(row).into().unwrap_or(f64::NAN));
        ResultColumn { standard: Some((standard.to_owned(), standards)), ..self.number(key, head, of) }
    }

    /// How many.
    pub fn count<N: Into<Option<usize>>>(&self, key: &str, head: &str, of: impl Fn(&'r R) -> N) -> ResultColumn {
        ResultColumn::new(key, head, Cells::Count(self.cells(|row| of(row).into())))
    }

    /// Ends of an interval, in SI.
    pub fn interval<N: Into<Option<[f64; 2]>>>(&self, key: &str, head: &str, of: impl Fn(&'r R) -> N) -> ResultColumn {
        ResultColumn::new(key, head, Cells::Interval(self.cells(|row| of(row).into())))
    }

    /// Numbers of one kind, in SI.
    pub fn numbers<N: Into<Option<Vec<f64>>>>(&self, key: &str, head: &str, of: impl Fn(&'r R) -> N) -> ResultColumn {
        ResultColumn::new(key, head, Cells::Numbers(self.cells(|row| of(row).into())))
    }

    /// Words.
    pub fn text<N: Into<Option<String>>>(&self, key: &str, head: &str, of: impl Fn(&'r R) -> N) -> ResultColumn {
        ResultColumn::new(key, head, Cells::Text(self.cells(|row| of(row).into())))
    }

    /// Several words.
    pub fn texts(&self, key: &str, head: &str, of: impl Fn(&'r R) -> Vec<String>) -> ResultColumn {
        ResultColumn::new(key, head, Cells::Texts(self.cells(of)))
    }

    /// Whether it is so.
    pub fn flag<N: Into<Option<bool>>>(&self, key: &str, head: &str, of: impl Fn(&'r R) -> N) -> ResultColumn {
        ResultColumn::new(key, head, Cells::Flag(self.cells(|row| of(row).into())))
    }

    /// The table of these columns.
    #[must_use]
    pub fn build(&self, columns: Vec<ResultColumn>) -> ResultTable {
        let (key, caption) = (self.key.clone(), self.caption.clone());
        ResultTable {
            key,
            caption,
            columns,
            n_rows: self.rows.len(),
            are_facts: self.are_facts,
            ..ResultTable::default()
        }
    }
}

impl ResultColumn {
    fn new(key: &str, head: &str, cells: Cells) -> Self {
        let (head, unit) = named(head);
        Self { key: key.to_owned(), head: head.to_owned(), unit, cells, standard: None, digits: Digits::Significant(4) }
    }

    /// Its numbers have that many significant digits.
    #[must_use]
    pub fn significant(self, digits: u8) -> Self {
        Self { digits: Digits::Significant(digits), ..self }
    }

    /// Its numbers are written as a person would type them, with at most that many significant digits.
    #[must_use]
    pub fn plain(self, digits: u8) -> Self {
        Self { digits: Digits::Plain(digits), ..self }
    }

    /// Its numbers have that many decimal places.
    #[must_use]
    pub fn places(self, places: u8) -> Self {
        Self { digits: Digits::Places(places), ..self }
    }

    /// Its numbers are parts of a whole.
    #[must_use]
    pub fn percent(self) -> Self {
        Self { digits: Digits::Percent, ..self }
    }

    /// Its pairs are the least and the largest of something, and not an interval of uncertainty.
    #[must_use]
    pub fn range(self) -> Self {
        Self { digits: Digits::Range, ..self }
    }

    /// Its numbers are times, s.
    #[must_use]
    pub fn duration(self) -> Self {
        Self { digits: Digits::Duration, ..self }
    }

    /// Its numbers are sizes on a disk, bytes.
    #[must_use]
    pub fn bytes(self) -> Self {
        Self { digits: Digits::Bytes, ..self }
    }

    /// Its numbers are normalised differences.
    #[must_use]
    pub fn normalised(self) -> Self {
        Self { digits: Digits::Normalised, ..self }
    }

    /// Its texts are names of coefficients, loads or channels.
    #[must_use]
    pub fn symbol(self) -> Self {
        Self { digits: Digits::Symbol, ..self }
    }

    /// Its numbers are probabilities.
    #[must_use]
    pub fn p_value(self) -> Self {
        Self { digits: Digits::PValue, ..self }
    }
}

/// `speed [kn]`: the name, and the unit in brackets at its end. Brackets that hold no unit are part of the name.
fn named(head: &str) -> (&str, Option<Unit>) {
    let of = |rest: &'_ str| -> Option<(usize, Unit)> {
        let (name, unit) = rest.rsplit_once('[')?;
        Some((name.len(), parse_unit(unit).ok()?))
    };
    match head.strip_suffix(']').and_then(of) {
        Some((end, unit)) => (head[..end].trim_end(), Some(unit)),
        None => (head, None),
    }
}
