//! Everything that keeps a table of another program from being read, at once.
//!
//! The reader stops at the first thing that is wrong. Of a table that Froude did not write there are often several, and nobody wants to meet them one after the
//! other: so the table is looked at again, and all of them are listed.

use std::path::Path;

use froude_foreign::layout::is_missing;
use froude_foreign::marks::Undecided;
use froude_foreign::split::{Row, rows};
use indexmap::IndexMap;

use crate::error::{Place, Position, RecordError};
use crate::file_words::{FileWords, of_sentinel, sentinel};
use crate::foreign_names::meant_without_unit;
use crate::heading::{Heading, passed_over};
use crate::known_columns::is_text_column;
use crate::label_rows::{OddRows, label};
use crate::reading::Reading;
use crate::records::Skipped;
use crate::sidecar::Sidecar;
use crate::text::counted;
use crate::units::parse_unit;

/// As much of a table as is looked at.
const SAMPLE_BYTES: usize = 1 << 18;

/// Most cells that are no numbers, by what stands in them.
const MOST_WORDS: usize = 5;

/// What to do about all of it.
pub(crate) fn remedy(path: &Path) -> String {
    format!(
        "froude inspect {} --write-sidecar writes {}, which proposes names, units and signs for you to check and correct",
        path.display(),
        path.with_extension("toml").display()
    )
}

/// The first error of a table of text, and what else is wrong with it.
pub(crate) fn all(
    path: &Path,
    text: &str,
    reading: &Reading,
    sidecar: Option<&Sidecar>,
    first: RecordError,
) -> RecordError {
    let end = if text.len() <= SAMPLE_BYTES {
        text.len()
    } else {
        let whole = text.floor_char_boundary(SAMPLE_BYTES);
        text[..whole].rfind('\n').map_or(whole, |end| end + 1)
    };
    of(path, &rows(&text[..end], reading.dialect.separator), reading, sidecar, first)
}

/// The same of a table with these rows.
pub(crate) fn of(
    path: &Path,
    rows: &[Row<'_>],
    reading: &Reading,
    sidecar: Option<&Sidecar>,
    first: RecordError,
) -> RecordError {
    if !matches!(first, RecordError::Syntax { .. } | RecordError::Asked { .. }) {
        return first;
    }
    let told = first.to_string();
    let is_told = |obstacle: &Obstacle| match obstacle.line {
        Some(line) => told.starts_with(&format!("{}:", Place::in_table(path, line))),
        None => obstacle.column.as_ref().is_some_and(|column| told.contains(&format!("`{column}`"))),
    };
    let is_text = matches!(Place::in_table(path, 1).position, Position::Line(_));
    let more: Vec<String> = list(reading, rows, sidecar)
        .iter()
        .filter(|obstacle| !is_told(obstacle))
        .map(|obstacle| match obstacle.line {
            Some(line) if is_text => format!("\n  - line {line}: {}", obstacle.text),
            Some(row) => format!("\n  - row {row}: {}", obstacle.text),
            None => format!("\n  - {}", obstacle.text),
        })
        .collect();
    if more.is_empty() {
        return first;
    }
    let understood = reading.understood(Skipped::default(), 0).map_or_else(String::new, |words| format!(" ({words})"));
    let others = counted(more.len(), "more thing keeps", "more things keep");
    let told = told.split(&remedy(path)).next().unwrap_or_default().trim_end();
    RecordError::Refused(format!(
        "{told}\n{others} this table from being read{understood}:{}\n{}",
        more.concat(),
        remedy(path)
    ))
}

/// Something that is wrong.
struct Obstacle {
    /// Where, for rows and cells.
    line: Option<usize>,
    /// The column whose head is wrong, for what is wrong in a head.
    column: Option<String>,
    text: String,
}

/// All that is wrong.
fn list(reading: &Reading, rows: &[Row<'_>], sidecar: Option<&Sidecar>) -> Vec<Obstacle> {
    let data: Vec<&Row<'_>> = rows.iter().filter(|row| !row.is_comment && row.line >= reading.line).collect();
    let is_mapped = sidecar.is_some_and(|sidecar| !sidecar.columns.is_empty());
    let unstated = FileWords::default();
    let file = sidecar.map_or(&unstated, |sidecar| &sidecar.file);
    let mut out = if is_mapped { Vec::new() } else { of_headings(reading) };
    if !is_mapped {
        out.extend(of_long(reading, &data));
    }
    out.extend(reading.undecided.as_ref().map(of_marks));
    out.extend(of_rows(reading, file, &data));
    out
}

/// What the one column of numbers is called where another names what each of them is.
const VALUE: [&str; 9] = ["value", "values", "reading", "wert", "messwert", "valeur", "valor", "verdi", "値"];

/// A table with a quantity per row, `time,channel,value`, instead of one per column.
fn of_long(reading: &Reading, data: &[&Row<'_>]) -> Option<Obstacle> {
    let is_number = |at: usize| reading.is_number.get(at).copied().unwrap_or(false);
    let names = || reading.headings.iter().enumerate();
    let (value_at, value) = names().find(|(_, heading)| VALUE.contains(&heading.name.to_lowercase().as_str()))?;
    let (channel, kinds) = names().filter(|(at, _)| !is_number(*at) && *at != value_at).find_map(|(at, heading)| {
        let mut kinds: IndexMap<&str, usize> = IndexMap::new();
        data.iter().filter_map(|row| row.cells.get(at)).for_each(|cell| *kinds.entry(cell.as_ref()).or_default() += 1);
        (kinds.len() > 1 && kinds.values().all(|n| *n > 1)).then_some((heading, kinds))
    })?;
    let shown: Vec<&str> = kinds.keys().take(3).copied().collect();
    let (channel, value) = (&channel.name, &value.name);
    Some(Obstacle {
        line: Some(reading.line),
        column: None,
        text: format!(
            "each row holds one of several quantities, which column `{channel}` names ({}); write one column for each instead: in pandas, df.pivot(index=…, columns=\"{channel}\", values=\"{value}\")",
            shown.join(", ")
        ),
    })
}

fn of_marks(found: &Undecided) -> Obstacle {
    let (line, text) = match found {
        Undecided::Either(one) => (one.line, format!("`{}` can be read in two ways", one.cell)),
        Undecided::Both(point, comma) => {
            (comma.line, format!("`{}` and `{}` have two decimal marks", point.cell, comma.cell))
        }
        Undecided::Mixed { certain, other } => {
            (other.line, format!("`{}` stands beside `{}` and can be read in two ways", other.cell, certain.cell))
        }
        Undecided::Thousands(one, other) => {
            (other.line, format!("`{}` and `{}` use two different thousands separators", one.cell, other.cell))
        }
    };
    Obstacle { line: Some(line), column: None, text }
}

/// What is wrong with names and units.
fn of_headings(reading: &Reading) -> Vec<Obstacle> {
    let mut out = Vec::new();
    let missed: IndexMap<usize, &str> = passed_over(&reading.headings).collect();
    for (at, heading) in reading.headings.iter().enumerate() {
        let is_number = reading.is_number.get(at).copied().unwrap_or(false);
        let name = heading.header();
        let problem = match &heading.unit {
            Some(unit) => match (parse_unit(unit), missed.get(&at)) {
                (Err(error), _) => error.to_string(),
                (Ok(_), Some(meant)) => format!("would not be used; is it {meant}?"),
                (Ok(_), None) => continue,
            },
            None if is_number && !is_text_column(&name) => {
                let meant = meant_without_unit(&heading.name).or_else(|| meant_without_unit(&heading.above));
                let meant = meant.map_or_else(String::new, |(meant, _)| format!("; is it {}?", meant.name));
                format!("has no unit{meant}")
            }
            None => continue,
        };
        out.push(Obstacle { line: None, text: format!("column `{name}`: {problem}"), column: Some(name) });
    }
    out
}

/// What is wrong with rows and cells.
fn of_rows(reading: &Reading, file: &FileWords, data: &[&Row<'_>]) -> Vec<Obstacle> {
    let mut out = Vec::new();
    let mut add = |line: usize, text: String| out.push(Obstacle { line: Some(line), column: None, text });
    let width = reading.headings.len();
    let mut sums = IndexMap::new();
    if file.leave_out.is_none() {
        let mut odd_rows = OddRows::default();
        sums.extend(data.iter().filter_map(|row| odd_rows.see(label(&row.cells), row.line)));
        sums.extend(odd_rows.end());
    }
    for (line, word) in &sums {
        add(*line, format!("the row begins with `{word}`; where it sums up others, declare it in leave_out"));
    }
    let rest: Vec<&&Row<'_>> =
        data.iter().filter(|row| !file.leaves_out(label(&row.cells)) && !sums.contains_key(&row.line)).collect();
    let is_ragged =
        |row: &&&&Row<'_>| row.cells.len() < width || row.cells[width..].iter().any(|cell| !cell.is_empty());
    if let Some(row) = rest.iter().find(is_ragged) {
        add(row.line, format!("the row has {}, the header has {width}", counted(row.cells.len(), "cell", "cells")));
    }
    let mut words: IndexMap<String, (usize, usize)> = IndexMap::new();
    for (at, heading) in reading.headings.iter().enumerate() {
        if !reading.is_number.get(at).copied().unwrap_or(false) {
            continue;
        }
        let mut values = Vec::new();
        for (cell, line) in rest.iter().filter_map(|row| Some((row.cells.get(at)?, row.line))) {
            let number = reading.dialect.marks.plain(cell).and_then(|plain| plain.parse::<f64>().ok());
            if file.is_not_measured(cell, number) {
                continue;
            }
            match number {
                Some(value) => values.push((value, line)),
                None if cell.is_empty() => {}
                None => words.entry(cell.to_string()).or_insert((line, 0)).1 += 1,
            }
        }
        let numbers: Vec<f64> = values.iter().map(|(value, _)| *value).collect();
        if let Some((row, value)) =
            sentinel(&numbers).filter(|_| file.not_measured.as_ref().is_none_or(|words| !words.is_empty()))
        {
            add(values[row].1, format!("column `{}`: {}", heading.header(), of_sentinel(value)));
        }
    }
    if reading.undecided.is_none() {
        for (word, (line, count)) in words.into_iter().take(MOST_WORDS) {
            let shown: String = word.chars().take(40).collect();
            let missing =
                if is_missing(&word) { "; where it means not measured, declare it in not_measured" } else { "" };
            let times = if count > 1 { format!(", {count} times") } else { String::new() };
            add(line, format!("`{shown}` is not a number{times}{missing}"));
        }
    }
    out
}

/// Refuses columns that are known by another name than Froude's, in a table without a sidecar.
pub(crate) fn refuse_passed_over(path: &Path, reading: &Reading) -> Result<(), RecordError> {
    match passed_over(&reading.headings).next() {
        Some((at, meant)) => {
            let name = reading.headings.get(at).map_or_else(String::new, Heading::header);
            let problem = format!(" would not be used; is it {meant}?\n{}", remedy(path));
            Err(RecordError::column(reading.place.clone(), &name, problem))
        }
        None => Ok(()),
    }
}
