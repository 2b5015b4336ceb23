//! Generic interrupt controller (ARM IHI 0048): one interrupt, one processor.

use crate::registers::Registers;

/// Processor interface and distributor.
pub struct Gic<R> {
    cpu: R,
    distributor: R,
}

impl<R: Registers> Gic<R> {
    /// The controller with these two blocks.
    pub const fn new(cpu: R, distributor: R) -> Self {
        Self { cpu, distributor }
    }

    /// Lets one shared interrupt through, to processor 0, at the middle priority.
    pub fn enable(&self, interrupt: u32) {
        let (word, bit) = (interrupt as usize / 32 * 4, 1 << (interrupt % 32));
        let (byte, shift) = (interrupt as usize / 4 * 4, interrupt % 4 * 8);
        self.distributor.change(0x400 + byte, 0xff << shift, 0x80 << shift); // priority
        self.distributor.change(0x800 + byte, 0xff << shift, 0x01 << shift); // target
        self.distributor.write(0x100 + word, bit); // set-enable
        self.distributor.write(0x000, 1);
        self.cpu.write(0x004, 0xff); // no priority is masked
        self.cpu.write(0x000, 1);
    }

    /// The pending interrupt's number; 1023 is none.
    pub fn acknowledge(&self) -> u32 {
        self.cpu.read(0x00c) & 0x3ff
    }

    /// It was dealt with.
    pub fn complete(&self, interrupt: u32) {
        self.cpu.write(0x010, interrupt);
    }
}
