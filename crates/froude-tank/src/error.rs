//! Why runs cannot be reduced.

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
