//! A method with a motor-driven body as a source of a campaign: a folder of logs, one run each, with a sidecar that states what it is.

use froude_fit::budget::Uncertain;
use froude_identify::answer::Made;
use froude_identify::method::{Declares, Found, MethodError, Need};
use froude_records::campaign::{Campaign, Source};
use froude_records::finding::{Finding, Severity};
use froude_records::number::significant;
use froude_records::run::Role;
use indexmap::IndexMap;

use super::derived::{Derived, derived};
use super::fit::{fit, motions, views};
use super::fitted::Fitted;
use super::lag;
use super::method::MotorDriven;
use super::read::{check, setups};
use super::run::Run;
use super::setup::Setup;
use super::spec::{Channel, Constant, Enters, Point};
use super::still_fit::fit_still_runs;
use super::{page, plan, record, still_page, twin};
use crate::conditioning::stretches::keep_still_part;
use crate::findings::warning;
use crate::joint::JointFit;
use crate::joint::findings::{contradicted, few_runs, misfit, of_motion, undetermined};
use crate::log::TankLog;
use crate::logs::{self, Logs, Wanted, distinct};
use crate::long_logs::{self, LENGTHS, Lengths};
use crate::matrix::CONFIGURATIONS;
use crate::method::TankMethod;
use crate::motion::Sampled;

/// The method as it stands in the registry; `needs` states the channels of each role, `takes` the keys of a source beside its own section.
#[must_use]
pub const fn method<M: MotorDriven>(
    name: &'static [&'static str; 1],
    words: &'static [&'static str; 1],
    needs: &'static [Need],
    takes: &'static [&'static str],
) -> TankMethod {
    TankMethod {
        names: name,
        words,
        needs,
        runs: name[0],
        takes,
        identify: |campaign, source, _, progress| identified::<M>(campaign, source, LENGTHS, progress),
        simulate: twin::files::<M>,
        plan: plan::prospect::<M>,
        declares: Declares { section: name[0], keys: M::SPEC.keys, plan: M::SPEC.plan },
        check: check::<M>,
    }
}

/// Reads, fits, chooses; logs beyond `lengths` are averaged.
pub(crate) fn identified<M: MotorDriven>(
    campaign: &Campaign,
    source: &Source,
    lengths: Lengths,
    progress: &dyn Fn(&str),
) -> Result<Found, MethodError> {
    let spec = M::SPEC;
    progress("reading the runs");
    let channels: Vec<&str> =
        std::iter::once(spec.motion.name).chain(spec.loads.iter().map(|load| load.name)).collect();
    let words =
        channels.split_last().map_or_else(String::new, |(last, rest)| format!("time, {} and {last}", rest.join(", ")));
    let wanted = Wanted { lengths, ..Wanted::of(spec.name, spec.roles.1, &words) };
    let Logs { runs: logs, mut files, mut findings } = logs::read(source.input.path(), &wanted, progress)?;
    if spec.plan.iter().all(|key| key.name != CONFIGURATIONS) {
        logs::one_body(&logs)?;
    }
    let mut setups = setups::<M>(campaign, source, &logs::configurations(&logs), None)?;
    let (mut still, logs): (Vec<TankLog>, Vec<TankLog>) =
        logs.into_iter().partition(|log| log.log.meta.role == Role::Still);
    still.iter_mut().try_for_each(keep_still_part)?;
    let still_runs = still.iter().map(run::<M>).collect::<Result<Vec<_>, _>>()?;
    for setup in &mut setups {
        setup.still_fits = fit_still_runs(&still_runs, setup).map_err(MethodError::refused)?;
    }
    let stamps = |log, load: &Channel| logs::stamps_standard_s(log, [spec.motion.name, load.name]);
    let of_log = |log| spec.loads.iter().map(move |load| stamps(log, load)).fold(0.0, f64::max);
    let clocks_s = logs.iter().map(of_log).fold(0.0, f64::max);
    for log in &logs {
        // An error that both loads have from one clock or one sampler is part of their one delay.
        let late = |load: &Channel| logs::lateness(log, load.name);
        let apart_s = |pair: &[Channel]| logs::stamps_standard_s(log, [pair[0].name, pair[1].name]);
        let is_apart = |pair: &&[Channel]| apart_s(pair) > 0.0 && late(&pair[0]) != late(&pair[1]);
        if let Some(pair) = spec.loads.windows(2).find(is_apart) {
            let what = format!(
                "the times of {} and {} are known relative to each other only to {:.1} ms, and one delay is fitted for both: log the loads with one clock",
                pair[0].name,
                pair[1].name,
                1e3 * apart_s(pair)
            );
            return Err(MethodError::input(&log.log.path, what));
        }
    }
    for constant in setups.iter_mut().flat_map(|setup| &mut setup.constants).filter(|c| c.enters == Enters::Delay) {
        // The uncertainty of the clocks adds to that of a declared delay; a fitted delay absorbs it.
        if let Some(delay) = &mut constant.known {
            delay.standard = delay.standard.hypot(clocks_s);
        }
    }
    let runs = logs.iter().map(run::<M>).collect::<Result<Vec<_>, _>>()?;
    progress(&format!("fitting the {}", spec.motion.name));
    let sampled: Vec<Sampled<'_>> = logs.iter().map(Sampled::of).collect();
    let Some(first) = setups.first() else { return Ok(Found::default()) };
    let motions = motions(&runs, first, &sampled).map_err(MethodError::refused)?;
    for (log, motion) in logs.iter().zip(&motions) {
        logs::add_step(&mut files, log, logs::cycles_step(log, motion, spec.motion.name));
    }
    let fastest_hz: Vec<f64> = motions.iter().map(|m| first.harmonics as f64 / m.angle.period_s()).collect();
    let (cycles, harmonics) = (first.cycles, first.harmonics);
    let (mut fits, mut failed) = (Vec::new(), Vec::new());
    for setup in setups {
        let law = setup.method.law().to_owned();
        progress(&format!("fitting the law {law}"));
        match fit(&runs, &motions, &setup, &campaign.identify) {
            Ok(fit) => fits.push((setup, fit)),
            Err(why) => failed.push((law, why)),
        }
    }
    // A failed law does not stop the others; it is an error only if all fail.
    if fits.is_empty()
        && let Some((_, why)) = failed.pop()
    {
        return Err(MethodError::refused(why));
    }
    let left_out = |(law, why)| warning("not-fitted", format!("{law} could not be fitted and is left out: {why}"));
    findings.extend(failed.into_iter().map(left_out));
    let points: Vec<&Point> = runs.iter().map(|run| &run.point).collect();
    let of_fit_alone = |(setup, fit): &(Setup<M>, JointFit)| derived(fit, &setup.method.sums(setup, &points));
    let derived: Vec<Vec<Derived>> = fits.iter().map(of_fit_alone).collect();
    let fitted: Vec<Fitted<'_, M>> = (fits.iter().zip(&derived))
        .map(|((setup, fit), derived)| Fitted { fit, setup, runs: &runs, motions: &motions, derived, campaign })
        .collect();
    let chosen = record::chosen(&fits);
    let each = runs.iter().zip(&motions);
    findings.extend(each.flat_map(|(run, motion)| of_motion(run.id, motion, &spec.motion, cycles, harmonics)));
    findings.extend(still_page::findings(fitted[0].setup));
    findings.extend(still_page::contradicted(&fitted[chosen]));
    findings.extend(fitted[0].setup.method.about_runs(&fitted[0]));
    findings.extend(logs.iter().zip(&fastest_hz).filter_map(|(log, hz)| long_logs::too_coarse(log, *hz)));
    let of_fits: Vec<Finding> = fitted.iter().flat_map(of_fit).collect();
    // A law that is wrong shifts the delay, too.
    if !of_fits.iter().any(|f| f.code == "misfit-repeats" && f.message.starts_with(&fitted[chosen].fit.law)) {
        findings.extend(lag::undeclared(&fitted[chosen]));
    }
    findings.extend(of_fits);
    let estimate = |(i, fitted): (usize, &Fitted<'_, M>)| {
        let mut estimate = record::estimate(fitted, (campaign, source), (i == chosen).then_some(fits.len()));
        if let Some(step) = long_logs::step(&logs, &fastest_hz) {
            estimate.method.words = format!("{step}; {}", estimate.method.words);
        }
        Made { name: estimate.id.clone(), estimate, files: files.clone() }.into()
    };
    Ok(Found {
        results: fitted.iter().enumerate().map(estimate).collect(),
        summary: Some(page::results(&fits, &fitted[chosen])),
        blocks: vec![page::section(&fitted[chosen])],
        findings: distinct(findings),
        ..Found::default()
    })
}

/// What a fit shows.
#[must_use]
pub fn of_fit<M: MotorDriven>(fitted: &Fitted<'_, M>) -> Vec<Finding> {
    let (spec, Fitted { fit, setup, runs, motions, .. }) = (M::SPEC, fitted);
    let mut out = misfit(fit, &views(runs, motions), spec.loads, spec.repeats);
    let (added, sign) = spec.added;
    if let Some(unknown) = fit.unknown(added)
        && let Some((value, combined)) = unknown.value.zip(unknown.combined)
        && combined.interval(value).iter().all(|end| sign * end < 0.0)
    {
        let text = format!(
            "{}: {added} is {} {}, and its whole 95 % interval has the wrong sign: check the signs of {} and {}, and the declared mass or inertia below the load cell",
            fit.law,
            significant(value, 3),
            unknown.unit,
            spec.motion.name,
            spec.loads[0].name
        );
        out.push(Finding::new(Severity::Error, "negative-added-mass", text));
    }
    out.extend(undetermined(fit, spec.undetermined));
    let known = |c: &Constant| Some((c.unknown.as_ref()?.name.clone(), c.known?));
    let declared: Vec<(String, Uncertain)> = setup.constants.iter().filter_map(known).collect();
    let check = format!("signs and clocks of {} and {}", spec.motion.name, spec.loads[0].name);
    out.extend(contradicted(fit, &declared, &check));
    out.extend(setup.method.about_fit(fitted));
    out.extend(few_runs(fit));
    out
}

/// A log as a run: its motion and loads, and the conditions that it was done in.
fn run<M: MotorDriven>(log: &TankLog) -> Result<Run<'_>, MethodError> {
    let (spec, meta) = (M::SPEC, &log.log.meta);
    logs::only_conditions(log, spec.conditions.iter().map(|condition| condition.name))?;
    let mut conditions = IndexMap::new();
    for condition in spec.conditions {
        let declared = logs::condition(log, condition.name, condition.dimension)?;
        let value = (condition.of)(meta.role, declared).map_err(|what| MethodError::input(&log.log.path, what))?;
        if spec.plan.iter().any(|key| key.name == condition.name) {
            conditions.insert(condition.name, value);
        }
    }
    let values = |channel: &Channel| {
        logs::channel(log, channel.name, channel.dimension, spec.guessed, channel.along).map(|c| c.values.as_slice())
    };
    Ok(Run {
        id: &meta.id,
        point: Point { id: meta.id.clone(), role: meta.role, configuration: meta.configuration.clone(), conditions },
        time_s: &log.log.time_s,
        motion: values(&spec.motion)?,
        loads: spec.loads.iter().map(values).collect::<Result<_, _>>()?,
    })
}
