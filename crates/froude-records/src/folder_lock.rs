//! One process at a time in a folder.
//!
//! Whoever works in it holds a lock on a file there. The lock is the system's: it ends with the process, however that ends, so that what
//! lies there afterwards stops nobody. Reading a folder needs no lock.

use std::fs::{File, TryLockError};
use std::io::{self, Read as _, Write as _};
use std::path::Path;

/// A lock that is held.
#[derive(Debug)]
pub struct FolderLock(File);

impl FolderLock {
    /// Takes the lock by a file of a folder, which then holds `who`; the inner error is what another process that has it left there.
    ///
    /// A disk without locks is an error where the lock `is_needed`; elsewhere there is nothing to wait for.
    ///
    /// # Errors
    ///
    /// The file cannot be made, locked or written.
    pub fn take(path: &Path, who: &str, is_needed: bool) -> io::Result<Result<Self, String>> {
        let mut file = File::options().read(true).write(true).create(true).truncate(false).open(path)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                let mut by = String::new();
                // Where a locked file cannot be read, or is not written yet, there is only less to say.
                let _ = file.read_to_string(&mut by);
                return Ok(Err(by.trim().to_owned()));
            }
            Err(TryLockError::Error(e)) if is_needed => return Err(e),
            _ => {}
        }
        file.set_len(0)?;
        file.write_all(who.as_bytes())?;
        Ok(Ok(Self(file)))
    }
}

impl Drop for FolderLock {
    /// Nobody works there any more, and the file says so; the lock goes with it.
    fn drop(&mut self) {
        // What cannot be emptied names a process that is gone: it stops nobody.
        let _ = self.0.set_len(0);
    }
}
