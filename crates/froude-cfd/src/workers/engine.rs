//! What works through a campaign: this machine, or a Slurm cluster.

pub(crate) mod board;
pub mod local;
pub mod slurm;
pub(crate) mod slurm_ledger;
pub mod slurm_options;
pub(crate) mod slurm_queue;

use std::collections::BTreeMap;

use crate::outcome::{Outcome, Status};

/// What happens while a campaign runs.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// An attempt at a case begins.
    Started {
        /// The case.
        id: String,
        /// Number of the attempt, from 1.
        attempt: u32,
        /// The case whose fields it starts from.
        start_from: Option<String>,
    },
    /// A case has done so many iterations.
    Iterated {
        /// The case.
        id: String,
        /// How many.
        iterations: usize,
    },
    /// A case has its result.
    Ended {
        /// The case.
        id: String,
        /// Its result.
        outcome: Box<Outcome>,
    },
    /// A case is left without one.
    Left {
        /// The case.
        id: String,
        /// Why.
        reason: String,
    },
    /// Something that concerns the campaign and not one case.
    Told(String),
    /// How far the campaign is; after each case.
    Counted(Progress),
}

/// How far a campaign is.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Progress {
    /// Cases with a result of each kind.
    pub done: BTreeMap<Status, usize>,
    /// Cases that somebody is at.
    pub running: usize,
    /// Cases that nobody has begun.
    pub waiting: usize,
    /// Cases that this run leaves without a result.
    pub left: usize,
    /// Time of processors that the cases without a result still take, s, by what those with one took.
    pub left_cpu_s: f64,
}

/// How a run of a campaign ended.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ran {
    /// How far the campaign is now.
    pub progress: Progress,
    /// Cases that this run left without a result, and why.
    pub left: Vec<(String, String)>,
    /// Whether it was cancelled.
    pub was_cancelled: bool,
}
