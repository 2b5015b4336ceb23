//! Why runs cannot be reduced.

use froude_identify::method::MethodError;

/// Why a run, or all of them together, cannot be reduced; the message says what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct TankError(String);

impl TankError {
    pub(crate) fn new(what: impl Into<String>) -> Self {
        Self(what.into())
    }

    pub(crate) fn of_run(run: &str, what: impl Into<String>) -> Self {
        Self(format!("run {run:?}: {}", what.into()))
    }
}

impl From<froude_identify::IdentifyError> for TankError {
    fn from(error: froude_identify::IdentifyError) -> Self {
        Self(error.to_string())
    }
}

/// What a campaign lacks, or has wrong, and where.
pub(crate) fn undeclared(place: impl std::fmt::Display, what: impl Into<String>) -> MethodError {
    MethodError::Undeclared { place: place.to_string(), what: what.into() }
}
