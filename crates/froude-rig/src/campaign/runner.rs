//! Drives and records one run after the other.
//!
//! A run is: go to its start, wait for the water, record the still rig, record the motion, record the still rig again. What ends it
//! early is told apart and kept: the operator (category 2), a fault of the controller (its own category), a recorder that can
//! write no more (category 1), a rig that no longer answers (its own watchdog). Whatever was recorded by then stays, marked
//! `interrupted` or `faulted`; a resumed campaign does that run again.
//!
//! Here the campaign goes on step by step, asks and records. The rig is ticked by a thread of its own, which carries out one order after the
//! other (a `Session` each).

use std::path::{Path, PathBuf};

use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::{Phase, Refusal};
use froude_records::RecordError;
use froude_records::run::{AxisConstants, BodyState, EventKind, RunStatus, read_run_meta};
use indexmap::IndexMap;

use froude_records::carriage::CarriagePlan;

use super::hand_over::{Engine, Helm, hand_over};
use super::plan::{Drive, JOG_S, OperatorStep, PlannedRun, Step};
use super::recording::{Recording, RigFacts};
use super::rig_thread::{self, Ended, Entry, Order};
use super::stop::{Asked, StopSwitch};
use crate::drive::{Rig, RigError, Sample};
use crate::load::Load;

/// Why a campaign stopped before its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunnerError {
    /// The operator asked for it.
    #[error("stopped by the operator in {run}; run the campaign again to go on from there")]
    Stopped {
        /// The run.
        run: String,
    },
    /// The operator asked for it while being asked.
    #[error("stopped by the operator, who was asked: {prompt}; run the campaign again to go on from there")]
    StoppedWaiting {
        /// What was asked.
        prompt: String,
    },
    /// The operator does not go on.
    #[error("the operator did not confirm: {prompt}")]
    NotConfirmed {
        /// What was asked.
        prompt: String,
    },
    /// A fault while nothing was to move: the operator was asked, or logs were read.
    #[error(
        "fault between two runs, while nothing was to move: {fault:?} (category {category} stop). Mend the cause, then run the \
         campaign again: it goes on from there"
    )]
    FaultAtRest {
        /// The fault.
        fault: Fault,
        /// How it was stopped.
        category: u8,
    },
    /// The controller latched a fault.
    #[error(
        "fault in {run}: {fault:?} (category {category} stop); the run is kept and marked. Mend the cause, then run the campaign \
         again: it goes on from there"
    )]
    Fault {
        /// The run.
        run: String,
        /// The fault.
        fault: Fault,
        /// How it was stopped.
        category: u8,
    },
    /// A fault before the run itself: in homing, or on the way to its start.
    #[error(
        "fault before {run}, in homing or on the way to its start: {fault:?} (category {category} stop); nothing was recorded. Mend the \
         cause (a loop softer than its chain lets the motor swing: froude carriage tune), then run the campaign again"
    )]
    FaultBefore {
        /// The run.
        run: String,
        /// The fault.
        fault: Fault,
        /// How it was stopped.
        category: u8,
    },
    /// The controller refused a request.
    #[error("{run}: the controller refused to {what}: {refusal:?}")]
    Refused {
        /// The run.
        run: String,
        /// What was asked.
        what: &'static str,
        /// Why not.
        refusal: Refusal,
    },
    /// Something took longer than it can.
    #[error("{run}: {what} did not end within {limit_s:.0} s; the carriage was stopped")]
    TooLong {
        /// The run.
        run: String,
        /// What.
        what: &'static str,
        /// The limit.
        limit_s: f64,
    },
    /// Recording failed; the carriage was stopped (category 1).
    #[error("the carriage was stopped because it can no longer be recorded: {0}")]
    Record(#[from] RecordError),
    /// What was recorded came too late to the disk; the carriage was stopped (category 1).
    #[error(
        "the carriage was stopped in {run} because the disk is {} s behind it; free the disk of other work, or record to another \
         one (--out)",
        rig_thread::PATIENCE_S
    )]
    Behind {
        /// The run.
        run: String,
    },
    /// The rig does not answer.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The thread that ticks the rig did not start, or did not live.
    #[error("the thread that ticks the rig: {reason}; the board's own watchdog stops the carriage")]
    Thread {
        /// What happened.
        reason: String,
    },
    /// A folder.
    #[error("{}: {reason}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
}

impl RunnerError {
    fn status(&self) -> RunStatus {
        match self {
            Self::Fault { .. } => RunStatus::Faulted,
            _ => RunStatus::Interrupted,
        }
    }
}

/// Who confirms the operator's steps.
pub trait Operator {
    /// Asks; `true` when it is done. Takes as long as it takes: the rig is looked after meanwhile. When `is_over` says so, nobody waits for
    /// the answer any more, and it is `false`.
    fn confirm(&mut self, prompt: &str, is_over: &dyn Fn() -> bool) -> bool;
}

/// What is asked before the first motion.
const CLEAR: &str = "Homing moves both axes now: both ways are clear, and somebody stands at the emergency stop";

/// Who is told how it goes.
pub trait Progress {
    /// A run begins, the `number`th of `total`.
    fn run_begins(&mut self, run: &PlannedRun, number: usize, total: usize);
    /// A sample, about thirty times a second of run time.
    fn sample(&mut self, run: &PlannedRun, sample: &Sample, time_s: f64);
    /// A line worth reading.
    fn say(&mut self, line: &str);
}

/// After a run, driven now or there already: whether its campaign knows enough. The text says why.
pub type Enough<'a> = dyn FnMut(&Path, &PlannedRun) -> Option<String> + 'a;

/// An approach that coasts too far even at this speed is none, m/s.
const SLOWEST_APPROACH_M_S: f64 = 0.02;

/// What is the same for all runs.
#[derive(Debug, Clone)]
pub struct Setting {
    /// Campaign's name.
    pub campaign: String,
    /// Folder of the runs; it exists.
    pub folder: PathBuf,
    /// What is asked for.
    pub asked: CarriagePlan,
    /// Speed of the ways between runs, m/s.
    pub return_speed_m_s: f64,
    /// Shape the reference for the load's mode.
    pub is_shaped: bool,
    /// Declared constants by axis.
    pub constants: IndexMap<String, AxisConstants>,
    /// What rides on the carriage apart from where it is mounted: only a twin needs it.
    pub load: Load,
    /// Seed, for the record; `None` on a real rig.
    pub twin_seed: Option<u64>,
    /// Every how many ticks one is recorded.
    pub decimation: u64,
    /// Start of the campaign on the host's clock, ns since 1970; 0 where runs shall be bit-equal.
    pub start_unix_ns: u64,
    /// Date in words.
    pub date: String,
}

/// How a campaign ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Runs driven now.
    pub driven: usize,
    /// Runs that were there already.
    pub resumed: usize,
    /// Runs left out because enough was known.
    pub spared: usize,
    /// Why it stopped early, where it did.
    pub enough: Option<String>,
}

/// Drives a whole plan. Runs that lie complete in the folder are not driven again; an interrupted one is put aside as
/// `ID.interrupted-N` and driven anew.
///
/// # Errors
///
/// [`RunnerError`]: the carriage is at rest then, as far as the rig still answers.
pub fn drive(
    steps: &[Step],
    setting: &Setting,
    rig: &mut (dyn Rig + Send),
    switch: &StopSwitch,
    operator: &mut dyn Operator,
    progress: &mut dyn Progress,
    enough: &mut Enough<'_>,
) -> Result<Outcome, RunnerError> {
    let facts = RigFacts::of(rig);
    let (pace, capacity) = rig_thread::pace(rig);
    let (helm, engine) = hand_over(pace, capacity);
    std::thread::scope(|scope| {
        let attend = move || rig_thread::attend(rig, engine, setting, switch);
        let thread = std::thread::Builder::new().name("rig".to_owned()).spawn_scoped(scope, attend);
        thread.map_err(|e| RunnerError::Thread { reason: e.to_string() })?;
        Campaign { steps, setting, helm, facts, switch, operator, progress }.drive(enough)
    })
}

/// The side of the campaign: it orders, asks and records.
struct Campaign<'a, 'b> {
    steps: &'a [Step],
    setting: &'a Setting,
    helm: Helm<Order<'a>, Entry>,
    facts: RigFacts,
    switch: &'a StopSwitch,
    operator: &'b mut dyn Operator,
    progress: &'b mut dyn Progress,
}

impl<'a> Campaign<'a, '_> {
    fn drive(mut self, enough: &mut Enough<'_>) -> Result<Outcome, RunnerError> {
        let folder = &self.setting.folder;
        let total = self.steps.iter().filter(|s| matches!(s, Step::Run(_))).count();
        let mut outcome = Outcome { driven: 0, resumed: 0, spared: 0, enough: None };
        let mut mounted: Option<OperatorStep> = None;
        let mut is_prepared = false;
        let mut number = 0;
        for step in self.steps {
            let run = match step {
                Step::Operator(step) => {
                    // Asked when a run needs it, so that a resumed campaign does not ask for what is past.
                    mounted = Some(step.clone());
                    continue;
                }
                Step::Run(run) => run,
            };
            number += 1;
            if outcome.enough.is_some() && run.pair.is_some() {
                outcome.spared += 1;
                continue;
            }
            if is_complete(folder, &run.id)? {
                outcome.resumed += 1;
                // What was known then is known now: a campaign that had stopped stays stopped.
                let known = enough(&folder.join(format!("{}.mcap", run.id)), run);
                outcome.enough = outcome.enough.or(known);
                continue;
            }
            if let Some(step) = mounted.take() {
                self.confirm(step.prompt)?;
            }
            if !is_prepared {
                self.confirm(CLEAR.to_owned())?;
            }
            self.progress.run_begins(run, number, total);
            let path = self.drive_run(run, number as u64, !is_prepared)?;
            is_prepared = true;
            outcome.driven += 1;
            if let Some(why) = enough(&path, run) {
                self.progress.say(&why);
                outcome.enough = Some(why);
            }
        }
        Ok(outcome)
    }

    fn confirm(&mut self, prompt: String) -> Result<(), RunnerError> {
        let (switch, helm) = (self.switch, &self.helm);
        let is_over = || switch.is_asked() || helm.is_in_trouble();
        let is_confirmed = self.operator.confirm(&prompt, &is_over);
        if self.helm.is_in_trouble() {
            self.carry_out(Order::Report, None, &mut None)?.result?;
        }
        if self.switch.is_asked() {
            return Err(RunnerError::StoppedWaiting { prompt });
        }
        if is_confirmed { Ok(()) } else { Err(RunnerError::NotConfirmed { prompt }) }
    }

    /// One run from its approach to its log, which is closed whatever happens.
    fn drive_run(&mut self, run: &'a PlannedRun, number: u64, is_first: bool) -> Result<PathBuf, RunnerError> {
        let begun = self.carry_out(Order::Begin { run, number, is_first }, Some(run), &mut None)?;
        begun.result?;
        let mut recording = Some(Recording::create(self.setting, run, &self.facts, &begun.last)?);
        let driven = self.carry_out(Order::Drive(run), Some(run), &mut recording);
        let (driven, clock) = match driven {
            Ok(ended) => (ended.result, ended.clock),
            Err(error) => (Err(error), None),
        };
        let status = driven.as_ref().map_or_else(RunnerError::status, |()| RunStatus::Complete);
        let note = match &driven {
            Ok(()) => None,
            Err(RunnerError::Record(_)) => Some("the disk took no more".to_owned()),
            Err(error) => Some(error.to_string()),
        };
        let path = recording.map(|r| r.finish(status, note, clock)).transpose();
        // A log that cannot be closed after it could not be written is no second failure.
        driven?;
        Ok(path?.unwrap_or_default())
    }

    /// Has an order carried out; what comes meanwhile is recorded and shown. A record that fails stops the carriage.
    fn carry_out(
        &mut self,
        order: Order<'a>,
        run: Option<&PlannedRun>,
        recording: &mut Option<Recording<'a>>,
    ) -> Result<Ended, RunnerError> {
        self.helm.order(order);
        let tick_s = 1.0 / (self.facts.rate_hz * self.facts.ticks_per_sample as f64);
        let mut failed = None;
        let mut entries = Vec::new();
        while self.helm.take(&mut entries) {
            for entry in entries.drain(..) {
                let recorded = match (&entry, &mut *recording) {
                    _ if failed.is_some() => Ok(()),
                    (Entry::Sample(number, sample), Some(recording)) => recording.sample(*number, sample),
                    (Entry::Event(kind, sentence), Some(recording)) => recording.event(kind, sentence),
                    _ => Ok(()),
                };
                if let Err(error) = recorded {
                    self.helm.give_up();
                    failed = Some(error);
                }
                match entry {
                    Entry::Sample(number, sample) if number.is_multiple_of(TOLD_EVERY) => {
                        if let Some(run) = run {
                            self.progress.sample(run, &sample, number as f64 * tick_s);
                        }
                    }
                    Entry::Ended(ended) => {
                        return match failed {
                            Some(error) => Err(error.into()),
                            None => Ok(ended),
                        };
                    }
                    _ => {}
                }
            }
        }
        Err(RunnerError::Thread { reason: "it has ended by itself".to_owned() })
    }
}

/// Whether a run lies there complete; an incomplete one is put aside.
fn is_complete(folder: &Path, id: &str) -> Result<bool, RunnerError> {
    let sidecar = folder.join(format!("{id}.toml"));
    if !sidecar.exists() {
        return Ok(false);
    }
    if read_run_meta(&sidecar)?.status == RunStatus::Complete {
        return Ok(true);
    }
    let aside =
        (1..10_000).map(|n| format!("{id}.interrupted-{n}")).find(|name| !folder.join(format!("{name}.toml")).exists());
    if let Some(aside) = aside {
        for extension in ["mcap", "toml"] {
            let from = folder.join(format!("{id}.{extension}"));
            if from.exists() {
                std::fs::rename(&from, folder.join(format!("{aside}.{extension}")))
                    .map_err(|e| RunnerError::Folder { path: from, reason: e.to_string() })?;
            }
        }
    }
    Ok(false)
}

/// The load of a run: a ballasted wet run carries what buoyancy takes off its wheels.
fn load_of(run: &PlannedRun, base: &Load) -> Load {
    use crate::load::{HungWeight, Mounting};
    let mounting = match run.body {
        BodyState::None => Mounting::None,
        BodyState::Dry => Mounting::Dry,
        BodyState::Wet => Mounting::Wet,
    };
    let ballast_kg = if run.is_ballasted && mounting == Mounting::Wet { base.balancing_ballast_kg() } else { 0.0 };
    Load {
        mounting,
        ballast_kg,
        hung: HungWeight {
            weight_n: run.hung_weight_n,
            floor_m: run.floor_m.unwrap_or(f64::NEG_INFINITY),
            ..base.hung
        },
        ..*base
    }
}

/// Longest that homing may take, s.
const HOMING_S: f64 = 300.0;
/// Longest that a stop may take, s.
const STOP_S: f64 = 20.0;
/// A request that is neither carried out nor refused within this many ticks is asked again on a line that loses frames.
const PATIENCE: usize = 400;

/// An order being carried out, on the rig's thread.
pub(super) struct Session<'a, 'o> {
    setting: &'a Setting,
    rig: &'a mut dyn Rig,
    switch: &'a StopSwitch,
    engine: &'a mut Engine<Order<'o>, Entry>,
    run: &'a PlannedRun,
    is_recorded: bool,
    /// Board's tick at which the order began.
    tick: Option<u64>,
    last: Sample,
}

impl<'a, 'o> Session<'a, 'o> {
    pub(super) fn new(
        setting: &'a Setting,
        rig: &'a mut dyn Rig,
        switch: &'a StopSwitch,
        engine: &'a mut Engine<Order<'o>, Entry>,
        run: &'a PlannedRun,
        is_recorded: bool,
    ) -> Self {
        Self { setting, rig, switch, engine, run, is_recorded, tick: None, last: Sample::default() }
    }

    /// Carries the order out and says how it ended.
    pub(super) fn ordered(mut self, order: impl FnOnce(&mut Self) -> Result<(), RunnerError>) -> Ended {
        let result = order(&mut self);
        let clock = self.tick.and_then(|tick| self.rig.host_clock(tick));
        Ended { result, last: self.last, clock }
    }

    fn axis(&self) -> usize {
        self.run.axis as usize
    }

    /// Goes to where the run starts and waits for the water; the last sample says what the rig has to be recorded.
    pub(super) fn begin(&mut self, number: u64, is_first: bool) -> Result<(), RunnerError> {
        self.rig.begin_run(&load_of(self.run, &self.setting.load), number);
        if is_first {
            self.prepare()?;
        }
        self.approach()?;
        self.wait(self.run.settle_s)?;
        self.tick(None).map(drop)
    }

    /// Enables and homes both axes.
    fn prepare(&mut self) -> Result<(), RunnerError> {
        for axis in [0, 1] {
            self.ask("enable the axis", Request::Enable { axis })?;
            self.ask("home the axis", Request::Home { axis })?;
            self.until("homing", HOMING_S, |s| s.axes[axis].is_homed && s.axes[axis].phase == Phase::Holding)?;
        }
        Ok(())
    }

    /// Goes to where the run starts: as fast as allowed, with a hung weight no faster than the run itself; more slowly where the coast
    /// beyond the start would not fit into the travel.
    fn approach(&mut self) -> Result<(), RunnerError> {
        let mut speed_m_s = self.setting.return_speed_m_s;
        let target_m = match self.run.drive {
            Drive::Profile { from_m, speed_m_s: own_m_s, .. } => {
                if self.run.hung_weight_n != 0.0 {
                    speed_m_s = own_m_s;
                }
                from_m
            }
            Drive::Pulses { from_m, .. } | Drive::Relay { from_m, .. } | Drive::Sweep { from_m, .. } => from_m,
            Drive::Jog { .. } => return Ok(()),
        };
        loop {
            match self.go(target_m, speed_m_s) {
                Err(RunnerError::Refused { refusal: Refusal::BeyondTravel, .. })
                    if speed_m_s > SLOWEST_APPROACH_M_S =>
                {
                    speed_m_s *= 0.5;
                }
                other => return other,
            }
        }
    }

    fn go(&mut self, target_m: f64, speed_m_s: f64) -> Result<(), RunnerError> {
        let axis = self.axis();
        let s = &self.setting.asked;
        let profile = Move {
            target_m,
            speed_m_s,
            acceleration_m_s2: s.acceleration_m_s2,
            jerk_m_s3: s.jerk_m_s3.unwrap_or(0.0),
            is_shaped: self.setting.is_shaped,
        };
        self.ask("move", Request::Move { axis, profile })?;
        // The longest way at this speed, and time for ramps and shaping.
        let limit_s = 10.0 / speed_m_s.max(1e-3) + 30.0;
        self.until("the move", limit_s, |s| s.axes[axis].phase == Phase::Holding)
    }

    /// Still, motion, still.
    pub(super) fn motion(&mut self) -> Result<(), RunnerError> {
        let still_s = self.setting.asked.still_s;
        self.wait(still_s)?;
        self.event(EventKind::Phase, "the motion begins");
        match self.run.drive {
            Drive::Profile { to_m, speed_m_s, .. } => self.go(to_m, speed_m_s)?,
            Drive::Pulses { volts, period_s, duty, duration_s, .. } => {
                self.excite("the pulses", Excitation::Pulses { volts, period_s, duty, duration_s }, duration_s)?;
            }
            Drive::Relay { volts, hysteresis_m, duration_s, .. } => {
                self.excite("the relay", Excitation::Relay { volts, hysteresis_m, duration_s }, duration_s)?;
            }
            Drive::Sweep { speed_m_s, volts, from_hz, to_hz, duration_s, .. } => {
                let sweep = Excitation::Sweep { volts, from_hz, to_hz, duration_s, speed_m_s };
                self.excite("the sweep", sweep, duration_s)?;
            }
            Drive::Jog { volts, distance_m } => {
                self.excite("the jog", Excitation::Jog { volts, distance_m, duration_s: JOG_S }, JOG_S)?;
            }
        }
        self.event(EventKind::Phase, "the motion has ended");
        self.wait(still_s)
    }

    fn excite(&mut self, what: &'static str, excitation: Excitation, duration_s: f64) -> Result<(), RunnerError> {
        let axis = self.axis();
        self.ask("excite", Request::Excite { axis, excitation })?;
        self.until(what, duration_s + 30.0, |s| s.axes[axis].phase == Phase::Holding)
    }

    fn wait(&mut self, seconds: f64) -> Result<(), RunnerError> {
        for _ in 0..(seconds * self.rig.rate_hz()).round() as u64 {
            self.tick(None)?;
        }
        Ok(())
    }

    /// Hands over a request and waits until it has taken effect.
    fn ask(&mut self, what: &'static str, request: Request) -> Result<(), RunnerError> {
        let sample = self.tick(Some(request))?;
        let mut refusal = sample.refusal;
        for _ in 0..PATIENCE {
            if refusal.is_some() || self.has_begun(&request)? {
                break;
            }
            refusal = self.tick(None)?.refusal;
        }
        match refusal {
            Some(refusal) => Err(RunnerError::Refused { run: self.run.id.clone(), what, refusal }),
            None => Ok(()),
        }
    }

    /// A request shows in the phase of its axis one tick later at the latest on the twin, a few on a line.
    fn has_begun(&mut self, request: &Request) -> Result<bool, RunnerError> {
        let sample = self.tick(None)?;
        let phase = |axis: usize| sample.axes.get(axis).map_or(Phase::Disabled, |a| a.phase);
        Ok(match *request {
            Request::Enable { axis } => phase(axis) != Phase::Disabled,
            Request::Home { axis } => phase(axis) == Phase::Homing,
            Request::Move { axis, profile } => {
                phase(axis) == Phase::Moving
                    || sample.axes.get(axis).is_some_and(|a| (a.reference_m - profile.target_m).abs() < 1e-6)
            }
            Request::Excite { axis, .. } => phase(axis) == Phase::Exciting || sample.refusal.is_none(),
            _ => true,
        })
    }

    fn until(&mut self, what: &'static str, limit_s: f64, done: impl Fn(&Sample) -> bool) -> Result<(), RunnerError> {
        for _ in 0..(limit_s * self.rig.rate_hz()) as u64 {
            if done(&self.tick(None)?) {
                return Ok(());
            }
        }
        self.come_to_rest(Request::Stop(StopCategory::One), None)?;
        Err(RunnerError::TooLong { run: self.run.id.clone(), what, limit_s })
    }

    /// One tick: driven, handed over, watched. Who asked for a stop gets it before anything else is asked of the rig.
    fn tick(&mut self, request: Option<Request>) -> Result<Sample, RunnerError> {
        match self.switch.asked() {
            Asked::Nothing => {}
            Asked::Stop => return Err(self.stopped(StopCategory::Two, "the operator asked for a stop (category 2)")),
            Asked::Cut => return Err(self.stopped(StopCategory::Zero, "the operator cut the torque (category 0)")),
        }
        if self.engine.is_unrecorded() {
            self.come_to_rest(Request::RecorderFailed, None)?;
            return Err(RunnerError::Behind { run: self.run.id.clone() });
        }
        let sample = self.rig_tick(request)?;
        if let Some((fault, _)) = sample.fault {
            let sentence = format!("{fault:?}: category {} stop", fault.category() as u8);
            self.event(EventKind::Fault, &sentence);
            self.until_rest()?;
            let (run, category) = (self.run.id.clone(), fault.category() as u8);
            return Err(if self.is_recorded {
                RunnerError::Fault { run, fault, category }
            } else {
                RunnerError::FaultBefore { run, fault, category }
            });
        }
        Ok(sample)
    }

    /// Stops because the operator asked for it.
    fn stopped(&mut self, category: StopCategory, sentence: &str) -> RunnerError {
        match self.come_to_rest(Request::Stop(category), Some(sentence)) {
            Ok(()) => RunnerError::Stopped { run: self.run.id.clone() },
            Err(error) => error,
        }
    }

    /// Asks for a stop, then says so, and goes on ticking and recording until both axes are at rest; a second press of the switch cuts.
    fn come_to_rest(&mut self, request: Request, sentence: Option<&str>) -> Result<(), RunnerError> {
        self.rig_tick(Some(request))?;
        if let Some(sentence) = sentence {
            self.event(EventKind::Operator, sentence);
        }
        self.until_rest()
    }

    /// Goes on until both axes are at rest, and a tenth of a second more, so that the record shows it.
    fn until_rest(&mut self) -> Result<(), RunnerError> {
        let mut is_cut = false;
        let mut rest_ticks = 0.0;
        for _ in 0..(STOP_S * self.rig.rate_hz()) as u64 {
            let request = (!is_cut && self.switch.asked() == Asked::Cut).then(|| {
                is_cut = true;
                Request::Stop(StopCategory::Zero)
            });
            let sample = self.rig_tick(request)?;
            let is_at_rest = sample.axes.iter().all(|a| matches!(a.phase, Phase::Disabled | Phase::Holding));
            rest_ticks = if is_at_rest { rest_ticks + 1.0 } else { 0.0 };
            if rest_ticks >= 0.1 * self.rig.rate_hz() {
                break;
            }
        }
        Ok(())
    }

    /// One tick of the rig; its sample is handed over where it is due to be recorded or shown.
    fn rig_tick(&mut self, request: Option<Request>) -> Result<Sample, RunnerError> {
        let sample = self.rig.tick(request)?;
        self.last = sample;
        let number = sample.tick.saturating_sub(*self.tick.get_or_insert(sample.tick));
        let is_due = self.is_recorded && number.is_multiple_of(self.setting.decimation);
        if is_due || number.is_multiple_of(TOLD_EVERY) {
            self.engine.offer(Entry::Sample(number, sample));
        }
        Ok(sample)
    }

    fn event(&mut self, kind: EventKind, sentence: &str) {
        self.engine.put(Entry::Event(kind, sentence.to_owned()));
    }
}

/// Ticks between two words to whoever watches: thirty a second.
const TOLD_EVERY: u64 = 133;
