//! The twin of a campaign's forced oscillation: the logs and sidecars that it would give for chosen true coefficients.
//!
//! What is declared with an uncertainty is drawn once for the campaign, about what is declared: radius, masses, density, the gains of angle, force
//! and stream. Buoyancies and delay are what `[simulate.coefficients]` states, else drawn about what is declared. Each run has a zero of its own.

use froude_identify::dataset::{Dataset, distinct};
use froude_identify::law::ForceLaw;
use froude_identify::method::{Export, MethodError};
use froude_records::campaign::{Campaign, SensorSpec, Source, Truth};
use froude_records::run::{FORCED_OSCILLATION, Role};
use froude_records::units::Dimension;
use froude_rig::oscillation::{OscillationRig, OscillationSensor, OscillationTrace, Swing};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use super::fit::{ADDED, BUOYANCY, DELAY};
use super::forces::{Drag, LOAD};
use super::section::{self, OscillationPlan};
use super::setup::{OscillationRun, Setup};
use super::source::{declared, drags, setup_of};
use crate::sensors::{Senses, seed_and_sensors};
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
    pub trace: OscillationTrace,
}

impl Simulated {
    /// The log as the reduction takes it.
    #[must_use]
    pub fn view(&self) -> OscillationRun<'_> {
        OscillationRun {
            id: &self.planned.id,
            body: self.planned.body,
            medium: self.planned.swing.medium,
            flow_m_s: self.planned.swing.flow_m_s,
            time_s: &self.trace.time_s,
            angle_rad: &self.trace.angle_rad,
            force_n: &self.trace.force_n,
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
        let swings = &block.swings;
        for configuration in &block.configurations {
            let body = setup.bodies.iter().position(|b| b.name == *configuration).unwrap_or(0);
            for &flow_m_s in &block.flow_m_s {
                for &amplitude_rad in &swings.amplitude_rad {
                    for &omega_rad_s in &swings.omega_rad_s {
                        for _ in 0..swings.repeats {
                            let swing = Swing {
                                medium: if block.in_air { Medium::Air } else { Medium::Water },
                                amplitude_rad,
                                omega_rad_s,
                                flow_m_s,
                                still_s: swings.still_s,
                                periods: swings.periods,
                            };
                            let id = format!("{:03}", out.len() + 1);
                            out.push(Planned { id, body, swing, rate_hz: swings.rate_hz, of_drag: 1.0 });
                        }
                    }
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
        let undeclared = |place: &str, what: String| MethodError::Undeclared { place: place.to_owned(), what };
        let place = campaign.path.display().to_string();
        let Some(simulate) = &campaign.simulate else {
            return Err(undeclared(
                &place,
                "a twin needs [simulate]: seed, model, and the true coefficients".to_owned(),
            ));
        };
        let Truth::Coefficients { model, values } = &simulate.truth else {
            let what = format!(
                "the twin of {FORCED_OSCILLATION} takes its truth from [simulate.coefficients], drag and {ADDED} together; a record is not enough"
            );
            return Err(undeclared(&place, what));
        };
        let mut asking = source.clone();
        asking.models = vec![model.clone()];
        asking.model_places.clear();
        let Drag { law, columns, .. } = drags(campaign, &asking, setup)?.remove(0);
        let need = |name: &str| {
            values
                .get(name)
                .copied()
                .ok_or_else(|| undeclared("[simulate.coefficients]", format!("{name} is missing; the truth needs it")))
        };
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
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut draw = |standard: f64| -> f64 {
        let z: f64 = rng.sample(StandardNormal);
        standard * z
    };
    let radius_m = setup.radius_m.value + draw(setup.radius_m.standard);
    let density = setup.density_kg_m3.value + draw(setup.density_kg_m3.standard);
    let [angle, force, flow] =
        [setup.angle_relative, setup.force_relative, setup.flow_relative].map(|part| 1.0 + draw(part));
    let delay_s = truth.delay_s.unwrap_or_else(|| setup.delay_s.map_or(0.0, |d| d.value + draw(d.standard)));
    let bodies: Vec<(f64, f64)> = (setup.bodies.iter().zip(&truth.buoyancy_n))
        .map(|(body, stated)| {
            let mass = body.mass_kg.value + draw(body.mass_kg.standard);
            let buoyancy = stated.unwrap_or_else(|| body.buoyancy_n.map_or(0.0, |b| b.value + draw(b.standard)));
            (mass, if setup.pivot == Pivot::Stream { buoyancy } else { 0.0 })
        })
        .collect();
    let zeros: Vec<f64> = planned.iter().map(|_| draw(ZERO_N)).collect();
    let of = |names: [&str; 2]| sensors.iter().find(|s| names.contains(&s.quantity.as_str()));
    let (on_angle, on_force) = (of(["angle", "phi"]), of(["force", LOAD]));
    let noise = |s: Option<&SensorSpec>| s.and_then(|s| s.noise).unwrap_or(0.0);
    let step = |s: Option<&SensorSpec>| s.and_then(|s| s.resolution).unwrap_or(0.0);
    let slow = on_force.and_then(|s| s.correlation_s);
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
        let sensor = OscillationSensor {
            rate_hz: run.rate_hz,
            angle_noise_rad: noise(on_angle),
            angle_step_rad: step(on_angle),
            force_noise_n: if slow.is_some() { 0.0 } else { noise(on_force) },
            slow_noise_n: if slow.is_some() { noise(on_force) } else { 0.0 },
            correlation_s: slow.unwrap_or(1.0),
            force_step_n: step(on_force),
            zero_n: zeros[i] + on_force.and_then(|s| s.bias).unwrap_or(0.0),
            drift_n_s: 0.0,
            delay_s,
        };
        let swing = Swing { flow_m_s: run.swing.flow_m_s * flow, ..run.swing };
        let drag_n = |v: [f64; 2]| run.of_drag * truth.drag_n(body.n_links, density, v);
        let mut trace =
            rig.swing(swing, sensor, &drag_n, seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(i as u64 + 1));
        trace.angle_rad.iter_mut().for_each(|x| *x *= angle);
        trace.force_n.iter_mut().for_each(|x| *x *= force);
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
    let mut out = Vec::new();
    for run in simulated(&planned, &setup, &truth, sensors, seed) {
        out.push(Export { name: format!("{}.csv", run.planned.id), content: log(&run.trace).into_bytes() });
        out.push(Export {
            name: format!("{}.toml", run.planned.id),
            content: sidecar(&run.planned, &setup, "A run of the twin.").into_bytes(),
        });
    }
    Ok(out)
}

pub(super) fn log(trace: &OscillationTrace) -> String {
    let mut out = String::from("time,phi,force\n");
    for ((t, angle), force) in trace.time_s.iter().zip(&trace.angle_rad).zip(&trace.force_n) {
        out += &format!("{t:.6},{angle:.8},{force:.6}\n");
    }
    out
}

/// `said` is a line for people.
pub(super) fn sidecar(run: &Planned, setup: &Setup, said: &str) -> String {
    let role = if run.swing.medium == Medium::Air { Role::DryAir } else { Role::Test }.name();
    let configuration = &setup.bodies[run.body].name;
    let mounted = if configuration.is_empty() {
        String::new()
    } else {
        format!("\n[mounted]\nconfiguration = {configuration:?}\n")
    };
    format!(
        "# {said}\nschema = 1\nmethod = \"{FORCED_OSCILLATION}\"\nrole = \"{role}\"\n{mounted}\n[conditions]\nflow = \"{} m/s\"\n\n[columns]\n\
         time  = {{ name = \"time\", unit = \"s\" }}\n\
         phi   = {{ name = \"angle\", unit = \"rad\", sign = 1, frame = \"sensor\", clock = \"log\" }}   # positive towards +y\n\
         force = {{ name = \"force\", unit = \"N\", sign = 1, frame = \"body\", clock = \"log\" }}       # of the rig on the body, along +y\n",
        run.swing.flow_m_s
    )
}
