//! Tables as Parquet: the same headers as in CSV are the names of the columns.

use std::fs::File;
use std::path::Path;

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;

use crate::csv_table::{check_dimension, split_header};
use crate::error::{Place, RecordError, reason};
use crate::sidecar::Sidecar;
use crate::table::{Column, ColumnData, Table, is_text_column, known_dimension};
use crate::units::parse_unit;

/// Most rows that are read into memory.
const MOST_ROWS: i64 = 50_000_000;

/// A cell as the file has it.
enum Cell {
    Number(f64),
    Text(String),
    Empty,
}

/// Reads a Parquet table, through a sidecar if there is one.
///
/// # Errors
///
/// See [`RecordError`]; a file that is cut off is [`RecordError::Damaged`].
pub fn read_parquet(path: &Path, sidecar: Option<&Sidecar>) -> Result<Table, RecordError> {
    let damaged =
        |e: parquet::errors::ParquetError| RecordError::Damaged { path: path.to_owned(), reason: e.to_string() };
    let file = File::open(path).map_err(|e| RecordError::Read { path: path.to_owned(), reason: reason(&e) })?;
    let reader = SerializedFileReader::new(file).map_err(damaged)?;
    let metadata = reader.metadata().file_metadata();
    if metadata.num_rows() > MOST_ROWS {
        return Err(RecordError::TooLarge {
            path: path.to_owned(),
            bytes: metadata.num_rows() as u64,
            limit: MOST_ROWS as u64,
            what: "rows of a table in memory",
        });
    }
    let header: Vec<String> = metadata.schema().get_fields().iter().map(|f| f.name().to_owned()).collect();
    let mut cells: Vec<Vec<Cell>> = header.iter().map(|_| Vec::new()).collect();
    let mut n_rows = 0;
    for row in reader.get_row_iter(None).map_err(damaged)? {
        let row = row.map_err(damaged)?;
        n_rows += 1;
        for (j, (name, field)) in row.get_column_iter().enumerate() {
            if let Some(column) = cells.get_mut(j) {
                column.push(cell(path, n_rows, name, field)?);
            }
        }
    }
    if n_rows == 0 {
        return Err(RecordError::NoRows { path: path.to_owned() });
    }
    let columns = match sidecar {
        Some(sidecar) => {
            let raw = |name: &str| {
                header.iter().position(|h| h == name).map(|j| {
                    cells[j]
                        .iter()
                        .map(|c| match c {
                            Cell::Number(x) => x.to_string(),
                            Cell::Text(t) => t.clone(),
                            Cell::Empty => String::new(),
                        })
                        .collect()
                })
            };
            sidecar.columns(path, &header, &raw, &|row| Place::row(path, row + 1))?
        }
        None => header.iter().zip(&cells).map(|(h, c)| column(path, h, c)).collect::<Result<_, _>>()?,
    };
    Ok(Table { path: path.to_owned(), columns, n_rows, line_of_row: (1..=n_rows).collect(), sidecar: None })
}

fn cell(path: &Path, row: usize, name: &str, field: &Field) -> Result<Cell, RecordError> {
    Ok(match field {
        Field::Null => Cell::Empty,
        Field::Double(x) => Cell::Number(*x),
        Field::Float(x) => Cell::Number(f64::from(*x)),
        Field::Byte(x) => Cell::Number(f64::from(*x)),
        Field::Short(x) => Cell::Number(f64::from(*x)),
        Field::Int(x) => Cell::Number(f64::from(*x)),
        Field::Long(x) => Cell::Number(*x as f64),
        Field::UByte(x) => Cell::Number(f64::from(*x)),
        Field::UShort(x) => Cell::Number(f64::from(*x)),
        Field::UInt(x) => Cell::Number(f64::from(*x)),
        Field::ULong(x) => Cell::Number(*x as f64),
        Field::Str(t) => Cell::Text(t.clone()),
        other => {
            return Err(RecordError::ColumnKind {
                place: Place::row(path, row),
                column: name.to_owned(),
                found: "neither numbers nor text",
                expected: if matches!(other, Field::Bool(_)) {
                    "numbers or text instead of true and false"
                } else {
                    "numbers or text"
                },
            });
        }
    })
}

fn column(path: &Path, header: &str, cells: &[Cell]) -> Result<Column, RecordError> {
    let (name, unit) = split_header(header);
    let whole = Place::whole(path);
    let is_text = cells.iter().any(|c| matches!(c, Cell::Text(_)));
    let Some(unit) = unit else {
        if is_text || is_text_column(name) {
            let texts = cells.iter().map(|c| match c {
                Cell::Text(t) => t.clone(),
                Cell::Number(x) => x.to_string(),
                Cell::Empty => String::new(),
            });
            return Ok(Column { name: name.to_owned(), data: ColumnData::Text(texts.collect()) });
        }
        let unit = known_dimension(name).map_or_else(|| "unit".to_owned(), |d| d.to_string());
        return Err(RecordError::MissingUnit {
            place: whole,
            column: name.to_owned(),
            advice: format!("name the column `{name} [{unit}]`, or map it with a sidecar"),
        });
    };
    if is_text {
        return Err(RecordError::ColumnKind {
            place: whole,
            column: header.to_owned(),
            found: "text",
            expected: "numbers",
        });
    }
    let unit = parse_unit(unit).map_err(|e| RecordError::BadUnit {
        place: whole.clone(),
        column: header.to_owned(),
        problem: e.to_string(),
    })?;
    check_dimension(&whole, header, name, &unit)?;
    let si = cells
        .iter()
        .enumerate()
        .map(|(row, c)| match c {
            Cell::Number(x) if x.is_finite() => Ok(unit.to_si(*x)),
            Cell::Number(x) => Err(RecordError::NotFinite {
                place: Place::row(path, row + 1),
                column: header.to_owned(),
                found: x.to_string(),
            }),
            _ => Err(RecordError::EmptyCell { place: Place::row(path, row + 1), column: header.to_owned() }),
        })
        .collect::<Result<_, _>>()?;
    Ok(Column { name: name.to_owned(), data: ColumnData::Number { dimension: unit.dimension, unit, si } })
}
