//! The twin of a campaign's steady tows: the logs and sidecars that it would give for chosen true coefficients.
//!
//! What `[[source.uncertainty]]` declares is drawn about what is stated: gains of loads and speed and errors of the angle, once for the campaign or once
//! for each run as the entry says. Each run has zeros of its own.

use std::cell::RefCell;

use crate::names::STEADY;
use froude_identify::dataset::Dataset;
use froude_identify::law::ForceLaw;
use froude_identify::method::{Export, MethodError};
use froude_identify::simulate::{planned, truth};
use froude_records::campaign::{BudgetEntry, Campaign, SensorSpec, Shared, Source};
use froude_records::units::Dimension;
use froude_rig::steady::{Tow, TowTrace, tow as towed};

use super::point::Run;
use super::section;
use super::window::Motion;
use crate::sensors::{Senses, reading, seed_and_sensors};
use crate::twin::{Draws, Sidecar, csv, pair, seed_of};

/// Standard deviation of the zero of a run, N or N m.
const ZERO: f64 = 0.2;

/// A run with its log.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// Its name.
    pub id: String,
    /// What is mounted.
    pub configuration: String,
    /// The angle as it is stated, rad.
    pub angle_rad: f64,
    /// Names of the loads.
    pub loads: Vec<String>,
    /// What was logged.
    pub trace: TowTrace,
}

impl Simulated {
    /// The log as the reduction takes it.
    #[must_use]
    pub fn view(&self) -> Run<'_> {
        let loads = self.loads.iter().zip(&self.trace.loads_n);
        Run {
            id: &self.id,
            time_s: &self.trace.time_s,
            motion: Motion::Speed(&self.trace.speed_m_s),
            loads: loads.map(|(name, values)| (name.as_str(), values.as_slice())).collect(),
            zero: None,
        }
    }
}

/// The run matrix and the truth of a source.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Settings, a row per run.
    pub data: Dataset,
    /// The true law.
    pub law: ForceLaw,
    /// Its coefficients.
    pub values: Vec<f64>,
    /// Factor on the law's loads in each run \[-\], from a trip, the mount or the wake of the previous run. Empty without run-to-run variation.
    pub of_run: Vec<f64>,
}

/// Reads the plan of a source with its truth.
///
/// # Errors
///
/// A campaign without water or without truth.
pub fn plan_of(campaign: &Campaign, source: &Source) -> Result<Plan, MethodError> {
    let mut own = campaign.clone();
    let source = Source { plan: source.rows()?, ..source.clone() };
    let data = planned(&own, &source)?;
    own.sources = vec![source];
    let (law, values) = truth(&own, &data)?;
    Ok(Plan { data, law, values, of_run: Vec::new() })
}

/// Loads of the law in one row of settings at another speed and angle, N.
#[must_use]
pub fn loads_at(plan: &Plan, row: usize, speed_m_s: f64, angle_rad: f64) -> Vec<f64> {
    let mut at = plan.data.subset(&[row]);
    at.put("speed", vec![speed_m_s], Dimension::SPEED);
    at.put("angle", vec![angle_rad], Dimension::ONE);
    at.velocity_from_speed_and_angle();
    let loads = plan.law.predict(&at, &plan.values).unwrap_or_else(|_| vec![f64::NAN; plan.law.responses.len()]);
    let factor = plan.of_run.get(row).copied().unwrap_or(1.0);
    loads.into_iter().map(|f| factor * f).collect()
}

/// The logs of all planned runs; the same seed gives the same logs.
#[must_use]
pub fn simulated(plan: &Plan, tow: Tow, sensors: &[SensorSpec], budget: &[BudgetEntry], seed: u64) -> Vec<Simulated> {
    let mut draws = Draws::of(seed);
    let value = |name: &str, row: usize| plan.data.values(name).map_or(0.0, |v| v[row]);
    // One error of the campaign for each entry; those of runs are drawn as they come.
    let common: Vec<f64> = budget.iter().map(|_| draws.normal()).collect();
    let mut out = Vec::new();
    for row in 0..plan.data.rows {
        let mut gains = vec![1.0; 1 + plan.law.responses.len()];
        let mut angle_off = 0.0;
        for (entry, common) in budget.iter().zip(&common) {
            let z = if entry.shared == Shared::Campaign { *common } else { draws.normal() };
            let at = if entry.quantity == "speed" {
                Some(0)
            } else {
                plan.law.responses.iter().position(|r| *r == entry.quantity).map(|r| 1 + r)
            };
            if let (Some(k), true) = (at, entry.relative) {
                gains[k] *= 1.0 + entry.standard * z;
            } else if entry.quantity == "angle" && !entry.relative {
                angle_off += entry.standard * z;
            }
        }
        let mut readings = vec![reading(sensors, &["speed"], 0.0, gains[0])];
        for (l, name) in plan.law.responses.iter().enumerate() {
            readings.push(reading(sensors, &[name], ZERO * draws.normal(), gains[1 + l]));
        }
        let (speed, angle) = (value("speed", row), value("angle", row));
        let last: RefCell<Option<(f64, Vec<f64>)>> = RefCell::new(None);
        let loads = |speed: f64| {
            if let Some((at, loads)) = last.borrow().as_ref().filter(|(at, _)| *at == speed) {
                debug_assert!(*at == speed);
                return loads.clone();
            }
            let loads = loads_at(plan, row, speed, angle + angle_off);
            *last.borrow_mut() = Some((speed, loads.clone()));
            loads
        };
        out.push(Simulated {
            id: format!("{:03}", row + 1),
            configuration: plan.data.configuration[row].clone(),
            angle_rad: angle,
            loads: plan.law.responses.clone(),
            trace: towed(tow, speed, &readings, &loads, seed_of(seed, row)),
        });
    }
    out
}

/// What the twin has: the speed, and the loads of the law.
pub(super) fn senses(plan: &Plan) -> [Senses<'_>; 1] {
    [Senses::with_memory(plan.law.responses.iter().map(String::as_str).chain(["speed"]))]
}

/// The files of all planned runs of a source: a log and its sidecar each.
///
/// # Errors
///
/// What the campaign does not declare.
pub fn files(campaign: &Campaign, source: &Source) -> Result<Vec<Export>, MethodError> {
    let plan = plan_of(campaign, source)?;
    let (seed, sensors) = seed_and_sensors(campaign, &senses(&plan))?;
    let runs = simulated(&plan, section::declared(source)?.tow, sensors, &source.uncertainty, seed);
    Ok(runs.iter().flat_map(|run| pair(&run.id, log(run), sidecar(run))).collect())
}

fn log(run: &Simulated) -> String {
    let loads = run.trace.loads_n.iter().map(|load| (load.as_slice(), 6));
    let columns: Vec<(&[f64], usize)> = std::iter::once((run.trace.speed_m_s.as_slice(), 7)).chain(loads).collect();
    csv(&format!("time,speed,{}", run.loads.join(",")), &run.trace.time_s, &columns)
}

fn sidecar(run: &Simulated) -> String {
    let unit = |load: &str| if load.starts_with('m') { "N m" } else { "N" };
    let loads = run.loads.iter().map(|load| [load, load, unit(load), "body", ""]);
    let sidecar = Sidecar {
        said: "A run of the twin.",
        method: STEADY,
        role: "test",
        configuration: &run.configuration,
        conditions: &[format!("angle = \"{} deg\"", (run.angle_rad.to_degrees() * 1e9).round() / 1e9)],
        time: "time",
        columns: &std::iter::once(["speed", "speed", "m/s", "body", ""]).chain(loads).collect::<Vec<_>>(),
        width: 5,
    };
    sidecar.text()
}
