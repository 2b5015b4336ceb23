//! Decimal and thousands marks: 0,5 and 1.234,5, 1 234.5 and 1'234.
//!
//! A number such as `1,234` can be read in two ways. What settles it is the rest of the file, as in `0,5` or `1.234,5`; where nothing does,
//! nobody guesses.

use std::borrow::Cow;

/// How numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Marks {
    /// Between whole and fraction: `.` or `,`.
    pub decimal: char,
    /// Between thousands: `.`, `,`, a blank (of any kind) or an apostrophe.
    pub thousands: Option<char>,
}

impl Default for Marks {
    fn default() -> Self {
        Self { decimal: '.', thousands: None }
    }
}

/// What the shape of a number says about its marks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// No marks.
    Whole,
    /// This decimal mark, and this mark of thousands if any, for certain.
    Certain(Option<char>, Option<char>),
    /// One mark before three digits: either.
    Either(char),
}

/// One mark for all that mean the same.
fn plain(c: char) -> Option<char> {
    match c {
        '.' | ',' => Some(c),
        ' ' | '\u{a0}' | '\u{202f}' | '\u{2009}' => Some(' '),
        '\'' | '’' => Some('\''),
        _ => None,
    }
}

/// The number without sign and exponent; `None` where what is left cannot be one.
fn body(cell: &str) -> Option<&str> {
    let cell = cell.trim();
    let unsigned = cell.strip_prefix(['+', '-', '−']).unwrap_or(cell);
    let end = unsigned.find(['e', 'E', 'd', 'D']).unwrap_or(unsigned.len());
    let (body, exponent) = unsigned.split_at(end);
    let digits = exponent.get(1..).unwrap_or_default();
    let digits = digits.strip_prefix(['+', '-']).unwrap_or(digits);
    let is_whole = exponent.is_empty() || (!digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()));
    (is_whole && body.bytes().any(|b| b.is_ascii_digit())).then_some(body)
}

/// Whether a cell has digits, a sign before them and at most one comma among them: what nearly all with a decimal comma have.
fn is_simple(cell: &str) -> bool {
    let digits = cell.strip_prefix(['+', '-']).unwrap_or(cell).as_bytes();
    let mut parts = digits.split(|b| *b == b',');
    let are_digits = |part: &[u8]| part.iter().all(u8::is_ascii_digit);
    let [whole, part] = [parts.next(), parts.next()].map(Option::unwrap_or_default);
    parts.next().is_none() && are_digits(whole) && are_digits(part) && !(whole.is_empty() && part.is_empty())
}

/// What a cell says about the marks; `None` where it is no number under any.
#[must_use]
pub fn shape(cell: &str) -> Option<Shape> {
    let text = body(cell)?;
    let mut marks: Vec<char> = Vec::new();
    let mut groups = vec![0_usize];
    for c in text.chars() {
        if c.is_ascii_digit() {
            *groups.last_mut()? += 1;
        } else {
            marks.push(plain(c)?);
            groups.push(0);
        }
    }
    let has_exponent = text.len() < cell.trim().trim_start_matches(['+', '-', '−']).len();
    let is_grouped = |groups: &[usize]| (1..=3).contains(&groups[0]) && groups[1..].iter().all(|g| *g == 3);
    let [first, .., last] = marks.as_slice() else {
        return match (marks.first(), groups.as_slice()) {
            (None, _) => Some(Shape::Whole),
            (Some(mark @ ('.' | ',')), [whole, 3])
                if (1..=3).contains(whole) && !text.starts_with('0') && !has_exponent =>
            {
                Some(Shape::Either(*mark))
            }
            (Some(mark @ ('.' | ',')), [whole, part]) if whole + part > 0 => Some(Shape::Certain(Some(*mark), None)),
            (Some(mark), groups) if is_grouped(groups) && !has_exponent => Some(Shape::Certain(None, Some(*mark))),
            _ => None,
        };
    };
    let whole = &marks[..marks.len() - 1];
    if whole.iter().any(|mark| mark != first) {
        return None;
    }
    if first == last {
        return (is_grouped(&groups) && !has_exponent).then_some(Shape::Certain(None, Some(*first)));
    }
    (matches!(last, '.' | ',') && is_grouped(&groups[..marks.len()]))
        .then_some(Shape::Certain(Some(*last), Some(*first)))
}

impl Marks {
    /// The number as every program reads it, `-1234.5e3`; `None` where these marks do not make it one.
    #[must_use]
    pub fn plain<'c>(&self, cell: &'c str) -> Option<Cow<'c, str>> {
        let cell = cell.trim();
        if self.decimal == ',' && is_simple(cell) {
            return Some(Cow::Owned(cell.replacen(',', ".", 1)));
        }
        let fits = match shape(cell)? {
            Shape::Whole => true,
            Shape::Either(mark) => mark == self.decimal || Some(mark) == self.thousands,
            Shape::Certain(decimal, thousands) => {
                decimal.is_none_or(|mark| mark == self.decimal) && (thousands.is_none() || thousands == self.thousands)
            }
        };
        if !fits {
            return None;
        }
        if self.decimal == '.'
            && cell.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+' | b'e' | b'E'))
            && self.thousands != Some('.')
        {
            return Some(Cow::Borrowed(cell));
        }
        let write = |c: char| match plain(c) {
            Some(mark) if mark == self.decimal => Some('.'),
            Some(_) => None,
            None if c == '−' => Some('-'),
            None if matches!(c, 'd' | 'D') => Some('e'),
            None => Some(c),
        };
        Some(Cow::Owned(cell.chars().filter_map(write).collect()))
    }
}

/// A cell that says something about the marks, and where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Witness {
    /// As written.
    pub cell: String,
    /// Its line.
    pub line: usize,
}

/// What the cells of a file say together.
#[derive(Debug, Clone, Default)]
pub struct Evidence {
    point: Option<Witness>,
    comma: Option<Witness>,
    thousands: Vec<(char, Witness)>,
    either_point: Option<Witness>,
    either_comma: Option<Witness>,
    /// One of `1.234` in a column that has whole numbers and no other fraction: 999, 1.000.
    among_whole: Option<Witness>,
}

/// What nobody can decide but a person.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Undecided {
    /// A cell that can be read in two ways.
    Either(Witness),
    /// Two cells with two decimal marks.
    Both(Witness, Witness),
    /// A cell that is a thousand only if the other, whose decimal mark is certain, is of the same hand.
    Mixed {
        /// The one that is certain.
        certain: Witness,
        /// The other.
        other: Witness,
    },
    /// Two marks of thousands.
    Thousands(Witness, Witness),
}

impl Evidence {
    /// Takes the cells of a column, with their lines.
    pub fn column<'c>(&mut self, cells: impl Iterator<Item = (&'c str, usize)>) {
        let (mut whole, mut either, mut is_certain) = (false, None, false);
        for (cell, line) in cells {
            let witness = || Some(Witness { cell: cell.trim().to_owned(), line });
            match shape(cell) {
                Some(Shape::Whole) => whole = true,
                Some(Shape::Either('.')) => {
                    either = either.or_else(witness);
                    self.either_point = self.either_point.take().or_else(witness);
                }
                Some(Shape::Either(_)) => self.either_comma = self.either_comma.take().or_else(witness),
                Some(Shape::Certain(decimal, thousands)) => {
                    match decimal {
                        Some('.') => {
                            is_certain = true;
                            self.point = self.point.take().or_else(witness);
                        }
                        Some(_) => self.comma = self.comma.take().or_else(witness),
                        None => {}
                    }
                    if let (Some(mark), Some(witness)) = (thousands, witness())
                        && self.thousands.iter().all(|(known, _)| *known != mark)
                    {
                        self.thousands.push((mark, witness));
                    }
                }
                None => {}
            }
        }
        if whole && !is_certain {
            self.among_whole = self.among_whole.take().or(either);
        }
    }

    /// Whether some cell says for certain which mark is the decimal one.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.point.is_some() || self.comma.is_some() || !self.thousands.is_empty()
    }

    /// The marks that all cells fit.
    ///
    /// # Errors
    ///
    /// The cells that contradict each other, or the one that nothing decides.
    pub fn marks(&self, is_comma_separated: bool) -> Result<Marks, Undecided> {
        let thousands = match self.thousands.as_slice() {
            [] => None,
            [(mark, _)] => Some(*mark),
            [(_, one), (_, other), ..] => return Err(Undecided::Thousands(one.clone(), other.clone())),
        };
        let decided = |decimal: char, certain: &Witness, doubtful: &Option<Witness>, other: char| match doubtful {
            Some(cell) if thousands != Some(other) => {
                Err(Undecided::Mixed { certain: certain.clone(), other: cell.clone() })
            }
            _ => Ok(Marks { decimal, thousands }),
        };
        let found = match (&self.point, &self.comma) {
            (Some(point), Some(comma)) => Err(Undecided::Both(point.clone(), comma.clone())),
            (None, Some(comma)) => decided(',', comma, &self.either_point, '.'),
            (Some(point), None) => decided('.', point, &self.either_comma, ','),
            // `1,234,567` and no fraction anywhere.
            (None, None) if thousands == Some('.') => Ok(Marks { decimal: ',', thousands }),
            (None, None) if thousands == Some(',') => Ok(Marks { decimal: '.', thousands }),
            (None, None) => {
                // A comma between cells goes with a point in numbers; behind other separators 1.250 may be 1250.
                let point = if is_comma_separated { &self.among_whole } else { &self.either_point };
                match self.either_comma.as_ref().or(point.as_ref()) {
                    Some(cell) => Err(Undecided::Either(cell.clone())),
                    None => Ok(Marks { decimal: '.', thousands }),
                }
            }
        }?;
        // A mark cannot be both.
        match self.thousands.iter().find(|(mark, _)| *mark == found.decimal) {
            Some((_, cell)) => {
                let decimal = if found.decimal == '.' { &self.point } else { &self.comma };
                let decimal = decimal.clone().unwrap_or_else(|| cell.clone());
                Err(Undecided::Both(decimal, cell.clone()))
            }
            None => Ok(found),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decide(cells: &[&str]) -> Result<Marks, Undecided> {
        let mut evidence = Evidence::default();
        evidence.column(cells.iter().copied().zip(1..));
        evidence.marks(true)
    }

    fn found(cells: &[&str]) -> (char, Option<char>) {
        let marks = decide(cells).unwrap();
        (marks.decimal, marks.thousands)
    }

    #[test]
    fn the_rest_of_the_file_settles_what_one_number_leaves_open() {
        assert_eq!(found(&["0.5", "1.234"]), ('.', None));
        assert_eq!(found(&["0,5", "12,25"]), (',', None));
        assert_eq!(found(&["1.234,5", "1.234", "0,5"]), (',', Some('.')));
        assert_eq!(found(&["1,234.5", "1,234"]), ('.', Some(',')));
        assert_eq!(found(&["1 234,5", "0,5"]), (',', Some(' ')));
        assert_eq!(found(&["1\u{202f}234,5", "12\u{a0}345"]), (',', Some(' ')));
        assert_eq!(found(&["1'234.5"]), ('.', Some('\'')));
        assert_eq!(found(&["1.234.567"]), (',', Some('.')));
        assert_eq!(found(&["1,234,567"]), ('.', Some(',')));
        assert_eq!(found(&["1.250", "2.500", "12.000"]), ('.', None));
        assert_eq!(found(&["1,5E+03", "-2"]), (',', None));
        assert_eq!(found(&["3", "4"]), ('.', None));
    }

    #[test]
    fn what_nothing_settles_is_asked() {
        let cell = |cells: &[&str]| match decide(cells).unwrap_err() {
            Undecided::Either(w) | Undecided::Mixed { other: w, .. } => w.cell,
            Undecided::Both(a, b) | Undecided::Thousands(a, b) => format!("{} {}", a.cell, b.cell),
        };
        assert_eq!(cell(&["1,234", "12"]), "1,234");
        assert_eq!(cell(&["0,5", "1.234"]), "1.234");
        assert_eq!(cell(&["0.5", "1,234"]), "1,234");
        // 800, 900, 1.000 rotations a minute are no 1.0.
        assert_eq!(cell(&["800", "900", "1.000"]), "1.000");
        // Behind semicolons 1.250 may be 1250.
        let mut evidence = Evidence::default();
        evidence.column(["1.250", "1.500"].into_iter().zip(1..));
        assert!(evidence.marks(false).is_err() && evidence.marks(true).is_ok() && !evidence.is_settled());
        assert_eq!(cell(&["0,5", "0.5"]), "0.5 0,5");
        assert_eq!(cell(&["1 234", "1'234"]), "1 234 1'234");
        assert_eq!(cell(&["1.234.567", "0.5"]), "0.5 1.234.567");
    }

    #[test]
    fn numbers_are_read_under_their_marks_alone() {
        let comma = Marks { decimal: ',', thousands: Some('.') };
        let plain = |cell: &'static str| comma.plain(cell).map(Cow::into_owned);
        assert_eq!(plain("-1.234,50").as_deref(), Some("-1234.50"));
        assert_eq!(plain("−0,5").as_deref(), Some("-0.5"));
        assert_eq!(plain("1,5D+03").as_deref(), Some("1.5e+03"));
        for no in ["1.5", "1,2,3", "a", "", "1..2", "12.34,5", "--1", "1e", ",", "0x1F", "1 234"] {
            assert_eq!(plain(no), None, "{no}");
        }
        let point = Marks::default();
        assert_eq!(point.plain(" .5e-3 ").as_deref(), Some(".5e-3"));
        assert_eq!(point.plain("1,234"), None);
        assert_eq!(point.plain("5."), Some(Cow::Borrowed("5.")));
    }
}
