//! Tables of more rows than one wants to keep: the same table, some rows at a time.
//!
//! Every chunk is a [`Table`] with the columns, units, checks and messages of [`read_table`]; memory is a chunk's,
//! whatever the file's length. A CSV of numbers alone is read eight digits at a time; a chunk with text, quotes or an error is read cell by
//! cell, which says what is wrong. A Parquet file is unpacked a row group at a time.
//!
//! Not as there: a line break within a quoted cell ends the chunk's row, and is refused.

use std::io::Read as _;
use std::path::Path;

use froude_foreign::split::Separator;

use crate::assemble::Want;
use crate::csv_table::{Head, Rows, read_csv, text};
use crate::error::RecordError;
use crate::fast_csv::{Layout, Lines, Memory, Reader};
use crate::file_words::FileWords;
use crate::parquet_table;
use crate::raw_column::Raw;
use crate::read;
use crate::read::utf8;
use crate::reading::Reading;
use crate::records::{Records, Skipped};
use crate::sidecar::Sidecar;
use crate::sidecar_file::sidecar_of;
use crate::table::Table;
use crate::table_file::{Format, read_table};

/// Bytes of CSV read at a time: some 10,000 rows, whose columns stay in the caches.
const CHUNK_BYTES: usize = 1 << 20;

/// Reads a table, `.csv` or `.parquet`, a chunk of rows at a time, through `sidecar` or the `.toml` of the same name beside it.
///
/// # Errors
///
/// The first [`RecordError`] in the order of the file, or what `each` returns.
pub fn for_each_chunk<E: From<RecordError>>(
    path: &Path,
    sidecar: Option<&Path>,
    each: &mut dyn FnMut(Table) -> Result<(), E>,
) -> Result<(), E> {
    let mapping = sidecar_of(path, sidecar)?;
    // How two clocks run is told by the whole of both logs.
    if mapping.as_ref().is_some_and(|mapping| !mapping.joins.is_empty()) {
        return each(read_table(path, sidecar)?);
    }
    match Format::of(path)? {
        Format::Text => csv(path, mapping.as_ref(), each),
        Format::Parquet => parquet_table::for_each_chunk(path, mapping.as_ref(), each),
        Format::Sheet | Format::Columns => each(read_table(path, sidecar)?),
    }
}

/// Rows of a table; lines of a CSV count as rows, one more or less. `None` where it cannot be read, or but once: reading it says why.
#[must_use]
pub fn count_rows(path: &Path) -> Option<usize> {
    rows(path, usize::MAX)
}

/// Whether a table has more rows than `limit`; lines of a CSV count as rows. False where it cannot be read: reading it says why.
#[must_use]
pub fn has_more_rows(path: &Path, limit: usize) -> bool {
    rows(path, limit).is_some_and(|rows| rows > limit)
}

/// Rows of a table, counted until there are more than `most`.
fn rows(path: &Path, most: usize) -> Option<usize> {
    // What is no file can be read but once.
    match Format::of(path).ok().filter(|_| path.is_file())? {
        Format::Text => n_lines(path, most).ok(),
        Format::Parquet => parquet_table::n_rows(path).ok(),
        // They are read whole.
        Format::Sheet | Format::Columns => None,
    }
}

/// Lines below the first, which names the columns; counted until there are more than `most`.
fn n_lines(path: &Path, most: usize) -> std::io::Result<usize> {
    let mut file = read::open(path).map_err(std::io::Error::other)?;
    let mut buffer = vec![0; CHUNK_BYTES];
    let mut lines = 0_usize;
    while lines.saturating_sub(1) <= most {
        match file.read(&mut buffer) {
            Ok(0) => break,
            Ok(n) => lines += memchr::memchr_iter(b'\n', &buffer[..n]).count(),
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(lines.saturating_sub(1))
}

fn csv<E: From<RecordError>>(
    path: &Path,
    sidecar: Option<&Sidecar>,
    each: &mut dyn FnMut(Table) -> Result<(), E>,
) -> Result<(), E> {
    let mut reader = Reader::open(path, CHUNK_BYTES)?;
    let mut start = reader.beginning()?;
    if start.starts_with(b"\xef\xbb\xbf") {
        start.drain(..3);
    }
    // The headers are whole; a letter of a later row may be cut in two.
    let end = memchr::memrchr(b'\n', &start).map_or(start.len(), |end| end + 1);
    let unstated = FileWords::default();
    let file = sidecar.map_or(&unstated, |sidecar| &sidecar.file);
    let reading = Reading::of(path, &text(path, &start[..end], file)?, file)?;
    let is_utf8 = std::str::from_utf8(&start[..end]).is_ok();
    if !reading.is_plain() || !is_utf8 || *file != unstated {
        return each(read_csv(path, sidecar)?);
    }
    let fitted = sidecar.map(|sidecar| sidecar.fitted(&reading.headings)).transpose()?;
    let head = Head::of(path, &reading, fitted.as_ref(), file)?;
    reader.go_on(start.split_off(reading.at), reading.line);
    let is_read: Vec<bool> = head.wants.iter().map(|want| !matches!(want, Want::LeftOut)).collect();
    let is_plain = head.wants.iter().zip(&is_read).all(|(want, is_read)| want.is_number() || !is_read);
    let layout = is_plain.then(|| Layout::of(&is_read));
    let mut memory = Memory::default();
    let understood = reading.understood(Skipped::default(), 0);
    let mut has_rows = false;
    while let Some(lines) = reader.next(&mut memory.text)? {
        has_rows = true;
        let table = chunk(path, &head, layout.as_ref(), &mut memory, &lines)?;
        each(table.also(understood.clone()))?;
    }
    if has_rows { Ok(()) } else { Err(RecordError::NoRows { path: path.to_owned() }.into()) }
}

/// A chunk of lines as a table.
fn chunk(
    path: &Path,
    head: &Head<'_, '_>,
    layout: Option<&Layout>,
    memory: &mut Memory,
    lines: &Lines,
) -> Result<Table, RecordError> {
    let first = lines.first;
    // A line that begins with `#` or `%` is a comment, also where its first cell is not read.
    let is_free = memchr::memchr2(b'#', b'%', &memory.text[..lines.bytes]).is_none();
    if let Some(layout) = layout.filter(|_| is_free)
        && let Some(columns) = layout.parse(memory, lines)
    {
        let raw =
            |column: Option<&[f64]>| column.map_or(Raw::Texts(Vec::new()), |column| Raw::Numbers(column.to_vec()));
        let lines = (first..first + lines.count).collect();
        return head.table(Rows::of(columns.into_iter().map(raw).collect(), lines));
    }
    let text = utf8(path, first, &memory.text[..lines.bytes])?;
    let mut records = Records::new(path, text, first, Separator::Comma);
    records.width = head.width_of_rows();
    head.table(head.rows(&mut records, None)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::ColumnData;
    use crate::table_file::read_table;

    /// All chunks of a table put together.
    fn together(path: &Path) -> Result<(Table, usize), RecordError> {
        let (mut all, mut n): (Option<Table>, usize) = (None, 0);
        for_each_chunk(path, None, &mut |chunk| {
            n += 1;
            let Some(all) = &mut all else {
                all = Some(chunk);
                return Ok(());
            };
            for (column, more) in all.columns.iter_mut().zip(chunk.columns) {
                match (&mut column.data, more.data) {
                    (ColumnData::Number { si, .. }, ColumnData::Number { si: more, .. }) => si.extend(more),
                    (ColumnData::Text(texts), ColumnData::Text(more)) => {
                        more.iter().for_each(|text| texts.push(text.clone()));
                    }
                    _ => panic!("a column changes its kind"),
                }
            }
            all.n_rows += chunk.n_rows;
            all.line_of_row.extend(chunk.line_of_row);
            Ok::<(), RecordError>(())
        })?;
        Ok((all.unwrap(), n))
    }

    /// A file of some megabytes whose row `i` is `row(i)`.
    fn written(folder: &Path, header: &str, row: impl Fn(usize) -> String) -> std::path::PathBuf {
        let path = folder.join("long.csv");
        let rows: String = (0..60_000).map(|i| row(i) + "\n").collect();
        std::fs::write(&path, format!("\u{feff}{header}\n{rows}\n\n")).unwrap();
        path
    }

    #[test]
    fn chunks_put_together_are_the_table() {
        let folder = tempfile::tempdir().unwrap();
        let number = |i: usize| format!("{:.6}", (i as f64 * 0.37).sin());
        for (header, text) in
            [("angle [deg],speed [m/s],f_x [mN]", ""), ("angle [deg],speed [m/s],f_x [mN],run", ",\"a, ä\"")]
        {
            let path = written(folder.path(), header, |i| {
                format!("{},{}, -{} {text}", i % 90, number(i), number(i).trim_start_matches('-'))
            });
            let (all, n) = together(&path).unwrap();
            assert!(n > 1, "{n}");
            assert_eq!(all, read_table(&path, None).unwrap());
            let parquet = folder.path().join("long.parquet");
            crate::table_file::prepare_table(&all, &parquet).unwrap().take_place().unwrap();
            let (from_parquet, n) = together(&parquet).unwrap();
            assert!(n > 1, "{n}");
            assert_eq!(from_parquet, read_table(&parquet, None).unwrap());
            assert!(
                has_more_rows(&path, 59_999) && has_more_rows(&parquet, 59_999) && !has_more_rows(&parquet, 60_000)
            );
        }
    }

    #[test]
    fn comments_and_blank_lines_are_passed_over_in_every_chunk() {
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path(), "speed [m/s],f_x [N]", |i| match i {
            50_000 => "# the wind rose".to_owned(),
            55_000 => String::new(),
            _ => format!("{},{}", i % 10, 2 * i),
        });
        let (all, whole) = (together(&path).unwrap().0, read_table(&path, None).unwrap());
        assert_eq!((all.n_rows, &all.columns, &all.line_of_row), (59_998, &whole.columns, &whole.line_of_row));
        assert_eq!(whole.understood.unwrap(), "1 comment line passed over, 1 blank line passed over");
    }

    #[test]
    fn a_sidecar_holds_for_every_chunk() {
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path(), "U,F,note", |i| format!("{i},{},#{i}", 2 * i));
        let mapping = "schema = 1\n[columns]\nU = { name = \"speed\", unit = \"mm/s\" }\n\
                       F = { name = \"f_x\", scale = \"0.5*speed*speed\", sign = -1 }\n[constants]\n";
        let mapping = mapping.replace("0.5*speed*speed", "0.5*rho*speed*speed*A");
        let constants = "rho = \"1000 kg/m^3\"\nA = \"0.01 m^2\"\n";
        std::fs::write(path.with_extension("toml"), mapping + constants).unwrap();
        assert_eq!(together(&path).unwrap().0, read_table(&path, None).unwrap());
    }

    #[test]
    fn what_is_wrong_is_reported_as_of_a_table_that_is_read_whole() {
        let folder = tempfile::tempdir().unwrap();
        for bad in ["1,", "1,x", "1", "1,2,3", "1,inf", "1,1e99", "1,\"2", "Mean,2"] {
            let path = written(folder.path(), "speed [m/s],f_x [N]", |i| {
                if i == 55_000 { bad.to_owned() } else { format!("{},{:.9}", i % 10, i as f64 / 7.0) }
            });
            let [whole, chunks] = [read_table(&path, None).unwrap_err(), together(&path).unwrap_err()];
            assert_eq!(whole.to_string(), chunks.to_string(), "{bad:?}");
        }
    }
}
