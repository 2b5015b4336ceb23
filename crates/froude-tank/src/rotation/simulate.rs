//! The twin of a campaign's rotation: the logs and sidecars that it would give for chosen true coefficients.
//!
//! What is declared with an uncertainty is drawn once for the campaign, about what is declared: inertias, restoring moment, delay, the gains of angle and torque.
//! Inertia, restoring moment and delay are what `[simulate.coefficients]` states, where it does. Each run has a zero of its own.

use froude_fit::budget::Uncertain;
use froude_identify::method::{Export, MethodError};
use froude_records::campaign::{Campaign, SensorSpec, Source, Truth};
use froude_records::run::{ROTATION, Role};
use froude_rig::rotation::{Lambdas, Mounted, RotationRig};
use froude_rig::swung::{Swing, SwungSensor, SwungTrace};

use super::fit::{INERTIA, LAMBDAS, RESTORING, RESTORING_IN_AIR, TARES, no_inertia};
use super::section::{self, RotationPlan, setup_of};
use super::setup::{RotationRun, Setup};
use crate::error::undeclared;
use crate::joint::DELAY;
use crate::sensors::{Senses, seed_and_sensors, swung};
use crate::twin::{Draws, Sidecar, csv, pair, seed_of, true_value};

/// Natural frequency of the twin's servo, rad/s, and its damping ratio: a joint module that overshoots a little.
const SERVO: (f64, f64) = (30.0, 0.6);
/// Standard deviation of the zero of a run, N m.
const ZERO_N_M: f64 = 0.02;

/// What the twin has: torque and angle.
pub(super) fn senses() -> [Senses<'static>; 2] {
    [Senses::with_memory(["torque"]), Senses::white("angle")]
}

/// One planned run.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Its name.
    pub id: String,
    /// What hangs on the shaft.
    pub mounted: Mounted,
    /// How it turns.
    pub swing: Swing,
    /// Samples a second.
    pub rate_hz: f64,
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
    pub fn view(&self) -> RotationRun<'_> {
        RotationRun {
            id: &self.planned.id,
            mounted: self.planned.mounted,
            time_s: &self.trace.time_s,
            angle_rad: &self.trace.angle_rad,
            torque_n_m: &self.trace.load,
        }
    }
}

/// What is mounted in runs of a role.
#[must_use]
pub fn mounted(role: Role) -> Mounted {
    match role {
        Role::DryAir => Mounted::BodyInAir,
        Role::Tare => Mounted::Shaft,
        _ => Mounted::Body,
    }
}

fn role(mounted: Mounted) -> Role {
    match mounted {
        Mounted::Body => Role::Test,
        Mounted::BodyInAir => Role::DryAir,
        Mounted::Shaft => Role::Tare,
    }
}

/// The run matrix of a plan.
#[must_use]
pub fn planned(blocks: &[RotationPlan]) -> Vec<Planned> {
    let mut out = Vec::new();
    for block in blocks {
        for swing in block.swings.each() {
            let id = format!("{:03}", out.len() + 1);
            out.push(Planned { id, mounted: mounted(block.role), swing, rate_hz: block.swings.rate_hz });
        }
    }
    out
}

/// What is true on the twin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truths {
    /// λ₁, λ₂, λ₃ of the body.
    pub lambdas: Lambdas,
    /// Those of the shaft.
    pub shaft: Lambdas,
    /// J that is stated, kg m².
    pub inertia_kg_m2: Option<f64>,
    /// K in water that is stated, N m.
    pub restoring_n_m: Option<f64>,
    /// K in air, N m.
    pub restoring_in_air_n_m: f64,
    /// The delay that is stated, s.
    pub delay_s: Option<f64>,
}

impl Truths {
    /// Of `[simulate]`.
    ///
    /// # Errors
    ///
    /// No `[simulate]`, a record instead of coefficients, a coefficient that is not stated.
    pub fn of(campaign: &Campaign, blocks: &[RotationPlan], setup: &Setup) -> Result<Self, MethodError> {
        let place = campaign.path.display();
        let values = match campaign.simulate.as_ref().map(|s| &s.truth) {
            Some(Truth::Coefficients { model, values }) if model == ROTATION => values,
            Some(_) => {
                let what = format!(
                    "the twin of {ROTATION} takes its truth from [simulate] model = \"{ROTATION}\" and [simulate.coefficients]: {}",
                    LAMBDAS.join(", ")
                );
                return Err(undeclared(place, what));
            }
            None => {
                let what = format!("a twin needs [simulate]: seed, model = \"{ROTATION}\", and the true coefficients");
                return Err(undeclared(place, what));
            }
        };
        let known = [LAMBDAS.as_slice(), &TARES, &[INERTIA, RESTORING, RESTORING_IN_AIR, DELAY]].concat();
        if let Some(other) = values.keys().find(|name| !known.contains(&name.as_str())) {
            let what = format!("{other} is none that a rotation has; it has {}", known.join(", "));
            return Err(undeclared("[simulate.coefficients]", what));
        }
        let need = |name: &str| true_value(values, name);
        let plans = |role: Role| blocks.iter().any(|block| block.role == role);
        let three = |names: [&str; 3]| -> Result<Lambdas, MethodError> {
            Ok([need(names[0])?, need(names[1])?, need(names[2])?])
        };
        let is_level = setup.restoring_n_m.is_some();
        match setup.inertia_kg_m2 {
            Some(_) => {}
            None if plans(Role::DryAir) => {
                need(INERTIA)?;
            }
            None => return Err(MethodError::refused(no_inertia())),
        }
        Ok(Self {
            lambdas: three(LAMBDAS)?,
            shaft: if plans(Role::Tare) || values.contains_key(TARES[0]) { three(TARES)? } else { [0.0; 3] },
            inertia_kg_m2: values.get(INERTIA).copied(),
            restoring_n_m: values.get(RESTORING).copied(),
            restoring_in_air_n_m: if is_level && plans(Role::DryAir) { need(RESTORING_IN_AIR)? } else { 0.0 },
            delay_s: values.get(DELAY).copied(),
        })
    }
}

/// The logs of all planned runs; the same seed gives the same logs.
///
/// `sensors` are those of `[[simulate.sensor]]`: `angle` and `torque`.
#[must_use]
pub fn simulated(
    planned: &[Planned],
    setup: &Setup,
    truth: &Truths,
    sensors: &[SensorSpec],
    seed: u64,
) -> Vec<Simulated> {
    let mut draws = Draws::of(seed);
    let mut about = |stated: Option<f64>, known: Option<Uncertain>| {
        let drawn = known.map_or(0.0, |k| draws.about(k));
        stated.unwrap_or(drawn)
    };
    let rig = RotationRig {
        inertia_kg_m2: about(truth.inertia_kg_m2, setup.inertia_kg_m2),
        shaft_inertia_kg_m2: about(None, setup.tare_inertia_kg_m2),
        lambdas: truth.lambdas,
        shaft: truth.shaft,
        restoring_n_m: about(truth.restoring_n_m, setup.restoring_n_m),
        restoring_in_air_n_m: truth.restoring_in_air_n_m,
        servo_rad_s: SERVO.0,
        servo_damping: SERVO.1,
    };
    let delay_s = about(truth.delay_s, setup.delay_s);
    let [angle_gain, torque_gain] = [setup.angle_relative, setup.torque_relative].map(|part| draws.gain(part));
    let zeros: Vec<f64> = planned.iter().map(|_| ZERO_N_M * draws.normal()).collect();
    let sensor = swung(sensors, &["angle"], &["torque"]);
    let one = |(i, run): (usize, &Planned)| {
        let sensor = SwungSensor { rate_hz: run.rate_hz, zero: zeros[i] + sensor.zero, delay_s, ..sensor };
        let trace = rig.turn(run.mounted, run.swing, sensor, seed_of(seed, i)).scaled(angle_gain, torque_gain);
        Simulated { planned: run.clone(), trace }
    };
    planned.iter().enumerate().map(one).collect()
}

/// The files of all planned runs of a source: a log and its sidecar each.
///
/// # Errors
///
/// What the campaign does not declare.
pub fn files(campaign: &Campaign, source: &Source) -> Result<Vec<Export>, MethodError> {
    let (setup, blocks) = (setup_of(campaign, source)?, section::plan(source)?);
    let truth = Truths::of(campaign, &blocks, &setup)?;
    let (seed, sensors) = seed_and_sensors(campaign, &senses())?;
    let runs = simulated(&planned(&blocks), &setup, &truth, sensors, seed);
    Ok(runs.iter().flat_map(|run| pair(&run.planned.id, log(&run.trace), sidecar(run))).collect())
}

fn log(trace: &SwungTrace) -> String {
    csv("time,theta,torque", &trace.time_s, &[(&trace.angle_rad, 8), (&trace.load, 8)])
}

fn sidecar(run: &Simulated) -> String {
    let sidecar = Sidecar {
        said: "A run of the twin.",
        method: ROTATION,
        role: role(run.planned.mounted).name(),
        configuration: "",
        conditions: &[],
        time: "time",
        columns: &[
            ["theta", "angle", "rad", "sensor", "   # positive about the body's z axis"],
            ["torque", "torque", "N m", "body", "    # of the rig on the body, about the same axis"],
        ],
        width: 6,
    };
    sidecar.text()
}
