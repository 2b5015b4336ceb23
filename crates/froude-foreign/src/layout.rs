//! Where in a table titles, names, units and numbers stand.

use std::borrow::Cow;
use std::collections::BTreeMap;

use crate::marks::{Evidence, Marks, Undecided, shape};
use crate::split::{Row, Separator, rows};

/// What a column is called, and in what its numbers are.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Head {
    /// As it stands above the column.
    pub name: String,
    /// What stands above that: a longer name over a symbol.
    pub above: String,
    /// What the row of units says; none where there is no such row.
    pub unit: Option<String>,
}

/// A line that is no part of the table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// Its number.
    pub number: usize,
    /// Its cells.
    pub cells: Vec<String>,
}

impl Line {
    fn of(row: &Row<'_>) -> Self {
        Self { number: row.line, cells: row.cells.iter().map(ToString::to_string).collect() }
    }
}

/// What a look at a table found.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Layout {
    /// Its columns; empty where nothing names them.
    pub heads: Vec<Head>,
    /// The line of the names, 0 for none.
    pub names_line: usize,
    /// The line of the units.
    pub units_line: Option<usize>,
    /// The line above which nothing is data.
    pub data_line: usize,
    /// Lines above the names that are none of these.
    pub titles: Vec<Line>,
    /// Lines below the units and above the numbers.
    pub below: Vec<Line>,
    /// Which columns hold numbers.
    pub is_number: Vec<bool>,
}

/// A table of text as it seems to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Seen {
    /// What stands between cells.
    pub separator: Separator,
    /// Its parts.
    pub layout: Layout,
    /// How its numbers are written, or what nobody can decide.
    pub marks: Result<Marks, Undecided>,
    /// Whether a number that can be read in two ways is still to be asked about, as nothing that was looked at says which mark is which.
    pub is_open: bool,
}

/// What somebody states about a table of text.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Stated {
    /// What stands between cells.
    pub separator: Option<Separator>,
    /// The decimal mark.
    pub decimal: Option<char>,
    /// The mark of thousands.
    pub thousands: Option<char>,
    /// The line of the names.
    pub names_line: Option<usize>,
    /// The line of the units; 0 for none.
    pub units_line: Option<usize>,
}

impl Stated {
    /// The marks that are stated, or those that the cells show.
    ///
    /// # Errors
    ///
    /// What nobody can decide but a person.
    pub fn marks(&self, evidence: &Evidence, is_comma_separated: bool) -> Result<Marks, Undecided> {
        match (self.decimal, self.thousands) {
            (None, None) => evidence.marks(is_comma_separated),
            (decimal, thousands) => {
                let decimal = decimal.unwrap_or(if thousands == Some('.') { ',' } else { '.' });
                Ok(Marks { decimal, thousands })
            }
        }
    }
}

/// Words in the place of a number that was not measured.
const MISSING: [&str; 14] =
    ["", "-", "--", "–", "nan", "na", "n/a", "#n/a", "#nv", "n.a.", "null", "none", "-nan(ind)", "1.#qnan"];

/// Whether a cell says that there is no number.
#[must_use]
pub fn is_missing(cell: &str) -> bool {
    MISSING.contains(&cell.to_lowercase().as_str())
}

/// Most rows of names and units.
const MOST_HEADS: usize = 4;

/// Looks at the beginning of a table.
#[must_use]
pub fn look(sample: &str, stated: &Stated, is_unit: &dyn Fn(&str) -> bool) -> Seen {
    let candidates: Vec<Separator> = stated.separator.map_or_else(|| Separator::ALL.to_vec(), |one| vec![one]);
    let mut best: Option<(f64, Separator, Vec<Row<'_>>)> = None;
    for separator in candidates {
        let rows = rows(sample, separator);
        let score = score(&rows);
        if best.as_ref().is_none_or(|(known, ..)| score > *known) {
            best = Some((score, separator, rows));
        }
    }
    let (separator, rows) = match best {
        Some((score, separator, rows)) if score > 0.0 || stated.separator.is_some() => (separator, rows),
        _ => (Separator::Comma, rows(sample, Separator::Comma)),
    };
    let layout = layout(&rows, stated, is_unit);
    let evidence = evidence(&rows, &layout);
    let marks = stated.marks(&evidence, separator == Separator::Comma);
    let is_open = stated.decimal.is_none() && stated.thousands.is_none() && !evidence.is_settled();
    Seen { separator, layout, marks, is_open }
}

/// How well rows fall into columns of numbers: their number times the part of their cells that are numbers; 0 for fewer than two columns.
fn score(rows: &[Row<'_>]) -> f64 {
    let (n, _) = width(rows);
    if n < 2 {
        return 0.0;
    }
    let fitting = rows.iter().filter(|row| !row.is_comment && row.cells.len() == n && numbers(row) > 0);
    let (count, part) = fitting.fold((0.0, 0.0), |(count, part), row| {
        let filled = row.cells.iter().filter(|cell| !is_missing(cell)).count().max(1);
        (count + 1.0, part + numbers(row) as f64 / filled as f64)
    });
    if count == 0.0 { 0.0 } else { count * (part / count).powi(2) }
}

fn numbers(row: &Row<'_>) -> usize {
    row.cells.iter().filter(|cell| shape(cell).is_some()).count()
}

/// The usual number of cells of rows with numbers, or of all rows where none has any, and how many rows have it.
fn width(rows: &[Row<'_>]) -> (usize, usize) {
    let mut counts = BTreeMap::new();
    let has_numbers = rows.iter().any(|row| !row.is_comment && numbers(row) > 0);
    for row in rows.iter().filter(|row| !row.is_comment && (numbers(row) > 0 || !has_numbers)) {
        *counts.entry(row.cells.len()).or_insert(0_usize) += 1;
    }
    counts.into_iter().max_by_key(|(n, count)| (*count, *n)).unwrap_or((0, 0))
}

/// Where titles, names, units and numbers of some rows stand.
#[must_use]
pub fn layout(rows: &[Row<'_>], stated: &Stated, is_unit: &dyn Fn(&str) -> bool) -> Layout {
    let (n, _) = width(rows);
    let rows: Vec<Row<'_>> = rows.iter().map(|row| with_units(row, n)).collect();
    let rows = rows.as_slice();
    let data: Vec<&Row<'_>> = rows.iter().filter(|row| !row.is_comment).collect();
    let is_number = number_columns(&data, n);
    let is_data = |row: &Row<'_>| {
        row.cells.len() == n
            && numbers(row) > 0
            && (0..n).all(|j| !is_number[j] || is_missing(holds(row, j)) || shape(holds(row, j)).is_some())
    };
    let is_units = |row: &Row<'_>| {
        let cells =
            row.cells.iter().map(|cell| bare(cell)).filter(|cell| !matches!(*cell, "" | "-" | "--" | "1" | "–"));
        // One among them may be a date's form, or a unit that is not known: that is said of its column.
        let (units, others) = cells.fold(
            (0, 0),
            |(units, others), cell| {
                if is_unit(cell) { (units + 1, others) } else { (units, others + 1) }
            },
        );
        units > 0 && units >= others && row.cells.len() >= n
    };
    // Spreadsheets add columns without a cell.
    let used = (0..n).filter(|j| data.iter().any(|row| row.cells.len() == n && !row.cells[*j].is_empty())).count();
    let is_head = |row: &Row<'_>| {
        row.cells.len() >= n
            && row.cells.len() <= n.max(1) + trailing(row)
            && filled(row) * 2 > used
            && (is_units(row) || (0..n).all(|j| !is_number[j] || shape(holds(row, j)).is_none()))
    };
    let mut units_at = None;
    let (first, last) = if let Some(line) = stated.names_line {
        let at = data.iter().position(|row| row.line >= line).unwrap_or(data.len());
        units_at = match stated.units_line {
            Some(0) => None,
            Some(line) => data.iter().position(|row| row.line == line),
            None => data.get(at + 1).filter(|row| is_units(row)).map(|_| at + 1),
        };
        (at, units_at.unwrap_or(at).max(at))
    } else {
        let begin = data.iter().position(|row| is_data(row)).unwrap_or(data.len());
        // A table of text alone begins with its names.
        let found = if begin == data.len() {
            data.iter().position(|row| row.cells.len() == n)
        } else {
            data[..begin].iter().rposition(|row| is_head(row))
        };
        let Some(last) = found else { return headless(rows, &data, is_number, n, is_unit) };
        let adjoins = |at: &usize| data[*at].last_line + 1 == data[at + 1].line && is_head(data[*at]);
        let above = (0..last).rev().take_while(adjoins).count().min(MOST_HEADS - 1);
        let first = last - above;
        if last > first && stated.units_line != Some(0) {
            units_at = (first + 1..=last).rev().chain([first]).find(|at| is_units(data[*at]));
        }
        // Below the units, loggers say how a number was made: `Avg`, `Smp`.
        let says_how = |row: &&&Row<'_>| {
            let words = || row.cells.iter().filter(|cell| !cell.is_empty());
            let has_digit = words().any(|cell| cell.contains(|c: char| c.is_ascii_digit()));
            row.cells.len() == n
                && words().count() > 0
                && !has_digit
                && (0..n).any(|j| is_number[j] && !is_missing(holds(row, j)))
        };
        let below = if units_at.is_some() && units_at < Some(last + 1) {
            data[last + 1..].iter().take_while(says_how).count()
        } else {
            0
        };
        (first, last + below)
    };
    let Some(end) = data.get(last) else { return Layout::default() };
    // Above the units, or below where nothing is above.
    let names_end = units_at.filter(|at| *at > first).unwrap_or(last + 1);
    let names: Vec<&Row<'_>> =
        (first..names_end).filter(|at| Some(*at) != units_at).filter_map(|at| data.get(at).copied()).collect();
    let below = units_at.filter(|at| *at > first).and_then(|at| data.get(at + 1..=last)).unwrap_or_default();
    let units = units_at.and_then(|at| data.get(at));
    let Some(lowest) = names.last() else { return Layout::default() };
    let width = lowest.cells.len().max(n);
    let heads = (0..width).map(|j| Head { unit: units.map(|row| bare(holds(row, j)).to_owned()), ..head(&names, j) });
    Layout {
        heads: heads.collect(),
        names_line: lowest.line,
        units_line: units.map(|row| row.line),
        // A comment below the names is looked at with the rows.
        data_line: end.last_line + 1,
        titles: data[..first.min(data.len())].iter().map(|row| Line::of(row)).collect(),
        below: below.iter().map(|row| Line::of(row)).collect(),
        is_number,
    }
}

/// A row of names between blanks, with each unit beside its name where that gives the number of columns: `speed [m/s] f_x [N]`.
fn with_units<'r>(row: &Row<'r>, n: usize) -> Row<'r> {
    let is_unit = |cell: &str| {
        [('[', ']'), ('(', ')')].iter().any(|(open, close)| cell.starts_with(*open) && cell.ends_with(*close))
    };
    if row.cells.len() <= n || !row.cells.iter().skip(1).any(|cell| is_unit(cell)) {
        return row.clone();
    }
    let mut cells: Vec<Cow<'r, str>> = Vec::new();
    for cell in &row.cells {
        match cells.last_mut() {
            Some(name) if is_unit(cell) => *name = Cow::Owned(format!("{name} {cell}")),
            _ => cells.push(cell.clone()),
        }
    }
    if cells.len() == n { Row { cells, ..row.clone() } } else { row.clone() }
}

/// A cell of a row; empty where the row is shorter.
fn holds<'r>(row: &'r Row<'_>, column: usize) -> &'r str {
    row.cells.get(column).map_or("", Cow::as_ref)
}

/// A table of which only a comment, or nothing, names the columns.
fn headless(
    rows: &[Row<'_>],
    data: &[&Row<'_>],
    is_number: Vec<bool>,
    n: usize,
    is_unit: &dyn Fn(&str) -> bool,
) -> Layout {
    let Some(first) = data.first() else { return Layout::default() };
    let comments: Vec<&Row<'_>> = rows
        .iter()
        .take_while(|row| row.line < first.line)
        .filter(|row| row.is_comment && row.cells.len() == n)
        .collect();
    let no_names = Layout { data_line: first.line, is_number: is_number.clone(), ..Layout::default() };
    let [.., last] = comments.as_slice() else { return no_names };
    if n < 2 || numbers(last) > 0 {
        return no_names;
    }
    let is_units = last.cells.iter().all(|cell| matches!(bare(cell), "" | "-" | "1") || is_unit(bare(cell)));
    let (names, units) = match comments.as_slice() {
        [.., names, units] if is_units => (*names, Some(*units)),
        _ => (*last, None),
    };
    let cell = |row: &Row<'_>, j: usize| row.cells.get(j).map_or_else(String::new, ToString::to_string);
    let heads = (0..n).map(|j| Head {
        name: cell(names, j),
        above: String::new(),
        unit: units.map(|row| bare(&cell(row, j)).to_owned()),
    });
    Layout {
        heads: heads.collect(),
        names_line: names.line,
        units_line: units.map(|row| row.line),
        data_line: first.line,
        titles: Vec::new(),
        below: Vec::new(),
        is_number,
    }
}

/// Columns of which at least half of the later cells are numbers.
fn number_columns(data: &[&Row<'_>], n: usize) -> Vec<bool> {
    let fitting: Vec<&&Row<'_>> = data.iter().filter(|row| row.cells.len() == n).collect();
    let later = &fitting[fitting.len() / 2..];
    (0..n)
        .map(|j| {
            let filled = later.iter().filter(|row| !is_missing(&row.cells[j]));
            let (all, numbers) =
                filled.fold((0, 0), |(all, found), row| (all + 1, found + usize::from(shape(&row.cells[j]).is_some())));
            numbers > 0 && 2 * numbers >= all
        })
        .collect()
}

/// A unit without the brackets that people set around it.
#[must_use]
pub fn bare(cell: &str) -> &str {
    let cell = cell.trim();
    let inner = |open, close| cell.strip_prefix(open).and_then(|rest: &str| rest.strip_suffix(close));
    inner('[', ']').or_else(|| inner('(', ')')).or_else(|| inner('<', '>')).map_or(cell, str::trim)
}

fn filled(row: &Row<'_>) -> usize {
    row.cells.iter().filter(|cell| !cell.is_empty()).count()
}

/// Empty cells at the end of a row.
fn trailing(row: &Row<'_>) -> usize {
    row.cells.iter().rev().take_while(|cell| cell.is_empty()).count()
}

/// The name of a column out of the rows above it: the lowest, with what spans it where that alone is empty or there twice.
fn head(names: &[&Row<'_>], j: usize) -> Head {
    let cell = |row: &Row<'_>, j: usize| row.cells.get(j).map(|cell| one_line(cell)).unwrap_or_default();
    let Some((lowest, upper)) = names.split_last() else { return Head::default() };
    // A head over several columns stands above the first of them.
    let spanning = upper
        .iter()
        .rev()
        .map(|row| (0..=j).rev().map(|k| cell(row, k)).find(|text| !text.is_empty()).unwrap_or_default());
    let above =
        spanning.filter(|text| !text.is_empty()).collect::<Vec<_>>().into_iter().rev().collect::<Vec<_>>().join(" ");
    let name = cell(lowest, j);
    let is_twice = (0..lowest.cells.len()).any(|k| k != j && cell(lowest, k) == name);
    let name = match (name.is_empty(), is_twice, above.is_empty()) {
        (true, _, false) => above.clone(),
        (false, true, false) => format!("{above} {name}"),
        _ => name,
    };
    Head { name, above, unit: None }
}

/// Headers of spreadsheets have line breaks.
fn one_line(cell: &str) -> String {
    cell.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What the numbers of a layout say about their marks.
fn evidence(rows: &[Row<'_>], layout: &Layout) -> Evidence {
    let mut evidence = Evidence::default();
    for j in (0..layout.is_number.len()).filter(|j| layout.is_number[*j]) {
        let below = rows.iter().filter(|row| !row.is_comment && row.line >= layout.data_line);
        evidence.column(below.filter_map(|row| Some((row.cells.get(j).map(Cow::as_ref)?, row.line))));
    }
    evidence
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(text: &str) -> Seen {
        look(text, &Stated::default(), &|unit| {
            matches!(unit, "m/s" | "N" | "gf" | "s" | "m" | "deg" | "°" | "N m" | "mm")
        })
    }

    fn names(seen: &Seen) -> Vec<&str> {
        seen.layout.heads.iter().map(|head| head.name.as_str()).collect()
    }

    #[test]
    fn separators_are_told_by_the_numbers_between_them() {
        let of = |text: &str| seen(text).separator;
        assert_eq!(of("a,b\n1,2\n3,4\n"), Separator::Comma);
        assert_eq!(of("a;b\n1,5;2,5\n0,5;4\n"), Separator::Semicolon);
        assert_eq!(of("a\tb\n1,5\t2,5\n"), Separator::Tab);
        assert_eq!(of("a b\n1,5 2,5\n1 4\n"), Separator::Blanks);
        assert_eq!(of("  Time   Fx\n  (s)   (N)\n  0.0   1.0\n  0.1   2.0\n"), Separator::Blanks);
        assert_eq!(of("a, b\n1.0, 2.0\n"), Separator::Comma);
        assert_eq!(of("date;a,b;c\n2026-01-02 10:00:00;1,5;2\n2026-01-02 10:00:01;1,5;2\n"), Separator::Semicolon);
        assert_eq!(of("speed\n1\n2\n"), Separator::Comma);
        assert_eq!(of("a|b\n1|2\n"), Separator::Bar);
    }

    #[test]
    fn titles_names_symbols_and_units_are_told_apart() {
        let found = seen(
            "Drift tests;;\nModel;KVLCC2;\n\nGeschwindigkeit;Kraft;Winkel\nU;F;beta\nm/s;N;°\n0,5;1,5;-12\n0,75;2,5;0\n",
        );
        assert_eq!(names(&found), ["U", "F", "beta"]);
        assert_eq!(found.layout.heads[0].above, "Geschwindigkeit");
        assert_eq!(found.layout.heads[0].unit.as_deref(), Some("m/s"));
        assert_eq!((found.layout.names_line, found.layout.units_line, found.layout.data_line), (5, Some(6), 7));
        assert_eq!(found.marks, Ok(Marks { decimal: ',', thousands: None }));
        let plain = seen("speed [m/s],f_x [N],run\n1,-2,a\n2,-4,b\n");
        assert_eq!((plain.layout.names_line, plain.layout.units_line, plain.layout.data_line), (1, None, 2));
        assert_eq!(plain.layout.is_number, [true, true, false]);
    }

    #[test]
    fn heads_over_several_columns_make_names_whole() {
        let found = seen("Force;;Speed\nx;y;x\nN;N;m/s\n1;2;3\n4;5;6\n");
        assert_eq!(names(&found), ["Force x", "y", "Speed x"]);
        let found = seen("t;Load;\n;x;y\n0;1;2\n1;4;5\n");
        assert_eq!(names(&found), ["t", "x", "y"]);
    }

    #[test]
    fn a_comment_above_the_numbers_may_name_them() {
        let found = seen("# tank, June\n# t x\n0.0 1.0\n0.1 2.0\n");
        assert_eq!(names(&found), ["t", "x"]);
        let found = seen("% t, x\n% s, m\n0.0,1.0\n0.1,2.0\n");
        assert_eq!((names(&found), found.layout.heads[1].unit.as_deref()), (vec!["t", "x"], Some("m")));
        let found = seen("# run 7, June\n# speed [m/s] f_x [N]\n4.0e-01 -1.62e+00\n6.0e-01 -3.71e+00\n");
        assert_eq!(names(&found), ["speed [m/s]", "f_x [N]"]);
        assert!(seen("0.0,1.0\n0.1,2.0\n").layout.heads.is_empty());
    }

    #[test]
    fn a_bad_row_below_the_names_is_data_and_not_a_second_head() {
        let found = seen("U,F\n1,x\n2,3\n4,5\n6,7\n");
        assert_eq!((names(&found), found.layout.data_line), (vec!["U", "F"], 2));
        let found = seen("Run;12\nU;F\n1;2\n2;3\n");
        assert_eq!((names(&found), found.layout.data_line, found.layout.titles.len()), (vec!["U", "F"], 3, 1));
    }
}
