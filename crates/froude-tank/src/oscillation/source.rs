//! Forced oscillation as a source of a campaign: a folder of logs, one run each, with a sidecar that states what it is.

use froude_hydro::swing::Medium;
use froude_identify::answer::Made;
use froude_identify::method::{Found, MethodError, Need};
use froude_records::campaign::{Campaign, Source};
use froude_records::run::{Channel, FORCED_OSCILLATION, Role};
use froude_records::units::Dimension;

use super::forces::{Drag, drags};
use super::setup::{OscillationRun, Setup, declared, motions_without, setup_of};
use super::{findings, fit, page, plan, record, section, simulate};
use crate::declared::check;
use crate::findings::warning;
use crate::log::TankLog;
use crate::logs::{self, Logs, distinct};
use crate::long_logs::{self, LENGTHS, Lengths};
use crate::method::TankMethod;
use crate::motion::Sampled;

const WORDS: &str =
    "added mass, drag, buoyancy and delay fitted together in time, to runs of a body that a motor swings";
const DRY: Need = Need { is_optional: true, ..Need::of(&["dry_air"], &["angle", "force"]) };
const ROLES: [Role; 2] = [Role::Test, Role::DryAir];
const CHANNELS: &str = "time, angle and force";

/// The joint fit in time.
pub const FORCED: TankMethod = TankMethod {
    names: &[FORCED_OSCILLATION],
    words: &[WORDS],
    needs: &[Need::of(&["test"], &["angle", "force"]), DRY],
    runs: FORCED_OSCILLATION,
    identify: |campaign, source, _, progress| identified(campaign, source, LENGTHS, progress),
    simulate: simulate::files,
    plan: plan::prospect,
    check: |source| check(source, FORCED_OSCILLATION, section::oscillation, section::plan),
};

/// Reads, fits, chooses; logs beyond `lengths` are averaged.
fn identified(
    campaign: &Campaign,
    source: &Source,
    lengths: Lengths,
    progress: &dyn Fn(&str),
) -> Result<Found, MethodError> {
    let spec = declared(source)?;
    progress("reading the runs");
    let Logs { runs: logs, mut files, mut findings } =
        logs::read_averaging(source.input.path(), FORCED_OSCILLATION, &ROLES, CHANNELS, lengths, progress)?;
    let mut setup = setup_of(campaign, source, &spec, &logs::configurations(&logs))?;
    let clocks_s = logs.iter().map(|log| logs::stamps_standard_s(log, ["angle", "force"])).fold(0.0, f64::max);
    if let Some(delay) = &mut setup.delay_s {
        // One that is found needs no word of the clocks; of one that is declared their error is an error too.
        delay.standard = delay.standard.hypot(clocks_s);
    }
    let runs = logs.iter().map(|log| run(log, &setup)).collect::<Result<Vec<_>, _>>()?;
    progress("fitting the angles");
    let sampled: Vec<Sampled<'_>> = logs.iter().map(Sampled::of).collect();
    let motions = motions_without(&runs, &setup, &sampled).map_err(MethodError::refused)?;
    for (log, motion) in logs.iter().zip(&motions) {
        logs::add_step(&mut files, log, logs::cycles_step(log, motion));
    }
    let fastest_hz: Vec<f64> = motions.iter().map(|m| setup.harmonics as f64 / m.angle.period_s()).collect();
    let (mut fits, mut failed) = (Vec::new(), Vec::new());
    for drag in drags(campaign, source, &setup)? {
        progress(&format!("{FORCED_OSCILLATION} with {}", drag.law.name));
        match fit(&runs, &motions, &setup, &drag, &campaign.identify) {
            Ok(fit) => fits.push((drag, fit)),
            Err(why) => failed.push((drag.law.name.clone(), why)),
        }
    }
    // A law that fails costs itself alone; where all fail, nothing is found.
    if fits.is_empty()
        && let Some((_, why)) = failed.pop()
    {
        return Err(MethodError::refused(why));
    }
    findings.extend(
        failed
            .into_iter()
            .map(|(law, why)| warning("not-fitted", format!("{law} could not be fitted and is left out: {why}"))),
    );
    let chosen = record::chosen(&fits);
    findings.extend(findings::of_runs(&runs, &motions, &setup, campaign));
    findings.extend(logs.iter().zip(&fastest_hz).filter_map(|(log, hz)| long_logs::too_coarse(log, *hz)));
    findings.extend(fits.iter().flat_map(|(_, fit)| findings::of_fit(fit, &runs, &motions, &setup)));
    let blocks = fits.get(chosen).map(|(_, fit)| page::section(fit, &runs, &motions, &setup)).into_iter().collect();
    let estimate = |(i, (drag, fit)): (usize, &(Drag, _))| {
        let context = record::Context { campaign, source, setup: &setup, runs: &runs, motions: &motions };
        let mut estimate = record::estimate(fit, drag, &context, (i == chosen).then_some(fits.len()));
        if let Some(step) = long_logs::step(&logs, &fastest_hz) {
            estimate.method.words = format!("{step}; {}", estimate.method.words);
        }
        Made { name: estimate.id.clone(), estimate, files: files.clone() }.into()
    };
    let results = fits.iter().enumerate().map(estimate).collect();
    let summary = (!fits.is_empty()).then(|| page::laws(&fits, chosen));
    Ok(Found { results, summary, blocks, findings: distinct(findings), ..Found::default() })
}

/// A log as a run: its angle and its force, and the stream that it was done in.
fn run<'a>(log: &'a TankLog, setup: &Setup) -> Result<OscillationRun<'a>, MethodError> {
    let meta = &log.log.meta;
    let medium = if meta.role == Role::DryAir { Medium::Air } else { Medium::Water };
    let flow_m_s = match logs::condition(log, "flow", Dimension::SPEED)? {
        Some(flow) => flow,
        None if medium == Medium::Air => 0.0,
        None => {
            let what = "the speed of the stream is not declared; write [conditions] flow = \"0.2 m/s\" in its sidecar (\"0 m/s\" in water at rest)";
            return Err(MethodError::input(&log.log.path, what));
        }
    };
    let body = setup.bodies.iter().position(|body| body.name == meta.configuration).unwrap_or(0);
    Ok(OscillationRun {
        id: &meta.id,
        body,
        medium,
        flow_m_s,
        time_s: &log.log.time_s,
        angle_rad: &channel(log, "angle", Dimension::ANGLE)?.values,
        force_n: &channel(log, "force", Dimension::FORCE)?.values,
    })
}

fn channel<'a>(log: &'a TankLog, name: &str, dimension: Dimension) -> Result<&'a Channel, MethodError> {
    let along = if name == "angle" {
        "the pivot; positive where the body moves towards +y"
    } else {
        "the rig on the body along +y"
    };
    logs::channel(log, name, dimension, "added mass is wrong by its size where one is guessed", along)
}

#[cfg(test)]
mod tests;
