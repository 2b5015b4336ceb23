//! Telemetry waits here for the line.
//!
//! The tick puts a frame in, the serial port takes it out when it has room. When the ring is full the new frame is dropped, so
//! that what is kept has no holes; the loss is counted, and the next frame that fits says that something is missing before it.

use heapless::Deque;

use crate::budget::TICKS_PER_S;
use crate::telemetry::Telemetry;

/// Frames that the board's ring holds: 256 ms.
pub const RING_FRAMES: usize = 1024;
const _: () = assert!(RING_FRAMES as u32 * 1000 / TICKS_PER_S >= 100, "the ring holds less than 100 ms");

/// First in, first out; never more than `N`.
#[derive(Debug, Clone)]
pub struct TelemetryRing<const N: usize = RING_FRAMES> {
    frames: Deque<Telemetry, N>,
    lost: u32,
    has_gap: bool,
}

impl<const N: usize> Default for TelemetryRing<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> TelemetryRing<N> {
    /// An empty ring.
    #[must_use]
    pub const fn new() -> Self {
        Self { frames: Deque::new(), lost: 0, has_gap: false }
    }

    /// Keeps a frame, or counts it as lost.
    pub fn put(&mut self, mut telemetry: Telemetry) {
        telemetry.has_gap_before = self.has_gap;
        self.has_gap = self.frames.push_back(telemetry).is_err();
        if self.has_gap {
            self.lost = self.lost.wrapping_add(1);
        }
    }

    /// The oldest frame.
    pub fn take(&mut self) -> Option<Telemetry> {
        self.frames.pop_front()
    }

    /// Frames waiting.
    #[must_use]
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Nothing waits.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Frames dropped since power-up; wraps.
    #[must_use]
    pub const fn lost(&self) -> u32 {
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbered(tick: u32) -> Telemetry {
        Telemetry { tick, ..Telemetry::default() }
    }

    #[test]
    fn a_full_ring_keeps_what_it_has_counts_what_comes_and_marks_the_hole() {
        let mut ring = TelemetryRing::<4>::new();
        (0..7).for_each(|tick| ring.put(numbered(tick)));
        assert_eq!((ring.len(), ring.lost()), (4, 3));
        let kept: [_; 4] = core::array::from_fn(|_| ring.take().unwrap());
        assert_eq!(kept.map(|t| t.tick), [0, 1, 2, 3]);
        assert!(kept.iter().all(|t| !t.has_gap_before));
        ring.put(numbered(7));
        ring.put(numbered(8));
        assert!(ring.take().unwrap().has_gap_before, "ticks 4 to 6 are missing before tick 7");
        assert!(!ring.take().unwrap().has_gap_before);
        assert!(ring.is_empty());
    }
}
