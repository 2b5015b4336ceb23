//! A campaign on a Slurm cluster: arrays of tasks, each of which does some minutes' worth of cases.
//!
//! A task runs this program's `case` on the folders of its cases, and writes their results as a worker on this machine does. Only those decide. The queue is asked whether a task lives; one that is gone while cases of it have no result is submitted again, those cases apart from all others, up to a number of times. Jobs may be requeued, run twice or come late: locks and the accepted result make that harmless.
//!
//! A coordinator that was killed finds what it had submitted in the folder `slurm`, and goes on with it.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::engine::board::{Board, Standing};
use crate::engine::slurm_ledger::Submission;
pub use crate::engine::slurm_options::SlurmOptions;
use crate::engine::slurm_queue::{self, TaskId, TaskState};
use crate::engine::{Event, Ran};
use crate::lock::Lock;
use crate::result;
use crate::store::{State, Store};
use crate::store_error::StoreError;

/// A task counts as gone when the queue does not have it so often in a row: a result may show later than its job ends.
const LOOKS_BEFORE_GONE: usize = 2;
/// Times that nothing can be submitted, with nothing in the queue, before that is an error.
const REFUSALS: usize = 3;

/// Runs all cases without a result as jobs of Slurm, and waits for them.
///
/// Once `cancel` is set the jobs are cancelled. Run again, it goes on where it was, however it ended.
///
/// # Errors
///
/// [`StoreError::Held`] if another process runs this campaign. [`StoreError::Refused`] if Slurm is missing or rejects a job, or if the folder cannot be written.
pub fn run(
    store: &Store,
    options: &SlurmOptions,
    cancel: &AtomicBool,
    tell: &(dyn Fn(Event) + Sync),
) -> Result<Ran, StoreError> {
    let _lock = Lock::take(store.root())?;
    let root = store.root().canonicalize().map_err(|e| StoreError::file(store.root(), e))?;
    let store = &Store::open(&root)?;
    let mut run = Run {
        store,
        options,
        tell,
        board: Board::of(store),
        flights: Vec::new(),
        lost: BTreeMap::new(),
        seen: BTreeSet::new(),
        largest_array: slurm_queue::largest_array()?,
        is_silent: false,
    };
    run.adopt()?;
    let mut refusals = 0;
    loop {
        if cancel.load(Ordering::SeqCst) {
            run.cancel()?;
            return Ok(run.board.ran(true));
        }
        run.look()?;
        if let Err(error) = run.submit() {
            refusals += 1;
            if run.flights.is_empty() && refusals >= REFUSALS {
                return Err(error);
            }
            tell(Event::Told(format!("{error}; it is tried again")));
        } else {
            refusals = 0;
        }
        if run.flights.is_empty() && run.board.standing(|s| *s == Standing::Waiting).is_empty() {
            return Ok(run.board.ran(false));
        }
        let start = Instant::now();
        while start.elapsed() < options.poll && !cancel.load(Ordering::SeqCst) {
            std::thread::sleep(Duration::from_millis(50).min(options.poll));
        }
    }
}

/// A task that is waited for.
struct Flight {
    submission: Submission,
    task: TaskId,
    /// Its cases without a result.
    open: Vec<String>,
    /// Looks in a row that the queue did not have it in.
    gone: usize,
}

struct Run<'a> {
    store: &'a Store,
    options: &'a SlurmOptions,
    tell: &'a (dyn Fn(Event) + Sync),
    board: Board,
    flights: Vec<Flight>,
    /// Jobs of this run that ended without a result of a case.
    lost: BTreeMap<String, usize>,
    /// Attempts that were told of.
    seen: BTreeSet<(String, u32)>,
    largest_array: usize,
    /// Whether the queue did not answer last time.
    is_silent: bool,
}

impl Run<'_> {
    /// Waits for what an earlier coordinator had submitted.
    fn adopt(&mut self) -> Result<(), StoreError> {
        for submission in Submission::open(self.store.root())? {
            match submission.number()? {
                Some(number) => self.fly(submission, number)?,
                None => submission.end()?,
            }
        }
        Ok(())
    }

    /// Waits for those tasks of an array that have cases to do.
    fn fly(&mut self, submission: Submission, number: u64) -> Result<(), StoreError> {
        let before = self.flights.len();
        for (k, ids) in submission.tasks.iter().enumerate() {
            let waiting = self.board.standing(|s| *s == Standing::Waiting);
            let is_open = |id: &&String| waiting.contains(id);
            let open: Vec<String> = ids.iter().filter(is_open).cloned().collect();
            for id in &open {
                self.board.stands(id, Standing::Running);
            }
            if !open.is_empty() {
                self.flights.push(Flight { submission: submission.clone(), task: (number, k), open, gone: 0 });
            }
        }
        if self.flights.len() == before { submission.end() } else { Ok(()) }
    }

    /// Takes results, and what tasks are gone.
    fn look(&mut self) -> Result<(), StoreError> {
        let names: BTreeSet<String> = self.flights.iter().map(|f| f.submission.name.clone()).collect();
        let names: Vec<String> = names.into_iter().collect();
        // Before the files: a task that ends in between is found gone, and its results are there.
        let tasks = match slurm_queue::tasks(&names) {
            Ok(tasks) => {
                self.is_silent = false;
                Some(tasks)
            }
            Err(error) => {
                if !std::mem::replace(&mut self.is_silent, true) {
                    (self.tell)(Event::Told(format!("{error}; the queue is asked until it answers")));
                }
                None
            }
        };
        let mut flights = std::mem::take(&mut self.flights);
        let mut stuck = Vec::new();
        for flight in &mut flights {
            flight.open.retain(|id| !self.is_settled(id));
            let Some(tasks) = &tasks else { continue };
            let state = tasks.get(&flight.task);
            let is_alive = state.is_some_and(TaskState::is_alive);
            flight.gone = if is_alive { 0 } else { flight.gone + 1 };
            if state.is_some_and(TaskState::is_stuck) {
                stuck.push(format!("{}_{}", flight.task.0, flight.task.1));
            }
            if flight.gone >= LOOKS_BEFORE_GONE {
                for id in std::mem::take(&mut flight.open) {
                    self.lose(&id, flight, state);
                }
            }
        }
        if let Err(error) = slurm_queue::cancel(&stuck) {
            (self.tell)(Event::Told(error.to_string()));
        }
        flights.retain(|flight| !flight.open.is_empty());
        self.flights = flights;
        self.end_what_nobody_waits_for(&names)
    }

    fn end_what_nobody_waits_for(&self, names: &[String]) -> Result<(), StoreError> {
        let is_waited_for = |name: &String| self.flights.iter().any(|f| f.submission.name == *name);
        if names.iter().all(is_waited_for) {
            return Ok(());
        }
        for submission in Submission::open(self.store.root())? {
            if names.contains(&submission.name) && !is_waited_for(&submission.name) {
                submission.end()?;
            }
        }
        Ok(())
    }

    /// Takes the result of a case, if it has one now.
    fn is_settled(&mut self, id: &str) -> bool {
        match self.store.state(id) {
            State::Done(attempted) => {
                self.board.done(id, &attempted.outcome);
                (self.tell)(Event::Ended { id: id.to_owned(), outcome: Box::new(attempted.outcome) });
            }
            State::Edited(reason) => self.leave(id, reason),
            State::Running(_) => {
                let attempts = result::attempts(&self.store.case_folder(id)).unwrap_or_default();
                let attempt = attempts.into_iter().max().unwrap_or(0);
                if attempt > 0 && self.seen.insert((id.to_owned(), attempt)) {
                    let start_from = self.store.case(id).ok().and_then(|c| c.start_from);
                    (self.tell)(Event::Started { id: id.to_owned(), attempt, start_from });
                }
                return false;
            }
            State::Planned | State::Interrupted => return false,
        }
        (self.tell)(Event::Counted(self.board.progress()));
        true
    }

    fn leave(&mut self, id: &str, reason: String) {
        self.board.stands(id, Standing::Left(reason.clone()));
        (self.tell)(Event::Left { id: id.to_owned(), reason });
    }

    /// A job is gone, and this case of it has no result.
    fn lose(&mut self, id: &str, flight: &Flight, state: Option<&TaskState>) {
        let lost = self.lost.entry(id.to_owned()).or_default();
        *lost += 1;
        let lost = *lost;
        let end = state.map_or_else(
            || "which the queue does not know any more".to_owned(),
            |s| format!("which ended as {}", s.state),
        );
        let (job, task) = flight.task;
        let said = format!(
            "job {job}_{task}, {end}, has left no result of it; it printed {}",
            flight.submission.log(&task.to_string())
        );
        if lost < self.options.tries {
            self.board.stands(id, Standing::Waiting);
            (self.tell)(Event::Told(format!("{id}: {said}; it is submitted again")));
        } else {
            let next = match state.map(|s| s.state.as_str()) {
                Some("TIMEOUT") => "; give jobs more time",
                Some("OUT_OF_MEMORY") => "; give jobs more memory",
                _ => "",
            };
            self.leave(id, format!("{said}; that was the last of {lost} tries{next}"));
        }
    }

    /// Submits all that can begin.
    fn submit(&mut self) -> Result<(), StoreError> {
        let tasks = self.tasks();
        for id in tasks.iter().flatten() {
            self.board.stands(id, Standing::Waiting);
        }
        for array in tasks.chunks(self.largest_array) {
            let submission = Submission::new(self.store.root(), array.to_vec(), &self.options.program)?;
            let arguments = self.arguments(&submission);
            let number = match slurm_queue::submit(&arguments, &submission.number_file()) {
                Ok(number) => number,
                // sbatch may give up on a slow answer, and the job be there.
                Err(error) => match submission.number()? {
                    Some(number) => number,
                    None => {
                        submission.withdraw()?;
                        return Err(error);
                    }
                },
            };
            self.fly(submission, number)?;
        }
        Ok(())
    }

    /// Cases in tasks of the wanted length: with a case those that start from it, and one that a job was lost with alone.
    fn tasks(&mut self) -> Vec<Vec<String>> {
        let task_s = self.options.task_cpu_s();
        let mut tasks = Vec::new();
        let mut task: Vec<String> = Vec::new();
        let mut cost_s = 0.0;
        while let Some(first) = self.board.next() {
            if self.lost.contains_key(&first) {
                tasks.push(vec![first]);
                continue;
            }
            let mut behind = vec![first];
            while let Some(id) = behind.pop() {
                self.board.stands(&id, Standing::Running);
                cost_s += self.board.expected_s(&id);
                behind.extend(self.board.waiting_on(&id).into_iter().filter(|id| !self.lost.contains_key(id)).rev());
                task.push(id);
                if cost_s >= task_s {
                    break;
                }
            }
            if cost_s >= task_s {
                tasks.push(std::mem::take(&mut task));
                cost_s = 0.0;
            }
        }
        tasks.extend(Some(task).filter(|t| !t.is_empty()));
        tasks
    }

    fn arguments(&self, submission: &Submission) -> Vec<String> {
        let cost_s = |ids: &Vec<String>| ids.iter().map(|id| self.board.expected_s(id)).sum::<f64>();
        let longest_s = submission.tasks.iter().map(cost_s).fold(0.0, f64::max);
        // Where a job was lost it may have been for want of time.
        let lost = submission.tasks.iter().flatten().filter_map(|id| self.lost.get(id)).max().copied().unwrap_or(0);
        self.options.arguments(self.store.root(), submission, longest_s, lost)
    }

    /// Cancels all that was submitted.
    fn cancel(&mut self) -> Result<(), StoreError> {
        let mut jobs = Vec::new();
        let open = Submission::open(self.store.root())?;
        for submission in &open {
            jobs.extend(submission.number()?.map(|number| number.to_string()));
        }
        slurm_queue::cancel(&jobs)?;
        for flight in std::mem::take(&mut self.flights) {
            for id in flight.open {
                self.board.stands(&id, Standing::Waiting);
            }
        }
        open.iter().try_for_each(Submission::end)
    }
}
