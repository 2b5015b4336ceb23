//! Errors of the `froude cfd` verbs.

use std::path::{Path, PathBuf};

use froude_added_mass::AddedMassError;
use froude_identify::method::MethodError;
use froude_records::RecordError;

use crate::openfoam::OpenFoamError;
use crate::store_error::StoreError;

/// Errors of `froude cfd`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VerbError {
    /// A file could not be read or written, or says something impossible.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A file of the campaign that cannot be used.
    #[error("{}: {problem}", .path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// The folder of the cases cannot be worked with.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// OpenFOAM cannot be run.
    #[error(transparent)]
    OpenFoam(#[from] OpenFoamError),
    /// A surface cannot be read.
    #[error(transparent)]
    Surface(#[from] AddedMassError),
    /// A source does not declare what its runs need.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// Stopped as asked.
    #[error("stopped as asked, nothing is lost: the same command resumes")]
    Stopped,
}

impl VerbError {
    /// True where the input is at fault, false where the machine is.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        !matches!(self, Self::OpenFoam(_) | Self::Stopped)
    }

    /// True where it was asked to stop, and the same command resumes.
    #[must_use]
    pub fn was_stopped(&self) -> bool {
        matches!(self, Self::Stopped | Self::OpenFoam(OpenFoamError::Cancelled { .. }))
    }

    pub(super) fn input(path: &Path, problem: impl Into<String>) -> Self {
        Self::Input { path: path.to_owned(), problem: problem.into() }
    }
}
