//! Fingerprints of the files that numbers come from.

use std::fmt::Write as _;
use std::io::Read as _;
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::error::{RecordError, reason};

/// SHA-256 of a file's bytes, hexadecimal.
///
/// # Errors
///
/// [`RecordError::Read`] when the file cannot be read.
pub fn sha256_of_file(path: &Path) -> Result<String, RecordError> {
    let failed = |e: std::io::Error| RecordError::Read { path: path.to_owned(), reason: reason(&e) };
    let mut file = std::fs::File::open(path).map_err(failed)?;
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        let n = file.read(&mut buffer).map_err(failed)?;
        if n == 0 {
            break;
        }
        hash.update(&buffer[..n]);
    }
    Ok(hash.finalize().iter().fold(String::with_capacity(64), |mut text, byte| {
        // Writing into a String cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    }))
}
