//! Why the program ends without its result: what the library refused, or what cannot be done with what was typed.

use crate::signals::STOPPED;

/// Why the program ends without its result.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The library refused.
    #[error(transparent)]
    Froude(froude::Error),

    /// What was typed cannot be done here, and what to write instead.
    #[error("{0}")]
    Refused(String),

    /// A part of the work is undone.
    #[error("{0}")]
    Part(String),

    /// Stopped as asked.
    #[error("{0}")]
    Stopped(String),
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
    /// Refused in the words of an error.
    pub fn refused(why: impl std::fmt::Display) -> Self {
        Self::Refused(why.to_string())
    }

    /// What the program needs of the system is not to be had.
    pub fn system(error: std::io::Error) -> Self {
        Self::refused(format_args!("a system call failed: {error}"))
    }

    /// 2 where the input is at fault, 1 where the machine is, and 130 of what was stopped as asked, as a shell has it after Ctrl-C.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Froude(error) if error.was_stopped() => STOPPED,
            Self::Froude(error) => 1 + u8::from(error.is_bad_input()),
            Self::Stopped(_) => STOPPED,
            Self::Part(_) => 1,
            Self::Refused(_) => 2,
        }
    }
}
