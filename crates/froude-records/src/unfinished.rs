//! Files and folders that grow under a name of their own until they are whole.
//!
//! **Name.** `.froude-unfinished-` and six letters or digits, beside what they become, so that the last step is a rename.
//!
//! **Life.** Their maker locks each (`flock`) for as long as it lives; the system takes the lock from a process that is
//! killed. What nobody holds was left by a dead one, however young or old it is, and is cleared by the next that writes
//! there. A disk without locks (some network disks) keeps what was left on it: nothing is ever cleared by its age.
//!
//! **Interruption.** A program that is told to stop removes its own with [`abandon`] before it exits.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile, TempDir};

/// Before the letters that make each name its own.
const PREFIX: &str = ".froude-unfinished-";

/// New names, where another process takes the one that was just made for left over.
const MOST_TRIES: usize = 8;

/// Unfinished files and folders of this process. Whoever renames one holds this lock.
static LIVE: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn live() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps a path listed as unfinished until it is dropped.
#[derive(Debug)]
pub(crate) struct Listed(PathBuf);

impl Listed {
    fn new(path: &Path) -> Self {
        live().insert(path.to_owned());
        Self(path.to_owned())
    }
}

impl Drop for Listed {
    fn drop(&mut self) {
        live().remove(&self.0);
    }
}

/// Renames without an interruption in between: [`abandon`] waits for its end.
pub(crate) fn uninterrupted<T>(rename: impl FnOnce() -> T) -> T {
    let _live = live();
    rename()
}

/// Removes the unfinished files and folders of this process. For a program that exits next: from now on nothing takes its place any more, and
/// a thread that tries waits for ever.
pub fn abandon() {
    let live = live();
    for path in live.iter() {
        // What cannot be removed is cleared by the next that writes there.
        let _ = if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
    }
    std::mem::forget(live);
}

/// A file that is private to this process until it is persisted; dropped, it is gone.
pub(crate) fn file_in(folder: &Path) -> io::Result<(NamedTempFile, Listed)> {
    clear(folder);
    for _ in 0..MOST_TRIES {
        let file = builder(0o666).tempfile_in(folder)?;
        let _ = file.as_file().lock();
        if file.path().exists() {
            let listed = Listed::new(file.path());
            return Ok((file, listed));
        }
    }
    Err(lost())
}

/// The same for a folder, with what holds its lock.
pub(crate) fn folder_in(folder: &Path) -> io::Result<(TempDir, Listed, Option<File>)> {
    clear(folder);
    for _ in 0..MOST_TRIES {
        let made = builder(0o777).tempdir_in(folder)?;
        // Some systems open no folder and lock none.
        let held = File::open(made.path()).ok().filter(|held| held.lock().is_ok());
        if made.path().exists() {
            let listed = Listed::new(made.path());
            return Ok((made, listed, held));
        }
    }
    Err(lost())
}

/// Takes away what dead processes left in a folder; what cannot be taken away stays.
///
/// A folder that grows itself is passed over: its maker lives, and a thousand files in it would each be looked for among the others.
fn clear(folder: &Path) {
    if folder.ancestors().filter_map(Path::file_name).any(is_ours) {
        return;
    }
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let Some(kind) = entry.file_type().ok().filter(|_| is_ours(&entry.file_name())) else { continue };
        let Ok(held) = File::open(entry.path()) else { continue };
        match held.try_lock() {
            // Held until it is gone: a maker that comes between finds its name missing and takes another.
            Ok(()) if kind.is_dir() => _ = std::fs::remove_dir_all(entry.path()),
            Ok(()) if kind.is_file() => _ = std::fs::remove_file(entry.path()),
            Ok(()) | Err(TryLockError::WouldBlock | TryLockError::Error(_)) => {}
        }
    }
}

fn is_ours(name: &OsStr) -> bool {
    name.to_str().and_then(|n| n.strip_prefix(PREFIX)).is_some_and(|rest| rest.len() == 6)
}

/// A temporary file is private to its owner; a result is as readable as any other: the system takes the umask off.
fn builder(mode: u32) -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(std::fs::Permissions::from_mode(mode));
    }
    #[cfg(not(unix))]
    let _ = mode;
    builder
}

fn lost() -> io::Error {
    io::Error::other("another program takes its temporary files away")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_dead_process_left_is_cleared_but_not_looked_for_in_a_folder_that_grows() {
        let folder = tempfile::tempdir().unwrap();
        let (growing, _listed, _held) = folder_in(folder.path()).unwrap();
        let inside = growing.path().join("figures");
        std::fs::create_dir(&inside).unwrap();
        let leave = |folder: &Path| {
            let left = folder.join(format!("{PREFIX}abcdef"));
            std::fs::write(&left, "half").unwrap();
            drop(file_in(folder).unwrap());
            left.exists()
        };
        assert!(!leave(folder.path()));
        assert!(
            leave(growing.path()) && leave(&inside),
            "a thousand files there cost a thousand looks and not a million"
        );
    }
}
