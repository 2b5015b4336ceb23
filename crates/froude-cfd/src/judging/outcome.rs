//! What a case came to.

use serde::{Deserialize, Serialize};

use crate::wall::MeshQuality;

/// How a case ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The forces stand still.
    Converged,
    /// They go to and fro about a mean that stands still.
    Oscillating,
    /// They drift, grow, or the field does.
    Diverged,
    /// The solver did not end, or wrote no forces.
    Failed,
}

impl Status {
    /// As it stands in tables.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Oscillating => "oscillating",
            Self::Diverged => "diverged",
            Self::Failed => "failed",
        }
    }

    /// Whether its forces may reach a fit.
    #[must_use]
    pub fn is_usable(self) -> bool {
        matches!(self, Self::Converged | Self::Oscillating)
    }
}

/// Six loads of the water on the whole body, in its axes: N, and N m about the reference point.
pub type Loads = [f64; 6];

/// What a case came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// Why, in words with numbers.
    pub reason: String,
    /// Mean over the window; `None` of a case that failed.
    pub loads: Option<Loads>,
    /// The part of it by pressure.
    pub pressure: Option<Loads>,
    /// Standard deviation of the iterative error: that of the mean over the window, with its drift.
    pub std_iterative: Option<Loads>,
    /// Iterations that it ran.
    pub iterations: usize,
    /// Time of processors, s.
    pub cpu_s: f64,
    /// Least, mean and largest y+; `None` where no wall has one.
    pub y_plus: Option<[f64; 3]>,
    /// Quality of its mesh; `None` of results that were written without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshQuality>,
    /// Case that it started from; `None`: the inflow.
    pub start_from: Option<String>,
    /// Cells of its mesh.
    pub cells: usize,
    /// Of the solver, as it prints it.
    pub solver_version: String,
}
