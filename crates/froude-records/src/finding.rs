//! What a check found: one sentence, its place, and how grave it is.
//!
//! Findings travel with the estimates into the report; none is silent.

use serde::{Deserialize, Serialize};

/// How grave a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing; nothing was changed because of it.
    Note,
    /// Doubtful: a reader should look before trusting the numbers.
    Warning,
    /// Contradicts physics or the file itself: the numbers should not be used as they are.
    Error,
}

/// One finding of a lint, with the numbers that it rests on inside its sentence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// How grave it is.
    pub severity: Severity,
    /// Short stable name, e.g. `identical-copies`.
    pub code: String,
    /// The sentence a person reads: what was found, what was expected, what to do.
    pub message: String,
    /// The source (of the campaign) that it concerns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// `file:line` where it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
}

impl Finding {
    /// A finding without source and place.
    #[must_use]
    pub fn new(severity: Severity, code: &str, message: String) -> Self {
        Self { severity, code: code.to_owned(), message, source: None, place: None }
    }

    /// The same finding, stated about a source.
    #[must_use]
    pub fn of_source(mut self, source: &str) -> Self {
        self.source = Some(source.to_owned());
        self
    }
}
