//! Why a report could not be made.

/// Why a report could not be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The numbers of a figure are not those of its axes.
    #[error("figure {figure:?} could not be drawn: {reason}")]
    Figure {
        /// Title of the figure.
        figure: String,
        /// What does not fit.
        reason: String,
    },
}
