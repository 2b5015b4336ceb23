//! What was done to the data of the runs, as a table of the report.

use froude_records::block::{Block, Section, TableBuilder};
use froude_records::estimate::DataFile;
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
pub fn section<'a>(files: impl Iterator<Item = &'a DataFile>) -> Option<Section> {
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
    let words = |row: &Row<'_>| {
        let words = &row.step.words;
        if row.differs {
            format!("{words} (the first of them; each with its own numbers in the record)")
        } else {
            words.clone()
        }
    };
    let channel = |row: &Row<'_>| if row.step.channel.is_empty() { "all".to_owned() } else { row.step.channel.clone() };
    let t =
        TableBuilder::new("steps", format!("Steps from {} to channels in SI.", counted(logs, "log", "logs")), &rows);
    let table = t.build(vec![
        t.text("step", "step", |row| row.step.step.clone()),
        t.text("channel", "channel", channel),
        t.text("words", "what was done", words),
        t.count("runs", "runs", |row| row.runs),
    ]);
    let said = "What was done to the data before anything was fitted, in this order. The record has every step of every run with its numbers.";
    (!rows.is_empty()).then(|| Section::new("Steps", [Block::words([said.to_owned()]), table.into()]))
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
        let [_, Block::Table(table)] = &section.blocks[..] else { panic!("{section:?}") };
        let row = |i: usize| table.columns.iter().map(|column| column.text(i).unwrap()).collect::<Vec<_>>();
        assert_eq!(row(0), ["read", "f_x", "column a", "2"]);
        assert!(row(1)[2].starts_with("1 s to 2 s (the first of them"));
        assert_eq!((&row(2)[0][..], &row(2)[3][..], table.n_rows), ("mark", "1", 3));
        assert!(super::section([file(&[])].iter()).is_none());
    }
}
