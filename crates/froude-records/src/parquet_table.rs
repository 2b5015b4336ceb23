//! Tables as Parquet: the same headers as in CSV are the names of the columns.
//!
//! Read are flat columns of numbers (float, double, integers) and of UTF-8 text,
//! uncompressed or with snappy or zstd. A null is an empty cell. A file that is cut
//! off has no footer and is refused as a whole.

use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{ChunkReader, FileReader as _, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::Field;
use parquet::schema::types::Type;

use crate::assemble::{Raw, Want, assemble, plan};
use crate::error::{Place, RecordError, reason};
use crate::sidecar::Sidecar;
use crate::table::{ColumnData, Table};
use crate::write::write_with;

/// Most rows that are read into memory.
const MOST_ROWS: i64 = 50_000_000;

/// Most bytes of cells, decompressed.
const LARGEST_BYTES: i64 = 16 << 30;

/// Reads a Parquet table, through a sidecar if there is one.
///
/// # Errors
///
/// See [`RecordError`]; a file that is cut off is [`RecordError::Damaged`].
pub fn read_parquet(path: &Path, sidecar: Option<&Sidecar>) -> Result<Table, RecordError> {
    let failed = |e: std::io::Error| RecordError::Read { path: path.to_owned(), reason: reason(&e) };
    let file = File::open(path).map_err(failed)?;
    if file.metadata().map_err(failed)?.is_dir() {
        return Err(RecordError::Read { path: path.to_owned(), reason: "it is a folder".to_owned() });
    }
    parse_parquet(path, file, sidecar)
}

/// The same from anything that holds a Parquet file; `path` is for messages.
///
/// # Errors
///
/// See [`RecordError`].
pub fn parse_parquet<R: ChunkReader + 'static>(
    path: &Path,
    source: R,
    sidecar: Option<&Sidecar>,
) -> Result<Table, RecordError> {
    // A damaged file can make the decoder panic: that is a damaged file, not our end.
    catch_unwind(AssertUnwindSafe(|| read(path, source, sidecar))).unwrap_or_else(|_| {
        Err(RecordError::Damaged { path: path.to_owned(), reason: "its pages contradict its footer".to_owned() })
    })
}

fn read<R: ChunkReader + 'static>(path: &Path, source: R, sidecar: Option<&Sidecar>) -> Result<Table, RecordError> {
    let damaged = |e: ParquetError| RecordError::Damaged { path: path.to_owned(), reason: in_words(&e) };
    let length = source.len();
    let reader = SerializedFileReader::new(source).map_err(damaged)?;
    check_sizes(path, reader.metadata(), length)?;
    let whole = Place::whole(path);
    let fields = reader.metadata().file_metadata().schema().get_fields();
    let header: Vec<String> = fields.iter().map(|f| f.name().trim().to_owned()).collect();
    let wants = plan(path, &header, sidecar, &whole)?;
    let mut raws = Vec::with_capacity(fields.len());
    for (field, name) in fields.iter().zip(&header) {
        raws.push(raw_of(field).ok_or_else(|| RecordError::ColumnKind {
            place: whole.clone(),
            column: name.clone(),
            found: "neither numbers nor text",
            expected: "numbers or text",
        })?);
    }
    let mut n_rows = 0;
    for row in reader.get_row_iter(None).map_err(damaged)? {
        let row = row.map_err(damaged)?;
        n_rows += 1;
        if row.len() != raws.len() {
            return Err(RecordError::RaggedRow {
                place: Place::row(path, n_rows),
                found: row.len(),
                expected: raws.len(),
            });
        }
        for (j, (_, field)) in row.get_column_iter().enumerate() {
            if matches!(wants[j], Want::LeftOut) {
                continue;
            }
            let place = || Place::row(path, n_rows);
            match (&mut raws[j], field) {
                (Raw::Texts(cells), Field::Str(text)) => cells.push(text.clone()),
                (Raw::Texts(cells), Field::Null) => cells.push(String::new()),
                (Raw::Numbers(_), Field::Null) => {
                    return Err(RecordError::EmptyCell { place: place(), column: header[j].clone() });
                }
                (Raw::Numbers(values), field) if number(field).is_some_and(f64::is_finite) => {
                    values.extend(number(field));
                }
                (_, other) => {
                    return Err(RecordError::NotFinite {
                        place: place(),
                        column: header[j].clone(),
                        found: number(other).map_or_else(|| "binary".to_owned(), |x| x.to_string()),
                    });
                }
            }
        }
    }
    assemble(path, &header, &wants, raws, sidecar, &whole, (1..=n_rows).collect())
}

/// Sizes that the footer claims, held against the file, before anything is allocated for them.
fn check_sizes(path: &Path, metadata: &ParquetMetaData, length: u64) -> Result<(), RecordError> {
    let rows = metadata.file_metadata().num_rows();
    if rows > MOST_ROWS {
        return Err(RecordError::Syntax {
            place: Place::whole(path),
            problem: format!("the table has {rows} rows; at most {MOST_ROWS} are read into memory"),
        });
    }
    let damaged =
        || RecordError::Damaged { path: path.to_owned(), reason: "its footer names bytes beyond its end".to_owned() };
    let mut decompressed = 0_i64;
    let mut counted = 0_i64;
    for group in metadata.row_groups() {
        counted = counted.saturating_add(group.num_rows());
        if group.num_rows() < 0 {
            return Err(damaged());
        }
        for chunk in group.columns() {
            let start =
                chunk.dictionary_page_offset().map_or(chunk.data_page_offset(), |d| d.min(chunk.data_page_offset()));
            let end = start.checked_add(chunk.compressed_size()).and_then(|end| u64::try_from(end).ok());
            if start < 0
                || chunk.compressed_size() < 0
                || chunk.uncompressed_size() < 0
                || end.is_none_or(|end| end > length)
            {
                return Err(damaged());
            }
            decompressed = decompressed.saturating_add(chunk.uncompressed_size());
        }
    }
    if rows < 0 || counted != rows {
        return Err(RecordError::Damaged {
            path: path.to_owned(),
            reason: format!("its footer counts {rows} rows, its row groups {counted}"),
        });
    }
    if decompressed > LARGEST_BYTES {
        return Err(RecordError::TooLarge {
            path: path.to_owned(),
            bytes: decompressed.unsigned_abs(),
            limit: LARGEST_BYTES.unsigned_abs(),
            what: "the cells of a table",
        });
    }
    Ok(())
}

/// The reader's words, without its names of variants and types.
fn in_words(error: &ParquetError) -> String {
    match error {
        ParquetError::General(text) | ParquetError::EOF(text) | ParquetError::NYI(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Empty cells of the kind that a column's type asks for; `None` for other types.
fn raw_of(field: &Type) -> Option<Raw> {
    if !field.is_primitive()
        || field.get_basic_info().has_repetition() && field.get_basic_info().repetition() == Repetition::REPEATED
    {
        return None;
    }
    match field.get_physical_type() {
        Physical::DOUBLE | Physical::FLOAT => Some(Raw::Numbers(Vec::new())),
        Physical::INT32 | Physical::INT64 => match field.get_basic_info().logical_type_ref() {
            None | Some(LogicalType::Integer { .. }) => Some(Raw::Numbers(Vec::new())),
            _ => None,
        },
        Physical::BYTE_ARRAY => Some(Raw::Texts(Vec::new())),
        _ => None,
    }
}

fn number(field: &Field) -> Option<f64> {
    Some(match field {
        Field::Double(x) => *x,
        Field::Float(x) => f64::from(*x),
        Field::Byte(x) => f64::from(*x),
        Field::Short(x) => f64::from(*x),
        Field::Int(x) => f64::from(*x),
        Field::Long(x) => *x as f64,
        Field::UByte(x) => f64::from(*x),
        Field::UShort(x) => f64::from(*x),
        Field::UInt(x) => f64::from(*x),
        Field::ULong(x) => *x as f64,
        _ => return None,
    })
}

/// Writes a table as Parquet (zstd), whole or not at all; numbers as doubles in the units of their columns.
///
/// # Errors
///
/// A file that cannot be written.
pub fn write_parquet(table: &Table, path: &Path) -> Result<(), RecordError> {
    write_with(path, |file| {
        write_columns(table, file).map_err(|e| match e {
            ParquetError::External(inner) => match inner.downcast::<std::io::Error>() {
                Ok(io) => *io,
                Err(other) => std::io::Error::other(other),
            },
            other => std::io::Error::other(other),
        })
    })
}

fn write_columns(table: &Table, file: impl std::io::Write + Send) -> Result<(), ParquetError> {
    let mut fields = Vec::new();
    for column in &table.columns {
        let header = column.header();
        let field = match &column.data {
            ColumnData::Number { .. } => Type::primitive_type_builder(&header, Physical::DOUBLE),
            ColumnData::Text(_) => {
                Type::primitive_type_builder(&header, Physical::BYTE_ARRAY).with_logical_type(Some(LogicalType::String))
            }
        };
        fields.push(Arc::new(field.with_repetition(Repetition::REQUIRED).build()?));
    }
    let schema = Arc::new(Type::group_type_builder("table").with_fields(fields).build()?);
    let properties = WriterProperties::builder().set_compression(Compression::ZSTD(ZstdLevel::default())).build();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for column in &table.columns {
        let Some(mut target) = group.next_column()? else { break };
        match &column.data {
            ColumnData::Number { unit, si, .. } => {
                let values: Vec<f64> = si.iter().map(|si| unit.from_si(*si)).collect();
                target.typed::<DoubleType>().write_batch(&values, None, None)?;
            }
            ColumnData::Text(cells) => {
                let values: Vec<ByteArray> = cells.iter().map(|cell| ByteArray::from(cell.as_str())).collect();
                target.typed::<ByteArrayType>().write_batch(&values, None, None)?;
            }
        }
        target.close()?;
    }
    group.close()?;
    writer.close()?;
    Ok(())
}
