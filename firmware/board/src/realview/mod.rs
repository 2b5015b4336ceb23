//! The emulated board: QEMU's realview-pb-a8, with a rig inside.
//!
//! Addresses: ARM DUI 0417 (RealView Platform Baseboard for Cortex-A8), §4.1; UART PL011 (DDI 0183), timer SP804 (DDI 0271),
//! interrupt controller GIC (IHI 0048).

mod gic;
mod pl011;
mod sp804;

use froude_control::tick::{AXES, Command};
use froude_link::budget::FULL_RATE_BAUD;
use froude_link::status::BoardId;

pub use gic::Gic;
pub use pl011::Pl011;
pub use sp804::Sp804;

use crate::board::{AxisLatched, Board, Latched, Scales};
use crate::demand::{V_PER_COUNT, dac_code};
use crate::registers::{Memory, Registers};
use crate::rig::Rig;
use crate::tick::{COUNTER_MHZ, Microseconds, TickLatch};

/// UART 0.
pub const UART: usize = 0x1000_9000;
/// Timers 0 and 1.
pub const TIMER: usize = 0x1001_1000;
/// System registers.
pub const SYSTEM: usize = 0x1000_0000;
/// The 24 MHz counter, from [`SYSTEM`].
pub const COUNTER: usize = 0x5c;
/// The interrupt controller's processor side.
pub const GIC_CPU: usize = 0x1e00_0000;
/// Its distributor.
pub const GIC_DISTRIBUTOR: usize = 0x1e00_1000;
/// Interrupt of timers 0 and 1: the fifth shared one.
pub const TIMER_INTERRUPT: u32 = 36;
/// Interrupt of UART 0: the thirteenth.
pub const UART_INTERRUPT: u32 = 44;

/// Amperes of a count of the current.
const A_PER_COUNT: f64 = 1e-3;

/// The board.
pub struct Realview {
    uart: Pl011<Memory>,
    system: Memory,
    latch: &'static TickLatch,
    taken: u32,
    time: Microseconds,
    /// The rig; it moves on with every tick of the timer.
    pub rig: Rig,
    command: Command,
    /// Times that the watchdog was fed, if there were one.
    pub fed: u32,
}

/// The timer's interrupt: acknowledges it and latches.
///
/// # Safety
///
/// Only from the interrupt handler of this board.
pub unsafe fn on_interrupt(latch: &TickLatch) {
    // SAFETY: the board's own addresses, mapped as device memory by the start-up.
    let (gic, timer, system) = unsafe { (gic(), Sp804::new(Memory::at(TIMER)), Memory::at(SYSTEM)) };
    let interrupt = gic.acknowledge();
    if interrupt == TIMER_INTERRUPT {
        timer.clear();
        latch.latch(system.read(COUNTER), [0; 2]);
    } else if interrupt == UART_INTERRUPT {
        // It only wakes the main loop, which reads; the next sleep lets it in again.
        // SAFETY: as above.
        Pl011::new(unsafe { Memory::at(UART) }).interrupt_on_byte(false);
    }
    gic.complete(interrupt);
}

/// # Safety
///
/// Only on this board.
const unsafe fn gic() -> Gic<Memory> {
    // SAFETY: as above.
    unsafe { Gic::new(Memory::at(GIC_CPU), Memory::at(GIC_DISTRIBUTOR)) }
}

impl Realview {
    /// Sets the board up; ticks come as soon as interrupts are let in.
    ///
    /// # Safety
    ///
    /// Only on this board, and once.
    #[must_use]
    pub unsafe fn start(latch: &'static TickLatch) -> Self {
        // SAFETY: as above.
        let (uart, timer, system, gic) =
            unsafe { (Pl011::new(Memory::at(UART)), Sp804::new(Memory::at(TIMER)), Memory::at(SYSTEM), gic()) };
        uart.start();
        gic.enable(TIMER_INTERRUPT);
        gic.enable(UART_INTERRUPT);
        timer.start(250); // of its 1 MHz
        let time = Microseconds::starting_at(system.read(COUNTER));
        Self { uart, system, latch, taken: 0, time, rig: Rig::default(), command: Command::default(), fed: 0 }
    }

    /// Nothing waits to be done, and whatever comes next will interrupt: the processor may sleep. To be asked, and slept on, with
    /// interrupts held back. (The emulator has more time for the line while the processor sleeps; the BeagleBone never does.)
    pub fn may_sleep(&self) -> bool {
        self.uart.interrupt_on_byte(true);
        self.uart.is_quiet() && self.latch.number() == self.taken
    }

    /// The 24 MHz counter.
    #[must_use]
    pub fn counter(&self) -> u32 {
        self.system.read(COUNTER)
    }
}

impl Board for Realview {
    const ID: BoardId = BoardId::Realview;
    const BAUD: u32 = FULL_RATE_BAUD;

    fn scales(&self) -> Scales {
        Scales { command_v_per_count: [V_PER_COUNT; AXES], current_a_per_count: [A_PER_COUNT; AXES] }
    }

    fn boot_number(&self) -> u32 {
        0
    }

    fn was_watchdog_reset(&self) -> bool {
        false
    }

    fn now_us(&mut self) -> u32 {
        self.time.peek(self.system.read(COUNTER))
    }

    fn take_tick(&mut self) -> Option<Latched> {
        if self.latch.number() == self.taken {
            return None;
        }
        let tick = self.latch.read();
        let ticks = tick.number.wrapping_sub(self.taken);
        self.taken = tick.number;
        (0..ticks.min(4000)).for_each(|_| self.rig.step(&self.command));
        let axes = self.rig.axes.map(|axis| {
            let input = axis.input();
            AxisLatched {
                encoder_count: input.encoder_count,
                encoder_errors: 0,
                current_counts: (input.current_a * (1.0 / A_PER_COUNT)) as i32 as i16,
                is_low_end: input.is_low_end,
                is_high_end: input.is_high_end,
                is_amplifier_ready: true,
            }
        });
        Some(Latched { latched_us: self.time.at(tick.counter), ticks, axes, is_estop_open: false })
    }

    fn actuate(&mut self, command: &Command) -> [i16; AXES] {
        self.command = *command;
        command.axes.map(|axis| dac_code(axis.volts))
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
        self.fed = self.fed.wrapping_add(1);
    }
}

const _: () = assert!(COUNTER_MHZ == 24);
