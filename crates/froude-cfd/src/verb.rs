//! `froude cfd`: a campaign of flow computations, planned, run on a laptop or a cluster, and collected into a table that `froude identify` reads.

mod asked;
mod bodies;
mod collect;
mod computed;
mod error;
mod findings;
mod loads;
mod meshes;
mod numerical;
mod plan;
mod report;
mod run;
mod status;
mod suggest;
mod swing;

use std::path::Path;

use froude_records::block::{Block, TableBuilder};
use froude_records::outcome::Outcome;

use self::asked::Asked;
use self::collect::collected;
use crate::store::Store;

pub use self::computed::Computed;
pub(crate) use self::computed::is_of_a_rig;
pub use self::error::VerbError;
pub(crate) use self::loads::{LOADS, unit};
pub use self::plan::plan;
pub use self::report::report;
pub use self::run::{Engine, Job, Running, SlurmOptions, run, run_case};
pub use self::status::status;
pub use self::suggest::suggest;
pub use self::swing::{Planned, SwungRun, swing};

/// Collects a campaign and writes its table.
///
/// # Errors
///
/// As the campaign is read; no case has a result that counts; the table cannot be written.
pub fn collect(campaign: &Path, source: Option<&str>) -> Result<Outcome, VerbError> {
    let found = collected(campaign, source)?;
    Ok(Outcome { blocks: found.blocks(), findings: Some(findings::of_collected(&found)), ..Outcome::default() })
}

/// Puts cases that failed or diverged back among those to compute, all of them or by name.
///
/// # Errors
///
/// As the campaign is read; a case that it does not have, or whose result counts; another process runs it.
pub fn retry(campaign: &Path, source: Option<&str>, named: &[String]) -> Result<Outcome, VerbError> {
    let asked = Asked::read(campaign, source)?;
    let again = crate::retry::retry(&Store::open(&asked.folder)?, named)?;
    let next = format!("{} to be computed again: froude cfd run {}", again.len(), campaign.display());
    let t = TableBuilder::new("cases", "", &again);
    let table = t.build(vec![t.text("case", "case", |id: &String| id.clone())]);
    Ok(Outcome { blocks: vec![table.into(), Block::text("", vec![next])], ..Outcome::default() })
}
