//! What was done to the data of the runs, as a table of the report.

use froude_records::estimate::DataFile;
use froude_records::page::{DocumentSection, TextTable};
use froude_records::run::step::Step;
use froude_records::text::counted;

/// One row: what was done alike to several runs.
struct Row<'a> {
    step: &'a Step,
    /// Runs that it was done to.
    runs: usize,
    /// Whether every run has words, and so numbers, of its own.
    differs: bool,
}

/// The steps of all files, those of one kind and channel once; `None` where none is stated.
pub fn section<'a>(files: impl Iterator<Item = &'a DataFile>) -> Option<DocumentSection> {
    let mut rows: Vec<Row<'_>> = Vec::new();
    let mut logs = 0;
    for file in files.filter(|file| !file.steps.is_empty()) {
        logs += 1;
        let mut seen: Vec<usize> = Vec::new();
        for step in &file.steps {
            let is_alike = |row: &Row<'_>| row.step.step == step.step && row.step.channel == step.channel;
            if let Some(at) = rows.iter().position(is_alike) {
                rows[at].differs |= rows[at].step.words != step.words;
                if !seen.contains(&at) {
                    rows[at].runs += 1;
                    seen.push(at);
                }
            } else {
                seen.push(rows.len());
                rows.push(Row { step, runs: 1, differs: false });
            }
        }
    }
    let of = |row: &Row<'_>| {
        let words = &row.step.words;
        let words = if row.differs {
            format!("{words} (the first of them; each with its own numbers in the record)")
        } else {
            words.clone()
        };
        let channel = if row.step.channel.is_empty() { "all".to_owned() } else { row.step.channel.clone() };
        vec![row.step.step.clone(), channel, words, row.runs.to_string()]
    };
    (!rows.is_empty()).then(|| DocumentSection {
        title: "Steps".to_owned(),
        paragraphs: vec!["What was done to the data before anything was fitted, in this order. The record has every step of every run with its numbers.".to_owned()],
        tables: vec![TextTable {
            caption: format!("Steps from {} to channels in SI.", counted(logs, "log", "logs")),
            head: ["step", "channel", "what was done", "runs"].map(str::to_owned).to_vec(),
            rows: rows.iter().map(of).collect(),
        }],
        ..DocumentSection::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(steps: &[(&str, &str, &str)]) -> DataFile {
        let steps = steps.iter().map(|(step, channel, words)| Step::new(step, channel, *words)).collect();
        DataFile { steps, ..DataFile::default() }
    }

    #[test]
    fn alike_steps_are_one_row_and_numbers_of_their_own_are_said() {
        let files = [
            file(&[("read", "f_x", "column a"), ("window", "", "1 s to 2 s"), ("mark", "", "x"), ("mark", "", "y")]),
            file(&[("read", "f_x", "column a"), ("window", "", "3 s to 4 s")]),
            file(&[]),
        ];
        let section = section(files.iter()).unwrap();
        let rows: Vec<(&str, &str)> = section.tables[0].rows.iter().map(|r| (r[0].as_str(), r[3].as_str())).collect();
        assert_eq!(rows, [("read", "2"), ("window", "2"), ("mark", "1")]);
        assert_eq!(section.tables[0].rows[0][2], "column a");
        assert!(section.tables[0].rows[1][2].starts_with("1 s to 2 s (the first of them"));
        assert!(super::section([file(&[])].iter()).is_none());
    }
}
