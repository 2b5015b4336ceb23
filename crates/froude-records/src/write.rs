//! Writing whole files or nothing.
//!
//! The content goes into a temporary file in the folder of the target, is brought to
//! the disk, and takes the target's place by a rename. A full disk, a lost connection
//! or a failing writer therefore leaves what stood there before.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::error::{RecordError, reason};
use crate::hash::sha256_of_file;
use crate::unfinished::{self, Listed, uninterrupted};

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
    fill: impl FnOnce(&mut io::BufWriter<&mut std::fs::File>) -> io::Result<()>,
) -> Result<(), RecordError> {
    Prepared::new(path, fill)?.take_place()
}

/// A file that lies whole on the disk and has not taken its place yet; dropped, it is gone.
#[derive(Debug)]
pub struct Prepared {
    path: PathBuf,
    folder: PathBuf,
    temporary: NamedTempFile,
    // After the file: it goes first.
    _listed: Listed,
}

impl Prepared {
    /// Writes what will be `path`.
    ///
    /// # Errors
    ///
    /// As [`write_with`].
    pub fn new(
        path: &Path,
        fill: impl FnOnce(&mut io::BufWriter<&mut std::fs::File>) -> io::Result<()>,
    ) -> Result<Self, RecordError> {
        let refuse = |reason: String| RecordError::Write { path: path.to_owned(), reason };
        let failed = |e: io::Error| refuse(reason(&e));
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
        let (mut temporary, listed) = unfinished::file_in(folder).map_err(failed)?;
        {
            let mut buffered = io::BufWriter::new(temporary.as_file_mut());
            fill(&mut buffered).map_err(failed)?;
            buffered.flush().map_err(failed)?;
        }
        // A file that is replaced keeps its permissions.
        if let Ok(old) = std::fs::metadata(path) {
            temporary.as_file().set_permissions(old.permissions()).map_err(failed)?;
        }
        temporary.as_file().sync_all().map_err(failed)?;
        Ok(Self { path: path.to_owned(), folder: folder.to_owned(), temporary, _listed: listed })
    }

    /// What it will be.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// SHA-256 of its content.
    ///
    /// # Errors
    ///
    /// [`RecordError::Read`].
    pub fn sha256(&self) -> Result<String, RecordError> {
        sha256_of_file(self.temporary.path())
    }

    /// Takes the place of what stands there.
    ///
    /// # Errors
    ///
    /// [`RecordError::Write`]; what stood there is untouched.
    pub fn take_place(self) -> Result<(), RecordError> {
        self.persisted(|file, path| file.persist(path))
    }

    /// Takes a place that is free, also where another program might take it at this moment.
    ///
    /// # Errors
    ///
    /// [`RecordError::Write`]: something stands there, and is untouched.
    pub fn take_free_place(self) -> Result<(), RecordError> {
        self.persisted(|file, path| file.persist_noclobber(path))
    }

    fn persisted(
        self,
        persist: fn(NamedTempFile, &Path) -> Result<std::fs::File, tempfile::PersistError>,
    ) -> Result<(), RecordError> {
        uninterrupted(|| persist(self.temporary, &self.path))
            .map_err(|e| RecordError::Write { path: self.path, reason: reason(&e.error) })?;
        sync_folder(&self.folder);
        Ok(())
    }
}

/// Brings the rename to the disk. The file itself is whole either way, so a folder
/// that cannot be synchronised (network disks) is no error.
pub(crate) fn sync_folder(folder: &Path) {
    #[cfg(unix)]
    if let Ok(folder) = std::fs::File::open(folder) {
        let _ = folder.sync_all();
    }
    #[cfg(not(unix))]
    let _ = folder;
}
