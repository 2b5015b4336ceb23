//! Steady tows as a source of a campaign: a folder of logs, one run each, reduced to the rows of a table.

use crate::names::STEADY;
use froude_identify::method::{Declares, Found, MethodError, Need};
use froude_identify::reduce::reduce_table;
use froude_identify::source::identify_observations;
use froude_identify::uncertainty::SharedError;
use froude_records::campaign::{Campaign, Source};
use froude_records::campaign_keys::ROWS;
use froude_records::finding::{Finding, Severity};
use froude_records::run::Role;
use froude_records::run::marks::SegmentKind;
use froude_records::run::step::Step;
use froude_records::text::counted;
use froude_records::units::Dimension;

use super::point::{Point, Run, Zero, point_told};
use super::row::{Row, angle_rad, table};
use super::section::{self, SteadySpec};
use super::tare::{self, Tare};
use super::walls::Walls;
use super::window::{Motion, Told};
use super::{page, plan, simulate};
use crate::conditioning::stretches::{in_words, longest_free, rows};
use crate::error::{TankError, undeclared};
use crate::findings::{note, warning};
use crate::log::TankLog;
use crate::logs::{self, Logs};
use crate::method::TankMethod;

/// Loads that a log may have, and their dimension.
const LOADS: [(&str, Dimension); 6] = [
    ("f_x", Dimension::FORCE),
    ("f_y", Dimension::FORCE),
    ("f_z", Dimension::FORCE),
    ("m_x", Dimension::MOMENT),
    ("m_y", Dimension::MOMENT),
    ("m_z", Dimension::MOMENT),
];
/// A drift of the zero this many of its standard uncertainties is none of chance.
const DRIFTS: f64 = 4.0;

/// Windows of raw runs as observations.
pub const STEADY_TOW: TankMethod = TankMethod {
    names: &[STEADY],
    words: &["steady windows of raw tows, or of a body held in a stream, each an observation"],
    needs: &[
        Need::of(&["test"], &[]),
        Need { is_optional: true, is_observed: false, ..Need::of(&["tare"], &[]) },
        Need { is_optional: true, is_observed: false, ..Need::of(&["still"], &[]) },
    ],
    runs: STEADY,
    takes: &[STEADY, "models", "uncertainty", "plan", "keep", "group", "tare"],
    identify: |campaign, source, _, progress| identify(campaign, source, progress),
    simulate: simulate::files,
    plan: plan::prospect,
    declares: Declares { section: STEADY, keys: section::KEYS, plan: ROWS },
    check: |source| {
        let is_of_steady = source.methods.iter().any(|method| method == STEADY);
        section::declared(source)?;
        if is_of_steady { source.rows().map(drop) } else { Ok(()) }
    },
};

fn identify(campaign: &Campaign, source: &Source, progress: &dyn Fn(&str)) -> Result<Found, MethodError> {
    let spec = section::declared(source)?;
    progress("reading the runs");
    let Logs { runs: logs, mut files, mut findings } = logs::read(
        source.input.path(),
        STEADY,
        &[Role::Test, Role::Tare, Role::Still],
        "time, speed or position, and loads",
        progress,
    )?;
    progress("looking for steady windows");
    let reduced = reduce(source, &logs, &spec)?;
    findings.extend(reduced.findings);
    let walls = Walls::of(campaign);
    findings.extend(reduced.rows.iter().filter_map(|row| walls.and_then(|walls| walls.finding(row))));
    for (run, step) in reduced.steps {
        if let Some(log) = logs.iter().find(|log| log.log.meta.id == run) {
            logs::add_step(&mut files, log, step);
        }
    }
    let table = table(source.input.path(), &reduced.rows);
    let mut observations = reduce_table(campaign, source, &table, files)?;
    if !reduced.errors.is_empty() && observations.data.rows != reduced.rows.len() {
        let what =
            "`keep` and runs of the role tare do not go together: leave the logs that are not meant out of the folder";
        return Err(undeclared(&source.place, what));
    }
    observations.shared_errors.extend(reduced.errors);
    let mut result = identify_observations(campaign, source, observations, STEADY, &|model| {
        progress(&format!("fitting {model}"));
    })?;
    findings.append(&mut result.findings);
    let blocks = vec![page::section(&logs, &reduced.rows, &spec)];
    Ok(Found { results: vec![result.into()], blocks, findings, ..Found::default() })
}

/// Observations of a folder.
struct Reduced {
    rows: Vec<Row>,
    errors: Vec<SharedError>,
    findings: Vec<Finding>,
    /// The window of each run, by its id.
    steps: Vec<(String, Step)>,
}

/// Every test as an observation; one that gives none is left out and said, unless none is left.
fn reduce(source: &Source, logs: &[TankLog], spec: &SteadySpec) -> Result<Reduced, MethodError> {
    let (mut findings, mut steps) = (Vec::new(), Vec::new());
    let stills = stills(logs)?;
    let (mut rows, mut tares) = (Vec::new(), Vec::new());
    let mut first: Option<TankError> = None;
    for log in logs.iter().filter(|log| log.log.meta.role != Role::Still) {
        let mut run = run(log)?;
        let found = match zero(log, &run, &stills, spec)? {
            Some(Err(error)) => Err(error),
            zero => {
                run.zero = zero.and_then(Result::ok);
                point_told(&run, spec, &Told { marks: &log.declared.marks, segments: &log.declared.segments })
            }
        };
        match found {
            Ok(point) => {
                findings.extend(of_point(&log.log.meta.id, &point));
                findings.extend(of_named_window(log, &run, &point, spec));
                steps.push((log.log.meta.id.clone(), window_step(log, &point)));
                if log.log.meta.role == Role::Tare {
                    tares.push(Tare { angle_rad: angle_rad(log)?, point });
                } else {
                    rows.push(Row::of(log, point)?);
                }
            }
            Err(error) => {
                findings.push(logs::left_out(&error));
                first.get_or_insert(error);
            }
        }
    }
    if rows.is_empty() {
        return Err(logs::no_run(source, first));
    }
    let mut errors = Vec::new();
    if !tares.is_empty() {
        errors = tare::subtract(&mut rows, &tares, &source.name).map_err(MethodError::refused)?;
        let text = format!(
            "{} subtracted at the same speed and angle; what is uncertain about their mean is shared by all observations there",
            counted(tares.len(), "run without the body is", "runs without the body are")
        );
        findings.push(note("tare-subtracted", text));
    }
    Ok(Reduced { rows, errors, findings, steps })
}

/// The window of a run as a step.
fn window_step(log: &TankLog, point: &Point) -> Step {
    let named = log.declared.segments.iter().any(|segment| segment.kind == SegmentKind::Steady);
    let by = if named { "as it is named in [[segments]]" } else { "by the rule of [source.steady]" };
    let words = format!(", {by}; mean tapered at both ends, the zero between the parts at rest taken off");
    let rest = |rows: &std::ops::Range<usize>| rows.len() as f64 * log.steps.median_s;
    let step = logs::window_step(log, &point.window.steady, &words);
    let step = step.with("at_rest_before", rest(&point.window.before), "s");
    step.with("at_rest_after", rest(&point.window.after), "s").with("speed", point.speed_m_s, "m/s")
}

/// Whether a window that a person has named is steady by the rule.
fn of_named_window(log: &TankLog, run: &Run<'_>, point: &Point, spec: &SteadySpec) -> Option<Finding> {
    let segment = log.declared.segments.iter().find(|segment| segment.kind == SegmentKind::Steady)?;
    let (rows, time_s) = (point.window.steady.clone(), run.time_s);
    let block = ((spec.block_s / log.steps.median_s).round() as usize).clamp(1, rows.len());
    let speeds = (rows.start..=rows.end - block).step_by(block).map(|at| run.motion.mean_m_s(time_s, at..at + block));
    let (low, high) = speeds.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let who = if segment.by.is_empty() { "somebody" } else { &segment.by };
    let (text, severity, code) = if half > spec.tolerance * middle.abs() {
        let text = format!(
            "the speed of its blocks of {} s differs by ± {:.2} % of {middle:.4} m/s, and {:.2} % is steady by the rule; it is used as it was named",
            spec.block_s,
            1e2 * half / middle.abs(),
            1e2 * spec.tolerance
        );
        (text, Severity::Warning, "named-window-not-steady")
    } else {
        ("it is steady by the rule too".to_owned(), Severity::Note, "named-window")
    };
    let id = &log.log.meta.id;
    let text = format!(
        "run {id:?}: its window from {:.3} s to {:.3} s was named by {who}; {text}",
        segment.from_s, segment.to_s
    );
    Some(Finding::new(severity, code, text))
}

/// What one observation shows.
fn of_point(run: &str, point: &Point) -> Vec<Finding> {
    let mut out = Vec::new();
    for load in &point.loads {
        let unit = if load.name.starts_with('m') { "N m" } else { "N" };
        if load.read.has_trend() {
            out.push(warning("load-not-steady",
                format!(
                    "run {run:?}: {} changes by {:.3e} ± {:.1e} {unit} over its window: the water has not settled, or the zero drifts; settle longer, or wait longer before \
                     the run",
                    load.name, load.read.trend, load.read.trend_standard
                ),
            ));
        }
        if let Some([drift, standard]) = load.drift.filter(|[d, s]| d.abs() > DRIFTS * s) {
            out.push(note("zero-drift",
                format!(
                    "run {run:?}: the zero of {} moves by {drift:.3e} ± {standard:.1e} {unit} from before to after the tow; the straight line between them is subtracted",
                    load.name
                ),
            ));
        }
    }
    out
}

/// A log as a run; nothing about it is taken for granted.
fn run(log: &TankLog) -> Result<Run<'_>, MethodError> {
    let why = "drag is wrong by its size or its sign where one is guessed";
    let channel = |name: &str, dimension, along: &str| {
        logs::channel(log, name, dimension, why, along).map(|c| c.values.as_slice())
    };
    let has = |name: &str| log.log.channels.contains_key(name);
    let motion = if has("speed") {
        Motion::Speed(channel("speed", Dimension::SPEED, "the body's way through the water")?)
    } else if has("position") || has("y/position") {
        let name = if has("position") { "position" } else { "y/position" };
        Motion::Position(channel(name, Dimension::LENGTH, "the body's way through the water")?)
    } else {
        let stream = logs::condition(log, "speed", Dimension::SPEED)?.ok_or_else(|| {
            MethodError::input(
                &log.log.path,
                "no channel speed or position says how it moves; of a body held in a stream write [conditions] speed = \"0.2 m/s\" in its sidecar",
            )
        })?;
        Motion::Stream(stream)
    };
    let mut loads = Vec::new();
    for (name, dimension) in LOADS.iter().filter(|(name, _)| has(name)) {
        loads.push((*name, channel(name, *dimension, "the water on the body, along its axes")?));
    }
    if loads.is_empty() {
        let there: Vec<&str> = log.log.channels.keys().map(String::as_str).collect();
        let what = format!("a run needs a load (f_x, f_y, …, of the water on the body), and has {}", there.join(", "));
        return Err(MethodError::input(&log.log.path, what));
    }
    for (name, _) in &loads {
        let frame = log.log.channels[*name].meaning.frame;
        if frame != froude_records::run::Frame::Body {
            let what = format!(
                "{name} is along the axes of {:?}; loads are taken along those of the body: declare how the cell lies in [frames.cell] and write frame = \"cell\", or frame = \"body\" where it is mounted with the body",
                frame.name()
            );
            return Err(MethodError::input(&log.log.path, what));
        }
    }
    Ok(Run { id: &log.log.meta.id, time_s: &log.log.time_s, motion, loads, zero: None })
}

/// A still run: when it was, and its mean loads.
struct Still {
    at_s: f64,
    loads: Vec<(String, Zero)>,
}

/// The part of a still run that is used: the one that is named, without marks.
fn at_rest(log: &TankLog) -> Result<std::ops::Range<usize>, MethodError> {
    let (time_s, declared) = (&log.log.time_s, &log.declared);
    let named = declared.segments.iter().find(|segment| segment.kind == SegmentKind::Still);
    let whole = named.map_or(0..time_s.len(), |segment| rows(time_s, segment.from_s, segment.to_s));
    longest_free(time_s, whole, &declared.marks).filter(|rows| rows.len() >= 4).ok_or_else(|| {
        let what = format!("nothing is left of this still run: {}; take another", in_words(&declared.marks));
        MethodError::input(&log.log.path, what)
    })
}

fn stills(logs: &[TankLog]) -> Result<Vec<Still>, MethodError> {
    let mut out = Vec::new();
    for log in logs.iter().filter(|log| log.log.meta.role == Role::Still) {
        let at_s = logs::condition(log, "at", Dimension::TIME)?.ok_or_else(|| {
            MethodError::input(
                &log.log.path,
                "a still run states when it was: write [conditions] at = \"0 s\" in its sidecar, counted from the same moment as those of the tests",
            )
        })?;
        let step_s = log.steps.median_s;
        let rows = at_rest(log)?;
        let of = |name: &str| {
            let mean = log.log.channels.get(name).map(|c| froude_fit::series::mean(&c.values[rows.clone()], step_s));
            mean.map(|m| (name.to_owned(), Zero { value: m.value, standard: m.standard }))
        };
        out.push(Still { at_s, loads: LOADS.iter().filter_map(|(name, _)| of(name)).collect() });
    }
    out.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    Ok(out)
}

/// The zero of a run from the still runs before and after it; `None` where there is none, or nothing says when it was.
fn zero(
    log: &TankLog,
    run: &Run<'_>,
    stills: &[Still],
    spec: &SteadySpec,
) -> Result<Option<Result<Vec<Zero>, TankError>>, MethodError> {
    let Some(at_s) = logs::condition(log, "at", Dimension::TIME)?.filter(|_| !stills.is_empty()) else {
        return Ok(None);
    };
    let before = stills.iter().rfind(|still| still.at_s <= at_s);
    let after = stills.iter().find(|still| still.at_s > at_s);
    let away_s = [before, after].iter().flatten().map(|s| (s.at_s - at_s).abs()).fold(f64::INFINITY, f64::min);
    let drift_n = spec.drift.map_or(0.0, |drift| drift.rate_n_s * away_s);
    if let Some(drift) = spec.drift.filter(|drift| drift_n > drift.most_n) {
        let what = format!(
            "the nearest still run is {away_s:.0} s away, over which the zero may drift by {drift_n:.3e} N, and {:.3e} N is allowed; take a still run \
             nearer to it, or state a smaller drift (drift in [source.steady])",
            drift.most_n
        );
        return Ok(Some(Err(TankError::of_run(run.id, what))));
    }
    let of = |still: &Still, name: &str| still.loads.iter().find(|(n, _)| n == name).map(|(_, zero)| *zero);
    let one = |name: &str| -> Option<Zero> {
        // What drifts between, evenly in ± that.
        let unknown = drift_n / 3.0_f64.sqrt();
        match (before, after) {
            (Some(a), Some(b)) => {
                let part = (at_s - a.at_s) / (b.at_s - a.at_s);
                let (x, y) = (of(a, name)?, of(b, name)?);
                let standard = ((1.0 - part) * x.standard).hypot(part * y.standard);
                Some(Zero { value: x.value + part * (y.value - x.value), standard })
            }
            (Some(only), None) | (None, Some(only)) => {
                let zero = of(only, name)?;
                Some(Zero { standard: zero.standard.hypot(unknown), ..zero })
            }
            (None, None) => None,
        }
    };
    Ok(run.loads.iter().map(|(name, _)| one(name)).collect::<Option<Vec<Zero>>>().map(Ok))
}
