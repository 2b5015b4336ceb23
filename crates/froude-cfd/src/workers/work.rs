//! One case, done once: what a worker does, on this machine or in a queue's job.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::case::Case;
use crate::lock::Lock;
use crate::outcome::{Outcome, Status};
use crate::result::{self, Attempted};
use crate::store::{State, Store};
use crate::store_error::StoreError;
use crate::wall;
use crate::{evidence, orphans};

/// What turns a case into its outcome: OpenFOAM, or a test's stand-in.
pub trait Solve: Sync {
    /// Solves a case in the empty folder of an attempt, and returns soon after `cancel` is set, with all its processes ended.
    ///
    /// # Errors
    ///
    /// Why there is no outcome, in words; it becomes the reason of a failed case.
    fn solve(&self, task: &Task<'_>) -> Result<Outcome, String>;
}

/// What a solver is given.
pub struct Task<'a> {
    /// The case.
    pub case: &'a Case,
    /// Folder of its mesh.
    pub mesh: &'a Path,
    /// Folder of the attempt whose last fields it starts from; `None`: from the inflow.
    pub start_from: Option<&'a Path>,
    /// Folder to work in.
    pub attempt: &'a Path,
    /// Set when the case is to end at once.
    pub cancel: &'a AtomicBool,
    /// Takes the number of iterations done.
    pub tell: &'a (dyn Fn(usize) + Sync),
}

/// How a worker came away from a case.
#[derive(Debug, Clone, PartialEq)]
pub enum Worked {
    /// This worker's result counts, or one that a killed worker left.
    Accepted(Attempted),
    /// The case had a result before.
    Already(Attempted),
    /// It was cancelled, and has none.
    Cancelled,
}

/// Does a case: takes its lock, waiting for `patience` where another has it, solves it in a new attempt, and accepts the result.
///
/// A solver that fails or panics gives a failed result; what is cancelled gives none. A job on a cluster needs more patience than [`DEAD_AFTER`](crate::lock::DEAD_AFTER): the node that had the case before may just have died. `begun` takes the number of the attempt and the case that it starts from, `tell` the iterations done.
///
/// # Errors
///
/// [`StoreError::Held`] if another worker has the case. [`StoreError::Refused`] if one of its files was changed or its folder cannot be written (a full disk); the case then counts as interrupted.
pub fn work(
    store: &Store,
    id: &str,
    solver: &dyn Solve,
    patience: Duration,
    cancel: &AtomicBool,
    begun: &dyn Fn(u32, Option<&str>),
    tell: &(dyn Fn(usize) + Sync),
) -> Result<Worked, StoreError> {
    let case = store.case(id)?;
    let folder = store.case_folder(id);
    if let Some(attempted) = result::accepted(&folder, &case)? {
        return Ok(Worked::Already(attempted));
    }
    let _lock = Lock::wait(&folder, patience)?;
    if let Some(attempted) = result::accepted(&folder, &case)? {
        return Ok(Worked::Already(attempted));
    }
    if let Some(attempted) = result::left_over(&folder, &case)? {
        return settled(&folder, &case, attempted);
    }
    if cancel.load(Ordering::SeqCst) {
        return Ok(Worked::Cancelled);
    }
    for dead in result::open_attempts(&folder)? {
        orphans::end(&result::attempt_folder(&folder, dead));
    }
    let (start_from, note) = start(store, &case);
    let (attempt, place) = result::begin(&folder)?;
    begun(attempt, start_from.as_ref().map(|(id, _)| id.as_str()));
    let task = Task {
        case: &case,
        mesh: &store.mesh_folder(&case),
        start_from: start_from.as_ref().map(|(_, path)| path.as_path()),
        attempt: &place,
        cancel,
        tell,
    };
    let solved = catch_unwind(AssertUnwindSafe(|| solver.solve(&task)))
        .unwrap_or_else(|panic| Err(format!("the solver's driver broke off: {}", sentence(&*panic))));
    let is_cancelled = cancel.load(Ordering::SeqCst);
    let mut outcome = match solved {
        Ok(outcome) if !is_cancelled || outcome.status.is_usable() => outcome,
        Err(reason) if !is_cancelled => failed(reason),
        Ok(_) | Err(_) => return Ok(Worked::Cancelled),
    };
    outcome.reason += &note;
    if !outcome.status.is_usable() {
        outcome.reason += full_disk(&place);
    }
    outcome.start_from = start_from.map(|(id, _)| id);
    if let Some(numbers) = not_finite(&outcome) {
        outcome = failed(format!("the solver's {numbers} are not finite numbers{note}"));
    }
    outcome = wall::judged(&case, outcome);
    result::let_go(&place);
    let attempted = Attempted { case: case.hash(), attempt, outcome, files: evidence::record(&place) };
    result::write(&folder, &attempted)?;
    settled(&folder, &case, attempted)
}

/// Accepts a result, or takes the one that came before it.
fn settled(folder: &Path, case: &Case, attempted: Attempted) -> Result<Worked, StoreError> {
    if result::accept(folder, attempted.attempt)? {
        return Ok(Worked::Accepted(attempted));
    }
    let before = result::accepted(folder, case)?;
    Ok(before.map_or(Worked::Accepted(attempted), Worked::Already))
}

/// The case whose fields this one starts from with their folder, and what to say where they are not to be had.
fn start(store: &Store, case: &Case) -> (Option<(String, std::path::PathBuf)>, String) {
    let Some(from) = &case.start_from else { return (None, String::new()) };
    match store.fields_of(from) {
        Some(folder) => (Some((from.clone(), folder)), String::new()),
        None => {
            let why = match store.state(from) {
                State::Done(a) if a.outcome.status == Status::Diverged => "diverged",
                State::Done(_) => "failed",
                State::Edited(_) => "was changed by hand",
                _ => "has no result",
            };
            (None, format!("; it started from the inflow, as {from} {why}"))
        }
    }
}

fn failed(reason: String) -> Outcome {
    Outcome {
        status: Status::Failed,
        reason,
        loads: None,
        pressure: None,
        std_iterative: None,
        iterations: 0,
        cpu_s: 0.0,
        y_plus: None,
        mesh: None,
        start_from: None,
        cells: 0,
        solver_version: String::new(),
    }
}

/// Which numbers of an outcome are no numbers.
fn not_finite(outcome: &Outcome) -> Option<&'static str> {
    let is_wrong = |loads: &Option<[f64; 6]>| loads.is_some_and(|l| l.iter().any(|v| !v.is_finite()));
    match outcome {
        o if is_wrong(&o.loads) || is_wrong(&o.pressure) => Some("loads"),
        o if is_wrong(&o.std_iterative) => Some("standard deviations"),
        o if o.y_plus.is_some_and(|y| y.iter().any(|v| !v.is_finite())) => Some("values of y+"),
        o if !o.cpu_s.is_finite() => Some("times"),
        _ => None,
    }
}

/// What to say of a case that failed on a disk that takes nothing more.
fn full_disk(folder: &Path) -> &'static str {
    /// More than what a small file takes, less than what a solver needs.
    const PROBE_BYTES: usize = 256 * 1024;
    let written = tempfile::NamedTempFile::new_in(folder)
        .and_then(|mut file| std::io::Write::write_all(&mut file, &vec![b'\n'; PROBE_BYTES]));
    match written {
        Err(e) if is_full(&e) => "; the disk is full: make room, and let froude cfd retry compute the case again",
        _ => "",
    }
}

fn is_full(error: &std::io::Error) -> bool {
    use std::io::ErrorKind::{QuotaExceeded, StorageFull};
    matches!(error.kind(), StorageFull | QuotaExceeded)
}

fn sentence(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("without a word")
}
