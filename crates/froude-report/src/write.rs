//! The files of an outcome: all of them, or none.

use std::io::Write as _;
use std::path::Path;

use froude_records::RecordError;
use froude_records::block::Block;
use froude_records::json::write_estimates;
use froude_records::manifest::take_own_place;
use froude_records::outcome::{Content, Outcome, OutputFile};
use froude_records::results::replace;
use froude_records::table_file::prepare_table;
use froude_records::write::{Prepared, write_atomically};

use crate::error::ReportError;
use crate::outcome::page;
use crate::{chart, field, map};

/// Why the files of an outcome are not written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The folder, or a file in it.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The page.
    #[error(transparent)]
    Report(#[from] ReportError),
}

/// Replaces a folder of results by the files of an outcome, which lie in it.
///
/// # Errors
///
/// A folder that holds what a person wrote, a full disk, a figure that cannot be drawn: what stood there is untouched.
pub fn write_folder(outcome: &Outcome, out: &Path) -> Result<(), WriteError> {
    let fill = |folder: &Path| {
        for file in &outcome.files {
            let path = folder.join(file.path.strip_prefix(out).unwrap_or(&file.path));
            match (&file.content, outcome.records.first()) {
                (Content::Figures, _) => all_figures(outcome, &path)?,
                (Content::Record, Some(record)) => write_estimates(&path, record)?,
                _ => prepared(outcome, file, &path)?.take_place()?,
            }
        }
        Ok(())
    };
    replace(out, |folder| {
        fill(folder).map_err(|error| match error {
            WriteError::Record(error) => error.in_finished(folder, out).into(),
            other @ WriteError::Report(_) => other,
        })
    })
}

fn all_figures(outcome: &Outcome, folder: &Path) -> Result<(), WriteError> {
    let of_report = outcome.report.as_deref().map(crate::figures);
    if of_report.as_ref().is_some_and(Vec::is_empty) {
        return Ok(());
    }
    std::fs::create_dir(folder).map_err(|e| RecordError::output(folder, &e))?;
    let Some(drawn) = of_report else { return figures(&outcome.blocks, folder) };
    for figure in drawn {
        write_atomically(&folder.join(figure.file_name), figure.svg.as_bytes())?;
    }
    Ok(())
}

/// Writes the files of an outcome one by one into a folder that holds others too. All of them are made before the first takes its place.
///
/// # Errors
///
/// As [`write_folder`]; a file in the place of another that Froude did not write.
pub fn write_files(outcome: &Outcome) -> Result<(), WriteError> {
    for folder in outcome.files.iter().filter_map(|file| file.path.parent()) {
        std::fs::create_dir_all(folder).map_err(|e| RecordError::output(folder, &e))?;
    }
    let all = outcome.files.iter().map(|file| prepared(outcome, file, &file.path)).collect::<Result<Vec<_>, _>>()?;
    all.into_iter().try_for_each(take_own_place)?;
    if let Some(scratch) = &outcome.scratch {
        // What is left is found by the next start.
        let _ = std::fs::remove_dir_all(&scratch.folder);
    }
    Ok(())
}

fn figures(blocks: &[Block], folder: &Path) -> Result<(), WriteError> {
    for block in blocks {
        let (name, svg) = match block {
            Block::Chart(chart) => (&chart.name, chart::svg(chart)),
            Block::Map(map) => (&map.name, map::svg(map)?),
            Block::Field(field) => (&field.name, field::svg(field)),
            Block::Section(section) => {
                figures(&section.blocks, folder)?;
                continue;
            }
            Block::Text { .. } | Block::Table(_) | Block::Estimates(_) => continue,
        };
        write_atomically(&folder.join(format!("{name}.svg")), svg.as_bytes())?;
    }
    Ok(())
}

fn prepared(outcome: &Outcome, file: &OutputFile, path: &Path) -> Result<Prepared, WriteError> {
    Ok(match &file.content {
        Content::Page(head) => {
            let page = page(outcome, head)?;
            Prepared::new(path, |out| out.write_all(page.as_bytes()))?
        }
        Content::Result => Prepared::new(path, |out| {
            serde_json::to_writer_pretty(&mut *out, &outcome.result())?;
            writeln!(out)
        })?,
        Content::Report => {
            let page = outcome.report.as_deref().map_or_else(String::new, crate::html);
            Prepared::new(path, |out| out.write_all(page.as_bytes()))?
        }
        Content::Table(table) => prepare_table(table, path)?,
        // Of a folder of their own.
        Content::Figures | Content::Record => Prepared::new(path, |_| Ok(()))?,
        Content::Bytes(bytes) => Prepared::new(path, |out| out.write_all(bytes))?,
    })
}
