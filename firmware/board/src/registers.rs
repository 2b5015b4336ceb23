//! Registers of a peripheral, at offsets from its base.

/// A block of registers. On the board it is memory, on the host a model.
pub trait Registers {
    /// Reads 32 bits.
    fn read(&self, offset: usize) -> u32;
    /// Writes 32 bits.
    fn write(&self, offset: usize, value: u32);
    /// Reads 16 bits.
    fn read_half(&self, offset: usize) -> u16;
    /// Writes 16 bits.
    fn write_half(&self, offset: usize, value: u16);

    /// Sets and clears bits of a register.
    fn change(&self, offset: usize, clear: u32, set: u32) {
        self.write(offset, self.read(offset) & !clear | set);
    }

    /// Waits until `mask` reads `value`, for so many reads. Whether it came is for the caller to know.
    fn await_value(&self, offset: usize, mask: u32, value: u32, reads: u32) -> bool {
        (0..reads).any(|_| self.read(offset) & mask == value)
    }
}

impl<R: Registers> Registers for &R {
    fn read(&self, offset: usize) -> u32 {
        (**self).read(offset)
    }
    fn write(&self, offset: usize, value: u32) {
        (**self).write(offset, value);
    }
    fn read_half(&self, offset: usize) -> u16 {
        (**self).read_half(offset)
    }
    fn write_half(&self, offset: usize, value: u16) {
        (**self).write_half(offset, value);
    }
}

/// Registers in the processor's memory.
#[derive(Debug, Clone, Copy)]
pub struct Memory(usize);

impl Memory {
    /// The block at `base`.
    ///
    /// # Safety
    ///
    /// A peripheral's registers must lie there, mapped as device memory, and whoever shares them must agree.
    #[must_use]
    pub const unsafe fn at(base: usize) -> Self {
        Self(base)
    }
}

impl Registers for Memory {
    fn read(&self, offset: usize) -> u32 {
        // SAFETY: promised in `at`.
        unsafe { core::ptr::read_volatile((self.0 + offset) as *const u32) }
    }
    fn write(&self, offset: usize, value: u32) {
        // SAFETY: promised in `at`.
        unsafe { core::ptr::write_volatile((self.0 + offset) as *mut u32, value) }
    }
    fn read_half(&self, offset: usize) -> u16 {
        // SAFETY: promised in `at`.
        unsafe { core::ptr::read_volatile((self.0 + offset) as *const u16) }
    }
    fn write_half(&self, offset: usize, value: u16) {
        // SAFETY: promised in `at`.
        unsafe { core::ptr::write_volatile((self.0 + offset) as *mut u16, value) }
    }
}
