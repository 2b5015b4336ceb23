//! The firmware's own application, with the twin behind it, at the other end of a line: what the host drives when it drives a board.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread::JoinHandle;
use std::time::Duration;

use froude_board::application::Application;
use froude_board::board::{AxisLatched, Board, Latched, Scales};
use froude_control::config::Config;
use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Move, Request};
use froude_control::status::{Phase, Refusal};
use froude_control::tick::{AXES, Command};
use froude_link::frame::{FrameWriter, MAX_WIRE};
use froude_link::session::NOBODY;
use froude_link::status::{Ack, BoardHello, BoardId, Health, TurnedAway, Verdict};
use froude_link::{FrameReader, FromBoard, HostFrame, Telemetry, ToBoard};
use froude_rig::defaults::control_config;
use froude_rig::drive::serial::SerialRig;
use froude_rig::drive::{Rig, RigError, Sample, Stranger};
use froude_rig::load::Load;
use froude_rig::twin::{Twin, TwinConfig};

const COMMAND_V: f64 = 10.0 / 32_768.0;
const CURRENT_A: f64 = 5.0 / 32_768.0;

/// A board whose rig is the twin and whose serial port is a few sockets, as if several hosts were on one line. A tick is due whenever the last one was taken and the line is idle,
/// so its time runs as fast as the host listens.
struct TwinBoard {
    twin: Twin,
    lines: Vec<UnixStream>,
    command: Command,
    now_us: u32,
    bytes: std::collections::VecDeque<u8>,
    /// Ticks that the host has not heard of are held back beyond this many, as a line of finite speed would.
    credit: Arc<std::sync::atomic::AtomicI64>,
    ticks: Arc<AtomicU64>,
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
        self.ticks.fetch_add(1, Ordering::SeqCst);
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
            let mut chunk = [0_u8; 4096];
            for line in &mut self.lines {
                if let Ok(n) = line.read(&mut chunk) {
                    self.bytes.extend(&chunk[..n]);
                }
            }
        }
        self.bytes.pop_front()
    }
    fn write_byte(&mut self, byte: u8) -> bool {
        // One host is waited for; of several, a port cannot know who listens.
        if let [line] = &mut self.lines[..] {
            return line.write(&[byte]).is_ok_and(|n| n == 1);
        }
        for line in &mut self.lines {
            let _ = line.write(&[byte]);
        }
        true
    }
    fn port_overflows(&self) -> u32 {
        0
    }
    fn feed_watchdog(&mut self) {}
}

/// The board in a thread of its own, until asked to end; gives back the application's last word and the twin.
struct Running {
    thread: JoinHandle<(Option<(Fault, u8)>, [Phase; AXES])>,
    is_over: Arc<AtomicBool>,
    is_reset: Arc<AtomicBool>,
    ticks: Arc<AtomicU64>,
    _alone: MutexGuard<'static, ()>,
}

/// Boards run one at a time: each wants a processor.
static ALONE: Mutex<()> = Mutex::new(());

/// Ticks a millisecond of real time: four is real time; the tests hurry.
const HURRY: i64 = 40;

fn board() -> (Running, UnixStream) {
    let (running, [line]) = board_with_hosts();
    (running, line)
}

/// A board with so many hosts on its line.
fn board_with_hosts<const N: usize>() -> (Running, [UnixStream; N]) {
    let alone = ALONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let mut lines = vec![];
    let ours = [(); N].map(|()| {
        let (ours, theirs) = UnixStream::pair().unwrap();
        theirs.set_nonblocking(true).unwrap();
        ours.set_read_timeout(Some(Duration::from_millis(2))).unwrap();
        lines.push(theirs);
        ours
    });
    let is_over = Arc::new(AtomicBool::new(false));
    let is_reset = Arc::new(AtomicBool::new(false));
    let ticks = Arc::new(AtomicU64::new(0));
    let (stop, reset, counted) = (Arc::clone(&is_over), Arc::clone(&is_reset), Arc::clone(&ticks));
    let thread = std::thread::spawn(move || {
        let credit = Arc::new(std::sync::atomic::AtomicI64::new(0));
        let twin = Twin::new(&TwinConfig::loaded(Load::default()), 3);
        let mut board = TwinBoard {
            twin,
            lines,
            command: Command::default(),
            now_us: 0,
            bytes: std::collections::VecDeque::new(),
            credit: Arc::clone(&credit),
            ticks: counted,
        };
        let mut application = Application::new();
        application.announce(&mut board);
        let mut last = std::time::Instant::now();
        while !stop.load(Ordering::SeqCst) {
            if last.elapsed() >= Duration::from_millis(1) {
                last = std::time::Instant::now();
                credit.store(HURRY, Ordering::SeqCst);
            }
            if reset.swap(false, Ordering::SeqCst) {
                application = Application::new();
                application.announce(&mut board);
            }
            if !application.turn(&mut board) {
                std::thread::sleep(Duration::from_micros(200));
            }
        }
        let status = application.output().status;
        (status.fault, status.axes.map(|a| a.phase))
    });
    (Running { thread, is_over, is_reset, ticks, _alone: alone }, ours)
}

impl Running {
    /// Waits until so much of the board's time has passed.
    fn pass_s(&self, s: f64) {
        let until = self.ticks.load(Ordering::SeqCst) + (4_000.0 * s) as u64;
        while self.ticks.load(Ordering::SeqCst) < until {
            std::thread::sleep(Duration::from_millis(1));
        }
    }

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
    // Of a host that is slow the board drops telemetry: that it moved may be among it, where it ended is not.
    let is_there = |s: &Sample| s.axes[0].phase == Phase::Holding && (s.axes[0].reference_m - 0.5).abs() < 1e-6;
    let end = until(&mut rig, 30.0, is_there);
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
    // Four seconds of the board's time, and the stop.
    running.pass_s(6.0);
    let (fault, phases) = running.end();
    assert_eq!(fault.map(|f| f.0), Some(Fault::HostSilent));
    assert_eq!(Fault::HostSilent.category(), StopCategory::One);
    assert_eq!(phases[0], Phase::Disabled);
}

/// A line on which telemetry no longer gets through once it is broken, and everything else does.
struct Worn {
    line: UnixStream,
    is_broken: Arc<AtomicBool>,
    reader: FrameReader<FromBoard>,
    writer: FrameWriter,
    passed: std::collections::VecDeque<u8>,
}

impl Read for Worn {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        let mut chunk = [0_u8; 1_024];
        let n = self.line.read(&mut chunk)?;
        for &byte in &chunk[..n] {
            let Some(received) = self.reader.feed(byte) else { continue };
            let is_telemetry = matches!(received.message, FromBoard::Telemetry(_));
            if !(is_telemetry && self.is_broken.load(Ordering::SeqCst)) {
                let mut wire = [0; MAX_WIRE];
                self.passed.extend(self.writer.write(&received.message, &mut wire));
            }
        }
        if self.passed.is_empty() { Err(std::io::ErrorKind::WouldBlock.into()) } else { self.passed.read(bytes) }
    }
}

impl Write for Worn {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.line.write(bytes)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        self.line.flush()
    }
}

#[test]
fn a_line_whose_telemetry_dies_is_given_up_and_the_carriage_stopped_whatever_else_it_carries() {
    let (running, line) = board();
    let is_broken = Arc::new(AtomicBool::new(false));
    let (reader, writer, passed) = (FrameReader::new(), FrameWriter::default(), std::collections::VecDeque::new());
    let worn = Worn { line, is_broken: Arc::clone(&is_broken), reader, writer, passed };
    let mut rig = SerialRig::on("a socket", Box::new(worn), config()).unwrap();
    rig.tick(Some(Request::Enable { axis: 0 })).unwrap();
    until(&mut rig, 20.0, |s| s.axes[0].phase == Phase::Holding);
    is_broken.store(true, Ordering::SeqCst);
    let begun = std::time::Instant::now();
    let error = loop {
        match rig.tick(None) {
            Ok(_) => assert!(begun.elapsed() < Duration::from_secs(20), "answers about the time keep it waiting"),
            Err(error) => break error,
        }
    };
    assert!(matches!(error, RigError::Silent { .. }), "{error}");
    // Sooner than the board's own watchdog: it was commanded.
    running.pass_s(1.0);
    assert_eq!(running.end(), (None, [Phase::Disabled; AXES]));
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
fn a_line_without_a_board_is_reported_with_what_to_do() {
    let (ours, _theirs) = UnixStream::pair().unwrap();
    ours.set_read_timeout(Some(Duration::from_millis(2))).unwrap();
    let error = SerialRig::on("a socket", Box::new(ours), config()).map(|_| ()).unwrap_err();
    assert!(error.to_string().starts_with("the board at a socket has sent no valid frame for 5."), "{error}");
}

/// A port whose buffer is full two times of three, and takes a byte or two then.
struct Full {
    line: UnixStream,
    asked: u32,
}

impl std::io::Read for Full {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        self.line.read(bytes)
    }
}

impl std::io::Write for Full {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.asked += 1;
        match self.asked % 3 {
            0 => self.line.write(&bytes[..bytes.len().min(2)]),
            1 => Err(std::io::ErrorKind::WouldBlock.into()),
            _ => Err(std::io::ErrorKind::TimedOut.into()),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.line.flush()
    }
}

/// A port that takes nothing.
struct Shut(UnixStream);

impl std::io::Read for Shut {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        self.0.read(bytes)
    }
}

impl std::io::Write for Shut {
    fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
        Err(std::io::ErrorKind::WouldBlock.into())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// A busy machine, or a hub: what cannot be written now is written a moment later, whole. A port that takes nothing for a second is lost.
#[test]
fn a_port_that_is_full_for_a_moment_is_no_error() {
    let (running, line) = board();
    let mut rig = SerialRig::on("a socket", Box::new(Full { line, asked: 0 }), config()).unwrap();
    rig.tick(Some(Request::Enable { axis: 0 })).unwrap();
    until(&mut rig, 20.0, |s| s.axes[0].phase == Phase::Holding);
    let (fault, phases) = running.end();
    assert_eq!((fault, phases[0]), (None, Phase::Holding));
    let (line, _other) = UnixStream::pair().unwrap();
    line.set_read_timeout(Some(Duration::from_millis(2))).unwrap();
    let began = std::time::Instant::now();
    let error = SerialRig::on("a socket", Box::new(Shut(line)), config()).map(|_| ()).unwrap_err();
    assert!(matches!(error, RigError::Port { .. }), "{error}");
    assert!(began.elapsed() >= Duration::from_secs(1));
}

/// Ticks a rig until it has read this tick of the board; the sessions that were reported to it, and why it ended if it did by itself.
fn driven(mut rig: SerialRig, last: Arc<AtomicU64>) -> JoinHandle<(Vec<Stranger>, Result<(), RigError>)> {
    std::thread::spawn(move || {
        let mut strangers = vec![];
        loop {
            match rig.tick(None) {
                Ok(sample) => {
                    assert_eq!(sample.fault, None, "{sample:?}");
                    strangers.extend(sample.stranger);
                    if sample.tick >= last.load(Ordering::SeqCst) {
                        return (strangers, Ok(()));
                    }
                }
                Err(error) => return (strangers, Err(error)),
            }
        }
    })
}

#[test]
fn a_second_host_is_refused_while_the_first_lives_and_the_first_learns_of_it() {
    let (running, [line, other]) = board_with_hosts();
    let mut rig = SerialRig::on("a socket", Box::new(line), config()).unwrap();
    rig.tick(Some(Request::Enable { axis: 0 })).unwrap();
    until(&mut rig, 20.0, |s| s.axes[0].phase == Phase::Holding);
    let last = Arc::new(AtomicU64::new(u64::MAX));
    let first = driven(rig, Arc::clone(&last));
    let error = SerialRig::on("a socket", Box::new(other), config()).map(|_| ()).unwrap_err();
    assert!(matches!(error, RigError::Held { holder, .. } if holder != NOBODY), "{error}");
    let said = error.to_string();
    assert!(said.starts_with("the board at a socket is being driven by another program (session "), "{said}");
    assert!(said.ends_with("End that program, then run again"), "{said}");
    running.pass_s(1.0);
    last.store(running.ticks.load(Ordering::SeqCst), Ordering::SeqCst);
    let (strangers, end) = first.join().unwrap();
    end.unwrap();
    assert!(matches!(strangers[..], [Stranger::TurnedAway(_)]), "said once: {strangers:x?}");
    let (fault, phases) = running.end();
    assert_eq!((fault, phases[0]), (None, Phase::Holding), "the first one's axis holds as before");
}

#[test]
fn a_stop_from_another_host_is_obeyed_and_the_first_learns_whose_it_was() {
    let (running, [line, mut other]) = board_with_hosts();
    let mut rig = SerialRig::on("a socket", Box::new(line), config()).unwrap();
    rig.tick(Some(Request::Enable { axis: 0 })).unwrap();
    until(&mut rig, 20.0, |s| s.axes[0].phase == Phase::Holding);
    let last = Arc::new(AtomicU64::new(u64::MAX));
    let first = driven(rig, Arc::clone(&last));
    let (mut writer, mut wire) = (FrameWriter::default(), [0_u8; 256]);
    let stop = ToBoard::Request { id: 1, request: Request::Stop(StopCategory::One) };
    // More than once, as whoever means it does: a machine that is busy may lose the board's answer on this hurried line.
    for _ in 0..5 {
        std::io::Write::write_all(&mut other, writer.write(&stop.from_session(0xb), &mut wire)).unwrap();
        running.pass_s(0.4);
    }
    last.store(running.ticks.load(Ordering::SeqCst), Ordering::SeqCst);
    let (strangers, end) = first.join().unwrap();
    end.unwrap();
    assert!(!strangers.is_empty() && strangers.iter().all(|s| *s == Stranger::Stopped(0xb)), "{strangers:x?}");
    let (fault, phases) = running.end();
    assert_eq!((fault, phases[0]), (None, Phase::Disabled), "a stop of category 1 takes the torque off");
}

#[test]
fn a_host_that_died_is_followed_by_the_next_one_after_its_silence() {
    let (running, [line, other]) = board_with_hosts();
    let mut rig = SerialRig::on("a socket", Box::new(line), config()).unwrap();
    rig.tick(Some(Request::Enable { axis: 0 })).unwrap();
    until(&mut rig, 20.0, |s| s.axes[0].phase == Phase::Holding);
    drop(rig);
    // At once: for four seconds of the board's time it waits for the dead one.
    let mut next = SerialRig::on("a socket", Box::new(other), config()).unwrap();
    let sample = next.tick(None).unwrap();
    assert_eq!(
        (sample.fault, sample.axes[0].phase),
        (None, Phase::Disabled),
        "stopped by the board, cleared by its name"
    );
    running.end();
}

/// A board that gives itself to whoever greets, takes every configuration, and then lets another session have it.
fn taken_over(mut line: UnixStream, holder: u32) -> JoinHandle<()> {
    std::thread::spawn(move || {
        let (mut reader, mut writer) = (FrameReader::<HostFrame>::new(), FrameWriter::default());
        let (mut tick, mut bytes) = (0, [0; 4096]);
        let hello = |session| BoardHello {
            board: BoardId::Twin,
            boot: 1,
            baud: 3_000_000,
            telemetry_every: 1,
            tick_us: 250,
            command_v_per_count: [COMMAND_V; 2],
            current_a_per_count: [CURRENT_A; 2],
            is_configured: false,
            was_watchdog_reset: false,
            session,
        };
        while let Ok(n @ 1..) = line.read(&mut bytes) {
            for received in bytes[..n].iter().filter_map(|&byte| reader.feed(byte)) {
                let HostFrame { session, says } = received.message;
                tick += 1;
                let answer = match says {
                    ToBoard::Hello => FromBoard::Hello(hello(session)),
                    ToBoard::Configure { id, .. } => {
                        FromBoard::Ack(Ack { session, id, tick, verdict: Verdict::Accepted })
                    }
                    ToBoard::Request { .. } => {
                        FromBoard::TurnedAway(TurnedAway { session, holder, holder_frames: 9, free_in_us: 210_000 })
                    }
                    // Nothing to answer.
                    _ => FromBoard::Health(Health::default()),
                };
                // What another host is answered is no business of ours.
                let others = FromBoard::Ack(Ack { session: holder, id: 2, tick, verdict: Verdict::NotNow });
                for message in
                    [others, answer, FromBoard::Telemetry(Telemetry { tick: tick + 1, ..Telemetry::default() })]
                {
                    let _ = line.write_all(writer.write(&message, &mut [0; MAX_WIRE]));
                }
            }
        }
    })
}

#[test]
fn a_host_that_slept_too_long_is_told_who_has_the_board() {
    let (ours, theirs) = UnixStream::pair().unwrap();
    ours.set_read_timeout(Some(Duration::from_millis(2))).unwrap();
    let board = taken_over(theirs, 0xbeef);
    let mut rig = SerialRig::on("a socket", Box::new(ours), config()).unwrap();
    let mut request = Some(Request::Enable { axis: 0 });
    let error = (0..10_000).find_map(|_| rig.tick(request.take()).err()).unwrap();
    assert!(matches!(error, RigError::TakenOver { holder: 0xbeef, .. }), "{error}");
    assert!(
        error.to_string().starts_with(
            "the board at a socket is driven by another program now (session 0000beef): this one was silent"
        ),
        "{error}"
    );
    drop(rig);
    board.join().unwrap();
}

#[test]
fn a_board_that_starts_anew_is_told_from_one_that_is_silent() {
    let (running, line) = board();
    let mut rig = SerialRig::on("a socket", Box::new(line), config()).unwrap();
    rig.tick(None).unwrap();
    running.is_reset.store(true, Ordering::SeqCst);
    let begun = std::time::Instant::now();
    let error = loop {
        if let Err(error) = rig.tick(None) {
            break error;
        }
        assert!(begun.elapsed() < Duration::from_secs(20));
    };
    assert!(matches!(error, RigError::Restarted { .. }), "{error}");
    assert!(error.to_string().starts_with("the board at a socket has restarted: the torque is off"), "{error}");
    running.end();
}

#[test]
fn a_board_of_the_first_version_is_named_with_what_to_do() {
    let (ours, mut theirs) = UnixStream::pair().unwrap();
    ours.set_read_timeout(Some(Duration::from_millis(2))).unwrap();
    // Its answer to a hello of another version: a hello cut short behind its own.
    let mut wire = [0; MAX_WIRE];
    theirs.write_all(FrameWriter::default().write(&FromBoard::ForeignHello { version: 1 }, &mut wire)).unwrap();
    let error = SerialRig::on("a socket", Box::new(ours), config()).map(|_| ()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the board at a socket speaks version 1 of the protocol, this program 2; flash the matching firmware"
    );
    // And ours is what that board would recognise as another version: the version stands where it always stood.
    let mut sent = [0; 64];
    let n = theirs.read(&mut sent).unwrap();
    let mut plain = [0; 64];
    let length = sent[..n].iter().position(|&byte| byte == 0).unwrap();
    cobs::decode(&sent[..length], &mut plain).unwrap();
    assert_eq!((plain[0], &plain[3..9]), (0x80, &b"FROU\x02\x00"[..]));
}
