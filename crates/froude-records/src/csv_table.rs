//! Tables as CSV: `name [unit]` headers, a row per observation.

use std::path::Path;

use crate::error::{Place, RecordError, read_bytes, utf8};
use crate::sidecar::Sidecar;
use crate::table::{Column, ColumnData, Table, is_text_column, known_dimension};
use crate::units::{Unit, UnitError, parse_unit};
use crate::write::write_with;

/// The largest CSV table that is read into memory; longer logs are streamed.
const LARGEST_BYTES: u64 = 2 << 30;

/// Raw cells of a CSV file.
struct Cells {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
    lines: Vec<usize>,
}

/// Reads a CSV table, through a sidecar if there is one.
///
/// # Errors
///
/// See [`RecordError`].
pub fn read_csv(path: &Path, sidecar: Option<&Sidecar>) -> Result<Table, RecordError> {
    let bytes = read_bytes(path, LARGEST_BYTES, "a table")?;
    parse_csv(path, utf8(path, &bytes)?, sidecar)
}

/// The same from text; `path` is for messages.
///
/// # Errors
///
/// See [`RecordError`].
pub fn parse_csv(path: &Path, text: &str, sidecar: Option<&Sidecar>) -> Result<Table, RecordError> {
    let cells = cells(path, text)?;
    if cells.rows.is_empty() {
        return Err(RecordError::NoRows { path: path.to_owned() });
    }
    let columns = match sidecar {
        Some(sidecar) => {
            let raw = |name: &str| {
                cells
                    .header
                    .iter()
                    .position(|h| h == name)
                    .map(|j| cells.rows.iter().map(|row| row[j].clone()).collect::<Vec<_>>())
            };
            let place = |row: usize| Place::line(path, cells.lines[row]);
            sidecar.columns(path, &cells.header, &raw, &place)?
        }
        None => (0..cells.header.len()).map(|j| column(path, &cells, j)).collect::<Result<_, _>>()?,
    };
    Ok(Table { path: path.to_owned(), columns, n_rows: cells.rows.len(), line_of_row: cells.lines, sidecar: None })
}

fn cells(path: &Path, text: &str) -> Result<Cells, RecordError> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
    let mut header: Vec<String> = Vec::new();
    let mut rows = Vec::new();
    let mut lines = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| RecordError::Syntax {
            place: e.position().map_or_else(|| Place::whole(path), |p| Place::line(path, p.line() as usize)),
            problem: format!("not CSV: {e}"),
        })?;
        let line = record.position().map_or(0, |p| p.line() as usize);
        let cells: Vec<String> = record.iter().map(|c| c.trim().to_owned()).collect();
        if cells.first().is_some_and(|c| c.starts_with('#')) {
            return Err(RecordError::Syntax {
                place: Place::line(path, line),
                problem: "a table has no comment lines; delete the line".to_owned(),
            });
        }
        if header.is_empty() {
            header = cells;
            continue;
        }
        if cells.len() != header.len() {
            return Err(RecordError::RaggedRow {
                place: Place::line(path, line),
                found: cells.len(),
                expected: header.len(),
            });
        }
        rows.push(cells);
        lines.push(line);
    }
    let mut seen = std::collections::HashSet::new();
    for name in &header {
        if !seen.insert(name) {
            return Err(RecordError::DuplicateColumn { place: Place::line(path, 1), column: name.clone() });
        }
    }
    Ok(Cells { header, rows, lines })
}

/// A column by its header.
fn column(path: &Path, cells: &Cells, j: usize) -> Result<Column, RecordError> {
    let header = &cells.header[j];
    let (name, unit) = split_header(header);
    let place = Place::line(path, 1);
    let texts = || cells.rows.iter().map(|row| row[j].clone()).collect::<Vec<_>>();
    if name.is_empty() {
        return Err(RecordError::Syntax {
            place,
            problem: format!("column {} has no name; write `name [unit]`", j + 1),
        });
    }
    let Some(unit) = unit else {
        let numeric = cells.rows.iter().all(|row| row[j].parse::<f64>().is_ok());
        if is_text_column(name) || (known_dimension(name).is_none() && !numeric) {
            return Ok(Column { name: name.to_owned(), data: ColumnData::Text(texts()) });
        }
        let unit = known_dimension(name).map_or_else(|| "unit".to_owned(), |d| d.to_string());
        let sidecar = path.with_extension("toml");
        let sidecar = sidecar.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        return Err(RecordError::MissingUnit {
            place,
            column: name.to_owned(),
            advice: format!("write `{name} [{unit}]`, or map it with a sidecar {sidecar}"),
        });
    };
    if is_text_column(name) {
        return Err(RecordError::BadUnit {
            place,
            column: header.clone(),
            problem: format!("{name} is text and has no unit; write `{name}`"),
        });
    }
    let unit = parse_unit(unit).map_err(|e: UnitError| RecordError::BadUnit {
        place: place.clone(),
        column: header.clone(),
        problem: e.to_string(),
    })?;
    check_dimension(&place, header, name, &unit)?;
    let row_place = |row: usize| Place::line(path, cells.lines[row]);
    let si = cells
        .rows
        .iter()
        .enumerate()
        .map(|(row, r)| number(&r[j], header, &|| row_place(row)).map(|v| unit.to_si(v)))
        .collect::<Result<_, _>>()?;
    Ok(Column { name: name.to_owned(), data: ColumnData::Number { dimension: unit.dimension, unit, si } })
}

/// `name [unit]` as name and unit.
pub(crate) fn split_header(header: &str) -> (&str, Option<&str>) {
    match header.split_once('[') {
        Some((name, rest)) => (name.trim(), Some(rest.trim_end().trim_end_matches(']').trim())),
        None => (header.trim(), None),
    }
}

/// A known name with another dimension is an error.
pub(crate) fn check_dimension(place: &Place, header: &str, name: &str, unit: &Unit) -> Result<(), RecordError> {
    match known_dimension(name) {
        Some(expected) if expected != unit.dimension => Err(RecordError::WrongDimension {
            place: place.clone(),
            column: header.to_owned(),
            expected: expected.describe(),
            found: unit.dimension.describe(),
        }),
        _ => Ok(()),
    }
}

/// A finite number in a cell.
pub(crate) fn number(cell: &str, header: &str, place: &dyn Fn() -> Place) -> Result<f64, RecordError> {
    if cell.is_empty() {
        return Err(RecordError::EmptyCell { place: place(), column: header.to_owned() });
    }
    match fast_float2::parse::<f64, _>(cell) {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err(RecordError::NotFinite { place: place(), column: header.to_owned(), found: clip(cell) }),
        Err(_) => Err(RecordError::NotANumber { place: place(), column: header.to_owned(), found: clip(cell) }),
    }
}

fn clip(text: &str) -> String {
    text.chars().take(40).collect()
}

/// Writes a table as CSV, whole or not at all; numbers in the units of their columns, in full precision.
///
/// # Errors
///
/// A file that cannot be written.
pub fn write_csv(table: &Table, path: &Path) -> Result<(), RecordError> {
    write_with(path, |file| {
        let mut writer = csv::WriterBuilder::new().from_writer(file);
        let header = table.columns.iter().map(|c| match &c.data {
            ColumnData::Number { unit, .. } => format!("{} [{}]", c.name, unit.text),
            ColumnData::Text(_) => c.name.clone(),
        });
        writer.write_record(header)?;
        for row in 0..table.n_rows {
            let cells = table.columns.iter().map(|c| match &c.data {
                ColumnData::Number { unit, si, .. } => shortest(unit, si[row]),
                ColumnData::Text(texts) => texts[row].clone(),
            });
            writer.write_record(cells)?;
        }
        writer.flush()
    })
}

/// The number in its unit, in the fewest digits that read back to the same SI value.
fn shortest(unit: &Unit, si: f64) -> String {
    let value = unit.from_si(si);
    // 12 digits usually do, and hide the rounding of the unit's factor (0.3 rather than 0.30000000000000004).
    let short: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    if unit.to_si(short) == si { format!("{short}") } else { format!("{value}") }
}
