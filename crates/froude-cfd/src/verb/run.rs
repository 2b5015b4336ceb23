//! `froude cfd run` and `froude cfd case`: cases through OpenFOAM.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use froude_records::block::{Block, TableBuilder, facts};
use froude_records::number::duration;
use froude_records::outcome::{Exit, Outcome};
use froude_records::text::counted;

use super::error::VerbError;
use super::plan::planned;
use crate::engine::slurm;
pub use crate::engine::slurm::SlurmOptions;
use crate::engine::{Event, Progress, Ran, local};
use crate::foam_solver::FoamSolver;
use crate::openfoam::OpenFoam;
use crate::store::Store;
use crate::work::{Worked, work};

/// How long a job of a queue waits for another that has its case.
const PATIENCE: Duration = Duration::from_mins(4);
/// Least time between two looks at what runs.
const LOOK: Duration = Duration::from_millis(200);

/// What computes.
#[derive(Debug, Clone, PartialEq)]
pub enum Engine {
    /// This machine: cases side by side, each on so many processors.
    Local {
        /// Cases.
        jobs: usize,
        /// Processors of each.
        ranks: usize,
    },
    /// A cluster that shares the campaign's folder.
    Slurm(SlurmOptions),
}

/// What is to be run.
#[derive(Debug, Clone)]
pub struct Job {
    /// The campaign.
    pub campaign: PathBuf,
    /// Its source, where several have cases.
    pub source: Option<String>,
    /// What computes.
    pub engine: Engine,
}

/// Plans a campaign and computes what has no result yet.
///
/// # Errors
///
/// As [`super::plan`]; OpenFOAM is not installed; another process runs the campaign.
pub fn run(job: &Job, cancel: &AtomicBool, running: &Running<'_>) -> Result<Outcome, VerbError> {
    let programs = OpenFoam::find()?;
    let planned = planned(&job.campaign, job.source.as_deref(), cancel, running.now)?;
    for line in planned.said.iter().cloned().chain(programs.advice()) {
        (running.line)(&line);
    }
    let hears = |event| running.hears(event);
    let ran = match &job.engine {
        Engine::Local { jobs, ranks } => {
            let solver = FoamSolver { openfoam: programs, ranks: *ranks };
            local::run(&planned.store, &solver, *jobs, cancel, &hears)?
        }
        Engine::Slurm(options) => slurm::run(&planned.store, options, cancel, &hears)?,
    };
    Ok(outcome(&ran, job, planned.store.root()))
}

/// Computes one case, by its folder; what it came to, in words.
///
/// # Errors
///
/// A folder that is no case of a campaign; OpenFOAM is not installed; the case is another's, or was edited.
pub fn run_case(folder: &Path, ranks: usize, cancel: &AtomicBool) -> Result<String, VerbError> {
    let programs = OpenFoam::find()?;
    let (store, id) = Store::of_case(folder)?;
    Ok(match work(&store, &id, &FoamSolver { openfoam: programs, ranks }, PATIENCE, cancel, &|_, _| (), &|_| ())? {
        Worked::Accepted(done) => format!("{}: {}", done.outcome.status.word(), done.outcome.reason),
        Worked::Already(done) => format!("has a result already ({})", done.outcome.status.word()),
        Worked::Cancelled => return Err(VerbError::Stopped),
    })
}

/// Who hears how a run goes: what is done now, again and again, and lines that stay.
pub struct Running<'a> {
    now: &'a (dyn Fn(&str) + Sync),
    line: &'a (dyn Fn(&str) + Sync),
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    progress: Progress,
    /// Iterations of what runs.
    iterations: BTreeMap<String, usize>,
    told: Option<Instant>,
}

impl<'a> Running<'a> {
    /// `now` takes the state, `line` what is worth keeping.
    pub fn new(now: &'a (dyn Fn(&str) + Sync), line: &'a (dyn Fn(&str) + Sync)) -> Self {
        Self { now, line, state: Mutex::default() }
    }

    fn hears(&self, event: Event) {
        let mut state = self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        match event {
            Event::Started { id, .. } => {
                state.iterations.insert(id, 0);
            }
            Event::Iterated { id, iterations } => {
                state.iterations.insert(id, iterations);
                if state.told.is_some_and(|told| told.elapsed() < LOOK) {
                    return;
                }
            }
            Event::Ended { id, outcome } => {
                state.iterations.remove(&id);
                if !outcome.status.is_usable() {
                    (self.line)(&format!("{id} {}: {}", outcome.status.word(), outcome.reason));
                }
            }
            Event::Left { id, reason } => {
                state.iterations.remove(&id);
                (self.line)(&format!("{id} has no result: {reason}"));
            }
            Event::Told(text) => (self.line)(&text),
            Event::Counted(progress) => state.progress = progress,
        }
        state.told = Some(Instant::now());
        (self.now)(&state.words());
    }
}

impl State {
    fn words(&self) -> String {
        let p = &self.progress;
        let done: usize = p.done.values().sum();
        let all = done + p.running + p.waiting + p.left;
        let bad: usize = p.done.iter().filter(|(s, _)| !s.is_usable()).map(|(_, n)| n).sum();
        let failing = if bad > 0 { format!(", {bad} failing") } else { String::new() };
        let left =
            if p.left_cpu_s > 0.0 { format!(", {} CPU time left", duration(p.left_cpu_s)) } else { String::new() };
        let now: Vec<String> = self.iterations.iter().take(3).map(|(id, n)| format!("{id} at {n}")).collect();
        format!("{done} of {all} cases done{failing}{left}; {}", now.join(", "))
    }
}

/// How a run ended.
fn outcome(ran: &Ran, job: &Job, folder: &Path) -> Outcome {
    let p = &ran.progress;
    let open = p.running + p.waiting + p.left;
    let mut said = Vec::new();
    if open > 0 {
        said.push(format!("{} no result yet", counted(open, "case has", "cases have")));
    }
    if p.done.iter().any(|(status, n)| !status.is_usable() && *n > 0) {
        said.push(
            "diverged and failed cases are not fitted; froude cfd status shows why, froude cfd retry queues them again"
                .to_owned(),
        );
    }
    let f = facts("", "", ran);
    let about = f.build(vec![
        f.text("folder", "", |_| folder.display().to_string()),
        f.count("open", "", |_| open),
        f.flag("was_cancelled", "", |ran| ran.was_cancelled),
    ]);
    let done = facts("done", format!("cases in {}, by how they ended", folder.display()), ran);
    let done = done.build(p.done.iter().map(|(status, n)| done.count(status.word(), status.word(), |_| *n)).collect());
    let t = TableBuilder::new("left", "", &ran.left);
    let left = t.build(vec![t.text("case", "", |(id, _)| id.clone()), t.text("reason", "", |(_, why)| why.clone())]);
    let exit = if ran.was_cancelled { stopped("run", &job.campaign) } else { Exit::Done };
    Outcome { blocks: vec![about.into(), done.into(), left.into(), Block::text("", said)], exit, ..Outcome::default() }
}

/// Of what goes on by the same command.
pub(super) fn stopped(verb: &str, campaign: &Path) -> Exit {
    Exit::Stopped(format!("stopped as requested; nothing is lost: froude cfd {verb} {} resumes it", campaign.display()))
}
