//! Drives and records one run after the other.
//!
//! A run is: go to its start, wait for the water, record the still rig, record the motion, record the still rig again. What ends it
//! early is kept apart: the operator (category 2), a fault of the controller (its own category), a recorder that can
//! write no more (category 1), a rig that no longer answers (its own watchdog). Whatever was recorded by then stays, marked
//! `interrupted` or `faulted`; a resumed campaign does that run again. A run is `complete` only when its planned motion was done: an
//! excitation that came to a soft limit before its end leaves it `cut`; the campaign goes on, and says so at its end.
//!
//! Here the campaign goes on step by step, asks and records. The rig is ticked by a thread of its own, which carries out one order after the
//! other (a `Session` each).

use std::path::{Path, PathBuf};

use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::{Phase, Refusal};
use froude_control::tick::AXES;
use froude_records::RecordError;
use froude_records::campaign::BodyAxis;
use froude_records::run::{AxisConstants, BodyState, CampaignMark, EventKind, RunStatus};
use indexmap::IndexMap;

use froude_records::carriage::CarriagePlan;

use super::hand_over::{Engine, Helm, hand_over};
use super::recording::{Recording, RigFacts};
use super::resume::{Found, look};
use super::rig_thread::{self, Ended, Entry, Order};
use super::stop::{Asked, StopSwitch};
use crate::drive::{Rig, RigError, Sample, Stranger};
use crate::load::Load;
use froude_records::carriage::plan::{Drive, JOG_S, OperatorStep, PlannedRun, Step};

/// Why a campaign stopped before its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunnerError {
    /// The operator asked for it.
    #[error("stopped by the operator in {run}; run the campaign again to resume from there")]
    Stopped {
        /// The run.
        run: String,
    },
    /// The operator asked for it while being asked.
    #[error("stopped by the operator, who was asked: {prompt}; run the campaign again to resume from there")]
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
    /// Another program on the line asked for a stop.
    #[error(
        "another program on the line (session {session:08x}) stopped the carriage in {run}. Find out who requested it, then run the campaign \
         again: it resumes from there"
    )]
    StoppedByAnother {
        /// The run.
        run: String,
        /// The other program's session.
        session: u32,
    },
    /// Another program on the line asked for a stop while nothing was to move.
    #[error(
        "another program on the line (session {session:08x}) asked for a stop between two runs, while nothing was to move. Find out who requested \
         it, then run the campaign again: it resumes from there"
    )]
    StoppedAtRest {
        /// The other program's session.
        session: u32,
    },
    /// A fault while nothing was to move: the operator was asked, or logs were read.
    #[error(
        "fault between two runs, while nothing was to move: {fault:?} (category {category} stop). Remove the cause, then run the \
         campaign again: it resumes from there"
    )]
    FaultAtRest {
        /// The fault.
        fault: Fault,
        /// How it was stopped.
        category: u8,
    },
    /// The controller latched a fault.
    #[error(
        "fault in {run}: {fault:?} (category {category} stop); the run is kept and marked. Remove the cause, then run the campaign \
         again: it resumes from there"
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
        "fault before {run}, in homing or on the way to its start: {fault:?} (category {category} stop); nothing was recorded. Remove the \
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
    /// A request was neither carried out nor refused.
    #[error(
        "{run}: the controller neither carried out nor refused to {what}; the carriage was stopped. Run the campaign again"
    )]
    Unanswered {
        /// The run.
        run: String,
        /// What was asked.
        what: &'static str,
    },
    /// A move ended elsewhere.
    #[error(
        "{run}: the move to {target_m:.3} m ended at {at_m:.3} m without a fault: something else stopped the carriage. Run the campaign \
         again: it resumes from there"
    )]
    Elsewhere {
        /// The run.
        run: String,
        /// Where it was to end, m.
        target_m: f64,
        /// Where it ended, m.
        at_m: f64,
    },
    /// All was driven, and some of it not to its end.
    #[error(
        "runs that ended before their planned motion was done are marked cut: {}. The same command drives them again; where that ends alike, \
         change the campaign and name another folder with --out",
        runs.join("; ")
    )]
    Cut {
        /// What became of each.
        runs: Vec<String>,
    },
    /// A stop was asked for twice, and the carriage still moves.
    #[error(
        "{run}: the carriage does not come to rest, although a stop was asked for twice: use the emergency stop. The board stops by itself \
         when this program has ended"
    )]
    NotAtRest {
        /// The run.
        run: String,
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
    /// What lies of a run is for a person to sort out.
    #[error("{0}")]
    Files(#[source] RecordError),
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
            Self::Fault { .. } | Self::FaultAtRest { .. } => RunStatus::Faulted,
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
const CLEAR: &str = "Homing moves both axes now: both axes are clear, and a person stands at the emergency stop";

/// The message about logs without a hash.
const EARLIER_VERSION: &str = "runs of an earlier version lie there: they carry no SHA-256 of their logs, so that only the logs' own checksums \
                               vouch for them";

/// Who sees how it goes.
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
    /// SHA-256 of the campaign's file, hexadecimal; empty where there is none.
    pub campaign_sha256: String,
    /// Folder of the runs; it exists.
    pub folder: PathBuf,
    /// What is asked for.
    pub asked: CarriagePlan,
    /// Speed of the ways between runs, m/s.
    pub return_speed_m_s: f64,
    /// Longest that homing may take, s, by axis.
    pub homing_s: [f64; AXES],
    /// Shape the reference for the load's mode.
    pub is_shaped: bool,
    /// The axis of the body that lies along the travel; `None` where nobody declared it.
    pub travel: Option<BodyAxis>,
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

impl Setting {
    /// The campaign, as its runs name it.
    #[must_use]
    pub fn mark(&self) -> CampaignMark<'_> {
        CampaignMark { name: &self.campaign, sha256: &self.campaign_sha256 }
    }
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
    /// Runs whose planned motion was not done, each with the reason.
    pub cut: Vec<String>,
}

impl Outcome {
    /// An error where a run's planned motion was not done.
    ///
    /// # Errors
    ///
    /// [`RunnerError::Cut`].
    pub fn whole(&self) -> Result<(), RunnerError> {
        if self.cut.is_empty() { Ok(()) } else { Err(RunnerError::Cut { runs: self.cut.clone() }) }
    }
}

/// Drives a whole plan. Runs that lie complete in the folder are not driven again; anything else that lies there of a run is set aside
/// as `ID.interrupted-N`, and the run driven anew.
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
        let thread = thread.map_err(|e| RunnerError::Thread { reason: e.to_string() })?;
        let driven = Campaign { steps, setting, helm, facts, switch, operator, progress }.drive(enough);
        // A thread that ended by itself has been reported already.
        let _ = thread.join();
        driven
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
        let mut outcome = Outcome { driven: 0, resumed: 0, spared: 0, enough: None, cut: Vec::new() };
        let mut mounted: Option<OperatorStep> = None;
        let mut is_prepared = false;
        let mut is_said = false;
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
            match look(folder, &run.id, self.setting.mark())? {
                Found::Complete { is_compared } => {
                    outcome.resumed += 1;
                    if !(is_compared || std::mem::replace(&mut is_said, true)) {
                        self.progress.say(EARLIER_VERSION);
                    }
                    // What was known then is known now: a campaign that had stopped stays stopped.
                    let known = enough(&folder.join(format!("{}.mcap", run.id)), run);
                    outcome.enough = outcome.enough.or(known);
                    continue;
                }
                Found::Nothing { aside: Some(what) } => self.progress.say(&what),
                Found::Nothing { aside: None } => {}
            }
            if let Some(step) = mounted.take() {
                self.confirm(step.prompt)?;
            }
            if !is_prepared {
                self.confirm(CLEAR.to_owned())?;
            }
            self.progress.run_begins(run, number, total);
            let (path, cut) = self.drive_run(run, number as u64, !is_prepared)?;
            is_prepared = true;
            outcome.driven += 1;
            if let Some(why) = cut {
                let what = format!("{} was cut: {why}", run.id);
                self.progress.say(&what);
                outcome.cut.push(what);
                continue;
            }
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

    /// One run from its approach to its log, which is closed whatever happens. Gives the log, and why the planned motion was not done where
    /// it was not.
    fn drive_run(
        &mut self,
        run: &'a PlannedRun,
        number: u64,
        is_first: bool,
    ) -> Result<(PathBuf, Option<String>), RunnerError> {
        let begun = self.carry_out(Order::Begin { run, number, is_first }, Some(run), &mut None)?;
        begun.result?;
        let mut recording = Some(Recording::create(self.setting, run, &self.facts, &begun.last)?);
        let driven = self.carry_out(Order::Drive(run), Some(run), &mut recording);
        let (driven, clock) = match driven {
            Ok(ended) => (ended.result, ended.clock),
            Err(error) => (Err(error), None),
        };
        let (status, note) = match &driven {
            Ok(None) => (RunStatus::Complete, None),
            Ok(Some(why)) => (RunStatus::Cut, Some(why.clone())),
            Err(error @ RunnerError::Record(_)) => (error.status(), Some("the disk accepted no more data".to_owned())),
            Err(error) => (error.status(), Some(error.to_string())),
        };
        let path = recording.map(|r| r.finish(status, note, clock)).transpose();
        // A log that cannot be closed after it could not be written is no second failure.
        let cut = driven?;
        Ok((path?.unwrap_or_default(), cut))
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
                    (Entry::Event(number, kind, sentence), Some(recording)) => recording.event(*number, kind, sentence),
                    _ => Ok(()),
                };
                if let Err(error) = recorded {
                    self.helm.give_up();
                    failed = Some(error);
                }
                match entry {
                    Entry::Sample(number, sample) if number.is_multiple_of(SHOWN_EVERY) => {
                        if let Some(run) = run {
                            self.progress.sample(run, &sample, number as f64 * tick_s);
                        }
                    }
                    Entry::Event(_, EventKind::Link, sentence) => self.progress.say(&sentence),
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

/// The load of a run: a ballasted wet run carries the wheel load that buoyancy removes.
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

/// Longest that a stop may take, s.
const STOP_S: f64 = 20.0;
/// Ticks within which a request is carried out or refused; a line that loses frames repeats it in the meantime.
const PATIENCE: usize = 4_000;
/// Further from its target than this no move has ended there, m: telemetry rounds to 0.1 µm.
const ARRIVED_M: f64 = 1e-5;
/// An excitation may seem this much shorter than it was, s: ticks before it was seen, and frames that were lost at its ends.
const UNSEEN_S: f64 = 0.05;
/// Part of a jog's way that must have been gone.
const JOGGED_PART: f64 = 0.9;

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
    pub(super) fn ordered(mut self, order: impl FnOnce(&mut Self) -> Result<Option<String>, RunnerError>) -> Ended {
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
            self.until("homing", self.setting.homing_s[axis], |s| {
                s.axes[axis].is_homed && s.axes[axis].phase == Phase::Holding
            })?;
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
            Drive::Pulses { from_m, .. }
            | Drive::Relay { from_m, .. }
            | Drive::Sweep { from_m, .. }
            | Drive::Jog { from_m, .. } => from_m,
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
        let at_m = self.until("the move", limit_s, |s| s.axes[axis].phase == Phase::Holding)?.axes[axis].reference_m;
        if (at_m - target_m).abs() > ARRIVED_M {
            return Err(RunnerError::Elsewhere { run: self.run.id.clone(), target_m, at_m });
        }
        Ok(())
    }

    /// Still, motion, still. Gives why the planned motion was not done, where it was not.
    pub(super) fn motion(&mut self) -> Result<Option<String>, RunnerError> {
        self.rig.begin_recording();
        let still_s = self.setting.asked.still_s;
        self.wait(still_s)?;
        self.event(EventKind::Phase, "the motion begins");
        let cut = match self.run.drive {
            Drive::Profile { to_m, speed_m_s, .. } => {
                self.go(to_m, speed_m_s)?;
                None
            }
            Drive::Pulses { volts, period_s, duty, duration_s, .. } => {
                self.excite("pulses", Excitation::Pulses { volts, period_s, duty, duration_s }, duration_s)?
            }
            Drive::Relay { volts, hysteresis_m, duration_s, .. } => {
                self.excite("relay", Excitation::Relay { volts, hysteresis_m, duration_s }, duration_s)?
            }
            Drive::Sweep { speed_m_s, volts, from_hz, to_hz, duration_s, .. } => {
                let sweep = Excitation::Sweep { volts, from_hz, to_hz, duration_s, speed_m_s };
                self.excite("sweep", sweep, duration_s)?
            }
            Drive::Jog { volts, distance_m, .. } => {
                self.excite("jog", Excitation::Jog { volts, distance_m, duration_s: JOG_S }, JOG_S)?
            }
        };
        if let Some(why) = &cut {
            self.event(EventKind::Warning, why);
        }
        self.event(EventKind::Phase, "the motion has ended");
        self.wait(still_s)?;
        Ok(cut)
    }

    /// Excites the axis; gives why that was not all that was planned, where it was not.
    fn excite(
        &mut self,
        what: &'static str,
        excitation: Excitation,
        duration_s: f64,
    ) -> Result<Option<String>, RunnerError> {
        let axis = self.axis();
        let begun = self.ask("excite", Request::Excite { axis, excitation })?;
        let mut last = None;
        let ended = self.until(what, duration_s + 30.0, |s| {
            if s.axes[axis].phase == Phase::Exciting {
                last = Some(s.tick);
            }
            s.axes[axis].phase == Phase::Holding
        })?;
        let rate_hz = self.rig.rate_hz() * self.rig.ticks_per_sample() as f64;
        let lasted_s = last.map_or(0.0, |tick| tick.saturating_sub(begun.tick) as f64 / rate_hz);
        let at_m = ended.axes[axis].position_m;
        if let Excitation::Jog { volts, distance_m, .. } = excitation {
            let gone_m = (at_m - begun.axes[axis].position_m).abs();
            return Ok((gone_m < JOGGED_PART * distance_m).then(|| {
                format!(
                    "the jog of {volts} V went {:.1} mm of {:.1} mm: a soft limit or its {duration_s} s ended it; polarity and encoder are not checked",
                    1e3 * gone_m,
                    1e3 * distance_m
                )
            }));
        }
        Ok((lasted_s + UNSEEN_S < duration_s).then(|| {
            format!(
                "the {what} ended after {lasted_s:.2} s of {duration_s} s, at {at_m:.3} m: the controller ends what would leave the soft limits"
            )
        }))
    }

    fn wait(&mut self, seconds: f64) -> Result<(), RunnerError> {
        for _ in 0..(seconds * self.rig.rate_hz()).round() as u64 {
            self.tick(None)?;
        }
        Ok(())
    }

    /// Hands over a request and waits until it has taken effect; gives the first sample that shows it.
    fn ask(&mut self, what: &'static str, request: Request) -> Result<Sample, RunnerError> {
        let mut sample = self.tick(Some(request))?;
        for _ in 0..PATIENCE {
            if let Some(refusal) = sample.refusal {
                return Err(RunnerError::Refused { run: self.run.id.clone(), what, refusal });
            }
            if has_begun(&sample, &request) {
                return Ok(sample);
            }
            sample = self.tick(None)?;
        }
        self.come_to_rest(Request::Stop(StopCategory::One), None)?;
        Err(RunnerError::Unanswered { run: self.run.id.clone(), what })
    }

    /// Goes on until it is done; gives the sample that shows it.
    fn until(
        &mut self,
        what: &'static str,
        limit_s: f64,
        mut done: impl FnMut(&Sample) -> bool,
    ) -> Result<Sample, RunnerError> {
        for _ in 0..(limit_s * self.rig.rate_hz()) as u64 {
            let sample = self.tick(None)?;
            if done(&sample) {
                return Ok(sample);
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
        if let Some(Stranger::Stopped(session)) = sample.stranger {
            self.rest_without_fault()?;
            return Err(RunnerError::StoppedByAnother { run: self.run.id.clone(), session });
        }
        if let Some((fault, _)) = sample.fault {
            let sentence = format!("{fault:?}: category {} stop", fault.category() as u8);
            self.event(EventKind::Fault, &sentence);
            self.until_rest()?;
            return Err(self.faulted(fault));
        }
        Ok(sample)
    }

    fn faulted(&self, fault: Fault) -> RunnerError {
        let (run, category) = (self.run.id.clone(), fault.category() as u8);
        if self.is_recorded {
            RunnerError::Fault { run, fault, category }
        } else {
            RunnerError::FaultBefore { run, fault, category }
        }
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
        self.rest_without_fault()
    }

    /// Goes on until both axes are at rest; a fault on the way is an error.
    fn rest_without_fault(&mut self) -> Result<(), RunnerError> {
        self.until_rest()?;
        // That nobody records any more is a fault by intent; any other one came while the carriage was being stopped.
        match self.last.fault {
            Some((fault, _)) if fault != Fault::RecorderFailed => {
                self.event(EventKind::Fault, &format!("{fault:?}: category {} stop", fault.category() as u8));
                Err(self.faulted(fault))
            }
            _ => Ok(()),
        }
    }

    /// Goes on until both axes are at rest. A stop that takes too long is made as hard as the drive can.
    fn until_rest(&mut self) -> Result<(), RunnerError> {
        if self.is_soon_at_rest()? {
            return Ok(());
        }
        self.rig_tick(Some(Request::Stop(StopCategory::One)))?;
        if self.is_soon_at_rest()? { Ok(()) } else { Err(RunnerError::NotAtRest { run: self.run.id.clone() }) }
    }

    /// Waits until both axes are at rest, and a tenth of a second more, so that the record shows it; `false` when that takes too long.
    fn is_soon_at_rest(&mut self) -> Result<bool, RunnerError> {
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
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// One tick of the rig; its sample is handed over where it is due to be recorded or shown.
    fn rig_tick(&mut self, request: Option<Request>) -> Result<Sample, RunnerError> {
        let sample = self.rig.tick(request)?;
        self.last = sample;
        self.tick.get_or_insert(sample.tick);
        let number = self.number();
        if let Some(stranger) = sample.stranger {
            self.event(EventKind::Link, &said_of(stranger));
        }
        let is_due = self.is_recorded && number.is_multiple_of(self.setting.decimation);
        if is_due || number.is_multiple_of(SHOWN_EVERY) {
            self.engine.offer(Entry::Sample(number, sample));
        }
        Ok(sample)
    }

    fn event(&mut self, kind: EventKind, sentence: &str) {
        let number = self.number();
        self.engine.put(Entry::Event(number, kind, sentence.to_owned()));
    }

    /// Ticks from the first sample of the order to the last one.
    fn number(&self) -> u64 {
        self.tick.map_or(0, |first| self.last.tick.saturating_sub(first))
    }
}

/// Whether a sample shows that a request is being carried out, or has been.
fn has_begun(sample: &Sample, request: &Request) -> bool {
    let phase = |axis: usize| sample.axes.get(axis).map_or(Phase::Disabled, |a| a.phase);
    match *request {
        Request::Enable { axis } => phase(axis) != Phase::Disabled,
        Request::Home { axis } => phase(axis) == Phase::Homing,
        Request::Move { axis, profile } => {
            phase(axis) == Phase::Moving
                || sample.axes.get(axis).is_some_and(|a| (a.reference_m - profile.target_m).abs() < ARRIVED_M)
        }
        // One that is ended at once is on its way to a stop already.
        Request::Excite { axis, .. } => matches!(phase(axis), Phase::Exciting | Phase::Stopping),
        _ => true,
    }
}

/// Whoever watches is shown the samples whose tick is a multiple of this: thirty a second, fewer from a board that sends fewer.
const SHOWN_EVERY: u64 = 133;

/// The message about another program on the line.
pub(super) fn said_of(stranger: Stranger) -> String {
    match stranger {
        Stranger::TurnedAway(session) => {
            format!("another program (session {session:08x}) asked for the board and was turned away")
        }
        Stranger::Stopped(session) => {
            format!("another program (session {session:08x}) asked for a stop, which was obeyed")
        }
    }
}
