//! A log as the methods of the tank use it.

use froude_records::finding::Finding;
use froude_records::run::step::Step;
use froude_records::run::{Declarations, ImportedRun, RunLog, TimeSteps, Told};
use indexmap::IndexMap;

use crate::extremes::Extremes;

/// A log with what is declared of its data, and what was done to them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TankLog {
    /// The run; its gaps are where ticks are missing.
    pub log: RunLog,
    /// How even its time steps are.
    pub steps: TimeSteps,
    /// What was done to a log that is too long to be held; `None` of one that is as it was recorded.
    pub averaged: Option<Averaged>,
    /// Extremes, as they were recorded, of the channels whose samples are others: means, or readings moved to other times.
    pub recorded: IndexMap<String, Extremes>,
    /// What a reader should know.
    pub findings: Vec<Finding>,
    /// What its sidecar declares of the channels, by the channel's name.
    pub told: IndexMap<String, Told>,
    /// What it declares of the data beside them.
    pub declared: Declarations,
    /// What was done to the data, in order.
    pub done: Vec<Step>,
}

/// A log whose rows are means of the rows recorded; its time steps and gaps are those of the rows recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Averaged {
    /// Rows recorded.
    pub rows: usize,
    /// Rows in a block.
    pub block_rows: usize,
    /// Rows of blocks that a gap or the end of the log cut, which are left out.
    pub left_out: usize,
}

impl From<ImportedRun> for TankLog {
    fn from(ImportedRun { log, steps, findings, told, declared, done }: ImportedRun) -> Self {
        Self { log, steps, findings, told, declared, done, ..Self::default() }
    }
}
