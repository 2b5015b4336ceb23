//! OpenFOAM as the solver of a campaign.

use crate::attempt::{How, Progress};
use crate::openfoam::OpenFoam;
use crate::outcome::Outcome;
use crate::solve::solve;
use crate::work::{Solve, Task};

/// OpenFOAM with the ranks of MPI that each case runs on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FoamSolver {
    /// The programs.
    pub openfoam: OpenFoam,
    /// Ranks; 1: no MPI.
    pub ranks: usize,
}

impl Solve for FoamSolver {
    fn solve(&self, task: &Task<'_>) -> Result<Outcome, String> {
        let tell = |progress: Progress| (task.tell)(progress.iteration);
        let how = How { openfoam: &self.openfoam, ranks: self.ranks, cancel: task.cancel, tell: &tell };
        solve(task.case, task.mesh, task.start_from, task.attempt, &how).map_err(|e| e.to_string())
    }
}
