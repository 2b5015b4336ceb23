//! Parts of a sweep on the disk: what is done stays done when the process is killed.
//!
//! A part is its rows as 64-bit numbers with the code of their status, and the SHA-256 of the sweep's key, the part's number and the rows. One that
//! is cut off or damaged is made again. One whose sum is that of another place (somebody renamed it) is rejected by its name.

use std::ops::Range;
use std::path::{Path, PathBuf};

use froude_records::RecordError;
use froude_records::folder_lock::FolderLock;
use froude_records::hash::{sha256_of_bytes, sha256_of_file, short_key};
use froude_records::outcome::Scratch;
use froude_records::read::if_there;
use froude_records::write::write_atomically;

use crate::sweep::{COLUMNS, Row};
use crate::swim::Status;
use crate::verb::VerbError;

/// So many parts, where a part has not more rows than it may.
const PARTS: usize = 64;
/// Most rows of a part: some seconds of work.
const MOST_ROWS: usize = 1024;
/// Bytes of a row.
const ROW: usize = 8 * COLUMNS.len() + 1;
/// Bytes of a sum, hexadecimal.
const SUM: usize = 64;
/// Before the key.
const PREFIX: &str = ".sweep-";

/// Hash of files and of what was asked.
pub(super) fn key(files: &[PathBuf], asked: &str) -> Result<String, VerbError> {
    let mut text = format!("{} {asked}", env!("CARGO_PKG_VERSION"));
    for file in files {
        text.push_str(&format!(" {}", sha256_of_file(file)?));
    }
    Ok(short_key(text.as_bytes()))
}

/// The parts of one sweep.
#[derive(Debug)]
pub(super) struct Parts {
    folder: PathBuf,
    key: String,
    rows: usize,
    each: usize,
    /// Folders with parts of other sweeps that never came to their end.
    pub(super) others: Vec<PathBuf>,
    lock: FolderLock,
}

impl Parts {
    /// Finds or makes the folder of so many rows.
    pub(super) fn begin(out: &Path, key: &str, rows: usize) -> Result<Self, VerbError> {
        let folder = out.join(format!("{PREFIX}{key}"));
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| RecordError::output(&path, &source)
        };
        std::fs::create_dir_all(&folder).map_err(failed(&folder))?;
        let lock_path = folder.join("lock");
        let Ok(lock) = FolderLock::take(&lock_path, "", false).map_err(failed(&lock_path))? else {
            let busy = "another process is running this sweep; wait for it, or name another folder with --out";
            return Err(VerbError::input(&folder, busy));
        };
        let is_other = |path: &PathBuf| {
            let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            *path != folder && name.starts_with(PREFIX)
        };
        let entries = std::fs::read_dir(out).map_err(failed(out))?;
        let mut others: Vec<PathBuf> = entries.flatten().map(|e| e.path()).filter(is_other).collect();
        others.sort();
        Ok(Self { folder, key: key.to_owned(), rows, each: (rows / PARTS).clamp(1, MOST_ROWS), others, lock })
    }

    pub(super) fn count(&self) -> usize {
        self.rows.div_ceil(self.each)
    }

    pub(super) fn rows(&self, part: usize) -> Range<usize> {
        let first = part * self.each;
        first..(first + self.each).min(self.rows)
    }

    fn path(&self, part: usize) -> PathBuf {
        self.folder.join(format!("{part:06}"))
    }

    /// What a part's sum is of: its place among the parts of this sweep, and its rows.
    fn sum(&self, part: usize, content: &[u8]) -> String {
        sha256_of_bytes(&[format!("{} {part} ", self.key).as_bytes(), content].concat())
    }

    /// The rows of a part that is done; `None` where it is not there, or damaged.
    ///
    /// # Errors
    ///
    /// [`VerbError`]: it is whole, and another part.
    pub(super) fn read(&self, part: usize) -> Result<Option<Vec<Row>>, VerbError> {
        let path = self.path(part);
        let most = (ROW * self.each + SUM) as u64;
        let Ok(Some(bytes)) = if_there(&path, most, "a part of a sweep") else { return Ok(None) };
        let Some((content, sum)) = bytes.len().checked_sub(SUM).map(|at| bytes.split_at(at)) else { return Ok(None) };
        let is_its = |part: usize| sum == self.sum(part, content).as_bytes();
        if content.len() == ROW * self.rows(part).len() && is_its(part) {
            return Ok(content.chunks_exact(ROW).map(row).collect());
        }
        match (0..self.count()).find(|other| is_its(*other)) {
            Some(other) => {
                let problem = format!(
                    "it holds part {other:06}, not part {part:06}: it was renamed or copied; delete it and run again"
                );
                Err(VerbError::input(&path, problem))
            }
            None => Ok(None),
        }
    }

    pub(super) fn write(&self, part: usize, rows: &[Row]) -> Result<(), VerbError> {
        let mut bytes = Vec::with_capacity(ROW * rows.len() + SUM);
        for row in rows {
            bytes.extend(row.numbers.iter().flat_map(|x| x.to_le_bytes()));
            bytes.push(row.status as u8);
        }
        let sum = self.sum(part, &bytes);
        bytes.extend(sum.as_bytes());
        Ok(write_atomically(&self.path(part), &bytes)?)
    }

    /// The folder, to be taken away when the table of its parts is written. What is left where that fails is found by the next start, and
    /// makes the same table.
    pub(super) fn scratch(self) -> Scratch {
        Scratch { folder: self.folder, lock: self.lock }
    }
}

fn row(bytes: &[u8]) -> Option<Row> {
    let (numbers, status) = bytes.split_at_checked(8 * COLUMNS.len())?;
    let mut row = Row { numbers: [f64::NAN; COLUMNS.len()], status: *Status::ALL.get(usize::from(*status.first()?))? };
    for (number, bytes) in row.numbers.iter_mut().zip(numbers.chunks_exact(8)) {
        *number = f64::from_le_bytes(bytes.try_into().ok()?);
    }
    Some(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_read_as_it_was_written_and_a_damaged_one_is_none() {
        let out = tempfile::tempdir().unwrap();
        let parts = Parts::begin(out.path(), "0123", 130).unwrap();
        assert_eq!((parts.count(), parts.rows(64)), (65, 128..130));
        let made: Vec<Row> = [Status::Periodic, Status::Still]
            .map(|status| Row { numbers: std::array::from_fn(|j| 1.0 / (j as f64 + 3.0)), status })
            .to_vec();
        parts.write(3, &made).unwrap();
        assert_eq!(parts.read(3).unwrap(), Some(made.clone()));
        assert_eq!(parts.read(4).unwrap(), None);
        let whole = std::fs::read(parts.path(3)).unwrap();
        std::fs::write(parts.path(3), &whole[..whole.len() - 1]).unwrap();
        assert_eq!(parts.read(3).unwrap(), None);
        let mut changed = whole.clone();
        changed[5] ^= 1;
        std::fs::write(parts.path(3), &changed).unwrap();
        assert_eq!(parts.read(3).unwrap(), None);
        // In the place of another it is rejected by name; the part that belongs there is made again once it is gone.
        std::fs::write(parts.path(5), &whole).unwrap();
        let said = parts.read(5).unwrap_err().to_string();
        assert!(said.contains("000005: it holds part 000003, not part 000005"), "{said}");
        let busy = Parts::begin(out.path(), "0123", 130).unwrap_err().to_string();
        assert!(busy.contains("another process"), "{busy}");
        let other = Parts::begin(out.path(), "4567", 1).unwrap();
        assert_eq!(other.others, [out.path().join(".sweep-0123")]);
    }
}
