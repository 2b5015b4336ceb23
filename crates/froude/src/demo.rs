//! `froude demo`: the main job with nothing prepared.
//!
//! Real tow-tank data (UNH RM2, CC BY 4.0) and the snake robot's twin beside the
//! published sets are embedded in the program, written to a folder and run.

use std::path::{Path, PathBuf};

use froude_identify::simulate::tables;
use froude_records::RecordError;
use froude_records::folder::UnfinishedFolder;
use froude_records::outcome::{Outcome, OutputFile};
use froude_records::write::write_atomically;
use include_dir::{Dir, include_dir};

use crate::Error;
use crate::pipeline::{Identified, Job, identify};

static EXAMPLES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../examples");

/// The folders of the demo.
const FOLDERS: [&str; 2] = ["unh-rm2", "mamba"];
/// Its campaigns, in the order in which they run; results lie beside each.
pub const CAMPAIGNS: [&str; 3] = ["unh-rm2/tare.toml", "unh-rm2/rotor.toml", "mamba/campaign.toml"];

/// Writes the example campaigns into `folder` and runs them; `progress` receives each step.
///
/// All of it grows beside the folder and takes its place at the end: a demo that fails leaves nothing.
///
/// # Errors
///
/// A folder that is not empty or cannot be written; anything that [`identify`] finds.
pub fn run(folder: &Path, date: Option<String>, progress: &dyn Fn(&str)) -> Result<Outcome, Error> {
    if std::fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
        return Err(Error::NotEmpty { path: folder.to_owned() });
    }
    let unfinished = UnfinishedFolder::beside(folder)?;
    let outcomes = build(unfinished.path(), date, progress).map_err(|e| e.in_finished(unfinished.path(), folder))?;
    let mut all = Outcome { findings: Some(Vec::new()), ..Outcome::default() };
    for Outcome { blocks, findings, records, files, .. } in outcomes.into_iter().map(Identified::outcome) {
        all.blocks.extend(blocks);
        all.findings.iter_mut().for_each(|all| all.extend(findings.clone().unwrap_or_default()));
        all.records.extend(records);
        let finished = |path: &Path| {
            path.strip_prefix(unfinished.path()).map_or_else(|_| path.to_owned(), |inside| folder.join(inside))
        };
        all.files.extend(files.into_iter().map(|file| OutputFile { path: finished(&file.path), ..file }));
    }
    unfinished.take_place()?;
    Ok(all)
}

fn build(folder: &Path, date: Option<String>, progress: &dyn Fn(&str)) -> Result<Vec<Identified>, Error> {
    for name in FOLDERS {
        progress(&format!("writing {name}"));
        if let Some(dir) = EXAMPLES.get_dir(name) {
            write_files(dir, folder)?;
        }
    }
    progress("mamba: simulating the circulation tank");
    tables::write(&folder.join("mamba/campaign.toml"), true)?;
    CAMPAIGNS
        .iter()
        .map(|name| {
            let mut job = Job::new(folder.join(name));
            job.date.clone_from(&date);
            identify(&job, &|step| progress(&format!("{name}: {step}")))
        })
        .collect()
}

fn write_files(dir: &Dir<'_>, folder: &Path) -> Result<(), Error> {
    for file in dir.files() {
        let path: PathBuf = folder.join(file.path());
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(|source| RecordError::output(parent, &source))?;
        }
        write_atomically(&path, file.contents())?;
    }
    dir.dirs().try_for_each(|inner| write_files(inner, folder))
}
