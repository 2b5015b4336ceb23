//! Lines as cells, as forgiving as a look at a file has to be.

use std::borrow::Cow;

/// What stands between cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// A tab.
    Tab,
    /// `|`
    Bar,
    /// Blanks, any number of them.
    Blanks,
}

impl Separator {
    /// Each of them.
    pub const ALL: [Self; 5] = [Self::Tab, Self::Semicolon, Self::Bar, Self::Comma, Self::Blanks];

    /// The byte that ends a cell; a blank for blanks.
    #[must_use]
    pub const fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
            Self::Bar => b'|',
            Self::Blanks => b' ',
        }
    }

    /// As it is declared.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Comma => ",",
            Self::Semicolon => ";",
            Self::Tab => "tab",
            Self::Bar => "|",
            Self::Blanks => "blanks",
        }
    }

    /// In a sentence: cells separated by …
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Comma => "commas",
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Bar => "bars",
            Self::Blanks => "blanks",
        }
    }
}

/// A row of a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Row<'t> {
    /// The line on which it begins, or its row in a sheet; from 1.
    pub line: usize,
    /// The line on which it ends.
    pub last_line: usize,
    /// Its cells, without blanks around them.
    pub cells: Vec<Cow<'t, str>>,
    /// Whether its line begins with `#` or `%`; the cells are without that mark.
    pub is_comment: bool,
}

impl Row<'_> {
    /// Whether all its cells are empty.
    #[must_use]
    pub fn is_blank(&self) -> bool {
        self.cells.iter().all(|cell| cell.is_empty())
    }
}

/// The mark of a comment at the beginning of a line, cut off; `None` where there is none. A cell that is `#` or `%` alone heads a column.
#[must_use]
pub fn comment(line: &str, separator: Separator) -> Option<&str> {
    let line = line.trim_start();
    let text = line.strip_prefix('#').or_else(|| line.strip_prefix('%'))?;
    let alone =
        separator != Separator::Blanks && text.trim_start_matches(' ').as_bytes().first() == Some(&separator.byte());
    (!alone).then(|| text.trim_start_matches(['#', '%']))
}

/// The rows of a text that begins on line 1, without its blank lines.
#[must_use]
pub fn rows(text: &str, separator: Separator) -> Vec<Row<'_>> {
    let mut rows = Vec::new();
    let (mut rest, mut line) = (text, 1);
    while !rest.is_empty() {
        let marked = comment(rest.split(['\n', '\r']).next().unwrap_or_default(), separator);
        let start =
            marked.map_or(rest, |text| &rest[rest.len().min(text.as_ptr() as usize - rest.as_ptr() as usize)..]);
        let (cells, after) = row(start, separator);
        let taken = &rest[..rest.len() - after.len()];
        let breaks = taken.bytes().filter(|b| *b == b'\n').count();
        let last_line = line + breaks.saturating_sub(1);
        let found = Row { line, last_line, cells, is_comment: marked.is_some() };
        // Cells that are empty between quotes are meant.
        if !found.is_blank() || start.starts_with('"') {
            rows.push(found);
        }
        line += breaks;
        rest = after;
    }
    rows
}

/// The cells of the first row, and what follows on it.
fn row(text: &str, separator: Separator) -> (Vec<Cow<'_, str>>, &str) {
    let mut cells = Vec::new();
    let mut rest = text;
    loop {
        if separator == Separator::Blanks {
            rest = rest.trim_start_matches([' ', '\t']);
            if !cells.is_empty() && (rest.is_empty() || rest.starts_with(['\n', '\r'])) {
                return (cells, after_line(rest));
            }
        }
        let (cell, after) = cell(rest, separator);
        cells.push(cell);
        match after.bytes().next() {
            Some(b'\n' | b'\r') | None => return (cells, after_line(after)),
            Some(_) => rest = &after[1..],
        }
    }
}

fn after_line(rest: &str) -> &str {
    rest.strip_prefix("\r\n").or_else(|| rest.strip_prefix(['\n', '\r'])).unwrap_or(rest)
}

/// The first cell, and what follows on it from its separator on.
fn cell(text: &str, separator: Separator) -> (Cow<'_, str>, &str) {
    let is_end =
        |b: u8| b == separator.byte() || matches!(b, b'\n' | b'\r') || (separator == Separator::Blanks && b == b'\t');
    let end_of = |text: &str| text.bytes().position(is_end).unwrap_or(text.len());
    if let Some(quoted) = text.strip_prefix('"') {
        let mut at = 0;
        while let Some(step) = quoted[at..].find('"') {
            at += step + 1;
            if !quoted[at..].starts_with('"') {
                let after = &quoted[at..];
                let after = &after[end_of(after)..];
                return (Cow::Owned(quoted[..at - 1].replace("\"\"", "\"").trim().to_owned()), after);
            }
            at += 1;
        }
    }
    let (cell, after) = text.split_at(end_of(text));
    (Cow::Borrowed(cell.trim()), after)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(text: &str, separator: Separator) -> Vec<(usize, Vec<String>, bool)> {
        rows(text, separator)
            .into_iter()
            .map(|row| (row.line, row.cells.iter().map(ToString::to_string).collect(), row.is_comment))
            .collect()
    }

    fn owned(cells: &[&str]) -> Vec<String> {
        cells.iter().map(|cell| (*cell).to_owned()).collect()
    }

    #[test]
    fn rows_keep_the_line_on_which_they_begin() {
        assert_eq!(
            split("a;\"b;\nc\"\r\n\r\n# note\n1; 2 \n", Separator::Semicolon),
            [(1, owned(&["a", "b;\nc"]), false), (4, owned(&["note"]), true), (5, owned(&["1", "2"]), false)]
        );
        assert_eq!(
            split("  1.0   2\t3  \n4 5 6", Separator::Blanks),
            [(1, owned(&["1.0", "2", "3"]), false), (2, owned(&["4", "5", "6"]), false)]
        );
        assert_eq!(
            split("#,U\n1,2\n", Separator::Comma),
            [(1, owned(&["#", "U"]), false), (2, owned(&["1", "2"]), false)]
        );
        assert_eq!(split("a\t\t\"x\"\"y\" z\n", Separator::Tab), [(1, owned(&["a", "", "x\"y"]), false)]);
        assert_eq!(
            split("\"open;\n1;2", Separator::Semicolon),
            [(1, owned(&["\"open", ""]), false), (2, owned(&["1", "2"]), false)]
        );
    }
}
