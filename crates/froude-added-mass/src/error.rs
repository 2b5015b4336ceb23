//! Why there is no added mass.

use std::path::{Path, PathBuf};

use froude_hydro::fluid::FluidError;
use froude_identify::IdentifyError;
use froude_identify::method::MethodError;
use froude_mesh::files::ReadError;
use froude_mesh::sections::SectionError;
use froude_panel::chain::ChainError;
use froude_panel::refine::RefineError;
use froude_records::RecordError;
use froude_records::given_option::GivenOption;

use crate::files::FileError;

/// Why there is no added mass; each message says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AddedMassError {
    /// A file could not be read or written, or says something impossible.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A mesh file cannot be read.
    #[error(transparent)]
    Mesh(#[from] ReadError),
    /// The dimensions give no body.
    #[error(transparent)]
    Sections(#[from] SectionError),
    /// The chain cannot be bent so.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// No mesh could be solved on.
    #[error(transparent)]
    Refine(#[from] RefineError),
    /// The least squares over the numbers of links refused.
    #[error(transparent)]
    Fit(#[from] IdentifyError),
    /// There is no such water.
    #[error("[fluid]: {0}")]
    Water(#[from] FluidError),

    /// An option that says nothing sensible.
    #[error("{given}: {why}")]
    Option {
        /// The option.
        given: GivenOption,
        /// What it takes.
        why: String,
    },
    /// Options that say nothing without another, or beside it.
    #[error("{why}")]
    Together {
        /// Which, and what to do.
        why: String,
    },
    /// A body or a mesh that is not what is needed, or the target of a repair.
    #[error("{}: {why}", .path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// What is wrong with it and what to do.
        why: String,
    },

    /// An added mass that its format cannot hold.
    #[error("cannot write {}: {reason}; nothing was changed", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: FileError,
    },
    /// A repair into a file that is there.
    #[error("{} exists, and a repair writes over nothing; name another file, or delete that one", .path.display())]
    RepairExists {
        /// The target.
        path: PathBuf,
    },
}

impl AddedMassError {
    /// What is wrong with a body, a mesh or the target of a repair, and what to do.
    pub(crate) fn input(path: &Path, why: impl Into<String>) -> Self {
        Self::Input { path: path.to_owned(), why: why.into() }
    }
}

impl From<AddedMassError> for MethodError {
    fn from(error: AddedMassError) -> Self {
        match error {
            AddedMassError::Record(error) => Self::Record(error),
            AddedMassError::Fit(error) => Self::Identify(error),
            other => Self::refused(other),
        }
    }
}
