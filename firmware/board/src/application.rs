//! The application: steps the controller at every tick and talks to the host in between.
//!
//! A tick comes before everything else. Between ticks bytes go in and out one at a time, so the next tick never waits for the
//! port longer than it takes to decode a frame.
//!
//! After power-up there is no configuration, no torque and no controller; telemetry runs from the first hello on. The hardware
//! watchdog is fed only after a tick that was stepped, so a main loop that hangs takes the torque away by reset.
//!
//! One host has the board at a time ([`froude_link::session`]). Any valid frame of it counts as a sign of life for the controller's
//! host watchdog. Of any other host a stop is obeyed and nothing else; that it was turned away is said to everybody on the line.

use froude_control::Controller;
use froude_control::config::Config;
use froude_control::request::Request;
use froude_control::status::{Output, Phase, Refusal, Status};
use froude_control::tick::{AXES, AxisInput, Command, Tick};
use froude_link::budget::Decimation;
use froude_link::frame::{FrameReader, FrameWriter};
use froude_link::ring::TelemetryRing;
use froude_link::sequence::{Arrival, Order};
use froude_link::session::{Greeting, Holder, NOBODY};
use froude_link::status::{
    Ack, BoardHello, Event, EventKind, FaultReport, Health, LockStepReply, TimeReply, TurnedAway, Verdict,
};
use froude_link::{FromBoard, HostFrame, Telemetry, ToBoard, VERSION};
use heapless::Deque;

use crate::board::{Board, Latched};

/// Longest frame that the board sends.
const FRAME_BYTES: usize = 160;
/// Ticks between two health reports: a second.
const HEALTH_TICKS: u32 = 4000;
/// Ticks between two words to hosts that are turned away: 10 ms, so that no host can fill the line with them.
const TURNED_AWAY_TICKS: u32 = 40;
/// Nominal tick, µs.
pub const TICK_US: u32 = 250;

/// State of the whole program.
#[derive(Clone)]
pub struct Application {
    controller: Option<Controller>,
    output: Output,
    tick: u32,
    operator: Operator,
    requests: Requests,
    /// The last answer to a host that gives the ticks, one by one.
    lock_step: Option<LockStepReply>,
    link: Link,
    overruns: u32,
    worst_step_us: u32,
}

/// Who may drive.
#[derive(Clone)]
struct Operator {
    holder: Holder,
    /// The controller's limit of its host's silence, µs.
    silence_us: u32,
    /// Turned away and not reported yet.
    stranger: Option<u32>,
    /// Ticks since one was reported.
    untold_ticks: u32,
}

/// A request and who asked for it.
#[derive(Clone, Copy)]
struct Waiting {
    session: u32,
    id: u16,
    request: Request,
}

/// What was asked for and what became of it.
#[derive(Clone)]
struct Requests {
    is_host_heard: bool,
    /// To be carried out, one a tick; a stop goes first.
    waiting: Deque<Waiting, 8>,
    /// The last answer to the host that has the board, for when it did not get it.
    answered: Option<Ack>,
}

/// Both directions of the serial line.
#[derive(Clone)]
struct Link {
    reader: FrameReader<HostFrame>,
    /// Of the frames of the host that has the board.
    order: Order,
    writer: FrameWriter,
    frame: [u8; FRAME_BYTES],
    len: usize,
    sent: usize,
    messages: Deque<FromBoard, 32>,
    messages_lost: u32,
    telemetry: TelemetryRing,
}

impl Default for Application {
    fn default() -> Self {
        Self::new()
    }
}

impl Application {
    /// As after power-up.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            controller: None,
            output: NOTHING,
            tick: 0,
            operator: Operator {
                holder: Holder::nobody(),
                silence_us: Config::PUBLISHED.host_silence_us,
                stranger: None,
                untold_ticks: TURNED_AWAY_TICKS,
            },
            requests: Requests { is_host_heard: false, waiting: Deque::new(), answered: None },
            lock_step: None,
            link: Link {
                reader: FrameReader::new(),
                order: Order::new(),
                writer: FrameWriter::starting_at(0),
                frame: [0; FRAME_BYTES],
                len: 0,
                sent: 0,
                messages: Deque::new(),
                messages_lost: 0,
                telemetry: TelemetryRing::new(),
            },
            overruns: 0,
            worst_step_us: 0,
        }
    }

    /// Says hello unasked, once, so that a host on the line learns of the restart.
    pub fn announce(&mut self, board: &mut impl Board) {
        self.say_hello(board);
    }

    /// One turn of the main loop: a tick if one is due, else a byte each way. Says whether anything was done.
    pub fn turn(&mut self, board: &mut impl Board) -> bool {
        if let Some(latched) = board.take_tick() {
            self.tick(board, &latched);
            return true;
        }
        let received = board.read_byte();
        if let Some(byte) = received {
            self.hear(board, byte);
        }
        let was_sent = self.link.send(board);
        received.is_some() || was_sent
    }

    /// What the controller said last.
    #[must_use]
    pub const fn output(&self) -> &Output {
        &self.output
    }

    /// Ticks that took longer than their period.
    #[must_use]
    pub const fn overruns(&self) -> u32 {
        self.overruns
    }

    /// Longest time from a tick to its command, µs.
    #[must_use]
    pub const fn worst_step_us(&self) -> u32 {
        self.worst_step_us
    }

    fn tick(&mut self, board: &mut impl Board, latched: &Latched) {
        self.tick = self.tick.wrapping_add(latched.ticks);
        self.operator.holder.pass(latched.ticks.saturating_mul(TICK_US));
        self.turn_away(latched.ticks);
        let missed = latched.ticks.saturating_sub(1);
        if missed > 0 {
            self.overruns = self.overruns.wrapping_add(missed);
            let kind = EventKind::Overrun(u16::try_from(missed).unwrap_or(u16::MAX));
            self.link.say(FromBoard::Event(Event { tick: self.tick, latched_us: latched.latched_us, kind }));
        }
        if self.lock_step.is_some() {
            // The host's ticks count, not the timer's; the outputs stay dead.
            board.actuate(&Command::default());
            board.feed_watchdog();
            return;
        }
        let scales = board.scales();
        let input = |k: usize| {
            let axis = latched.axes.get(k).copied().unwrap_or_default();
            AxisInput {
                encoder_count: axis.encoder_count,
                encoder_errors: axis.encoder_errors,
                current_a: f64::from(axis.current_counts) * scales.current_a_per_count.get(k).unwrap_or(&0.0),
                is_low_end: axis.is_low_end,
                is_high_end: axis.is_high_end,
                is_amplifier_ready: axis.is_amplifier_ready,
            }
        };
        let waiting = self.next_request();
        let tick = Tick {
            latched_us: latched.latched_us,
            axes: [input(0), input(1)],
            is_estop_open: latched.is_estop_open,
            is_host_heard: core::mem::take(&mut self.requests.is_host_heard),
            request: waiting.map(|waiting| waiting.request),
        };
        let before = self.output.status;
        self.output = match &mut self.controller {
            Some(controller) => controller.step(&tick),
            None => NOTHING,
        };
        let codes = board.actuate(&self.output.command);
        board.feed_watchdog();
        let took = board.now_us().wrapping_sub(latched.latched_us);
        self.worst_step_us = self.worst_step_us.max(took);

        let currents = latched.axes.map(|axis| axis.current_counts);
        let mut telemetry = Telemetry::of(&tick, &self.output, codes, currents);
        telemetry.tick = self.tick;
        telemetry.is_after_overrun = missed > 0;
        if self.operator.holder.session() != NOBODY {
            self.link.file(telemetry, decimation(board));
        }
        self.report(&before, latched.latched_us);
        if let Some(Waiting { session, id, .. }) = waiting {
            let verdict = match (&self.controller, self.output.status.refusal) {
                (None, _) => Verdict::NotConfigured,
                (_, Some(refusal)) => Verdict::Refused(refusal),
                (_, None) => Verdict::Accepted,
            };
            self.answer(session, id, verdict);
        }
        if self.tick % HEALTH_TICKS < latched.ticks {
            self.report_health(board);
        }
    }

    /// Tells what changed: faults, cleared faults, phases.
    fn report(&mut self, before: &Status, latched_us: u32) {
        let (tick, now) = (self.tick, self.output.status);
        match (before.fault, now.fault) {
            (was, Some((fault, axis))) if was != now.fault => {
                let category = fault.category();
                self.link.say(FromBoard::Fault(FaultReport { tick, latched_us, fault, axis, category }));
            }
            (Some((fault, _)), None) => {
                self.link.say(FromBoard::Event(Event { tick, latched_us, kind: EventKind::Cleared(fault) }));
            }
            _ => {}
        }
        for (axis, (was, is)) in before.axes.iter().zip(&now.axes).enumerate() {
            if was.phase != is.phase {
                let kind = EventKind::Phase { axis: axis as u8, phase: is.phase };
                self.link.say(FromBoard::Event(Event { tick, latched_us, kind }));
            }
        }
    }

    fn report_health(&mut self, board: &impl Board) {
        let (counts, order) = (self.link.reader.counts(), self.link.order.counts());
        self.link.say(FromBoard::Health(Health {
            tick: self.tick,
            telemetry_lost: self.link.telemetry.lost(),
            overruns: self.overruns,
            worst_step_us: self.worst_step_us,
            port_overflows: board.port_overflows().wrapping_add(self.link.messages_lost),
            corrupt: counts.corrupt,
            lost: order.lost,
            late: order.late,
            duplicates: order.duplicates,
        }));
    }

    fn answer(&mut self, session: u32, id: u16, verdict: Verdict) {
        let ack = Ack { session, id, tick: self.tick, verdict };
        if session == self.operator.holder.session() {
            self.requests.answered = Some(ack);
        }
        self.link.say(FromBoard::Ack(ack));
    }

    /// A byte came from a host.
    fn hear(&mut self, board: &mut impl Board, byte: u8) {
        let Some(received) = self.link.reader.feed(byte) else { return };
        let HostFrame { session, says } = received.message;
        match says {
            ToBoard::Hello => return self.greet(board, session, received.sequence),
            // It hears the version and nothing else, and takes nothing from the host that has the board.
            ToBoard::ForeignHello { version } => {
                self.link.say(FromBoard::ForeignHello { version: VERSION });
                let kind = EventKind::VersionMismatch(version);
                let latched_us = board.now_us();
                return self.link.say(FromBoard::Event(Event { tick: self.tick, latched_us, kind }));
            }
            _ => {}
        }
        if !self.operator.holder.hear(session) {
            return self.hear_stranger(session, &says);
        }
        let arrival = self.link.order.note(received.sequence);
        self.requests.is_host_heard = true;
        match says {
            ToBoard::Hello | ToBoard::ForeignHello { .. } | ToBoard::Heartbeat => {}
            ToBoard::TimeRequest { host_sent_us } => {
                let board_received_us = board.now_us();
                // The answer is stamped when it is written; it waits behind what is already in the queue.
                let reply = TimeReply { session, host_sent_us, board_received_us, board_sent_us: board_received_us };
                self.link.say(FromBoard::TimeReply(reply));
            }
            ToBoard::Request { id, request } => {
                self.request(Waiting { session, id, request }, matches!(arrival, Arrival::Late | Arrival::Duplicate));
            }
            ToBoard::Configure { id, config } => {
                if let Some(ack) = self.requests.answered.filter(|ack| ack.id == id) {
                    return self.link.say(FromBoard::Ack(ack));
                }
                let verdict = self.configure(&config);
                self.answer(session, id, verdict);
            }
            ToBoard::LockStep { number, tick } => self.lock_step(session, number, &tick),
        }
    }

    /// A stop is obeyed from everybody, as often as it is asked for; nothing else is, from a host that does not have the board.
    fn hear_stranger(&mut self, session: u32, says: &ToBoard) {
        match *says {
            ToBoard::Request { id, request: request @ Request::Stop(_) } => {
                self.put(Waiting { session, id, request });
            }
            _ => self.operator.stranger = Some(session),
        }
    }

    /// Says that somebody was turned away, not too often.
    fn turn_away(&mut self, ticks: u32) {
        let Operator { holder, silence_us, stranger, untold_ticks } = &mut self.operator;
        *untold_ticks = untold_ticks.saturating_add(ticks);
        if *untold_ticks < TURNED_AWAY_TICKS {
            return;
        }
        if let Some(session) = stranger.take() {
            *untold_ticks = 0;
            self.link.say(FromBoard::TurnedAway(TurnedAway {
                session,
                holder: holder.session(),
                holder_frames: holder.frames(),
                free_in_us: holder.free_in_us(*silence_us),
            }));
        }
    }

    fn greet(&mut self, board: &mut impl Board, session: u32, sequence: u16) {
        match self.operator.holder.greet(session, self.operator.silence_us) {
            Greeting::Refused => {
                self.operator.stranger = Some(session);
                return;
            }
            Greeting::Taken => {
                // A controller that drove what was simulated knows nothing of where the carriage is.
                if self.lock_step.take().is_some() {
                    self.controller = None;
                    self.output = NOTHING;
                }
                self.requests.answered = None;
                self.link.order.restart();
            }
            // A repeated hello changes nothing: it must not make a repeated request a new one.
            Greeting::Again => {}
        }
        self.link.order.note(sequence);
        self.requests.is_host_heard = true;
        self.say_hello(board);
        self.report_health(board);
    }

    fn say_hello(&mut self, board: &impl Board) {
        let scales = board.scales();
        self.link.say(FromBoard::Hello(BoardHello {
            board: board_id(board),
            boot: board.boot_number(),
            baud: baud(board),
            telemetry_every: decimation(board).every,
            tick_us: TICK_US,
            command_v_per_count: scales.command_v_per_count,
            current_a_per_count: scales.current_a_per_count,
            is_configured: self.controller.is_some(),
            was_watchdog_reset: board.was_watchdog_reset(),
            session: self.operator.holder.session(),
        }));
    }

    /// A request is carried out once, whatever the line does: its number is remembered until the next one.
    fn request(&mut self, waiting: Waiting, is_stale: bool) {
        if let Some(ack) = self.requests.answered.filter(|ack| ack.id == waiting.id) {
            return self.link.say(FromBoard::Ack(ack));
        }
        // A late or repeated frame is older than one that was carried out: its sender has moved on, except for a stop.
        if !is_stale || waiting.is_stop() {
            self.put(waiting);
        }
    }

    /// Keeps a request until its tick. What was asked for before a stop and not begun is not begun after it: it is refused.
    fn put(&mut self, new: Waiting) {
        if new.is_stop() {
            for _ in 0..self.requests.waiting.len() {
                let Some(older) = self.requests.waiting.pop_front() else { break };
                if older.is_stop() {
                    let _ = self.requests.waiting.push_back(older);
                } else {
                    self.answer(older.session, older.id, Verdict::Refused(Refusal::Busy));
                }
            }
        }
        self.requests.put(new);
    }

    /// The next request; what a host asked for before it lost the board is dropped, but for a stop.
    fn next_request(&mut self) -> Option<Waiting> {
        let holder = self.operator.holder.session();
        while let Some(waiting) = self.requests.waiting.pop_front() {
            if waiting.session == holder || waiting.is_stop() {
                return Some(waiting);
            }
        }
        None
    }

    fn configure(&mut self, config: &Config) -> Verdict {
        let is_at_rest = self.output.status.axes.iter().all(|axis| axis.phase == Phase::Disabled);
        if !is_at_rest {
            return Verdict::NotNow;
        }
        match Controller::new(*config) {
            Ok(controller) => {
                self.controller = Some(controller);
                self.operator.silence_us = config.host_silence_us;
                self.output = NOTHING;
                self.lock_step = None;
                Verdict::Accepted
            }
            Err(_) => Verdict::BadConfiguration,
        }
    }

    /// Steps with the host's inputs. The same number again gets the same answer; any other but the next one gets none.
    fn lock_step(&mut self, session: u32, number: u32, tick: &Tick) {
        let Some(controller) = &mut self.controller else { return };
        let next = self.lock_step.as_ref().map_or(0, |last| last.number.wrapping_add(1));
        if number == next {
            let Output { command, status } = controller.step(tick);
            self.lock_step = Some(LockStepReply {
                session,
                number,
                command,
                reference_m: status.axes.map(|axis| axis.reference_m),
                position_m: status.axes.map(|axis| axis.position_m),
                phases: status.axes.map(|axis| axis.phase),
                fault: status.fault.map(|(fault, _)| fault),
                refusal: status.refusal,
            });
        }
        if let Some(reply) = self.lock_step.filter(|last| last.number == number) {
            self.link.say(FromBoard::LockStep(reply));
        }
    }
}

impl Waiting {
    const fn is_stop(&self) -> bool {
        matches!(self.request, Request::Stop(_))
    }
}

impl Requests {
    /// Keeps a request until its tick, once. There is always room for a stop; what else does not fit is not answered, and its host
    /// asks again.
    fn put(&mut self, new: Waiting) {
        if self.waiting.iter().any(|other| (other.session, other.id) == (new.session, new.id)) {
            return;
        }
        if !new.is_stop() {
            let _ = self.waiting.push_back(new);
            return;
        }
        if self.waiting.is_full() {
            self.waiting.pop_back();
        }
        let _ = self.waiting.push_front(new);
    }
}

const NOTHING: Output = Output {
    command: Command { axes: [froude_control::tick::AxisCommand { volts: 0.0, is_enabled: false }; AXES] },
    status: Status {
        tick: 0,
        axes: [froude_control::status::AxisStatus {
            phase: Phase::Disabled,
            is_homed: false,
            count: 0,
            position_m: 0.0,
            reference_m: 0.0,
            reference_m_s: 0.0,
            reference_m_s2: 0.0,
            is_saturated: false,
        }; AXES],
        fault: None,
        refusal: None,
    },
};

fn board_id<B: Board>(_: &B) -> froude_link::status::BoardId {
    B::ID
}

fn baud<B: Board>(_: &B) -> u32 {
    B::BAUD
}

fn decimation<B: Board>(_: &B) -> Decimation {
    const { Decimation::of(B::BAUD) }
}

impl Link {
    /// Queues a message; it goes before telemetry.
    fn say(&mut self, message: FromBoard) {
        if self.messages.push_back(message).is_err() {
            self.messages_lost = self.messages_lost.wrapping_add(1);
        }
    }

    /// Files telemetry of a tick that is sent.
    fn file(&mut self, telemetry: Telemetry, decimation: Decimation) {
        if decimation.takes(telemetry.tick) {
            self.telemetry.put(telemetry);
        }
    }

    /// Moves a byte towards the host, if there is one and the port has room.
    fn send(&mut self, board: &mut impl Board) -> bool {
        if self.sent == self.len && !self.next_frame(board) {
            return false;
        }
        let Some(&byte) = self.frame.get(self.sent) else { return false };
        let was_sent = board.write_byte(byte);
        self.sent += usize::from(was_sent);
        was_sent
    }

    fn next_frame(&mut self, board: &mut impl Board) -> bool {
        let message = self.messages.pop_front().or_else(|| self.telemetry.take().map(FromBoard::Telemetry));
        let Some(mut message) = message else { return false };
        if let FromBoard::TimeReply(reply) = &mut message {
            reply.board_sent_us = board.now_us();
        }
        self.len = self.writer.write(&message, &mut self.frame).len();
        self.sent = 0;
        self.len > 0
    }
}
