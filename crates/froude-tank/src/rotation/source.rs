//! Rotation as a source of a campaign: a folder of logs, one run each, with a sidecar that states what it is.

use froude_identify::answer::Made;
use froude_identify::method::{Found, MethodError, Need};
use froude_records::campaign::{Campaign, Source};
use froude_records::run::{Channel, ROTATION, Role};
use froude_records::units::Dimension;

use super::derive::derived;
use super::section::setup_of;
use super::setup::{RotationRun, motions_without};
use super::simulate::mounted;
use super::{findings, fit, page, plan, record, section, simulate};
use crate::declared::check;
use crate::log::TankLog;
use crate::logs::{self, Logs, distinct};
use crate::long_logs;
use crate::method::TankMethod;
use crate::motion::Sampled;

const CHANNELS: &[&str] = &["angle", "torque"];
const DRY: Need = Need { is_optional: true, ..Need::of(&["dry_air"], CHANNELS) };
const TARE: Need = Need { is_optional: true, ..Need::of(&["tare"], CHANNELS) };
const WORDS: &str = "added inertia and damping of a body about its own axis, fitted in time to runs in which a motor turns it to and fro";

/// The joint fit in time.
pub const TURNED: TankMethod = TankMethod {
    names: &[ROTATION],
    words: &[WORDS],
    needs: &[Need::of(&["test"], CHANNELS), DRY, TARE],
    runs: ROTATION,
    identify: |campaign, source, _, progress| identify(campaign, source, progress),
    simulate: simulate::files,
    plan: plan::prospect,
    check: |source| check(source, ROTATION, section::rotation, section::plan),
};

fn identify(campaign: &Campaign, source: &Source, progress: &dyn Fn(&str)) -> Result<Found, MethodError> {
    let mut setup = setup_of(campaign, source)?;
    progress("reading the runs");
    let roles = [Role::Test, Role::DryAir, Role::Tare];
    let Logs { runs: logs, mut files, mut findings } =
        logs::read(source.input.path(), ROTATION, &roles, "time, angle and torque", progress)?;
    one_body(&logs)?;
    let clocks_s = logs.iter().map(|log| logs::stamps_standard_s(log, ["angle", "torque"])).fold(0.0, f64::max);
    if let Some(delay) = &mut setup.delay_s {
        // One that is found needs no word of the clocks; of one that is declared their error is an error too.
        delay.standard = delay.standard.hypot(clocks_s);
    }
    let runs = logs.iter().map(run).collect::<Result<Vec<_>, _>>()?;
    progress("fitting the angles");
    let sampled: Vec<Sampled<'_>> = logs.iter().map(Sampled::of).collect();
    let motions = motions_without(&runs, &setup, &sampled).map_err(MethodError::refused)?;
    for (log, motion) in logs.iter().zip(&motions) {
        logs::add_step(&mut files, log, logs::cycles_step(log, motion));
    }
    let fastest_hz: Vec<f64> = motions.iter().map(|m| setup.harmonics as f64 / m.angle.period_s()).collect();
    findings.extend(logs.iter().zip(&fastest_hz).filter_map(|(log, hz)| long_logs::too_coarse(log, *hz)));
    progress("fitting the torques");
    let fit = fit(&runs, &motions, &setup, &campaign.identify).map_err(MethodError::refused)?;
    let derived = derived(&fit, &setup);
    findings.extend(findings::of_runs(&runs, &motions, &setup));
    findings.extend(findings::of_fit(&fit, &derived, &runs, &motions, &setup));
    let context =
        record::Context { campaign, source, setup: &setup, runs: &runs, motions: &motions, derived: &derived };
    let mut estimate = record::estimate(&fit, &context);
    if let Some(step) = long_logs::step(&logs, &fastest_hz) {
        estimate.method.words = format!("{step}; {}", estimate.method.words);
    }
    let made = Made { name: estimate.id.clone(), estimate, files };
    Ok(Found {
        results: vec![made.into()],
        summary: Some(page::results(&fit, &derived)),
        blocks: vec![page::section(&fit, &runs, &motions, &setup)],
        findings: distinct(findings),
        ..Found::default()
    })
}

/// Runs of one body: λs of two are no numbers of one.
fn one_body(logs: &[TankLog]) -> Result<(), MethodError> {
    let name = |log: &TankLog| log.log.meta.configuration.clone();
    let of_body = || logs.iter().filter(|log| log.log.meta.role != Role::Tare);
    let Some(first) = of_body().next() else { return Ok(()) };
    match of_body().find(|log| name(log) != name(first)) {
        None => Ok(()),
        Some(other) => {
            let what = format!(
                "is of the configuration {:?} where {} is of {:?}; the coefficients are of one body: give each a folder and a [[source]] of its own",
                name(other),
                first.log.meta.id,
                name(first)
            );
            Err(MethodError::input(&other.log.path, what))
        }
    }
}

/// A log as a run: its angle and its torque.
fn run(log: &TankLog) -> Result<RotationRun<'_>, MethodError> {
    if let Some(flow) = logs::condition(log, "flow", Dimension::SPEED)?.filter(|flow| *flow != 0.0) {
        let what = format!(
            "was done in a stream of {flow} m/s, which turns on the body with a moment of its own; these coefficients are of water at rest: repeat it there"
        );
        return Err(MethodError::input(&log.log.path, what));
    }
    Ok(RotationRun {
        id: &log.log.meta.id,
        mounted: mounted(log.log.meta.role),
        time_s: &log.log.time_s,
        angle_rad: &channel(log, "angle", Dimension::ANGLE)?.values,
        torque_n_m: &channel(log, "torque", Dimension::MOMENT)?.values,
    })
}

fn channel<'a>(log: &'a TankLog, name: &str, dimension: Dimension) -> Result<&'a Channel, MethodError> {
    let along = if name == "angle" {
        "the body about the axis of rotation"
    } else {
        "the rig on the body, about the same axis"
    };
    logs::channel(log, name, dimension, "added inertia is wrong by its size where one is guessed", along)
}
