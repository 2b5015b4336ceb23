//! Why there is no added mass.

use std::fmt::Display;
use std::path::Path;

use froude_hydro::fluid::FluidError;
use froude_identify::IdentifyError;
use froude_identify::method::MethodError;
use froude_mesh::files::ReadError;
use froude_mesh::sections::SectionError;
use froude_panel::chain::ChainError;
use froude_panel::refine::RefineError;
use froude_records::RecordError;
use froude_records::given_option::GivenOption;

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
    /// A request that cannot be carried out. The message starts with the file or the option and ends with what to do.
    #[error("{0}")]
    Refused(String),
}

impl AddedMassError {
    /// What is wrong with a body, a mesh or the target of a repair, and what to do.
    pub(crate) fn input(path: &Path, why: impl Display) -> Self {
        Self::Refused(format!("{}: {why}", path.display()))
    }

    /// An option that says nothing sensible, and what it takes.
    pub(crate) fn option(given: &GivenOption, why: impl Display) -> Self {
        Self::Refused(format!("{given}: {why}"))
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
