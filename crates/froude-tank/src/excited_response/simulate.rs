//! The twin of a campaign in waves: the logs and sidecars of held and free runs that it would give for chosen true coefficients.
//!
//! What is declared with an uncertainty is drawn once for the campaign, about what is declared: mass, restoring coefficient, delay, the gains of force and acceleration.

use std::f64::consts::TAU;

use crate::names::EXCITED_RESPONSE;
use froude_identify::method::{Export, MethodError};
use froude_records::campaign::{Campaign, SensorSpec, Source};
use froude_records::run::Role;
use froude_rig::excited_response::{WaveReadings, WaveRig, WaveTrace};
use froude_rig::steady::Reading;

use super::coefficients::NAMES;
use super::section::{self, setup_of};
use super::setup::{Setup, Shows, WaveRun};
use crate::matrix::Point;
use crate::sensors::{Senses, reading, seed_and_sensors};
use crate::twin::{Column, Draws, Logged, seed_of, true_values, truths};

/// Speed of the twin's waves for the phase between wavemaker and body: they have come in by so many turns and a part, whose size does not matter.
const PHASE_RAD: f64 = -0.7;

/// One planned run.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Its name.
    pub id: String,
    /// Whether the body is held.
    pub is_held: bool,
    /// Period of the wave, s.
    pub period_s: f64,
    /// Body, wave and wavemaker, with mass and restoring coefficient as they are declared.
    pub rig: WaveRig,
}

/// A run with its log.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// As it was planned.
    pub planned: Planned,
    /// What was logged.
    pub trace: WaveTrace,
}

impl Simulated {
    /// The log as the reduction takes it.
    #[must_use]
    pub fn view(&self) -> WaveRun<'_> {
        WaveRun {
            id: &self.planned.id,
            period_s: Some(self.planned.period_s),
            time_s: &self.trace.time_s,
            reference: &self.trace.reference_m,
            shows: if self.planned.is_held { Shows::Force } else { Shows::Acceleration },
            signal: (&self.trace.signal).into(),
            camera_m: None,
        }
    }
}

/// The runs of planned waves, at true coefficients A33 and B33.
#[must_use]
pub fn planned(waves: &[Point], setup: &Setup, [added_kg, damping_n_s_m]: [f64; 2]) -> Vec<Planned> {
    let mut out = Vec::new();
    for wave in waves {
        let of = |name: &str| wave.condition(name);
        let rig = WaveRig {
            mass_kg: setup.mass_kg.value,
            added_kg,
            damping_n_s_m,
            restoring_n_m: setup.restoring_n_m.value,
            omega_rad_s: TAU / of("period"),
            stroke_m: of("stroke"),
            force_n: of("force"),
            phase_rad: PHASE_RAD,
            still_s: of("still"),
            ramp_s: of("ramp"),
            travel_s: of("travel"),
            lasts_s: of("lasts"),
            rate_hz: of("rate"),
            thrown_back: None,
        };
        let held = of("held") as usize;
        for k in 0..held + of("free") as usize {
            let is_held = k < held;
            let role = if is_held { Role::Held } else { Role::Free }.name();
            let id = format!("{:03}_{role}", out.len() + 1);
            out.push(Planned { id, is_held, period_s: of("period"), rig });
        }
    }
    out
}

/// A33 and B33 of `[simulate.coefficients]`.
///
/// # Errors
///
/// No `[simulate]`, a record instead of coefficients, a coefficient that is not stated.
pub fn truth(campaign: &Campaign) -> Result<[f64; 2], MethodError> {
    let (_, values) = truths(campaign, EXCITED_RESPONSE)?;
    true_values(values, NAMES)
}

/// Quantities of the sensors: wavemaker, force, acceleration.
pub const SENSORS: [&[&str]; 3] = [&["reference"], &["f_z", "force"], &["acceleration"]];

/// What the twin has.
pub(super) fn senses() -> [Senses<'static>; 1] {
    [Senses::with_memory(SENSORS.into_iter().flatten().copied())]
}

/// The logs of all planned runs; the same seed gives the same logs.
#[must_use]
pub fn simulated(planned: &[Planned], setup: &Setup, sensors: &[SensorSpec], seed: u64) -> Vec<Simulated> {
    let mut draws = Draws::of(seed);
    let [mass_kg, restoring_n_m, delay_s] =
        [setup.mass_kg, setup.restoring_n_m, setup.delay_s].map(|known| draws.about(known));
    let [on_force, on_acceleration] = [setup.force_relative, setup.acceleration_relative].map(|part| draws.gain(part));
    let [reference, force, acceleration] = SENSORS.map(|names| reading(sensors, names, 0.0, 1.0));
    let one = |(i, run): (usize, &Planned)| {
        let rig = WaveRig { mass_kg, restoring_n_m, ..run.rig };
        let seed = seed_of(seed, i);
        let trace = if run.is_held {
            let signal = Reading { gain: on_force, ..force };
            rig.held(WaveReadings { reference, signal, delay_s }, seed)
        } else {
            let signal = Reading { gain: on_acceleration, ..acceleration };
            rig.free(WaveReadings { reference, signal, delay_s: 0.0 }, seed)
        };
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
    let setup = setup_of(source)?;
    let planned = planned(&section::plan(source)?, &setup, truth(campaign)?);
    let (seed, sensors) = seed_and_sensors(campaign, &senses())?;
    let runs = simulated(&planned, &setup, sensors, seed);
    Ok(runs.iter().flat_map(files_of).collect())
}

fn files_of(run: &Simulated) -> [Export; 2] {
    let (role, signal) = if run.planned.is_held {
        (Role::Held, ["fz", "f_z", "N", "body", "           # of the water on the body, upwards"])
    } else {
        (Role::Free, ["acc", "acceleration", "m/s^2", "body", "   # upwards"])
    };
    let column = |described, places, values| Column { described, places, values };
    let logged = Logged {
        id: &run.planned.id,
        said: "A run of the twin.",
        method: EXCITED_RESPONSE,
        role,
        configuration: "",
        conditions: &[format!("period = \"{} s\"", run.planned.period_s)],
        time: ("t", &run.trace.time_s),
        columns: &[
            column(["wavemaker", "reference", "m", "sensor", ""], 8, &run.trace.reference_m),
            column(signal, 7, &run.trace.signal),
        ],
    };
    logged.files()
}
