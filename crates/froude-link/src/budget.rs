//! What a line can carry, and the rule by which telemetry gives way.
//!
//! A byte takes ten bit times (8N1). Telemetry may fill four fifths of the line from board to host; the rest belongs to events,
//! acknowledgements and clock replies. At 3 Mbaud that is exactly every tick; a slower line carries every second, fourth, fifth …
//! tick, and the board says so in its hello.

use crate::frame::OVERHEAD;
use crate::telemetry::BODY_BYTES;

/// Ticks per second.
pub const TICKS_PER_S: u32 = 4000;
/// Bit times of a byte on the line.
pub const BITS_PER_BYTE: u32 = 10;
/// The largest telemetry frame that the budget allows.
pub const TELEMETRY_BUDGET_BYTES: u32 = 60;
/// A telemetry frame on the wire, all included.
pub const TELEMETRY_WIRE_BYTES: u32 = (BODY_BYTES + OVERHEAD) as u32;
/// The baud rate that carries every tick.
pub const FULL_RATE_BAUD: u32 = 3_000_000;

/// Bits per second of telemetry at full rate, by the budget: 2.4 Mbit/s.
pub const TELEMETRY_BAUD: u32 = TELEMETRY_BUDGET_BYTES * BITS_PER_BYTE * TICKS_PER_S;

const _: () = assert!(TELEMETRY_WIRE_BYTES <= TELEMETRY_BUDGET_BYTES, "a telemetry frame exceeds its budget");
const _: () = assert!(Decimation::of(FULL_RATE_BAUD).every == 1, "3 Mbaud do not carry every tick");
const _: () = assert!(Decimation::of(921_600).every == 4, "the decimation at 921,600 baud is another than documented");

/// Every how many ticks telemetry is sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Decimation {
    /// A frame every so many ticks; a divisor of the tick rate.
    pub every: u16,
}

impl Decimation {
    /// The smallest step, out of the divisors of the tick rate, that leaves a fifth of the line free.
    #[must_use]
    pub const fn of(baud: u32) -> Self {
        let mut every = 1;
        while every < TICKS_PER_S {
            // telemetry / every ≤ 4/5 baud, in integers
            let divides = TICKS_PER_S.is_multiple_of(every);
            if divides && TELEMETRY_BAUD as u64 * 5 <= baud as u64 * 4 * every as u64 {
                break;
            }
            every += 1;
        }
        Self { every: every as u16 }
    }

    /// Whether this tick is sent.
    #[must_use]
    pub const fn takes(self, tick: u32) -> bool {
        match tick.checked_rem(self.every as u32) {
            Some(rest) => rest == 0,
            None => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_megabaud_carry_every_tick_and_921600_every_fourth() {
        assert_eq!(TELEMETRY_BAUD, 2_400_000);
        assert_eq!(Decimation::of(3_000_000).every, 1);
        assert_eq!(Decimation::of(921_600).every, 4);
        assert_eq!(Decimation::of(115_200).every, 32);
        assert_eq!(Decimation::of(0).every, 4000);
    }
}
