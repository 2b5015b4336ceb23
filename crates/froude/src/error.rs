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

    /// Runs of a carriage give no drag.
    #[error(transparent)]
    Drag(#[from] froude_identify::carriage::DragError),

    /// A record of a servo gives no parameters.
    #[error(transparent)]
    Servo(#[from] froude_identify::servo::ServoError),

    /// An experiment on the loop gives no answer.
    #[error(transparent)]
    Tuning(#[from] froude_identify::tuning::TuningError),

    /// The rig cannot be set up as the campaign declares it.
    #[error(transparent)]
    Setup(#[from] froude_rig::campaign::setup::SetupError),

    /// A campaign stopped before its end.
    #[error(transparent)]
    Runner(#[from] froude_rig::campaign::runner::RunnerError),

    /// Somebody else drives into the folder.
    #[error(transparent)]
    Lock(#[from] froude_rig::campaign::lock::LockError),

    /// A mesh file cannot be read.
    #[error(transparent)]
    Mesh(#[from] froude_mesh::files::ReadError),

    /// The body does not fit into the tank.
    #[error(transparent)]
    Tank(#[from] froude_panel::tank::TankError),

    /// The chain cannot be bent so.
    #[error(transparent)]
    Chain(#[from] froude_panel::chain::ChainError),

    /// The dimensions give no body.
    #[error(transparent)]
    Sections(#[from] froude_mesh::sections::SectionError),

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
            Self::Identify(_)
            | Self::NotEmpty { .. }
            | Self::Nothing(_)
            | Self::Drag(_)
            | Self::Servo(_)
            | Self::Tuning(_)
            | Self::Setup(_)
            | Self::Mesh(_)
            | Self::Sections(_)
            | Self::Tank(_)
            | Self::Chain(_) => true,
            Self::Runner(_) | Self::Lock(_) | Self::Report(_) | Self::Output { .. } => false,
        }
    }
}
