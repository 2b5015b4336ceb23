//! The fault catalogue with the board in between: two hosts on one line, one of them with a late operator.
//!
//! **Setting.** The firmware's application steps the controller on the twin; hosts speak to it in frames. The first host has the board,
//! says every 20 ms that it is there and asks for the moves of the catalogue's scene; its operator is late, and it goes on giving signs
//! of life meanwhile or does not. The second host says whatever it can, at random: hello, heartbeats, requests, configurations,
//! lock step, stops, other versions. Something breaks on a moving axis, as in [`crate::faults`]. In the end both fall silent.
//!
//! **What must hold**, in every run:
//!
//! - Every command, phase and fault is, bit for bit, that of a bare controller that hears what [`Spec`] lets through: the requests of
//!   the session that has the board, and stops.
//! - No load touches a hard stop, no command is not finite, and after the silence both axes come to rest without torque.
//! - As long as nobody stops the carriage and the first host lives, what breaks is named in time, as without a second host. Otherwise
//!   the first fault is one that the catalogue accepts, or the host's own silence, or none. Where the second host had got the board
//!   before, it drives as wildly as it talks (open-loop jogs, moves on a broken axis), and what it trips is its own. Where it also clears
//!   the fault of a dead encoder and drives again, no controller knows where the load is: the hard stops are then its own too.
//! - The second host gets the board only when the controller had stopped for the silence of the first, or no axis had torque.
//!
//! A current that is not a number cannot come out of a converter; where the catalogue draws one the amplifier fails instead.

use crate::faults::{Faults, MOUNTINGS, Scene};
use std::collections::{BTreeMap, VecDeque};

use froude_board::application::Application;
use froude_board::board::{AxisLatched, Board, Latched, Scales};
use froude_control::Controller;
use froude_control::config::Config;
use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::{Output, Phase};
use froude_control::tick::{AXES, AxisInput, Command, Tick};
use froude_link::frame::{FrameWriter, MAX_WIRE};
use froude_link::session::{AFTER_SILENCE_US, NOBODY};
use froude_link::status::BoardId;
use froude_link::{HostFrame, ToBoard};
use froude_rig::amplifier::AmplifierFault;
use froude_rig::defaults::control_config;
use froude_rig::encoder::EncoderFault;
use froude_rig::injection::{Injection, Scheduled};
use froude_rig::load::Load;
use froude_rig::twin::{TICK_S, Twin, TwinConfig};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const COMMAND_V: f64 = 10.0 / 32_768.0;
const CURRENT_A: f64 = 10.0 / 32_768.0;
const FIRST: u32 = 0xa;
const SECOND: u32 = 0xb;
/// Ticks between two signs of life.
const HEARTBEAT: u64 = 80;

/// The twin behind the board's drivers; what the board says goes nowhere.
#[derive(Clone)]
struct TwinBoard {
    twin: Twin,
    command: Command,
    latched: Option<Latched>,
    now_us: u32,
    bytes: VecDeque<u8>,
}

impl Board for TwinBoard {
    const ID: BoardId = BoardId::Twin;
    const BAUD: u32 = 115_200;

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
        self.latched.take()
    }
    fn actuate(&mut self, command: &Command) -> [i16; AXES] {
        self.command = *command;
        command.axes.map(|a| (a.volts / COMMAND_V) as i16)
    }
    fn read_byte(&mut self) -> Option<u8> {
        self.bytes.pop_front()
    }
    fn write_byte(&mut self, _: u8) -> bool {
        true
    }
    fn port_overflows(&self) -> u32 {
        0
    }
    fn feed_watchdog(&mut self) {}
}

/// What the board may do, said once more and shortly: a bare controller, and who may ask it for what.
#[derive(Clone)]
struct Spec {
    controller: Option<Controller>,
    output: Output,
    silence_us: u32,
    holder: u32,
    silent_us: u64,
    is_heard: bool,
    /// Session, number, request; stops first.
    waiting: VecDeque<(u32, u16, Request)>,
    answered: Option<u16>,
    /// The board changed hands although an axis had torque and no fault had stopped it.
    has_slipped: bool,
}

impl Spec {
    fn tick(&mut self, latched: &Latched) {
        self.silent_us += 250;
        let holder = self.holder;
        let is_allowed = |session: u32, request: &Request| session == holder || matches!(request, Request::Stop(_));
        self.waiting.retain(|(session, _, request)| is_allowed(*session, request));
        let next = self.waiting.pop_front();
        let axes = latched.axes.map(|a| AxisInput {
            encoder_count: a.encoder_count,
            encoder_errors: a.encoder_errors,
            current_a: f64::from(a.current_counts) * CURRENT_A,
            is_low_end: a.is_low_end,
            is_high_end: a.is_high_end,
            is_amplifier_ready: a.is_amplifier_ready,
        });
        let (latched_us, is_estop_open) = (latched.latched_us, latched.is_estop_open);
        let is_host_heard = std::mem::take(&mut self.is_heard);
        let tick =
            Tick { latched_us, axes, is_estop_open, is_host_heard, request: next.map(|(_, _, request)| request) };
        if let Some(controller) = &mut self.controller {
            self.output = controller.step(&tick);
        }
        if let Some((session, id, _)) = next.filter(|(session, ..)| *session == holder) {
            debug_assert_eq!(session, holder);
            self.answered = Some(id);
        }
    }

    /// What was asked for before a stop and not begun is not begun after it.
    fn refuse_what_waits(&mut self) {
        let is_stop = |waiting: &(u32, u16, Request)| matches!(waiting.2, Request::Stop(_));
        let refused = self.waiting.iter().rfind(|w| !is_stop(w) && w.0 == self.holder);
        self.answered = refused.map(|w| w.1).or(self.answered);
        self.waiting.retain(is_stop);
    }

    fn hear(&mut self, &HostFrame { session, says }: &HostFrame) {
        if let ToBoard::Request { id, request: request @ Request::Stop(_) } = says {
            let is_repeated = session == self.holder && self.answered == Some(id);
            if !is_repeated {
                self.refuse_what_waits();
            }
            if !is_repeated && !self.waiting.iter().any(|w| (w.0, w.1) == (session, id)) {
                self.waiting.truncate(7);
                self.waiting.push_front((session, id, request));
            }
        }
        if says == ToBoard::Hello
            && session != self.holder
            && (self.holder == NOBODY || self.silent_us >= u64::from(self.silence_us + AFTER_SILENCE_US))
        {
            let has_torque =
                self.output.status.axes.iter().any(|a| !matches!(a.phase, Phase::Disabled | Phase::Coasting));
            self.has_slipped |= has_torque && self.output.status.fault.is_none();
            (self.holder, self.answered) = (session, None);
        }
        if session != self.holder || matches!(says, ToBoard::ForeignHello { .. }) {
            return;
        }
        (self.is_heard, self.silent_us) = (true, 0);
        match says {
            ToBoard::Request { id, request } if !matches!(request, Request::Stop(_)) => {
                let is_known = self.answered == Some(id) || self.waiting.iter().any(|w| (w.0, w.1) == (session, id));
                if !is_known && self.waiting.len() < 8 {
                    self.waiting.push_back((session, id, request));
                }
            }
            ToBoard::Configure { id, config } if self.answered != Some(id) => {
                self.answered = Some(id);
                let is_off = self.output.status.axes.iter().all(|a| a.phase == Phase::Disabled);
                if let (true, Ok(controller)) = (is_off, Controller::new(config)) {
                    (self.controller, self.output) = (Some(controller), Output::default());
                    self.silence_us = config.host_silence_us;
                }
            }
            _ => {}
        }
    }
}

/// Board, twin and line, and what should come of it.
#[derive(Clone)]
struct Bench {
    application: Application,
    board: TwinBoard,
    writers: BTreeMap<u32, FrameWriter>,
    said: Vec<HostFrame>,
    spec: Spec,
    is_first_mute: bool,
    /// A tick at which board and specification were not equal.
    unequal: Option<u64>,
    has_bad_command: bool,
    has_left_travel: bool,
    ticks: u64,
}

impl Bench {
    fn new(load: Load) -> Self {
        let mut config = TwinConfig::loaded(load);
        for axis in &mut config.axes {
            axis.start_m = 0.02;
        }
        Self {
            application: Application::new(),
            board: TwinBoard {
                twin: Twin::new(&config, 0),
                command: Command::default(),
                latched: None,
                now_us: 0,
                bytes: VecDeque::new(),
            },
            writers: BTreeMap::new(),
            said: vec![],
            spec: Spec {
                controller: None,
                output: Output::default(),
                silence_us: Config::PUBLISHED.host_silence_us,
                holder: NOBODY,
                silent_us: 0,
                is_heard: false,
                waiting: VecDeque::new(),
                answered: None,
                has_slipped: false,
            },
            is_first_mute: false,
            unequal: None,
            has_bad_command: false,
            has_left_travel: false,
            ticks: 0,
        }
    }

    fn send(&mut self, session: u32, says: &ToBoard) {
        if session == FIRST && self.is_first_mute {
            return;
        }
        let frame = (*says).from_session(session);
        let mut wire = [0; MAX_WIRE];
        self.board.bytes.extend(self.writers.entry(session).or_default().write(&frame, &mut wire));
        // What comes of another version is its version.
        self.said.push(frame);
    }

    fn output(&self) -> Output {
        *self.application.output()
    }

    fn fault(&self) -> Option<Fault> {
        self.application.output().status.fault.map(|(fault, _)| fault)
    }

    /// One tick: the rig moves on, the board answers, then hears what was sent.
    fn step(&mut self) {
        let tick = self.board.twin.tick(self.board.command);
        self.is_first_mute |= !tick.is_host_heard;
        let axes = tick.axes.map(|a| AxisLatched {
            encoder_count: a.encoder_count,
            encoder_errors: a.encoder_errors,
            current_counts: (a.current_a / CURRENT_A) as i16,
            is_low_end: a.is_low_end,
            is_high_end: a.is_high_end,
            is_amplifier_ready: a.is_amplifier_ready,
        });
        let latched = Latched { latched_us: tick.latched_us, ticks: 1, axes, is_estop_open: tick.is_estop_open };
        self.board.now_us = tick.latched_us;
        self.board.latched = Some(latched);
        self.spec.tick(&latched);
        let (got, want) = {
            self.application.turn(&mut self.board);
            (self.application.output(), &self.spec.output)
        };
        let bits = |o: &Output| o.command.axes.map(|a| (a.volts.to_bits(), a.is_enabled));
        let states = |o: &Output| (o.status.fault, o.status.axes.map(|a| (a.phase, a.reference_m.to_bits())));
        if self.unequal.is_none() && (bits(got) != bits(want) || states(got) != states(want)) {
            self.unequal = Some(self.ticks);
        }
        self.has_bad_command |= got.command.axes.iter().any(|c| !c.volts.is_finite());
        self.has_left_travel |= !self.board.twin.is_inside_travel();
        while self.application.turn(&mut self.board) {}
        for frame in std::mem::take(&mut self.said) {
            self.spec.hear(&frame);
        }
        self.ticks += 1;
    }

    /// So many ticks with the first host's signs of life.
    fn pass(&mut self, ticks: u64) {
        for _ in 0..ticks {
            if self.ticks.is_multiple_of(HEARTBEAT) {
                self.send(FIRST, &ToBoard::Heartbeat);
            }
            self.step();
        }
    }

    fn is_holding(&self, axis: usize) -> bool {
        self.application.output().status.axes[axis].phase == Phase::Holding
    }

    /// Greets, configures, homes, and goes to where scenes begin.
    fn homed(mut self, config: &Config) -> Self {
        self.send(FIRST, &ToBoard::Hello);
        self.send(FIRST, &ToBoard::Configure { id: 1, config: *config });
        let mut id = 1;
        for axis in 0..AXES {
            let profile = Move {
                target_m: [0.5, 0.3][axis],
                speed_m_s: 0.1,
                acceleration_m_s2: 0.3,
                jerk_m_s3: 3.0,
                is_shaped: true,
            };
            for request in [Request::Enable { axis }, Request::Home { axis }, Request::Move { axis, profile }] {
                id += 1;
                self.pass(4);
                self.send(FIRST, &ToBoard::Request { id, request });
                self.pass(4);
                let mut left = 4_000_000;
                while !self.is_holding(axis) && left > 0 {
                    self.pass(1);
                    left -= 1;
                }
            }
        }
        assert!(self.fault().is_none() && self.output().status.axes.iter().all(|a| a.is_homed), "{:?}", self.output());
        assert_eq!(self.unequal, None);
        self
    }
}

/// When the first host's operator is late, and what its program does meanwhile.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Late {
    Never,
    /// From this tick for so many; the program goes on giving signs of life.
    Living(u64, u64),
    /// The program stands still with its operator.
    Dead(u64, u64),
}

/// What came of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Ending {
    /// Moves and injection.
    pub scene: Scene,
    late: Late,
    /// Frames of the second host.
    pub frames: u32,
    /// Stops that anybody asked for.
    pub stops: u32,
    /// The second host got the board, after how many ticks.
    pub taken_over: Option<u64>,
    /// The first fault after something broke, and how long after, s.
    pub detected: Option<(Fault, f64)>,
    /// The second host had the board when the fault was latched.
    pub is_its_own: bool,
    /// The second host cleared a fault that something broken had brought about.
    pub was_cleared: bool,
    /// A fault was there before anything broke.
    pub was_faulted: bool,
    /// Until something was detected, or until it had to be: nobody stopped, and the first host was not silent.
    pub is_undisturbed: bool,
    unequal: Option<u64>,
    has_slipped: bool,
    has_left_travel: bool,
    has_bad_command: bool,
    is_at_rest: bool,
    has_arrived: bool,
}

impl Ending {
    /// Whether everything held that must.
    pub fn is_allowed(&self) -> bool {
        let injection = &self.scene.injection;
        let is_chain = matches!(injection, Injection::ChainBreak);
        let accepted = injection.accepted();
        let is_named = if self.was_faulted {
            true
        } else if self.is_undisturbed {
            match self.detected {
                Some((fault, after_s)) => accepted.contains(&fault) && after_s <= injection.latest_s() + 0.5 * TICK_S,
                None => accepted.is_empty() || (self.has_arrived && injection.is_unseen_at_rest()),
            }
        } else {
            let own = [Fault::HostSilent, Fault::RecorderFailed];
            self.is_its_own || self.detected.is_none_or(|(fault, _)| accepted.contains(&fault) || own.contains(&fault))
        };
        let is_blind =
            self.was_cleared && matches!(injection, Injection::Encoder(EncoderFault::Silent | EncoderFault::Stuck));
        self.unequal.is_none()
            && !self.has_slipped
            && !self.has_bad_command
            && (is_chain || (is_named && (is_blind || !self.has_left_travel) && self.is_at_rest))
    }
}

/// Longest wait for something to happen after it broke, ticks; as long again after the second host's last word.
const WATCHED: u64 = 6_000;
/// Longest way to rest after everybody fell silent, ticks.
const REST: u64 = 60_000;
const ARRIVED_M: f64 = 1e-4;

/// Homed boards, one for each mounting.
#[derive(Clone)]
pub struct Hosts {
    homed: Vec<Bench>,
}

impl Hosts {
    /// Homes them.
    pub fn new() -> Self {
        let homed = MOUNTINGS.map(|mounting| {
            let load = Load::mounted(mounting);
            Bench::new(load).homed(&control_config(&[load; 2]))
        });
        Self { homed: homed.into() }
    }

    /// One run; everything from the seed.
    pub fn run(&self, seed: u64) -> Ending {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut scene = Scene::drawn(&mut rng);
        if scene.injection == Injection::NotFiniteCurrent {
            scene.injection = Injection::Amplifier(AmplifierFault::Off);
        }
        let mut bench = self.homed[scene.mounting].clone();
        bench.board.twin.begin_run([Load::mounted(MOUNTINGS[scene.mounting]); 2], scene.load_seed);
        let begun = bench.ticks;
        let mut first = First::drawn(&mut rng, &scene);
        let mut second = Second::drawn(&mut rng);
        let mut ending = Ending {
            scene,
            late: first.late,
            frames: 0,
            stops: 0,
            taken_over: None,
            detected: None,
            is_its_own: false,
            was_cleared: false,
            was_faulted: false,
            is_undisturbed: true,
            unequal: None,
            has_slipped: false,
            has_left_travel: false,
            has_bad_command: false,
            is_at_rest: false,
            has_arrived: false,
        };
        let mut broken_at = None;
        let mut end = 40_000;
        for tick in 0.. {
            if tick >= end {
                break;
            }
            first.speak(tick, &mut bench, &mut ending);
            second.speak(tick, &mut bench, &mut ending);
            let moving = bench.output().status.axes[scene.axis].reference_m_s.abs() >= 0.02;
            let is_time = tick >= scene.after_ticks as u64 && (moving || tick > 14_000);
            if broken_at.is_none() && is_time {
                broken_at = Some(tick);
                end = tick + WATCHED;
                ending.was_faulted = bench.fault().is_some();
                ending.is_undisturbed &= ending.stops == 0 && !first.was_silent(tick);
                bench.board.twin.inject(Scheduled { tick: 0, axis: scene.axis, injection: scene.injection });
            }
            bench.step();
            if ending.taken_over.is_none() && bench.spec.holder == SECOND {
                ending.taken_over = Some(tick);
            }
            if let (Some(at), None) = (broken_at, ending.detected) {
                let after_s = (tick + 1 - at) as f64 * TICK_S;
                ending.detected = bench.fault().map(|fault| (fault, after_s));
                ending.is_its_own = ending.detected.is_some() && bench.spec.holder == SECOND;
                if ending.detected.is_none() && after_s <= scene.injection.latest_s() {
                    ending.is_undisturbed &= ending.stops == 0 && !first.was_silent(tick);
                }
            }
            ending.was_cleared |= ending.is_its_own && bench.fault().is_none();
        }
        let ended = bench.output().status.axes[scene.axis];
        ending.has_arrived = ended.phase == Phase::Holding && (ended.reference_m - ended.position_m).abs() < ARRIVED_M;
        for _ in 0..REST {
            bench.step();
            let is_off =
                bench.output().status.axes.iter().all(|a| matches!(a.phase, Phase::Disabled | Phase::Coasting));
            ending.is_at_rest = is_off && (0..AXES).all(|i| bench.board.twin.truth(i).load_speed_m_s == 0.0);
            if ending.is_at_rest {
                break;
            }
        }
        ending.unequal = bench.unequal.map(|at| at - begun);
        ending.has_slipped = bench.spec.has_slipped;
        ending.has_left_travel = bench.has_left_travel;
        ending.has_bad_command = bench.has_bad_command || bench.board.twin.refused_inputs() > 0;
        ending
    }

    /// Runs these seeds; the sum does not depend on how they are divided among threads.
    pub fn sweep(&self, seeds: impl IntoIterator<Item = u64>) -> Sweep {
        let mut sweep = Sweep::default();
        for seed in seeds {
            let ending = self.run(seed);
            sweep.runs += 1;
            sweep.frames += u64::from(ending.frames);
            sweep.stopped += u64::from(ending.stops > 0);
            sweep.taken_over += u64::from(ending.taken_over.is_some());
            sweep.late += u64::from(ending.late != Late::Never);
            sweep.undisturbed += u64::from(ending.is_undisturbed && !ending.was_faulted);
            let called = ending.detected.map_or_else(|| "nothing".to_owned(), |(fault, _)| format!("{fault:?}"));
            *sweep.called.entry((ending.scene.injection.name(), called)).or_default() += 1;
            if !ending.is_allowed() {
                sweep.refused.push((seed, ending));
            }
        }
        sweep
    }
}

/// What a series of runs gave.
#[derive(Debug, Clone, Default)]
pub struct Sweep {
    /// Runs.
    pub runs: u64,
    /// Frames of the second host.
    pub frames: u64,
    /// Runs that somebody stopped.
    pub stopped: u64,
    /// Runs in which the second host got the board.
    pub taken_over: u64,
    /// Runs with a late operator.
    pub late: u64,
    /// Runs whose fault had to be named in time as without a second host.
    pub undisturbed: u64,
    /// For each injection, what it was called and how often.
    pub called: BTreeMap<(&'static str, String), u64>,
    /// Runs that are not allowed, by seed.
    pub refused: Vec<(u64, Ending)>,
}

impl Sweep {
    /// Both.
    pub fn joined(mut self, other: Self) -> Self {
        self.runs += other.runs;
        self.frames += other.frames;
        self.stopped += other.stopped;
        self.taken_over += other.taken_over;
        self.late += other.late;
        self.undisturbed += other.undisturbed;
        for (what, n) in other.called {
            *self.called.entry(what).or_default() += n;
        }
        self.refused.extend(other.refused);
        self
    }

    /// The seeds below `runs`, on all processors.
    pub fn of(hosts: &Hosts, runs: u64) -> Self {
        let workers = std::thread::available_parallelism().map_or(1, usize::from);
        std::thread::scope(|scope| {
            let parts: Vec<_> = (0..workers)
                .map(|first| scope.spawn(move || hosts.sweep((first as u64..runs).step_by(workers))))
                .collect();
            parts.into_iter().filter_map(|part| part.join().ok()).fold(Self::default(), Self::joined)
        })
    }
}

impl std::fmt::Display for Sweep {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for ((injection, called), n) in &self.called {
            writeln!(f, "{n:6}  {injection}: {called}")?;
        }
        let Self { runs, frames, stopped, taken_over, late, undisturbed, refused, .. } = self;
        write!(
            f,
            "{runs} runs with two hosts: {frames} frames of the second, {stopped} stopped by somebody, {taken_over} taken over, {late} with a \
             late operator, {undisturbed} to be named in time; {} not allowed",
            refused.len()
        )
    }
}

/// The host that has the board.
struct First {
    scene: Scene,
    late: Late,
    /// What its operator asks for in the end.
    answer: Request,
    id: u16,
}

impl First {
    fn drawn(rng: &mut impl Rng, scene: &Scene) -> Self {
        let (from, long) = (rng.random_range(0..12_000), rng.random_range(200..6_000));
        let late = match rng.random_range(0..10) {
            0..4 => Late::Never,
            4..7 => Late::Living(from, long),
            _ => Late::Dead(from, long),
        };
        let back = Move { target_m: 0.4, speed_m_s: 0.1, acceleration_m_s2: 0.5, jerk_m_s3: 0.0, is_shaped: false };
        let answer = match rng.random_range(0..6) {
            0 => Request::Stop(any_category(rng)),
            1 => Request::Clear(Fault::HostSilent),
            2 => Request::Enable { axis: scene.axis },
            3 => Request::RecorderFailed,
            _ => Request::Move { axis: scene.axis, profile: back },
        };
        Self { scene: *scene, late, answer, id: 100 }
    }

    /// It has been silent: what comes of the run from here is also its doing.
    fn was_silent(&self, tick: u64) -> bool {
        matches!(self.late, Late::Dead(from, _) if tick >= from)
    }

    fn speak(&mut self, tick: u64, bench: &mut Bench, ending: &mut Ending) {
        if matches!(self.late, Late::Dead(from, long) if (from..from + long).contains(&tick)) {
            return;
        }
        if tick < 2 {
            let (axis, id) = (tick as usize, 50 + tick as u16);
            bench.send(
                FIRST,
                &ToBoard::Request { id, request: Request::Move { axis, profile: self.scene.moves[axis] } },
            );
        }
        if tick.is_multiple_of(HEARTBEAT) {
            bench.send(FIRST, &ToBoard::Heartbeat);
        }
        if let Late::Living(from, long) | Late::Dead(from, long) = self.late
            && tick == from + long
        {
            ending.stops += u32::from(matches!(self.answer, Request::Stop(_) | Request::RecorderFailed));
            bench.send(FIRST, &ToBoard::Request { id: self.id, request: self.answer });
        }
    }
}

fn any_category(rng: &mut impl Rng) -> StopCategory {
    [StopCategory::Zero, StopCategory::One, StopCategory::Two][rng.random_range(0..3)]
}

/// The host that should not be there.
struct Second {
    rng: Pcg64Mcg,
    /// Ticks between two of its frames, on average.
    every: f64,
    /// Whether it also stops.
    stops: bool,
    /// Requests as many as the board's last ones have numbers.
    id: u16,
}

impl Second {
    fn drawn(rng: &mut impl Rng) -> Self {
        let every = [f64::INFINITY, 3.0, 40.0, 300.0, 2_000.0][rng.random_range(0..5_usize)];
        Self {
            rng: Pcg64Mcg::seed_from_u64(rng.random()),
            every,
            stops: rng.random_bool(0.3),
            id: rng.random_range(45..55),
        }
    }

    fn speak(&mut self, _: u64, bench: &mut Bench, ending: &mut Ending) {
        if !self.rng.random_bool(1.0 / self.every) {
            return;
        }
        let rng = &mut self.rng;
        let axis = rng.random_range(0..2_usize);
        // Numbers near those of the first host, so that one is taken for the other if it can be.
        let id = if rng.random() { rng.random_range(45..55) } else { self.id };
        let mut session = SECOND;
        let says = match rng.random_range(0..20) {
            0..5 => ToBoard::Hello,
            5..9 => ToBoard::Heartbeat,
            9 => ToBoard::TimeRequest { host_sent_us: rng.random() },
            10 => ToBoard::LockStep { number: rng.random_range(0..3), tick: Tick::default() },
            11 => {
                let load = Load::mounted(MOUNTINGS[rng.random_range(0..3_usize)]);
                ToBoard::Configure { id, config: Config { host_silence_us: 1_000_000, ..control_config(&[load; 2]) } }
            }
            12 => ToBoard::ForeignHello { version: [1, 3, u16::MAX][rng.random_range(0..3_usize)] },
            13 if self.stops => {
                session = [SECOND, NOBODY, FIRST + 7][rng.random_range(0..3_usize)];
                ending.stops += 1;
                ToBoard::Request { id, request: Request::Stop(any_category(rng)) }
            }
            _ => ToBoard::Request { id, request: any_request(rng, axis) },
        };
        // Lock step is a test of the board and takes its outputs away; as the holder this host does not ask for it.
        if matches!(says, ToBoard::LockStep { .. }) && bench.spec.holder == SECOND {
            return;
        }
        if bench.spec.holder == SECOND && matches!(says, ToBoard::Request { .. }) {
            self.id = self.id.wrapping_add(1);
        }
        ending.frames += 1;
        bench.send(session, &says);
    }
}

fn any_request(rng: &mut impl Rng, axis: usize) -> Request {
    match rng.random_range(0..8) {
        0 => Request::Enable { axis },
        1 => Request::Disable { axis },
        2 => Request::Home { axis },
        3 => Request::RecorderFailed,
        4 => Request::Clear([Fault::HostSilent, Fault::RecorderFailed][rng.random_range(0..2_usize)]),
        5 => {
            let excitation = Excitation::Jog { volts: rng.random_range(-1.0..1.0), distance_m: 0.01, duration_s: 0.3 };
            Request::Excite { axis, excitation }
        }
        _ => Request::Move {
            axis,
            profile: Move {
                target_m: rng.random_range([0.1..4.5, 0.1..0.8][axis].clone()),
                speed_m_s: rng.random_range(0.03..0.5),
                acceleration_m_s2: rng.random_range(0.2..0.9),
                jerk_m_s3: 0.0,
                is_shaped: rng.random(),
            },
        },
    }
}
