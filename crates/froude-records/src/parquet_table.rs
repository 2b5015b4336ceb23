//! Tables as Parquet: the same headers as in CSV are the names of the columns.
//!
//! Read are flat columns, uncompressed or with snappy or zstd: numbers of every type, truth values, dates and times in the units of
//! their types, UTF-8 text and categories; lists and structures are refused by name. A null is an empty cell. A file that is cut
//! off has no footer and is refused as a whole.
//!
//! Checksums of pages are verified where a file has them. They leave out the pages' headers and the footer with names, types and
//! counts; what we write ourselves has a checksum of each column as it is read, and nothing outside it.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use parquet::basic::Type as Physical;
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::column::reader::{ColumnReader, get_column_reader};
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData, RowGroupMetaData};
use parquet::file::reader::{ChunkReader, FileReader as _, Length as _, SerializedFileReader};

use crate::assemble::{CHUNK_ROWS, Room, Want, assemble, plan};
use crate::error::{Place, RecordError};
use crate::file_words::FileWords;
use crate::heading::Heading;
use crate::parquet_cells::{Blanks, Cells, describe};
use crate::parquet_columns::{FileColumn, check_packing};
use crate::parquet_sums::{self, Sum};
use crate::parquet_types::CellType;
use crate::raw_column::Raw;
use crate::read;
use crate::sidecar::Sidecar;
use crate::table::Table;

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
    caught(path, || read_whole(path, source, sidecar, &mut None))
}

/// The same with empty cells of loads and of motions along axes, which [`Table::blank`] lists.
///
/// # Errors
///
/// As [`parse_parquet`].
pub fn parse_parquet_with_blanks<R: ChunkReader + 'static>(
    path: &Path,
    source: R,
    sidecar: Option<&Sidecar>,
) -> Result<Table, RecordError> {
    let mut blanks = Some(Vec::new());
    let table = caught(path, || read_whole(path, source, sidecar, &mut blanks))?;
    let mut blank = blanks.unwrap_or_default();
    // Row by row, as in CSV; a column is read at a time.
    blank.sort_by_key(|(_, row)| *row);
    Ok(Table { blank, ..table })
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
    blanks: &mut Blanks,
) -> Result<Table, RecordError> {
    let length = source.len();
    if length > LARGEST_FILE {
        return Err(RecordError::too_large(path, length, LARGEST_FILE, "a Parquet table"));
    }
    let reader = reader(path, source)?;
    let fitted = fitted(&reader, sidecar)?;
    let opened = Opened::new(path, reader, length, fitted.as_ref())?;
    check_memory(path, opened.reader.metadata())?;
    // Nothing is unpacked for cells that would not be kept: a kilobyte can stand for as many rows as a footer cares to count.
    let rows = u64::try_from(opened.reader.metadata().file_metadata().num_rows()).unwrap_or(0);
    Room::new(path).take(opened.bytes_a_row().saturating_mul(rows))?;
    let mut room = Room::new(path);
    let mut sums = opened.sums();
    let mut raws = opened.empty();
    let mut first_row = 1;
    for g in 0..opened.reader.num_row_groups() {
        let mut group = opened.group(g)?;
        first_row += opened.take(&mut group, usize::MAX, first_row, &mut raws, blanks, &mut room)?;
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
    let reader = caught(path, || reader(path, file))?;
    let fitted = fitted(&reader, sidecar)?;
    let opened = caught(path, || Opened::new(path, reader, length, fitted.as_ref()))?;
    let rows = u64::try_from(opened.reader.metadata().file_metadata().num_rows()).unwrap_or(0);
    let most = Room::MOST_BYTES.max(length.saturating_mul(MOST_UNPACKED));
    Room::of(path, most).take(opened.bytes_a_row().saturating_mul(rows))?;
    let mut sums = opened.sums();
    let mut first_row = 1;
    for g in 0..opened.reader.num_row_groups() {
        let mut group = caught(path, || opened.group(g))?;
        while group.taken < group.rows {
            let (mut raws, mut room) = (opened.empty(), Room::new(path));
            let n = caught(path, || opened.take(&mut group, CHUNK_ROWS, first_row, &mut raws, &mut None, &mut room))?;
            opened.add(&mut sums, &raws);
            each(opened.table(raws, (first_row..first_row + n).collect())?)?;
            first_row += n;
        }
    }
    opened.check_sums(sums)?;
    if first_row == 1 { Err(RecordError::NoRows { path: path.to_owned() }.into()) } else { Ok(()) }
}

fn reader<R: ChunkReader + 'static>(path: &Path, source: R) -> Result<SerializedFileReader<R>, RecordError> {
    SerializedFileReader::new(source).map_err(|e| RecordError::Damaged { path: path.to_owned(), reason: describe(&e) })
}

/// The sidecar fitted to the columns of a file.
fn fitted<R: ChunkReader + 'static>(
    reader: &SerializedFileReader<R>,
    sidecar: Option<&Sidecar>,
) -> Result<Option<Sidecar>, RecordError> {
    let columns = FileColumn::all(reader.metadata().file_metadata(), sidecar.is_some());
    let headings: Vec<Heading> = columns.iter().map(|column| Heading::own(&column.header)).collect();
    sidecar.map(|sidecar| sidecar.fitted(&headings)).transpose()
}

/// A Parquet file whose footer was read and believed.
struct Opened<'a, R: ChunkReader + 'static> {
    path: &'a Path,
    sidecar: Option<&'a Sidecar>,
    file: FileWords,
    reader: SerializedFileReader<R>,
    header: Vec<String>,
    columns: Vec<FileColumn>,
    /// What the cells of each column are.
    kinds: Vec<CellType>,
    wants: Vec<Want<'a>>,
    /// The first timestamp, ns since 1970.
    origin_ns: Cell<Option<i128>>,
}

impl<'a, R: ChunkReader + 'static> Opened<'a, R> {
    fn new(
        path: &'a Path,
        reader: SerializedFileReader<R>,
        length: u64,
        sidecar: Option<&'a Sidecar>,
    ) -> Result<Self, RecordError> {
        let file = sidecar.map(|sidecar| sidecar.file.clone()).unwrap_or_default();
        let sidecar = sidecar.filter(|sidecar| !sidecar.columns.is_empty());
        check_sizes(path, reader.metadata(), length)?;
        let columns = FileColumn::all(reader.metadata().file_metadata(), sidecar.is_some());
        if columns.is_empty() {
            return Err(RecordError::NoRows { path: path.to_owned() });
        }
        let header: Vec<String> = columns.iter().map(|column| column.header.clone()).collect();
        let mut wants = plan(path, &header, sidecar, &Place::whole(path))?;
        for (want, _) in wants.iter_mut().zip(&columns).filter(|(_, column)| column.is_index()) {
            if matches!(want, Want::Text { .. }) {
                *want = Want::LeftOut;
            }
        }
        let kinds = columns.iter().zip(&wants).map(|(column, want)| match want {
            Want::LeftOut => Ok(CellType::Text),
            want => column.checked(path, want),
        });
        let kinds = kinds.collect::<Result<_, _>>()?;
        check_packing(path, reader.metadata())?;
        Ok(Self { path, sidecar, file, reader, header, columns, kinds, wants, origin_ns: Cell::new(None) })
    }

    /// Its columns without cells.
    fn empty(&self) -> Vec<Raw> {
        self.columns.iter().map(FileColumn::raw).collect()
    }

    /// Bytes of the cells of a row that are kept.
    fn bytes_a_row(&self) -> u64 {
        let of = |kind: &CellType| if kind.is_text() { size_of::<String>() } else { size_of::<f64>() } as u64;
        let kept = self.wants.iter().zip(&self.kinds).filter(|(want, _)| !matches!(want, Want::LeftOut));
        kept.map(|(_, kind)| of(kind)).sum()
    }

    /// A row group from its first row on.
    fn group(&self, g: usize) -> Result<Group, RecordError> {
        let descriptions = self.reader.metadata().file_metadata().schema_descr_ptr();
        let group = self.reader.get_row_group(g).map_err(|e| self.damaged(&e))?;
        let of = |(j, want): (usize, &Want<'_>)| -> Result<_, RecordError> {
            if matches!(want, Want::LeftOut) {
                return Ok(None);
            }
            let j = self.columns[j].leaf;
            let pages = group.get_column_page_reader(j).map_err(|e| self.damaged(&e))?;
            let left = u64::try_from(group.metadata().column(j).uncompressed_size()).unwrap_or(0);
            let description = descriptions.column(j);
            let width = match description.physical_type() {
                Physical::FIXED_LEN_BYTE_ARRAY => usize::try_from(description.type_length()).unwrap_or(1).max(1),
                _ => 4,
            };
            Ok(Some(get_column_reader(description, Box::new(Checked { pages, left, width }))))
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
        blanks: &mut Blanks,
        room: &mut Room<'_>,
    ) -> Result<usize, RecordError> {
        let n_rows = most.min(group.rows - group.taken);
        for (j, (column, want)) in group.columns.iter_mut().zip(&self.wants).enumerate() {
            let Some(column) = column else { continue };
            let advice = || want.advice(self.path, self.sidecar);
            let may_be_blank = want.name_if_blank();
            let cells = Cells {
                path: self.path,
                column: &self.header[j],
                kind: self.kinds[j],
                time_unit: self.columns[j].time_unit,
                origin_ns: &self.origin_ns,
                may_be_blank,
                advice: &advice,
                first_row,
                n_rows,
            };
            cells.read(column, &mut raws[j], blanks, room)?;
        }
        group.taken += n_rows;
        Ok(n_rows)
    }

    fn damaged(&self, error: &ParquetError) -> RecordError {
        RecordError::Damaged { path: self.path.to_owned(), reason: describe(error) }
    }

    fn table(&self, raws: Vec<Raw>, rows: Vec<usize>) -> Result<Table, RecordError> {
        assemble(self.path, &self.header, &self.wants, raws, (self.sidecar, &self.file), &Place::whole(self.path), rows)
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
    /// Least bytes of an entry of a dictionary: numbers and lengths of texts take four.
    width: usize,
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
        if let Some(Page::DictionaryPage { buf, num_values, .. }) = &page
            && *num_values as usize > buf.len() / self.width
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
            let width = i64::from(chunk.column_descr().type_length().max(0));
            let most = group.num_rows().saturating_mul(BYTES_A_ROW + width).saturating_add(BYTES_BESIDE);
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
