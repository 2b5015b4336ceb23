//! From counts to position: a wrapping hardware counter, and a quadrature decoder in software.
//!
//! **Units.** Counts are quarter periods of a line (the paper: 1000 lines, 4000 counts a turn).

/// Unwraps a 32-bit hardware count.
///
/// Any start value will do, also one just before its wrap. Right as long as fewer than 2³¹ counts pass between two ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Unwrap {
    last: Option<u32>,
    count: i64,
}

impl Unwrap {
    /// Takes the hardware count of this tick; returns how far it went since the last tick. The first tick is zero.
    pub fn step(&mut self, hardware: u32) -> i32 {
        let moved = hardware.wrapping_sub(self.last.unwrap_or(hardware)).cast_signed();
        self.last = Some(hardware);
        self.count = self.count.wrapping_add(i64::from(moved));
        moved
    }

    /// Counts since the first tick.
    #[must_use]
    pub fn count(&self) -> i64 {
        self.count
    }
}

/// Decodes the two lines of an incremental encoder, four counts a period.
///
/// A positive turn is A before B: 00 → 10 → 11 → 01 → 00 (A first). Both lines changing at once is illegal: a pulse was lost or
/// disturbed; it is counted and the count stays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct QuadratureDecoder {
    lines: Option<(bool, bool)>,
    count: u32,
    errors: u32,
}

impl QuadratureDecoder {
    /// Starts from a count.
    #[must_use]
    pub const fn starting_at(count: u32) -> Self {
        Self { lines: None, count, errors: 0 }
    }

    /// Takes the lines as they are now. The first call only remembers them.
    pub fn step(&mut self, a: bool, b: bool) {
        if let Some((was_a, was_b)) = self.lines {
            match (was_a != a, was_b != b) {
                (false, false) => {}
                (true, true) => self.errors = self.errors.wrapping_add(1),
                // A changed: forward if it now differs from B. B changed: forward if it now equals A.
                (true, false) if a != b => self.count = self.count.wrapping_add(1),
                (false, true) if a == b => self.count = self.count.wrapping_add(1),
                _ => self.count = self.count.wrapping_sub(1),
            }
        }
        self.lines = Some((a, b));
    }

    /// Wrapping count, as a hardware counter gives it.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Illegal transitions so far, wrapping.
    #[must_use]
    pub fn errors(&self) -> u32 {
        self.errors
    }
}
