//! What the timer's interrupt leaves for the main loop.
//!
//! The handler does nothing but read time and encoders and count; floating point, decisions and outputs are the main loop's.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Time and encoders of the last tick. Written by the interrupt, read by the main loop of the same processor.
#[derive(Debug)]
pub struct TickLatch {
    number: AtomicU32,
    counter: AtomicU32,
    encoders: [AtomicU32; 2],
}

/// One latched tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LatchedTick {
    /// Ticks since the timer was started; wraps.
    pub number: u32,
    /// Free-running counter at the tick, in its own steps.
    pub counter: u32,
    /// Hardware counts of the encoders.
    pub encoders: [u32; 2],
}

impl Default for TickLatch {
    fn default() -> Self {
        Self::new()
    }
}

impl TickLatch {
    /// No tick yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { number: AtomicU32::new(0), counter: AtomicU32::new(0), encoders: [AtomicU32::new(0), AtomicU32::new(0)] }
    }

    /// From the interrupt: a tick came.
    pub fn latch(&self, counter: u32, encoders: [u32; 2]) {
        let [y, x] = &self.encoders;
        self.counter.store(counter, Relaxed);
        y.store(encoders[0], Relaxed);
        x.store(encoders[1], Relaxed);
        self.number.store(self.number.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// Number of the last tick.
    #[must_use]
    pub fn number(&self) -> u32 {
        self.number.load(Relaxed)
    }

    /// The last tick, whole: read again if the interrupt came in between.
    #[must_use]
    pub fn read(&self) -> LatchedTick {
        loop {
            let number = self.number();
            let [y, x] = &self.encoders;
            let latched = LatchedTick {
                number,
                counter: self.counter.load(Relaxed),
                encoders: [y.load(Relaxed), x.load(Relaxed)],
            };
            if self.number() == number {
                return latched;
            }
        }
    }
}

/// Microseconds out of a free-running counter of 24 MHz; both wrap at 2³², the counter every 179 s.
#[derive(Debug, Clone, Copy, Default)]
pub struct Microseconds {
    counter: u32,
    us: u32,
}

/// Steps of the counter in a µs.
pub const COUNTER_MHZ: u32 = 24;

impl Microseconds {
    /// Starts at zero with the counter where it is.
    #[must_use]
    pub const fn starting_at(counter: u32) -> Self {
        Self { counter, us: 0 }
    }

    /// The time at this reading of the counter. To be asked at least every 179 s.
    pub fn at(&mut self, counter: u32) -> u32 {
        let whole = counter.wrapping_sub(self.counter) / COUNTER_MHZ;
        self.us = self.us.wrapping_add(whole);
        self.counter = self.counter.wrapping_add(whole.wrapping_mul(COUNTER_MHZ)); // the rest stays for the next time
        self.us
    }

    /// The same, without moving on: also for readings just before the last one.
    #[must_use]
    pub fn peek(&self, counter: u32) -> u32 {
        let step = counter.wrapping_sub(self.counter) as i32;
        self.us.wrapping_add_signed(step.div_euclid(COUNTER_MHZ as i32))
    }
}
