//! One coordinator a campaign, and one worker a case.
//!
//! A lock is a file `lock-NNNNNN.json` in the folder that it guards; whose number is the highest holds it. Who finds the highest released, or its holder dead, makes the next number, which only one can; no highest is ever taken away, so that a slow taker with old knowledge finds itself below another and gives up.
//!
//! A holder on this machine lives as long as its process. One on another lives as long as its file is written again: every [`BEAT`], and it counts as dead after [`DEAD_AFTER`], which is more than a network disk holds back what it knows. Ages are told by the clock of the disk, not by those of two hosts.
//!
//! A lock saves work and decides nothing: a worker that was taken for dead and is not may still end its case, and which result counts is decided where results are accepted.

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime};

use froude_records::write::Prepared;
use serde::{Deserialize, Serialize};

use crate::input;
use crate::process::Process;
use crate::store_error::StoreError;

/// How often a holder says that it lives.
pub const BEAT: Duration = Duration::from_secs(10);
/// A holder on another machine that has not said so for this long is dead.
pub const DEAD_AFTER: Duration = Duration::from_mins(3);

/// Takers that may come between before this one gives up.
const MOST_TRIES: usize = 100;

/// A lock that is held; dropped, it is released.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    held: Held,
    beat: Option<(Sender<()>, JoinHandle<()>)>,
}

/// What a lock's file holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Held {
    process: Process,
    is_released: bool,
}

impl Held {
    /// Of the same length held and released: the one is written over the other, also on a full disk.
    fn text(&self) -> String {
        let text = serde_json::to_string(self).unwrap_or_default();
        if self.is_released { text + " \n" } else { text + "\n" }
    }
}

/// Who holds a lock.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Holder {
    /// The process; `None` where its file cannot be read.
    pub process: Option<Process>,
    /// Since it last said that it lives, s.
    pub age_s: u64,
}

impl std::fmt::Display for Holder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.process {
            Some(process) => {
                write!(f, "process {} on {}, which last said so {} s ago", process.pid, process.host, self.age_s)
            }
            None => write!(f, "a process whose file cannot be read, which was written {} s ago", self.age_s),
        }
    }
}

impl Lock {
    /// Takes the lock of a folder.
    ///
    /// # Errors
    ///
    /// [`StoreError::Held`] with its holder; [`StoreError::Refused`] where the folder cannot be read or written.
    pub fn take(folder: &Path) -> Result<Self, StoreError> {
        for _ in 0..MOST_TRIES {
            let highest = highest(folder)?;
            if let Some(number) = highest {
                match look(folder, number) {
                    Seen::Live(holder) => {
                        let folder = folder.display();
                        let held = format!("{folder}: {holder}, works on it; wait for it to end, or end it");
                        return Err(StoreError::Held(held));
                    }
                    Seen::Gone => continue,
                    Seen::Free => {}
                }
            }
            let next = highest.unwrap_or(0) + 1;
            let path = file(folder, next);
            let held = Held { process: Process::this(), is_released: false };
            let prepared = Prepared::new(&path, |out| out.write_all(held.text().as_bytes()))?;
            if let Err(error) = prepared.take_free_place() {
                if path.exists() {
                    continue;
                }
                return Err(error.into());
            }
            if self::highest(folder)? != Some(next) {
                let _ = std::fs::remove_file(&path);
                continue;
            }
            for lower in numbers(folder)?.into_iter().filter(|n| *n < next) {
                let _ = std::fs::remove_file(file(folder, lower));
            }
            let beat = heart(path.clone(), held.text());
            return Ok(Self { path, held, beat: Some(beat) });
        }
        Err(StoreError::file(folder, format!("others took its lock {MOST_TRIES} times; try again")))
    }

    /// Takes the lock, and waits until it is free where another holds it.
    ///
    /// # Errors
    ///
    /// As [`take`](Self::take), when it is still held after `longest`.
    pub fn wait(folder: &Path, longest: Duration) -> Result<Self, StoreError> {
        let start = std::time::Instant::now();
        loop {
            match Self::take(folder) {
                Err(StoreError::Held(_)) if start.elapsed() < longest => {
                    std::thread::sleep(Duration::from_millis(200));
                }
                done => return done,
            }
        }
    }

    /// Releases the lock of a folder that was moved, where it is now.
    pub fn release_in(mut self, folder: &Path) {
        self.path = folder.join(self.path.file_name().unwrap_or_default());
    }

    /// Who holds the lock of a folder, if somebody does.
    ///
    /// # Errors
    ///
    /// [`StoreError::Refused`] where the folder cannot be read.
    pub fn holder(folder: &Path) -> Result<Option<Holder>, StoreError> {
        for _ in 0..MOST_TRIES {
            let Some(number) = highest(folder)? else { return Ok(None) };
            match look(folder, number) {
                Seen::Live(holder) => return Ok(Some(holder)),
                Seen::Free => return Ok(None),
                Seen::Gone => {}
            }
        }
        Ok(None)
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        if let Some((stop, thread)) = self.beat.take() {
            drop(stop);
            let _ = thread.join();
        }
        self.held.is_released = true;
        // Its process number says the same as soon as this one ends.
        let _ = overwrite(&self.path, &self.held.text());
    }
}

/// The file of a lock.
fn file(folder: &Path, number: u64) -> PathBuf {
    folder.join(format!("lock-{number:06}.json"))
}

fn numbers(folder: &Path) -> Result<Vec<u64>, StoreError> {
    input::numbers(folder, ["lock-", ".json"], u64::MAX)
}

fn highest(folder: &Path) -> Result<Option<u64>, StoreError> {
    Ok(numbers(folder)?.into_iter().max())
}

enum Seen {
    Live(Holder),
    Free,
    Gone,
}

fn look(folder: &Path, number: u64) -> Seen {
    let path = file(folder, number);
    let text = match input::bytes(&path) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Seen::Gone,
        text => text.unwrap_or_default(),
    };
    let held = read(&text);
    if held.as_ref().is_some_and(|h| h.is_released || h.process.is_alive() == Some(false)) {
        return Seen::Free;
    }
    let is_seen = held.as_ref().is_some_and(|h| h.process.is_alive() == Some(true));
    let Ok(written) = std::fs::metadata(&path).and_then(|m| m.modified()) else { return Seen::Gone };
    let now = if is_seen { SystemTime::now() } else { time_of_the_disk(folder) };
    let age = now.duration_since(written).unwrap_or_default();
    if !is_seen && age > DEAD_AFTER {
        return Seen::Free;
    }
    Seen::Live(Holder { process: held.map(|h| h.process), age_s: age.as_secs() })
}

fn read(text: &[u8]) -> Option<Held> {
    serde_json::from_slice(text).ok()
}

/// What the disk's clock says, which for a network disk is that of the host that has it; this host's where nothing can be written.
fn time_of_the_disk(folder: &Path) -> SystemTime {
    let written = tempfile::NamedTempFile::new_in(folder).and_then(|file| file.as_file().metadata()?.modified());
    written.unwrap_or_else(|_| SystemTime::now())
}

/// Writes the same again and again until the sender is gone, or the file.
fn heart(path: PathBuf, text: String) -> (Sender<()>, JoinHandle<()>) {
    let (stop, stopped) = channel();
    let thread = std::thread::spawn(move || {
        while stopped.recv_timeout(BEAT) == Err(RecvTimeoutError::Timeout) && overwrite(&path, &text).is_ok() {}
    });
    (stop, thread)
}

fn overwrite(path: &Path, text: &str) -> std::io::Result<()> {
    let mut file: File = OpenOptions::new().write(true).open(path)?;
    file.write_all(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn stranger(folder: &Path, age: Duration) {
        let process = Process { host: "far".to_owned(), machine: "another".to_owned(), pid: 7, started_ticks: 1 };
        let path = file(folder, 1);
        std::fs::write(&path, Held { process, is_released: false }.text()).unwrap();
        File::options().write(true).open(path).unwrap().set_modified(SystemTime::now() - age).unwrap();
    }

    #[test]
    fn the_second_taker_is_told_of_the_first_and_takes_it_after_its_release() {
        let folder = tempfile::tempdir().unwrap();
        let first = Lock::take(folder.path()).unwrap();
        let refused = Lock::take(folder.path()).unwrap_err().to_string();
        assert!(refused.contains(&format!("process {} on ", std::process::id())), "{refused}");
        drop(first);
        assert_eq!(Lock::holder(folder.path()).unwrap(), None);
        let second = Lock::take(folder.path()).unwrap();
        assert_eq!(numbers(folder.path()).unwrap(), [2]);
        drop(second);
    }

    #[test]
    fn a_holder_on_another_machine_counts_as_dead_when_its_heart_has_stood_still_for_three_minutes() {
        let folder = tempfile::tempdir().unwrap();
        stranger(folder.path(), DEAD_AFTER.checked_sub(Duration::from_secs(5)).unwrap());
        let refused = Lock::take(folder.path()).unwrap_err().to_string();
        assert!(refused.contains("process 7 on far, which last said so 17"), "{refused}");
        stranger(folder.path(), DEAD_AFTER + Duration::from_secs(5));
        Lock::take(folder.path()).unwrap();
    }

    #[test]
    fn a_file_is_as_long_held_as_released() {
        let held = Held { process: Process::this(), is_released: false };
        let released = Held { is_released: true, ..held.clone() };
        assert_eq!(held.text().len(), released.text().len());
        assert_eq!(read(released.text().as_bytes()), Some(released));
    }

    #[test]
    fn of_many_threads_one_at_a_time_holds_it() {
        let folder = tempfile::tempdir().unwrap();
        let inside = std::sync::atomic::AtomicUsize::new(0);
        let taken = std::sync::atomic::AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..20 {
                        let Ok(lock) = Lock::take(folder.path()) else { continue };
                        assert_eq!(inside.fetch_add(1, std::sync::atomic::Ordering::SeqCst), 0);
                        taken.fetch_add(1, std::sync::atomic::Ordering::SeqCst);
                        inside.fetch_sub(1, std::sync::atomic::Ordering::SeqCst);
                        drop(lock);
                    }
                });
            }
        });
        assert!(taken.into_inner() > 0);
    }

    proptest! {
        #[test]
        fn any_bytes_in_the_file_are_a_holder_or_none(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let folder = tempfile::tempdir().unwrap();
            std::fs::write(file(folder.path(), 3), &bytes).unwrap();
            std::fs::write(folder.path().join("lock-18446744073709551615.json"), &bytes).unwrap();
            let holder = Lock::holder(folder.path()).unwrap().unwrap();
            prop_assert_eq!(holder.process, None);
        }
    }
}
