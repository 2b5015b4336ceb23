//! Quadrature decoder eQEP inside a PWM subsystem (TRM SPRUH73, §15.1 and §15.4).
//!
//! Counts every edge of both lines over all 32 bits. The decoder flags that both lines changed at once but does not count how
//! often: what is counted here is in how many ticks it happened, so a burst within one tick is one.

use crate::registers::Registers;

/// From the subsystem's base.
const CLOCK_CONFIG: usize = 0x08;
const EQEP: usize = 0x180;

const POSITION: usize = EQEP;
const POSITION_INIT: usize = EQEP + 0x04;
const POSITION_MAX: usize = EQEP + 0x08;
const DECODER: usize = EQEP + 0x28;
const CONTROL: usize = EQEP + 0x2a;
const FLAGS: usize = EQEP + 0x32;
const FLAGS_CLEAR: usize = EQEP + 0x34;

const CLOCK: u32 = 1 << 4;
/// Runs on while a debugger holds the processor; starts again at the maximum; counts.
const COUNTING: u16 = 0b10 << 14 | 0b01 << 12 | 1 << 3;
const PHASE_ERROR: u16 = 1 << 2;

/// A decoder.
pub struct Eqep<R> {
    registers: R,
    errors: u32,
}

impl<R: Registers> Eqep<R> {
    /// The decoder of the PWM subsystem with these registers.
    pub const fn new(registers: R) -> Self {
        Self { registers, errors: 0 }
    }

    /// Counts from 0.
    pub fn start(&mut self) {
        self.registers.change(CLOCK_CONFIG, 0, CLOCK);
        self.registers.write_half(CONTROL, 0);
        self.registers.write_half(DECODER, 0); // quadrature, both lines as they are
        self.registers.write(POSITION_MAX, u32::MAX);
        self.registers.write(POSITION_INIT, 0);
        self.registers.write(POSITION, 0);
        self.registers.write_half(FLAGS_CLEAR, u16::MAX);
        self.registers.write_half(CONTROL, COUNTING);
    }

    /// The count; wraps at 2³².
    pub fn count(&self) -> u32 {
        self.registers.read(POSITION)
    }

    /// Ticks in which both lines changed at once; to be asked once a tick.
    pub fn errors(&mut self) -> u32 {
        if self.registers.read_half(FLAGS) & PHASE_ERROR != 0 {
            self.registers.write_half(FLAGS_CLEAR, PHASE_ERROR | 1);
            self.errors = self.errors.wrapping_add(1);
        }
        self.errors
    }
}
