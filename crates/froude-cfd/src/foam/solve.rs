//! A whole steady case in a folder of its own: written, solved, judged.
//!
//! The solver runs in slices of half a window, and the forces are judged between them. So a case ends at the same iteration on any machine, whatever else that machine does. A restart costs the reading of the mesh, and stirs forces for some iterations: by 1e-5 of a bluff body's, by 1e-3 of ½ρU²A at most where pressure acts on a large flat face.

use std::path::Path;

use crate::attempt::Attempt;
pub use crate::attempt::{How, Progress, SOLVER_LOG, SolveError};
use crate::case::Case;
use crate::foam_system::Pace;
use crate::history;
use crate::judge::{Evidence, Judgement, judge};
use crate::openfoam::End;
use crate::outcome::Outcome;
use crate::solver_log::{fastest, y_plus};
use crate::wall::MeshQuality;

/// Solves a case in an empty folder.
///
/// `mesh` is the folder of the points, faces and boundary; `start_from` the folder that another case on the same mesh was solved in, whose last fields this one starts from. The folder keeps what was asked (`system`, `constant`), what came out (`postProcessing`, logs) and the fields of the last iteration, from which other cases can start.
///
/// # Errors
///
/// [`SolveError`]: nothing could be judged. A solver that fails is none: its outcome says it.
pub fn solve(
    case: &Case,
    mesh: &Path,
    start_from: Option<&Path>,
    folder: &Path,
    how: &How,
) -> Result<Outcome, SolveError> {
    let most = case.stop.iterations;
    let attempt = Attempt::begin(case, mesh, start_from, folder, how, Pace::Steady, most)?;
    let slice = (case.stop.window / 2).max(1);
    let mut until = 0;
    let judgement = loop {
        let from = until;
        until = if from == 0 { 2 * slice } else { from + slice }.min(most);
        let end = attempt.run([from as f64, until as f64])?;
        let judgement = judged(&attempt, end, until)?;
        if judgement.is_final || until == most {
            break judgement;
        }
    };
    attempt.end()?;
    Ok(Outcome {
        status: judgement.status,
        reason: judgement.reason,
        loads: judgement.window.map(|window| window.mean),
        pressure: judgement.window.map(|window| window.pressure),
        std_iterative: judgement.window.map(|window| window.std_of_mean),
        iterations: history::read(folder, case.is_half)?.len(),
        cpu_s: attempt.log()?.cpu_s * how.ranks as f64,
        y_plus: y_plus(folder)?,
        mesh: MeshQuality::read(mesh),
        start_from: start_from.and(case.start_from.clone()),
        cells: attempt.mesh.cells,
        solver_version: how.openfoam.version.clone(),
    })
}

fn judged(attempt: &Attempt, end: End, until: usize) -> Result<Judgement, SolveError> {
    let samples = history::read(attempt.folder, attempt.case.is_half)?;
    let (fastest, log) = (fastest(attempt.folder)?, attempt.log()?);
    Ok(judge(attempt.case, Evidence { samples: &samples, log: &log, fastest: &fastest, end, until }))
}
