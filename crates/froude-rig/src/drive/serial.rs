//! The real rig: a board at a serial port.
//!
//! The board runs the loop; the host hands over requests, listens, and says every 20 ms that it is there: silent for longer than the
//! configured time, the board stops the carriage by itself (category 1). A request is repeated with its number until the board
//! has answered it, so a lost frame costs time and nothing else; a lost telemetry frame is a gap in the record.
//!
//! **One operator.** The port is opened for this program alone. On the line every frame carries a session number, drawn when the rig
//! is opened; the board does what one session asks for and turns others away until that one has been silent ([`froude_link::session`]).
//! A program that finds the board taken waits as long as a program that has died would keep it, and gives up when the other one lives.
//!
//! **Position.** Telemetry carries raw counts. Where they begin is learnt while the axis holds after homing: the mean of reference less
//! counts over half a second, good to less than a count (2.5 µm).
//!
//! **Clock.** Ten times a second the board is asked for its time; where its ticks lie on the host's clock goes into every record, with the
//! uncertainty of that ([`froude_link::clock`]).
//!
//! Not here: the force sensor, which has a box of its own; its log is joined by time afterwards.

use std::collections::VecDeque;
use std::hash::{BuildHasher, RandomState};
use std::io::{Read, Write};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use froude_control::config::Config;
use froude_control::fault::{Fault, StopCategory};
use froude_control::request::Request;
use froude_control::status::{Phase, Refusal};
use froude_control::tick::AXES;
use froude_link::clock::{Aligner, Exchange, Unwrapped};
use froude_link::message::{FromBoard, ToBoard};
use froude_link::session::NOBODY;
use froude_link::status::{Ack, BoardHello, TurnedAway, Verdict};
use froude_link::{FrameReader, FrameWriter, Telemetry, VERSION};

use super::port::Port;
use super::{AxisSample, HostClock, Rig, RigError, Sample, Stranger};
use crate::load::Load;

/// A sign of life at least this often.
const HEARTBEAT: Duration = Duration::from_millis(20);
/// The board is asked for its time this often.
const ASK_TIME: Duration = Duration::from_millis(100);
/// A request that was not answered is repeated after this time.
const REPEAT: Duration = Duration::from_millis(50);
/// Listened to for this long without telemetry, the board is stopped and given up. Until then a stop of the operator waits with it.
const SILENCE: Duration = Duration::from_secs(1);
/// No longer than this has it listened between two looks at the line: a computer that stood still itself heard nobody's silence.
const ATTENTION: Duration = Duration::from_millis(50);
/// Pause before a port is asked again that takes nothing at the moment.
const BETWEEN_WRITES: Duration = Duration::from_micros(200);
/// How long the greeting and the configuration may take.
const GREETING: Duration = Duration::from_secs(5);
/// Holding samples after homing over which the beginning of the counts is averaged.
const LEARNING: u32 = 2_000;
/// Longest frame on the line.
const LONGEST_FRAME: usize = 1_024;

/// Any line: a serial port, or whatever a test puts in its place. Reads must return after a few milliseconds at the latest.
pub trait Line: Read + Write + Send {}
impl<T: Read + Write + Send> Line for T {}

/// Writes a whole frame. A port whose buffer is full for the moment says so (`WouldBlock`, `TimedOut`): it is asked again for as long as a
/// board may be silent.
fn write_with_patience(line: &mut dyn Line, mut frame: &[u8]) -> std::io::Result<()> {
    use std::io::ErrorKind::{Interrupted, TimedOut, WouldBlock, WriteZero};
    let begun = Instant::now();
    while !frame.is_empty() {
        match line.write(frame) {
            Ok(0) => return Err(WriteZero.into()),
            Ok(n) => frame = &frame[n..],
            Err(e) if matches!(e.kind(), WouldBlock | TimedOut | Interrupted) && begun.elapsed() < SILENCE => {
                std::thread::sleep(BETWEEN_WRITES);
            }
            Err(e) => return Err(e),
        }
    }
    Ok(())
}

/// Where the counts of an axis begin.
#[derive(Debug, Clone, Copy, Default)]
struct Origin {
    /// Sum of reference less counted position, m, over the samples so far.
    sum_m: f64,
    samples: u32,
    count: Option<i64>,
    last: u32,
}

/// A board at a port.
pub struct SerialRig {
    port: String,
    line: Box<dyn Line>,
    session: u32,
    /// The first time that the board turned this session away.
    refused: Option<TurnedAway>,
    /// The last session that was turned away because this one has the board, and whether that is still to be said.
    stranger: Option<(u32, bool)>,
    /// Another session whose stop the board carried out, until it is reported.
    stopped_by: Option<u32>,
    reader: FrameReader<FromBoard>,
    writer: FrameWriter,
    config: Config,
    hello: Option<BoardHello>,
    heard: VecDeque<Telemetry>,
    ticks: Unwrapped,
    origins: [Origin; AXES],
    /// The request that has no answer yet, its number, and when it was last sent.
    asked: Option<(u16, Request, Instant)>,
    id: u16,
    answer: Option<Ack>,
    /// Telemetry up to this tick is of an earlier configuration, or of another host's time.
    stale_until: Option<u32>,
    refusal: Option<Refusal>,
    last_sent: Instant,
    /// When it last listened, and how long it has listened since something was heard.
    listened: Instant,
    unheard: Duration,
    clock: Clock,
}

/// Exchanges of time with the board.
struct Clock {
    /// When the host's stamps begin, on both of its clocks.
    opened: Instant,
    opened_unix_s: f64,
    asked: Instant,
    aligner: Aligner,
    board: Unwrapped,
    /// The last telemetry: its tick, and its time on the board's clock without wraps, µs.
    latched: Option<(u64, u64)>,
}

impl Clock {
    fn new() -> Self {
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let now = Instant::now();
        Self {
            opened: now,
            opened_unix_s: since_1970.as_secs_f64(),
            asked: now,
            aligner: Aligner::default(),
            board: Unwrapped::default(),
            latched: None,
        }
    }

    fn host_us(&self) -> u64 {
        self.opened.elapsed().as_micros() as u64
    }
}

impl SerialRig {
    /// Opens a port, greets the board and configures it.
    ///
    /// # Errors
    ///
    /// [`RigError`]: no such port, or another program has it; no answer, another version, a board that another program drives, a
    /// configuration that the board does not take.
    pub fn open(port: &str, baud: u32, config: Config) -> Result<Self, RigError> {
        Self::on(port, Box::new(Port::open(port, baud)?), config)
    }

    /// The same on any line; `port` is its name in messages.
    ///
    /// # Errors
    ///
    /// As [`Self::open`].
    pub fn on(port: &str, line: Box<dyn Line>, config: Config) -> Result<Self, RigError> {
        let now = Instant::now();
        let mut rig = Self {
            port: port.to_owned(),
            line,
            session: drawn_session(),
            refused: None,
            stranger: None,
            stopped_by: None,
            reader: FrameReader::new(),
            writer: FrameWriter::default(),
            config,
            hello: None,
            heard: VecDeque::new(),
            ticks: Unwrapped::default(),
            origins: [Origin::default(); AXES],
            asked: None,
            id: 0,
            answer: None,
            stale_until: None,
            refusal: None,
            last_sent: now,
            listened: now,
            unheard: Duration::ZERO,
            clock: Clock::new(),
        };
        rig.greet()?;
        rig.configure()?;
        Ok(rig)
    }

    /// Asks for the board until it says that it is ours.
    fn greet(&mut self) -> Result<(), RigError> {
        let begun = Instant::now();
        let mut sent: Option<Instant> = None;
        while self.hello.is_none() {
            // A program that died keeps the board for a while.
            let taken = Duration::from_micros(self.refused.map_or(0, |refused| u64::from(refused.free_in_us)));
            if begun.elapsed() > GREETING + taken {
                return Err(self.silent(begun.elapsed()));
            }
            if sent.is_none_or(|at| at.elapsed() > REPEAT) {
                self.send(&ToBoard::Hello)?;
                sent = Some(Instant::now());
            }
            self.listen()?;
        }
        Ok(())
    }

    /// The board did not hear this session.
    fn turned_away(&mut self, now: TurnedAway) -> Result<(), RigError> {
        let port = self.port.clone();
        if self.hello.is_some() {
            return Err(match now.holder {
                NOBODY => RigError::Restarted { port },
                holder => RigError::TakenOver { port, holder },
            });
        }
        match self.refused.filter(|first| first.holder == now.holder) {
            // It spoke between two refusals.
            Some(first) if first.holder_frames != now.holder_frames => Err(RigError::Held { port, holder: now.holder }),
            Some(_) => Ok(()),
            None => {
                self.refused = Some(now);
                Ok(())
            }
        }
    }

    /// A board that still drives is stopped first; a fault that only says that the host was away is cleared by its name.
    fn configure(&mut self) -> Result<(), RigError> {
        let begun = Instant::now();
        loop {
            self.id = self.id.wrapping_add(1).max(1);
            self.answer = None;
            self.send(&ToBoard::Configure { id: self.id, config: self.config })?;
            let sent = Instant::now();
            while self.answer.is_none() && sent.elapsed() < 4 * REPEAT {
                self.listen()?;
            }
            match self.answer.map(|ack| ack.verdict) {
                Some(Verdict::Accepted) => break,
                Some(Verdict::BadConfiguration) => {
                    return Err(RigError::Port {
                        port: self.port.clone(),
                        reason: "the board does not accept the configuration; check [rig] against its limits"
                            .to_owned(),
                    });
                }
                Some(Verdict::NotNow) => self.quieten()?,
                _ => {}
            }
            if begun.elapsed() > GREETING {
                return Err(self.silent(begun.elapsed()));
            }
        }
        self.heard.clear();
        // What was answered until now was asked for before this host had the board.
        self.stopped_by = None;
        self.stale_until = self.answer.map(|ack| ack.tick);
        if let Some((fault @ (Fault::HostSilent | Fault::RecorderFailed), _)) = self.next(None)?.fault {
            self.tick(Some(Request::Clear(fault)))?;
        }
        Ok(())
    }

    fn quieten(&mut self) -> Result<(), RigError> {
        self.tick(Some(Request::Stop(StopCategory::One)))?;
        for axis in 0..AXES {
            self.tick(Some(Request::Disable { axis }))?;
        }
        Ok(())
    }

    fn silent(&self, silent: Duration) -> RigError {
        RigError::Silent { port: self.port.clone(), silent_s: silent.as_secs_f64() }
    }

    fn send(&mut self, says: &ToBoard) -> Result<(), RigError> {
        let mut wire = [0_u8; LONGEST_FRAME];
        let frame = self.writer.write(&(*says).from_session(self.session), &mut wire);
        self.last_sent = Instant::now();
        write_with_patience(&mut *self.line, frame)
            .map_err(|e| RigError::Port { port: self.port.clone(), reason: e.to_string() })
    }

    /// Takes what has come; returns after a few milliseconds when nothing has.
    fn listen(&mut self) -> Result<(), RigError> {
        let mut bytes = [0_u8; 4_096];
        self.unheard += self.listened.elapsed().min(ATTENTION);
        self.listened = Instant::now();
        let n = match self.line.read(&mut bytes) {
            Ok(0) => {
                return Err(RigError::Port { port: self.port.clone(), reason: "the port is gone".to_owned() });
            }
            Ok(n) => n,
            Err(e) if matches!(e.kind(), std::io::ErrorKind::TimedOut | std::io::ErrorKind::WouldBlock) => 0,
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => 0,
            Err(e) => return Err(RigError::Port { port: self.port.clone(), reason: e.to_string() }),
        };
        for &byte in &bytes[..n] {
            if let Some(received) = self.reader.feed(byte) {
                // Answers about the time do not say what the carriage does: without telemetry the board is given up.
                // Neither do answers to another host.
                let is_for_us = match received.message {
                    FromBoard::Telemetry(_) => true,
                    FromBoard::Ack(ack) => ack.session == self.session,
                    FromBoard::Hello(hello) => hello.session == self.session,
                    _ => false,
                };
                if is_for_us {
                    self.unheard = Duration::ZERO;
                }
                self.take(received.message)?;
            }
        }
        Ok(())
    }

    fn take(&mut self, message: FromBoard) -> Result<(), RigError> {
        match message {
            // One of another session is the board's own at its start, or an answer to another host.
            FromBoard::Hello(hello) if hello.session == self.session => self.hello = Some(hello),
            // Said late, of a hello before the one that was taken.
            FromBoard::TurnedAway(refused) if refused.session == refused.holder => {}
            FromBoard::TurnedAway(refused) if refused.session == self.session => self.turned_away(refused)?,
            // One that goes on asking is one line in the log.
            FromBoard::TurnedAway(TurnedAway { session, holder, .. })
                if holder == self.session && self.stranger.is_none_or(|(last, _)| last != session) =>
            {
                self.stranger = Some((session, true));
            }
            FromBoard::ForeignHello { version } => {
                return Err(RigError::Version {
                    port: self.port.clone(),
                    board: version.to_string(),
                    ours: VERSION.to_string(),
                });
            }
            FromBoard::Telemetry(telemetry) => {
                let is_stale = |until: u32| telemetry.tick.wrapping_sub(until) as i32 <= 0;
                if !self.stale_until.is_some_and(is_stale) {
                    self.stale_until = None;
                    self.heard.push_back(telemetry);
                }
            }
            FromBoard::Ack(ack) if ack.session == self.session => {
                if ack.id == self.id {
                    self.answer = Some(ack);
                }
                if self.asked.is_some_and(|(id, _, _)| id == ack.id) {
                    self.asked = None;
                    self.refusal = match ack.verdict {
                        Verdict::Refused(refusal) => Some(refusal),
                        Verdict::Accepted => None,
                        _ => Some(Refusal::NotReady),
                    };
                }
            }
            // The board carries out nothing of a session that does not have it, but for a stop.
            FromBoard::Ack(Ack { session, verdict: Verdict::Accepted, .. }) => self.stopped_by = Some(session),
            FromBoard::TimeReply(reply) if reply.session == self.session => {
                let clock = &mut self.clock;
                let board_received_us = clock.board.unwrap(reply.board_received_us);
                let on_board = reply.board_sent_us.wrapping_sub(reply.board_received_us);
                clock.aligner.add(Exchange {
                    host_sent_us: reply.host_sent_us,
                    board_received_us,
                    board_sent_us: board_received_us + u64::from(on_board),
                    host_received_us: clock.host_us(),
                });
            }
            // Faults and phases are in the telemetry as well; health is asked for by nobody here.
            _ => {}
        }
        Ok(())
    }

    /// Waits for the next telemetry frame.
    fn next(&mut self, request: Option<Request>) -> Result<Sample, RigError> {
        if let Some(request) = request {
            self.id = self.id.wrapping_add(1).max(1);
            self.send(&ToBoard::Request { id: self.id, request })?;
            self.asked = Some((self.id, request, Instant::now()));
        }
        loop {
            if let Some(telemetry) = self.heard.pop_front() {
                return Ok(self.sample(&telemetry));
            }
            if let Some((id, request, at)) = self.asked
                && at.elapsed() > REPEAT
            {
                self.send(&ToBoard::Request { id, request })?;
                self.asked = Some((id, request, Instant::now()));
            }
            if self.last_sent.elapsed() > HEARTBEAT {
                self.send(&ToBoard::Heartbeat)?;
            }
            if self.clock.asked.elapsed() > ASK_TIME {
                self.clock.asked = Instant::now();
                self.send(&ToBoard::TimeRequest { host_sent_us: self.clock.host_us() })?;
            }
            self.listen()?;
            // Only now: what came while nobody listened lies in the port.
            if self.heard.is_empty() && self.unheard > SILENCE {
                // It may still hear: nobody watches the carriage any more.
                self.id = self.id.wrapping_add(1).max(1);
                let _ = self.send(&ToBoard::Request { id: self.id, request: Request::Stop(StopCategory::One) });
                return Err(self.silent(self.unheard));
            }
        }
    }

    /// What another host came to, once; of two things at a time the stop.
    fn stranger(&mut self) -> Option<Stranger> {
        if let Some(session) = self.stopped_by.take() {
            return Some(Stranger::Stopped(session));
        }
        let (session, is_new) = self.stranger?;
        self.stranger = Some((session, false));
        is_new.then_some(Stranger::TurnedAway(session))
    }

    fn sample(&mut self, telemetry: &Telemetry) -> Sample {
        let (volts, amperes) =
            self.hello.map_or(([0.0; AXES], [0.0; AXES]), |h| (h.command_v_per_count, h.current_a_per_count));
        let mut axes = [AxisSample::default(); AXES];
        for (i, (sample, t)) in axes.iter_mut().zip(&telemetry.axes).enumerate() {
            let drive = &self.config.axes[i].drive;
            let m_per_count = std::f64::consts::TAU / drive.counts_per_revolution * drive.sprocket_radius_m
                / drive.gear_ratio
                * drive.encoder_sign;
            let origin = &mut self.origins[i];
            let count = match origin.count {
                None => i64::from(t.encoder_count),
                Some(count) => count + i64::from(t.encoder_count.wrapping_sub(origin.last) as i32),
            };
            (origin.count, origin.last) = (Some(count), t.encoder_count);
            let counted_m = count as f64 * m_per_count;
            if !t.is_homed {
                (origin.sum_m, origin.samples) = (0.0, 0);
            } else if t.phase == Phase::Holding && origin.samples < LEARNING {
                origin.sum_m += t.reference_position_m() - counted_m;
                origin.samples += 1;
            }
            let origin_m = if origin.samples > 0 { origin.sum_m / f64::from(origin.samples) } else { 0.0 };
            *sample = AxisSample {
                count,
                position_m: counted_m + origin_m,
                reference_m: t.reference_position_m(),
                reference_m_s: t.reference_velocity_m_s(),
                reference_m_s2: t.reference_acceleration_m_s2(),
                command_v: f64::from(t.command_counts) * volts[i],
                current_a: f64::from(t.current_counts) * amperes[i],
                phase: t.phase,
                is_homed: t.is_homed,
            };
        }
        let stranger = self.stranger();
        let tick = self.ticks.unwrap(telemetry.tick);
        self.clock.latched = Some((tick, self.clock.board.unwrap(telemetry.latched_us)));
        Sample {
            tick,
            axes,
            force_n: None,
            fault: telemetry.fault,
            refusal: self.refusal.take(),
            stranger,
            truth: None,
        }
    }
}

/// A session's number: another one each time, and not nobody's.
fn drawn_session() -> u32 {
    (RandomState::new().hash_one(std::process::id()) as u32).max(NOBODY + 1)
}

impl Rig for SerialRig {
    fn tick(&mut self, request: Option<Request>) -> Result<Sample, RigError> {
        self.next(request)
    }

    fn rate_hz(&self) -> f64 {
        self.hello.map_or(4_000.0, |h| 1e6 / f64::from(h.tick_us) / f64::from(h.telemetry_every.max(1)))
    }

    fn ticks_per_sample(&self) -> u64 {
        self.hello.map_or(1, |h| u64::from(h.telemetry_every.max(1)))
    }

    fn is_real_time(&self) -> bool {
        true
    }

    fn begin_run(&mut self, _: &Load, _: u64) {}

    fn host_clock(&self, tick: u64) -> Option<HostClock> {
        let alignment = self.clock.aligner.alignment()?;
        let (last_tick, last_us) = self.clock.latched?;
        let tick_us = u64::from(self.hello?.tick_us);
        let board_us = last_us.wrapping_sub(last_tick.wrapping_sub(tick).wrapping_mul(tick_us));
        let host_us = alignment.host_us as f64 + alignment.host_after_us(board_us);
        Some(HostClock {
            unix_s: self.clock.opened_unix_s + 1e-6 * host_us,
            drift: 1.0 / (1.0 + alignment.drift) - 1.0,
            standard_uncertainty_s: 1e-6 * alignment.host_after_std_us(board_us),
        })
    }

    fn version(&self) -> String {
        self.hello.map_or_else(|| "board".to_owned(), |h| format!("{:?}, protocol {VERSION}", h.board))
    }
}
