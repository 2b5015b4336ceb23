//! Drives and records one run after the other.
//!
//! A run is: go to its start, wait for the water, record the still rig, record the motion, record the still rig again. What ends it
//! early is told apart and kept: the operator (category 2), a fault of the controller (its own category), a recorder that can
//! write no more (category 1), a rig that no longer answers (its own watchdog). Whatever was recorded by then stays, marked
//! `interrupted` or `faulted`; a resumed campaign does that run again.

use std::path::{Path, PathBuf};

use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::{Phase, Refusal};
use froude_records::RecordError;
use froude_records::run::{
    AxisConstants, AxisSample, BodyState, CampaignMark, CarriageSample, ClockAlignment, EventKind, Layout, Packing,
    Pair, Recorder, RunMeta, RunStatus, check_pair,
};
use indexmap::IndexMap;

use froude_records::carriage::CarriagePlan;

use super::plan::{Drive, JOG_S, OperatorStep, PlannedRun, Step};
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
    /// SHA-256 of the campaign's file, hexadecimal; empty where there is none.
    pub campaign_sha256: String,
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
    rig: &mut dyn Rig,
    switch: &StopSwitch,
    operator: &mut dyn Operator,
    progress: &mut dyn Progress,
    enough: &mut Enough<'_>,
) -> Result<Outcome, RunnerError> {
    let total = steps.iter().filter(|s| matches!(s, Step::Run(_))).count();
    let mut outcome = Outcome { driven: 0, resumed: 0, spared: 0, enough: None };
    let mut mounted: Option<OperatorStep> = None;
    let mut is_prepared = false;
    let mut is_said = false;
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
        if let Some(is_compared) = is_complete(setting, &run.id, progress)? {
            outcome.resumed += 1;
            if !(is_compared || std::mem::replace(&mut is_said, true)) {
                progress.say(
                    "runs of an earlier version lie there: they carry no SHA-256 of their logs, so that only the logs' own checksums vouch for \
                     them",
                );
            }
            // What was known then is known now: a campaign that had stopped stays stopped.
            let known = enough(&setting.folder.join(format!("{}.mcap", run.id)), run);
            outcome.enough = outcome.enough.or(known);
            continue;
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
        let path = session.drive_run()?;
        outcome.driven += 1;
        if let Some(why) = enough(&path, run) {
            progress.say(&why);
            outcome.enough = Some(why);
        }
    }
    Ok(outcome)
}

/// Whether a run lies there complete, and then whether its log was compared with its hash; what is no complete run is put aside.
fn is_complete(setting: &Setting, id: &str, progress: &mut dyn Progress) -> Result<Option<bool>, RunnerError> {
    let folder = &setting.folder;
    let campaign = CampaignMark { name: &setting.campaign, sha256: &setting.campaign_sha256 };
    let failed = |e: RecordError| RunnerError::Folder { path: folder.clone(), reason: e.to_string() };
    match check_pair(folder, id, campaign).map_err(failed)? {
        Pair::Absent => return Ok(None),
        Pair::Complete { is_compared, .. } => return Ok(Some(is_compared)),
        Pair::Again { reason } => progress.say(&format!("{reason}: {id} is put aside and driven again")),
    }
    let is_free = |name: &String| ["mcap", "toml"].iter().all(|e| !folder.join(format!("{name}.{e}")).exists());
    let aside = (1..10_000).map(|n| format!("{id}.interrupted-{n}")).find(is_free);
    if let Some(aside) = aside {
        for extension in ["mcap", "toml"] {
            let from = folder.join(format!("{id}.{extension}"));
            if from.exists() {
                std::fs::rename(&from, folder.join(format!("{aside}.{extension}")))
                    .map_err(|e| RunnerError::Folder { path: from, reason: e.to_string() })?;
            }
        }
    }
    Ok(None)
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

    /// The whole run; the record is closed whatever happens.
    fn drive_run(mut self) -> Result<PathBuf, RunnerError> {
        self.approach()?;
        self.wait(self.run.settle_s)?;
        self.begin_record()?;
        let driven = self.motion();
        let status = driven.as_ref().map_or_else(RunnerError::status, |()| RunStatus::Complete);
        if let (Some(recorder), Err(error)) = (&mut self.recorder, &driven) {
            recorder.meta_mut().note = error.to_string();
        }
        self.align_clock();
        let path = self.recorder.take().map(|r| r.finish(status)).transpose();
        driven?;
        Ok(path?.unwrap_or_default())
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

    /// Still, motion, still.
    fn motion(&mut self) -> Result<(), RunnerError> {
        let still_s = self.setting.asked.still_s;
        self.wait(still_s)?;
        self.event(EventKind::Phase, "the motion begins")?;
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
        self.event(EventKind::Phase, "the motion has ended")?;
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
            campaign_sha256: setting.campaign_sha256.clone(),
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
            log: None,
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

/// Ticks between two words to whoever watches: thirty a second.
const TOLD_EVERY: u64 = 133;

/// What only the twin knows, for tests and for looking on; no identification reads it.
const TRUTHS: [(&str, &str); 4] =
    [("truth/y/load_position", "m"), ("truth/y/load_velocity", "m/s"), ("truth/y/drag", "N"), ("truth/y/spring", "N")];
