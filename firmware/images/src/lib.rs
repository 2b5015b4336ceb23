//! Start-up of the Cortex-A8, and what every image needs: vectors, memory map, the panic that must not be.
//!
//! Order, and why: caches off and cleaned (whoever loaded us may have used them), vectors (from here a fault ends in a known
//! place), stacks of the modes that are used, .bss cleared, translation table written, MMU with caches and branch prediction on,
//! coprocessors 10 and 11 allowed, floating point enabled, and only then Rust, which may use a floating-point register anywhere.
//!
//! A panic cannot happen: [`panic`] calls a function that nobody defines, so an image with a reachable panic does not link.
#![no_std]

pub mod boot;
pub mod semihosting;

unsafe extern "C" {
    /// Not defined anywhere. The linker names it when a panic is still reachable.
    fn a_panic_is_still_reachable() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: never linked, hence never called.
    unsafe { a_panic_is_still_reachable() }
}
