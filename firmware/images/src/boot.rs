//! From reset to Rust.
//!
//! Sources: ARM DDI 0406C (ARMv7-A: B2.2 cache maintenance by set and way, B3.5 short descriptors, B4.1 system registers);
//! ARM DDI 0344K (Cortex-A8: 3.2.25 control register).

use core::arch::global_asm;
use core::cell::UnsafeCell;

global_asm!(
    r#"
    .section .text.start, "ax"
    .arm
    .fpu neon
    .global _start
_start:
    cpsid   aif, #19                    @ supervisor, nothing may interrupt
    bl      clean_data_caches           @ the loader's writes reach memory before its caches go
    mrc     p15, 0, r0, c1, c0, 0       @ SCTLR
    bic     r0, r0, #0x1000             @ I: instruction cache off
    bic     r0, r0, #0x0800             @ Z: branch prediction off
    bic     r0, r0, #0x0007             @ C, A, M: data cache, alignment check and MMU off
    bic     r0, r0, #0x2000             @ V: vectors where VBAR says
    mcr     p15, 0, r0, c1, c0, 0
    isb
    bl      clean_data_caches
    mov     r0, #0
    mcr     p15, 0, r0, c7, c5, 0       @ ICIALLU
    mcr     p15, 0, r0, c7, c5, 6       @ BPIALL
    mcr     p15, 0, r0, c8, c7, 0       @ TLBIALL
    dsb
    isb
    ldr     r0, =vectors
    mcr     p15, 0, r0, c12, c0, 0      @ VBAR
    cps     #18
    ldr     sp, =__irq_stack_top
    cps     #23
    ldr     sp, =__abort_stack_top
    cps     #27
    ldr     sp, =__abort_stack_top
    cps     #19
    ldr     sp, =__stack_top
    ldr     r0, =__bss_start
    ldr     r1, =__bss_end
    mov     r2, #0
1:  cmp     r0, r1
    strlo   r2, [r0], #4
    blo     1b
    ldr     r0, =translation_table      @ section k: k MiB, to itself
    ldr     r1, =__normal_first
    ldr     r2, =__normal_last
    mov     r3, #0
2:  ldr     r4, =0x00000c16             @ device, read and write, never executed (XN), section
    cmp     r3, r1
    cmphs   r2, r3
    ldrhs   r4, =0x00001c0e             @ normal, write-back write-allocate, section
    cmp     r3, r1
    ldrlo   r4, =0x00000c16
    orr     r4, r4, r3, lsl #20
    str     r4, [r0, r3, lsl #2]
    add     r3, r3, #1
    cmp     r3, #4096
    blo     2b
    dsb
    ldr     r0, =translation_table
    orr     r0, r0, #0x09               @ walks: inner and outer write-back write-allocate
    mcr     p15, 0, r0, c2, c0, 0       @ TTBR0
    mov     r0, #0
    mcr     p15, 0, r0, c2, c0, 2       @ TTBCR: TTBR0 for everything
    mov     r0, #1
    mcr     p15, 0, r0, c3, c0, 0       @ DACR: domain 0 is checked
    isb
    mrc     p15, 0, r0, c1, c0, 0
    orr     r0, r0, #0x1000             @ I
    orr     r0, r0, #0x0800             @ Z
    orr     r0, r0, #0x0005             @ C, M
    mcr     p15, 0, r0, c1, c0, 0
    isb
    mrc     p15, 0, r0, c1, c0, 2       @ CPACR: full access to coprocessors 10 and 11
    orr     r0, r0, #0x00f00000
    mcr     p15, 0, r0, c1, c0, 2
    isb
    mov     r0, #0x40000000             @ FPEXC.EN
    vmsr    fpexc, r0
    mov     r0, #0                      @ to nearest, subnormals kept: what the host does
    vmsr    fpscr, r0
    bl      carriage_main
3:  wfi
    b       3b

    @ Every data or unified cache up to the level of coherency, set by set and way by way (DDI 0406C, B2.2.7).
clean_data_caches:
    dmb
    mrc     p15, 1, r0, c0, c0, 1       @ CLIDR
    ands    r3, r0, #0x07000000
    mov     r3, r3, lsr #23             @ twice the level of coherency
    beq     8f
    mov     r10, #0
4:  add     r2, r10, r10, lsr #1
    mov     r1, r0, lsr r2
    and     r1, r1, #7
    cmp     r1, #2
    blt     7f                          @ no data cache at this level
    mcr     p15, 2, r10, c0, c0, 0      @ CSSELR
    isb
    mrc     p15, 1, r1, c0, c0, 0       @ CCSIDR
    and     r2, r1, #7
    add     r2, r2, #4                  @ log2 of the line's bytes
    ldr     r4, =0x3ff
    ands    r4, r4, r1, lsr #3          @ ways − 1
    clz     r5, r4
    ldr     r7, =0x7fff
    ands    r7, r7, r1, lsr #13         @ sets − 1
5:  mov     r9, r4
6:  orr     r11, r10, r9, lsl r5
    orr     r11, r11, r7, lsl r2
    mcr     p15, 0, r11, c7, c14, 2     @ DCCISW
    subs    r9, r9, #1
    bge     6b
    subs    r7, r7, #1
    bge     5b
7:  add     r10, r10, #2
    cmp     r3, r10
    bgt     4b
8:  mov     r10, #0
    mcr     p15, 2, r10, c0, c0, 0
    dsb
    isb
    bx      lr

    .align 5
vectors:
    b       _start                      @ reset
    b       dead                        @ undefined instruction
    b       dead                        @ supervisor call
    b       dead                        @ prefetch abort
    b       dead                        @ data abort
    b       dead                        @ reserved
    b       interrupt
    b       dead                        @ fast interrupt: not used

    @ Nothing is repaired: interrupts stay off, and the hardware watchdog, no longer fed, takes the torque away.
dead:
    cpsid   aif
    bl      carriage_dead
9:  b       9b

    @ Saves all that the procedure call standard lets a function destroy, floating point included.
interrupt:
    sub     lr, lr, #4
    push    {{r0-r3, r12, lr}}
    vmrs    r0, fpscr
    push    {{r0, r1}}
    vpush   {{d0-d7}}
    vpush   {{d16-d31}}
    bl      carriage_interrupt
    vpop    {{d16-d31}}
    vpop    {{d0-d7}}
    pop     {{r0, r1}}
    vmsr    fpscr, r0
    ldmfd   sp!, {{r0-r3, r12, pc}}^
    .ltorg
"#
);

/// 4096 sections of 1 MiB. Written by the start-up, read by the MMU.
#[repr(C, align(16384))]
pub struct TranslationTable(UnsafeCell<[u32; 4096]>);
// SAFETY: touched once, before anything runs that could share it.
unsafe impl Sync for TranslationTable {}

/// The flat map.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".translation")]
#[allow(non_upper_case_globals)]
pub static translation_table: TranslationTable = TranslationTable(UnsafeCell::new([0; 4096]));

/// Lets interrupts in.
pub fn enable_interrupts() {
    // SAFETY: vectors and handlers are in place before Rust runs.
    unsafe { core::arch::asm!("cpsie i", options(nomem, nostack)) };
}

/// Runs `f` with interrupts held back.
pub fn without_interrupts<T>(f: impl FnOnce() -> T) -> T {
    // SAFETY: only the mask bit changes; it is restored to "enabled", the state of the main loop.
    unsafe { core::arch::asm!("cpsid i", options(nostack)) };
    let value = f();
    unsafe { core::arch::asm!("cpsie i", options(nostack)) };
    value
}

/// Sleeps until an interrupt is pending.
pub fn wait_for_interrupt() {
    // SAFETY: waiting changes nothing.
    unsafe { core::arch::asm!("wfi", options(nomem, nostack)) };
}
