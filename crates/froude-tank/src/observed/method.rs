//! What a method of single observations states, and what it does itself.

use froude_fit::budget::Uncertain;
use froude_identify::declare::{Key, Values};
use froude_identify::method::MethodError;
use froude_identify::uncertainty::SharedError;
use froude_records::block::{Digits, ResultColumn, Section, TableBuilder};
use froude_records::campaign::{Campaign, SensorSpec, Source};
use froude_records::finding::Finding;
use froude_records::run::Role;
use froude_records::run::step::Step;
use froude_records::units::Dimension;

use super::page;
use super::source::Reduced;
use super::twin::{Loads, Rig, Trace};
use crate::channel::Channel;
use crate::error::TankError;
use crate::log::TankLog;
use crate::logs;
use crate::matrix::Plan;
use crate::steady::point::Point as Observation;
use crate::steady::row::Row;
use crate::steady::window::Told;

pub use crate::matrix::Point;

/// A method as data.
#[derive(Debug, Clone, Copy)]
pub struct Spec {
    /// Name of the method and of its section.
    pub name: &'static str,
    /// In a message, with its article: `a drop`.
    pub called: &'static str,
    /// Roles of the runs that are read. Those of the role test are observed; a still run is not reduced.
    pub roles: &'static [Role],
    /// The keys of its section.
    pub keys: &'static [Key],
    /// What to write where there is no section; empty where all keys have defaults.
    pub missing: &'static str,
    /// The keys of a block of its plan: `configurations`, `repeats`, and an axis for each condition that is planned.
    pub plan: &'static [Key],
    /// What a log has, in words: `time and depth`.
    pub reads: &'static str,
    /// Conditions that a run states.
    pub conditions: &'static [Condition],
    /// Channels that a log may have.
    pub channels: &'static [Channel],
    /// Channels of the twin's sensors other than loads, and whether their noise may be correlated.
    pub senses: &'static [(&'static str, bool)],
    /// Loads that it observes.
    pub loads: &'static [&'static str],
    /// What a guessed sign of a channel costs, in words.
    pub guessed: &'static str,
    /// What the budget calls the error that the speed of each run has for itself.
    pub speed_error: &'static str,
}

impl Spec {
    /// Its plan: what is simulated is as long as its rig makes it.
    pub(super) const fn planned(&self) -> Plan {
        Plan { keys: self.plan, roles: ("", &[Role::Test]), asks: |_| (1, 0.0) }
    }

    /// Texts that fit most methods; the others have to be stated.
    pub const GENERAL: Self = Self {
        name: "",
        called: "",
        roles: &[Role::Test],
        keys: &[],
        missing: "",
        plan: &[],
        reads: "",
        conditions: &[],
        channels: &[],
        senses: &[],
        loads: &["f_x"],
        guessed: "drag is wrong by its size or its sign where one is guessed",
        speed_error: "errors of the speeds",
    };
}

/// A condition that a run is done in.
#[derive(Debug, Clone, Copy)]
pub struct Condition {
    /// In `[conditions]`, and as a key of the plan.
    pub name: &'static str,
    /// Of its value.
    pub dimension: Dimension,
    /// Key and head of its column in the plan: `weight_n`, `weight [N]`.
    pub column: [&'static str; 2],
    /// Of its column.
    pub digits: Digits,
    /// What holds where a run states none.
    pub otherwise: Unstated,
}

/// What holds where a run does not state a condition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unstated {
    /// This value, SI.
    Is(f64),
    /// The run is refused with what to write.
    Refused(&'static str),
    /// It has none; another channel may tell it, or nobody needs it.
    Nothing,
}

/// The angle of attack, whose loads lie along the axes of the body.
pub const ANGLE: Condition = Condition {
    name: "angle",
    dimension: Dimension::ONE,
    column: ["angle_rad", "angle [deg]"],
    digits: Digits::Plain(4),
    otherwise: Unstated::Is(0.0),
};

/// A log as a method takes it: columns of one length, time increasing.
#[derive(Debug, Clone)]
pub struct Run<'a> {
    /// What it is.
    pub point: Point,
    /// Time, s.
    pub time_s: &'a [f64],
    /// Channels that [`Observed::takes`] names.
    pub channels: Vec<(&'a str, &'a [f64])>,
    /// What its sidecar declares of its parts.
    pub told: Told<'a>,
}

impl<'a> Run<'a> {
    /// A channel; empty where the run has none of this name.
    #[must_use]
    pub fn channel(&self, name: &str) -> &'a [f64] {
        self.channels.iter().find(|(own, _)| *own == name).map_or(&[], |(_, values)| values)
    }

    /// That it cannot be reduced, and what to do; the message starts with its name.
    pub fn refused(&self, what: impl Into<String>) -> TankError {
        TankError::of_run(&self.point.id, what)
    }
}

/// A number that is declared, and that errs for all runs alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    /// In words, as the budget calls it: `scale of the picture`.
    pub name: &'static str,
    /// As declared.
    pub known: Option<Uncertain>,
    /// Its value where nothing is declared.
    pub otherwise: f64,
}

/// What a standard uncertainty of a declared number moves an observation by.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Moves {
    /// Its speed, m/s.
    pub speed_m_s: f64,
    /// Its loads, N.
    pub loads_n: Vec<f64>,
}

/// What a method is declared in.
#[derive(Debug, Clone, Copy)]
pub struct Declared<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// The source.
    pub source: &'a Source,
    /// Its section.
    pub values: &'a Values,
}

/// A method of single observations, as a campaign declares it.
pub trait Observed: Clone + std::fmt::Debug + Send + Sync + 'static {
    /// What it is.
    const SPEC: Spec;

    /// What the reduction of a run tells beside its observation, for page and findings.
    type Found: Clone + std::fmt::Debug + Send + Sync;

    /// From its section.
    ///
    /// # Errors
    ///
    /// What is missing or contradicts itself, and what to write.
    fn read(declared: &Declared<'_>) -> Result<Self, MethodError>;

    /// Its constants, in the order in which the twin draws them.
    fn constants(&self) -> Vec<Constant> {
        Vec::new()
    }

    /// The observation of a run; `constants` belong to [`Self::constants`].
    ///
    /// # Errors
    ///
    /// Why it gives none, and what to do.
    fn reduce(&self, run: &Run<'_>, constants: &[f64]) -> Result<(Observation, Self::Found), TankError>;

    /// The speed that a planned run is observed at, m/s, by the loads of the true law.
    ///
    /// # Errors
    ///
    /// That there is none, and what to plan.
    fn speed(&self, run: &Point, loads: &Loads<'_>) -> Result<f64, String>;

    /// What the rig would log of a planned run.
    fn twin(&self, run: &Point, rig: &mut Rig<'_>) -> Trace;

    /// The channels that a log is read by; it needs all of them.
    ///
    /// # Errors
    ///
    /// What it lacks, and what to do.
    fn takes(&self, _log: &TankLog) -> Result<Vec<&'static Channel>, String> {
        Ok(Self::SPEC.channels.iter().collect())
    }

    /// The same method with what runs tell about other runs.
    ///
    /// # Errors
    ///
    /// A run that does not tell it, and what to do.
    fn beside(self, _logs: &[TankLog]) -> Result<Self, MethodError> {
        Ok(self)
    }

    /// Corrects the observations by runs of other roles; what their errors do, and what was found.
    ///
    /// # Errors
    ///
    /// An observation that cannot be corrected.
    fn corrected(
        &self,
        _rows: &mut [Row],
        _others: &[Reduced<Self>],
        _source: &str,
    ) -> Result<(Vec<SharedError>, Vec<Finding>), TankError> {
        Ok((Vec::new(), Vec::new()))
    }

    /// The same method where runs are planned only: what it reads of the errors in a log is what these sensors have.
    #[must_use]
    fn planned(&self, _sensors: &[SensorSpec]) -> Self {
        self.clone()
    }

    /// Standard uncertainty of the speed of a run by its own errors, m/s.
    fn speed_standard_m_s(&self, _found: &Self::Found) -> f64 {
        0.0
    }

    /// Variance of a load by the noise of `sensors` in a planned run, without what the speed does to it; `None` where repeated runs of the twin are to tell both.
    fn variance(&self, _run: &Reduced<Self>, _load: &str, _sensors: &[SensorSpec]) -> Option<f64> {
        None
    }

    /// Names of the errors that all runs share.
    fn errors(&self) -> Vec<&'static str> {
        self.constants().iter().map(|constant| constant.name).collect()
    }

    /// What each of [`Self::errors`] moves the observation of a run by: half of the difference between its reductions with the constant one standard
    /// uncertainty larger and smaller (GUM, 5.1.3).
    ///
    /// # Errors
    ///
    /// As [`Self::reduce`].
    fn moves(&self, run: &Run<'_>, found: &Observation, _: &Self::Found) -> Result<Vec<Moves>, TankError> {
        let constants = self.constants();
        let values = values(&constants);
        let one = |(k, constant): (usize, &Constant)| {
            let standard = constant.known.map_or(0.0, |known| known.standard);
            if standard <= 0.0 {
                return Ok(Moves { speed_m_s: 0.0, loads_n: vec![0.0; found.loads.len()] });
            }
            let at = |by: f64| {
                let mut moved = values.clone();
                moved[k] += by;
                self.reduce(run, &moved).map(|(found, _)| found)
            };
            let (high, low) = (at(standard)?, at(-standard)?);
            let loads = high.loads.iter().zip(&low.loads);
            Ok(Moves {
                speed_m_s: 0.5 * (high.speed_m_s - low.speed_m_s),
                loads_n: loads.map(|(high, low)| 0.5 * (high.value - low.value)).collect(),
            })
        };
        constants.iter().enumerate().map(one).collect()
    }

    /// What was done to a run, as a step of its file.
    fn step(&self, log: &TankLog, run: &Reduced<Self>) -> Step {
        logs::window_step(log, &run.observation.window.steady, "").with("speed", run.observation.speed_m_s, "m/s")
    }

    /// What a run shows.
    fn about_run(&self, _log: &TankLog, _run: &Run<'_>, _found: &Reduced<Self>) -> Vec<Finding> {
        Vec::new()
    }

    /// Columns of the run matrix behind the conditions.
    fn columns<'r>(&self, t: &TableBuilder<'r, Planned<'r, Self>>) -> Vec<ResultColumn> {
        vec![t.number("duration_s", "duration [s]", |row| row.duration_s).places(1)]
    }

    /// What the plan says of its runs, behind their number and time: `over 2 m of way, …`.
    fn about_plan(&self, _runs: &[Reduced<Self>]) -> String {
        "waits between them not counted".to_owned()
    }

    /// The part of the page about the runs; `rows` are their observations as they are fitted.
    fn section(&self, runs: &[Reduced<Self>], _rows: &[Row], _logs: &[TankLog]) -> Section {
        page::section(runs)
    }
}

/// A planned run as its row of the plan sees it.
#[derive(Debug, Clone)]
pub struct Planned<'r, M: Observed> {
    /// As it would be reduced.
    pub run: &'r Reduced<M>,
    /// The speed that it would come to, m/s.
    pub speed_m_s: f64,
    /// Length of its log, s.
    pub duration_s: f64,
}

/// Values of constants where nothing is drawn.
pub(super) fn values(constants: &[Constant]) -> Vec<f64> {
    constants.iter().map(|c| c.known.map_or(c.otherwise, |known| known.value)).collect()
}
