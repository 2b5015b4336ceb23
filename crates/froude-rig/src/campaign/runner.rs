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

pub(crate) mod error;
pub(crate) mod session;
pub(crate) mod setting;

use std::path::{Path, PathBuf};

use crate::carriage::plan::{OperatorStep, PlannedRun, Step};
use froude_records::block::{Block, facts};
use froude_records::outcome::{Exit, Outcome};
use froude_records::run::{EventKind, RunStatus};
use froude_records::text::counted;

use super::hand_over::{Helm, hand_over};
use super::recording::{Recording, RigFacts};
use super::resume::{Found, look};
use super::rig_thread;
use super::stop::StopSwitch;
use crate::campaign::order::{Ended, Entry, Order};
use crate::campaign::runner::setting::SHOWN_EVERY;
use crate::drive::{Rig, Sample};

pub use crate::campaign::runner::setting::Setting;
pub use error::RunnerError;

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

/// What is known after a run.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Known {
    /// Where the estimate stands, in words.
    pub said: Option<String>,
    /// Why the campaign may stop; `None` where it goes on.
    pub enough: Option<String>,
}

/// Asked after a run, driven now or there already.
pub type Look<'a> = dyn FnMut(&Path, &PlannedRun) -> Known + 'a;

/// How a campaign ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Driven {
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

impl Driven {
    /// An error where a run's planned motion was not done.
    ///
    /// # Errors
    ///
    /// [`RunnerError::Cut`].
    pub fn whole(&self) -> Result<(), RunnerError> {
        if self.cut.is_empty() { Ok(()) } else { Err(RunnerError::Cut { runs: self.cut.clone() }) }
    }

    /// What is said of it; the runs lie in `folder`.
    #[must_use]
    pub fn outcome(&self, folder: &Path) -> Outcome {
        let f = facts("", "", self);
        let about = f.build(vec![
            f.text("folder", "", |_| folder.display().to_string()),
            f.count("driven", "", |d| d.driven),
            f.count("resumed", "", |d| d.resumed),
            f.count("spared", "", |d| d.spared),
            f.text("enough", "", |d| d.enough.clone()),
            f.texts("cut", "", |d| d.cut.clone()),
        ]);
        let mut said = vec![format!(
            "{} driven, {} already there, {} left out. Runs in {}",
            counted(self.driven, "run", "runs"),
            counted(self.resumed, "was", "were"),
            self.spared,
            folder.display()
        )];
        said.extend(self.enough.clone());
        let next = ["drag", "identify"].map(|verb| format!("Next: froude carriage {verb} {}", folder.display()));
        let exit = self.whole().map_or_else(|why| Exit::Failed(why.to_string()), |()| Exit::Done);
        let blocks = vec![about.into(), Block::text("", said), Block::text("", next.to_vec())];
        Outcome { blocks, exit, ..Outcome::default() }
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
    look_at: &mut Look<'_>,
) -> Result<Driven, RunnerError> {
    let facts = RigFacts::of(rig);
    let (pace, capacity) = rig_thread::pace(rig);
    let (helm, engine) = hand_over(pace, capacity);
    std::thread::scope(|scope| {
        let attend = move || rig_thread::attend(rig, engine, setting, switch);
        let thread = std::thread::Builder::new().name("rig".to_owned()).spawn_scoped(scope, attend);
        let thread = thread.map_err(|e| RunnerError::Thread { reason: e.to_string() })?;
        let driven = Campaign { steps, setting, helm, facts, switch, operator, progress }.drive(look_at);
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
    fn drive(mut self, look_at: &mut Look<'_>) -> Result<Driven, RunnerError> {
        let folder = &self.setting.folder;
        let total = self.steps.iter().filter(|s| matches!(s, Step::Run(_))).count();
        let mut outcome = Driven { driven: 0, resumed: 0, spared: 0, enough: None, cut: Vec::new() };
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
                    let known = look_at(&folder.join(format!("{}.mcap", run.id)), run);
                    outcome.enough = outcome.enough.or(known.enough);
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
            let known = look_at(&path, run);
            for line in known.said.iter().chain(&known.enough) {
                self.progress.say(line);
            }
            outcome.enough = outcome.enough.or(known.enough);
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
