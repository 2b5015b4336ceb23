//! What a method of single observations does itself.

use froude_identify::declare::Values;
use froude_identify::method::MethodError;
use froude_identify::uncertainty::SharedError;
use froude_records::block::{ResultColumn, Section, TableBuilder};
use froude_records::campaign::{Campaign, SensorSpec, Source};
use froude_records::finding::Finding;
use froude_records::run::step::Step;

use super::page;
use super::reduced::{Planned, Reduced};
use super::rig::{Loads, Rig, Trace};
use super::spec::{Constant, Moves, Point, Run, Spec, values};
use crate::channel::Channel;
use crate::error::TankError;
use crate::log::TankLog;
use crate::logs;
use crate::steady::point::Point as Observation;
use crate::steady::row::Row;

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
        _others: &[Reduced<Self::Found>],
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

    /// Variance of a load by the noise of `sensors` in a planned run, without what the speed does to it; `None` if both are to be estimated from repeated runs of the twin.
    fn variance(&self, _run: &Reduced<Self::Found>, _load: &str, _sensors: &[SensorSpec]) -> Option<f64> {
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

    /// How long a planned run takes, s, by its log that lasts `logged_s`.
    fn duration_s(&self, _run: &Point, logged_s: f64) -> f64 {
        logged_s
    }

    /// What was done to a run, as a step of its file.
    fn step(&self, log: &TankLog, run: &Reduced<Self::Found>) -> Step {
        logs::window_step(log, &run.observation.window.steady, "").with("speed", run.observation.speed_m_s, "m/s")
    }

    /// What a run shows.
    fn about_run(&self, _log: &TankLog, _run: &Run<'_>, _found: &Reduced<Self::Found>) -> Vec<Finding> {
        Vec::new()
    }

    /// Columns of the run matrix behind the conditions.
    fn columns<'r>(&self, t: &TableBuilder<'r, Planned<'r, Self::Found>>) -> Vec<ResultColumn> {
        vec![t.number("duration_s", "duration [s]", |row| row.duration_s).places(1)]
    }

    /// What the plan says of its runs, behind their number and time: `over 2 m of way, …`.
    fn about_plan(&self, _runs: &[Reduced<Self::Found>]) -> String {
        "waits between them not counted".to_owned()
    }

    /// The part of the page about the runs; `rows` are their observations as they are fitted.
    fn section(&self, runs: &[Reduced<Self::Found>], _rows: &[Row], _logs: &[TankLog]) -> Section {
        page::section(Self::SPEC.conditions, runs)
    }
}
