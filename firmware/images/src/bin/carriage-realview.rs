//! The carriage controller on the emulated Cortex-A8, with a rig of its own behind the amplifiers.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;

use froude_board::Application;
use froude_board::realview::{Realview, on_interrupt};
use froude_board::tick::TickLatch;
use froude_images::boot::{enable_interrupts, wait_for_interrupt, without_interrupts};

static LATCH: TickLatch = TickLatch::new();

/// Too large for the stack.
struct Only(UnsafeCell<Application>);
// SAFETY: one processor, and the interrupt does not touch it.
unsafe impl Sync for Only {}
static APPLICATION: Only = Only(UnsafeCell::new(Application::new()));

/// Called once by the start-up.
#[unsafe(no_mangle)]
pub extern "C" fn carriage_main() -> ! {
    // SAFETY: this board, once.
    let (application, mut board) = unsafe { (&mut *APPLICATION.0.get(), Realview::start(&LATCH)) };
    enable_interrupts();
    #[cfg(feature = "reachable-panic")]
    assert!(board.counter() != 7, "this must not link");
    application.announce(&mut board);
    loop {
        if !application.turn(&mut board) {
            without_interrupts(|| {
                if board.may_sleep() {
                    wait_for_interrupt();
                }
            });
        }
    }
}

/// Called by the vectors.
#[unsafe(no_mangle)]
pub extern "C" fn carriage_interrupt() {
    // SAFETY: the handler of this board.
    unsafe { on_interrupt(&LATCH) };
}

/// Called by the vectors when the processor met something that it cannot do.
#[unsafe(no_mangle)]
pub extern "C" fn carriage_dead() {
    froude_images::semihosting::exit(false)
}
