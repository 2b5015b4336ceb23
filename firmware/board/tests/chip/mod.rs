//! A model of the AM335x's peripherals, as far as the drivers use them.
//!
//! It does what the manual says and is strict where the chip is: a register of a module whose clock is off faults the bus, here it
//! panics. Time stands still until [`Chip::advance`] moves it, in steps of the 24 MHz crystal.

#![allow(dead_code)]

use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};
use std::rc::Rc;

use froude_board::am335x::Blocks;
use froude_board::registers::Registers;

/// Which block of registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum At {
    Per,
    WakeUp,
    Dpll,
    Reset,
    Control,
    Uart,
    Timer,
    Counter,
    Intc,
    PwmY,
    PwmX,
    Spi,
    Adc,
    Watchdog,
    Gpio0,
    Gpio1,
}

/// The clock that a block needs: where its control register is.
fn clock_of(at: At) -> Option<(At, usize)> {
    Some(match at {
        At::Uart => (At::Per, 0x6c),
        At::Timer => (At::Per, 0x80),
        At::Counter => (At::Per, 0x84),
        At::PwmY => (At::Per, 0xd4),
        At::PwmX => (At::Per, 0xd8),
        At::Spi => (At::Per, 0x4c),
        At::Gpio1 => (At::Per, 0xac),
        At::Gpio0 => (At::WakeUp, 0x08),
        At::Adc => (At::WakeUp, 0xbc),
        At::Watchdog => (At::WakeUp, 0xd4),
        _ => return None,
    })
}

/// One quadrature decoder and the lines of its encoder.
#[derive(Debug, Default, Clone)]
pub struct Decoder {
    pub lines: (bool, bool),
    pub position: u32,
    pub flags: u16,
}

#[derive(Debug, Default)]
pub struct State {
    pub registers: BTreeMap<(At, usize), u32>,
    /// Modules that never come up.
    pub dead: Vec<(At, usize)>,
    pub sent: Vec<u8>,
    pub transmit: VecDeque<u8>,
    pub receive: VecDeque<u8>,
    pub overrun: bool,
    pub timer: u32,
    pub counter: u32,
    pub overflow: bool,
    pub decoders: [Decoder; 2],
    /// DAC: range and power as written, and the outputs, V.
    pub range: Option<u32>,
    pub power: Option<u32>,
    pub volts: [f64; 2],
    pub is_dac_stuck: bool,
    pub currents: [u32; 2],
    pub samples: VecDeque<u32>,
    pub watchdog_left: Option<u32>,
    pub watchdog_word: u32,
    pub has_bitten: bool,
    pub inputs: u32,
    pub outputs: u32,
    pub interrupt_masked: bool,
    pub in_service: bool,
}

/// The chip.
#[derive(Debug, Clone, Default)]
pub struct Chip(pub Rc<RefCell<State>>);

/// One of its blocks.
#[derive(Debug, Clone)]
pub struct Block(Chip, At);

impl Chip {
    pub fn new() -> Self {
        let chip = Self::default();
        chip.0.borrow_mut().interrupt_masked = true;
        chip
    }

    pub fn block(&self, at: At) -> Block {
        Block(self.clone(), at)
    }

    pub fn blocks(&self) -> Blocks<Block> {
        let b = |at| self.block(at);
        Blocks {
            clocks_per: b(At::Per),
            clocks_wake_up: b(At::WakeUp),
            clocks_dpll: b(At::Dpll),
            reset: b(At::Reset),
            control: b(At::Control),
            uart: b(At::Uart),
            timer: b(At::Timer),
            counter: b(At::Counter),
            intc: b(At::Intc),
            pwm: [b(At::PwmY), b(At::PwmX)],
            spi: b(At::Spi),
            adc: b(At::Adc),
            watchdog: b(At::Watchdog),
            gpio_0: b(At::Gpio0),
            gpio_1: b(At::Gpio1),
        }
    }

    pub fn with<T>(&self, f: impl FnOnce(&mut State) -> T) -> T {
        f(&mut self.0.borrow_mut())
    }

    /// What was last written somewhere.
    pub fn written(&self, at: At, offset: usize) -> u32 {
        self.with(|s| s.registers.get(&(at, offset)).copied().unwrap_or(0))
    }

    /// Whether the processor is interrupted now.
    pub fn is_interrupted(&self) -> bool {
        let is_enabled = self.written(At::Timer, 0x2c) & 2 != 0;
        self.with(|s| s.overflow && is_enabled && !s.interrupt_masked)
    }

    /// Time passes: timers count, the serial port sends at its baud rate, the watchdog starves.
    pub fn advance(&self, steps: u32) {
        let load = self.written(At::Timer, 0x40);
        let (runs_timer, runs_counter) =
            (self.written(At::Timer, 0x38) & 1 == 1, self.written(At::Counter, 0x38) & 1 == 1);
        self.with(|s| {
            if runs_timer {
                let (next, has_wrapped) = s.timer.overflowing_add(steps);
                s.timer = if has_wrapped { load.wrapping_add(next) } else { next };
                s.overflow |= has_wrapped;
            }
            if runs_counter {
                s.counter = s.counter.wrapping_add(steps);
            }
            if let Some(left) = &mut s.watchdog_left {
                // 32,768 Hz against 24 MHz
                *left = left.saturating_sub((u64::from(steps) * 32_768).div_ceil(24_000_000) as u32);
                s.has_bitten |= *left == 0;
            }
            // 3 Mbaud are 80 crystal steps a byte.
            for _ in 0..steps / 80 {
                let Some(byte) = s.transmit.pop_front() else { break };
                s.sent.push(byte);
            }
        });
    }

    /// A byte comes in from the host.
    pub fn receive(&self, byte: u8) {
        self.with(|s| if s.receive.len() < 64 { s.receive.push_back(byte) } else { s.overrun = true });
    }

    /// The encoder's lines become these.
    pub fn set_lines(&self, axis: usize, lines: (bool, bool)) {
        let at = [At::PwmY, At::PwmX][axis];
        let counts = self.written(at, 0x180 + 0x2a) & (1 << 3) != 0
            && self.written(at, 0x08) & (1 << 4) != 0
            && self.written(at, 0x180 + 0x28) & 0xc000 == 0;
        let max = self.written(at, 0x180 + 0x08);
        self.with(|s| {
            let decoder = &mut s.decoders[axis];
            let was = std::mem::replace(&mut decoder.lines, lines);
            if !counts || was == lines {
                return;
            }
            // A leads B: 00 → 10 → 11 → 01 counts up.
            let phase = |(a, b): (bool, bool)| [0, 1, 3, 2][usize::from(a) + 2 * usize::from(b)];
            match (phase(lines) + 4 - phase(was)) % 4 {
                1 => decoder.position = if decoder.position == max { 0 } else { decoder.position + 1 },
                3 => decoder.position = if decoder.position == 0 { max } else { decoder.position - 1 },
                _ => decoder.flags |= 1 << 2 | 1,
            }
        });
    }

    /// The encoder moves by so many edges.
    pub fn turn(&self, axis: usize, edges: i32) {
        const CYCLE: [(bool, bool); 4] = [(false, false), (true, false), (true, true), (false, true)];
        for _ in 0..edges.abs() {
            let lines = self.with(|s| s.decoders[axis].lines);
            let at = CYCLE.iter().position(|&l| l == lines).unwrap();
            self.set_lines(axis, CYCLE[(at + if edges > 0 { 1 } else { 3 }) % 4]);
        }
    }

    fn check_clock(&self, at: At) {
        if let Some((block, offset)) = clock_of(at) {
            let is_on = self.written(block, offset) & 3 == 2 && self.with(|s| !s.dead.contains(&(block, offset)));
            assert!(is_on, "{at:?} was touched while its clock was off: the bus would fault");
        }
    }
}

impl Registers for Block {
    fn read(&self, offset: usize) -> u32 {
        let Self(chip, at) = self;
        chip.check_clock(*at);
        let stored = chip.written(*at, offset);
        chip.with(|s| match (at, offset) {
            (At::Per | At::WakeUp, _) => {
                let is_up = stored & 3 == 2 && !s.dead.contains(&(*at, offset));
                stored & 3 | if is_up { 0 } else { 3 << 16 }
            }
            (At::Uart, 0x58) | (At::Spi, 0x114) | (At::Intc, 0x14) => 1,
            (At::Timer | At::Counter, 0x10) => stored & !1,
            (At::Timer, 0x28) => u32::from(s.overflow) << 1,
            (At::Timer, 0x3c) => s.timer,
            (At::Counter, 0x3c) => s.counter,
            (At::Intc, 0x40) => {
                if s.overflow && !s.in_service {
                    s.in_service = true;
                    68
                } else {
                    0xffff_ff80 // spurious
                }
            }
            (At::Uart, 0x14) => u32::from(!s.receive.is_empty()) | u32::from(std::mem::take(&mut s.overrun)) << 1,
            (At::Uart, 0x44) => u32::from(s.transmit.len() >= 64),
            (At::Uart, 0x00) => u32::from(s.receive.pop_front().unwrap_or(0)),
            (At::PwmY, 0x180) => s.decoders[0].position,
            (At::PwmX, 0x180) => s.decoders[1].position,
            (At::Spi, 0x130) => u32::from(!s.is_dac_stuck) << 1,
            (At::Adc, 0xe4) => s.samples.len() as u32,
            (At::Adc, 0x100) => s.samples.pop_front().unwrap_or(0),
            (At::Watchdog, 0x34) => 0,
            (At::Gpio1, 0x138) => s.inputs,
            _ => stored,
        })
    }

    fn write(&self, offset: usize, value: u32) {
        let Self(chip, at) = self;
        chip.check_clock(*at);
        let divisor = chip.written(At::Uart, 0x0c) & 0x80 != 0;
        let wldr = chip.written(At::Watchdog, 0x2c);
        let trigger = chip.written(At::Watchdog, 0x30);
        let step = |k: usize| chip.written(At::Adc, [0x64, 0x6c][k]);
        let steps = [step(0), step(1)];
        let spi = (chip.written(At::Spi, 0x12c), chip.written(At::Spi, 0x134));
        chip.with(|s| {
            match (at, offset) {
                (At::Uart, 0x00) if !divisor => {
                    assert!(s.transmit.len() < 64, "the FIFO was full");
                    s.transmit.push_back(value as u8);
                    return;
                }
                (At::Timer, 0x28) => s.overflow &= value & 2 == 0,
                (At::Timer, 0x3c) => s.timer = value,
                (At::Counter, 0x3c) => s.counter = value,
                (At::Intc, 0xc8) => s.interrupt_masked &= value & (1 << 4) == 0, // 68 = 2·32 + 4
                (At::Intc, 0x48) => s.in_service = false,
                (At::PwmY, 0x180) => s.decoders[0].position = value,
                (At::PwmX, 0x180) => s.decoders[1].position = value,
                (At::Spi, 0x138) => {
                    assert_eq!(spi.0 >> 7 & 0x1f, 23, "words of 24 bits");
                    assert_eq!((spi.0 >> 6 & 1, spi.1 & 1), (1, 1), "select active low, channel on");
                    match value >> 16 {
                        0x0c => s.range = Some(value & 7),
                        0x10 => s.power = Some(value & 0x1f),
                        0x00 => s.volts[0] = f64::from(value as u16 as i16) * 10.0 / 32768.0,
                        0x02 => s.volts[1] = f64::from(value as u16 as i16) * 10.0 / 32768.0,
                        other => panic!("no such register of the DAC: {other:#x}"),
                    }
                }
                (At::Adc, 0x54) => {
                    for (k, step) in steps.iter().enumerate() {
                        if value & (2 << k) != 0 {
                            let input = (step >> 19 & 0xf) as usize;
                            s.samples.push_back((k as u32) << 16 | s.currents[input]);
                        }
                    }
                }
                (At::Watchdog, 0x48) => {
                    match (s.watchdog_word, value) {
                        (0xaaaa, 0x5555) => s.watchdog_left = None,
                        (0xbbbb, 0x4444) => s.watchdog_left = Some(0_u32.wrapping_sub(wldr)),
                        _ => {}
                    }
                    s.watchdog_word = value;
                }
                (At::Watchdog, 0x30) if value != trigger && s.watchdog_left.is_some() => {
                    s.watchdog_left = Some(0_u32.wrapping_sub(wldr));
                }
                (At::Gpio0, 0x190) => s.outputs &= !value,
                (At::Gpio0, 0x194) => s.outputs |= value,
                _ => {}
            }
            s.registers.insert((*at, offset), value);
        });
    }

    fn read_half(&self, offset: usize) -> u16 {
        let Self(chip, at) = self;
        chip.check_clock(*at);
        let stored = chip.written(*at, offset) as u16;
        chip.with(|s| match (at, offset) {
            (At::PwmY, 0x1b2) => s.decoders[0].flags,
            (At::PwmX, 0x1b2) => s.decoders[1].flags,
            _ => stored,
        })
    }

    fn write_half(&self, offset: usize, value: u16) {
        let Self(chip, at) = self;
        chip.check_clock(*at);
        chip.with(|s| match (at, offset) {
            (At::PwmY, 0x1b4) => s.decoders[0].flags &= !value,
            (At::PwmX, 0x1b4) => s.decoders[1].flags &= !value,
            _ => {
                s.registers.insert((*at, offset), u32::from(value));
            }
        });
    }
}
