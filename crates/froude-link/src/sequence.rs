//! Order of arrival: what was lost, repeated or late.
//!
//! Every frame of one end carries the next 16-bit number. A number ahead of the newest one seen leaves a gap; a number
//! behind it is late if it fills a gap and a repetition if it does not, distinguished over the last 64 numbers. Older ones count as
//! late without giving anything back. Gaps of up to 32,767 frames (8 s of telemetry) are counted exactly.

/// Numbers behind the newest one that are remembered.
pub const WINDOW: u16 = 64;

/// How a frame arrived.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrival {
    /// The next one, or the first one of all.
    InOrder,
    /// So many before it are missing.
    AfterLoss(u16),
    /// It was missing until now. It is older than something that was already delivered.
    Late,
    /// It was delivered before.
    Duplicate,
}

/// Counters of one end's frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct OrderCounts {
    /// Missing until now; a late arrival takes one back.
    pub lost: u32,
    /// Arrived after a younger one.
    pub late: u32,
    /// Arrived again.
    pub duplicates: u32,
}

/// Watches the sequence numbers of one end. Frames of another end have numbers of their own and do not belong here.
#[derive(Debug, Clone, Copy, Default)]
pub struct Order {
    newest: Option<u16>,
    /// Bit k: the number `newest − k` was received.
    received: u64,
    counts: OrderCounts,
}

impl Order {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { newest: None, received: 0, counts: OrderCounts { lost: 0, late: 0, duplicates: 0 } }
    }

    /// What was counted so far.
    #[must_use]
    pub const fn counts(&self) -> OrderCounts {
        self.counts
    }

    /// Forgets the numbers, not the counts: another end, or the same one anew, speaks from here.
    pub fn restart(&mut self) {
        self.newest = None;
    }

    /// Takes note of a frame with this number.
    pub fn note(&mut self, number: u16) -> Arrival {
        let Some(newest) = self.newest else {
            self.newest = Some(number);
            // What came before the first frame is nobody's loss.
            self.received = u64::MAX;
            return Arrival::InOrder;
        };
        let ahead = number.wrapping_sub(newest);
        if ahead == 0 || ahead > u16::MAX / 2 {
            return self.note_behind(newest.wrapping_sub(number));
        }
        self.newest = Some(number);
        self.received = if ahead < WINDOW { self.received << ahead | 1 } else { 1 };
        let missing = ahead.wrapping_sub(1);
        self.counts.lost = self.counts.lost.wrapping_add(u32::from(missing));
        if missing == 0 { Arrival::InOrder } else { Arrival::AfterLoss(missing) }
    }

    fn note_behind(&mut self, behind: u16) -> Arrival {
        if behind >= WINDOW {
            self.counts.late = self.counts.late.wrapping_add(1);
            return Arrival::Late;
        }
        let bit = 1_u64 << behind;
        if self.received & bit != 0 {
            self.counts.duplicates = self.counts.duplicates.wrapping_add(1);
            return Arrival::Duplicate;
        }
        self.received |= bit;
        self.counts.late = self.counts.late.wrapping_add(1);
        self.counts.lost = self.counts.lost.saturating_sub(1);
        Arrival::Late
    }
}
