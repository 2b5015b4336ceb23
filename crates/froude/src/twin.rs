//! What a campaign's twins would measure, written where the campaign expects it: tables of sources that have one, logs of those that have runs.
//!
//! A campaign may come from anybody: only its own folder is written into, and a folder of runs is replaced only when nothing but the twin's own
//! files lies in it.

use std::path::{Path, PathBuf};

use froude_identify::method::MethodError;
use froude_identify::runs::first_other;
use froude_identify::simulate::tables::{self, SimulateError};
use froude_records::RecordError;
use froude_records::block::{Block, TableBuilder};
use froude_records::campaign::{Campaign, Input, Source};
use froude_records::folder::UnfinishedFolder;
use froude_records::outcome::Outcome;
use froude_records::output;
use froude_records::text::counted;

use crate::{Error, method};

/// What was written for one source.
struct Written {
    source: String,
    /// The table, or the folder of the runs.
    path: PathBuf,
    /// Observations of the table.
    rows: Option<usize>,
    runs: Option<usize>,
}

/// Writes the tables and the logs of every source that plans some.
///
/// What exists is replaced only when `replace` is true.
///
/// # Errors
///
/// See [`Error`]: a campaign without plan or without `[simulate]`; places outside of the campaign's folder; a folder with other files in it.
pub fn simulate(path: &Path, replace: bool) -> Result<Outcome, Error> {
    let campaign = method::read_campaign(path)?;
    let mut folders = Vec::new();
    for source in campaign.sources.iter().filter(|source| source.plans_runs()) {
        let target = inside(&campaign, source)?;
        let mut all = Vec::new();
        for (method, _) in method::of(source, None)? {
            all.extend(method.simulate(&campaign, source).map_err(Error::Method)?.unwrap_or_default());
        }
        if let Some(other) = first_other(target, |name| all.iter().any(|file| file.name == name))? {
            let what = format!("holds {}, not written by the twin; name another folder in `runs`", other.display());
            return Err(Error::Method(MethodError::input(target, what)));
        }
        if !replace && target.exists() && first_other(target, |_| false)?.is_some() {
            return Err(SimulateError::Exists { path: target.to_owned() }.into());
        }
        let folder = UnfinishedFolder::beside(target)?;
        for file in &all {
            let place = folder.path().join(&file.name);
            std::fs::write(&place, &file.content).map_err(|source| RecordError::output(&place, &source))?;
        }
        let runs = all.iter().filter(|file| Path::new(&file.name).extension().is_some_and(|e| e == "csv")).count();
        let written = Written { source: source.name.clone(), path: target.to_owned(), rows: None, runs: Some(runs) };
        folders.push((folder, written));
    }
    let has_tables = campaign.sources.iter().any(|source| !source.plan.is_empty() && !source.plans_runs());
    let mut out = Vec::new();
    if has_tables || folders.is_empty() {
        let tables = tables::write(path, replace)?;
        out.extend(tables.into_iter().map(|t| Written {
            source: t.source,
            path: t.path,
            rows: Some(t.rows),
            runs: None,
        }));
    }
    for (folder, written) in folders {
        folder.take_place()?;
        out.push(written);
    }
    let t = TableBuilder::new("written", "", &out);
    let table = t.build(vec![
        t.text("source", "", |w| w.source.clone()),
        t.count("rows", "", |w| w.rows),
        t.count("runs", "", |w| w.runs),
        t.text("path", "", |w| w.path.display().to_string()),
    ]);
    let said = out.iter().map(Written::words).collect();
    Ok(Outcome { blocks: vec![table.into(), Block::text("", said)], ..Outcome::default() })
}

impl Written {
    fn words(&self) -> String {
        let rows = self.rows.map(|n| counted(n, "observation", "observations"));
        let count = rows.or(self.runs.map(|n| counted(n, "run", "runs"))).unwrap_or_default();
        format!("{}: {count} in {}", self.source, self.path.display())
    }
}

/// The folder of a source's runs, where it lies below that of the campaign.
fn inside<'a>(campaign: &Campaign, source: &'a Source) -> Result<&'a Path, Error> {
    let Input::Runs { .. } = &source.input else {
        let what = "a plan of runs needs `runs`, the folder that they go to".to_owned();
        return Err(Error::Method(MethodError::Undeclared { place: source.place.to_string(), what }));
    };
    let path = source.input.path();
    output::inside(&campaign.path, path, &source.place, "runs", "froude simulate")?;
    Ok(path)
}
