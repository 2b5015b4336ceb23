//! Why a campaign's folder cannot be worked with.

use std::fmt::Display;
use std::path::Path;

use froude_records::RecordError;

/// Why a campaign's folder cannot be worked with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// A file, a case or the queue, which the text names.
    #[error("{0}")]
    Refused(String),

    /// A file that a campaign's folder holds beside its cases.
    #[error(transparent)]
    Record(#[from] RecordError),

    /// Another process works on it.
    #[error("{0}")]
    Held(String),
}

impl StoreError {
    /// A file or folder, and what is wrong with it.
    #[must_use]
    pub fn file(path: &Path, problem: impl Display) -> Self {
        Self::Refused(format!("{}: {problem}", path.display()))
    }

    /// A case that is not taken.
    pub(crate) fn case(id: &str, problem: impl Display) -> Self {
        Self::Refused(format!("case {id:?} cannot be taken: {problem}"))
    }

    /// A file whose content is not what was written.
    pub(crate) fn edited(path: &Path, [found, expected]: [&str; 2], next: &str) -> Self {
        let problem = format!(
            "it was changed after it was written: its content has the checksum {found}, and {expected} was written; {next}"
        );
        Self::file(path, problem)
    }
}
