//! What the application asks of a board.

use froude_control::tick::{AXES, Command};
use froude_link::status::BoardId;

/// Slow inputs of one axis, and the current's raw code.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct AxisLatched {
    /// Hardware count of the decoder.
    pub encoder_count: u32,
    /// Illegal transitions seen by the decoder; wraps.
    pub encoder_errors: u32,
    /// Code of the current's ADC.
    pub current_counts: i16,
    /// The low end switch is open.
    pub is_low_end: bool,
    /// The high end switch is open.
    pub is_high_end: bool,
    /// The amplifier is ready.
    pub is_amplifier_ready: bool,
}

/// All inputs of a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Latched {
    /// When, µs; wraps.
    pub latched_us: u32,
    /// Ticks since the last one that was taken, 1 if none was missed.
    pub ticks: u32,
    /// The axes.
    pub axes: [AxisLatched; AXES],
    /// The emergency-stop chain is open.
    pub is_estop_open: bool,
}

/// How counts are read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Volts of a DAC count.
    pub command_v_per_count: [f64; AXES],
    /// Amperes of an ADC count.
    pub current_a_per_count: [f64; AXES],
}

/// A board. Nothing here waits longer than a few µs.
pub trait Board {
    /// Kind of board.
    const ID: BoardId;
    /// Baud rate of the serial line.
    const BAUD: u32;

    /// How counts are read.
    fn scales(&self) -> Scales;
    /// Something that differs from power-up to power-up, if there is such a thing.
    fn boot_number(&self) -> u32;
    /// The last reset was the watchdog's.
    fn was_watchdog_reset(&self) -> bool;
    /// Now, µs; wraps.
    fn now_us(&mut self) -> u32;
    /// The inputs, if a tick came that was not taken yet.
    fn take_tick(&mut self) -> Option<Latched>;
    /// Puts the commands out and says which codes the DAC got.
    fn actuate(&mut self, command: &Command) -> [i16; AXES];
    /// A byte from the serial port.
    fn read_byte(&mut self) -> Option<u8>;
    /// A byte for the serial port, unless it is full.
    fn write_byte(&mut self, byte: u8) -> bool;
    /// Bytes that the serial port lost; wraps.
    fn port_overflows(&self) -> u32;
    /// The main loop is alive. Only called after a tick was stepped in time.
    fn feed_watchdog(&mut self);
}
