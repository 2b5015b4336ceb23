//! Writes the answer to a question about a file into its sidecar.

use std::path::Path;

use crate::error::RecordError;
use crate::question::Question;
use crate::read;
use crate::write::write_atomically;

/// Writes an answer, counted from 0, into the sidecar: as a new file, or into its `[file]`.
///
/// # Errors
///
/// There is no such answer; the sidecar cannot be read or written.
pub fn settle(question: &Question, answer: usize) -> Result<(), RecordError> {
    let Some(answer) = question.answers.get(answer) else {
        return Err(RecordError::Refused(format!("there are answers 1 to {}", question.answers.len())));
    };
    let lines = format!("{}\n", answer.lines.join("\n"));
    write_atomically(&question.sidecar, with(&existing(&question.sidecar)?, &lines).as_bytes())
}

fn existing(sidecar: &Path) -> Result<String, RecordError> {
    if sidecar.exists() { read::text(sidecar, 1 << 20, "a sidecar") } else { Ok("schema = 1\n".to_owned()) }
}

/// A sidecar with more lines in its `[file]`.
fn with(text: &str, lines: &str) -> String {
    let is_head =
        |line: &str| line.split('#').next().unwrap_or_default().split_whitespace().collect::<String>() == "[file]";
    let mut out: Vec<&str> = text.split_inclusive('\n').collect();
    match out.iter().position(|line| is_head(line)) {
        Some(head) => out.insert(head + 1, lines),
        None if text.is_empty() || text.ends_with('\n') => out.extend(["[file]\n", lines]),
        None => out.extend(["\n[file]\n", lines]),
    }
    out.concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Place;
    use crate::question::{Answer, asked_by};

    #[test]
    fn an_answer_goes_into_a_new_sidecar_or_an_existing_one() {
        let folder = tempfile::tempdir().unwrap();
        let sidecar = folder.path().join("t.toml");
        let answer = |mark: &str| Answer { means: format!("a {mark}"), lines: vec![format!("decimal = \"{mark}\"")] };
        let question = Question {
            problem: "`1,234` can be two numbers".to_owned(),
            sidecar: sidecar.clone(),
            answers: vec![answer(","), answer(".")],
        };
        let written = || std::fs::read_to_string(&sidecar).unwrap();
        settle(&question, 1).unwrap();
        assert_eq!(written(), "schema = 1\n[file]\ndecimal = \".\"\n");
        std::fs::write(&sidecar, "schema = 1\n\n[columns]\n\"a\" = { name = \"time\" }\n").unwrap();
        settle(&question, 0).unwrap();
        assert_eq!(written(), "schema = 1\n\n[columns]\n\"a\" = { name = \"time\" }\n[file]\ndecimal = \",\"\n");
        std::fs::write(&sidecar, "schema = 1\n[ file ]  # how it is written\nseparator = \";\"\n[columns]\n").unwrap();
        settle(&question, 0).unwrap();
        assert_eq!(
            written(),
            "schema = 1\n[ file ]  # how it is written\ndecimal = \",\"\nseparator = \";\"\n[columns]\n"
        );
        assert!(settle(&question, 2).is_err());
        let error = RecordError::Asked { place: Place::whole(&sidecar), question: question.clone() };
        assert_eq!(asked_by(&error), Some(&question));
    }
}
