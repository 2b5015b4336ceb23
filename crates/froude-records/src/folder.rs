//! Writing whole folders or nothing.
//!
//! A folder is built beside its place and takes it by one rename, which exchanges the two where something stands there.
//! Whatever happens meanwhile, the old one stands there or the new one, never a part and never a mixture.
//!
//! A disk that cannot exchange two folders (some network disks) takes two renames: a process that is killed between them
//! leaves the old folder as `.froude-old-NAME` beside its place, and the next that writes there puts it back.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::error::{RecordError, reason};
use crate::unfinished::{self, Listed, uninterrupted};
use crate::write::sync_folder;

/// A folder in the making; dropped before it has taken its place, it leaves nothing.
#[derive(Debug)]
pub struct UnfinishedFolder {
    target: PathBuf,
    folder: TempDir,
    _listed: Listed,
    // After the folder that lies in them: they go last.
    made: MadeParents,
    _held: Option<File>,
}

impl UnfinishedFolder {
    /// Begins one beside `target`, whose parents are made where they are missing.
    ///
    /// # Errors
    ///
    /// [`RecordError::Write`]: a target that is no folder, or a parent that cannot be written.
    /// [`RecordError::StartedIn`]: this process works in the target, or below it.
    pub fn beside(target: &Path) -> Result<Self, RecordError> {
        let refuse = |reason: String| RecordError::Write { path: target.to_owned(), reason };
        let failed = |e: io::Error| refuse(reason(&e));
        // A link to a folder stands for that folder.
        let whole = if target.exists() { target.canonicalize().map_err(failed)? } else { target.to_owned() };
        let (Some(parent), Some(_)) = (whole.parent(), whole.file_name()) else {
            return Err(refuse("it is not the name of a folder that can be made".to_owned()));
        };
        let parent = if parent.as_os_str().is_empty() { Path::new(".") } else { parent };
        let made = MadeParents::of(parent).map_err(failed)?;
        let (folder, listed, held) = unfinished::folder_in(parent).map_err(failed)?;
        put_back(&whole).map_err(failed)?;
        if whole.exists() {
            if !whole.is_dir() {
                return Err(refuse("it is a file, and a folder is needed".to_owned()));
            }
            if std::env::current_dir().and_then(|d| d.canonicalize()).is_ok_and(|here| here.starts_with(&whole)) {
                return Err(RecordError::StartedIn { path: target.to_owned() });
            }
            if is_mounted(&whole, parent) {
                return Err(refuse("a disk is mounted there; name a folder inside it".to_owned()));
            }
        }
        Ok(Self { target: whole, folder, _listed: listed, made, _held: held })
    }

    /// Where it grows.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Brings it to the disk and puts it where it belongs; what stood there is gone.
    ///
    /// # Errors
    ///
    /// [`RecordError::Write`]; what stood there is untouched.
    pub fn take_place(mut self) -> Result<(), RecordError> {
        let failed = |e: io::Error| RecordError::Write { path: self.target.clone(), reason: reason(&e) };
        sync_all(self.folder.path());
        if let Ok(old) = std::fs::metadata(&self.target) {
            std::fs::set_permissions(self.folder.path(), old.permissions()).map_err(failed)?;
        }
        uninterrupted(|| match std::fs::symlink_metadata(&self.target) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => std::fs::rename(self.folder.path(), &self.target),
            _ => exchange(self.folder.path(), &self.target),
        })
        .map_err(failed)?;
        self.made.0.clear();
        sync_folder(self.target.parent().unwrap_or(Path::new(".")));
        Ok(())
    }
}

/// True where a folder lies on another disk than its parent: no rename leads there.
fn is_mounted(folder: &Path, parent: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        let device = |path: &Path| std::fs::metadata(path).ok().map(|m| m.dev());
        device(folder) != device(parent)
    }
    #[cfg(not(unix))]
    {
        let _ = (folder, parent);
        false
    }
}

/// Puts the new folder where the old one stands, which goes to the place of the new one.
fn exchange(new: &Path, old: &Path) -> io::Result<()> {
    #[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
    {
        use rustix::fs::{CWD, RenameFlags, renameat_with};
        use rustix::io::Errno;
        match renameat_with(CWD, new, CWD, old, RenameFlags::EXCHANGE) {
            // The disk or the system cannot.
            Err(Errno::INVAL | Errno::NOSYS | Errno::OPNOTSUPP) => {}
            done => return Ok(done?),
        }
    }
    let aside = aside(old);
    std::fs::rename(old, &aside)?;
    if let Err(error) = std::fs::rename(new, old) {
        std::fs::rename(&aside, old)?;
        return Err(error);
    }
    // What stays is taken away by the next that writes here.
    let _ = std::fs::remove_dir_all(aside);
    Ok(())
}

/// Ends an exchange in two steps that was cut off between them, or after them.
fn put_back(target: &Path) -> io::Result<()> {
    let aside = aside(target);
    match (aside.is_dir(), target.exists()) {
        (true, false) => std::fs::rename(aside, target),
        (true, true) => std::fs::remove_dir_all(aside),
        (false, _) => Ok(()),
    }
}

fn aside(target: &Path) -> PathBuf {
    let mut name = std::ffi::OsString::from(".froude-old-");
    name.push(target.file_name().unwrap_or_default());
    target.with_file_name(name)
}

/// The names in a folder and in those below it; a disk that cannot be synchronised is no error, as for a file.
fn sync_all(folder: &Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_type().is_ok_and(|t| t.is_dir()) {
            sync_all(&entry.path());
        }
    }
    sync_folder(folder);
}

/// Folders that were made on the way, the innermost last; dropped, those that are empty go again.
#[derive(Debug)]
struct MadeParents(Vec<PathBuf>);

impl MadeParents {
    fn of(folder: &Path) -> io::Result<Self> {
        let missing = folder.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists());
        let made = Self(missing.map(Path::to_owned).collect());
        std::fs::create_dir_all(folder)?;
        Ok(made)
    }
}

impl Drop for MadeParents {
    fn drop(&mut self) {
        for folder in &self.0 {
            let _ = std::fs::remove_dir(folder);
        }
    }
}
