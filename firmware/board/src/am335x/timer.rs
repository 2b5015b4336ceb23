//! DMTimer (TRM SPRUH73, §20.1), from the 24 MHz crystal.

use crate::registers::Registers;

const CONFIG: usize = 0x10;
const STATUS: usize = 0x28;
const ENABLE_SET: usize = 0x2c;
const CONTROL: usize = 0x38;
const COUNTER: usize = 0x3c;
const LOAD: usize = 0x40;

const OVERFLOW: u32 = 1 << 1;
const START_WITH_RELOAD: u32 = 1 << 1 | 1;

/// A timer that counts up and starts again from its load value.
pub struct Timer<R> {
    registers: R,
}

impl<R: Registers> Timer<R> {
    /// The timer with these registers.
    pub const fn new(registers: R) -> Self {
        Self { registers }
    }

    fn start_from(&self, load: u32) -> bool {
        self.registers.write(CONFIG, 1);
        let is_reset = self.registers.await_value(CONFIG, 1, 0, 10_000);
        self.registers.write(LOAD, load);
        self.registers.write(COUNTER, load);
        is_reset
    }

    /// Interrupts every `period` of the crystal. Says whether the module answered.
    pub fn start_periodic(&self, period: u32) -> bool {
        let is_reset = self.start_from(0_u32.wrapping_sub(period));
        self.registers.write(STATUS, OVERFLOW);
        self.registers.write(ENABLE_SET, OVERFLOW);
        self.registers.write(CONTROL, START_WITH_RELOAD);
        is_reset
    }

    /// Counts through all 32 bits. Says whether the module answered.
    pub fn start_free(&self) -> bool {
        let is_reset = self.start_from(0);
        self.registers.write(CONTROL, START_WITH_RELOAD);
        is_reset
    }

    /// Where it is.
    pub fn counter(&self) -> u32 {
        self.registers.read(COUNTER)
    }

    /// The interrupt was seen. Read back, so that the line is low before the controller is asked for the next one.
    pub fn clear(&self) {
        self.registers.write(STATUS, OVERFLOW);
        let _ = self.registers.read(STATUS);
    }
}
