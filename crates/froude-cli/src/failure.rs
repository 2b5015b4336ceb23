//! Why the program ends without its result: what the library refused, or what cannot be done with what was typed.

use std::path::PathBuf;

use froude::records::units::UnitError;
use froude::swim::verb::typed::NotUnderstood;

use crate::signals::STOPPED;

/// Why the program ends without its result.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The library refused.
    #[error(transparent)]
    Froude(froude::Error),

    /// A file was named that the verb has no use for.
    #[error("{} is {found}; froude {verb} takes {takes}. {instead}", .path.display())]
    Instead {
        /// The file.
        path: PathBuf,
        /// What it is.
        found: &'static str,
        /// The verb.
        verb: &'static str,
        /// What the verb takes.
        takes: &'static str,
        /// What to write instead.
        instead: String,
    },

    /// A log that its own fit would be held against.
    #[error("--validate {}: the log that is fitted says nothing of another motion; name another log", .path.display())]
    ValidatesItself {
        /// The log.
        path: PathBuf,
    },

    /// What the program needs of the system is not to be had.
    #[error("the system does not give what is needed: {0}")]
    Program(std::io::Error),

    /// Stopped as asked.
    #[error("{0}")]
    Stopped(String),

    /// A part of the work is undone.
    #[error("{0}")]
    Part(String),

    /// An option that is called otherwise now.
    #[error("{old} is now {new}: write {instead}")]
    Renamed {
        /// The option.
        old: &'static str,
        /// Its name now.
        new: &'static str,
        /// The option with its value.
        instead: String,
    },

    /// An option that means nothing without another.
    #[error("--weld is for a repair: add --repair FILE, the mesh to be written (.obj or .stl)")]
    WeldWithoutRepair,

    /// An option that is no length.
    #[error("{option} {text:?}: {source}; write a length, \"2.000 m\"")]
    Length {
        /// The option.
        option: &'static str,
        /// What was written.
        text: String,
        /// What is wrong with it.
        source: UnitError,
    },

    /// A gait without one of its numbers.
    #[error("a gait has {option}: write {option} '{example}', or name a gait file: --gait gait.toml")]
    NoGait {
        /// The option.
        option: &'static str,
        /// A value.
        example: &'static str,
    },

    /// An option that is no such quantity.
    #[error(transparent)]
    Quantity(NotUnderstood),

    /// Runs that state no rig.
    #[error("the runs do not state which rig they come from")]
    NoRig,

    /// What was asked is not done.
    #[error("{0}")]
    Refused(String),

    /// `--yes` at a real rig.
    #[error("--yes is for the twin: at a real rig a person must be present and confirm each step")]
    YesAtARig,

    /// Nobody is there to confirm.
    #[error(
        "nothing was moved: nobody can confirm, because standard input is not a terminal. Run it in a terminal{}",
        if *.is_twin { ", or give --yes, which the twin accepts" } else { "" }
    )]
    Nobody {
        /// Whether a twin is driven.
        is_twin: bool,
    },

    /// Nobody could stop a drive.
    #[error("Ctrl-C cannot be watched: {0}; nothing was moved")]
    Unwatched(std::io::Error),

    /// The result is no JSON.
    #[error("the result cannot be written as JSON: {0}")]
    Json(serde_json::Error),
}

impl<E> From<E> for Failure
where
    froude::Error: From<E>,
{
    fn from(error: E) -> Self {
        Self::Froude(error.into())
    }
}

impl Failure {
    /// 2 where the input is at fault, 1 where the machine is, and 130 of what was stopped as asked, as a shell has it after Ctrl-C.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Froude(error) if error.was_stopped() => STOPPED,
            Self::Froude(error) => 1 + u8::from(error.is_bad_input()),
            Self::Stopped(_) => STOPPED,
            Self::Part(_) => 1,
            _ => 2,
        }
    }
}
