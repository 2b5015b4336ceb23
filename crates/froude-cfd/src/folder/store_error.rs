//! Why a campaign's folder cannot be worked with.

use std::path::{Path, PathBuf};

use froude_records::RecordError;

use crate::lock::Holder;

/// Why a campaign's folder cannot be worked with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// A file or folder that is not what it should be.
    #[error("{}: {problem}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },

    /// A file or folder that cannot be read or written.
    #[error(transparent)]
    Record(#[from] RecordError),

    /// Somebody else works there.
    #[error("{}: {holder}, works on it; wait for it to end, or end it", path.display())]
    Held {
        /// The campaign's folder, or a case's.
        path: PathBuf,
        /// Who.
        holder: Holder,
    },

    /// A file that is not what was written.
    #[error("{}: it was changed after it was written: its content has the checksum {found}, and {expected} was written; {next}", path.display())]
    Edited {
        /// The file.
        path: PathBuf,
        /// Checksum of what it holds.
        found: String,
        /// Checksum of what it held.
        expected: String,
        /// What to do.
        next: &'static str,
    },

    /// A case that the campaign does not have.
    #[error("{}: it has no case {id:?}; froude cfd status names those that it has", path.display())]
    NoCase {
        /// The campaign's folder.
        path: PathBuf,
        /// The case that was asked for.
        id: String,
    },

    /// A case that cannot be planned or tried again.
    #[error("case {id:?} cannot be taken: {problem}")]
    Plan {
        /// Which.
        id: String,
        /// Why.
        problem: String,
    },

    /// A queue that does not do what was asked.
    #[error("{program}: {problem}")]
    Queue {
        /// The program of Slurm that was called.
        program: String,
        /// What it said.
        problem: String,
    },
}

impl StoreError {
    /// A file or folder with what is wrong with it.
    #[must_use]
    pub fn file(path: &Path, problem: impl Into<String>) -> Self {
        Self::File { path: path.to_owned(), problem: problem.into() }
    }
}
