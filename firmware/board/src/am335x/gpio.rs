//! General-purpose lines (TRM SPRUH73, chapter 25).

use crate::registers::Registers;

const OUTPUT_DISABLE: usize = 0x134;
const DATA_IN: usize = 0x138;
const CLEAR: usize = 0x190;
const SET: usize = 0x194;

/// A bank of 32 lines.
pub struct Gpio<R> {
    registers: R,
}

impl<R: Registers> Gpio<R> {
    /// The bank with these registers.
    pub const fn new(registers: R) -> Self {
        Self { registers }
    }

    /// Makes outputs of these lines, low from the first moment.
    pub fn start_outputs(&self, lines: u32) {
        self.registers.write(CLEAR, lines);
        self.registers.change(OUTPUT_DISABLE, lines, 0);
    }

    /// All lines as they are.
    pub fn read(&self) -> u32 {
        self.registers.read(DATA_IN)
    }

    /// Sets these lines high or low.
    pub fn put(&self, lines: u32, is_high: bool) {
        self.registers.write(if is_high { SET } else { CLEAR }, lines);
    }
}
