//! `froude cfd swing`: what a campaign plans for a tank, computed.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use froude_cfd::verb::{Planned, SwungRun, swing as compute};
use froude_identify::dataset::distinct;
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
    let (density_kg_m3, runs) = computed::asked(campaign, source)?;
    let swung = runs.iter().map(|run| SwungRun {
        id: run.planned.id.clone(),
        configuration: run.body.name.clone(),
        radius_m: run.radius_m,
        amplitude_rad: run.planned.swing.amplitude,
        omega_rad_s: run.planned.swing.omega_rad_s,
        forward_m_s: run.planned.point.condition("flow"),
        periods: run.planned.swing.periods,
        mass_kg: run.mass_kg,
        buoyancy_n: run.buoyancy_n,
        volume_m3: run.body.reference_volume_m3,
    });
    let names: Vec<String> = runs.iter().map(|run| run.body.name.clone()).collect();
    Ok(Planned {
        runs: swung.collect(),
        configurations: distinct(&names),
        density_kg_m3,
        files: Box::new(move |place, time_s, fluid_n, said| computed::files(&runs[place], time_s, fluid_n, said)),
    })
}
