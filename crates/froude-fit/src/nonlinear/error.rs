//! What can be wrong with a model or its parameters, and what to do about it.

/// Why a non-linear fit could not be made, in words; runs and rows count from 0.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NonlinearError(pub(super) String);
