//! Free decay as a source of a campaign: a folder of logs, one release each.

use crate::decay::axis::Motion;
use crate::decay::rates::fitted_by;
use crate::decay::section;
use crate::decay::{DecayFit, DecayRun, DecaySetup, Method as DecayMethod, RunSummary};
use crate::decay::{plan, plausible, record, releases};
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
use froude_records::page::{Chart, ChartPanel, Mark, Series};
use froude_records::run::{Channel, Role};
use froude_records::units::Dimension;

/// Their names.
const NAMES: [&str; 3] = [DecayMethod::ALL[0].name(), DecayMethod::ALL[1].name(), BOTH];

/// Both, where the releases have enough peaks.
const BOTH: &str = "decay";

/// Role of a log with a release.
const RELEASE: &str = "release";

/// Envelope and output error of releases.
pub const DECAY: TankMethod = TankMethod {
    names: &NAMES,
    words: &[DecayMethod::ALL[0].words(), DecayMethod::ALL[1].words(), "both readings of a free decay"],
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
    let is_asked = |method: &DecayMethod| asked.iter().any(|name| [BOTH, method.name()].contains(name));
    let methods: Vec<DecayMethod> = DecayMethod::ALL.into_iter().filter(is_asked).collect();
    let (mut out, mut fits) = (Vec::new(), Vec::new());
    let (mut fitted, mut failed) = (Vec::new(), Vec::new());
    for &method in &methods {
        progress(method.words());
        match fitted_by(method, &runs, &setup) {
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
    if let Some((_, fit)) = fitted.first() {
        plausible::check(&logs, &runs, &setup, fit.range.period_s)?;
    }
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
    let blocks = fits.last().map(|fit| section(fit, &runs)).into_iter().chain(fits.last().map(decrements)).collect();
    Ok(Found { results: out, blocks, findings: logs::distinct(findings), ..Found::default() })
}

/// What `[source.decay]` declares.
///
/// # Errors
///
/// It is not there, or cannot be read.
pub fn declared(source: &Source) -> Result<DecaySetup, MethodError> {
    let what = "nothing is declared of the body that oscillates: write [source.decay] with axis = \"heave\"; for its added mass inertia and stiffness too, each as { value = \
                \"12 kg\", standard = \"0.5 %\" }";
    needed(source, "decay", section::decay, what)
}

/// The same with its plan, which has displacements of its axis.
fn planning(source: &Source) -> Result<(DecaySetup, Vec<Point>), MethodError> {
    let (setup, points) = (declared(source)?, section::plan(source)?);
    if setup.restoring.is_per_inertia() {
        let what = "a planned release needs the body and its springs: write inertia and stiffness in [source.decay], each as { value = \"12 kg\", standard = \"0.5 %\" }";
        return Err(undeclared(&source.place, what));
    }
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
    let unit = fit.axis.position_unit();
    let added = match (fit.restoring.is_per_inertia(), is_angle) {
        (true, _) => "omega_rad_s",
        (false, true) => "added_kg_m2",
        (false, false) => "added_kg",
    };
    let left = match (fit.method, is_angle) {
        (DecayMethod::Envelope, true) if fit.restoring.is_per_inertia() => {
            ["residual_rms_rad_s2", "residual of the force per inertia, rms [rad/s^2]"]
        }
        (DecayMethod::Envelope, false) if fit.restoring.is_per_inertia() => {
            ["residual_rms_m_s2", "residual of the force per inertia, rms [m/s^2]"]
        }
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
        t.number(added, &format!("{} by it alone [{}]", fit.names[0], fit.units()[0]), |r| r.added).significant(4),
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

/// The logarithmic decrement of each swing, beside that of the law at its amplitude.
fn decrements(fit: &DecayFit) -> Section {
    let swings = fit.swings();
    let [key, head] =
        if fit.axis.is_rotation() { ["from_rad", "amplitude [deg]"] } else { ["from_m", "amplitude [m]"] };
    let caption = format!(
        "Logarithmic decrement of each swing: of the peak that it begins at, over the next one on the same side; and that of the law of {} at that amplitude.",
        fit.method.name()
    );
    let t = TableBuilder::new("decrements", caption, &swings);
    let table = t.build(vec![
        t.text("release", "release", |s| s.run.clone()),
        t.count("swing", "swing", |s| s.number),
        t.number(key, head, |s| s.amplitude).significant(4),
        t.number("period_s", "period [s]", |s| s.period_s).significant(4),
        t.number("decrement", "decrement [1]", |s| s.decrement).significant(4),
        t.number("law", "of the law [1]", |s| s.law).significant(4),
        t.interval("interval_95", "95 % interval of the law", |s| s.interval_95),
    ]);
    let is_angle = fit.axis.is_rotation();
    let shown = |amplitude: f64| if is_angle { amplitude.to_degrees() } else { amplitude };
    let (x, y) =
        swings.iter().filter_map(|s| Some((shown(s.amplitude), s.decrement?))).unzip::<f64, f64, Vec<_>, Vec<_>>();
    let mut law: Vec<(f64, f64, [f64; 2])> =
        swings.iter().filter_map(|s| Some((shown(s.amplitude), s.law?, s.interval_95?))).collect();
    law.sort_by(|a, b| a.0.total_cmp(&b.0));
    let end = |k: usize| law.iter().map(|(.., ends)| ends[k]).collect::<Vec<f64>>();
    let of_law = Series {
        low: end(0),
        high: end(1),
        ..series(
            "law, with its 95 % interval",
            Mark::Line,
            law.iter().map(|(x, ..)| *x).collect::<Vec<_>>(),
            law.iter().map(|(_, y, _)| *y).collect::<Vec<_>>(),
        )
    };
    let panel =
        drawn::panel("logarithmic decrement [1]".to_owned(), vec![series("each swing", Mark::Points, x, y), of_law]);
    let chart = Chart {
        name: "decrements".to_owned(),
        title: "Decrement by amplitude".to_owned(),
        caption: format!(
            "Logarithmic decrement of each swing, and of the law fitted by {}, against the amplitude at which the swing begins.",
            fit.method.name()
        ),
        x_label: head.to_owned(),
        panels: vec![panel],
        ..Chart::default()
    };
    Section::new("Decrement by amplitude", [chart.into(), table.into()])
}

/// A log as a release: its time and the channel that moves.
fn release(log: &TankLog, axis: Motion) -> Result<DecayRun<'_>, MethodError> {
    let unit = if axis.is_rotation() { Dimension::ANGLE } else { Dimension::LENGTH };
    let channels = &log.log.channels;
    let is_meant = |c: &&Channel| c.meaning.unit == unit.to_string();
    let alike: Vec<&Channel> = channels.values().filter(is_meant).collect();
    // Any name will do where only one column can be meant: a pure number may be anything, a length is the position.
    let only = alike.first().copied().filter(|_| alike.len() == 1 && !axis.is_rotation());
    let named: Vec<&str> =
        axis.column_names().iter().copied().filter(|name| channels.get(*name).as_ref().is_some_and(is_meant)).collect();
    if let [first, second, ..] = named[..] {
        let what = format!(
            "{first} and {second} can both be the position of a release: leave one out of the log, or name it otherwise in a sidecar, {second} = {{ name = \"other\", unit = \"deg\" }}"
        );
        return Err(MethodError::input(&log.log.path, what));
    }
    let Some(position) = named.first().and_then(|name| channels.get(*name)).or(only) else {
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
