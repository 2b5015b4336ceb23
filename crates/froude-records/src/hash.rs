//! Fingerprints of the files that numbers come from.

use std::fmt::Write as _;
use std::io::Read;
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::error::{RecordError, reason};

/// Length and SHA-256 of a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Fingerprint {
    /// Its bytes.
    pub bytes: u64,
    /// Their SHA-256, hexadecimal.
    pub sha256: String,
}

/// SHA-256 of a file's bytes, hexadecimal.
///
/// # Errors
///
/// [`RecordError::Read`] when the file cannot be read.
pub fn sha256_of_file(path: &Path) -> Result<String, RecordError> {
    fingerprint_of_file(path).map(|found| found.sha256)
}

/// Length and SHA-256 of a file.
///
/// # Errors
///
/// As [`sha256_of_file`].
pub fn fingerprint_of_file(path: &Path) -> Result<Fingerprint, RecordError> {
    let failed = |e: std::io::Error| RecordError::Read { path: path.to_owned(), reason: reason(&e) };
    let mut file = crate::read::open(path)?;
    fingerprint_of(&mut file).map_err(failed)
}

/// SHA-256 of bytes in memory, hexadecimal.
#[must_use]
pub fn sha256_of_bytes(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// Hexadecimal digits of a [`short_key`]: 64 bits.
const SHORT: usize = 16;

/// Start of the SHA-256 of bytes: enough to tell what a lab has apart, short enough to stand in a record.
#[must_use]
pub fn short_key(bytes: &[u8]) -> String {
    sha256_of_bytes(bytes)[..SHORT].to_owned()
}

/// Of everything that can be read from here on.
pub(crate) fn fingerprint_of(input: &mut impl Read) -> std::io::Result<Fingerprint> {
    let mut hash = Sha256::new();
    let mut bytes = 0;
    let mut buffer = vec![0; 1 << 16];
    loop {
        let n = match input.read(&mut buffer) {
            Ok(0) => break,
            Ok(n) => n,
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => continue,
            Err(e) => return Err(e),
        };
        hash.update(&buffer[..n]);
        bytes += n as u64;
    }
    Ok(Fingerprint { bytes, sha256: hexadecimal(&hash.finalize()) })
}

pub(crate) fn hexadecimal(digest: &[u8]) -> String {
    digest.iter().fold(String::with_capacity(2 * digest.len()), |mut text, byte| {
        // Writing into a String cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}
