//! `froude cfd swing`: what a campaign plans for a tank, computed.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use froude_cfd::verb::{Planned, SwungRun, swing as compute};
use froude_identify::method::MethodError;
use froude_records::campaign::{Campaign, Source};
use froude_records::outcome::Outcome;
use froude_tank::oscillation::computed;

use crate::Error;

/// Computes the runs of a campaign's forced oscillation that have no log yet, `jobs` at a time. `now` hears how far it is.
///
/// # Errors
///
/// As [`froude_cfd::verb::swing`].
pub fn swing(
    campaign: &Path,
    source: Option<&str>,
    jobs: usize,
    cancel: &AtomicBool,
    now: &(dyn Fn(&str) + Sync),
) -> Result<Outcome, Error> {
    Ok(compute(campaign, source, jobs, cancel, now, &planned)?)
}

fn planned(campaign: &Campaign, source: &Source) -> Result<Planned, MethodError> {
    let (setup, runs) = computed::asked(campaign, source)?;
    let swung = runs.iter().map(|run| {
        let body = &setup.bodies[run.body];
        SwungRun {
            id: run.id.clone(),
            configuration: body.name.clone(),
            radius_m: setup.radius_m.value,
            amplitude_rad: run.swing.amplitude_rad,
            omega_rad_s: run.swing.omega_rad_s,
            forward_m_s: run.flow_m_s,
            periods: run.swing.periods,
            mass_kg: body.mass_kg.value,
            buoyancy_n: body.buoyancy_n.map(|b| b.value),
            volume_m3: body.reference_volume_m3,
        }
    });
    Ok(Planned {
        runs: swung.collect(),
        configurations: setup.bodies.iter().map(|body| body.name.clone()).collect(),
        density_kg_m3: setup.density_kg_m3.value,
        files: Box::new(move |place, time_s, fluid_n, said| {
            computed::files(&runs[place], &setup, time_s, fluid_n, said)
        }),
    })
}
