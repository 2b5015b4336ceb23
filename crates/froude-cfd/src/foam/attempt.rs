//! A case's folder while it is solved: its start, runs of the solver one behind another, its end.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use crate::case::Case;
use crate::foam_case::{self, write_dictionary};
use crate::foam_error::FoamError;
use crate::foam_mesh::FoamMesh;
use crate::foam_system::{self, Pace};
use crate::history;
use crate::input;
use crate::openfoam::{End, OpenFoam, OpenFoamError};
use crate::solver_log::SolverLog;
use crate::warm;

/// Log of the solver in a case's folder.
pub const SOLVER_LOG: &str = "log.solver";
/// Log of the programs around it.
const PARTS_LOG: &str = "log.parts";
/// Programs are looked after 50 times a second, and forces told of twice.
const LOOKS_A_TELLING: usize = 25;

/// How a case is solved.
pub struct How<'a> {
    /// The programs.
    pub openfoam: &'a OpenFoam,
    /// Ranks of MPI; 1: none.
    pub ranks: usize,
    /// Set from outside: the case ends at once, and has no outcome.
    pub cancel: &'a AtomicBool,
    /// Told some times a second, whenever there are new forces.
    pub tell: &'a (dyn Fn(Progress) + Sync),
}

/// How far a case is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Iterations or steps done.
    pub iteration: usize,
    /// At most.
    pub of: usize,
    /// Force of the water on the whole body, body axes, N.
    pub force_n: [f64; 3],
}

/// Why a case has no outcome.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// Its folder, its mesh, the case it starts from, or what the solver wrote.
    #[error(transparent)]
    File(#[from] FoamError),
    /// A program did not run, or was ended as asked.
    #[error(transparent)]
    Program(#[from] OpenFoamError),
    /// A program around the solver, or a solver in time.
    #[error("{program} did not end as it should ({end:?}); it says: {said}; its log is {log}")]
    Part {
        /// The program.
        program: &'static str,
        /// How it ended.
        end: End,
        /// Its log.
        log: PathBuf,
        /// Its error, or the last line of its log.
        said: String,
    },
}

impl SolveError {
    /// Whether it was ended as asked.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        matches!(self, Self::Program(OpenFoamError::Cancelled { .. }))
    }
}

/// A case in its folder.
pub(crate) struct Attempt<'a> {
    pub case: &'a Case,
    pub mesh: FoamMesh,
    pub folder: &'a Path,
    pub how: &'a How<'a>,
    pace: Pace,
    /// Iterations or steps at most.
    most: usize,
}

impl<'a> Attempt<'a> {
    /// Writes the case into an empty folder, with its start, and divides it among ranks.
    pub fn begin(
        case: &'a Case,
        mesh: &Path,
        start_from: Option<&Path>,
        folder: &'a Path,
        how: &'a How,
        pace: Pace,
        most: usize,
    ) -> Result<Self, SolveError> {
        let mesh = foam_case::write(case, mesh, folder, pace)?;
        if let Some(other) = start_from {
            warm::write(case, &mesh, other, folder)?;
        }
        let attempt = Self { case, mesh, folder, how, pace, most };
        if how.ranks > 1 {
            attempt.write_control([0.0, 1.0])?;
            write_dictionary(folder, "system/decomposeParDict", &foam_system::decomposition(how.ranks))?;
            attempt.part("decomposePar", &["-force"])?;
        }
        Ok(attempt)
    }

    /// Runs the solver from one iteration or time to another, tells of forces on the way, and leaves the fields of the last.
    pub fn run(&self, span: [f64; 2]) -> Result<End, SolveError> {
        self.write_control(span)?;
        let (mut looks, mut told) = (0_usize, 0);
        let mut look = || {
            looks += 1;
            if !looks.is_multiple_of(LOOKS_A_TELLING) {
                return;
            }
            // Whatever is wrong with the forces is found when they are judged.
            let samples = history::read(self.folder, self.case.is_half).unwrap_or_default();
            if let Some(last) = samples.last().filter(|_| samples.len() > told) {
                told = samples.len();
                let [x, y, z, ..] = last.total();
                (self.how.tell)(Progress { iteration: told, of: self.most, force_n: [x, y, z] });
            }
        };
        let How { openfoam, ranks, cancel, .. } = *self.how;
        let end = openfoam.run(self.pace.program(), &[], ranks, self.folder, SOLVER_LOG, cancel, &mut look)?;
        self.remove_earlier_times(ranks)?;
        Ok(end)
    }

    /// Runs a solver in time to the end, and brings the ranks' fields together: what the solver said.
    pub fn run_until(&self, time_s: f64) -> Result<SolverLog, SolveError> {
        let end = self.run([0.0, time_s])?;
        let log = self.log()?;
        if end != End::Whole {
            return Err(self.failed(end, log.fatal.unwrap_or_else(|| "nothing".to_owned())));
        }
        self.end()?;
        Ok(log)
    }

    /// That the solver did not do what it was to do.
    pub fn failed(&self, end: End, said: String) -> SolveError {
        SolveError::Part { program: self.pace.program(), end, log: self.folder.join(SOLVER_LOG), said }
    }

    /// What the solver said so far.
    pub fn log(&self) -> Result<SolverLog, SolveError> {
        let log = self.folder.join(SOLVER_LOG);
        let text = input::bytes(&log).map_err(|e| FoamError::at(&log, e))?;
        Ok(SolverLog::of(&String::from_utf8_lossy(&text)))
    }

    /// Brings the ranks' fields together.
    pub fn end(&self) -> Result<(), SolveError> {
        if self.how.ranks > 1 {
            self.part("reconstructPar", &["-latestTime"])?;
            for rank in 0..self.how.ranks {
                remove(&self.folder.join(format!("processor{rank}")))?;
            }
            self.remove_earlier_times(1)?;
        }
        Ok(())
    }

    fn write_control(&self, span: [f64; 2]) -> Result<(), FoamError> {
        let control = foam_system::control(self.case, &self.mesh, self.pace, span);
        write_dictionary(self.folder, "system/controlDict", &control)
    }

    /// Runs a program that must succeed.
    fn part(&self, program: &'static str, arguments: &[&str]) -> Result<(), SolveError> {
        let end = self.how.openfoam.run(program, arguments, 1, self.folder, PARTS_LOG, self.how.cancel, &mut || {})?;
        if end == End::Whole {
            return Ok(());
        }
        let log = self.folder.join(PARTS_LOG);
        let text = input::text(&log).unwrap_or_default();
        let last = || text.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("nothing").to_owned();
        Err(SolveError::Part { program, end, log, said: SolverLog::of(&text).fatal.unwrap_or_else(last) })
    }

    /// Leaves the last time of the case, and of each of its ranks, with the fields that a run can start from.
    fn remove_earlier_times(&self, ranks: usize) -> Result<(), FoamError> {
        let mut folders = vec![self.folder.to_owned()];
        if ranks > 1 {
            folders.extend((0..ranks).map(|rank| self.folder.join(format!("processor{rank}"))));
        }
        for folder in folders {
            let mut times = foam_case::times(&folder)?;
            let last = times.pop();
            for (_, path) in times {
                remove(&path)?;
            }
            // The walls' y+ is kept as three numbers, not as a field over all cells.
            let field = last.map(|(_, path)| path.join("yPlus")).filter(|field| field.is_file());
            if let Some(field) = field {
                std::fs::remove_file(&field).map_err(|e| FoamError::at(&field, e))?;
            }
        }
        Ok(())
    }
}

fn remove(folder: &Path) -> Result<(), FoamError> {
    std::fs::remove_dir_all(folder).map_err(|e| FoamError::at(folder, e))
}
