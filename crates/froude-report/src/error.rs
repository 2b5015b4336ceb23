//! Why a report could not be made.

/// Why a report could not be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The drawing library refused a figure.
    #[error("figure {figure:?} could not be drawn: {reason}")]
    Figure {
        /// Title of the figure.
        figure: String,
        /// What the drawing library said.
        reason: String,
    },
}
