//! Writing whole files or nothing.
//!
//! The content goes into a temporary file in the folder of the target, is brought to
//! the disk, and takes the target's place by a rename. A full disk, a lost connection
//! or a failing writer therefore leaves what stood there before.

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
    let refuse = |reason: String| RecordError::Write { path: path.to_owned(), reason };
    let failed = |e: std::io::Error| refuse(reason(&e));
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    if !folder.exists() {
        return Err(refuse("its folder does not exist".to_owned()));
    }
    if !folder.is_dir() {
        return Err(refuse("its folder is not a folder".to_owned()));
    }
    if path.is_dir() {
        return Err(refuse("it is a folder".to_owned()));
    }
    let mut temporary = like_any_other().tempfile_in(folder).map_err(failed)?;
    {
        let mut buffered = std::io::BufWriter::new(temporary.as_file_mut());
        fill(&mut buffered).map_err(failed)?;
        buffered.flush().map_err(failed)?;
    }
    // A file that is replaced keeps its permissions.
    if let Ok(old) = std::fs::metadata(path) {
        temporary.as_file().set_permissions(old.permissions()).map_err(failed)?;
    }
    temporary.as_file().sync_all().map_err(failed)?;
    temporary.persist(path).map_err(|e| failed(e.error))?;
    sync_folder(folder);
    Ok(())
}

/// A temporary file is private to its owner; a result is as readable as any other file.
fn like_any_other() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".froude-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // The system takes the umask off, as it does for every new file.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder
}

/// Brings the rename to the disk. The file itself is whole either way, so a folder
/// that cannot be synchronised (network disks) is no error.
fn sync_folder(folder: &Path) {
    #[cfg(unix)]
    if let Ok(folder) = std::fs::File::open(folder) {
        let _ = folder.sync_all();
    }
    #[cfg(not(unix))]
    let _ = folder;
}
