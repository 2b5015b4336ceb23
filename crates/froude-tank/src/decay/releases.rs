//! The twin of a campaign's releases: the logs and sidecars that it would give for chosen true coefficients.
//!
//! Inertia and restoring force are drawn once for the campaign, about what is declared. Each release has a zero of its own.

use crate::decay::axis::Motion;
use crate::names::FREE_DECAY;
use froude_identify::method::{Export, MethodError};
use froude_records::campaign::{Campaign, SensorSpec};
use froude_records::run::Role;
use froude_rig::decay::{DecayRig, DecaySensor};

use super::record::LAW;
use super::run::{DecayRun, DecaySetup, Restoring};
use super::section::release;
use crate::error::undeclared;
use crate::matrix::Point;
use crate::sensors::{Senses, reading, seed_and_sensors};
use crate::twin::{self, Column, Draws, seed_of, true_values, truths};

/// Standard deviation of the zero of a release, as part of its displacement.
const ZERO: f64 = 0.02;

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

/// A, D_I and D_II of `[simulate.coefficients]`.
///
/// # Errors
///
/// No `[simulate]`, a record or another law instead of them, one that is not stated.
pub fn truth_of(campaign: &Campaign, axis: Motion) -> Result<[f64; 3], MethodError> {
    let names = axis.decay_names();
    let (model, values) = truths(campaign, FREE_DECAY)?;
    if model != LAW {
        let all = names.join(", ");
        let what =
            format!("the truth of a free decay is model = \"{LAW}\" with {all}, and [simulate] states {model:?}");
        return Err(undeclared(campaign.path.display(), what));
    }
    true_values(values, names.each_ref().map(String::as_str))
}

/// Names of the position in `[[simulate.sensor]]`.
pub(super) const fn names(axis: Motion) -> &'static [&'static str] {
    if axis.is_rotation() { &["angle", "phi"] } else { &["position", "displacement"] }
}

/// What the twin has: the position.
pub(super) fn senses(axis: Motion) -> [Senses<'static>; 1] {
    [Senses::with_memory(names(axis).iter().copied())]
}

/// The logs of all planned releases; the same seed gives the same logs.
#[must_use]
pub fn simulated(
    points: &[Point],
    setup: &DecaySetup,
    truth: [f64; 3],
    sensors: &[SensorSpec],
    seed: u64,
) -> Vec<Logged> {
    drawn(points, setup, truth, (sensors, seed), Draws::of(seed))
}

/// The same without errors of sensors and of what is declared.
pub(super) fn exactly(points: &[Point], setup: &DecaySetup, truth: [f64; 3]) -> Vec<Logged> {
    drawn(points, setup, truth, (&[], 0), Draws::none())
}

fn drawn(
    points: &[Point],
    setup: &DecaySetup,
    [added, linear, quadratic]: [f64; 3],
    (sensors, seed): (&[SensorSpec], u64),
    mut draws: Draws,
) -> Vec<Logged> {
    let inertia = draws.about(setup.inertia);
    let stiffness = match setup.restoring {
        Restoring::Spring(c) => draws.about(c),
        Restoring::Buoyancy { force_n, radius_m } => draws.about(force_n) * draws.about(radius_m),
        // Nothing is planned of these.
        Restoring::PerInertia { omega2, .. } => omega2,
    };
    let of = reading(sensors, names(setup.axis), 0.0, 1.0);
    let one = |(i, point): (usize, &Point)| {
        let release = release(point);
        let rig = DecayRig {
            inertia,
            added,
            linear,
            quadratic,
            stiffness,
            is_pendulum: setup.restoring.is_pendulum(),
            coulomb: 0.0,
            rest: of.zero + ZERO * release.displacement * draws.normal(),
        };
        let sensor = DecaySensor {
            rate_hz: point.condition("rate"),
            noise: of.noise,
            correlation_s: of.correlation_s,
            step: of.step,
            drift_per_s: of.drift_per_s,
        };
        let trace = rig.release(sensor, release, seed_of(seed, i));
        Logged { id: point.id.clone(), time_s: trace.time_s, position: trace.position }
    };
    points.iter().enumerate().map(one).collect()
}

/// The files of all planned releases: a log and its sidecar each.
///
/// # Errors
///
/// What the campaign does not declare.
pub fn files(campaign: &Campaign, points: &[Point], setup: &DecaySetup) -> Result<Vec<Export>, MethodError> {
    let truth = truth_of(campaign, setup.axis)?;
    let (seed, sensors) = seed_and_sensors(campaign, &senses(setup.axis))?;
    let logs = simulated(points, setup, truth, sensors, seed);
    Ok(points.iter().zip(&logs).flat_map(|(point, log)| files_of(point, log, setup.axis)).collect())
}

/// Name of the column that moves, with its unit.
const fn column(axis: Motion) -> [&'static str; 2] {
    if axis.is_rotation() { ["angle", "rad"] } else { ["position", "m"] }
}

fn files_of(point: &Point, log: &Logged, axis: Motion) -> [Export; 2] {
    let [name, unit] = column(axis);
    let logged = twin::Logged {
        id: &point.id,
        said: "A release of the twin.",
        method: FREE_DECAY,
        role: Role::Decay,
        configuration: &point.configuration,
        conditions: &[],
        time: ("time", &log.time_s),
        columns: &[Column { described: [name, name, unit, "sensor", ""], places: 8, values: &log.position }],
    };
    logged.files()
}
