//! The operator's stop: the first Ctrl-C stops under control and holds (category 2), the second cuts the torque (category 0).
//!
//! A signal's handler sets flags and nothing else. That a stop was asked for is one flag which nobody clears, so that everybody may look at it.
//! Presses are counted by one thread alone, the rig's, at every sample that it gets: two presses are two when a sample lies between them.
//!
//! SIGTERM and SIGHUP stop under control however often they come: a terminal that is closed hangs up twice, once by itself and once by its
//! shell, and that must not cut the torque.

use super::sync::{Arc, AtomicBool, AtomicU8, Ordering};

/// Shared between the signals' handlers and everybody who looks.
#[derive(Debug, Clone, Default)]
pub struct StopSwitch {
    is_asked: Arc<AtomicBool>,
    is_pressed: Arc<AtomicBool>,
    presses: Arc<AtomicU8>,
}

/// What was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// Nothing.
    Nothing,
    /// A controlled stop.
    Stop,
    /// Torque off.
    Cut,
}

impl StopSwitch {
    /// One more press.
    pub fn press(&self) {
        self.is_asked.store(true, Ordering::SeqCst);
        let _ = self.presses.fetch_update(Ordering::SeqCst, Ordering::SeqCst, |n| Some(n.saturating_add(1)));
    }

    /// The flag that the handler of every signal sets: stop.
    #[must_use]
    pub fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.is_asked)
    }

    /// The flag that Ctrl-C's handler sets after that: once more.
    #[must_use]
    pub fn press_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.is_pressed)
    }

    /// Whether a stop was asked for.
    #[must_use]
    pub fn is_asked(&self) -> bool {
        self.is_asked.load(Ordering::SeqCst)
    }

    /// Whether Ctrl-C was among what asked for it: then one more cuts, otherwise two.
    #[must_use]
    pub fn was_pressed(&self) -> bool {
        self.is_pressed.load(Ordering::SeqCst) || self.presses.load(Ordering::SeqCst) > 0
    }

    /// What was asked for so far. It counts, so that it is for the rig's thread alone; all others have [`Self::is_asked`].
    #[must_use]
    pub fn asked(&self) -> Asked {
        if !self.is_asked() {
            return Asked::Nothing;
        }
        if self.is_pressed.swap(false, Ordering::SeqCst) {
            self.press();
        }
        if self.presses.load(Ordering::SeqCst) > 1 { Asked::Cut } else { Asked::Stop }
    }
}
