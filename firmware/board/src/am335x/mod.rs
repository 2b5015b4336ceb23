//! BeagleBone Black: TI AM335x, Cortex-A8 at 1 GHz.
//!
//! **This board file has not met hardware.** It is written from the manual (TRM SPRUH73) and runs against register models on the host.
//! Addresses: TRM, chapter 2 (memory map); interrupts: table 6-1.
//!
//! U-Boot's SPL has set up PLLs and DDR before it jumps here.

pub mod adc;
pub mod clocks;
pub mod dac;
pub mod eqep;
pub mod gpio;
pub mod intc;
pub mod pins;
pub mod timer;
pub mod uart;
pub mod watchdog;

use froude_control::tick::{AXES, Command};
use froude_link::budget::FULL_RATE_BAUD;
use froude_link::status::BoardId;

use self::adc::Adc;
use self::dac::Dac;
use self::eqep::Eqep;
use self::gpio::Gpio;
use self::intc::Intc;
use self::pins::line;
use self::timer::Timer;
use self::uart::{Rate, Uart};
use self::watchdog::Watchdog;
use crate::board::{AxisLatched, Board, Latched, Scales};
use crate::demand::{V_PER_COUNT, dac_code};
use crate::registers::{Memory, Registers};
use crate::tick::{COUNTER_MHZ, Microseconds, TickLatch};

/// Interrupt of DMTimer2.
pub const TIMER_INTERRUPT: u32 = 68;
/// Steps of the crystal in a tick.
pub const TICK_STEPS: u32 = 250 * COUNTER_MHZ;
/// Amperes of an ADC count: ± 10 A over ± 0.9 V about the middle. A calibration replaces it on the host.
pub const A_PER_COUNT: f64 = 10.0 / 2048.0;

/// PRM_RSTST: why the processor was reset, and the watchdog's bit.
const RESET_STATUS: usize = 0x08;
const WATCHDOG_RESET: u32 = 1 << 4;

/// The peripherals' registers.
pub struct Blocks<R> {
    /// CM_PER, 0x44E0_0000.
    pub clocks_per: R,
    /// CM_WKUP, 0x44E0_0400.
    pub clocks_wake_up: R,
    /// CM_DPLL, 0x44E0_0500.
    pub clocks_dpll: R,
    /// PRM_DEVICE, 0x44E0_0F00.
    pub reset: R,
    /// Control module, 0x44E1_0000.
    pub control: R,
    /// UART1, 0x4802_2000.
    pub uart: R,
    /// DMTimer2, 0x4804_0000.
    pub timer: R,
    /// DMTimer3, 0x4804_2000.
    pub counter: R,
    /// INTC, 0x4820_0000.
    pub intc: R,
    /// PWMSS0 and PWMSS2, 0x4830_0000 and 0x4830_4000.
    pub pwm: [R; AXES],
    /// McSPI0, 0x4803_0000.
    pub spi: R,
    /// TSC_ADC, 0x44E0_D000.
    pub adc: R,
    /// WDT1, 0x44E3_5000.
    pub watchdog: R,
    /// GPIO0, 0x44E0_7000.
    pub gpio_0: R,
    /// GPIO1, 0x4804_C000.
    pub gpio_1: R,
}

impl Blocks<Memory> {
    /// Where they are in the processor's memory.
    ///
    /// # Safety
    ///
    /// Only on an AM335x; the main loop and the interrupt share timer, counter, controller and decoders as this module does.
    #[must_use]
    pub const unsafe fn in_memory() -> Self {
        // SAFETY: the chip's own addresses.
        unsafe {
            Self {
                clocks_per: Memory::at(0x44e0_0000),
                clocks_wake_up: Memory::at(0x44e0_0400),
                clocks_dpll: Memory::at(0x44e0_0500),
                reset: Memory::at(0x44e0_0f00),
                control: Memory::at(0x44e1_0000),
                uart: Memory::at(0x4802_2000),
                timer: Memory::at(0x4804_0000),
                counter: Memory::at(0x4804_2000),
                intc: Memory::at(0x4820_0000),
                pwm: [Memory::at(0x4830_0000), Memory::at(0x4830_4000)],
                spi: Memory::at(0x4803_0000),
                adc: Memory::at(0x44e0_d000),
                watchdog: Memory::at(0x44e3_5000),
                gpio_0: Memory::at(0x44e0_7000),
                gpio_1: Memory::at(0x4804_c000),
            }
        }
    }
}

/// The timer's interrupt: latches time and encoders, then acknowledges.
pub fn on_interrupt<R: Registers>(blocks: &Blocks<R>, latch: &TickLatch) {
    let intc = Intc::new(&blocks.intc);
    if intc.active() == Some(TIMER_INTERRUPT) {
        let [y, x] = &blocks.pwm;
        latch.latch(Timer::new(&blocks.counter).counter(), [Eqep::new(y).count(), Eqep::new(x).count()]);
        Timer::new(&blocks.timer).clear();
    }
    intc.complete();
}

/// The board.
pub struct Am335x<R> {
    uart: Uart<R>,
    counter: Timer<R>,
    encoders: [Eqep<R>; AXES],
    dac: Dac<R>,
    adc: Adc<R>,
    watchdog: Watchdog<R>,
    enables: Gpio<R>,
    inputs: Gpio<R>,
    latch: &'static TickLatch,
    taken: u32,
    time: Microseconds,
    was_watchdog_reset: bool,
    /// The DAC did not take a word: no torque until the next reset.
    has_dac_failed: bool,
}

impl<R: Registers> Am335x<R> {
    /// Sets the board up, torque off first. Ticks come as soon as interrupts are let in.
    ///
    /// # Errors
    ///
    /// The name of the first module that does not answer.
    pub fn start(blocks: Blocks<R>, latch: &'static TickLatch) -> Result<Self, &'static str> {
        let b = blocks;
        clocks::start(&b.clocks_per, &b.clocks_wake_up, &b.clocks_dpll)?;
        let (enables, inputs) = (Gpio::new(b.gpio_0), Gpio::new(b.gpio_1));
        enables.start_outputs(line::ENABLE[0] | line::ENABLE[1]);
        pins::start(&b.control);
        let was_watchdog_reset = b.reset.read(RESET_STATUS) & WATCHDOG_RESET != 0;
        b.reset.write(RESET_STATUS, WATCHDOG_RESET);

        let dac = Dac::new(b.spi);
        let uart = Uart::new(b.uart);
        let counter = Timer::new(b.counter);
        let mut encoders = b.pwm.map(Eqep::new);
        let adc = Adc::new(b.adc);
        let mut watchdog = Watchdog::new(b.watchdog);
        answered(dac.start(), "SPI0")?;
        answered(uart.start(Rate::of(Self::BAUD)), "UART1")?;
        answered(counter.start_free(), "TIMER3")?;
        encoders.iter_mut().for_each(Eqep::start);
        adc.start();
        answered(Intc::new(b.intc).start(TIMER_INTERRUPT), "INTC")?;
        answered(Timer::new(b.timer).start_periodic(TICK_STEPS), "TIMER2")?;
        answered(watchdog.start(), "WDT1")?;
        let time = Microseconds::starting_at(counter.counter());
        Ok(Self {
            uart,
            counter,
            encoders,
            dac,
            adc,
            watchdog,
            enables,
            inputs,
            latch,
            taken: latch.number(),
            time,
            was_watchdog_reset,
            has_dac_failed: false,
        })
    }
}

fn answered(is_there: bool, name: &'static str) -> Result<(), &'static str> {
    if is_there { Ok(()) } else { Err(name) }
}

impl<R: Registers> Board for Am335x<R> {
    const ID: BoardId = BoardId::Am335x;
    const BAUD: u32 = FULL_RATE_BAUD;

    fn scales(&self) -> Scales {
        Scales { command_v_per_count: [V_PER_COUNT; AXES], current_a_per_count: [A_PER_COUNT; AXES] }
    }

    fn boot_number(&self) -> u32 {
        0
    }

    fn was_watchdog_reset(&self) -> bool {
        self.was_watchdog_reset
    }

    fn now_us(&mut self) -> u32 {
        self.time.peek(self.counter.counter())
    }

    fn take_tick(&mut self) -> Option<Latched> {
        if self.latch.number() == self.taken {
            return None;
        }
        let tick = self.latch.read();
        let ticks = tick.number.wrapping_sub(self.taken);
        self.taken = tick.number;
        let [current_y, current_x] = self.adc.read();
        let lines = self.inputs.read();
        let [encoder_y, encoder_x] = &mut self.encoders;
        let [count_y, count_x] = tick.encoders;
        let is_dac_good = !self.has_dac_failed;
        let axis = |encoder: &mut Eqep<R>, encoder_count, current_counts, low, high, fault| AxisLatched {
            encoder_count,
            encoder_errors: encoder.errors(),
            current_counts,
            is_low_end: lines & low != 0,
            is_high_end: lines & high != 0,
            is_amplifier_ready: is_dac_good && lines & fault == 0,
        };
        let ([low_y, low_x], [high_y, high_x], [fault_y, fault_x]) = (line::LOW, line::HIGH, line::FAULT);
        Some(Latched {
            latched_us: self.time.at(tick.counter),
            ticks,
            axes: [
                axis(encoder_y, count_y, current_y, low_y, high_y, fault_y),
                axis(encoder_x, count_x, current_x, low_x, high_x, fault_x),
            ],
            is_estop_open: lines & line::ESTOP != 0,
        })
    }

    fn actuate(&mut self, command: &Command) -> [i16; AXES] {
        let codes = command.axes.map(|axis| if axis.is_enabled { dac_code(axis.volts) } else { 0 });
        // Volts first, torque after: an amplifier is never enabled onto an old command.
        if !self.dac.put(codes) {
            self.has_dac_failed = true;
        }
        for (axis, enable) in command.axes.iter().zip(line::ENABLE) {
            self.enables.put(enable, axis.is_enabled && !self.has_dac_failed);
        }
        self.adc.convert();
        codes
    }

    fn read_byte(&mut self) -> Option<u8> {
        self.uart.read()
    }

    fn write_byte(&mut self, byte: u8) -> bool {
        self.uart.write(byte)
    }

    fn port_overflows(&self) -> u32 {
        self.uart.overflows()
    }

    fn feed_watchdog(&mut self) {
        self.watchdog.feed();
    }
}
