//! `froude cfd status`: how far a campaign is, by its files alone.

use std::path::{Path, PathBuf};

use froude_cfd::status::{CampaignStatus, Row, Standing};
use froude_cfd::store::Store;
use froude_panel::refine::duration;
use froude_records::number::significant;
use froude_records::page::{DocumentSection, TextTable};
use froude_records::text::counted;
use serde_json::{Value, json};

use super::{Asked, OUTDATED};
use crate::Error;

/// Rows that a person is shown of those that are open or done as they should be.
const SHOWN: usize = 20;

/// How far a campaign is.
#[derive(Debug, Clone)]
pub struct Standings {
    folder: PathBuf,
    is_outdated: bool,
    found: CampaignStatus,
}

/// Reads how far a campaign is.
///
/// # Errors
///
/// As the campaign is read; a folder that was not planned.
pub fn status(campaign: &Path, source: Option<&str>) -> Result<Standings, Error> {
    let asked = Asked::read(campaign, source)?;
    Ok(of_store(&Store::open(&asked.folder)?, &asked))
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

    /// What a person reads: what needs attention whole, the others up to a number.
    #[must_use]
    pub fn section(&self) -> DocumentSection {
        let f = &self.found;
        let mut paragraphs = vec![format!(
            "{}; {} of a processor spent, {} left at {} µs a cell and iteration, {} GB on disk",
            self.counts(),
            duration(f.cpu_s),
            duration(f.left_cpu_s),
            significant(1e6 * f.s_per_cell_iteration, 2),
            significant(f.disk_bytes as f64 / 1e9, 2),
        )];
        if self.is_outdated {
            paragraphs.push(OUTDATED.to_owned());
        }
        let needs = |row: &&Row| matches!(row.standing, Standing::Failed | Standing::Diverged | Standing::Edited);
        let troubled = f.rows.iter().filter(needs).count();
        let shown = troubled.max(SHOWN).min(f.rows.len());
        if shown < f.rows.len() {
            paragraphs.push(format!("{} more are not shown; --json has all", f.rows.len() - shown));
        }
        let row = |row: &Row| {
            vec![
                row.id.clone(),
                row.standing.word().to_owned(),
                row.iterations.map_or_else(String::new, |n| n.to_string()),
                row.cpu_s.map_or_else(String::new, duration),
                row.attempts.to_string(),
                row.start_from.clone().unwrap_or_else(|| "inflow".to_owned()),
                row.reason.clone(),
            ]
        };
        let head = ["case", "is", "iterations", "time", "attempts", "starts from", "because"];
        DocumentSection {
            title: "Status".to_owned(),
            paragraphs,
            tables: vec![TextTable {
                caption: format!("cases in {}", self.folder.display()),
                head: head.map(str::to_owned).to_vec(),
                rows: f.rows.iter().take(shown).map(row).collect(),
            }],
            charts: Vec::new(),
        }
    }

    /// The same for a program.
    #[must_use]
    pub fn as_json(&self) -> Value {
        let f = &self.found;
        let counts: serde_json::Map<String, Value> =
            f.counts.iter().map(|(standing, n)| (standing.word().to_owned(), json!(n))).collect();
        json!({
            "folder": self.folder,
            "is_outdated": self.is_outdated,
            "counts": counts,
            "cpu_s": f.cpu_s,
            "left_cpu_s": f.left_cpu_s,
            "s_per_cell_iteration": f.s_per_cell_iteration,
            "disk_bytes": f.disk_bytes,
            "cases": f.rows.iter().map(|row| json!({
                "case": row.id,
                "is": row.standing.word(),
                "reason": row.reason,
                "attempts": row.attempts,
                "iterations": row.iterations,
                "cpu_s": row.cpu_s,
                "start_from": row.start_from,
            })).collect::<Vec<_>>(),
        })
    }
}
