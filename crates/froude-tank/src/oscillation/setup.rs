//! What a forced oscillation gives: runs over time, and what is declared about body, rig and water.

use froude_fit::budget::Uncertain;
use froude_hydro::swing::{Medium, Pivot};
use froude_identify::method::MethodError;
use froude_records::campaign::{Campaign, Source};
use froude_records::run::FORCED_OSCILLATION;
use froude_records::table::links_of_configuration;

use super::section::{self, OscillationSpec};
use crate::declared::{self, needed, uncertain};
use crate::error::{TankError, undeclared};
use crate::logs;
use crate::motion::{Cycles, Logged, Motion, Sampled, motion};
use crate::reference;

/// The load that the cell shows.
pub(super) const LOAD: &str = "f_y";

/// One run: columns of one length, time increasing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OscillationRun<'a> {
    /// Name of the run, for messages.
    pub id: &'a str,
    /// Which of the bodies of the setup hung on the rod.
    pub body: usize,
    /// In water or in air.
    pub medium: Medium,
    /// U, m/s.
    pub flow_m_s: f64,
    /// Time, s.
    pub time_s: &'a [f64],
    /// φ, rad.
    pub angle_rad: &'a [f64],
    /// Force of the rig on the body along +y, N; its zero is free.
    pub force_n: &'a [f64],
}

/// A configuration, and what is declared of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Its name; empty where there is one body without a name.
    pub name: String,
    /// k, links of a snake robot between head and tail; `None` for a body that is no `HkLT`.
    pub n_links: Option<f64>,
    /// V: the volume that C_A refers to, m³.
    pub reference_volume_m3: f64,
    /// m: all that moves below the load cell, kg.
    pub mass_kg: Uncertain,
    /// B: buoyancy less weight, N, as far as it is known beforehand.
    pub buoyancy_n: Option<Uncertain>,
}

/// What is declared about rig and water.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// How the pivot lies.
    pub pivot: Pivot,
    /// r: from the pivot axis to the body's reference point, m.
    pub radius_m: Uncertain,
    /// The configurations.
    pub bodies: Vec<Body>,
    /// ρ, kg/m³.
    pub density_kg_m3: Uncertain,
    /// U is the run's; this is its standard uncertainty, one error of all runs, as part of U.
    pub flow_relative: f64,
    /// Gain error of the angle, as part of it.
    pub angle_relative: f64,
    /// Gain error of the force, as part of it.
    pub force_relative: f64,
    /// Delay of the force behind the angle, s, as far as it is known beforehand: with a standard uncertainty of 0 it is taken as it is.
    pub delay_s: Option<Uncertain>,
    /// Which cycles are used.
    pub cycles: Cycles,
    /// Harmonics of the angle.
    pub harmonics: usize,
}

impl Setup {
    /// One pivot along the stream, everything exact, nothing known of buoyancies and delay.
    #[must_use]
    pub fn new(radius_m: Uncertain, density_kg_m3: f64, bodies: Vec<Body>) -> Self {
        Self {
            pivot: Pivot::Stream,
            radius_m,
            bodies,
            density_kg_m3: Uncertain::new(density_kg_m3, 0.0),
            flow_relative: 0.0,
            angle_relative: 0.0,
            force_relative: 0.0,
            delay_s: None,
            cycles: Cycles::default(),
            harmonics: 3,
        }
    }

    /// The numbers are possible.
    pub(super) fn check(&self) -> Result<(), TankError> {
        let refuse =
            |what: String, value: f64, must: &str| Err(TankError::new(format!("{what} is {value}; it must be {must}")));
        if !(self.radius_m.value != 0.0 && self.radius_m.value.is_finite()) {
            return refuse("the radius".to_owned(), self.radius_m.value, "finite and not zero");
        }
        if !(self.density_kg_m3.value > 0.0 && self.density_kg_m3.value.is_finite()) {
            return refuse("the density".to_owned(), self.density_kg_m3.value, "above zero and finite");
        }
        for body in &self.bodies {
            let of =
                |what: &str| if body.name.is_empty() { what.to_owned() } else { format!("{what} of {}", body.name) };
            if !(body.mass_kg.value >= 0.0 && body.mass_kg.value.is_finite()) {
                return refuse(of("the mass"), body.mass_kg.value, "zero or more and finite");
            }
            if !(body.reference_volume_m3 > 0.0 && body.reference_volume_m3.is_finite()) {
                return refuse(of("the reference volume"), body.reference_volume_m3, "above zero and finite");
            }
            if self.pivot == Pivot::Upright && body.buoyancy_n.is_some() {
                return refuse(
                    of("the buoyancy"),
                    body.buoyancy_n.map_or(0.0, |b| b.value),
                    "left out: about an upright pivot it has no part across the body",
                );
            }
        }
        Ok(())
    }
}

/// `[source.forced_oscillation]`.
///
/// # Errors
///
/// It is not there, or cannot be read.
pub fn declared(source: &Source) -> Result<OscillationSpec, MethodError> {
    let what =
        "nothing is declared of the body that swings: write [source.forced_oscillation] with pivot, radius and mass";
    needed(source, FORCED_OSCILLATION, section::oscillation, what)
}

/// Everything that the campaign declares, for the configurations that there are.
///
/// # Errors
///
/// What is missing, and what to write; a budget entry of a quantity that this method does not have.
pub fn setup_of(
    campaign: &Campaign,
    source: &Source,
    spec: &OscillationSpec,
    configurations: &[String],
) -> Result<Setup, MethodError> {
    let body = |name: &String| {
        let of = if name.is_empty() { String::new() } else { format!(" of {name}") };
        let volume = reference::volume_m3(campaign, source, name)?;
        let mass = spec.mass_kg.of(name).ok_or_else(|| {
            undeclared(&source.place, format!("no mass is declared{of}: write it in [source.forced_oscillation] mass, {name} = {{ value = \"1.63 kg\", standard = \"5 g\" }}"))
        })?;
        Ok(Body {
            name: name.clone(),
            n_links: links_of_configuration(name).map(f64::from),
            reference_volume_m3: volume,
            mass_kg: uncertain(mass),
            buoyancy_n: spec.buoyancy_n.of(name).map(uncertain),
        })
    };
    let density = reference::density_kg_m3(campaign, source)?;
    let bodies = configurations.iter().map(body).collect::<Result<_, MethodError>>()?;
    let mut out = Setup {
        pivot: spec.pivot,
        delay_s: spec.delay_s.map(uncertain),
        cycles: spec.cycles,
        harmonics: spec.harmonics,
        ..Setup::new(uncertain(spec.radius_m), density, bodies)
    };
    for entry in &source.uncertainty {
        logs::is_of_all_runs(entry)?;
        let gain = match entry.quantity.as_str() {
            "density" => {
                out.density_kg_m3.standard = if entry.relative { entry.standard * density } else { entry.standard };
                continue;
            }
            "angle" => &mut out.angle_relative,
            "force" | LOAD => &mut out.force_relative,
            "flow" | "speed" => &mut out.flow_relative,
            other => {
                let what = format!(
                    "quantity = {other:?} is none that a forced oscillation has: it has force, angle, flow and density; radius, mass, buoyancy and \
                     delay take their standard uncertainties in [source.forced_oscillation]"
                );
                return Err(undeclared(&entry.place, what));
            }
        };
        *gain = declared::gain(entry, "the zero of each run is fitted")?;
    }
    Ok(out)
}

/// The motion of every run.
///
/// # Errors
///
/// That of the first run whose motion cannot be used.
pub fn motions(runs: &[OscillationRun<'_>], setup: &Setup) -> Result<Vec<Motion>, TankError> {
    runs.iter().map(|run| of_run(run, setup, Sampled::default())).collect()
}

/// The same without the cycles that a mark touches; `sampled` belongs to `runs`, one each.
///
/// # Errors
///
/// As [`motions`]: too few cycles without a mark, too.
pub fn motions_without(
    runs: &[OscillationRun<'_>],
    setup: &Setup,
    sampled: &[Sampled<'_>],
) -> Result<Vec<Motion>, TankError> {
    runs.iter().zip(sampled).map(|(run, sampled)| of_run(run, setup, *sampled)).collect()
}

fn of_run(run: &OscillationRun<'_>, setup: &Setup, sampled: Sampled<'_>) -> Result<Motion, TankError> {
    let OscillationRun { id, time_s, angle_rad, force_n, .. } = *run;
    let of = Logged { id, time_s, angle_rad, load: ("force", "N", force_n), sampled };
    motion(&of, setup.cycles, setup.harmonics)
}
