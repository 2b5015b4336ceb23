//! `froude cfd run` and `froude cfd case`: cases through OpenFOAM.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use froude_cfd::engine::slurm;
pub use froude_cfd::engine::slurm::SlurmOptions;
use froude_cfd::engine::{Event, Progress, Ran, local};
use froude_cfd::foam_solver::FoamSolver;
use froude_cfd::openfoam::OpenFoam;
use froude_cfd::store::Store;
use froude_cfd::work::{Worked, work};
use froude_panel::refine::duration;
use froude_records::page::{DocumentSection, TextTable};
use froude_records::text::counted;
use serde_json::{Value, json};

use super::plan::plan;
use crate::Error;

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
/// As [`plan`]; OpenFOAM is not there; another process runs the campaign.
pub fn run(job: &Job, cancel: &AtomicBool, running: &Running<'_>) -> Result<Done, Error> {
    let programs = OpenFoam::find()?;
    let planned = plan(&job.campaign, job.source.as_deref(), cancel, running.now)?;
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
    Ok(Done { was_cancelled: ran.was_cancelled, ran, folder: planned.store.root().to_owned() })
}

/// Computes one case, by its folder; what it came to, in words.
///
/// # Errors
///
/// A folder that is no case of a campaign; OpenFOAM is not there; the case is another's, or was edited.
pub fn run_case(folder: &Path, ranks: usize, cancel: &AtomicBool) -> Result<String, Error> {
    let programs = OpenFoam::find()?;
    let (store, id) = Store::of_case(folder)?;
    Ok(match work(&store, &id, &FoamSolver { openfoam: programs, ranks }, PATIENCE, cancel, &|_, _| (), &|_| ())? {
        Worked::Accepted(done) => format!("{}: {}", done.outcome.status.word(), done.outcome.reason),
        Worked::Already(done) => format!("has a result already ({})", done.outcome.status.word()),
        Worked::Cancelled => return Err(Error::Stopped),
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
        let left = if p.left_cpu_s > 0.0 {
            format!(", {} left of a processor", duration(p.left_cpu_s))
        } else {
            String::new()
        };
        let now: Vec<String> = self.iterations.iter().take(3).map(|(id, n)| format!("{id} at {n}")).collect();
        format!("{done} of {all} cases done{failing}{left}; {}", now.join(", "))
    }
}

/// How a run ended.
#[derive(Debug, Clone)]
pub struct Done {
    ran: Ran,
    folder: PathBuf,
    /// Whether it was stopped.
    pub was_cancelled: bool,
}

impl Done {
    /// What a person reads.
    #[must_use]
    pub fn section(&self) -> DocumentSection {
        let p = &self.ran.progress;
        let open = p.running + p.waiting + p.left;
        let mut paragraphs = Vec::new();
        if open > 0 {
            paragraphs.push(format!("{} no result yet", counted(open, "case has", "cases have")));
        }
        if p.done.iter().any(|(status, n)| !status.is_usable() && *n > 0) {
            paragraphs.push("what diverged or failed reaches no fit; froude cfd status says why of each, froude cfd retry lets the next run compute them again".to_owned());
        }
        DocumentSection {
            title: "Computed".to_owned(),
            paragraphs,
            tables: vec![TextTable {
                caption: format!("cases in {}", self.folder.display()),
                head: ["ended", "cases"].map(str::to_owned).to_vec(),
                rows: p.done.iter().map(|(status, n)| vec![status.word().to_owned(), n.to_string()]).collect(),
            }],
            charts: Vec::new(),
        }
    }

    /// The same for a program.
    #[must_use]
    pub fn as_json(&self) -> Value {
        let p = &self.ran.progress;
        let done: serde_json::Map<String, Value> =
            p.done.iter().map(|(status, n)| (status.word().to_owned(), json!(n))).collect();
        json!({
            "folder": self.folder,
            "done": done,
            "open": p.running + p.waiting + p.left,
            "left": self.ran.left.iter().map(|(id, why)| json!({"case": id, "reason": why})).collect::<Vec<_>>(),
            "was_cancelled": self.was_cancelled,
        })
    }
}
