//! Runs that a computation of the flow gives in place of a tank: what is to be computed of a source, and the log and sidecar of what was.
//!
//! The body goes to and fro along y by r φ(t), φ = φ_A sin ωt, and forward at U: v_y = r φ̇ in body axes, as on the arc of a pivot along the stream. That the arc also rolls the body by φ about its own axis is left out. The log has the force of a rig on a body of the declared mass and buoyancy, f_m = m r φ̈ − F_y − B sin φ, so that what reduces runs of a tank reduces these.

use std::collections::BTreeSet;

use froude_identify::method::{Export, MethodError};
use froude_records::campaign::{Campaign, Source};
use froude_records::run::Role;
use froude_rig::swung::SwungTrace;

use super::{Body, Oscillation};
use crate::driven::matrix::{Planned, planned};
use crate::driven::read::setups;
use crate::driven::setup::Setup;
use crate::driven::twin::files_of;
use crate::error::undeclared;
use crate::matrix::of_configurations;
use froude_hydro::swing::Pivot;

/// What is computed of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// The run, named by what it is: `H1LT-a10-w70-u0.2`, angle and angular frequency in degrees and per second.
    pub planned: Planned,
    /// From the pivot to the body, m.
    pub radius_m: f64,
    /// The configuration.
    pub body: Body,
    /// Its mass on the rig, kg.
    pub mass_kg: f64,
    /// Its net buoyancy, N.
    pub buoyancy_n: Option<f64>,
}

/// The density of the water, kg/m³, and the planned runs of a source that are in water.
///
/// # Errors
///
/// What the campaign does not declare; a body that turns its heading; no run in water; a run twice; too few periods for the cycles that are asked for.
pub fn asked(campaign: &Campaign, source: &Source) -> Result<(f64, Vec<Asked>), MethodError> {
    let mut runs = planned::<Oscillation>(source)?;
    // Nothing that is computed depends on the drag law.
    let setup: Setup<Oscillation> =
        setups(campaign, source, &of_configurations(runs.iter().map(|run| &run.point)), None)?.remove(0);
    let refuse = |what: &str| undeclared(&source.place, what);
    if setup.method.pivot != Pivot::Stream {
        return Err(refuse(
            "an upright pivot turns the body's heading, which is not computed; write pivot = \"stream\", a swing across the stream",
        ));
    }
    runs.retain(|run| run.point.role == Role::Test);
    for run in &mut runs {
        let (name, swing) = (&run.point.configuration, &run.swing);
        let before = if name.is_empty() { String::new() } else { format!("{name}-") };
        // Of degrees the conversion's rounding is no digit.
        let degrees = |rad: f64| (1e9 * rad.to_degrees()).round() / 1e9;
        let [amplitude, omega] = [swing.amplitude, swing.omega_rad_s].map(degrees);
        run.id = format!("{before}a{amplitude}-w{omega}-u{}", run.point.condition("flow"));
    }
    let mut names = BTreeSet::new();
    if let Some(twice) = runs.iter().find(|run| !names.insert(run.id.clone())) {
        return Err(refuse(&format!(
            "plans {} twice: a computation gives the same again, which is no second observation; leave repeats out",
            twice.id
        )));
    }
    let needed = (setup.cycles.skip + setup.cycles.fewest) as f64;
    if setup.cycles.skip == 0 || runs.iter().any(|run| run.swing.periods < needed) {
        return Err(refuse(&format!(
            "a computed body starts at once, so that one cycle at least is to be left out, and {needed} periods are needed for cycles = {{ skip = {}, fewest = {} }}; write skip = 1 or more, and as many periods",
            setup.cycles.skip, setup.cycles.fewest
        )));
    }
    if runs.is_empty() {
        return Err(refuse("plans no run in water: add a [[source.plan]] with amplitude, frequency and flow"));
    }
    let known = |k: usize| setup.constants[k].known.map(|known| known.value);
    let density = known(super::DENSITY).unwrap_or(0.0);
    let one = |planned: Planned| {
        let place = setup.method.body(&planned.point.configuration);
        let mass = Oscillation::mass(place);
        Asked {
            planned,
            radius_m: known(super::RADIUS).unwrap_or(0.0),
            body: setup.method.bodies[place].clone(),
            mass_kg: known(mass).unwrap_or(0.0),
            buoyancy_n: known(mass + 1),
        }
    };
    Ok((density, runs.into_iter().map(one).collect()))
}

/// The log and the sidecar of a run, of which F_y of the water on the body is known over time; `said` is a line for people at the head of the sidecar.
#[must_use]
pub fn files(run: &Asked, time_s: &[f64], fluid_n: &[f64], said: &str) -> [Export; 2] {
    let swing = &run.planned.swing;
    let omega = swing.omega_rad_s;
    let angle = |t: f64| swing.amplitude * (omega * t).sin();
    let buoyancy_n = run.buoyancy_n.unwrap_or(0.0);
    let of_rig = |(&t, &fluid): (&f64, &f64)| {
        let phi = angle(t);
        -run.mass_kg * run.radius_m * omega * omega * phi - fluid - buoyancy_n * phi.sin()
    };
    let trace = SwungTrace {
        time_s: time_s.to_vec(),
        motion: time_s.iter().map(|t| angle(*t)).collect(),
        loads: vec![time_s.iter().zip(fluid_n).map(of_rig).collect()],
    };
    files_of::<Oscillation>(&run.planned, &trace, said)
}
