//! Files of a campaign's folder and of OpenFOAM, opened where all input files are ([`froude_records::read`]).

use std::io;
use std::path::Path;

use froude_records::RecordError;
use froude_records::read::whole;

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
