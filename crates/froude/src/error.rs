//! Why a job of the pipeline failed.

use std::path::PathBuf;

/// Why a job of the pipeline failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read or written, or says something impossible.
    #[error(transparent)]
    Record(#[from] froude_records::RecordError),

    /// The campaign gives no coefficients.
    #[error(transparent)]
    Identify(#[from] froude_identify::IdentifyError),

    /// The report could not be drawn.
    #[error(transparent)]
    Report(#[from] froude_report::ReportError),

    /// A folder or file of the output could not be made.
    #[error("{}: cannot be written: {source}; choose another place with --out", .path.display())]
    Output {
        /// The folder or file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },

    /// The demo will not write over somebody's folder.
    #[error("{} exists and is not empty; name another folder: froude demo DIR", .path.display())]
    NotEmpty {
        /// The folder.
        path: PathBuf,
    },

    /// A verb was given nothing to work on.
    #[error("{0}")]
    Nothing(String),
}

impl Error {
    /// True where the input is at fault (exit code 2), false where the machine is (exit code 1).
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Record(e) => !e.is_output(),
            Self::Identify(froude_identify::IdentifyError::Record(e)) => !e.is_output(),
            Self::Identify(_) | Self::NotEmpty { .. } | Self::Nothing(_) => true,
            Self::Report(_) | Self::Output { .. } => false,
        }
    }
}
