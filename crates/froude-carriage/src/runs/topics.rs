//! What is in an MCAP log that another program recorded: its topics, and what of it is read. No role, no campaign: nobody declared any.

use std::io::BufReader;
use std::path::Path;

use froude_foreign::{Cells, Column, Part, mcap};
use froude_identify::inspect::Inspection;
use froude_identify::method::MethodError;
use froude_records::finding::{Finding, Severity};
use froude_records::read::open;
use froude_records::text::counted;

/// Its topics, each with messages, rate and fields; what is not read is a note.
///
/// # Errors
///
/// A file that cannot be read.
pub(super) fn inspect(path: &Path) -> Result<Inspection, MethodError> {
    let refuse = |what: String| MethodError::input(path, what);
    let file = open(path)?;
    let bytes = file.metadata().map_err(|e| refuse(format!("cannot be read: {e}")))?.len();
    let contents = mcap::read(&mut BufReader::new(file), bytes).map_err(|e| refuse(e.to_string()))?;
    let mut facts = vec![(
        "log".to_owned(),
        format!("of another program, with {} that can be read", counted(contents.parts.len(), "topic", "topics")),
    )];
    facts.extend(contents.parts.iter().map(|part| (part.name.clone(), described(part))));
    let next = "a sidecar with [columns], and [file] part = \"TOPIC\" where there are several, reads a topic as a table; froude inspect FILE --write-sidecar proposes one";
    facts.push(("next".to_owned(), next.to_owned()));
    let findings = contents.notes.into_iter().map(|note| Finding::new(Severity::Note, "log-topic", note)).collect();
    Ok(Inspection::new("topics", facts, findings))
}

/// `251 messages at 50.0 Hz, 5.000 s: gyro.x, gyro.y`.
fn described(part: &Part) -> String {
    let times = part.columns.iter().find_map(|column| match column {
        Column { name, cells: Cells::Numbers(times), .. } if name == "time" => Some(times.as_slice()),
        _ => None,
    });
    let times = times.unwrap_or_default();
    let duration = match times {
        [first, .., last] if last > first => {
            let span = last - first;
            format!(" at {:.1} Hz, {span:.3} s", (times.len() - 1) as f64 / span)
        }
        _ => String::new(),
    };
    let fields: Vec<&str> =
        part.columns.iter().map(|column| column.name.as_str()).filter(|name| *name != "time").collect();
    format!("{}{duration}: {}", counted(times.len(), "message", "messages"), fields.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_are_listed_with_their_rates_and_nothing_is_invented() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds/foreign_logs/json.mcap");
        let found = inspect(&path).unwrap();
        let fact = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        assert_eq!(found.kind, "topics");
        assert_eq!(
            found.facts[..2],
            [
                fact("log", "of another program, with 2 topics that can be read"),
                fact("/force", "10 messages at 100.0 Hz, 0.090 s: f.x, f.y, raw_0, raw_1"),
            ]
        );
        assert!(
            found.findings.iter().any(|finding| finding.message.starts_with("topic /proto is not read (1 message): "))
        );
    }
}
