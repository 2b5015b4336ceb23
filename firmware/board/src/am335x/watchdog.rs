//! Hardware watchdog WDT1 (TRM SPRUH73, §20.4), from the 32,768 Hz clock. When it is not fed, it resets the processor: all pins become
//! inputs, and the pull-downs on the amplifiers' enable lines take the torque away.

use crate::registers::Registers;

const CONTROL: usize = 0x24;
const COUNTER: usize = 0x28;
const LOAD: usize = 0x2c;
const TRIGGER: usize = 0x30;
const PENDING: usize = 0x34;
const START_STOP: usize = 0x48;
const TRIGGER_PENDING: u32 = 1 << 3;

/// 32,768 Hz for 50 ms.
pub const TIMEOUT: u32 = 1638;

/// The watchdog.
pub struct Watchdog<R> {
    registers: R,
    trigger: u32,
}

impl<R: Registers> Watchdog<R> {
    /// With these registers.
    pub const fn new(registers: R) -> Self {
        Self { registers, trigger: 0 }
    }

    /// Writes wait for the slow clock: three of its periods, 92 µs.
    fn post(&self, offset: usize, value: u32) -> bool {
        self.registers.write(offset, value);
        self.registers.await_value(PENDING, 0x3f, 0, 100_000)
    }

    /// Bites [`TIMEOUT`] after the last feeding, from now on. Says whether the module answered.
    pub fn start(&mut self) -> bool {
        self.post(START_STOP, 0xaaaa)
            && self.post(START_STOP, 0x5555)
            && self.post(CONTROL, 0) // no prescaler
            && self.post(LOAD, 0_u32.wrapping_sub(TIMEOUT))
            && self.post(COUNTER, 0_u32.wrapping_sub(TIMEOUT))
            && self.post(START_STOP, 0xbbbb)
            && self.post(START_STOP, 0x4444)
    }

    /// Starts the time anew. While the last feeding is still under way there is nothing to do.
    pub fn feed(&mut self) {
        if self.registers.read(PENDING) & TRIGGER_PENDING == 0 {
            self.trigger = !self.trigger;
            self.registers.write(TRIGGER, self.trigger);
        }
    }
}
