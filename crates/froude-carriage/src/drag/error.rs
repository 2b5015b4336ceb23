//! Why runs of a carriage give no drag.

use std::fmt::Display;

/// Why runs of a carriage give no drag, in words that state what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct DragError(pub(super) String);

impl DragError {
    /// A calibration without what it needs.
    pub(super) fn calibration(why: impl Display) -> Self {
        Self(format!("calibration: {why}"))
    }
}
