//! Files of a campaign's folder and of OpenFOAM, opened where all input files are ([`froude_records::read`]).

use std::io;
use std::path::Path;
use std::str::FromStr;

use froude_records::RecordError;
use froude_records::read::whole;
use froude_records::write::write_atomically;
use serde::Serialize;

use crate::store_error::StoreError;

/// Largest file that is read: a field of the largest mesh has some hundred bytes a cell.
const LARGEST_BYTES: u64 = 4 << 30;

/// The bytes of a regular file; an error without its name, which the caller adds.
pub(crate) fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    // What is not there keeps its kind.
    std::fs::metadata(path)?;
    whole(path, LARGEST_BYTES, "a file of a computed flow").map_err(|error| match error {
        RecordError::Read { reason, .. } => io::Error::other(reason),
        other => io::Error::other(other.to_string()),
    })
}

/// The same of a text.
pub(crate) fn text(path: &Path) -> io::Result<String> {
    String::from_utf8(bytes(path)?).map_err(|e| io::Error::new(io::ErrorKind::InvalidData, e.utf8_error().to_string()))
}

/// Numbers of a folder's entries that are called so before and behind them, in no order; below the largest there is, so that each has a next.
pub(crate) fn numbers<N: FromStr + PartialOrd>(
    folder: &Path,
    [before, behind]: [&str; 2],
    largest: N,
) -> Result<Vec<N>, StoreError> {
    let failed = |e: io::Error| StoreError::file(folder, e);
    let mut numbers = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let name = entry.map_err(failed)?.file_name();
        let number = name.to_str().and_then(|n| n.strip_prefix(before)?.strip_suffix(behind)?.parse().ok());
        numbers.extend(number.filter(|n| *n < largest));
    }
    Ok(numbers)
}

/// Writes a file of JSON that people read.
pub(crate) fn write_json(path: &Path, content: &impl Serialize) -> Result<(), RecordError> {
    let failed = |e: serde_json::Error| RecordError::Write { path: path.to_owned(), reason: e.to_string() };
    write_atomically(path, (serde_json::to_string_pretty(content).map_err(failed)? + "\n").as_bytes())
}
