//! The emulator's console and its end (ARM DUI 0375, semihosting). Only emulated images use it.

use core::arch::asm;
use core::fmt::{self, Write};

fn call(operation: u32, argument: u32) -> u32 {
    let result;
    // SAFETY: the emulator answers; nothing but the result register changes.
    unsafe { asm!("svc 0x123456", inlateout("r0") operation => result, in("r1") argument, options(nostack)) };
    result
}

/// The emulator's standard output.
pub struct Console;

impl Write for Console {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            // SYS_WRITEC takes the address of a character.
            call(3, (&raw const byte) as u32);
        }
        Ok(())
    }
}

/// Ends the emulator: status 0 if all went well, 1 if not.
pub fn exit(is_good: bool) -> ! {
    // SYS_EXIT with ADP_Stopped_ApplicationExit or ADP_Stopped_RunTimeErrorUnknown.
    call(0x18, if is_good { 0x20026 } else { 0x20023 });
    loop {
        crate::boot::wait_for_interrupt();
    }
}
