//! Timer, overrun and host watchdog without a host: rig and host are inside, nothing comes from outside, so two runs are equal.
//!
//! Run with `-icount shift=2`: an instruction takes 4 ns of virtual time, four cycles of a Cortex-A8 at 1 GHz. The loop spins as it
//! does on the board: asleep (`wfi`), QEMU 7.2 with `sleep=off` lets every second tick of the timer pass unseen. The story: greet, configure, enable, home, move; hang for a few ticks (overrun); let the line
//! stall until the telemetry ring is full; fall silent in the middle of a move (host watchdog, stop of category 1); greet again,
//! clear, and say how it went.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;
use core::fmt::Write as _;

use froude_board::realview::{Realview, on_interrupt};
use froude_board::rig::CONFIG;
use froude_board::tick::TickLatch;
use froude_board::{
    Application, Board,
    board::{Latched, Scales},
};
use froude_control::fault::Fault;
use froude_control::request::{Move, Request};
use froude_control::status::Phase;
use froude_control::tick::{AXES, Command};
use froude_images::boot::enable_interrupts;
use froude_images::semihosting::{Console, exit};
use froude_link::frame::{FrameReader, FrameWriter, MAX_WIRE};
use froude_link::status::{BoardId, EventKind, Verdict};
use froude_link::{FromBoard, ToBoard};

static LATCH: TickLatch = TickLatch::new();

/// The host's session.
const SESSION: u32 = 1;
/// Bytes that 3 Mbaud carry in a tick.
const BYTES_PER_TICK: u32 = 75;
/// When the host falls silent, tick.
const SILENCE: u32 = 20_000;
/// When it comes back.
const RETURN: u32 = 28_000;
/// The end.
const END: u32 = 32_000;
/// When the main loop hangs, and for how long.
const HANG: u32 = 12_000;
const HANG_TICKS: u32 = 2;
/// When the line stalls, and until when: longer than the ring.
const STALL: core::ops::Range<u32> = 13_000..14_500;

/// The host that lives on the board.
struct Host {
    writer: FrameWriter,
    reader: FrameReader<FromBoard>,
    wire: [u8; MAX_WIRE],
    len: usize,
    sent: usize,
    room: u32,
    /// FNV-1a over every byte that the board sent.
    hash: u64,
    seen: Seen,
}

/// What was reported to the host.
#[derive(Default)]
struct Seen {
    accepted: u32,
    not_accepted: u32,
    telemetry: u32,
    missing_ticks: u32,
    marked_gaps: u32,
    last_tick: Option<u32>,
    skipped: u32,
    silent_fault_tick: Option<u32>,
    at_rest_tick: Option<u32>,
    health: froude_link::status::Health,
}

impl Host {
    /// What it has to say at this tick.
    fn speak(&mut self, tick: u32) {
        let go = |target_m| {
            let profile = Move { target_m, speed_m_s: 0.5, acceleration_m_s2: 0.8, jerk_m_s3: 8.0, is_shaped: true };
            Request::Move { axis: 0, profile }
        };
        let message = match tick {
            100 => ToBoard::Hello,
            200 => ToBoard::Configure { id: 1, config: CONFIG },
            300 => ToBoard::Request { id: 2, request: Request::Enable { axis: 0 } },
            320 => ToBoard::Request { id: 3, request: Request::Enable { axis: 1 } },
            400 => ToBoard::Request { id: 4, request: Request::Home { axis: 0 } },
            420 => ToBoard::Request { id: 5, request: Request::Home { axis: 1 } },
            10_000 => ToBoard::Request { id: 6, request: go(0.5) },
            17_600 => ToBoard::Request { id: 7, request: go(4.0) },
            RETURN => ToBoard::Hello,
            28_100 => ToBoard::Request { id: 8, request: Request::Clear(Fault::HostSilent) },
            SILENCE..RETURN => return,
            _ if tick % 40 == 7 => ToBoard::Heartbeat,
            _ => return,
        };
        self.len = self.writer.write(&message.from_session(SESSION), &mut self.wire).len();
        self.sent = 0;
    }

    fn hear(&mut self, byte: u8) {
        self.hash = (self.hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        let Some(received) = self.reader.feed(byte) else { return };
        let seen = &mut self.seen;
        match received.message {
            FromBoard::Ack(ack) if ack.verdict == Verdict::Accepted => seen.accepted += 1,
            FromBoard::Ack(_) => seen.not_accepted += 1,
            FromBoard::Telemetry(telemetry) => {
                seen.telemetry += 1;
                let step = telemetry.tick.wrapping_sub(seen.last_tick.unwrap_or(telemetry.tick.wrapping_sub(1)));
                seen.missing_ticks += step - 1;
                seen.marked_gaps += u32::from(telemetry.has_gap_before);
                seen.last_tick = Some(telemetry.tick);
            }
            FromBoard::Event(event) => match event.kind {
                EventKind::Overrun(ticks) => seen.skipped += u32::from(ticks),
                EventKind::Phase { axis: 0, phase: Phase::Disabled | Phase::Coasting } => {
                    seen.at_rest_tick.get_or_insert(event.tick);
                }
                _ => {}
            },
            FromBoard::Fault(report) => {
                let _ = writeln!(Console, "fault {:?} of axis {} at {}", report.fault, report.axis, report.tick);
                if report.fault == Fault::HostSilent {
                    seen.silent_fault_tick = Some(report.tick);
                }
            }
            FromBoard::Health(health) => seen.health = health,
            _ => {}
        }
    }
}

/// The emulated board with the host where its serial port was.
struct Closed {
    board: Realview,
    host: Host,
    tick: u32,
}

impl Board for Closed {
    const ID: BoardId = Realview::ID;
    const BAUD: u32 = Realview::BAUD;

    fn scales(&self) -> Scales {
        self.board.scales()
    }
    fn boot_number(&self) -> u32 {
        self.board.boot_number()
    }
    fn was_watchdog_reset(&self) -> bool {
        false
    }
    fn now_us(&mut self) -> u32 {
        self.board.now_us()
    }
    fn take_tick(&mut self) -> Option<Latched> {
        let latched = self.board.take_tick()?;
        self.tick += latched.ticks;
        self.host.room = BYTES_PER_TICK * latched.ticks;
        self.host.speak(self.tick);
        Some(latched)
    }
    fn actuate(&mut self, command: &Command) -> [i16; AXES] {
        self.board.actuate(command)
    }
    fn read_byte(&mut self) -> Option<u8> {
        let byte = self.host.wire.get(..self.host.len)?.get(self.host.sent).copied();
        self.host.sent += usize::from(byte.is_some());
        byte
    }
    fn write_byte(&mut self, byte: u8) -> bool {
        let has_room = self.host.room > 0 && !STALL.contains(&self.tick);
        if has_room {
            self.host.room -= 1;
            self.host.hear(byte);
        }
        has_room
    }
    fn port_overflows(&self) -> u32 {
        0
    }
    fn feed_watchdog(&mut self) {
        self.board.feed_watchdog();
    }
}

/// Too large for the stack.
struct Only(UnsafeCell<Application>);
// SAFETY: one processor, and the interrupt does not touch it.
unsafe impl Sync for Only {}
static APPLICATION: Only = Only(UnsafeCell::new(Application::new()));

/// Called once by the start-up.
#[unsafe(no_mangle)]
pub extern "C" fn carriage_main() -> ! {
    // SAFETY: this board, once.
    let (application, board) = unsafe { (&mut *APPLICATION.0.get(), Realview::start(&LATCH)) };
    let host = Host {
        writer: FrameWriter::starting_at(0),
        reader: FrameReader::new(),
        wire: [0; MAX_WIRE],
        len: 0,
        sent: 0,
        room: 0,
        hash: 0xcbf2_9ce4_8422_2325,
        seen: Seen::default(),
    };
    let mut closed = Closed { board, host, tick: 0 };
    enable_interrupts();
    application.announce(&mut closed);
    let mut has_hung = false;
    let (mut worst_us, mut worst_at) = (0, 0);
    while closed.tick < END {
        if closed.tick >= HANG && !has_hung {
            has_hung = true;
            let since = LATCH.number();
            while LATCH.number().wrapping_sub(since) < HANG_TICKS {} // the main loop hangs
        }
        application.turn(&mut closed);
        if application.worst_step_us() > worst_us {
            (worst_us, worst_at) = (application.worst_step_us(), closed.tick);
        }
    }
    let seen = &closed.host.seen;
    let fault = application.output().status.fault;
    let mut console = Console;
    let _ = writeln!(console, "ticks {} of the timer, {} taken", LATCH.number(), closed.tick);
    let _ = writeln!(console, "overruns {} told {}", application.overruns(), seen.skipped);
    let _ = writeln!(console, "worst_step_us {worst_us} at {worst_at}");
    let _ = writeln!(console, "accepted {} refused {}", seen.accepted, seen.not_accepted);
    let _ = writeln!(
        console,
        "telemetry {} missing {} marked {} ring_lost {}",
        seen.telemetry, seen.missing_ticks, seen.marked_gaps, seen.health.telemetry_lost
    );
    let _ = writeln!(
        console,
        "silent_at {} fault_at {} at_rest_at {}",
        SILENCE,
        seen.silent_fault_tick.unwrap_or(0),
        seen.at_rest_tick.unwrap_or(0)
    );
    let _ = writeln!(console, "cleared {}", fault.is_none());
    let _ = writeln!(console, "fed {}", closed.board.fed);
    let _ = writeln!(console, "hash {:016x}", closed.host.hash);
    exit(true)
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
