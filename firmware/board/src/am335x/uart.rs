//! Serial port (TRM SPRUH73, chapter 19), polled, with its FIFOs of 64 bytes.
//!
//! Clocked with 48 MHz, sixteen times oversampled: 3 Mbaud is the divisor 1. 921,600 is only reached with the 13 times oversampling mode
//! and the divisor 4 (923,077 baud, 0.16 % fast).

use core::cell::Cell;

use crate::registers::Registers;

const DATA: usize = 0x00;
const DIVISOR_HIGH: usize = 0x04;
const FIFO_CONTROL: usize = 0x08;
const LINE_CONTROL: usize = 0x0c;
const LINE_STATUS: usize = 0x14;
const MODE: usize = 0x20;
const SUPPLEMENTARY_STATUS: usize = 0x44;
const SYSTEM_CONFIG: usize = 0x54;
const SYSTEM_STATUS: usize = 0x58;

const DATA_READY: u32 = 1;
const OVERRUN: u32 = 1 << 1;
const TRANSMIT_FULL: u32 = 1;

const CLOCK_HZ: u32 = 48_000_000;

/// Oversampling mode and divisor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rate {
    mode: u32,
    divisor: u32,
}

impl Rate {
    /// What comes nearest to `baud`.
    #[must_use]
    pub const fn of(baud: u32) -> Self {
        let by_16 = Self { mode: 0, divisor: (CLOCK_HZ / 16 + baud / 2) / baud };
        let by_13 = Self { mode: 3, divisor: (CLOCK_HZ / 13 + baud / 2) / baud };
        if by_16.divisor > 0 && by_16.baud().abs_diff(baud) <= by_13.baud().abs_diff(baud) { by_16 } else { by_13 }
    }

    /// The baud rate that comes out.
    #[must_use]
    pub const fn baud(self) -> u32 {
        let oversampling = if self.mode == 0 { 16 } else { 13 };
        match CLOCK_HZ.checked_div(oversampling * self.divisor) {
            Some(baud) => baud,
            None => 0,
        }
    }
}

/// A serial port.
pub struct Uart<R> {
    registers: R,
    overflows: Cell<u32>,
}

impl<R: Registers> Uart<R> {
    /// The port with these registers.
    pub const fn new(registers: R) -> Self {
        Self { registers, overflows: Cell::new(0) }
    }

    /// 8N1 at this rate. Says whether the module answered.
    pub fn start(&self, rate: Rate) -> bool {
        let r = &self.registers;
        r.write(SYSTEM_CONFIG, 1 << 1);
        let is_reset = r.await_value(SYSTEM_STATUS, 1, 1, 10_000);
        r.write(SYSTEM_CONFIG, 1 << 3); // never idle
        r.write(MODE, 7); // off while it is set up
        r.write(LINE_CONTROL, 0x80); // divisor latch
        r.write(DATA, 0);
        r.write(DIVISOR_HIGH, 0); // the FIFOs can only be turned on while the baud clock stands
        r.write(FIFO_CONTROL, 0b111);
        r.write(DATA, rate.divisor & 0xff);
        r.write(DIVISOR_HIGH, rate.divisor >> 8);
        r.write(LINE_CONTROL, 0b11);
        r.write(MODE, rate.mode);
        is_reset
    }

    /// The next byte, if one has come.
    pub fn read(&self) -> Option<u8> {
        let status = self.registers.read(LINE_STATUS);
        if status & OVERRUN != 0 {
            self.overflows.set(self.overflows.get().wrapping_add(1));
        }
        (status & DATA_READY != 0).then(|| self.registers.read(DATA) as u8)
    }

    /// Takes a byte unless the FIFO is full.
    pub fn write(&self, byte: u8) -> bool {
        let has_room = self.registers.read(SUPPLEMENTARY_STATUS) & TRANSMIT_FULL == 0;
        if has_room {
            self.registers.write(DATA, u32::from(byte));
        }
        has_room
    }

    /// Times that bytes were lost.
    pub fn overflows(&self) -> u32 {
        self.overflows.get()
    }
}
