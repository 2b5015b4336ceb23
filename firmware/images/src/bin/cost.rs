//! What a tick costs, in instructions.
//!
//! Run with `-icount shift=10`: every instruction takes 1024 ns of virtual time, and the 24 MHz counter moves 24.576 steps an
//! instruction, so the difference of two readings gives the number of instructions between them exactly.
//!
//! The story of [`froude_board::scenario`] runs twice. First every step is counted. Then it runs again, and the costliest steps and
//! a sample of the others go through [`traced_step`], where a debugger may follow them instruction by instruction.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;
use core::fmt::Write as _;
use core::hint::black_box;

use froude_board::realview::{COUNTER, GIC_DISTRIBUTOR, Realview, SYSTEM, TIMER_INTERRUPT, on_interrupt};
use froude_board::registers::{Memory, Registers};
use froude_board::rig::CONFIG;
use froude_board::scenario::{Scenario, TICKS};
use froude_board::tick::TickLatch;
use froude_control::Controller;
use froude_control::status::Output;
use froude_control::tick::Tick;
use froude_images::boot::enable_interrupts;
use froude_images::semihosting::{Console, exit};
use froude_link::frame::{FrameReader, FrameWriter, MAX_WIRE};
use froude_link::{FromBoard, HostFrame, Telemetry, ToBoard};

static LATCH: TickLatch = TickLatch::new();

/// Costs up to this many instructions are distinguished.
const CLASSES: usize = 65_536;
/// Costliest steps that are followed.
const WORST: usize = 8;
/// Every so many steps one is followed, too.
const SAMPLE: u32 = 12_500;

struct Counts(UnsafeCell<[u32; CLASSES]>);
// SAFETY: one processor, and the interrupt does not touch it.
unsafe impl Sync for Counts {}
static COUNTS: Counts = Counts(UnsafeCell::new([0; CLASSES]));

/// The step, once in the image, so that all callers measure the same code.
#[inline(never)]
fn step(controller: &mut Controller, tick: &Tick) -> Output {
    controller.step(tick)
}

/// A step that a debugger may follow.
#[unsafe(no_mangle)]
#[inline(never)]
extern "Rust" fn traced_step(controller: &mut Controller, tick: &Tick) -> Output {
    step(controller, tick)
}

/// Instructions of `f`, the readings themselves not counted.
fn instructions<T>(system: &Memory, f: impl FnOnce() -> T) -> (u32, T) {
    let before = system.read(COUNTER);
    let value = f();
    let steps = system.read(COUNTER).wrapping_sub(before);
    // 24.576 steps an instruction; the second reading is one.
    ((steps * 125 + 1536) / 3072 - 1, value)
}

/// Called once by the start-up.
#[unsafe(no_mangle)]
pub extern "C" fn carriage_main() -> ! {
    // SAFETY: this board.
    let system = unsafe { Memory::at(SYSTEM) };
    // SAFETY: nobody else.
    let counts = unsafe { &mut *COUNTS.0.get() };
    let mut console = Console;
    let Ok(fresh) = Controller::new(CONFIG) else { exit(false) };

    let (mut controller, mut story) = (fresh, Scenario::default());
    let mut worst = [(0_u32, 0_u32); WORST]; // (instructions, tick), costliest first
    let mut faults = 0;
    let mut refusals = 0;
    let mut switches = 0;
    let mut before = Output::default();
    while story.number() < TICKS {
        let (number, tick) = (story.number(), story.tick());
        let (cost, output) = instructions(&system, || step(&mut controller, &tick));
        story.follow(&output);
        if let Some(count) = counts.get_mut(cost as usize) {
            *count += 1;
        }
        let mut next = (cost, number);
        for place in &mut worst {
            if next.0 > place.0 {
                core::mem::swap(place, &mut next);
            }
        }
        faults += u32::from(output.status.fault.is_some() && before.status.fault.is_none());
        refusals += u32::from(output.status.refusal.is_some());
        let phases = before.status.axes.iter().zip(&output.status.axes);
        switches += phases.filter(|(was, is)| was.phase != is.phase).count() as u32;
        before = output;
    }
    let mut seen = 0;
    let median = counts.iter().position(|&count| {
        seen += count;
        seen * 2 >= TICKS
    });
    let _ = writeln!(console, "ticks {TICKS} faults {faults} refusals {refusals} switches {switches}");
    let _ = writeln!(console, "hash {:016x}", story.hash);
    let _ = writeln!(console, "median {}", median.unwrap_or(0));
    for (cost, number) in worst {
        let _ = writeln!(console, "worst {cost} at {number}");
    }
    others(&system, &before);

    let (mut controller, mut story) = (fresh, Scenario::default());
    while story.number() < TICKS {
        let (number, tick) = (story.number(), story.tick());
        let is_followed = number % SAMPLE == 1 || worst.iter().any(|&(_, at)| at == number);
        let output = if is_followed { traced_step(&mut controller, &tick) } else { step(&mut controller, &tick) };
        story.follow(&output);
    }
    let _ = writeln!(console, "again {:016x}", story.hash);
    exit(true)
}

/// What a tick costs besides its step.
fn others(system: &Memory, output: &Output) {
    let mut console = Console;
    let mut wire = [0; MAX_WIRE];
    let (cost, telemetry) =
        instructions(system, || black_box(Telemetry::of(black_box(&Tick::default()), output, [1, 2], [3, 4])));
    let _ = writeln!(console, "telemetry_filled {cost}");
    let mut writer = FrameWriter::starting_at(77);
    let (cost, len) = instructions(system, || writer.write(&FromBoard::Telemetry(telemetry), &mut wire).len());
    let _ = writeln!(console, "telemetry_framed {cost} bytes {len}");
    let len = writer.write(&ToBoard::Heartbeat.from_session(0x1234_5678), &mut wire).len();
    let mut reader = FrameReader::<HostFrame>::new();
    let (cost, heard) = instructions(system, || wire.iter().take(len).filter_map(|&byte| reader.feed(byte)).count());
    let _ = writeln!(console, "heartbeat_read {cost} bytes {len} messages {heard}");
    // The timer's own interrupt, made pending by hand: vectors, registers saved, latch, acknowledgement, return.
    // SAFETY: this board, once.
    let (_board, distributor) = unsafe { (Realview::start(&LATCH), Memory::at(GIC_DISTRIBUTOR)) };
    unsafe { Memory::at(froude_board::realview::TIMER) }.write(0x08, 0); // no ticks of its own
    enable_interrupts();
    let (word, bit) = (TIMER_INTERRUPT as usize / 32 * 4, 1 << (TIMER_INTERRUPT % 32));
    let (empty, ()) = instructions(system, || system.write(0x08, 0));
    let before = LATCH.number();
    let (cost, ()) = instructions(system, || distributor.write(0x200 + word, bit));
    let _ = writeln!(console, "interrupt {} taken {}", cost - empty, LATCH.number() - before);
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
    exit(false)
}
