//! The twin of a campaign's runs: the logs and sidecars that it would give for chosen true coefficients.
//!
//! Every declared constant is drawn once for the campaign about what is declared, in the method's order; one whose truth is stated takes that. Each load of a run
//! has a zero of its own.

use froude_identify::method::{Export, MethodError};
use froude_identify::simulate::check_stated;
use froude_records::campaign::{Campaign, SensorSpec, Source};
use froude_records::run::Role;
use froude_rig::steady::Reading;
use froude_rig::swung::{SwungSensor, SwungTrace, log};
use indexmap::IndexMap;

use super::matrix::{Planned, planned};
use super::method::MotorDriven;
use super::read::setups;
use super::run::Run;
use super::setup::Setup;
use super::spec::{Channel, Condition, Constant, Enters, Factor, Point};
use super::still_fit::is_still;
use crate::error::{TankError, undeclared};
use crate::matrix::of_configurations;
use crate::sensors::{Senses, of_sensor, seed_and_sensors};
use crate::twin::{Column, Draws, Logged, seed_of, true_values, truths};

/// Natural frequency of the twin's servo, rad/s, and its damping ratio: a joint module that overshoots a little.
const SERVO: (f64, f64) = (30.0, 0.6);

/// What the twin has: loads and motion.
pub(super) fn senses<M: MotorDriven>() -> Vec<Senses<'static>> {
    let loads = M::SPEC.loads.iter().map(|load| Senses::with_memory(load.names()));
    loads.chain([Senses::white(M::SPEC.motion.name)]).collect()
}

/// What is true on the twin.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Of the coefficients; zero of one that no run looks for.
    pub coefficients: Vec<f64>,
    /// Of the constants, where it is stated.
    pub constants: Vec<Option<f64>>,
}

impl Truth {
    /// Of the coefficients of `[simulate]`, for the planned runs.
    ///
    /// # Errors
    ///
    /// A coefficient that the runs look for and that is not stated, a constant that nobody knows.
    pub fn of<M: MotorDriven>(
        values: &IndexMap<String, f64>,
        setup: &Setup<M>,
        points: &[&Point],
    ) -> Result<Self, MethodError> {
        let all = setup.method.coefficients();
        let name_of = |constant: &Constant| constant.unknown.as_ref().map(|unknown| unknown.name.clone());
        setup.check(points).map_err(MethodError::refused)?;
        let coefficients = all.iter().map(|c| {
            let is_needed = points.iter().any(|point| point.role == c.role);
            if is_needed {
                true_values(values, [&c.name]).map(|[value]| value)
            } else {
                Ok(values.get(&c.name).copied().unwrap_or(0.0))
            }
        });
        let constants = setup.constants.iter().map(|constant| {
            let stated = name_of(constant).and_then(|name| values.get(&name).copied());
            match constant.looked_for(points.iter().copied()) {
                Some(unknown) if constant.known.is_none() && constant.otherwise.is_err() => {
                    true_values(values, [&unknown.name]).map(|[value]| Some(value))
                }
                _ => Ok(stated),
            }
        });
        Ok(Self {
            coefficients: coefficients.collect::<Result<_, _>>()?,
            constants: constants.collect::<Result<_, _>>()?,
        })
    }

    /// The truth of an unknown of the fit.
    #[must_use]
    pub fn value<M: MotorDriven>(&self, name: &str, setup: &Setup<M>) -> f64 {
        let coefficient = setup.method.coefficients().iter().position(|c| c.name == name);
        let is_it = |c: &Constant| c.unknown.as_ref().is_some_and(|unknown| unknown.name == name);
        let constant = || setup.constants.iter().position(is_it);
        coefficient
            .map(|j| self.coefficients[j])
            .or_else(|| constant().map(|k| self.constants[k].unwrap_or_else(|| setup.values()[k])))
            .unwrap_or(0.0)
    }
}

/// A source's planned runs, the setup of the true law, and the truth.
pub struct Twin<M> {
    /// The runs.
    pub planned: Vec<Planned>,
    /// What is declared, with the true law.
    pub setup: Setup<M>,
    /// What is true.
    pub truth: Truth,
}

impl<M: MotorDriven> Twin<M> {
    /// Of a campaign.
    ///
    /// # Errors
    ///
    /// What the campaign does not declare; no `[simulate]`, or one with a record instead of coefficients.
    pub fn of(campaign: &Campaign, source: &Source) -> Result<Self, MethodError> {
        let spec = M::SPEC;
        let planned = planned::<M>(source)?;
        let (model, values) = truths(campaign, spec.name)?;
        let stated = campaign.simulate.as_ref().map_or(&[][..], |simulate| &simulate.stated);
        if !spec.law.is_empty() && model != spec.name {
            let what =
                format!("[simulate] has model = {model:?}; {} has one law: write model = {:?}", spec.called, spec.name);
            return Err(undeclared(campaign.path.display(), what));
        }
        let setup =
            setups::<M>(campaign, source, &of_configurations(planned.iter().map(|run| &run.point)), Some(model))?
                .remove(0);
        let all = setup.method.coefficients();
        let constants = setup.constants.iter().filter_map(|c| c.unknown.as_ref());
        let constants = constants.map(|unknown| (unknown.name.as_str(), unknown.unit));
        let own: Vec<(&str, &str)> = all.iter().map(|c| (c.name.as_str(), c.unit.as_str())).chain(constants).collect();
        check_stated(stated, model, &own, &setup.method.unused())?;
        let points: Vec<&Point> = planned.iter().map(|run| &run.point).collect();
        setup.method.check_runs(&points).map_err(|why| undeclared(&source.place, why.to_string()))?;
        let truth = Truth::of(values, &setup, &points)?;
        Ok(Self { planned, setup, truth })
    }

    /// The logs of all planned runs; the same seed gives the same logs. `sensors` are those of `[[simulate.sensor]]`.
    ///
    /// # Errors
    ///
    /// A law that cannot be evaluated.
    pub fn simulated(&self, sensors: &[SensorSpec], seed: u64) -> Result<Vec<Simulated>, TankError> {
        let mut draws = Draws::of(seed);
        let mut constants = self.setup.values();
        for ((value, constant), stated) in constants.iter_mut().zip(&self.setup.constants).zip(&self.truth.constants) {
            if let Some(known) = constant.known.filter(|_| constant.enters != Enters::Derived) {
                *value = draws.about(known);
            }
            *value = stated.unwrap_or(*value);
        }
        let loads = M::SPEC.loads;
        let read = |channel: &Channel, zero, gain| of_sensor(channel.sensor(sensors), zero, gain);
        let mut zeros: Vec<Vec<f64>> =
            self.planned.iter().map(|_| loads.iter().map(|load| load.zero * draws.normal()).collect()).collect();
        // The zero of still runs walks from run to run of a configuration.
        let drift = self.setup.zeroing.map_or(0.0, |zeroing| zeroing.drift);
        let mut last: IndexMap<&str, Vec<f64>> = IndexMap::new();
        for (zero, run) in zeros.iter_mut().zip(&self.planned).filter(|(_, run)| is_still(&run.point)) {
            if let Some(before) = last.get(run.point.configuration.as_str()) {
                zero.clone_from(before);
                zero.iter_mut().take(1).for_each(|zero| *zero += drift * draws.normal());
            }
            last.insert(&run.point.configuration, zero.clone());
        }
        let gain = |enters: Enters| self.setup.enters(|e| e == enters).map_or(1.0, |k| constants[k]);
        let delay_s = self.setup.enters(|e| e == Enters::Delay).map_or(0.0, |k| constants[k]);
        let one = |(i, run): (usize, &Planned)| {
            let motion = read(&M::SPEC.motion, 0.0, gain(Enters::Motion));
            let of_load = |(k, load): (usize, &Channel)| read(load, zeros[i][k], gain(Enters::Load(k)));
            let loads: Vec<Reading> = loads.iter().enumerate().map(of_load).collect();
            let sensor = SwungSensor { rate_hz: run.rate_hz, motion, loads, delay_s };
            let there = |motion: &[[f64; 3]]| self.loads(run, &constants, motion);
            let trace = log(run.swing, SERVO, &sensor, there, seed_of(seed, i))?;
            Ok(Simulated { planned: run.clone(), trace })
        };
        self.planned.iter().enumerate().map(one).collect()
    }

    /// The loads of a run without zeros at the samples of its motion.
    fn loads(&self, run: &Planned, constants: &[f64], motion: &[[f64; 3]]) -> Result<Vec<Vec<f64>>, TankError> {
        let all = self.setup.method.coefficients();
        let mut out = vec![vec![0.0; motion.len()]; M::SPEC.loads.len()];
        let mut add = |load: usize, factor: Factor, term: &[f64]| {
            let factor = match factor {
                Factor::Coefficient(j) => {
                    let of_run = all[j].varies.and_then(|group| run.of_drag.get(group));
                    of_run.unwrap_or(&1.0) * self.truth.coefficients[j]
                }
                Factor::Constant(k) => constants[k],
            };
            out[load].iter_mut().zip(term).for_each(|(y, x)| *y += factor * x);
        };
        self.setup.method.terms(&run.point, constants, motion, &mut add)?;
        Ok(out)
    }
}

/// A run with its log.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// As it was planned.
    pub planned: Planned,
    /// What was logged.
    pub trace: SwungTrace,
}

impl Simulated {
    /// The log as the reduction takes it.
    #[must_use]
    pub fn view(&self) -> Run<'_> {
        Run {
            id: &self.planned.id,
            point: self.planned.point.clone(),
            time_s: &self.trace.time_s,
            motion: &self.trace.motion,
            loads: self.trace.loads.iter().map(Vec::as_slice).collect(),
        }
    }
}

/// The files of all planned runs of a source: a log and its sidecar each.
///
/// # Errors
///
/// What the campaign does not declare.
pub fn files<M: MotorDriven>(campaign: &Campaign, source: &Source) -> Result<Vec<Export>, MethodError> {
    let twin = Twin::<M>::of(campaign, source)?;
    let (seed, sensors) = seed_and_sensors(campaign, &senses::<M>())?;
    let runs = twin.simulated(sensors, seed).map_err(MethodError::refused)?;
    Ok(runs.iter().flat_map(|run| files_of::<M>(&run.planned, &run.trace, "A run of the twin.")).collect())
}

/// The log and the sidecar of a run; `said` is a line for people at the head of the sidecar.
#[must_use]
pub fn files_of<M: MotorDriven>(run: &Planned, trace: &SwungTrace, said: &str) -> [Export; 2] {
    let (spec, point) = (M::SPEC, &run.point);
    let channels = std::iter::once(&spec.motion).chain(spec.loads);
    let values = std::iter::once(&trace.motion).chain(&trace.loads);
    let columns: Vec<Column<'_>> = channels.zip(values).map(|(channel, values)| Column::of(channel, values)).collect();
    let role = if spec.roles.1.contains(&point.role) { point.role } else { Role::Test };
    let condition = |condition: &Condition| {
        let value = point.conditions.get(condition.name)?;
        Some(format!("{} = \"{value} {}\"", condition.name, condition.unit))
    };
    let conditions: Vec<String> = spec.conditions.iter().filter_map(condition).collect();
    let logged = Logged {
        id: &run.id,
        said,
        method: spec.name,
        role,
        configuration: &point.configuration,
        conditions: &conditions,
        time: ("time", &trace.time_s),
        columns: &columns,
    };
    logged.files()
}
