//! Free decay as a source of a campaign: a folder of logs, one release each.

use crate::decay::axis::Motion;
use crate::decay::section;
use crate::decay::{DecayFit, DecayRun, DecaySetup, Method as DecayMethod, RunSummary};
use crate::decay::{envelope, output_error, plan, record, releases};
use crate::declared::{check, needed};
use crate::drawn::{self, first_of, over_time, series};
use crate::error::undeclared;
use crate::findings::warning;
use crate::log::TankLog;
use crate::logs::{self, Logs, Wanted};
use crate::long_logs::Lengths;
use crate::matrix::Point;
use crate::method::TankMethod;
use crate::names::FREE_DECAY;
use froude_identify::method::{Declares, Found, MethodError, Need};
use froude_records::block::{Section, TableBuilder};
use froude_records::campaign::{Campaign, Source};
use froude_records::page::{ChartPanel, Mark};
use froude_records::run::{Channel, Role};
use froude_records::units::Dimension;

/// Their names.
const NAMES: [&str; 2] = [DecayMethod::ALL[0].name(), DecayMethod::ALL[1].name()];

/// Role of a log with a release.
const RELEASE: &str = "release";

fn named(name: &str) -> Option<DecayMethod> {
    DecayMethod::ALL.into_iter().find(|method| method.name() == name)
}

/// Envelope and output error of releases.
pub const DECAY: TankMethod = TankMethod {
    names: &NAMES,
    words: &[DecayMethod::ALL[0].words(), DecayMethod::ALL[1].words()],
    needs: &[Need::of(&[RELEASE], &[])],
    runs: FREE_DECAY,
    takes: &["plan", "decay"],
    identify,
    simulate: |campaign, source| {
        let (setup, points) = planning(source)?;
        releases::files(campaign, &points, &setup)
    },
    plan: |campaign, source| {
        let (setup, points) = planning(source)?;
        plan::prospect(campaign, source, &points, &setup)
    },
    declares: Declares { section: "decay", keys: section::KEYS, plan: section::PLAN },
    check: |source| check(source, "decay", section::decay, section::plan),
};

fn identify(
    campaign: &Campaign,
    source: &Source,
    asked: &[&'static str],
    progress: &dyn Fn(&str),
) -> Result<Found, MethodError> {
    let setup = declared(source)?;
    progress("reading the releases");
    let wanted = Wanted {
        assumed: Some(RELEASE),
        lengths: Lengths::WHOLE,
        ..Wanted::of(FREE_DECAY, &[Role::Decay], "`time [s]` and `position [m]` (or `angle [deg]`)")
    };
    let Logs { runs: logs, files, mut findings } = logs::read(source.input.path(), &wanted, progress)?;
    logs::one_body(&logs)?;
    let runs = logs.iter().map(|log| release(log, setup.axis)).collect::<Result<Vec<_>, _>>()?;
    let methods: Vec<DecayMethod> = asked.iter().filter_map(|name| named(name)).collect();
    let (mut out, mut fits) = (Vec::new(), Vec::new());
    let (mut fitted, mut failed) = (Vec::new(), Vec::new());
    for &method in &methods {
        progress(method.words());
        let fit: Result<DecayFit, _> = match method {
            DecayMethod::Envelope => envelope(&runs, &setup),
            DecayMethod::OutputError => output_error(&runs, &setup),
        };
        match fit {
            Ok(fit) => fitted.push((method, fit)),
            Err(why) => failed.push((method, why)),
        }
    }
    // A method that fails costs itself alone; where all fail, nothing is found.
    if fitted.is_empty()
        && let Some((method, why)) = failed.pop()
    {
        return Err(MethodError::input(source.input.path(), format!("{}: {why}", method.name())));
    }
    findings.extend(failed.into_iter().map(|(method, why)| {
        let text = format!("{} could not be fitted and is left out: {why}", method.name());
        warning("not-fitted", text)
    }));
    let best = fitted.iter().map(|(method, _)| *method).max_by_key(|method| *method == DecayMethod::OutputError);
    for (method, fit) in fitted {
        let mut result = record::result(&fit, campaign, source, best == Some(method))?;
        result.files.clone_from(&files);
        findings.append(&mut result.findings);
        out.push(result.into());
        fits.push(fit);
    }
    findings.extend(fits.first().zip(fits.get(1)).and_then(|(a, b)| a.disagrees_with(b)));
    // What both state about a release is reported once.
    let blocks = fits.last().map(|fit| section(fit, &runs)).into_iter().collect();
    Ok(Found { results: out, blocks, findings: logs::distinct(findings), ..Found::default() })
}

/// What `[source.decay]` declares.
///
/// # Errors
///
/// It is not there, or cannot be read.
pub fn declared(source: &Source) -> Result<DecaySetup, MethodError> {
    let what = "nothing is declared of the body that oscillates: write [source.decay] with axis = \"heave\", inertia and stiffness, each as { value = \
                \"12 kg\", standard = \"0.5 %\" }";
    needed(source, "decay", section::decay, what)
}

/// The same with its plan, which has displacements of its axis.
fn planning(source: &Source) -> Result<(DecaySetup, Vec<Point>), MethodError> {
    let (setup, points) = (declared(source)?, section::plan(source)?);
    let is_angle = setup.axis.is_rotation();
    let [needed, found] = if is_angle { ["angle", "displacement"] } else { ["displacement", "angle"] };
    if points.iter().any(|point| !point.conditions.contains_key(needed)) {
        let what = format!("[[source.plan]] states {found}, but the axis is {}: write {needed}", setup.axis.name());
        return Err(undeclared(&source.place, what));
    }
    Ok((setup, points))
}

/// Releases whose motion is drawn; more would be a page of the same.
const DRAWN: usize = 6;

/// The releases on the page: what was used of each, and the motion with that of the fit.
fn section(fit: &DecayFit, runs: &[DecayRun<'_>]) -> Section {
    let is_angle = fit.axis.is_rotation();
    let (unit, added) = if is_angle { ("rad", "kg_m2") } else { ("m", "kg") };
    let left = match (fit.method, is_angle) {
        (DecayMethod::OutputError, true) => ["residual_rms_rad", "residual of the position, rms [rad]"],
        (DecayMethod::OutputError, false) => ["residual_rms_m", "residual of the position, rms [m]"],
        (DecayMethod::Envelope, true) => ["residual_rms_n_m", "residual of the force, rms [N m]"],
        (DecayMethod::Envelope, false) => ["residual_rms_n", "residual of the force, rms [N]"],
    };
    let caption = format!("Data used of each release, by {}.", fit.method.name());
    let t = TableBuilder::new("releases", caption, &fit.runs);
    let of = |key: &str, head: &str, of: fn(&RunSummary) -> f64| {
        t.number(&format!("{key}_{unit}"), &format!("{head} [{unit}]"), of)
    };
    let table = t.build(vec![
        t.text("release", "release", |r| r.id.clone()),
        t.count("half_cycles", "half cycles", |r| r.half_cycles),
        t.number("period_s", "period [s]", |r| r.period_s).significant(5),
        t.number(
            &format!("added_{added}"),
            &format!("{} by it alone [{}]", fit.names[0], fit.axis.decay_units()[0]),
            |r| r.added,
        )
        .significant(4),
        t.number("from_s", "fit starts at [s]", |r| r.from_s).plain(4),
        of("position", "initial position", |r| r.start[0]).plain(4),
        t.number(&format!("speed_{unit}_s"), &format!("initial speed [{unit}/s]"), |r| r.start[1]).plain(3),
        of("rest", "rest", |r| r.rest).plain(3),
        of("noise", "noise of a sample", |r| r.noise).significant(2),
        t.number(left[0], left[1], |r| r.residual_rms).significant(2),
    ]);
    let panel = |summary: &RunSummary| {
        let run = runs.iter().find(|run| run.id == summary.id)?;
        let first = run.time_s.partition_point(|t| *t < summary.from_s);
        let time_s = run.time_s.get(first..first + summary.fitted.len())?;
        let measured = series("measured", Mark::Points, run.time_s, run.position);
        let fitted = series("fitted", Mark::Line, time_s, &summary.fitted[..]);
        Some(drawn::panel(format!("{} [{unit}]", summary.id), vec![measured, fitted]))
    };
    let panels: Vec<ChartPanel> =
        fit.runs.iter().filter(|run| !run.fitted.is_empty()).take(DRAWN).filter_map(panel).collect();
    let of = first_of(panels.len(), fit.runs.len());
    let caption = format!("Position of {of}the releases as measured, and the fitted motion where it was used.");
    let chart = (!panels.is_empty()).then(|| over_time(["releases", "Motion and fit"], caption, panels).into());
    Section::new("Releases", std::iter::once(table.into()).chain(chart))
}

/// A log as a release: its time and the channel that moves.
fn release(log: &TankLog, axis: Motion) -> Result<DecayRun<'_>, MethodError> {
    let (names, unit): (&[&str], Dimension) = if axis.is_rotation() {
        (&["angle"], Dimension::ANGLE)
    } else {
        (&["y/position", "position"], Dimension::LENGTH)
    };
    let channels = &log.log.channels;
    let is_meant = |c: &&Channel| c.meaning.unit == unit.to_string();
    let alike: Vec<&Channel> = channels.values().filter(is_meant).collect();
    // Any name will do where only one column can be meant.
    let only = alike.first().copied().filter(|_| alike.len() == 1 && !axis.is_rotation());
    let found = names.iter().find_map(|name| channels.get(*name).filter(is_meant)).or(only);
    let Some(position) = found else {
        let head = if axis.is_rotation() { "angle [deg]" } else { "position [m]" };
        let there: Vec<&str> = channels.keys().map(|name| name.trim_start_matches("y/")).collect();
        let there = if there.is_empty() { "nothing beside the time".to_owned() } else { there.join(", ") };
        return Err(MethodError::input(
            &log.log.path,
            format!("a release needs `{head}`; it has {there}: head the column so, or map it with a sidecar"),
        ));
    };
    Ok(DecayRun { id: &log.log.meta.id, time_s: &log.log.time_s, position: &position.values })
}
