//! A campaign on this machine: workers over a queue of cases.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::engine::board::{Board, Standing};
use crate::engine::{Event, Ran};
use crate::lock::Lock;
use crate::store::Store;
use crate::store_error::StoreError;
use crate::work::{Solve, Worked, work};

/// How often a worker that waits for another looks whether it is cancelled.
const LOOK: Duration = Duration::from_millis(100);

/// Runs all cases without a result, `jobs` at a time, those behind the cases that they start from.
///
/// A case that fails stops no other: what starts from it starts from the inflow. Once `cancel` is set no case begins, and those that run end without a result. Run again, it goes on where it was, however it ended.
///
/// # Errors
///
/// [`StoreError::Held`]: another process runs this campaign. [`StoreError::Refused`]: its folder cannot be written.
pub fn run(
    store: &Store,
    solver: &dyn Solve,
    jobs: usize,
    cancel: &AtomicBool,
    tell: &(dyn Fn(Event) + Sync),
) -> Result<Ran, StoreError> {
    let _lock = Lock::take(store.root())?;
    let queue = Queue { board: Mutex::new(Board::of(store)), changed: Condvar::new(), cancel };
    std::thread::scope(|scope| {
        for _ in 0..jobs.max(1) {
            scope.spawn(|| {
                while let Some(id) = queue.next() {
                    one(store, solver, &queue, &id, tell);
                }
            });
        }
    });
    let board = queue.board.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(board.ran(cancel.load(Ordering::SeqCst)))
}

fn one(store: &Store, solver: &dyn Solve, queue: &Queue<'_>, id: &str, tell: &(dyn Fn(Event) + Sync)) {
    let begun = |attempt, from: Option<&str>| {
        tell(Event::Started { id: id.to_owned(), attempt, start_from: from.map(str::to_owned) });
    };
    let told = |iterations| tell(Event::Iterated { id: id.to_owned(), iterations });
    let worked = work(store, id, solver, Duration::ZERO, queue.cancel, &begun, &told);
    let event = {
        let mut board = queue.lock();
        match worked {
            Ok(Worked::Accepted(attempted) | Worked::Already(attempted)) => {
                board.done(id, &attempted.outcome);
                Some(Event::Ended { id: id.to_owned(), outcome: Box::new(attempted.outcome) })
            }
            Ok(Worked::Cancelled) => {
                board.stands(id, Standing::Waiting);
                None
            }
            Err(error) => {
                board.stands(id, Standing::Left(error.to_string()));
                Some(Event::Left { id: id.to_owned(), reason: error.to_string() })
            }
        }
    };
    queue.changed.notify_all();
    if let Some(event) = event {
        tell(event);
        let progress = queue.lock().progress();
        tell(Event::Counted(progress));
    }
}

struct Queue<'a> {
    board: Mutex<Board>,
    changed: Condvar,
    cancel: &'a AtomicBool,
}

impl Queue<'_> {
    fn lock(&self) -> MutexGuard<'_, Board> {
        self.board.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next case, as soon as one can begin; `None` when none ever will, or the run is cancelled.
    fn next(&self) -> Option<String> {
        let mut board = self.lock();
        loop {
            if self.cancel.load(Ordering::SeqCst) {
                return None;
            }
            if let Some(id) = board.next() {
                return Some(id);
            }
            if board.standing(|s| *s == Standing::Running).is_empty() {
                return None;
            }
            board = self.changed.wait_timeout(board, LOOK).unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}
