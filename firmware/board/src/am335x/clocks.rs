//! Module clocks of the AM335x (TRM SPRUH73, chapter 8: CM_PER, CM_WKUP, CM_DPLL).

use crate::registers::Registers;

/// Module is wanted.
const ENABLE: u32 = 2;
const MODULE_MODE: u32 = 0b11;
/// It works when this field is 0.
const IDLE_STATUS: u32 = 0b11 << 16;
/// A module that takes longer than this many reads will not come.
const READS: u32 = 100_000;

/// Offsets in CM_PER (0x44E0_0000) of the modules used.
pub const PER: [(usize, &str); 7] = [
    (0x6c, "UART1"),
    (0x4c, "SPI0"),
    (0x80, "TIMER2"),
    (0x84, "TIMER3"),
    (0xac, "GPIO1"),
    (0xd4, "EPWMSS0"),
    (0xd8, "EPWMSS2"),
];
/// Offsets in CM_WKUP (0x44E0_0400).
pub const WAKE_UP: [(usize, &str); 3] = [(0x08, "GPIO0"), (0xbc, "ADC_TSC"), (0xd4, "WDT1")];
/// CM_PER_L4LS_CLKSTCTRL: the domain of the slow peripherals.
const L4LS: usize = 0x00;
/// CLKSEL_TIMER2_CLK and CLKSEL_TIMER3_CLK in CM_DPLL (0x44E0_0500).
const TIMER_SOURCES: [usize; 2] = [0x08, 0x0c];
/// The 24 MHz crystal.
const CRYSTAL: u32 = 1;

/// Turns on every module that the carriage needs.
///
/// # Errors
///
/// The name of the first module that does not come up.
pub fn start<R: Registers>(per: &R, wake_up: &R, dpll: &R) -> Result<(), &'static str> {
    per.change(L4LS, MODULE_MODE, ENABLE);
    for source in TIMER_SOURCES {
        dpll.write(source, CRYSTAL);
    }
    enable(per, &PER)?;
    enable(wake_up, &WAKE_UP)
}

fn enable<R: Registers>(block: &R, modules: &[(usize, &'static str)]) -> Result<(), &'static str> {
    for &(offset, name) in modules {
        block.change(offset, MODULE_MODE, ENABLE);
        if !block.await_value(offset, IDLE_STATUS | MODULE_MODE, ENABLE, READS) {
            return Err(name);
        }
    }
    Ok(())
}
