//! How far a campaign is, by its files alone: while it runs, and from any host that sees them.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use crate::cost::Cost;
use crate::outcome::Status;
use crate::result;
use crate::store::{State, Store};

/// How far a campaign is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CampaignStatus {
    /// Cases in each state.
    pub counts: BTreeMap<Standing, usize>,
    /// A row for each case: what needs a hand first, then what runs, then in the order of the plan.
    pub rows: Vec<Row>,
    /// Time of a processor for one cell and iteration, s; `None` before a case has ended.
    pub s_per_cell_iteration: f64,
    /// Time of processors that all results took, s.
    pub cpu_s: f64,
    /// Time of processors that the cases without a result are expected to take, s.
    pub left_cpu_s: f64,
    /// Room that the folder takes on the disk, bytes.
    pub disk_bytes: u64,
}

/// State of a case, as a word; in the order of the rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// A file of it is not what was written.
    Edited,
    /// The solver did not end, or wrote no forces.
    Failed,
    /// The forces drift or grow.
    Diverged,
    /// Tried, without a result.
    Interrupted,
    /// Somebody is at it.
    Running,
    /// Nobody has begun it.
    Planned,
    /// The forces go to and fro about a mean.
    Oscillating,
    /// The forces stand still.
    Converged,
}

impl Standing {
    /// As it stands in tables and records.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Edited => "edited",
            Self::Failed => Status::Failed.word(),
            Self::Diverged => Status::Diverged.word(),
            Self::Interrupted => "interrupted",
            Self::Running => "running",
            Self::Planned => "planned",
            Self::Oscillating => Status::Oscillating.word(),
            Self::Converged => Status::Converged.word(),
        }
    }
}

/// A case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Its name.
    pub id: String,
    /// Its state.
    pub standing: Standing,
    /// Why, in words; of a running one, who.
    pub reason: String,
    /// Attempts that were begun.
    pub attempts: usize,
    /// Iterations of its result.
    pub iterations: Option<usize>,
    /// Time of processors of its result, s.
    pub cpu_s: Option<f64>,
    /// The case that it started from, or will; `None`: the inflow.
    pub start_from: Option<String>,
}

impl CampaignStatus {
    /// Reads how far a campaign is.
    #[must_use]
    pub fn of(store: &Store) -> Self {
        let mut cost = Cost::default();
        let mut open = Vec::new();
        let mut rows = Vec::new();
        for id in store.ids() {
            let (case, state) = (store.case(id).ok(), store.state(id));
            if let (Some(case), State::Done(attempted)) = (&case, &state) {
                cost.learn(case, &attempted.outcome);
            }
            let start_from = case.as_ref().and_then(|c| c.start_from.clone());
            let waiting = case.filter(|_| state.is_open());
            if let Some(case) = &waiting {
                cost.knows_mesh_of(store, case);
            }
            open.extend(waiting);
            let attempts = result::attempts(&store.case_folder(id)).map_or(0, |a| a.len());
            rows.push(row(id, state, attempts, start_from));
        }
        rows.sort_by_key(|row: &Row| row.standing.min(Standing::Planned));
        let mut counts = BTreeMap::new();
        for row in &rows {
            *counts.entry(row.standing).or_default() += 1;
        }
        Self {
            counts,
            s_per_cell_iteration: cost.s_per_cell_iteration(),
            cpu_s: rows.iter().filter_map(|r| r.cpu_s).sum(),
            left_cpu_s: open.iter().map(|case| cost.expected_s(case)).sum(),
            disk_bytes: bytes_below(store.root()),
            rows,
        }
    }
}

fn row(id: &str, state: State, attempts: usize, start_from: Option<String>) -> Row {
    let mut row = Row {
        id: id.to_owned(),
        standing: Standing::Planned,
        reason: String::new(),
        attempts,
        iterations: None,
        cpu_s: None,
        start_from,
    };
    match state {
        State::Planned => {}
        State::Running(holder) => {
            row.standing = Standing::Running;
            row.reason = holder.to_string();
        }
        State::Interrupted => {
            row.standing = Standing::Interrupted;
            "its last attempt ended without a result; froude cfd run tries again".clone_into(&mut row.reason);
        }
        State::Edited(why) => {
            row.standing = Standing::Edited;
            row.reason = why;
        }
        State::Done(attempted) => {
            let outcome = attempted.outcome;
            row.standing = match outcome.status {
                Status::Converged => Standing::Converged,
                Status::Oscillating => Standing::Oscillating,
                Status::Diverged => Standing::Diverged,
                Status::Failed => Standing::Failed,
            };
            row.reason = outcome.reason;
            row.iterations = Some(outcome.iterations);
            row.cpu_s = Some(outcome.cpu_s);
            row.start_from = outcome.start_from;
        }
    }
    row
}

/// Of all files below a folder, those that are linked twice counted once for each name; links are not followed.
fn bytes_below(folder: &Path) -> u64 {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .map(|entry| match entry.metadata() {
            Ok(data) if data.is_dir() => bytes_below(&entry.path()),
            Ok(data) if data.is_file() => data.len(),
            _ => 0,
        })
        .sum()
}
