//! What only a person can decide about a file.

use std::error::Error;
use std::fmt;
use std::path::PathBuf;

/// A question about a file with its possible answers.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// What is to be decided, without the answers.
    pub problem: String,
    /// The sidecar that takes the answer.
    pub sidecar: PathBuf,
    /// The answers; one at least.
    pub answers: Vec<Answer>,
}

/// One way to read a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// What it means, as `1.234`.
    pub means: String,
    /// The keys of `[file]` that say so, a line each.
    pub lines: Vec<String>,
}

impl fmt::Display for Question {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.sidecar.file_name().unwrap_or_default().to_string_lossy();
        write!(f, "{}; write in {name}", self.problem)?;
        for (k, answer) in self.answers.iter().enumerate() {
            let or = if k == 0 { ", " } else { "\nor " };
            write!(f, "{or}for {}:\n  schema = 1\n  [file]\n  {}", answer.means, answer.lines.join("\n  "))?;
        }
        Ok(())
    }
}

impl Error for Question {}

/// The question that an error asks, if it asks one.
#[must_use]
pub fn asked_by<'e>(error: &'e (dyn Error + 'static)) -> Option<&'e Question> {
    match error.downcast_ref() {
        Some(question) => Some(question),
        None => asked_by(error.source()?),
    }
}
