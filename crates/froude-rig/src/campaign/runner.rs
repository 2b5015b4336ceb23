//! Drives and records one run after the other.
//!
//! A run is: go to its start, wait for the water, record the still rig, record the motion, record the still rig again. What ends it
//! early is told apart and kept: the operator (category 2), a fault of the controller (its own category), a recorder that can
//! write no more (category 1), a rig that no longer answers (its own watchdog). Whatever was recorded by then stays, marked
//! `interrupted` or `faulted`; a resumed campaign does that run again. A run is `complete` only when its planned motion was done: an
//! excitation that came to a soft limit before its end leaves it `cut`; the campaign goes on, and tells it at its end.

use std::path::{Path, PathBuf};

use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::{Phase, Refusal};
use froude_records::RecordError;
use froude_records::run::{
    AxisConstants, AxisSample, BodyState, CarriageSample, ClockAlignment, EventKind, Layout, Packing, Recorder,
    RunMeta, RunStatus,
};
use indexmap::IndexMap;

use froude_records::carriage::CarriagePlan;

use super::plan::{Drive, JOG_S, OperatorStep, PlannedRun, Step};
use super::resume::{Found, look};
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
    /// The operator does not go on.
    #[error("the operator did not confirm: {prompt}")]
    NotConfirmed {
        /// What was asked.
        prompt: String,
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
         again: it goes on from there"
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
    /// The rig does not answer.
    #[error(transparent)]
    Rig(#[from] RigError),
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
    /// Asks; `true` when it is done.
    fn confirm(&mut self, prompt: &str) -> bool;
}

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

/// Drives a whole plan. Runs that lie complete in the folder are not driven again; anything else that lies there of a run is put aside
/// as `ID.interrupted-N`, and the run driven anew.
///
/// # Errors
///
/// [`RunnerError`]: the carriage is at rest then, as far as the rig still answers.
pub fn drive(
    steps: &[Step],
    setting: &Setting,
    rig: &mut dyn Rig,
    switch: &StopSwitch,
    operator: &mut dyn Operator,
    progress: &mut dyn Progress,
    enough: &mut Enough<'_>,
) -> Result<Outcome, RunnerError> {
    let total = steps.iter().filter(|s| matches!(s, Step::Run(_))).count();
    let mut outcome = Outcome { driven: 0, resumed: 0, spared: 0, enough: None, cut: Vec::new() };
    let mut mounted: Option<OperatorStep> = None;
    let mut is_prepared = false;
    let mut number = 0;
    for step in steps {
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
        match look(&setting.folder, &run.id)? {
            Found::Complete => {
                outcome.resumed += 1;
                // What was known then is known now: a campaign that had stopped stays stopped.
                let known = enough(&setting.folder.join(format!("{}.mcap", run.id)), run);
                outcome.enough = outcome.enough.or(known);
                continue;
            }
            Found::Nothing { aside: Some(what) } => progress.say(&what),
            Found::Nothing { aside: None } => {}
        }
        if let Some(step) = mounted.take()
            && !operator.confirm(&step.prompt)
        {
            return Err(RunnerError::NotConfirmed { prompt: step.prompt });
        }
        progress.run_begins(run, number, total);
        rig.begin_run(&load_of(run, &setting.load), number as u64);
        let mut session = Session { setting, rig, switch, progress, run, recorder: None, row: Vec::new(), tick: None };
        if !is_prepared {
            session.prepare()?;
            is_prepared = true;
        }
        let (path, cut) = session.drive_run()?;
        outcome.driven += 1;
        if let Some(why) = cut {
            let told = format!("{} was cut: {why}", run.id);
            progress.say(&told);
            outcome.cut.push(told);
            continue;
        }
        if let Some(why) = enough(&path, run) {
            progress.say(&why);
            outcome.enough = Some(why);
        }
    }
    Ok(outcome)
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
/// Ticks within which a request is carried out or refused; a line that loses frames repeats it in the meantime.
const PATIENCE: usize = 4_000;
/// Further from its target than this no move has ended there, m: telemetry rounds to 0.1 µm.
const ARRIVED_M: f64 = 1e-5;
/// An excitation may seem this much shorter than it was, s: ticks before it was seen, and frames that were lost at its ends.
const UNSEEN_S: f64 = 0.05;
/// Part of a jog's way that must have been gone.
const JOGGED_PART: f64 = 0.9;

struct Session<'a> {
    setting: &'a Setting,
    rig: &'a mut dyn Rig,
    switch: &'a StopSwitch,
    progress: &'a mut dyn Progress,
    run: &'a PlannedRun,
    recorder: Option<Recorder>,
    row: Vec<f64>,
    /// Board's tick at which recording began.
    tick: Option<u64>,
}

impl Session<'_> {
    fn axis(&self) -> usize {
        self.run.axis as usize
    }

    /// Whether the short axis is recorded: it is declared, or it is the one that moves.
    fn has_x(&self) -> bool {
        self.setting.constants.contains_key("x") || self.run.axis == froude_records::run::Axis::X
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

    /// The whole run; the record is closed whatever happens. Gives its file, and why the planned motion was not done where it was not.
    fn drive_run(mut self) -> Result<(PathBuf, Option<String>), RunnerError> {
        self.approach()?;
        self.wait(self.run.settle_s)?;
        self.begin_record()?;
        let driven = self.motion();
        let (status, note) = match &driven {
            Ok(None) => (RunStatus::Complete, None),
            Ok(Some(why)) => (RunStatus::Cut, Some(why.clone())),
            Err(error) => (error.status(), Some(error.to_string())),
        };
        if let (Some(recorder), Some(note)) = (&mut self.recorder, note) {
            recorder.meta_mut().note = note;
        }
        self.align_clock();
        let path = self.recorder.take().map(|r| r.finish(status)).transpose();
        let cut = driven?;
        Ok((path?.unwrap_or_default(), cut))
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

    /// Where the record's first tick lies on the host's clock.
    fn align_clock(&mut self) {
        let clock = self.tick.and_then(|tick| self.rig.host_clock(tick));
        if let (Some(recorder), Some(clock)) = (&mut self.recorder, clock) {
            recorder.meta_mut().clock = Some(ClockAlignment {
                host_at_zero_s: clock.unix_s - 1e-9 * self.setting.start_unix_ns as f64,
                drift: clock.drift,
                standard_uncertainty_s: clock.standard_uncertainty_s,
            });
        }
    }

    /// Still, motion, still. Gives why the planned motion was not done, where it was not.
    fn motion(&mut self) -> Result<Option<String>, RunnerError> {
        let still_s = self.setting.asked.still_s;
        self.wait(still_s)?;
        self.event(EventKind::Phase, "the motion begins")?;
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
            self.event(EventKind::Warning, why)?;
        }
        self.event(EventKind::Phase, "the motion has ended")?;
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
        self.come_to_rest(StopCategory::One)?;
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
        self.come_to_rest(StopCategory::One)?;
        Err(RunnerError::TooLong { run: self.run.id.clone(), what, limit_s })
    }

    /// One tick: driven, recorded, watched.
    fn tick(&mut self, request: Option<Request>) -> Result<Sample, RunnerError> {
        let sample = self.rig.tick(request)?;
        if let Err(error) = self.record(&sample) {
            self.come_to_rest_for_recorder()?;
            return Err(error.into());
        }
        if let Some((fault, _)) = sample.fault {
            let sentence = format!("{fault:?}: category {} stop", fault.category() as u8);
            self.event(EventKind::Fault, &sentence)?;
            self.until_rest()?;
            let (run, category) = (self.run.id.clone(), fault.category() as u8);
            return Err(if self.recorder.is_some() {
                RunnerError::Fault { run, fault, category }
            } else {
                RunnerError::FaultBefore { run, fault, category }
            });
        }
        match self.switch.asked() {
            Asked::Nothing => Ok(sample),
            Asked::Stop => {
                self.event(EventKind::Operator, "the operator asked for a stop (category 2)")?;
                self.come_to_rest(StopCategory::Two)?;
                Err(RunnerError::Stopped { run: self.run.id.clone() })
            }
            Asked::Cut => {
                self.event(EventKind::Operator, "the operator cut the torque (category 0)")?;
                self.come_to_rest(StopCategory::Zero)?;
                Err(RunnerError::Stopped { run: self.run.id.clone() })
            }
        }
    }

    /// Asks for a stop and goes on ticking and recording until both axes are at rest; a second press of the switch cuts.
    fn come_to_rest(&mut self, category: StopCategory) -> Result<(), RunnerError> {
        let sample = self.rig.tick(Some(Request::Stop(category)))?;
        self.record(&sample)?;
        self.until_rest()
    }

    fn come_to_rest_for_recorder(&mut self) -> Result<(), RunnerError> {
        self.recorder_gone();
        self.rig.tick(Some(Request::RecorderFailed))?;
        self.until_rest()
    }

    /// What is recorded is closed by the recorder itself; nothing more goes there.
    fn recorder_gone(&mut self) {
        if let Some(mut recorder) = self.recorder.take() {
            "the disk took no more".clone_into(&mut recorder.meta_mut().note);
            // Its failure is what is being told.
            let _ = recorder.finish(RunStatus::Interrupted);
        }
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
            let sample = self.rig.tick(request)?;
            self.record(&sample)?;
            let is_at_rest = sample.axes.iter().all(|a| matches!(a.phase, Phase::Disabled | Phase::Holding));
            rest_ticks = if is_at_rest { rest_ticks + 1.0 } else { 0.0 };
            if rest_ticks >= 0.1 * self.rig.rate_hz() {
                break;
            }
        }
        Ok(())
    }

    fn begin_record(&mut self) -> Result<(), RunnerError> {
        let probe = self.tick(None)?;
        let run = self.run;
        let setting = self.setting;
        let rate_hz = self.rig.rate_hz() * self.rig.ticks_per_sample() as f64 / setting.decimation as f64;
        let meta = RunMeta {
            campaign: setting.campaign.clone(),
            id: run.id.clone(),
            kind: run.kind,
            set: run.set,
            pair: run.pair,
            repeat: run.pair,
            axis: run.axis,
            target_speed_m_s: run.speed_m_s(),
            direction: run.direction(),
            body: run.body,
            is_ballasted: run.is_ballasted,
            hung_weight_n: (run.kind == froude_records::run::RunKind::Calibration).then_some(run.hung_weight_n),
            rig: setting.constants.clone(),
            constants: IndexMap::new(),
            status: RunStatus::Running,
            note: String::new(),
            versions: IndexMap::from([
                ("froude".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
                ("board".to_owned(), self.rig.version()),
            ]),
            twin_seed: setting.twin_seed,
            clock: None,
            log_rate_hz: rate_hz,
            date: setting.date.clone(),
            start_unix_ns: setting.start_unix_ns,
        };
        let truths: &[(&str, &str)] = if probe.truth.is_some() { &TRUTHS } else { &[] };
        let layout = Layout::carriage(self.has_x(), probe.force_n.is_some(), truths)?;
        self.recorder = Some(Recorder::create(&setting.folder, meta, layout, Packing::Lz4)?);
        self.tick = None;
        Ok(())
    }

    fn event(&mut self, kind: EventKind, sentence: &str) -> Result<(), RunnerError> {
        if let Some(recorder) = &mut self.recorder {
            let tick = recorder.ticks();
            recorder.event(tick, &kind, sentence)?;
        }
        Ok(())
    }

    fn record(&mut self, sample: &Sample) -> Result<(), RecordError> {
        let first = *self.tick.get_or_insert(sample.tick);
        let number = sample.tick - first;
        if number.is_multiple_of(TOLD_EVERY) {
            self.progress.sample(
                self.run,
                sample,
                number as f64 / (self.rig.rate_hz() * self.rig.ticks_per_sample() as f64),
            );
        }
        let has_x = self.has_x();
        let Some(recorder) = &mut self.recorder else { return Ok(()) };
        if !number.is_multiple_of(self.setting.decimation) {
            return Ok(());
        }
        let axis = |i: usize| {
            let a = &sample.axes[i];
            let fault = sample.fault.filter(|&(_, on)| usize::from(on) == i || usize::from(on) >= sample.axes.len());
            AxisSample {
                encoder: a.count,
                position_m: a.position_m,
                reference_position_m: a.reference_m,
                reference_velocity_m_s: a.reference_m_s,
                reference_acceleration_m_s2: a.reference_m_s2,
                command_v: a.command_v,
                current_a: a.current_a,
                state: a.phase as u8,
                fault: fault.map_or(0, |(f, _)| f as u8),
            }
        };
        let row = CarriageSample { y: axis(0), x: has_x.then(|| axis(1)), force_n: sample.force_n.unwrap_or(0.0) };
        let mut truths = [0.0; TRUTHS.len()];
        let n = match &sample.truth {
            Some([y, _]) => {
                truths = [y.load_position_m, y.load_speed_m_s, y.drag_n, y.spring_n];
                truths.len()
            }
            None => 0,
        };
        row.row(sample.force_n.is_some(), &truths[..n], &mut self.row);
        recorder.record(number / self.setting.decimation, &self.row)
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

/// Ticks between two words to whoever watches: thirty a second.
const TOLD_EVERY: u64 = 133;

/// What only the twin knows, for tests and for looking on; no identification reads it.
const TRUTHS: [(&str, &str); 4] =
    [("truth/y/load_position", "m"), ("truth/y/load_velocity", "m/s"), ("truth/y/drag", "N"), ("truth/y/spring", "N")];
