//! The twin of a campaign's forced oscillation: the logs and sidecars that it would give for chosen true coefficients.
//!
//! What is declared with an uncertainty is drawn once for the campaign, about what is declared: radius, masses, density, the gains of angle, force
//! and stream. Buoyancies and delay are what `[simulate.coefficients]` states, else drawn about what is declared. Each run has a zero of its own.

use froude_identify::dataset::{Dataset, distinct};
use froude_identify::law::ForceLaw;
use froude_identify::method::{Export, MethodError};
use froude_records::campaign::{Campaign, SensorSpec, Source};
use froude_records::run::{FORCED_OSCILLATION, Role};
use froude_records::units::Dimension;
use froude_rig::oscillation::OscillationRig;
use froude_rig::swung::{Swing, SwungSensor, SwungTrace};

use super::fit::{ADDED, BUOYANCY, DELAY};
use super::forces::{Drag, drags};
use super::section::{self, OscillationPlan};
use super::setup::{LOAD, OscillationRun, Setup, declared, setup_of};
use crate::sensors::{Senses, seed_and_sensors, swung};
use crate::twin::{Draws, Sidecar, csv, pair, seed_of, true_value, truths};
use froude_hydro::swing::{Medium, Pivot};

/// Natural frequency of the twin's servo, rad/s, and its damping ratio: a joint module that overshoots a little.
const SERVO: (f64, f64) = (30.0, 0.6);
/// Standard deviation of the zero of a run, N.
const ZERO_N: f64 = 0.2;

/// What the twin has: force and angle.
pub(super) fn senses() -> [Senses<'static>; 2] {
    [Senses::with_memory(["force", LOAD]), Senses::white("angle")]
}

/// One planned run.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Its name.
    pub id: String,
    /// Which body of the setup.
    pub body: usize,
    /// What it swings in.
    pub medium: Medium,
    /// Speed of the stream, m/s.
    pub flow_m_s: f64,
    /// How it swings.
    pub swing: Swing,
    /// Samples a second.
    pub rate_hz: f64,
    /// Factor on the law's drag in this run \[-\]; 1 without run-to-run variation.
    pub of_drag: f64,
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
    pub fn view(&self) -> OscillationRun<'_> {
        OscillationRun {
            id: &self.planned.id,
            body: self.planned.body,
            medium: self.planned.medium,
            flow_m_s: self.planned.flow_m_s,
            time_s: &self.trace.time_s,
            angle_rad: &self.trace.angle_rad,
            force_n: &self.trace.load,
        }
    }
}

/// Names of the planned configurations, in order of first appearance.
#[must_use]
pub fn configurations(blocks: &[OscillationPlan]) -> Vec<String> {
    distinct(&blocks.iter().flat_map(|block| block.configurations.clone()).collect::<Vec<_>>())
}

/// The run matrix of a plan.
#[must_use]
pub fn planned(blocks: &[OscillationPlan], setup: &Setup) -> Vec<Planned> {
    let mut out = Vec::new();
    for block in blocks {
        for configuration in &block.configurations {
            let body = setup.bodies.iter().position(|b| b.name == *configuration).unwrap_or(0);
            for &flow_m_s in &block.flow_m_s {
                for swing in block.swings.each() {
                    let id = format!("{:03}", out.len() + 1);
                    let medium = if block.in_air { Medium::Air } else { Medium::Water };
                    out.push(Planned {
                        id,
                        body,
                        medium,
                        flow_m_s,
                        swing,
                        rate_hz: block.swings.rate_hz,
                        of_drag: 1.0,
                    });
                }
            }
        }
    }
    out
}

/// What is true on the twin.
#[derive(Debug, Clone)]
pub struct Truths {
    /// C_A.
    pub added: f64,
    /// The drag law.
    pub law: ForceLaw,
    /// Its coefficients.
    pub drag: Vec<f64>,
    /// B that is stated, by body.
    pub buoyancy_n: Vec<Option<f64>>,
    /// The delay that is stated, s.
    pub delay_s: Option<f64>,
}

impl Truths {
    /// Of `[simulate]`.
    ///
    /// # Errors
    ///
    /// No `[simulate]`, a record instead of coefficients, a coefficient that is not stated.
    pub fn of(campaign: &Campaign, source: &Source, setup: &Setup) -> Result<Self, MethodError> {
        let instead = format!(
            "the twin of {FORCED_OSCILLATION} takes its truth from [simulate.coefficients], drag and {ADDED} together; a record is not enough"
        );
        let (model, values) = truths(campaign, instead)?;
        let mut asking = source.clone();
        asking.models = vec![model.to_owned()];
        asking.model_places.clear();
        let Drag { law, columns, .. } = drags(campaign, &asking, setup)?.remove(0);
        let need = |name: &str| true_value(values, name);
        let drag = law.coefficients.iter().enumerate().map(|(j, c)| {
            // What moves the other load alone is not needed.
            if columns.contains(&j) { need(&c.name) } else { Ok(values.get(&c.name).copied().unwrap_or(0.0)) }
        });
        let of_body = |name: &str| if name.is_empty() { BUOYANCY.to_owned() } else { format!("{BUOYANCY}_{name}") };
        Ok(Self {
            added: need(ADDED)?,
            drag: drag.collect::<Result<_, _>>()?,
            law,
            buoyancy_n: setup.bodies.iter().map(|b| values.get(&of_body(&b.name)).copied()).collect(),
            delay_s: values.get(DELAY).copied(),
        })
    }

    /// Drag across a body at a velocity through the water, N.
    #[must_use]
    pub fn drag_n(&self, n_links: Option<f64>, density: f64, [v_x, v_y]: [f64; 2]) -> f64 {
        let mut data = Dataset { rows: 1, ..Dataset::default() };
        data.put("v_x", vec![v_x], Dimension::SPEED);
        data.put("v_y", vec![v_y], Dimension::SPEED);
        data.speed_and_angle_from_velocity();
        data.put("density", vec![density], Dimension::DENSITY);
        if let Some(k) = n_links {
            data.put("n_links", vec![k], Dimension::ONE);
        }
        let at = self.law.responses.iter().position(|r| r == LOAD).unwrap_or(0);
        self.law.predict(&data, &self.drag).map_or(f64::NAN, |f| f[at])
    }
}

/// The logs of all planned runs; the same seed gives the same logs.
///
/// `sensors` are those of `[[simulate.sensor]]`: `angle` and `force` (or `f_y`).
#[must_use]
pub fn simulated(
    planned: &[Planned],
    setup: &Setup,
    truth: &Truths,
    sensors: &[SensorSpec],
    seed: u64,
) -> Vec<Simulated> {
    let mut draws = Draws::of(seed);
    let radius_m = draws.about(setup.radius_m);
    let density = draws.about(setup.density_kg_m3);
    let [angle, force, flow] =
        [setup.angle_relative, setup.force_relative, setup.flow_relative].map(|part| draws.gain(part));
    let delay_s = truth.delay_s.unwrap_or_else(|| setup.delay_s.map_or(0.0, |d| draws.about(d)));
    let bodies: Vec<(f64, f64)> = (setup.bodies.iter().zip(&truth.buoyancy_n))
        .map(|(body, stated)| {
            let mass = draws.about(body.mass_kg);
            let buoyancy = stated.unwrap_or_else(|| body.buoyancy_n.map_or(0.0, |b| draws.about(b)));
            (mass, if setup.pivot == Pivot::Stream { buoyancy } else { 0.0 })
        })
        .collect();
    let zeros: Vec<f64> = planned.iter().map(|_| ZERO_N * draws.normal()).collect();
    let sensor = swung(sensors, &["angle", "phi"], &["force", LOAD]);
    let one = |(i, run): (usize, &Planned)| {
        let (body, (mass_kg, buoyancy_n)) = (&setup.bodies[run.body], bodies[run.body]);
        let rig = OscillationRig {
            pivot: setup.pivot,
            radius_m,
            mass_kg,
            added_kg: truth.added * density * body.reference_volume_m3,
            buoyancy_n,
            servo_rad_s: SERVO.0,
            servo_damping: SERVO.1,
        };
        let sensor = SwungSensor { rate_hz: run.rate_hz, zero: zeros[i] + sensor.zero, delay_s, ..sensor };
        let drag_n = |v: [f64; 2]| run.of_drag * truth.drag_n(body.n_links, density, v);
        let stream = (run.medium, run.flow_m_s * flow);
        let trace = rig.swing(stream, run.swing, sensor, &drag_n, seed_of(seed, i)).scaled(angle, force);
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
    let (spec, blocks) = (declared(source)?, section::plan(source)?);
    let setup = setup_of(campaign, source, &spec, &configurations(&blocks))?;
    let truth = Truths::of(campaign, source, &setup)?;
    let planned = planned(&blocks, &setup);
    let (seed, sensors) = seed_and_sensors(campaign, &senses())?;
    let runs = simulated(&planned, &setup, &truth, sensors, seed);
    let text = |run: &Simulated| sidecar(&run.planned, &setup, "A run of the twin.");
    Ok(runs.iter().flat_map(|run| pair(&run.planned.id, log(&run.trace), text(run))).collect())
}

pub(super) fn log(trace: &SwungTrace) -> String {
    csv("time,phi,force", &trace.time_s, &[(&trace.angle_rad, 8), (&trace.load, 6)])
}

pub(super) fn sidecar(run: &Planned, setup: &Setup, said: &str) -> String {
    let sidecar = Sidecar {
        said,
        method: FORCED_OSCILLATION,
        role: if run.medium == Medium::Air { Role::DryAir } else { Role::Test }.name(),
        configuration: &setup.bodies[run.body].name,
        conditions: &[format!("flow = \"{} m/s\"", run.flow_m_s)],
        time: "time",
        columns: &[
            ["phi", "angle", "rad", "sensor", "   # positive towards +y"],
            ["force", "force", "N", "body", "       # of the rig on the body, along +y"],
        ],
        width: 5,
    };
    sidecar.text()
}
