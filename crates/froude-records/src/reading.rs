//! How a table of text was understood before its first row is read: encoding, separators, marks, names, units.

use std::path::Path;

use froude_foreign::decode::Decoded;
use froude_foreign::layout::{Head, Layout, Line, Seen, look};
use froude_foreign::marks::{Marks, Undecided, Witness, shape};

use crate::error::{Place, Position, RecordError};
use crate::file_words::{FileWords, sidecar_name};
use crate::foreign_names::meant;
use crate::guard::unguarded;
use crate::heading::{Heading, headings, rename_sname, split_header};
use crate::label_rows::{Odd, is_scale, is_statistic, label, odd};
use crate::question::{Answer, Question};
use crate::records::{Dialect, NextRow as _, Records, Skipped};
use crate::text::counted;
use crate::units::{Dimension, parse_unit};

/// As much of a file as is looked at.
const SAMPLE_BYTES: usize = 1 << 18;

/// A table of text as it was understood.
#[derive(Debug, Clone)]
pub(crate) struct Reading {
    /// How it is written.
    pub dialect: Dialect,
    /// Its columns.
    pub headings: Vec<Heading>,
    /// Which of them hold numbers.
    pub is_number: Vec<bool>,
    /// Where their names stand.
    pub place: Place,
    /// Bytes and lines before the first row.
    pub at: usize,
    /// The line of the first row.
    pub line: usize,
    /// What differs from a table of Froude's own, in words.
    pub words: Vec<String>,
    /// Numbers that nobody can decide but a person.
    pub undecided: Option<Undecided>,
    /// Whether one further down is to be asked about.
    pub is_open: bool,
}

impl Reading {
    /// Understands a text by its beginning; `decoded` says in which encoding it is.
    ///
    /// # Errors
    ///
    /// A file without names of columns, and one whose names and units contradict each other.
    pub fn of(path: &Path, decoded: &Decoded<'_>, file: &FileWords) -> Result<Self, RecordError> {
        let text = decoded.text.as_ref();
        if text.trim().is_empty() {
            let problem = "the file is empty; its first line names the columns as `name [unit]`";
            return Err(RecordError::syntax(Place::whole(path), problem));
        }
        if !text.contains('\n') && text.trim_end().contains('\r') {
            let problem = "a carriage return stands without a line feed; save the file with LF or CRLF line ends";
            return Err(RecordError::syntax(Place::in_table(path, 1), problem));
        }
        if file.stated == FileWords::default().stated && is_own(text) {
            return Self::own(path, decoded);
        }
        let seen = look(sample(text), &file.stated, &|unit| parse_unit(unit).is_ok());
        let reading = Self::seen(path, &seen, of_encoding(decoded).into_iter().collect(), file)?;
        let at = text.split_inclusive('\n').take(reading.line - 1).map(str::len).sum();
        Ok(Self { at, ..reading })
    }

    /// A table whose layout was looked at; `words` say how its cells were found.
    ///
    /// # Errors
    ///
    /// As [`Self::of`].
    pub fn seen(path: &Path, seen: &Seen, words: Vec<String>, file: &FileWords) -> Result<Self, RecordError> {
        let layout = &seen.layout;
        refuse_scales(path, layout, file)?;
        ask_for_symbols(path, layout, file)?;
        if layout.heads.is_empty() {
            let problem = "there are numbers where the columns should be named; write a line of headers above them, as `speed [m/s],f_x [N]`";
            return Err(RecordError::syntax(Place::in_table(path, layout.data_line.max(1)), problem));
        }
        let place = Place::in_table(path, layout.names_line);
        if let Some(problem) = named_numbers(&layout.heads) {
            return Err(RecordError::syntax(place, problem));
        }
        let mut headings = headings(&layout.heads, &layout.is_number)
            .map_err(|problem| RecordError::syntax(place.clone(), problem))?;
        // Columns without a name and without a cell, as spreadsheets add them.
        while headings.last().is_some_and(|last| last.written.is_empty()) {
            headings.pop();
        }
        let sname = rename_sname(&mut headings);
        let (marks, undecided) = match seen.marks.clone() {
            Ok(marks) => (marks, None),
            Err(undecided) => (Marks::default(), Some(undecided)),
        };
        let noun = if matches!(place.position, Position::Row(_)) { "row" } else { "line" };
        let words = told(words, seen, marks, &sname, noun);
        let dialect = Dialect { separator: seen.separator, marks };
        let is_number = layout.is_number.clone();
        Ok(Self {
            dialect,
            headings,
            is_number,
            place,
            at: 0,
            line: layout.data_line,
            words,
            undecided,
            is_open: seen.is_open,
        })
    }

    /// A table as Froude writes it: its first line are its headers.
    fn own(path: &Path, decoded: &Decoded<'_>) -> Result<Self, RecordError> {
        let text = decoded.text.as_ref();
        let dialect = Dialect::own();
        let mut records = Records::new(path, text, 1, dialect.separator);
        let mut cells = Vec::new();
        records.next(&mut cells)?;
        let heads: Vec<Head> =
            cells.iter().map(|cell| Head { name: unguarded(cell.trim()).to_owned(), ..Head::default() }).collect();
        let mut headings = headings(&heads, &vec![true; heads.len()])
            .map_err(|problem| RecordError::syntax(Place::line(path, 1), problem))?;
        let sname = rename_sname(&mut headings);
        let place = Place::line(path, 1);
        let words = of_encoding(decoded).into_iter().chain(renamed(&sname)).collect();
        let is_number = headings.iter().map(|heading| heading.unit.is_some()).collect();
        Ok(Self {
            dialect,
            headings,
            is_number,
            place,
            at: records.at,
            line: records.line,
            words,
            undecided: None,
            is_open: false,
        })
    }

    /// Whether its rows are those of Froude's own tables: numbers with a point between commas.
    pub fn is_plain(&self) -> bool {
        self.dialect == Dialect::own() && self.undecided.is_none()
    }

    /// What was understood, in one sentence; `None` where there is nothing to say.
    pub fn understood(&self, skipped: Skipped, left_out: usize) -> Option<String> {
        let mut words = self.words.clone();
        let counts = [
            (skipped.comments, "comment line passed over", "comment lines passed over"),
            (skipped.blank, "blank line passed over", "blank lines passed over"),
            (left_out, "row left out as declared", "rows left out as declared"),
        ];
        words.extend(counts.into_iter().filter(|(n, ..)| *n > 0).map(|(n, one, many)| counted(n, one, many)));
        (!words.is_empty()).then(|| words.join(", "))
    }
}

/// Whether the first line is one of headers between commas of which at least one is `name [unit]`.
fn is_own(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default();
    let has_unit = |cell: &str| {
        !cell.contains([';', '\t', '|'])
            && matches!(split_header(cell.trim().trim_matches('"')), Ok((_, Some(unit))) if parse_unit(unit).is_ok())
    };
    !first.trim_start().starts_with(['#', '%']) && first.split(',').any(has_unit)
}

/// The whole lines at the beginning of a text.
fn sample(text: &str) -> &str {
    if text.len() <= SAMPLE_BYTES {
        return text;
    }
    let end = memchr::memrchr(b'\n', &text.as_bytes()[..SAMPLE_BYTES]).map_or(text.len(), |end| end + 1);
    &text[..end]
}

/// The encoding, where it is not UTF-8.
fn of_encoding(decoded: &Decoded<'_>) -> Option<String> {
    let guess = if decoded.is_guess { " (by its letters)" } else { "" };
    (decoded.encoding != "UTF-8").then(|| format!("text in {}{guess}", decoded.encoding))
}

/// What loggers write below the units about how a number was made, in small letters.
const MADE_BY: [&str; 5] = ["avg", "smp", "sample", "average", "-"];

/// `speed:0.5` in the place of a name: a serial plotter's line, which names each number again.
fn named_numbers(heads: &[Head]) -> Option<String> {
    let is_named = |head: &Head| {
        let parts = head.name.split(['\t', ' ', ',']).filter(|part| !part.is_empty());
        parts.clone().count() > 0
            && parts.clone().all(|part| {
                part.split_once(':')
                    .is_some_and(|(name, number)| name.starts_with(char::is_alphabetic) && shape(number).is_some())
            })
    };
    let head = heads.first().filter(|_| heads.iter().all(is_named))?;
    Some(format!(
        "`{}` states a number with its name, and so does every other cell: write names and units once, in the first line (`speed [m/s],f_x [N]`), and only numbers below",
        head.name
    ))
}

fn joined(line: &Line) -> String {
    line.cells.join("; ").trim_end_matches("; ").to_owned()
}

/// Refuses what stands among names and units and may scale or shift the numbers, as nothing would apply it.
fn refuse_scales(path: &Path, layout: &Layout, file: &FileWords) -> Result<(), RecordError> {
    let is_open = |line: &&Line| {
        let is_known = |cell: &String| cell.is_empty() || MADE_BY.contains(&cell.to_lowercase().as_str());
        !line.cells.iter().all(is_known) && !file.leaves_out(label(&line.cells))
    };
    // `Faktor; 1; 1000` above the names; a sentence is a title.
    let is_scale_above = |line: &&Line| {
        odd(label(&line.cells)) == Some(Odd::Scale)
            && line.cells.iter().any(|cell| shape(cell).is_some())
            && !file.leaves_out(label(&line.cells))
    };
    let below = layout.below.iter().find(is_open).map(|line| (line, "between the units and the numbers"));
    let above = || layout.titles.iter().find(is_scale_above).map(|line| (line, "above the names"));
    if let Some((line, place)) = below.or_else(above) {
        let problem = format!(
            "`{}` stands {place}: if it scales, shifts or reverses the numbers, nothing applies it. Apply it by a unit or a sign in the sidecar, and skip the line with:\n  schema = 1\n  [file]\n  leave_out = [\"{}\"]",
            joined(line),
            label(&line.cells)
        );
        return Err(RecordError::syntax(Place::in_table(path, line.number), problem));
    }
    let of_statistic = |head: &&Head| is_statistic(&head.above) && !head.name.starts_with(&head.above);
    if let (Some(head), None) = (layout.heads.iter().find(of_statistic), file.stated.names_line) {
        let problem = format!(
            "`{}` stands above `{}`: if the numbers are statistics and not single readings, give the column a name that says so in the sidecar. Then state which line holds the names, in {}:\n  schema = 1\n  [file]\n  names = {}",
            head.above,
            head.name,
            sidecar_name(path),
            layout.names_line
        );
        return Err(RecordError::syntax(Place::in_table(path, layout.names_line), problem));
    }
    let is_power = |text: &str| is_scale(text) && (text.contains("10") || text.contains(['^', '⁻', 'e', 'E']));
    let all_scale =
        layout.heads.len() > 1 && layout.heads.iter().all(|head| head.name.is_empty() || is_scale(&head.name));
    let scale = layout.heads.iter().find_map(|head| {
        let of_name = (all_scale && is_power(&head.name)).then_some(&head.name);
        of_name.or_else(|| is_power(&head.above).then_some(&head.above))
    });
    if let (Some(scale), None) = (scale, file.stated.names_line) {
        let problem = format!(
            "`{scale}` stands among the names and the units: if it scales the numbers, nothing applies it; state the scale by the unit of the column (`kN`). In that case, and also if it is a name, state which line holds the names, in {}:\n  schema = 1\n  [file]\n  names = {}",
            sidecar_name(path),
            layout.names_line
        );
        return Err(RecordError::syntax(Place::in_table(path, layout.names_line), problem));
    }
    let are_units =
        |name: &String| !name.is_empty() && parse_unit(name).is_ok_and(|unit| unit.dimension != Dimension::ONE);
    if let (Some(units), true) = (layout.units_line, layout.heads.len() > 1)
        && layout.heads.iter().all(|head| are_units(&head.name))
    {
        let problem = format!("both this line and line {units} hold units; delete the wrong one");
        return Err(RecordError::syntax(Place::in_table(path, layout.names_line), problem));
    }
    Ok(())
}

/// Asks about a line of units that may be one of symbols, as `L; m; V` below `Length; Mass; Volume`.
fn ask_for_symbols(path: &Path, layout: &Layout, file: &FileWords) -> Result<(), RecordError> {
    let Some(line) = layout.units_line.filter(|_| file.stated.units_line.is_none()) else { return Ok(()) };
    let pairs = || layout.heads.iter().filter_map(|head| Some((&head.name, head.unit.as_deref()?)));
    let is_symbol = |unit: &str| unit.chars().count() == 1 && unit.chars().all(char::is_alphabetic);
    let is_initial = |(name, unit): (&String, &str)| name.to_lowercase().starts_with(&unit.to_lowercase());
    // `Force` in N and `Volt` in V say themselves that the line holds units.
    let is_unit = |(name, unit): (&String, &str)| {
        let dimension = |text: &str| parse_unit(text).ok().map(|unit| unit.dimension);
        meant(name, dimension(unit)).is_some() || dimension(name) == dimension(unit)
    };
    let is_open =
        pairs().count() > 1 && pairs().all(|pair| is_symbol(pair.1) && is_initial(pair)) && !pairs().any(is_unit);
    let Some((name, unit)) = pairs().next().filter(|_| is_open) else { return Ok(()) };
    let problem = format!(
        "`{unit}` below `{name}` can be a symbol or a unit, and so can all others of this line; write in {}:\n  schema = 1\n  [file]\n  units = 0\nif they are symbols, or units = {line} if they are units",
        sidecar_name(path)
    );
    Err(RecordError::syntax(Place::in_table(path, line), problem))
}

/// Adds how the cells of a table are to be read.
fn told(
    mut words: Vec<String>,
    seen: &Seen,
    marks: Marks,
    sname: &[(String, &'static str)],
    noun: &str,
) -> Vec<String> {
    let Layout { heads, units_line, titles, names_line, below, .. } = &seen.layout;
    let dialect = Dialect::own();
    if seen.separator != dialect.separator {
        words.push(format!("cells separated by {}", seen.separator.words()));
    }
    if marks.decimal == ',' {
        words.push("decimal comma".to_owned());
    }
    if let Some(mark) = marks.thousands {
        let name = match mark {
            '.' => "points",
            ',' => "commas",
            '\'' => "apostrophes",
            _ => "blanks",
        };
        words.push(format!("{name} between thousands"));
    }
    if !titles.is_empty() {
        let mut said = counted(
            titles.len(),
            &format!("{noun} above the names passed over"),
            &format!("{noun}s above the names passed over"),
        );
        // What may change the numbers below is shown.
        let scales = |line: &&Line| line.cells.iter().any(|cell| odd(cell) == Some(Odd::Scale) || is_scale(cell));
        if let Some(line) = titles.iter().find(scales) {
            said += &format!(" (also {noun} {}, `{}`, which nothing applies)", line.number, joined(line));
        }
        words.push(said);
    }
    let mut above: Vec<&str> =
        heads.iter().filter(|head| !head.name.starts_with(&head.above)).map(|head| head.above.as_str()).collect();
    above.dedup();
    if !above.is_empty() {
        words.push(format!("`{}` above the names", above.join("; ")));
    }
    if *names_line > 1 {
        words.push(format!("names in {noun} {names_line}"));
    }
    if let Some(line) = units_line {
        words.push(format!("units in {noun} {line}"));
    }
    if !below.is_empty() {
        let (one, many) =
            (format!("{noun} below the units passed over"), format!("{noun}s below the units passed over"));
        words.push(counted(below.len(), &one, &many));
    }
    words.extend(renamed(sname));
    words
}

/// What was renamed, in words.
fn renamed(sname: &[(String, &'static str)]) -> Option<String> {
    let (letters, names): (Vec<&str>, Vec<&str>) = sname.iter().map(|(letter, name)| (letter.as_str(), *name)).unzip();
    (!letters.is_empty()).then(|| format!("{} by SNAME as {}", letters.join(", "), names.join(", ")))
}

/// What nobody can decide but a person, with what to write in the sidecar.
pub(crate) fn undecided(path: &Path, found: &Undecided, sidecar: &Path) -> RecordError {
    let asked = |line: usize, problem: String, answers: Vec<Answer>| RecordError::Asked {
        place: Place::line(path, line),
        question: Question { problem, sidecar: sidecar.to_owned(), answers },
    };
    let answer = |means: String, lines: &[(&str, char)]| Answer {
        means,
        lines: lines.iter().map(|(key, mark)| format!("{key} = \"{mark}\"")).collect(),
    };
    match found {
        Undecided::Either(Witness { cell, line }) => {
            let mark = if cell.contains(',') { ',' } else { '.' };
            let [fraction, whole] = [cell.replace(mark, "."), cell.replace(mark, "")];
            let problem = format!("`{cell}` can be {fraction} or {whole}, and nothing else in the file decides");
            asked(*line, problem, vec![answer(fraction, &[("decimal", mark)]), answer(whole, &[("thousands", mark)])])
        }
        Undecided::Both(point, comma) => {
            let problem = format!(
                "`{}` has a decimal comma and `{}` in line {} a decimal point; export the file with one of them",
                comma.cell, point.cell, point.line
            );
            let stated = |decimal, thousands| {
                answer(format!("a decimal {}", word(decimal)), &[("decimal", decimal), ("thousands", thousands)])
            };
            asked(comma.line, problem, vec![stated(',', '.'), stated('.', ',')])
        }
        Undecided::Mixed { certain, other } => {
            let mark = if other.cell.contains(',') { ',' } else { '.' };
            let decimal = if mark == ',' { '.' } else { ',' };
            let whole = other.cell.replace(mark, "");
            let problem = format!(
                "`{}` stands beside `{}` in line {}: with that decimal mark it is {whole}; if it is not, export the file with one decimal mark",
                other.cell, certain.cell, certain.line
            );
            asked(other.line, problem, vec![answer(whole, &[("decimal", decimal), ("thousands", mark)])])
        }
        Undecided::Thousands(one, other) => {
            let problem = format!(
                "`{}` and `{}` in line {} use two different thousands separators; export the file with one of them",
                other.cell, one.cell, one.line
            );
            RecordError::syntax(Place::line(path, other.line), problem)
        }
    }
}

fn word(mark: char) -> &'static str {
    if mark == ',' { "comma" } else { "point" }
}
