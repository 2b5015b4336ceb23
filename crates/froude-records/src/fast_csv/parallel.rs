//! Chunks on several threads, folded in the file's order.

use std::num::NonZeroUsize;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::{Chunk, FastCsv, Layout, Memory, Reader, Summary};
use crate::fast_csv::error::FastCsvError;

impl FastCsv {
    /// Maps every chunk on some thread, then folds the results in the file's order.
    ///
    /// `map` runs on several threads at once, `fold` on one at a time. Since chunks are
    /// cut by their place in the file, the outcome is the same for any number of
    /// threads. Each thread holds one chunk.
    ///
    /// # Errors
    ///
    /// The first error in the file's order: a [`FastCsvError`], or what `map` or `fold`
    /// returns.
    pub fn fold_chunks<T, E, M, F>(self, threads: NonZeroUsize, map: M, fold: F) -> Result<Summary, E>
    where
        M: Fn(Chunk<'_>) -> Result<T, E> + Sync,
        F: FnMut(T) -> Result<(), E> + Send,
        E: From<FastCsvError> + Send,
    {
        let path = self.reader.path.clone();
        let work = Work {
            layout: self.layout,
            reader: Mutex::new(self.reader),
            turn: Mutex::new(Turn { next: 0, fold, failure: None }),
            turn_has_come: Condvar::new(),
            map,
        };
        if threads.get() == 1 {
            work.run(&path);
        } else {
            std::thread::scope(|scope| {
                for _ in 0..threads.get() {
                    scope.spawn(|| work.run(&path));
                }
            });
        }
        let turn = work.turn.into_inner().unwrap_or_else(PoisonError::into_inner);
        if let Some(failure) = turn.failure {
            return Err(failure);
        }
        let reader = work.reader.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(reader.finish()?)
    }
}

/// What all threads share.
struct Work<M, F, E> {
    layout: Layout,
    reader: Mutex<Reader>,
    turn: Mutex<Turn<F, E>>,
    turn_has_come: Condvar,
    map: M,
}

/// Whose result is folded next.
struct Turn<F, E> {
    next: u64,
    fold: F,
    failure: Option<E>,
}

impl<M, F, E> Work<M, F, E> {
    /// One thread: chunk after chunk until the file ends or something failed.
    fn run<T>(&self, path: &std::path::Path)
    where
        M: Fn(Chunk<'_>) -> Result<T, E>,
        F: FnMut(T) -> Result<(), E>,
        E: From<FastCsvError>,
    {
        let mut memory = Memory::default();
        loop {
            // A failure to read takes the turn of the chunk that it would have been.
            let (index, lines) = {
                let mut reader = lock(&self.reader);
                let index = reader.summary.chunks;
                let lines = reader.next(&mut memory.text);
                if lines.is_err() {
                    // The other threads shall find the end.
                    reader.has_ended = true;
                    reader.carry.clear();
                }
                (index, lines)
            };
            let lines = match lines {
                Ok(None) => return,
                Ok(Some(lines)) => Ok(lines),
                Err(error) => Err(E::from(error)),
            };
            let mut place = Place { work: self, index, is_done: false };
            let result = lines.and_then(|lines| {
                let columns = self.layout.parse(path, &mut memory, &lines)?;
                (self.map)(Chunk { columns: &columns, first_line: lines.first, index: lines.index })
            });
            if !place.fold(result) {
                return;
            }
        }
    }
}

impl<M, F, E> Work<M, F, E> {
    /// Waits until it is the turn of chunk `index`.
    fn wait(&self, index: u64) -> MutexGuard<'_, Turn<F, E>> {
        let mut turn = lock(&self.turn);
        while turn.next != index {
            turn = (self.turn_has_come).wait(turn).unwrap_or_else(PoisonError::into_inner);
        }
        turn
    }
}

/// A chunk's place in the order. Gives the turn on even when `map` panics, so that no
/// other thread waits for ever.
struct Place<'a, M, F, E> {
    work: &'a Work<M, F, E>,
    index: u64,
    is_done: bool,
}

impl<M, F, E> Place<'_, M, F, E> {
    /// Waits for the turn and folds; false when the work is over.
    fn fold<T>(&mut self, result: Result<T, E>) -> bool
    where
        F: FnMut(T) -> Result<(), E>,
    {
        let work = self.work;
        let mut turn = work.wait(self.index);
        if turn.failure.is_none() {
            let folded = result.and_then(|value| (turn.fold)(value));
            turn.failure = folded.err();
        }
        turn.next += 1;
        let goes_on = turn.failure.is_none();
        self.is_done = true;
        drop(turn);
        work.turn_has_come.notify_all();
        goes_on
    }
}

impl<M, F, E> Drop for Place<'_, M, F, E> {
    fn drop(&mut self) {
        if !self.is_done {
            // Unwinding: nothing is folded, and the panic goes on at the end of the scope.
            self.work.wait(self.index).next += 1;
            self.work.turn_has_come.notify_all();
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
