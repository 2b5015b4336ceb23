//! Excited response as a source of a campaign: a folder of logs, one run each, with a sidecar that says whether the body is held or free.

use std::borrow::Cow;

use crate::names::EXCITED_RESPONSE;
use froude_identify::answer::Made;
use froude_identify::method::{Declares, Found, MethodError, Need};
use froude_records::campaign::{Campaign, Source};
use froude_records::run::{Channel, Role};
use froude_records::units::Dimension;

use super::section::setup_of;
use super::setup::{ACCELERATION, FORCE, POSITION, REFERENCE, Shows, WaveRun};
use super::{findings, fit, page, plan, record, section, simulate};
use crate::declared::check;
use crate::log::TankLog;
use crate::logs::{self, Logs, Wanted, distinct};
use crate::method::TankMethod;

const WORDS: &str =
    "added mass and damping of a section in waves, from the force on the held body and the motion of the free one";
const WHY: &str = "added mass and damping follow from the phase between force and motion, which a guess turns";

/// Force of the held body over the motion of the free one.
pub const EXCITED: TankMethod = TankMethod {
    names: &[EXCITED_RESPONSE],
    words: &[WORDS],
    needs: &[Need::of(&["held"], &[REFERENCE, FORCE]), Need::of(&["free"], &[REFERENCE])],
    runs: EXCITED_RESPONSE,
    takes: &[EXCITED_RESPONSE, "uncertainty", "plan"],
    identify: |campaign, source, _, progress| identify(campaign, source, progress),
    simulate: simulate::files,
    plan: plan::prospect,
    declares: Declares { section: EXCITED_RESPONSE, keys: section::KEYS, plan: section::PLAN },
    check: |source| check(source, EXCITED_RESPONSE, section::excited, section::plan),
};

fn identify(campaign: &Campaign, source: &Source, progress: &dyn Fn(&str)) -> Result<Found, MethodError> {
    let mut setup = setup_of(source)?;
    progress("reading the runs");
    let channels = "time, wavemaker, and force or acceleration";
    let wanted = Wanted::of(EXCITED_RESPONSE, &[Role::Held, Role::Free], channels);
    let Logs { runs: logs, files, findings: mut said } = logs::read(source.input.path(), &wanted, progress)?;
    // A camera beside accelerometers is compared, and its clock is no part of the result.
    let late = |log: &TankLog| {
        let is_compared = log.log.channels.keys().any(|name| name.starts_with(ACCELERATION));
        let used = log.told.iter().filter(|(name, _)| !(is_compared && name.as_str() == POSITION));
        used.map(|(_, told)| told.time_standard_s).fold(0.0, f64::max)
    };
    let clocks_s = logs.iter().map(late).fold(0.0, f64::max);
    setup.delay_s.standard = setup.delay_s.standard.hypot(clocks_s);
    let runs = logs.iter().map(run).collect::<Result<Vec<_>, _>>()?;
    progress("fitting the waves");
    let found = fit(&runs, &setup).map_err(MethodError::refused)?;
    said.extend(findings::findings(&found, &runs, &setup));
    let best = record::narrowest(&found);
    let made = |(i, at)| {
        let context = record::Context { campaign, source, setup: &setup, runs: &runs };
        let estimate = record::estimate(at, &context, i == best);
        Made { name: estimate.id.clone(), estimate, files: files.clone() }.into()
    };
    Ok(Found {
        results: found.iter().enumerate().map(made).collect(),
        summary: Some(page::coefficients(&found)),
        blocks: vec![page::section(&found, &runs)],
        findings: distinct(said),
        ..Found::default()
    })
}

/// A log as a run: the wavemaker, and the force on the held body or the motion of the free one.
fn run(log: &TankLog) -> Result<WaveRun<'_>, MethodError> {
    let meta = &log.log.meta;
    let period_s = logs::condition(log, "period", Dimension::TIME)?;
    let reference = channel(log, REFERENCE, Dimension::LENGTH, "the wavemaker away from the beach")?;
    let of = |shows, signal| WaveRun {
        id: &meta.id,
        period_s,
        time_s: &log.log.time_s,
        reference: &reference.values,
        shows,
        signal,
        camera_m: None,
    };
    if meta.role == Role::Held {
        let force =
            channel(log, FORCE, Dimension::FORCE, "the water on the body along the axis that its motion counts along")?;
        return Ok(of(Shows::Force, Cow::Borrowed(&force.values)));
    }
    let heave = "the motion along the axis that the force counts along";
    let names: Vec<&String> = log.log.channels.keys().filter(|name| name.starts_with(ACCELERATION)).collect();
    let has_position = log.log.channels.contains_key(POSITION);
    let position = || channel(log, POSITION, Dimension::LENGTH, heave);
    if names.is_empty() {
        if !has_position {
            let there: Vec<&str> = log.log.channels.keys().map(String::as_str).collect();
            let what = format!(
                "a run with the free body needs its motion: {ACCELERATION} (m/s²; of several, each named {ACCELERATION}_…, the mean is taken) or {POSITION} (m), and has {}",
                there.join(", ")
            );
            return Err(MethodError::input(&log.log.path, what));
        }
        return Ok(of(Shows::Position, Cow::Borrowed(&position()?.values)));
    }
    let all =
        names.iter().map(|name| channel(log, name, Dimension::ACCELERATION, heave)).collect::<Result<Vec<_>, _>>()?;
    let signal = match all.as_slice() {
        [only] => Cow::Borrowed(only.values.as_slice()),
        all => {
            let mean = |i: usize| all.iter().map(|channel| channel.values[i]).sum::<f64>() / all.len() as f64;
            Cow::Owned((0..log.log.time_s.len()).map(mean).collect())
        }
    };
    // Its clock is what the comparison finds.
    let compared = || logs::of_any_clock(log, POSITION, Dimension::LENGTH, WHY, heave);
    let camera = if has_position { Some(compared()?.values.as_slice()) } else { None };
    Ok(WaveRun { camera_m: camera, ..of(Shows::Acceleration, signal) })
}

fn channel<'a>(log: &'a TankLog, name: &str, dimension: Dimension, along: &str) -> Result<&'a Channel, MethodError> {
    logs::channel(log, name, dimension, WHY, along)
}
