//! Short ways to write a warning and a note.

use froude_records::finding::{Finding, Severity};

pub(crate) fn warning(code: &str, message: String) -> Finding {
    Finding::new(Severity::Warning, code, message)
}

pub(crate) fn note(code: &str, message: String) -> Finding {
    Finding::new(Severity::Note, code, message)
}
