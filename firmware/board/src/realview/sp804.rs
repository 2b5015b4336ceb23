//! Dual timer SP804 (ARM DDI 0271): its first half, periodic.

use crate::registers::Registers;

const LOAD: usize = 0x00;
const CONTROL: usize = 0x08;
const CLEAR: usize = 0x0c;
/// Enabled, periodic, interrupt, 32 bits, no prescaler.
const PERIODIC: u32 = 1 << 7 | 1 << 6 | 1 << 5 | 1 << 1;

/// A periodic timer.
pub struct Sp804<R> {
    registers: R,
}

impl<R: Registers> Sp804<R> {
    /// The timer with these registers.
    pub const fn new(registers: R) -> Self {
        Self { registers }
    }

    /// Interrupts every `period` of its clock.
    pub fn start(&self, period: u32) {
        self.registers.write(CONTROL, 0);
        self.registers.write(CLEAR, 1);
        self.registers.write(LOAD, period);
        self.registers.write(CONTROL, PERIODIC);
    }

    /// The interrupt was seen.
    pub fn clear(&self) {
        self.registers.write(CLEAR, 1);
    }
}
