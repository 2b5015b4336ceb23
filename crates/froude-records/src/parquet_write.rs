//! Tables written as Parquet (zstd).

use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::error::RecordError;
use crate::parquet_sums::{self, Sum};
use crate::raw_column::Raw;
use crate::table::{ColumnData, Table};
use crate::write::Prepared;

/// A table as Parquet (zstd), written but not yet moved into place; numbers as doubles in the units of their columns.
pub(crate) fn prepare_parquet(table: &Table, path: &Path) -> Result<Prepared, RecordError> {
    Prepared::new(path, |file| {
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
        let is_blank = table.blank.iter().any(|(name, _)| *name == column.name);
        let repetition = if is_blank { Repetition::OPTIONAL } else { Repetition::REQUIRED };
        fields.push(Arc::new(field.with_repetition(repetition).build()?));
    }
    let schema = Arc::new(Type::group_type_builder("table").with_fields(fields).build()?);
    let properties = WriterProperties::builder().set_compression(Compression::ZSTD(ZstdLevel::default())).build();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    let mut sums = Vec::with_capacity(table.columns.len());
    for column in &table.columns {
        let Some(mut target) = group.next_column()? else { break };
        let cells = match &column.data {
            ColumnData::Number { unit, si, .. } => {
                let mut values: Vec<f64> = si.iter().map(|si| unit.from_si(*si)).collect();
                // 1 for a number, 0 for a null, which is read as an empty cell.
                let mut is_there = vec![1_i16; values.len()];
                let blank: Vec<usize> =
                    table.blank.iter().filter(|(name, _)| *name == column.name).map(|(_, row)| *row).collect();
                for row in &blank {
                    values[*row] = 0.0;
                    is_there[*row] = 0;
                }
                let numbers = values.iter().zip(&is_there).filter(|(_, is_there)| **is_there == 1);
                let numbers: Vec<f64> = numbers.map(|(value, _)| *value).collect();
                let levels = (!blank.is_empty()).then_some(is_there.as_slice());
                target.typed::<DoubleType>().write_batch(&numbers, levels, None)?;
                Raw::Numbers(values)
            }
            ColumnData::Text(cells) => {
                let values: Vec<ByteArray> = cells.iter().map(|cell| ByteArray::from(cell.as_str())).collect();
                target.typed::<ByteArrayType>().write_batch(&values, None, None)?;
                Raw::Texts(cells.iter().cloned().collect())
            }
        };
        target.close()?;
        let mut sum = Sum::new(column.header().trim());
        sum.add(&cells);
        sums.push(sum.finish());
    }
    group.close()?;
    writer.append_key_value_metadata(KeyValue::new(parquet_sums::KEY.to_owned(), sums.join(" ")));
    writer.close()?;
    Ok(())
}
