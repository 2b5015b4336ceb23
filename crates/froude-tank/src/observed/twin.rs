//! The twin of a campaign's runs: the logs and sidecars that it would give for chosen true coefficients.
//!
//! Every declared constant is drawn once for the campaign about what is declared; a relative error of a load or the speed, and an error of the angle, that `[[source.uncertainty]]` states, once
//! for the campaign or for each run as the entry says. Each load of a run has a zero of its own.

use froude_fit::budget::Uncertain;
use froude_identify::method::{Export, MethodError};
use froude_identify::simulate::{planned, truth};
use froude_identify::source::check_budget;
use froude_records::campaign::{BudgetEntry, Campaign, PlanBlock, SensorSpec, Shared, Source};
use froude_records::units::Dimension;

use super::method::Observed;
use super::read::read;
use super::rig::{Loads, Rig, Trace};
use super::settings::Plan;
use super::spec::{ANGLE, Condition, Constant, Point, Run, values};
use crate::channel::Channel;
use crate::error::undeclared;
use crate::sensors::{Senses, reading, seed_and_sensors};
use crate::steady::window::Told;
use crate::twin::{Column, Draws, Logged, seed_of};

/// A run with its log.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// As it was planned.
    pub point: Point,
    /// What was logged.
    pub trace: Trace,
}

impl Simulated {
    /// The log as the reduction takes it.
    #[must_use]
    pub fn view(&self) -> Run<'_> {
        Run {
            point: self.point.clone(),
            time_s: &self.trace.time_s,
            channels: self.trace.columns.iter().map(|(name, values)| (name.as_str(), values.as_slice())).collect(),
            told: Told::default(),
        }
    }

    /// Length of the log, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.trace.time_s.last().copied().unwrap_or(0.0)
    }
}

/// A source's planned runs, the method, and the truth.
#[derive(Debug, Clone)]
pub struct Twin<M> {
    /// The method as it is declared.
    pub method: M,
    /// The runs.
    pub points: Vec<Point>,
    /// Their settings at the speeds that they are observed at, the law and its coefficients.
    pub plan: Plan,
}

impl<M: Observed> Twin<M> {
    /// Of a campaign.
    ///
    /// # Errors
    ///
    /// What the campaign does not declare; a law with loads that the method does not observe, a run without a speed.
    pub fn of(campaign: &Campaign, source: &Source) -> Result<Self, MethodError> {
        let points = M::SPEC.planned().points(source, M::SPEC.name)?;
        Self::with(campaign, source, read(campaign, source)?, points)
    }

    /// Of runs that are stated.
    ///
    /// # Errors
    ///
    /// As [`Self::of`].
    pub fn with(campaign: &Campaign, source: &Source, method: M, points: Vec<Point>) -> Result<Self, MethodError> {
        // If only the law gives the speed of a run, the law is read with a planned condition in place of the speed: both differ between the same runs.
        let instead = |point: &Point| {
            let others = M::SPEC.conditions.iter().filter(|condition| condition.name != ANGLE.name);
            let other = || others.clone().find_map(|condition| point.conditions.get(condition.name));
            point.conditions.get("speed").or_else(other).copied().unwrap_or(1.0)
        };
        let block = |point: &Point| PlanBlock {
            configurations: vec![point.configuration.clone()],
            speed_m_s: vec![instead(point)],
            angle_rad: vec![point.condition("angle")],
            pitch_rad: vec![0.0],
            repeats: 1,
        };
        let own = Source { plan: points.iter().map(block).collect(), ..source.clone() };
        let mut alone = campaign.clone();
        alone.sources = vec![own.clone()];
        let mut data = planned(&alone, &own)?;
        data.channels
            .retain(|name, _| !["f_x", "f_y"].contains(&name.as_str()) || M::SPEC.loads.contains(&name.as_str()));
        check_budget(source, &data)?;
        let (law, values) = truth(&alone, &data)?;
        if let Some(load) = law.responses.iter().find(|load| !M::SPEC.loads.contains(&load.as_str())) {
            let what = format!(
                "the law {} gives {load}, and {} observes {}: choose a law for that in [simulate] model",
                law.name,
                M::SPEC.called,
                M::SPEC.loads.join(" and ")
            );
            return Err(undeclared(campaign.path.display(), what));
        }
        let mut out = Self { method, points, plan: Plan { data, law, values, of_run: Vec::new() } };
        let speed = |(row, point): (usize, &Point)| {
            out.method.speed(point, &out.loads(row, 0.0)).map_err(|what| undeclared(&source.place, what))
        };
        let speeds = out.points.iter().enumerate().map(speed).collect::<Result<Vec<f64>, _>>()?;
        out.plan.data.put("speed", speeds, Dimension::SPEED);
        out.plan.data.velocity_from_speed_and_angle();
        Ok(out)
    }

    fn loads(&self, row: usize, off_rad: f64) -> Loads<'_> {
        Loads { plan: &self.plan, row, angle_rad: self.points[row].condition(ANGLE.name) + off_rad }
    }

    /// The speed that a run is observed at, m/s.
    pub(super) fn speed_m_s(&self, row: usize) -> f64 {
        self.plan.data.values("speed").map_or(0.0, |speeds| speeds[row])
    }

    /// What the twin has: the method's own channels, and the loads of the law that it reads.
    pub(super) fn senses(&self) -> Vec<Senses<'_>> {
        let sense = |(name, has_memory): &(&'static str, bool)| {
            if *has_memory { Senses::with_memory([*name]) } else { Senses::white(name) }
        };
        let read = self.plan.law.responses.iter().map(String::as_str).filter(|load| channel::<M>(load).is_some());
        M::SPEC.senses.iter().map(sense).chain([Senses::with_memory(read)]).collect()
    }

    /// The logs of all planned runs; the same seed gives the same logs. `sensors` are those of `[[simulate.sensor]]`, `budget` that of the source.
    #[must_use]
    pub fn simulated(&self, sensors: &[SensorSpec], budget: &[BudgetEntry], seed: u64) -> Vec<Simulated> {
        self.drawn(&self.method.constants(), sensors, budget, seed)
    }

    /// The same without errors of sensors and of what is declared.
    #[must_use]
    pub fn exactly(&self) -> Vec<Simulated> {
        self.noisy(&[], 0)
    }

    /// The same with the errors of sensors alone.
    pub(super) fn noisy(&self, sensors: &[SensorSpec], seed: u64) -> Vec<Simulated> {
        let exact = |c: Constant| Constant { known: c.known.map(|known| Uncertain::new(known.value, 0.0)), ..c };
        let constants: Vec<Constant> = self.method.constants().into_iter().map(exact).collect();
        self.drawn(&constants, sensors, &[], seed)
    }

    fn drawn(
        &self,
        constants: &[Constant],
        sensors: &[SensorSpec],
        budget: &[BudgetEntry],
        seed: u64,
    ) -> Vec<Simulated> {
        let mut draws = Draws::of(seed);
        let mut drawn = values(constants);
        for (value, known) in drawn.iter_mut().zip(constants).filter_map(|(v, c)| Some((v, c.known?))) {
            *value = draws.about(known);
        }
        let common: Vec<f64> = budget.iter().map(|_| draws.normal()).collect();
        let mut out = Vec::new();
        for (row, point) in self.points.iter().enumerate() {
            let names = &self.plan.law.responses;
            let mut gains = vec![1.0; names.len()];
            let (mut stretch, mut off_rad) = (1.0, 0.0);
            for (entry, common) in budget.iter().zip(&common) {
                let z = if entry.shared == Shared::Campaign { *common } else { draws.normal() };
                let of_load = names.iter().position(|name| *name == entry.quantity);
                match (entry.quantity.as_str(), entry.relative, of_load) {
                    ("speed", true, _) => stretch *= 1.0 + entry.standard * z,
                    ("angle", false, _) => off_rad += entry.standard * z,
                    (_, true, Some(k)) => gains[k] *= 1.0 + entry.standard * z,
                    _ => {}
                }
            }
            let zero = |name: &str| channel::<M>(name).map_or(0.0, |channel| channel.zero);
            let each = names.iter().zip(&gains);
            let readings =
                each.map(|(name, gain)| reading(sensors, &[name], zero(name) * draws.normal(), *gain)).collect();
            let mut rig = Rig {
                constants: &drawn,
                speed_m_s: self.speed_m_s(row),
                loads: self.loads(row, off_rad),
                stretch,
                readings,
                sensors,
                draws: &mut draws,
                seed: seed_of(seed, row),
            };
            let trace = self.method.twin(point, &mut rig);
            out.push(Simulated { point: point.clone(), trace });
        }
        out
    }
}

/// A channel that logs of the method may have.
fn channel<M: Observed>(name: &str) -> Option<&'static Channel> {
    M::SPEC.channels.iter().find(|channel| channel.name == name)
}

/// The files of all planned runs of a source: a log and its sidecar each.
///
/// # Errors
///
/// What the campaign does not declare.
pub fn files<M: Observed>(campaign: &Campaign, source: &Source) -> Result<Vec<Export>, MethodError> {
    let twin = Twin::<M>::of(campaign, source)?;
    let (seed, sensors) = seed_and_sensors(campaign, &twin.senses())?;
    let runs = twin.simulated(sensors, &source.uncertainty, seed);
    Ok(runs.iter().flat_map(files_of::<M>).collect())
}

fn files_of<M: Observed>(run: &Simulated) -> [Export; 2] {
    let (spec, Simulated { point, trace }) = (M::SPEC, run);
    let columns: Vec<Column<'_>> =
        trace.columns.iter().filter_map(|(name, values)| Some(Column::of(channel::<M>(name)?, values))).collect();
    let condition = |condition: &Condition| {
        // What a log shows is not stated beside it.
        let is_logged = columns.iter().any(|column| column.described[1] == condition.name);
        let value = point.conditions.get(condition.name).filter(|_| !is_logged)?;
        Some(match condition.dimension {
            // Digits beyond those of an angle as it is declared are those of a conversion.
            Dimension::ONE => format!("{} = \"{} deg\"", condition.name, (value.to_degrees() * 1e9).round() / 1e9),
            dimension => format!("{} = \"{value} {dimension}\"", condition.name),
        })
    };
    let conditions: Vec<String> = spec.conditions.iter().filter_map(condition).collect();
    let run = Logged {
        id: &point.id,
        said: "A run of the twin.",
        method: spec.name,
        role: point.role,
        configuration: &point.configuration,
        conditions: &conditions,
        time: ("time", &trace.time_s),
        columns: &columns,
    };
    run.files()
}
