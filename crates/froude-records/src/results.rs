//! The results of a job lie in a folder of their own, which is replaced as a whole.
//!
//! All files grow in a folder beside it and come into place by one rename, so that results of two runs are never mixed. Beside them lies
//! the list of what was written: what is not on it, or was changed since, is a person's. Then nothing is written at all.

use std::path::{Path, PathBuf};

use crate::error::RecordError;
use crate::folder::UnfinishedFolder;
use crate::manifest::{Alien, first_alien, write_manifest};

/// Says before a long computation whether its results can be written; nothing is left of the trial.
///
/// # Errors
///
/// The folder is a file, holds what Froude did not write, or nothing can be written where it is or would be.
pub fn can_be_written(out: &Path) -> Result<(), RecordError> {
    let there = out.ancestors().map(|p| if p.as_os_str().is_empty() { Path::new(".") } else { p }).find(|p| p.exists());
    let there = there.unwrap_or(Path::new("."));
    if !there.is_dir() {
        return Err(RecordError::output(out, &std::io::ErrorKind::NotADirectory.into()));
    }
    only_own(out)?;
    UnfinishedFolder::beside(out)?;
    Ok(())
}

/// Refuses a folder that holds what a person wrote.
fn only_own(out: &Path) -> Result<(), RecordError> {
    let alien = if out.is_dir() { first_alien(out)? } else { None };
    match alien {
        Some(Alien { path, is_changed }) => {
            let advice = "is replaced as a whole; move the file out of it, or name another folder with --out";
            Err(RecordError::not_ours(&path, is_changed, format!("and the folder {} {advice}", out.display())))
        }
        None => Ok(()),
    }
}

/// Refuses results in a folder that holds one of these inputs, or in place of one.
///
/// # Errors
///
/// [`RecordError::Refused`].
pub fn spares<'a>(out: &Path, inputs: impl IntoIterator<Item = &'a Path>) -> Result<(), RecordError> {
    let Ok(out) = std::fs::canonicalize(out) else { return Ok(()) };
    let is_replaced = |path: &&Path| std::fs::canonicalize(path).is_ok_and(|path| path.starts_with(&out));
    match inputs.into_iter().find(is_replaced) {
        None => Ok(()),
        Some(input) => {
            let (out, input) = (out.display(), input.display());
            let advice = "which is read: results there would replace it. Name another folder with --out";
            Err(RecordError::Refused(format!("{out} holds {input}, {advice}")))
        }
    }
}

/// Replaces the folder `out` by what `fill` writes into the folder that it is given; the results of an earlier job are gone then.
///
/// # Errors
///
/// Those of `fill`; a folder that holds what a person wrote; a full disk. Then nothing of this job is left, and older results are untouched.
pub fn replace<E: From<RecordError>>(out: &Path, fill: impl FnOnce(&Path) -> Result<(), E>) -> Result<(), E> {
    only_own(out)?;
    let folder = UnfinishedFolder::beside(out)?;
    fill(folder.path())?;
    write_manifest(folder.path()).map_err(|error| error.in_finished(folder.path(), out))?;
    // Somebody may have put a file there meanwhile.
    only_own(out)?;
    Ok(folder.take_place()?)
}

impl RecordError {
    /// A folder or file of the output that could not be made.
    #[must_use]
    pub fn output(path: &Path, source: &std::io::Error) -> Self {
        Self::Output { path: path.to_owned(), reason: source.to_string() }
    }

    /// The same where it speaks of a folder that grew as `unfinished` and would have become `finished`.
    #[must_use]
    pub fn in_finished(self, unfinished: &Path, finished: &Path) -> Self {
        let seen = |path: PathBuf| path.strip_prefix(unfinished).map(|rest| finished.join(rest)).unwrap_or(path);
        match self {
            Self::Write { path, reason } => Self::Write { path: seen(path), reason },
            Self::Output { path, reason } => Self::Output { path: seen(path), reason },
            other => other,
        }
    }
}
