//! Tables as Parquet: the same headers as in CSV are the names of the columns.
//!
//! Read are flat columns of numbers (float, double, integers) and of UTF-8 text,
//! uncompressed or with snappy or zstd. A null is an empty cell. A file that is cut
//! off has no footer and is refused as a whole.
//!
//! Checksums of pages are verified where a file has them. They leave out the pages' headers and the footer with names, types and
//! counts; what we write ourselves has a checksum of each column as it is read, and nothing outside it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, KeyValue, ParquetMetaData, RowGroupMetaData};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{ChunkReader, FileReader as _, Length as _, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::assemble::{CHUNK_ROWS, Room, Want, assemble, plan};
use crate::error::{Place, RecordError};
use crate::parquet_sums::{self, Sum};
use crate::raw_column::Raw;
use crate::read;
use crate::sidecar::Sidecar;
use crate::table::{ColumnData, Table};
use crate::write::Prepared;

/// Most rows that are read into memory.
const MOST_ROWS: i64 = 50_000_000;

/// Most bytes of pages, unpacked.
const LARGEST_BYTES: u64 = 2 << 30;

/// Largest file.
const LARGEST_FILE: u64 = 2 << 30;

/// A file that is read in chunks unpacks to so many times its size at most: more is not measured, and would take hours.
const MOST_UNPACKED: u64 = 200;

/// What a column of numbers unpacks to at most: so much a row, as numbers or as a dictionary with its places, and so much beside.
const BYTES_A_ROW: i64 = 24;
const BYTES_BESIDE: i64 = 1 << 20;

/// Reads anything that holds a Parquet table, through a sidecar if there is one; `path` is for messages.
///
/// # Errors
///
/// See [`RecordError`]; a file that is cut off is [`RecordError::Damaged`].
pub fn parse_parquet<R: ChunkReader + 'static>(
    path: &Path,
    source: R,
    sidecar: Option<&Sidecar>,
) -> Result<Table, RecordError> {
    caught(path, || read_whole(path, source, sidecar))
}

/// A damaged file can make the decoder panic: that is a damaged file, not our end.
fn caught<T>(path: &Path, read: impl FnOnce() -> Result<T, RecordError>) -> Result<T, RecordError> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| {
        Err(RecordError::Damaged { path: path.to_owned(), reason: "its pages contradict its footer".to_owned() })
    })
}

fn read_whole<R: ChunkReader + 'static>(
    path: &Path,
    source: R,
    sidecar: Option<&Sidecar>,
) -> Result<Table, RecordError> {
    let length = source.len();
    if length > LARGEST_FILE {
        return Err(RecordError::too_large(path, length, LARGEST_FILE, "a Parquet table"));
    }
    let opened = Opened::new(path, source, sidecar)?;
    check_memory(path, opened.reader.metadata())?;
    // Nothing is unpacked for cells that would not be kept: a kilobyte can stand for as many rows as a footer cares to count.
    let rows = u64::try_from(opened.reader.metadata().file_metadata().num_rows()).unwrap_or(0);
    Room::new(path).take(opened.bytes_a_row().saturating_mul(rows))?;
    let mut room = Room::new(path);
    let mut sums = opened.sums();
    let mut raws = opened.empty()?;
    let mut first_row = 1;
    for g in 0..opened.reader.num_row_groups() {
        let mut group = opened.group(g)?;
        first_row += opened.take(&mut group, usize::MAX, first_row, &mut raws, &mut room)?;
    }
    opened.add(&mut sums, &raws);
    opened.check_sums(sums)?;
    opened.table(raws, (1..first_row).collect())
}

/// Rows of a Parquet table, as its footer counts them.
pub(crate) fn n_rows(path: &Path) -> Result<usize, RecordError> {
    let file = read::open(path)?;
    let reader = caught(path, || reader(path, file))?;
    Ok(usize::try_from(reader.metadata().file_metadata().num_rows()).unwrap_or(0))
}

/// Hands on a table a chunk of rows at a time; of a row group a page of each column is unpacked at once.
pub(crate) fn for_each_chunk<E: From<RecordError>>(
    path: &Path,
    sidecar: Option<&Sidecar>,
    each: &mut dyn FnMut(Table) -> Result<(), E>,
) -> Result<(), E> {
    let file = read::open(path)?;
    let length = file.len();
    let opened = caught(path, || Opened::new(path, file, sidecar))?;
    let rows = u64::try_from(opened.reader.metadata().file_metadata().num_rows()).unwrap_or(0);
    let most = Room::MOST_BYTES.max(length.saturating_mul(MOST_UNPACKED));
    Room::of(path, most).take(opened.bytes_a_row().saturating_mul(rows))?;
    let mut sums = opened.sums();
    let mut first_row = 1;
    for g in 0..opened.reader.num_row_groups() {
        let mut group = caught(path, || opened.group(g))?;
        while group.taken < group.rows {
            let (mut raws, mut room) = (opened.empty()?, Room::new(path));
            let n = caught(path, || opened.take(&mut group, CHUNK_ROWS, first_row, &mut raws, &mut room))?;
            opened.add(&mut sums, &raws);
            each(opened.table(raws, (first_row..first_row + n).collect())?)?;
            first_row += n;
        }
    }
    opened.check_sums(sums)?;
    if first_row == 1 { Err(RecordError::NoRows { path: path.to_owned() }.into()) } else { Ok(()) }
}

fn reader<R: ChunkReader + 'static>(path: &Path, source: R) -> Result<SerializedFileReader<R>, RecordError> {
    SerializedFileReader::new(source).map_err(|e| RecordError::Damaged { path: path.to_owned(), reason: in_words(&e) })
}

/// A Parquet file whose footer was read and believed.
struct Opened<'a, R: ChunkReader + 'static> {
    path: &'a Path,
    sidecar: Option<&'a Sidecar>,
    reader: SerializedFileReader<R>,
    header: Vec<String>,
    wants: Vec<Want<'a>>,
}

impl<'a, R: ChunkReader + 'static> Opened<'a, R> {
    fn new(path: &'a Path, source: R, sidecar: Option<&'a Sidecar>) -> Result<Self, RecordError> {
        let length = source.len();
        let reader = reader(path, source)?;
        check_sizes(path, reader.metadata(), length)?;
        let fields = reader.metadata().file_metadata().schema().get_fields();
        let header: Vec<String> = fields.iter().map(|f| f.name().trim().to_owned()).collect();
        let wants = plan(path, &header, sidecar, &Place::whole(path))?;
        let opened = Self { path, sidecar, reader, header, wants };
        opened.empty()?;
        if opened.header.is_empty() {
            return Err(RecordError::NoRows { path: path.to_owned() });
        }
        Ok(opened)
    }

    fn fields(&self) -> &[Arc<Type>] {
        self.reader.metadata().file_metadata().schema().get_fields()
    }

    /// Its columns without cells.
    fn empty(&self) -> Result<Vec<Raw>, RecordError> {
        let of = |(field, name): (&Arc<Type>, &String)| {
            let problem = " holds neither numbers nor text; expected numbers or text";
            raw_of(field).ok_or_else(|| RecordError::column(Place::whole(self.path), name, problem))
        };
        self.fields().iter().zip(&self.header).map(of).collect()
    }

    /// Bytes of the cells of a row that are kept.
    fn bytes_a_row(&self) -> u64 {
        let of = |field: &Arc<Type>| match raw_of(field) {
            Some(Raw::Numbers(_)) => size_of::<f64>() as u64,
            _ => size_of::<String>() as u64,
        };
        let kept = self.wants.iter().zip(self.fields()).filter(|(want, _)| !matches!(want, Want::LeftOut));
        kept.map(|(_, field)| of(field)).sum()
    }

    /// A row group from its first row on.
    fn group(&self, g: usize) -> Result<Group, RecordError> {
        let descriptions = self.reader.metadata().file_metadata().schema_descr_ptr();
        let group = self.reader.get_row_group(g).map_err(|e| self.damaged(&e))?;
        let of = |(j, want): (usize, &Want<'_>)| -> Result<_, RecordError> {
            if matches!(want, Want::LeftOut) {
                return Ok(None);
            }
            let pages = group.get_column_page_reader(j).map_err(|e| self.damaged(&e))?;
            let left = u64::try_from(group.metadata().column(j).uncompressed_size()).unwrap_or(0);
            Ok(Some(get_column_reader(descriptions.column(j), Box::new(Checked { pages, left }))))
        };
        let columns = self.wants.iter().enumerate().map(of).collect::<Result<_, _>>()?;
        Ok(Group { columns, rows: usize::try_from(group.metadata().num_rows()).unwrap_or(0), taken: 0 })
    }

    /// Reads rows of a group behind what is there, `most` at most; how many they are.
    fn take(
        &self,
        group: &mut Group,
        most: usize,
        first_row: usize,
        raws: &mut [Raw],
        room: &mut Room<'_>,
    ) -> Result<usize, RecordError> {
        let n_rows = most.min(group.rows - group.taken);
        for (j, (column, want)) in group.columns.iter_mut().zip(&self.wants).enumerate() {
            let Some(column) = column else { continue };
            let is_unsigned = matches!(
                self.fields()[j].get_basic_info().logical_type_ref(),
                Some(LogicalType::Integer(integer)) if !integer.is_signed
            );
            let advice = || want.advice(self.path, self.sidecar);
            let header = &self.header[j];
            let cells = Cells { path: self.path, column: header, advice: &advice, first_row, n_rows };
            cells.read(column, is_unsigned, &mut raws[j], room)?;
        }
        group.taken += n_rows;
        Ok(n_rows)
    }

    fn damaged(&self, error: &ParquetError) -> RecordError {
        RecordError::Damaged { path: self.path.to_owned(), reason: in_words(error) }
    }

    fn table(&self, raws: Vec<Raw>, rows: Vec<usize>) -> Result<Table, RecordError> {
        assemble(self.path, &self.header, &self.wants, raws, self.sidecar, &Place::whole(self.path), rows)
    }

    /// The stated checksum of every column that is read beside its own, begun; none where the file has none.
    fn sums(&self) -> Option<(&str, Vec<Sum>)> {
        let entries = self.reader.metadata().file_metadata().key_value_metadata();
        let entry = entries?.iter().find(|entry| entry.key == parquet_sums::KEY)?;
        Some((entry.value.as_deref().unwrap_or_default(), self.header.iter().map(|h| Sum::new(h)).collect()))
    }

    fn add(&self, sums: &mut Option<(&str, Vec<Sum>)>, raws: &[Raw]) {
        for ((sum, want), raw) in sums.iter_mut().flat_map(|(_, sums)| sums).zip(&self.wants).zip(raws) {
            if !matches!(want, Want::LeftOut) {
                sum.add(raw);
            }
        }
    }

    /// Holds every column that was read against its checksum.
    fn check_sums(&self, sums: Option<(&str, Vec<Sum>)>) -> Result<(), RecordError> {
        let Some((stated, found)) = sums else { return Ok(()) };
        let stated: Vec<&str> = stated.split(' ').collect();
        let damaged = |reason: String| Err(RecordError::Damaged { path: self.path.to_owned(), reason });
        if stated.len() != self.header.len() {
            return damaged(format!("it has checksums of {} columns and {} columns", stated.len(), self.header.len()));
        }
        for (((header, want), stated), found) in self.header.iter().zip(&self.wants).zip(stated).zip(found) {
            if !matches!(want, Want::LeftOut) && found.finish() != stated {
                return damaged(format!("column {header} is not what was written: its checksum is another"));
            }
        }
        Ok(())
    }
}

/// A row group as far as it was read.
struct Group {
    /// Its columns, side by side; none for what is left out.
    columns: Vec<Option<ColumnReader>>,
    rows: usize,
    taken: usize,
}

/// Pages whose claims are checked against their bytes before the decoder allocates for them.
///
/// The decoder reserves memory for as many dictionary entries as a page's header says; a
/// damaged header can say two thousand million, and running out of memory cannot be caught. A page is unpacked before it can be
/// seen here; more of them than the footer promised are not.
struct Checked {
    pages: Box<dyn PageReader>,
    /// Bytes that the footer still promises.
    left: u64,
}

impl PageReader for Checked {
    fn get_next_page(&mut self) -> parquet::errors::Result<Option<Page>> {
        let page = self.pages.get_next_page()?;
        if let Some(page) = &page {
            let bytes = page.buffer().len() as u64;
            self.left = self
                .left
                .checked_sub(bytes)
                .ok_or_else(|| ParquetError::General("its pages unpack to more than its footer says".to_owned()))?;
        }
        // Numbers and lengths of texts take four bytes at least.
        if let Some(Page::DictionaryPage { buf, num_values, .. }) = &page
            && *num_values as usize > buf.len() / 4
        {
            return Err(ParquetError::General(format!(
                "a dictionary of {} bytes claims {num_values} entries",
                buf.len()
            )));
        }
        Ok(page)
    }

    fn peek_next_page(&mut self) -> parquet::errors::Result<Option<PageMetadata>> {
        self.pages.peek_next_page()
    }

    fn skip_next_page(&mut self) -> parquet::errors::Result<()> {
        self.pages.skip_next_page()
    }

    fn at_record_boundary(&mut self) -> parquet::errors::Result<bool> {
        self.pages.at_record_boundary()
    }
}

impl Iterator for Checked {
    type Item = parquet::errors::Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

/// Some rows of one column.
struct Cells<'a> {
    path: &'a Path,
    column: &'a str,
    /// What to do about an empty cell.
    advice: &'a dyn Fn() -> String,
    first_row: usize,
    n_rows: usize,
}

impl Cells<'_> {
    fn place(&self, row: usize) -> Place {
        Place::row(self.path, self.first_row + row)
    }

    fn damaged(&self, reason: String) -> RecordError {
        RecordError::Damaged { path: self.path.to_owned(), reason }
    }

    fn read(
        &self,
        column: &mut ColumnReader,
        is_unsigned: bool,
        raw: &mut Raw,
        room: &mut Room<'_>,
    ) -> Result<(), RecordError> {
        match (column, raw) {
            (ColumnReader::DoubleColumnReader(c), Raw::Numbers(out)) => self.numbers(c, out, room, |x| *x),
            (ColumnReader::FloatColumnReader(c), Raw::Numbers(out)) => self.numbers(c, out, room, |x| f64::from(*x)),
            (ColumnReader::Int32ColumnReader(c), Raw::Numbers(out)) if is_unsigned => {
                self.numbers(c, out, room, |x| f64::from(x.cast_unsigned()))
            }
            (ColumnReader::Int32ColumnReader(c), Raw::Numbers(out)) => self.numbers(c, out, room, |x| f64::from(*x)),
            (ColumnReader::Int64ColumnReader(c), Raw::Numbers(out)) if is_unsigned => {
                self.numbers(c, out, room, |x| x.cast_unsigned() as f64)
            }
            (ColumnReader::Int64ColumnReader(c), Raw::Numbers(out)) => self.numbers(c, out, room, |x| *x as f64),
            (ColumnReader::ByteArrayColumnReader(c), Raw::Texts(out)) => self.each(c, |row, cell| {
                let text = std::str::from_utf8(cell.map_or(&[], ByteArray::data)).map_err(|_| {
                    RecordError::syntax(self.place(row), format!("column `{}`: the text is not UTF-8", self.column))
                })?;
                room.text(out, text, &|| self.place(row))
            }),
            _ => Err(self.damaged(format!("column {} is of another type than its schema says", self.column))),
        }
    }

    fn numbers<T: DataType>(
        &self,
        column: &mut ColumnReaderImpl<T>,
        out: &mut Vec<f64>,
        room: &mut Room<'_>,
        number: impl Fn(&T::T) -> f64,
    ) -> Result<(), RecordError> {
        self.each(column, |row, cell| {
            let Some(cell) = cell else {
                return Err(RecordError::empty_cell(self.place(row), self.column, &(self.advice)()));
            };
            let value = number(cell);
            if !value.is_finite() {
                return Err(RecordError::not_finite(self.place(row), self.column, &value.to_string()));
            }
            room.number(out, value)
        })
    }

    /// Every cell of these rows, `None` for a null, with its row from 0.
    fn each<T: DataType>(
        &self,
        column: &mut ColumnReaderImpl<T>,
        mut see: impl FnMut(usize, Option<&T::T>) -> Result<(), RecordError>,
    ) -> Result<(), RecordError> {
        const BATCH: usize = 4096;
        let mut row = 0;
        let (mut levels, mut values) = (Vec::new(), Vec::new());
        while row < self.n_rows {
            levels.clear();
            values.clear();
            let most = BATCH.min(self.n_rows - row);
            let (n, _, _) = column
                .read_records(most, Some(&mut levels), None, &mut values)
                .map_err(|e| self.damaged(in_words(&e)))?;
            if n == 0 {
                return Err(self.damaged(format!("column {} ends before row {}", self.column, self.first_row + row)));
            }
            // A required column has no levels: every cell has a value.
            let mut given = values.iter();
            for k in 0..n {
                let cell = if levels.get(k).is_none_or(|level| *level > 0) { given.next() } else { None };
                see(row + k, cell)?;
            }
            row += n;
        }
        Ok(())
    }
}

/// Sizes that the footer claims, checked against the file, before anything is allocated for them.
fn check_sizes(path: &Path, metadata: &ParquetMetaData, length: u64) -> Result<(), RecordError> {
    let rows = metadata.file_metadata().num_rows();
    let damaged = |reason: String| Err(RecordError::Damaged { path: path.to_owned(), reason });
    let beyond = || damaged("its footer names bytes beyond its end".to_owned());
    let mut counted = 0_i64;
    for group in metadata.row_groups() {
        counted = counted.saturating_add(group.num_rows());
        if group.num_rows() < 0 {
            return beyond();
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
                return beyond();
            }
            let is_number = chunk.column_type() != Physical::BYTE_ARRAY;
            let most = group.num_rows().saturating_mul(BYTES_A_ROW).saturating_add(BYTES_BESIDE);
            let (bytes, numbers) = (chunk.uncompressed_size(), group.num_rows());
            if is_number && bytes > most {
                return damaged(format!("its footer gives {bytes} bytes to {numbers} numbers"));
            }
        }
    }
    if rows < 0 || counted != rows {
        return damaged(format!("its footer counts {rows} rows, its row groups {counted}"));
    }
    Ok(())
}

/// What a table that is read into memory as a whole may have.
fn check_memory(path: &Path, metadata: &ParquetMetaData) -> Result<(), RecordError> {
    let rows = metadata.file_metadata().num_rows();
    if rows > MOST_ROWS {
        let problem = format!("the table has {rows} rows; at most {MOST_ROWS} are read into memory");
        return Err(RecordError::syntax(Place::whole(path), problem));
    }
    let chunks = metadata.row_groups().iter().flat_map(RowGroupMetaData::columns);
    let bytes = chunks.map(ColumnChunkMetaData::uncompressed_size).fold(0, i64::saturating_add).unsigned_abs();
    if bytes > LARGEST_BYTES {
        return Err(RecordError::too_large(path, bytes, LARGEST_BYTES, "the pages of a table, unpacked"));
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
        fields.push(Arc::new(field.with_repetition(Repetition::REQUIRED).build()?));
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
                let values: Vec<f64> = si.iter().map(|si| unit.from_si(*si)).collect();
                target.typed::<DoubleType>().write_batch(&values, None, None)?;
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
