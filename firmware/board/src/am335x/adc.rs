//! The motor currents: the touch-screen ADC (TRM SPRUH73, chapter 12), inputs AIN0 (y) and AIN1 (x), 12 bits over 1.8 V.
//!
//! Started when a tick ends and read when the next begins: a reading is at most one tick old. Four samples are averaged, 40 µs for both.

use crate::registers::Registers;

const CONTROL: usize = 0x40;
const CLOCK_DIVIDER: usize = 0x4c;
const STEP_ENABLE: usize = 0x54;
const STEP_CONFIG: [usize; 2] = [0x64, 0x6c];
const FIFO_COUNT: usize = 0xe4;
const FIFO: usize = 0x100;

/// Steps may be written, samples carry the number of their step.
const SETUP: u32 = 1 << 2 | 1 << 1;
const AVERAGE_4: u32 = 2 << 2;
/// Code of no current: half of 1.8 V.
const MIDDLE: i16 = 2048;

/// The ADC.
pub struct Adc<R> {
    registers: R,
    last: [i16; 2],
}

impl<R: Registers> Adc<R> {
    /// With these registers.
    pub const fn new(registers: R) -> Self {
        Self { registers, last: [0; 2] }
    }

    /// Sets both steps up and converts for the first time.
    pub fn start(&self) {
        self.registers.write(CONTROL, SETUP);
        self.registers.write(CLOCK_DIVIDER, 7); // 3 MHz
        for (input, offset) in (0..).zip(STEP_CONFIG) {
            self.registers.write(offset, AVERAGE_4 | input << 19 | 8 << 15); // against VREFN
        }
        self.registers.write(CONTROL, SETUP | 1);
        self.convert();
    }

    /// Converts both inputs once.
    pub fn convert(&self) {
        self.registers.write(STEP_ENABLE, 0b110);
    }

    /// The newest codes, signed about no current.
    pub fn read(&mut self) -> [i16; 2] {
        let waiting = self.registers.read(FIFO_COUNT) & 0x7f;
        for _ in 0..waiting {
            let sample = self.registers.read(FIFO);
            let code = (sample & 0xfff) as i16 - MIDDLE;
            if let Some(place) = self.last.get_mut((sample >> 16 & 0xf) as usize) {
                *place = code;
            }
        }
        self.last
    }
}
