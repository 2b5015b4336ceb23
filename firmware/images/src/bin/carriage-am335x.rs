//! The carriage controller on the BeagleBone Black. **It has not met hardware.**
#![no_std]
#![no_main]

use core::cell::UnsafeCell;

use froude_board::Application;
use froude_board::am335x::{Am335x, Blocks, on_interrupt};
use froude_board::tick::TickLatch;
use froude_images::boot::{enable_interrupts, wait_for_interrupt};

static LATCH: TickLatch = TickLatch::new();

/// Too large for the stack.
struct Only(UnsafeCell<Application>);
// SAFETY: one processor, and the interrupt does not touch it.
unsafe impl Sync for Only {}
static APPLICATION: Only = Only(UnsafeCell::new(Application::new()));

/// Called once by the start-up.
#[unsafe(no_mangle)]
pub extern "C" fn carriage_main() -> ! {
    // SAFETY: once.
    let application = unsafe { &mut *APPLICATION.0.get() };
    // SAFETY: this chip.
    match Am335x::start(unsafe { Blocks::in_memory() }, &LATCH) {
        Ok(mut board) => {
            enable_interrupts();
            application.announce(&mut board);
            loop {
                application.turn(&mut board);
            }
        }
        // A module does not answer: the enable lines are low and stay so. A debugger finds its name here.
        Err(name) => loop {
            core::hint::black_box(name);
            wait_for_interrupt();
        },
    }
}

/// Called by the vectors.
#[unsafe(no_mangle)]
pub extern "C" fn carriage_interrupt() {
    // SAFETY: this chip.
    on_interrupt(&unsafe { Blocks::in_memory() }, &LATCH);
}

/// Called by the vectors when the processor met something that it cannot do: the watchdog resets it.
#[unsafe(no_mangle)]
pub extern "C" fn carriage_dead() {}
