//! Fingerprints of the files that numbers come from.

use std::io::{self, Read, Write};
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
    let failed = |e: io::Error| RecordError::Read { path: path.to_owned(), reason: reason(&e) };
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
pub(crate) fn fingerprint_of(input: &mut impl Read) -> io::Result<Fingerprint> {
    let mut sealed = Sealed::new(io::sink());
    io::copy(input, &mut sealed)?;
    Ok(sealed.fingerprint())
}

/// Something that is being written, and its fingerprint so far.
pub(crate) struct Sealed<W> {
    to: W,
    sum: Sha256,
    bytes: u64,
}

impl<W: Write> Sealed<W> {
    pub(crate) fn new(to: W) -> Self {
        Self { to, sum: Sha256::new(), bytes: 0 }
    }

    /// Of all that was written.
    pub(crate) fn fingerprint(self) -> Fingerprint {
        Fingerprint { bytes: self.bytes, sha256: hexadecimal(&self.sum.finalize()) }
    }
}

impl<W: Write> Write for Sealed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.to.write(bytes)?;
        self.sum.update(&bytes[..n]);
        self.bytes += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

pub(crate) fn hexadecimal(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
