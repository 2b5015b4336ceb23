//! A board at a pseudo-terminal: the firmware's own application in real time, with the twin behind it.
//!
//! What opens [`BoardAtTerminal::port`] drives it as it would drive the board at `/dev/ttyUSB0`. It stays when its host goes, and takes
//! the next one.
//!
//! **Time.** The board's time follows the clock. It never makes up for more than 50 ms: where the computer was busy for longer, the
//! board's time was slower. A computer that is busy with other things also keeps the host from its heartbeats, which is no fault of the
//! host: while nothing has been heard for a tenth of a second, the board's time stands still, for `patience` at most.
// Three programs include this file, and none of them uses all of it.
#![allow(dead_code)]

use std::collections::VecDeque;
use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::fs::OpenOptionsExt;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use froude_board::application::Application;
use froude_board::board::{AxisLatched, Board, Latched, Scales};
use froude_control::fault::Fault;
use froude_control::status::Phase;
use froude_control::tick::{AXES, Command};
use froude_link::status::BoardId;
use froude_rig::load::Load;
use froude_rig::twin::{Twin, TwinConfig};
use rustix::fs::OFlags;
use rustix::pty::OpenptFlags;

const COMMAND_V: f64 = 10.0 / 32_768.0;
const CURRENT_A: f64 = 5.0 / 32_768.0;
const TICK: Duration = Duration::from_micros(250);
/// The board's time makes up for this much, ticks.
const MOST_OWED: u32 = 200;
/// Ticks between two looks at the line.
const AT_ONCE: u32 = 8;
/// Silence of the host that makes the board's time stand still: half of what the controller allows.
const SILENCE: Duration = Duration::from_millis(100);
/// Bytes on their way out.
const OUTBOX: usize = 4_096;

/// How a board begins.
pub struct BoardConfig {
    /// Where the axes stand, m from their low end switch.
    pub start_m: [f64; AXES],
    /// How long the board's time may stand still for a host that is kept from its heartbeats.
    pub patience: Duration,
}

/// What the board and its rig are doing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Watched {
    /// Ticks since power-up.
    pub ticks: u64,
    /// Latched fault.
    pub fault: Option<Fault>,
    /// Phases of the axes.
    pub phases: [Phase; AXES],
    /// Speed of the loads, m/s.
    pub speed_m_s: [f64; AXES],
    /// Farthest that any motor has been from where it began, m.
    pub moved_m: f64,
}

/// A board that runs in a thread of its own until it is dropped.
pub struct BoardAtTerminal {
    /// What a host opens.
    pub port: PathBuf,
    /// The same line, for what a second host says on it.
    pub line: File,
    watched: Arc<Mutex<Watched>>,
    is_over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl BoardAtTerminal {
    /// Powers up.
    pub fn new(config: &BoardConfig) -> std::io::Result<Self> {
        let (host_end, held, port) = terminal()?;
        let line = held.try_clone()?;
        // Raw, so that no byte is read as a command to the terminal.
        let mut raw = rustix::termios::tcgetattr(&held)?;
        raw.make_raw();
        rustix::termios::tcsetattr(&held, rustix::termios::OptionalActions::Now, &raw)?;
        rustix::fs::fcntl_setfl(&host_end, rustix::fs::fcntl_getfl(&host_end)? | OFlags::NONBLOCK)?;
        let mut twin = TwinConfig::loaded(Load::default());
        for (axis, start_m) in twin.axes.iter_mut().zip(config.start_m) {
            axis.start_m = start_m;
        }
        let watched = Arc::new(Mutex::new(Watched::default()));
        let is_over = Arc::new(AtomicBool::new(false));
        let twin = Twin::new(&twin, 3);
        let began_m = [0, 1].map(|i| twin.truth(i).motor_position_m);
        let board = TerminalBoard {
            twin,
            line: File::from(host_end),
            held,
            command: Command::default(),
            now_us: 0,
            inbox: VecDeque::new(),
            outbox: Vec::new(),
            owed: 0,
            heard: None,
            began_m,
            watched: Watched::default(),
        };
        let thread = {
            let (watched, is_over, patience) = (Arc::clone(&watched), Arc::clone(&is_over), config.patience);
            std::thread::spawn(move || board.run(patience, &watched, &is_over))
        };
        Ok(Self { port, line, watched, is_over, thread: Some(thread) })
    }

    /// What it is doing.
    pub fn watched(&self) -> Watched {
        self.watched.lock().map_or_else(|e| *e.into_inner(), |w| *w)
    }
}

impl Drop for BoardAtTerminal {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

struct TerminalBoard {
    twin: Twin,
    line: File,
    /// Held open, so that the line outlives its host.
    held: File,
    command: Command,
    now_us: u32,
    inbox: VecDeque<u8>,
    outbox: Vec<u8>,
    owed: u32,
    heard: Option<Instant>,
    began_m: [f64; AXES],
    watched: Watched,
}

impl TerminalBoard {
    fn run(mut self, patience: Duration, watched: &Mutex<Watched>, is_over: &AtomicBool) {
        let mut application = Application::new();
        application.announce(&mut self);
        let mut due = Instant::now();
        while !is_over.load(Ordering::SeqCst) {
            std::thread::sleep(4 * TICK);
            self.receive();
            let silence = self.heard.map_or(Duration::MAX, |at| at.elapsed());
            let is_standing = silence > SILENCE && silence < patience;
            let behind = due.elapsed().as_nanos() / TICK.as_nanos();
            if is_standing || behind > u128::from(MOST_OWED) {
                due = Instant::now();
            }
            let mut ticks = if is_standing { 0 } else { (behind as u32).min(MOST_OWED) };
            due += ticks * TICK;
            loop {
                let now = ticks.min(AT_ONCE);
                (self.owed, ticks) = (now, ticks - now);
                while application.turn(&mut self) {}
                self.transmit();
                if ticks == 0 {
                    break;
                }
                self.receive();
            }
            let status = &application.output().status;
            self.watched.ticks = self.twin.ticks();
            self.watched.fault = status.fault.map(|f| f.0);
            self.watched.phases = status.axes.map(|a| a.phase);
            for i in 0..AXES {
                let truth = self.twin.truth(i);
                self.watched.speed_m_s[i] = truth.load_speed_m_s;
                self.watched.moved_m = self.watched.moved_m.max((truth.motor_position_m - self.began_m[i]).abs());
            }
            if let Ok(mut shown) = watched.lock() {
                *shown = self.watched;
            }
        }
    }

    fn receive(&mut self) {
        let mut chunk = [0_u8; 4_096];
        while let Ok(n @ 1..) = self.line.read(&mut chunk) {
            self.inbox.extend(&chunk[..n]);
            self.heard = Some(Instant::now());
        }
    }

    fn transmit(&mut self) {
        while !self.outbox.is_empty() {
            match self.line.write(&self.outbox) {
                Ok(n @ 1..) => drop(self.outbox.drain(..n)),
                _ => break,
            }
        }
    }
}

impl Board for TerminalBoard {
    const ID: BoardId = BoardId::Twin;
    const BAUD: u32 = 3_000_000;

    fn scales(&self) -> Scales {
        Scales { command_v_per_count: [COMMAND_V; AXES], current_a_per_count: [CURRENT_A; AXES] }
    }
    fn boot_number(&self) -> u32 {
        1
    }
    fn was_watchdog_reset(&self) -> bool {
        false
    }
    fn now_us(&mut self) -> u32 {
        self.now_us
    }
    fn take_tick(&mut self) -> Option<Latched> {
        self.owed = self.owed.checked_sub(1)?;
        let tick = self.twin.tick(self.command);
        self.now_us = tick.latched_us;
        let axes = tick.axes.map(|a| AxisLatched {
            encoder_count: a.encoder_count,
            encoder_errors: a.encoder_errors,
            current_counts: (a.current_a / CURRENT_A) as i16,
            is_low_end: a.is_low_end,
            is_high_end: a.is_high_end,
            is_amplifier_ready: a.is_amplifier_ready,
        });
        Some(Latched { latched_us: tick.latched_us, ticks: 1, axes, is_estop_open: tick.is_estop_open })
    }
    fn actuate(&mut self, command: &Command) -> [i16; AXES] {
        self.command = *command;
        command.axes.map(|a| (a.volts / COMMAND_V) as i16)
    }
    fn read_byte(&mut self) -> Option<u8> {
        self.inbox.pop_front()
    }
    fn write_byte(&mut self, byte: u8) -> bool {
        let has_room = self.outbox.len() < OUTBOX;
        if has_room {
            self.outbox.push(byte);
        }
        has_room
    }
    fn port_overflows(&self) -> u32 {
        0
    }
    fn feed_watchdog(&mut self) {}
}

/// A pseudo-terminal for a person: what is written to the first end is typed at the second.
pub fn keyboard() -> std::io::Result<(File, OwnedFd)> {
    let (typed, read, _) = terminal()?;
    Ok((File::from(typed), OwnedFd::from(read)))
}

/// Both ends of a pseudo-terminal, which is nobody's controlling one, and the second end's path.
fn terminal() -> std::io::Result<(OwnedFd, File, PathBuf)> {
    let first = rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
    rustix::pty::grantpt(&first)?;
    rustix::pty::unlockpt(&first)?;
    let name = rustix::pty::ptsname(&first, Vec::new())?;
    let path = PathBuf::from(name.to_string_lossy().into_owned());
    let second =
        File::options().read(true).write(true).custom_flags(OFlags::NOCTTY.bits().cast_signed()).open(&path)?;
    Ok((first, second, path))
}
