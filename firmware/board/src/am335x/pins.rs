//! Pin multiplexer (TRM SPRUH73, §9.3: control module, registers `conf_…` at 0x44E1_0800 and up).
//!
//! Every line is on the BeagleBone Black's headers and used by neither eMMC nor the boot pins. Inputs are pulled up, and a switch
//! that opens (or a wire that breaks) reads as pressed.

use crate::registers::Registers;

/// Receiver on, pull-up.
const INPUT: u32 = 0x30;
/// Receiver off, no pull.
const OUTPUT: u32 = 0x08;

/// A pin: offset of its register, what is written there, where it is, what for.
pub struct Pin {
    /// Offset in the control module.
    pub offset: usize,
    /// Mode and electrical configuration.
    pub value: u32,
    /// On the headers.
    pub header: &'static str,
    /// What for.
    pub what: &'static str,
}

const fn pin(offset: usize, value: u32, header: &'static str, what: &'static str) -> Pin {
    Pin { offset, value, header, what }
}

/// All that are used.
pub const PINS: [Pin; 20] = [
    pin(0x984, OUTPUT, "P9_24", "UART1 to host"),
    pin(0x980, INPUT, "P9_26", "UART1 from host"),
    pin(0x950, INPUT, "P9_22", "SPI0 clock"), // the clock is read back: its receiver must be on
    pin(0x954, OUTPUT, "P9_21", "SPI0 to DAC"),
    pin(0x958, INPUT, "P9_18", "SPI0 from DAC"),
    pin(0x95c, OUTPUT, "P9_17", "SPI0 select DAC"),
    pin(0x9a0, INPUT | 1, "P9_42", "eQEP0 A: encoder y"),
    pin(0x964, 0x2f, "P9_42", "second ball of the same pin: listens to nothing"),
    pin(0x9a4, INPUT | 1, "P9_27", "eQEP0 B: encoder y"),
    pin(0x830, INPUT | 4, "P8_12", "eQEP2 A: encoder x"),
    pin(0x834, INPUT | 4, "P8_11", "eQEP2 B: encoder x"),
    pin(0x878, INPUT | 7, "P9_12", "GPIO1_28: emergency-stop chain"),
    pin(0x840, INPUT | 7, "P9_15", "GPIO1_16: y low end"),
    pin(0x844, INPUT | 7, "P9_23", "GPIO1_17: y high end"),
    pin(0x848, INPUT | 7, "P9_14", "GPIO1_18: x low end"),
    pin(0x84c, INPUT | 7, "P9_16", "GPIO1_19: x high end"),
    pin(0x838, INPUT | 7, "P8_16", "GPIO1_14: amplifier y fault"),
    pin(0x83c, INPUT | 7, "P8_15", "GPIO1_15: amplifier x fault"),
    pin(0x828, OUTPUT | 7, "P8_14", "GPIO0_26: enable y"),
    pin(0x82c, OUTPUT | 7, "P8_17", "GPIO0_27: enable x"),
];

/// Lines of GPIO1, all inputs: 1 is open, pressed, not ready.
pub mod line {
    /// Emergency-stop chain.
    pub const ESTOP: u32 = 1 << 28;
    /// Low end switches, y and x.
    pub const LOW: [u32; 2] = [1 << 16, 1 << 18];
    /// High end switches.
    pub const HIGH: [u32; 2] = [1 << 17, 1 << 19];
    /// The amplifiers' fault outputs.
    pub const FAULT: [u32; 2] = [1 << 14, 1 << 15];
    /// The amplifiers' enable inputs, lines of GPIO0.
    pub const ENABLE: [u32; 2] = [1 << 26, 1 << 27];
}

/// Configures all of them.
pub fn start<R: Registers>(control: &R) {
    for pin in &PINS {
        control.write(pin.offset, pin.value);
    }
}
