//! What is doubtful about a log.

use crate::finding::{Finding, Severity};

/// Faults of a log as a whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Doubt {
    /// What sort of thing.
    pub kind: DoubtKind,
    /// The sentence a person reads; it names the file.
    pub text: String,
}

/// Sort of a doubt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DoubtKind {
    /// Cut off, or changed: its bytes are not those that were recorded.
    Damaged,
    /// A whole log, but of another run, another campaign or another drive than its sidecar.
    Exchanged,
    /// No sidecar lies beside it.
    NoSidecar,
    /// Its sidecar does not say what bytes it should have.
    NoFingerprint,
    /// Its file has another name than its run.
    Renamed,
    /// Its sidecar says something else than the log itself: a person edited it.
    Edited,
}

impl Doubt {
    /// The same as a finding: damage and exchange are errors, an edit is a note.
    #[must_use]
    pub fn finding(&self) -> Finding {
        let (severity, code) = match self.kind {
            DoubtKind::Damaged => (Severity::Error, "run-damaged"),
            DoubtKind::Exchanged => (Severity::Error, "run-exchanged"),
            DoubtKind::NoSidecar => (Severity::Warning, "run-without-sidecar"),
            DoubtKind::NoFingerprint => (Severity::Warning, "run-without-hash"),
            DoubtKind::Renamed => (Severity::Warning, "run-renamed"),
            DoubtKind::Edited => (Severity::Note, "run-edited"),
        };
        Finding::new(severity, code, self.text.clone())
    }
}
