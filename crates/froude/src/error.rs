//! Why a job of the pipeline failed.

use std::path::{Path, PathBuf};

use froude_identify::compare::too_many;
use froude_identify::method::MethodError;
use froude_records::text::counted;
use froude_report::write::WriteError;
use froude_rig::campaign::error::CampaignError;
use froude_rig::campaign::runner::RunnerError;
use froude_swim::verb::VerbError;
use froude_tank::names::FREE_DECAY;

use crate::registry::METHODS;

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

    /// A method gives no estimates.
    #[error(transparent)]
    Method(MethodError),

    /// Runs of another method than the one that reads.
    #[error(
        "{}: {found}, and runs of the method {wanted} are read here: {instead}; else name a folder with runs of {wanted}",
        .folder.display()
    )]
    OfAnotherMethod {
        /// Where they lie.
        folder: PathBuf,
        /// How many of what.
        found: String,
        /// The method that is read here.
        wanted: String,
        /// What reads them, if anything does.
        instead: String,
    },

    /// Runs of a carriage give no drag.
    #[error(transparent)]
    Drag(#[from] froude_carriage::drag::DragError),

    /// A record of a servo gives no parameters.
    #[error(transparent)]
    Servo(#[from] froude_carriage::servo::ServoError),

    /// An experiment on the loop gives no answer.
    #[error(transparent)]
    Tuning(#[from] froude_carriage::tuning::TuningError),

    /// A campaign cannot be driven.
    #[error(transparent)]
    Campaign(#[from] froude_rig::campaign::error::CampaignError),

    /// A campaign stopped before its end.
    #[error(transparent)]
    Runner(#[from] froude_rig::campaign::runner::RunnerError),

    /// A robot does not swim.
    #[error(transparent)]
    Swim(VerbError),

    /// A campaign of flow computations does not go on.
    #[error(transparent)]
    Cfd(froude_cfd::verb::VerbError),

    /// The report could not be drawn.
    #[error(transparent)]
    Report(#[from] froude_report::ReportError),

    /// A job failed in a folder that nobody sees, in the words of the one that it would have become.
    #[error("{text}")]
    InFinished {
        /// What went wrong.
        text: String,
        /// See [`Error::is_bad_input`].
        is_bad_input: bool,
    },

    /// No table of a twin was written, or not all of them.
    #[error(transparent)]
    Simulate(#[from] froude_identify::simulate::tables::SimulateError),

    /// The demo will not write over somebody's folder.
    #[error("{} exists and is not empty; name another folder: froude demo DIR", .path.display())]
    NotEmpty {
        /// The folder.
        path: PathBuf,
    },

    /// A campaign without sources.
    #[error(
        "{0}: the campaign has no [[source]]{1}",
        .path.display(),
        if *.is_driven {
            format!("; it drives a carriage: froude run {0}, and of its runs froude carriage drag FOLDER", .path.display())
        } else {
            String::new()
        }
    )]
    NoSource {
        /// The campaign.
        path: PathBuf,
        /// Whether it drives a carriage.
        is_driven: bool,
    },

    /// More estimates than a comparison can show.
    #[error("{}", too_many(*.estimates))]
    TooMany {
        /// How many there are.
        estimates: usize,
    },

    /// The result of a part would replace that of more runs, or of others.
    #[error(
        "{} holds the result of {}, of which {} not named now (the first is {first}); it is not replaced by that of {}. Name another folder \
         with --out",
        .out.display(),
        counted(*.there, "run", "runs"),
        counted(*.others, "is", "are"),
        counted(*.named, "run", "runs")
    )]
    ReplacesMore {
        /// The folder of the results.
        out: PathBuf,
        /// Runs of the result that lies there.
        there: usize,
        /// Those of them that are not read now.
        others: usize,
        /// The first of these.
        first: String,
        /// Runs that are read.
        named: usize,
    },
}

impl From<MethodError> for Error {
    /// What a method cannot know is who reads the runs that it has no use for.
    fn from(error: MethodError) -> Self {
        let MethodError::OfAnotherMethod { folder, found, method, is_imported, wanted } = error else {
            return Self::Method(error);
        };
        let of = if is_imported { FREE_DECAY } else { &method };
        let readers: Vec<&str> = METHODS.iter().filter(|m| m.runs() == of).flat_map(|m| m.names()).copied().collect();
        let instead = match readers.as_slice() {
            [] => "no method of this version reads those".to_owned(),
            _ if is_imported => "a [[source]] with method = \"decay\" reads releases".to_owned(),
            _ => format!("a [[source]] with method = {readers:?} reads those"),
        };
        Self::OfAnotherMethod { folder, found, wanted, instead }
    }
}

impl From<VerbError> for Error {
    fn from(error: VerbError) -> Self {
        match error {
            VerbError::Record(error) => Self::Record(error),
            error => Self::Swim(error),
        }
    }
}

impl From<froude_cfd::verb::VerbError> for Error {
    fn from(error: froude_cfd::verb::VerbError) -> Self {
        match error {
            froude_cfd::verb::VerbError::Record(error) => Self::Record(error),
            froude_cfd::verb::VerbError::Method(error) => error.into(),
            froude_cfd::verb::VerbError::Surface(error) => error.into(),
            error => Self::Cfd(error),
        }
    }
}

impl From<WriteError> for Error {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Record(error) => Self::Record(error),
            WriteError::Report(error) => Self::Report(error),
        }
    }
}

impl From<froude_added_mass::AddedMassError> for Error {
    fn from(error: froude_added_mass::AddedMassError) -> Self {
        MethodError::from(error).into()
    }
}

impl Error {
    /// True where the input is at fault (exit code 2), false where the machine is (exit code 1).
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::InFinished { is_bad_input, .. } => *is_bad_input,
            Self::Record(e) => !e.is_output(),
            Self::Identify(froude_identify::IdentifyError::Record(e)) => !e.is_output(),
            Self::Method(e) => e.is_bad_input(),
            Self::Campaign(e) => e.is_bad_input(),
            Self::Simulate(e) => e.is_bad_input(),
            Self::Cfd(e) => e.is_bad_input(),
            Self::Identify(_)
            | Self::NotEmpty { .. }
            | Self::NoSource { .. }
            | Self::TooMany { .. }
            | Self::ReplacesMore { .. }
            | Self::OfAnotherMethod { .. }
            | Self::Drag(_)
            | Self::Servo(_)
            | Self::Tuning(_)
            | Self::Swim(_) => true,
            Self::Runner(_) | Self::Report(_) => false,
        }
    }

    /// True where the job ended because it was asked to (Ctrl-C), and the same command resumes.
    #[must_use]
    pub fn was_stopped(&self) -> bool {
        let is_asked = |e: &RunnerError| matches!(e, RunnerError::Stopped { .. } | RunnerError::StoppedWaiting { .. });
        match self {
            Self::Cfd(e) => e.was_stopped(),
            Self::Runner(e) | Self::Campaign(CampaignError::Runner(e)) => is_asked(e),
            _ => false,
        }
    }

    /// The same where it speaks of a folder that grew as `unfinished` and would have become `finished`.
    pub(crate) fn in_finished(self, unfinished: &Path, finished: &Path) -> Self {
        let (text, own) = (self.to_string(), unfinished.display().to_string());
        if text.contains(&own) {
            let text = text.replace(&own, &finished.display().to_string());
            Self::InFinished { text, is_bad_input: self.is_bad_input() }
        } else {
            self
        }
    }
}
