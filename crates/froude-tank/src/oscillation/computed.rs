//! Runs that a computation of the flow gives in place of a tank: what is to be computed of a source, and the log and sidecar of what was.
//!
//! The body goes to and fro along y by r φ(t), φ = φ_A sin ωt, and forward at U: v_y = r φ̇ in body axes, as on the arc of a pivot along the stream. That the arc also rolls the body by φ about its own axis is left out. The log has the force of a rig on a body of the declared mass and buoyancy, f_m = m r φ̈ − F_y − B sin φ, so that what reduces runs of a tank reduces these.

use std::collections::BTreeSet;

use froude_identify::method::{Export, MethodError};
use froude_records::campaign::{Campaign, Source};
use froude_rig::swung::SwungTrace;

use super::section;
use super::setup::{Setup, declared, setup_of};
use super::simulate::{Planned, configurations, log, planned, sidecar};
use crate::error::undeclared;
use crate::twin::pair;
use froude_hydro::swing::{Medium, Pivot};

/// The setup of a source and those of its planned runs that are in water, named by what they are: `H1LT-a10-w70-u0.2`, angle and angular frequency in degrees and per second.
///
/// # Errors
///
/// What the campaign does not declare; a body that turns its heading; no run in water; a run twice; too few periods for the cycles that are asked for.
pub fn asked(campaign: &Campaign, source: &Source) -> Result<(Setup, Vec<Planned>), MethodError> {
    let blocks = section::plan(source)?;
    let setup = setup_of(campaign, source, &declared(source)?, &configurations(&blocks))?;
    let refuse = |what: &str| undeclared(&source.place, what);
    if setup.pivot != Pivot::Stream {
        return Err(refuse(
            "an upright pivot turns the body's heading, which is not computed; write pivot = \"stream\", a swing across the stream",
        ));
    }
    let mut runs = planned(&blocks, &setup);
    runs.retain(|run| run.medium == Medium::Water);
    for run in &mut runs {
        let (name, swing) = (&setup.bodies[run.body].name, &run.swing);
        let before = if name.is_empty() { String::new() } else { format!("{name}-") };
        // Of degrees the conversion's rounding is no digit.
        let degrees = |rad: f64| (1e9 * rad.to_degrees()).round() / 1e9;
        run.id = format!("{before}a{}-w{}-u{}", degrees(swing.amplitude_rad), degrees(swing.omega_rad_s), run.flow_m_s);
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
    Ok((setup, runs))
}

/// The log and the sidecar of a run, of which F_y of the water on the body is known over time; `said` is a line for people at the head of the sidecar.
#[must_use]
pub fn files(run: &Planned, setup: &Setup, time_s: &[f64], fluid_n: &[f64], said: &str) -> [Export; 2] {
    let (radius_m, body) = (setup.radius_m.value, &setup.bodies[run.body]);
    let omega = run.swing.omega_rad_s;
    let angle = |t: f64| run.swing.amplitude_rad * (omega * t).sin();
    let buoyancy_n = body.buoyancy_n.map_or(0.0, |b| b.value);
    let of_rig = |(&t, &fluid): (&f64, &f64)| {
        let phi = angle(t);
        -body.mass_kg.value * radius_m * omega * omega * phi - fluid - buoyancy_n * phi.sin()
    };
    let trace = SwungTrace {
        time_s: time_s.to_vec(),
        angle_rad: time_s.iter().map(|t| angle(*t)).collect(),
        load: time_s.iter().zip(fluid_n).map(of_rig).collect(),
    };
    pair(&run.id, log(&trace), sidecar(run, setup, said))
}
