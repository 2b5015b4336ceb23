//! One drive at a time into a folder of runs.
//!
//! Whoever drives holds a [`FolderLock`], in whose file it says who it is.

use std::path::{Path, PathBuf};

use froude_records::folder_lock::FolderLock;

/// The file's name in the folder.
pub const LOCK_FILE: &str = "drive.lock";

/// Why a folder cannot be driven into.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LockError {
    /// Somebody drives into it.
    #[error(
        "{}: another froude is driving into this folder ({by}); nothing was moved and nothing changed. Wait until it has ended, or \
         name another folder with --out", folder.display()
    )]
    Taken {
        /// The folder.
        folder: PathBuf,
        /// Who, in words: process, host, since when.
        by: String,
    },
    /// The folder or its lock cannot be made.
    #[error(
        "{}: cannot be locked: {reason}; without a lock two programs could drive into it. Name a folder on a disk of this computer \
         with --out", path.display()
    )]
    Impossible {
        /// The folder or the file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
}

/// Makes the folder where it is missing, and takes it: nobody else drives into it as long as the lock lives. `date` in words and
/// `start_unix_ns`, ns since 1970, are left for whoever comes second.
///
/// # Errors
///
/// [`LockError`].
pub fn take(folder: &Path, date: &str, start_unix_ns: u64) -> Result<FolderLock, LockError> {
    let path = folder.join(LOCK_FILE);
    let failed = |e: std::io::Error| LockError::Impossible { path: path.clone(), reason: e.to_string() };
    std::fs::create_dir_all(folder).map_err(failed)?;
    let since = time_of_day(start_unix_ns / 1_000_000_000);
    let who = format!("process {} on {}, since {date} {since} UTC\n", std::process::id(), host());
    FolderLock::take(&path, &who, true).map_err(failed)?.map_err(|by| {
        let by = if by.is_empty() { "who, it has not said yet".to_owned() } else { by };
        LockError::Taken { folder: folder.to_owned(), by }
    })
}

fn time_of_day(unix_s: u64) -> String {
    let s = unix_s % 86_400;
    format!("{:02}:{:02}:{:02}", s / 3_600, s / 60 % 60, s % 60)
}

#[cfg(unix)]
fn host() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

#[cfg(not(unix))]
fn host() -> String {
    std::env::var("COMPUTERNAME").unwrap_or_else(|_| "this computer".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_is_told_who_is_first_and_comes_in_when_that_one_has_gone() {
        let folder = tempfile::tempdir().unwrap();
        let runs = folder.path().join("deep/runs");
        let first = take(&runs, "2026-03-01", (86_400 + 7_384) * 1_000_000_000).unwrap();
        let refused = take(&runs, "2026-03-02", 0).unwrap_err().to_string();
        let who = format!("(process {} on {}, since 2026-03-01 02:03:04 UTC)", std::process::id(), host());
        assert!(refused.contains(&who), "{refused}");
        assert!(refused.starts_with(&runs.display().to_string()), "{refused}");
        drop(first);
        let said = || std::fs::read_to_string(runs.join(LOCK_FILE)).unwrap();
        assert_eq!(said(), "");
        // The longer word of one that was killed leaves nothing behind.
        std::fs::write(runs.join(LOCK_FILE), "process 1 on a computer with a long name, since long ago\nand so on\n")
            .unwrap();
        let second = take(&runs, "2026-03-02", 0).unwrap();
        assert!(said().ends_with("since 2026-03-02 00:00:00 UTC\n") && said().lines().count() == 1, "{}", said());
        drop(second);
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_an_error_with_its_path() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let error = take(&file.join("runs"), "", 0).unwrap_err().to_string();
        assert!(error.contains("cannot be locked") && error.contains("file/runs"), "{error}");
    }
}
