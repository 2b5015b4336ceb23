//! The operator's stop: the first request stops under control and holds (category 2), the second cuts the torque (category 0).

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

/// Shared between the signal handler and the runner.
#[derive(Debug, Clone, Default)]
pub struct StopSwitch(Arc<AtomicU8>);

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
    /// One more press; safe in a signal handler.
    pub fn press(&self) {
        let _ = self.0.fetch_update(Ordering::SeqCst, Ordering::SeqCst, |n| Some(n.saturating_add(1)));
    }

    /// What the presses so far ask for.
    #[must_use]
    pub fn asked(&self) -> Asked {
        match self.0.load(Ordering::SeqCst) {
            0 => Asked::Nothing,
            1 => Asked::Stop,
            _ => Asked::Cut,
        }
    }
}
