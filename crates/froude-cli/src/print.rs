//! Results as a person reads them, and as JSON.

use froude::records::block::Block;
use froude::records::outcome::{Exit, Outcome};
use froude::records::text::visible_json;
use froude::report::{csv, terminal};

use crate::failure::Failure;
use crate::out::{note, say};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// For people.
    Lines,
    Json,
    Csv,
}

pub fn answer(answer: &Outcome, form: Form) -> Result<(), Failure> {
    answer_with(answer, form, false)
}

pub fn answer_with(answer: &Outcome, form: Form, has_details: bool) -> Result<(), Failure> {
    match form {
        Form::Json => {
            let unwritten = |error| Failure::refused(format_args!("the result cannot be written as JSON: {error}"));
            // As JSON's own escapes: what a program reads is the same.
            say!("{}", visible_json(&serde_json::to_string_pretty(&answer.json()).map_err(unwritten)?));
        }
        Form::Csv => {
            say!("{}", csv::tables(answer).trim_end());
            for line in answer.findings.iter().flat_map(|found| terminal::findings(found)) {
                note!("{line}");
            }
        }
        Form::Lines => told(answer, has_details),
    }
    match &answer.exit {
        Exit::Done => Ok(()),
        Exit::Failed(why) => Err(Failure::Part(why.clone())),
        Exit::Refused(why) => Err(Failure::Refused(why.clone())),
        Exit::Stopped(why) => Err(Failure::Stopped(why.clone())),
    }
}

fn told(answer: &Outcome, has_details: bool) {
    blocks(&answer.blocks, has_details);
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

pub fn blocks(all: &[Block], has_details: bool) {
    lines(&terminal::blocks(all, has_details));
}

fn lines(all: &[String]) {
    for line in all {
        say!("{line}");
    }
}
