//! Interrupt controller of the AM335x (TRM SPRUH73, chapter 6): one interrupt, as IRQ.

use crate::registers::Registers;

const SYSCONFIG: usize = 0x10;
const SYSSTATUS: usize = 0x14;
const ACTIVE: usize = 0x40;
const CONTROL: usize = 0x48;
const THRESHOLD: usize = 0x68;

/// The controller.
pub struct Intc<R> {
    registers: R,
}

impl<R: Registers> Intc<R> {
    /// The controller with these registers.
    pub const fn new(registers: R) -> Self {
        Self { registers }
    }

    /// Resets it and lets one interrupt through.
    pub fn start(&self, interrupt: u32) -> bool {
        self.registers.write(SYSCONFIG, 1 << 1);
        let is_reset = self.registers.await_value(SYSSTATUS, 1, 1, 10_000);
        self.registers.write(THRESHOLD, 0xff); // no priority is held back
        self.registers.write(0x100 + 4 * interrupt as usize, 0); // IRQ, highest priority
        self.registers.write(0x88 + 0x20 * (interrupt as usize / 32), 1 << (interrupt % 32)); // unmask
        is_reset
    }

    /// The active interrupt; `None` if it is spurious.
    pub fn active(&self) -> Option<u32> {
        let active = self.registers.read(ACTIVE);
        (active >> 7 == 0).then_some(active & 0x7f)
    }

    /// It was dealt with; the next may come.
    pub fn complete(&self) {
        self.registers.write(CONTROL, 1);
        core::sync::atomic::fence(core::sync::atomic::Ordering::SeqCst);
    }
}
