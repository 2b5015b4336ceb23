//! x
#![no_std]
#![no_main]
use core::fmt::Write;
use froude_images::semihosting::{Console, exit};
/// x
#[unsafe(no_mangle)]
pub extern "C" fn carriage_main() -> ! {
    let _ = Console.write_str("hello\n");
    let x = unsafe { core::ptr::read_volatile(0x1000005C as *const u32) };
    let y = unsafe { core::ptr::read_volatile(0x1000005C as *const u32) };
    let z = f64::from(y.wrapping_sub(x)) / 24.576;
    let _ = write!(Console, "{} {}\n", y.wrapping_sub(x), (z * 1000.0) as u32);
    exit(true)
}
#[unsafe(no_mangle)]
extern "C" fn carriage_interrupt() {}
#[unsafe(no_mangle)]
extern "C" fn carriage_dead() { exit(false) }
