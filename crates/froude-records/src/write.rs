//! Files are written whole or not at all: to a temporary in the same folder, then renamed.

use std::io::Write as _;
use std::path::Path;

use crate::error::{RecordError, reason};

/// Writes a file so that either the old or the new content stands there, never a part.
///
/// # Errors
///
/// [`RecordError::Write`]: the folder cannot be written, or the disk is full; what stood there is untouched.
pub fn write_atomically(path: &Path, content: &[u8]) -> Result<(), RecordError> {
    write_with(path, |file| file.write_all(content))
}

/// The same for content that is made while it is written.
///
/// # Errors
///
/// As [`write_atomically`]; an error of `fill` counts as one.
pub fn write_with(
    path: &Path,
    fill: impl FnOnce(&mut std::io::BufWriter<&mut std::fs::File>) -> std::io::Result<()>,
) -> Result<(), RecordError> {
    let failed = |e: std::io::Error| RecordError::Write { path: path.to_owned(), reason: reason(&e) };
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let mut temporary = tempfile::Builder::new().prefix(".froude-").tempfile_in(folder).map_err(failed)?;
    {
        let mut buffered = std::io::BufWriter::new(temporary.as_file_mut());
        fill(&mut buffered).map_err(failed)?;
        buffered.flush().map_err(failed)?;
    }
    temporary.as_file().sync_all().map_err(failed)?;
    set_usual_permissions(temporary.as_file()).map_err(failed)?;
    temporary.persist(path).map_err(|e| failed(e.error))?;
    Ok(())
}

/// A temporary file is private to its owner; a result is as readable as any other file.
#[cfg(unix)]
fn set_usual_permissions(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn set_usual_permissions(_: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}
