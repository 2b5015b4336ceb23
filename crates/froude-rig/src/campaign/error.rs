//! Why a campaign cannot be driven.

use std::path::PathBuf;

use froude_records::RecordError;
use froude_records::run::CAMPAIGN_COPY;

use super::lock::LockError;
use super::runner::RunnerError;
use super::setup::SetupError;
use crate::campaign::preflight::Objection;

/// Why a campaign cannot be driven, or was not driven to its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CampaignError {
    /// A file could not be read or written, or says something impossible.
    #[error(transparent)]
    Record(#[from] RecordError),

    /// The rig cannot be set up as the campaign declares it.
    #[error(transparent)]
    Setup(#[from] SetupError),

    /// Somebody else drives into the folder.
    #[error(transparent)]
    Lock(#[from] LockError),

    /// It stopped before its end.
    #[error(transparent)]
    Runner(#[from] RunnerError),

    /// There is no rig.
    #[error("{}: nothing to drive: the campaign has no [rig] of a twin or a board", .path.display())]
    NoRig {
        /// The campaign.
        path: PathBuf,
    },

    /// There is a rig, and nothing that it is asked to do.
    #[error("{}: [rig] says what is driven, [carriage] must say what it is to do", .path.display())]
    NoPlan {
        /// The campaign.
        path: PathBuf,
    },

    /// The axis that is to tow is not described.
    #[error("{place}: axis = \"x\" tows along an axis that is not described: write [rig.x], with the keys of [rig.y]")]
    NoAxis {
        /// Where it is asked for.
        place: String,
    },

    /// The pre-flight refuses it.
    #[error(
        "nothing was moved: {}: {}{}", .first.id, .first.text,
        if *.more == 0 { String::new() } else { format!(" ({more} more: froude run --check)") }
    )]
    Refused {
        /// The first objection.
        first: Objection,
        /// How many there are beside it.
        more: usize,
    },

    /// The folder belongs to another campaign.
    #[error(
        "{} holds runs of another campaign, or of an earlier state of this one ({CAMPAIGN_COPY} differs): name another folder with --out",
        .folder.display()
    )]
    OtherCampaign {
        /// The folder of the runs.
        folder: PathBuf,
    },

    /// The folder of the runs or the campaign's copy in it could not be made.
    #[error("{}: cannot be written: {source}; choose another place with --out", .path.display())]
    Output {
        /// The folder or file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

impl CampaignError {
    /// True where the input is at fault, false where the machine is or the drive was stopped.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Record(e) => !e.is_output(),
            Self::Setup(_)
            | Self::NoRig { .. }
            | Self::NoPlan { .. }
            | Self::NoAxis { .. }
            | Self::Refused { .. }
            | Self::OtherCampaign { .. } => true,
            Self::Lock(_) | Self::Runner(_) | Self::Output { .. } => false,
        }
    }
}
