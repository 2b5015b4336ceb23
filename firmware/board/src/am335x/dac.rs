//! The drive commands: a dual DAC of ± 10 V (AD5752R) on McSPI0 (TRM SPRUH73, chapter 24).
//!
//! Words of 24 bits at 12 MHz, select low for each: 2 µs a word, sent while the program goes on. The DAC takes two's complement
//! (pin BIN/2sCOMP low) and puts each word out at once (pin LDAC low).

use crate::registers::Registers;

/// From the module's base: the AM335x keeps the registers of older OMAPs 0x100 up.
const SYSTEM_CONFIG: usize = 0x110;
const SYSTEM_STATUS: usize = 0x114;
const MODULE_CONTROL: usize = 0x128;
const CHANNEL_CONFIG: usize = 0x12c;
const CHANNEL_STATUS: usize = 0x130;
const CHANNEL_CONTROL: usize = 0x134;
const TRANSMIT: usize = 0x138;

const TRANSMIT_EMPTY: u32 = 1 << 1;
/// Data on the falling edge of a clock that idles low; 48 MHz / 4; select active low; 24 bits; transmit only, on line D0; one and a half
/// clocks between select and clock.
const WORDS_OF_24: u32 = 1 | 2 << 2 | 1 << 6 | 23 << 7 | 2 << 12 | 1 << 17 | 1 << 18 | 1 << 25;
/// A word takes 2 µs; nothing healthy needs this many reads.
const READS: u32 = 2_000;

/// Registers of the DAC, as the first byte of a word (read/write, 0, register, address).
mod register {
    pub const OUTPUT: [u32; 2] = [0x00 << 16, 0x02 << 16];
    pub const RANGE_BOTH: u32 = 0x0c << 16;
    pub const POWER: u32 = 0x10 << 16;
}
const RANGE_10_V: u32 = 0b100;
/// Both outputs and the internal reference.
const POWER_ALL: u32 = 1 | 1 << 2 | 1 << 4;

/// The DAC.
pub struct Dac<R> {
    registers: R,
}

impl<R: Registers> Dac<R> {
    /// On the module with these registers.
    pub const fn new(registers: R) -> Self {
        Self { registers }
    }

    /// ± 10 V on both outputs, 0 V on them, powered. Says whether the module answered.
    pub fn start(&self) -> bool {
        let r = &self.registers;
        r.write(SYSTEM_CONFIG, 1 << 1);
        let is_reset = r.await_value(SYSTEM_STATUS, 1, 1, 10_000);
        r.write(SYSTEM_CONFIG, 0b11 << 8 | 0b01 << 3); // clocks kept, never idle
        r.write(MODULE_CONTROL, 0); // master; select goes with every word
        r.write(CHANNEL_CONFIG, WORDS_OF_24);
        r.write(CHANNEL_CONTROL, 1);
        is_reset
            && self.send(register::RANGE_BOTH | RANGE_10_V)
            && self.put([0; 2])
            && self.send(register::POWER | POWER_ALL)
    }

    /// Both codes. Says whether they could be sent.
    pub fn put(&self, codes: [i16; 2]) -> bool {
        let [y, x] = codes.map(|code| u32::from(code as u16));
        let [to_y, to_x] = register::OUTPUT;
        self.send(to_y | y) && self.send(to_x | x)
    }

    fn send(&self, word: u32) -> bool {
        let has_room = self.registers.await_value(CHANNEL_STATUS, TRANSMIT_EMPTY, TRANSMIT_EMPTY, READS);
        if has_room {
            self.registers.write(TRANSMIT, word);
        }
        has_room
    }
}
