//! The one place where input files are opened, with the errors of this crate.
//!
//! **Kind.** Regular files only, also through a symbolic link: a pipe may block for ever and a device may have no end.
//! **Size.** Every reader states a limit, or reads in chunks. A test (`crates/froude-cli/tests/suite/files.rs`) keeps other openings out.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;
use std::str::Utf8Error;

use crate::error::{Place, RecordError, reason};
use crate::memory::reserve;

/// Largest file of Froude's own that lists or states something: `case.json`, `campaign.json`, a result, a lock.
pub const OWN_BYTES: u64 = 16 << 20;

/// Opens a regular file for reading.
///
/// # Errors
///
/// [`RecordError::Read`]: it cannot be opened, or it is a folder, a pipe, a socket or a device.
pub fn open(path: &Path) -> Result<File, RecordError> {
    let refuse = |reason: String| RecordError::Read { path: path.to_owned(), reason };
    let kind = std::fs::metadata(path).map_err(|e| refuse(reason(&e)))?.file_type();
    if kind.is_dir() {
        return Err(refuse("it is a folder".to_owned()));
    }
    if !kind.is_file() {
        return Err(refuse(
            "it is a pipe, a socket or a device, and a regular file is needed; save what it carries to a file"
                .to_owned(),
        ));
    }
    let mut options = File::options();
    options.read(true);
    // A pipe that takes the file's place at this moment does not block either.
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt as _;
        options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits() as i32);
    }
    options.open(path).map_err(|e| refuse(reason(&e)))
}

/// The bytes of a file of at most `limit`; `what` says in the message what kind of file it was read as.
///
/// # Errors
///
/// [`RecordError::Read`] and [`RecordError::TooLarge`].
pub fn whole(path: &Path, limit: u64, what: &'static str) -> Result<Vec<u8>, RecordError> {
    let failed = |error: std::io::Error| RecordError::Read { path: path.to_owned(), reason: reason(&error) };
    let file = open(path)?;
    let bytes = file.metadata().map_err(failed)?.len();
    if bytes > limit {
        return Err(RecordError::too_large(path, bytes, limit, what));
    }
    let mut content = Vec::new();
    reserve(&mut content, bytes as usize + 1).map_err(|e| RecordError::memory(path, e))?;
    // A growing file, or one of /proc, has no honest length: stop one byte past the limit.
    file.take(limit + 1).read_to_end(&mut content).map_err(failed)?;
    if content.len() as u64 > limit {
        return Err(RecordError::too_large(path, content.len() as u64, limit, what));
    }
    Ok(content)
}

/// The same of a text in UTF-8.
///
/// # Errors
///
/// As [`whole`]; [`RecordError::Syntax`] where it is not UTF-8.
pub fn text(path: &Path, limit: u64, what: &'static str) -> Result<String, RecordError> {
    let text = String::from_utf8(whole(path, limit, what)?);
    let mut text = text.map_err(|e| not_utf8(path, 1, e.as_bytes(), e.utf8_error()))?;
    if text.starts_with('\u{feff}') {
        text.remove(0);
    }
    Ok(text)
}

/// The same of a file that need not be there: `None` where there is none.
///
/// # Errors
///
/// As [`whole`].
pub fn if_there(path: &Path, limit: u64, what: &'static str) -> Result<Option<Vec<u8>>, RecordError> {
    match std::fs::metadata(path) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        _ => whole(path, limit, what).map(Some),
    }
}

/// UTF-8 text from a line of a file on, or the line of the first byte that is not.
pub(crate) fn utf8<'a>(path: &Path, first_line: usize, bytes: &'a [u8]) -> Result<&'a str, RecordError> {
    std::str::from_utf8(bytes).map_err(|error| not_utf8(path, first_line, bytes, error))
}

fn not_utf8(path: &Path, first_line: usize, bytes: &[u8], error: Utf8Error) -> RecordError {
    let line = first_line + memchr::memchr_iter(b'\n', &bytes[..error.valid_up_to()]).count();
    RecordError::syntax(Place::line(path, line), "the text is not UTF-8; save the file as UTF-8")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_and_a_folder_are_rejected_and_a_link_to_a_file_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a");
        std::fs::write(&file, "text").unwrap();
        assert!(open(folder.path()).unwrap_err().to_string().ends_with("it is a folder"));
        assert_eq!(if_there(&folder.path().join("b"), 9, "a text").unwrap(), None);
        #[cfg(unix)]
        {
            let link = folder.path().join("link");
            std::os::unix::fs::symlink(&file, &link).unwrap();
            assert_eq!(text(&link, 9, "a text").unwrap(), "text");
            let said = whole(Path::new("/dev/zero"), 9, "a text").unwrap_err().to_string();
            assert!(said.contains("a pipe, a socket or a device, and a regular file is needed"), "{said}");
        }
        assert!(whole(&file, 3, "a text").unwrap_err().to_string().contains("the limit for a text is 3"));
    }
}
