//! `froude cfd status`: how far a campaign is, by its files alone.

use std::path::{Path, PathBuf};

use froude_records::block::{Block, TableBuilder, facts};
use froude_records::number::{bytes, duration, significant};
use froude_records::outcome::Outcome;
use froude_records::text::counted;

use super::asked::{Asked, OUTDATED};
use super::error::VerbError;
use crate::status::{CampaignStatus, Row, Standing};
use crate::store::Store;

/// Rows that a person is shown of those that are open or done as they should be.
const SHOWN: usize = 20;

/// How far a campaign is.
#[derive(Debug, Clone)]
pub(super) struct Standings {
    folder: PathBuf,
    is_outdated: bool,
    found: CampaignStatus,
}

/// Reads how far a campaign is.
///
/// # Errors
///
/// As the campaign is read; a folder that was not planned.
pub fn status(campaign: &Path, source: Option<&str>) -> Result<Outcome, VerbError> {
    let asked = Asked::read(campaign, source)?;
    let blocks = of_store(&Store::open(&asked.folder)?, &asked).blocks();
    Ok(Outcome { blocks, ..Outcome::default() })
}

/// The status of a campaign's folder.
pub(super) fn of_store(store: &Store, asked: &Asked) -> Standings {
    let is_outdated = !store.was_planned_from(&asked.inputs_sha256());
    Standings { found: CampaignStatus::of(store), is_outdated, folder: store.root().to_owned() }
}

impl Standings {
    /// How many cases are in which state.
    pub(super) fn counts(&self) -> String {
        let counts = self.found.counts.iter().map(|(standing, n)| format!("{n} {}", standing.word()));
        format!("{}: {}", counted(self.found.rows.len(), "case", "cases"), counts.collect::<Vec<_>>().join(", "))
    }

    /// What needs attention whole, the others up to a number.
    pub(super) fn blocks(&self) -> Vec<Block> {
        let f = &self.found;
        let needs = |row: &&Row| matches!(row.standing, Standing::Failed | Standing::Diverged | Standing::Edited);
        let shown = f.rows.iter().filter(needs).count().max(SHOWN).min(f.rows.len());
        let about = facts("", "", self);
        let about = about.build(vec![
            about.text("folder", "", |s| s.folder.display().to_string()),
            about.flag("is_outdated", "", |s| s.is_outdated),
            about.number("cpu_s", "", |s| s.found.cpu_s),
            about.number("left_cpu_s", "", |s| s.found.left_cpu_s),
            about.number("s_per_cell_iteration", "", |s| s.found.s_per_cell_iteration),
            about.count("disk_bytes", "", |s| s.found.disk_bytes as usize),
        ]);
        let counts = facts("counts", "", self);
        let of = |(standing, n): (&Standing, &usize)| counts.count(standing.word(), "", |_| *n);
        let counts = counts.build(f.counts.iter().map(of).collect());
        let t = TableBuilder::new("cases", format!("cases in {}", self.folder.display()), &f.rows);
        let mut cases = t.build(vec![
            t.text("case", "case", |row| row.id.clone()),
            t.text("is", "status", |row| row.standing.word().to_owned()),
            t.count("iterations", "iterations", |row| row.iterations),
            t.number("cpu_s", "CPU time", |row| row.cpu_s).duration(),
            t.count("attempts", "attempts", |row| row.attempts),
            t.text("start_from", "starts from", |row| row.start_from.clone().unwrap_or_else(|| "inflow".to_owned())),
            t.text("reason", "reason", |row| row.reason.clone()),
        ]);
        cases.shown_rows = Some((0..shown).collect());
        let mut said = vec![format!(
            "{}; {} CPU time used, {} remaining at {} µs per cell and iteration, {} on disk",
            self.counts(),
            duration(f.cpu_s),
            duration(f.left_cpu_s),
            significant(1e6 * f.s_per_cell_iteration, 2),
            bytes(f.disk_bytes as f64),
        )];
        said.extend(self.is_outdated.then(|| OUTDATED.to_owned()));
        if shown < f.rows.len() {
            said.push(format!("{} more are not shown; --json has all", f.rows.len() - shown));
        }
        vec![about.into(), counts.into(), cases.into(), Block::text("", said)]
    }
}
