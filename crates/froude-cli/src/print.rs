//! Results as a person reads them, and as JSON.

use froude::records::block::Block;
use froude::records::outcome::{Exit, Outcome};
use froude::records::text::visible_json;
use froude::report::terminal;

use crate::failure::Failure;
use crate::out::say;

/// One JSON document on standard output.
pub fn json<T: serde::Serialize>(value: &T) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(Failure::Json)?;
    // As JSON's own escapes: what a program reads is the same.
    say!("{}", visible_json(&text));
    Ok(())
}

/// What a verb returns, for a person or as one JSON document.
pub fn answer(answer: &Outcome, is_json: bool) -> Result<(), Failure> {
    answer_with(answer, is_json, false)
}

/// The same; `has_details` where a person asks for details too.
pub fn answer_with(answer: &Outcome, is_json: bool, has_details: bool) -> Result<(), Failure> {
    if is_json {
        json(&answer.json())?;
    } else {
        lines(&terminal::blocks(&answer.blocks, has_details));
        if let Some(found) = &answer.findings {
            say!("");
            lines(&terminal::findings(found));
        }
        if !answer.files.is_empty() {
            say!("");
        }
        for file in &answer.files {
            say!("{:<9} {}", file.key.trim_end_matches("[]"), file.path.display());
        }
    }
    match &answer.exit {
        Exit::Done => Ok(()),
        Exit::Failed(why) => Err(Failure::Part(why.clone())),
        Exit::Refused(why) => Err(Failure::Refused(why.clone())),
        Exit::Stopped(why) => Err(Failure::Stopped(why.clone())),
    }
}

/// Blocks before an answer is whole.
pub fn blocks(all: &[Block]) {
    lines(&terminal::blocks(all, false));
}

fn lines(all: &[String]) {
    for line in all {
        say!("{line}");
    }
}
