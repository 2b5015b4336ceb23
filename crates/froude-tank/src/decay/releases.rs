//! The twin of a campaign's releases: the logs and sidecars that it would give for chosen true coefficients.
//!
//! Inertia and restoring force are drawn once for the campaign, about what is declared. Each release has a zero of its own.

use crate::decay::axis::Motion;
use crate::names::FREE_DECAY;
use froude_identify::method::{Export, MethodError};
use froude_records::campaign::{Campaign, SensorSpec, Truth};
use froude_records::run::Role;
use froude_rig::decay::{DecayRig, DecaySensor, Release};

use super::record::LAW;
use super::run::{DecayRun, DecaySetup, Restoring};
use super::section::DecayPlan;
use crate::error::undeclared;
use crate::sensors::{Senses, seed_and_sensors};
use crate::twin::{self, Column, Draws, seed_of};

/// Standard deviation of the zero of a release, as part of its displacement.
const ZERO: f64 = 0.02;

/// One planned release.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Its name.
    pub id: String,
    /// What is mounted; empty where the campaign does not say.
    pub configuration: String,
    /// How it is released.
    pub release: Release,
    /// Samples a second.
    pub rate_hz: f64,
}

/// A release that owns its columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Logged {
    /// See [`DecayRun::id`].
    pub id: String,
    /// See [`DecayRun::time_s`].
    pub time_s: Vec<f64>,
    /// See [`DecayRun::position`].
    pub position: Vec<f64>,
}

impl Logged {
    /// The release as the reduction takes it.
    #[must_use]
    pub fn view(&self) -> DecayRun<'_> {
        DecayRun { id: &self.id, time_s: &self.time_s, position: &self.position }
    }
}

/// The run matrix of a plan.
#[must_use]
pub fn planned(blocks: &[DecayPlan]) -> Vec<Planned> {
    let mut out = Vec::new();
    for block in blocks {
        for &displacement in &block.displacement {
            for _ in 0..block.repeats {
                out.push(Planned {
                    id: format!("{:03}", out.len() + 1),
                    configuration: block.configuration.clone(),
                    release: Release { displacement, held_s: block.held_s, free_s: block.free_s },
                    rate_hz: block.rate_hz,
                });
            }
        }
    }
    out
}

/// A, D_I and D_II of `[simulate.coefficients]`.
///
/// # Errors
///
/// No `[simulate]`, a record or another law instead of them, one that is not stated.
pub fn truth_of(campaign: &Campaign, axis: Motion) -> Result<[f64; 3], MethodError> {
    let place = campaign.path.display();
    let names = axis.decay_names();
    let all = names.join(", ");
    let Some(simulate) = &campaign.simulate else {
        let what = format!(
            "a twin needs [simulate] with seed, model = \"{LAW}\" and the true {all} in [simulate.coefficients]"
        );
        return Err(undeclared(&place, what));
    };
    let Truth::Coefficients { model, values } = &simulate.truth else {
        let what =
            format!("the twin of a free decay takes its truth from [simulate.coefficients] ({all}), not from a record");
        return Err(undeclared(&place, what));
    };
    if model != LAW {
        let what =
            format!("the truth of a free decay is model = \"{LAW}\" with {all}, and [simulate] states {model:?}");
        return Err(undeclared(&place, what));
    }
    let mut out = [0.0; 3];
    for (out, name) in out.iter_mut().zip(&names) {
        let missing = || undeclared("[simulate.coefficients]", format!("{name} is missing; the truth needs {all}"));
        *out = values.get(name).copied().ok_or_else(missing)?;
    }
    Ok(out)
}

const fn names(axis: Motion) -> &'static [&'static str] {
    if axis.is_rotation() { &["angle", "phi"] } else { &["position", "displacement"] }
}

/// What the twin has: the position.
pub(super) fn senses(axis: Motion) -> [Senses<'static>; 1] {
    [Senses::with_memory(names(axis).iter().copied())]
}

/// The sensor of the position among those of `[[simulate.sensor]]`.
pub(super) fn sensor_of(sensors: &[SensorSpec], axis: Motion) -> Option<&SensorSpec> {
    sensors.iter().find(|s| names(axis).contains(&s.quantity.as_str()))
}

/// The logs of all planned releases; the same seed gives the same logs.
#[must_use]
pub fn simulated(
    planned: &[Planned],
    setup: &DecaySetup,
    [added, linear, quadratic]: [f64; 3],
    sensors: &[SensorSpec],
    seed: u64,
) -> Vec<Logged> {
    let mut draws = Draws::of(seed);
    let inertia = draws.about(setup.inertia);
    let stiffness = match setup.restoring {
        Restoring::Spring(c) => draws.about(c),
        Restoring::Buoyancy { force_n, radius_m } => draws.about(force_n) * draws.about(radius_m),
    };
    let sensor = sensor_of(sensors, setup.axis);
    let of = |part: Option<f64>| part.unwrap_or(0.0);
    let one = |(i, run): (usize, &Planned)| {
        let rig = DecayRig {
            inertia,
            added,
            linear,
            quadratic,
            stiffness,
            is_pendulum: setup.restoring.is_pendulum(),
            coulomb: 0.0,
            rest: of(sensor.and_then(|s| s.bias)) + ZERO * run.release.displacement * draws.normal(),
        };
        let sensor = DecaySensor {
            rate_hz: run.rate_hz,
            noise: of(sensor.and_then(|s| s.noise)),
            correlation_s: sensor.and_then(|s| s.correlation_s),
            step: of(sensor.and_then(|s| s.resolution)),
            drift_per_s: 0.0,
        };
        let trace = rig.release(sensor, run.release, seed_of(seed, i));
        Logged { id: run.id.clone(), time_s: trace.time_s, position: trace.position }
    };
    planned.iter().enumerate().map(one).collect()
}

/// The files of all planned releases: a log and its sidecar each.
///
/// # Errors
///
/// What the campaign does not declare.
pub fn files(campaign: &Campaign, blocks: &[DecayPlan], setup: &DecaySetup) -> Result<Vec<Export>, MethodError> {
    let truth = truth_of(campaign, setup.axis)?;
    let planned = planned(blocks);
    let (seed, sensors) = seed_and_sensors(campaign, &senses(setup.axis))?;
    let logs = simulated(&planned, setup, truth, sensors, seed);
    Ok(planned.iter().zip(&logs).flat_map(|(run, log)| files_of(run, log, setup.axis)).collect())
}

/// Name of the column that moves, with its unit.
const fn column(axis: Motion) -> [&'static str; 2] {
    if axis.is_rotation() { ["angle", "rad"] } else { ["position", "m"] }
}

fn files_of(run: &Planned, log: &Logged, axis: Motion) -> [Export; 2] {
    let [name, unit] = column(axis);
    let logged = twin::Logged {
        id: &run.id,
        said: "A release of the twin.",
        method: FREE_DECAY,
        role: Role::Decay,
        configuration: &run.configuration,
        conditions: &[],
        time: ("time", &log.time_s),
        columns: &[Column { described: [name, name, unit, "sensor", ""], places: 8, values: &log.position }],
    };
    logged.files()
}
