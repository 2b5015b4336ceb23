//! UART PL011 (ARM DDI 0183), polled.

use core::cell::Cell;

use crate::registers::Registers;

const DATA: usize = 0x00;
const FLAGS: usize = 0x18;
const LINE_CONTROL: usize = 0x2c;
const CONTROL: usize = 0x30;
const INTERRUPT_MASK: usize = 0x38;

const RECEIVE_EMPTY: u32 = 1 << 4;
const TRANSMIT_FULL: u32 = 1 << 5;
/// A byte has come, or has waited for its successor.
const RECEIVE_INTERRUPTS: u32 = 1 << 4 | 1 << 6;
/// In the data register, beside the byte: the one before it was overwritten.
const OVERRUN: u32 = 1 << 11;

/// A serial port.
pub struct Pl011<R> {
    registers: R,
    overflows: Cell<u32>,
}

impl<R: Registers> Pl011<R> {
    /// The port with these registers.
    pub const fn new(registers: R) -> Self {
        Self { registers, overflows: Cell::new(0) }
    }

    /// 8N1 with FIFOs, both directions.
    pub fn start(&self) {
        self.registers.write(CONTROL, 0);
        self.registers.write(LINE_CONTROL, 0b111 << 4);
        self.registers.write(CONTROL, 0b11 << 8 | 1);
    }

    /// No byte is waiting.
    pub fn is_quiet(&self) -> bool {
        self.registers.read(FLAGS) & RECEIVE_EMPTY != 0
    }

    /// Whether the next byte shall interrupt.
    pub fn interrupt_on_byte(&self, shall: bool) {
        self.registers.write(INTERRUPT_MASK, if shall { RECEIVE_INTERRUPTS } else { 0 });
    }

    /// The next byte, if one has come.
    pub fn read(&self) -> Option<u8> {
        if self.registers.read(FLAGS) & RECEIVE_EMPTY != 0 {
            return None;
        }
        let data = self.registers.read(DATA);
        if data & OVERRUN != 0 {
            self.overflows.set(self.overflows.get().wrapping_add(1));
        }
        Some(data as u8)
    }

    /// Takes a byte unless the FIFO is full.
    pub fn write(&self, byte: u8) -> bool {
        let has_room = self.registers.read(FLAGS) & TRANSMIT_FULL == 0;
        if has_room {
            self.registers.write(DATA, u32::from(byte));
        }
        has_room
    }

    /// Times that bytes were overwritten.
    pub fn overflows(&self) -> u32 {
        self.overflows.get()
    }
}
