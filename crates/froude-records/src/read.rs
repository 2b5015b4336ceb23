//! The one place where input files are opened, with the errors of this crate.
//!
//! **Kind.** Regular files only, also through a symbolic link: a pipe may block for ever and a device may have no end.
//! **Size.** Every reader states a limit, or reads in chunks. A test (`crates/froude-cli/tests/files.rs`) keeps other openings out.

use std::fs::File;
use std::path::Path;

use crate::error::{RecordError, read_bytes, reason, utf8};

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
    read_bytes(path, limit, what)
}

/// The same of a text in UTF-8.
///
/// # Errors
///
/// As [`whole`]; [`RecordError::Syntax`] where it is not UTF-8.
pub fn text(path: &Path, limit: u64, what: &'static str) -> Result<String, RecordError> {
    let bytes = whole(path, limit, what)?;
    utf8(path, &bytes).map(str::to_owned)
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
