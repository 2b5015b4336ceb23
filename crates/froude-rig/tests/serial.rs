//! The firmware's own application, with the twin behind it, at the other end of a line: what the host drives when it drives a board.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use froude_board::application::Application;
use froude_board::board::{AxisLatched, Board, Latched, Scales};
use froude_control::config::Config;
use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Move, Request};
use froude_control::status::{Phase, Refusal};
use froude_control::tick::{AXES, Command};
use froude_link::status::BoardId;
use froude_rig::defaults::control_config;
use froude_rig::drive::serial::SerialRig;
use froude_rig::drive::{Rig, RigError, Sample};
use froude_rig::load::Load;
use froude_rig::twin::{Twin, TwinConfig};

const COMMAND_V: f64 = 10.0 / 32_768.0;
const CURRENT_A: f64 = 5.0 / 32_768.0;

/// A board whose rig is the twin and whose serial port is a socket. A tick is due whenever the last one was taken and the line is idle,
/// so its time runs as fast as the host listens.
struct TwinBoard {
    twin: Twin,
    line: UnixStream,
    command: Command,
    now_us: u32,
    bytes: std::collections::VecDeque<u8>,
    /// Ticks that the host has not heard of are held back beyond this many, as a line of finite speed would.
    credit: Arc<std::sync::atomic::AtomicI64>,
}

impl Board for TwinBoard {
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
        if self.credit.fetch_sub(1, Ordering::SeqCst) <= 0 {
            self.credit.fetch_add(1, Ordering::SeqCst);
            return None;
        }
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
        if self.bytes.is_empty() {
            let mut chunk = [0_u8; 512];
            if let Ok(n) = self.line.read(&mut chunk) {
                self.bytes.extend(&chunk[..n]);
            }
        }
        self.bytes.pop_front()
    }
    fn write_byte(&mut self, byte: u8) -> bool {
        self.line.write(&[byte]).is_ok_and(|n| n == 1)
    }
    fn port_overflows(&self) -> u32 {
        0
    }
    fn feed_watchdog(&mut self) {}
}

/// The board in a thread of its own, until told to end; gives back the application's last word and the twin.
struct Running {
    thread: JoinHandle<(Option<(Fault, u8)>, [Phase; AXES])>,
    is_over: Arc<AtomicBool>,
}

/// Ticks a millisecond of real time: four is real time; the tests hurry.
const HURRY: i64 = 40;

fn board() -> (Running, UnixStream) {
    let (ours, theirs) = UnixStream::pair().unwrap();
    theirs.set_nonblocking(true).unwrap();
    ours.set_read_timeout(Some(Duration::from_millis(2))).unwrap();
    let is_over = Arc::new(AtomicBool::new(false));
    let stop = Arc::clone(&is_over);
    let thread = std::thread::spawn(move || {
        let credit = Arc::new(std::sync::atomic::AtomicI64::new(0));
        let twin = Twin::new(&TwinConfig::loaded(Load::default()), 3);
        let mut board = TwinBoard {
            twin,
            line: theirs,
            command: Command::default(),
            now_us: 0,
            bytes: std::collections::VecDeque::new(),
            credit: Arc::clone(&credit),
        };
        let mut application = Application::new();
        application.announce(&mut board);
        let mut last = std::time::Instant::now();
        while !stop.load(Ordering::SeqCst) {
            if last.elapsed() >= Duration::from_millis(1) {
                last = std::time::Instant::now();
                credit.store(HURRY, Ordering::SeqCst);
            }
            application.turn(&mut board);
        }
        let status = application.output().status;
        (status.fault, status.axes.map(|a| a.phase))
    });
    (Running { thread, is_over }, ours)
}

impl Running {
    fn end(self) -> (Option<(Fault, u8)>, [Phase; AXES]) {
        self.is_over.store(true, Ordering::SeqCst);
        self.thread.join().unwrap()
    }
}

fn config() -> Config {
    let load = Load::default();
    // The board's time runs ten times as fast as the host's: its watchdog has to be as much more patient.
    Config { host_silence_us: 4_000_000, ..control_config(&[load, load]) }
}

fn until(rig: &mut SerialRig, limit_s: f64, done: impl Fn(&Sample) -> bool) -> Sample {
    let begun = std::time::Instant::now();
    loop {
        let sample = rig.tick(None).unwrap();
        assert_eq!(sample.fault, None, "{sample:?}");
        if done(&sample) {
            return sample;
        }
        assert!(begun.elapsed().as_secs_f64() < limit_s, "{sample:?}");
    }
}

#[test]
fn a_board_is_greeted_configured_homed_and_moved_over_the_line() {
    let (running, line) = board();
    let mut rig = SerialRig::on("a socket", Box::new(line), config()).unwrap();
    assert_eq!(rig.rate_hz(), 4_000.0);
    rig.tick(Some(Request::Enable { axis: 0 })).unwrap();
    until(&mut rig, 20.0, |s| s.axes[0].phase == Phase::Holding);
    rig.tick(Some(Request::Home { axis: 0 })).unwrap();
    until(&mut rig, 60.0, |s| s.axes[0].is_homed && s.axes[0].phase == Phase::Holding);
    // Time for the beginning of the counts to be learnt.
    for _ in 0..4_000 {
        rig.tick(None).unwrap();
    }
    let profile = Move { target_m: 0.5, speed_m_s: 0.3, acceleration_m_s2: 0.5, jerk_m_s3: 0.0, is_shaped: false };
    rig.tick(Some(Request::Move { axis: 0, profile })).unwrap();
    until(&mut rig, 20.0, |s| s.axes[0].phase == Phase::Moving);
    let end = until(&mut rig, 30.0, |s| s.axes[0].phase == Phase::Holding);
    // Three counts of 2.5 µm: friction holds the axis within them, and the beginning of the counts is as good.
    assert!((end.axes[0].position_m - 0.5).abs() < 1e-5, "{end:?}");
    // The last tick lies just before now on the host's clock, as well as the line's delay tells.
    let now_s = || std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_secs_f64();
    let last = rig.tick(None).unwrap();
    let clock = rig.host_clock(last.tick).unwrap();
    assert!((clock.unix_s - now_s()).abs() < 1.0, "{clock:?} {}", now_s());
    assert!(clock.standard_uncertainty_s > 0.0 && clock.standard_uncertainty_s.is_finite(), "{clock:?}");
    println!("{clock:?}, off by {} s", clock.unix_s - now_s());
    // A refused request comes back as one.
    rig.tick(Some(Request::Move { axis: 0, profile: Move { target_m: 50.0, ..profile } })).unwrap();
    let refused = until(&mut rig, 20.0, |s| s.refusal.is_some());
    assert_eq!(refused.refusal, Some(Refusal::BeyondTravel));
    running.end();
}

#[test]
fn a_host_that_vanishes_is_noticed_by_the_board_which_stops_by_itself() {
    let (running, line) = board();
    let mut rig = SerialRig::on("a socket", Box::new(line), config()).unwrap();
    rig.tick(Some(Request::Enable { axis: 0 })).unwrap();
    until(&mut rig, 20.0, |s| s.axes[0].phase == Phase::Holding);
    drop(rig);
    // Four seconds of the board's time at ten times the host's, and the stop.
    std::thread::sleep(Duration::from_millis(1_500));
    let (fault, phases) = running.end();
    assert_eq!(fault.map(|f| f.0), Some(Fault::HostSilent));
    assert_eq!(Fault::HostSilent.category(), StopCategory::One);
    assert_eq!(phases[0], Phase::Disabled);
}

#[test]
fn a_port_that_vanishes_is_an_error_that_says_who_stops_the_carriage() {
    let (running, line) = board();
    let mut rig = SerialRig::on("a socket", Box::new(line), config()).unwrap();
    running.end();
    let error = loop {
        if let Err(error) = rig.tick(None) {
            break error;
        }
    };
    assert!(matches!(error, RigError::Port { .. }), "{error}");
    assert!(error.to_string().ends_with("the board's own watchdog stops the carriage"), "{error}");
}

#[test]
fn a_line_without_a_board_is_told_with_what_to_do() {
    let (ours, _theirs) = UnixStream::pair().unwrap();
    ours.set_read_timeout(Some(Duration::from_millis(2))).unwrap();
    let error = SerialRig::on("a socket", Box::new(ours), config()).map(|_| ()).unwrap_err();
    assert!(error.to_string().starts_with("the board at a socket has sent no valid frame for 5."), "{error}");
}
