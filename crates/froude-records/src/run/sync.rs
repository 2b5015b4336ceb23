//! Brings a growing file to the disk twice a second, beside the thread that records.
//!
//! `fsync` may take longer than the 50 ms after which a chunk must have been handed over, so it has a thread of its own.
//! It goes by the machine's clock, also where run time is simulated: power fails in real time.

use std::fs::File;
use std::io;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Twice a second: with the time that it takes itself, at least once.
const PERIOD: Duration = Duration::from_millis(500);

/// The thread; it ends when this is dropped.
pub(crate) struct Syncer {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
    failure: Arc<Mutex<Option<io::Error>>>,
}

impl Syncer {
    pub fn start(file: File) -> io::Result<Self> {
        let (stop, stopped) = channel::<()>();
        let failure = Arc::new(Mutex::new(None));
        let reported = Arc::clone(&failure);
        let thread = std::thread::Builder::new().name("fsync".to_owned()).spawn(move || {
            while stopped.recv_timeout(PERIOD) == Err(RecvTimeoutError::Timeout) {
                if let Err(error) = file.sync_data() {
                    *reported.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                    return;
                }
            }
        })?;
        Ok(Self { stop: Some(stop), thread: Some(thread), failure })
    }

    /// What went wrong, reported once.
    pub fn failure(&self) -> Option<io::Error> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl Drop for Syncer {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
