//! The weight-driven rig as a source of a campaign: a folder of logs, one run each, reduced to the rows of a table.

use crate::names::WEIGHT_TOW;
use froude_identify::method::{Declares, Found, MethodError, Need};
use froude_identify::reduce::reduce_table;
use froude_identify::source::identify_observations;
use froude_identify::uncertainty::SharedError;
use froude_records::campaign::{BudgetEntry, Campaign, Shared, Source};
use froude_records::estimate::ErrorKind;
use froude_records::finding::Finding;
use froude_records::run::Role;
use froude_records::run::step::Step;
use froude_records::units::Dimension;

use super::reduce::{ERRORS, Reduced, WeightRun, reduce};
use super::section::WeightTowSpec;
use super::track::metres;
use super::{page, plan, section, simulate};
use crate::conditioning::stretches::{in_words, touching};
use crate::declared::check;
use crate::error::{TankError, undeclared};
use crate::findings::{note, warning};
use crate::log::TankLog;
use crate::logs::{self, Logs};
use crate::method::TankMethod;
use crate::steady::row::{Row, angle_rad, table};

const WHY: &str = "drag is wrong by its size or its sign where one is guessed";
/// Residuals of the equation of motion this many times the errors of the track are none of the camera.
const MISFIT: f64 = 3.0;

/// The last part of the way of a wagon, each run an observation.
pub const PULLED: TankMethod = TankMethod {
    names: &[WEIGHT_TOW],
    words: &[
        "runs of a wagon that a hanging weight pulls, filmed: the speed at the end of the way, the drag by load cell or by the equation of motion",
    ],
    needs: &[Need::of(&["test"], &[])],
    runs: WEIGHT_TOW,
    takes: &[WEIGHT_TOW, "models", "uncertainty", "plan", "keep", "group", "tare"],
    identify: |campaign, source, _, progress| identify(campaign, source, progress),
    simulate: simulate::files,
    plan: plan::prospect,
    declares: Declares { section: WEIGHT_TOW, keys: section::KEYS, plan: section::PLAN },
    check: |source| check(source, WEIGHT_TOW, section::weight_tow, section::plan),
};

fn identify(campaign: &Campaign, source: &Source, progress: &dyn Fn(&str)) -> Result<Found, MethodError> {
    let spec = simulate::declared(source)?;
    progress("reading the runs");
    let Logs { runs: logs, mut files, mut findings } =
        logs::read(source.input.path(), WEIGHT_TOW, &[Role::Test], "time, mark or position, and loads", progress)?;
    progress("reading the tracks");
    let positions = logs.iter().map(|log| position(log, &spec)).collect::<Result<Vec<_>, _>>()?;
    let (mut rows, mut reduced) = (Vec::new(), Vec::new());
    let mut first: Option<TankError> = None;
    for (log, position_m) in logs.iter().zip(&positions) {
        let run = run(log, position_m)?;
        match reduce(&run, &spec, None).and_then(|found| without_marks(log, found)) {
            Ok(found) => {
                logs::add_step(&mut files, log, window_step(log, &found));
                findings.extend(of_run(run.id, &found, run.weight_n - spec.friction_n.value));
                rows.push(Row::of(log, found.point.clone())?);
                reduced.push(found);
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
    let own = with_track(source, &reduced);
    let mut observations = reduce_table(campaign, &own, &table(source.input.path(), &rows), files)?;
    let errors = shared(&reduced, &observations.data.loads());
    if !errors.is_empty() && observations.data.rows != rows.len() {
        let what = "`keep` and errors that all runs share (scale, moving_mass, friction) do not go together: leave the logs that are not meant out of the folder";
        return Err(undeclared(&source.place, what));
    }
    observations.shared_errors.extend(errors);
    let mut result = identify_observations(campaign, &own, observations, WEIGHT_TOW, &|model| {
        progress(&format!("fitting {model}"));
    })?;
    findings.append(&mut result.findings);
    let blocks = vec![page::section(&rows, &reduced, &logs, &positions, &spec)];
    Ok(Found { results: vec![result.into()], blocks, findings, ..Found::default() })
}

/// A reduced run, where nothing of what it was reduced from is marked.
fn without_marks(log: &TankLog, found: Reduced) -> Result<Reduced, TankError> {
    let used = if found.balance.is_some() { &found.track.moving } else { &found.track.window };
    let marks = touching(&log.log.time_s, used, &log.declared.marks);
    if marks.is_empty() {
        return Ok(found);
    }
    let marks = in_words(&marks);
    let what = if found.balance.is_some() {
        "what moves, which the equation of motion is fitted to"
    } else {
        "the last part of its way"
    };
    let what = format!("{what}, holds {marks}; film it again, or give the camera a view without what was marked");
    Err(TankError::of_run(&log.log.meta.id, what))
}

/// The last part of the way as a step.
fn window_step(log: &TankLog, found: &Reduced) -> Step {
    let by = if found.balance.is_some() { "the equation of motion over all that moves" } else { "shown steady" };
    let step = logs::window_step(log, &found.track.window, &format!(", the last part of the way; {by}"));
    step.with("speed", found.track.speed_m_s, "m/s")
}

/// The positions of a log, m: of its mark by scale and lens, or as they stand.
fn position(log: &TankLog, spec: &WeightTowSpec) -> Result<Vec<f64>, MethodError> {
    let along = "the wagon's way along the rail, either way";
    if log.log.channels.contains_key("mark") {
        let mark = logs::channel(log, "mark", Dimension::ONE, WHY, along)?;
        let scale = spec.scale_m.ok_or_else(|| {
            MethodError::input(
                &log.log.path,
                "its mark is in pixels, and nothing says how large one is: write scale = { value = \"1.2 mm\", standard = \"1 %\" } in [source.weight_tow]",
            )
        })?;
        return Ok(metres(&mark.values, scale.value, spec.lens));
    }
    let name = if log.log.channels.contains_key("y/position") { "y/position" } else { "position" };
    Ok(logs::channel(log, name, Dimension::LENGTH, WHY, along)?.values.clone())
}

/// A log as a run; nothing about it is taken for granted.
fn run<'a>(log: &'a TankLog, position_m: &'a [f64]) -> Result<WeightRun<'a>, MethodError> {
    let weight_n = logs::condition(log, "weight", Dimension::FORCE)?.ok_or_else(|| {
        MethodError::input(
            &log.log.path,
            "the weight that pulls is not stated; write [conditions] weight = \"0.1 N\" in its sidecar",
        )
    })?;
    let mut loads = Vec::new();
    for name in ["f_x", "f_y"].into_iter().filter(|name| log.log.channels.contains_key(*name)) {
        let channel = logs::channel(log, name, Dimension::FORCE, WHY, "the water on the body, along its axes")?;
        loads.push((name, channel.values.as_slice()));
    }
    Ok(WeightRun {
        id: &log.log.meta.id,
        angle_rad: angle_rad(log)?,
        weight_n,
        time_s: &log.log.time_s,
        position_m,
        loads,
    })
}

/// What one run shows.
fn of_run(run: &str, found: &Reduced, pull_n: f64) -> Vec<Finding> {
    let mut out = Vec::new();
    if let Some(balance) = &found.balance {
        let [change, standard] = found.track.change;
        out.extend((change > 2.0 * standard).then(|| {
            note("not-steady",
                format!(
                    "run {run:?}: its speed changes by {:.1} ± {:.1} % over its window, at {:.0} % of its terminal speed: {:.2} of the {:.2} mN that pull are inertia",
                    1e2 * change,
                    1e2 * standard,
                    1e2 * found.track.speed_m_s / balance.terminal_m_s,
                    1e3 * (pull_n - found.drag_n),
                    1e3 * pull_n
                ),
            )
        }));
        if balance.residual_m > MISFIT * found.track.noise_m {
            out.push(warning("track-misfit",
                format!(
                    "run {run:?}: the equation of motion leaves {:.2} mm of the track, whose errors are {:.2} mm: look at weight, friction and moving_mass, at a string that \
                     stretches, or a push at the start",
                    1e3 * balance.residual_m,
                    1e3 * found.track.noise_m
                ),
            ));
        }
    }
    out
}

/// The source with the errors of its tracks in its budget: each run has one of its own.
#[must_use]
pub fn with_track(source: &Source, reduced: &[Reduced]) -> Source {
    let square = |r: &Reduced| (r.track.standard_m_s / r.point.speed_m_s).powi(2);
    let standard = (reduced.iter().map(square).sum::<f64>() / reduced.len() as f64).sqrt();
    let mut own = source.clone();
    own.uncertainty.push(BudgetEntry {
        quantity: "speed".to_owned(),
        standard,
        relative: true,
        shared: Shared::Sample,
        dof: None,
        name: Some("errors of the tracks".to_owned()),
        kind: ErrorKind::B,
        dimension: Dimension::ONE,
        place: source.place.clone(),
    });
    own
}

/// What all runs have in common: scale, moving mass, friction, and the law of the drag while it accelerates.
///
/// A speed that is wrong by δU moves a load against its law by −2 f δU/U, as quadratic drag does.
#[must_use]
pub fn shared(reduced: &[Reduced], loads: &[&str]) -> Vec<SharedError> {
    let one = |(k, name): (usize, &&str)| -> Option<SharedError> {
        let of_load = |load: &&str| {
            let row = |r: &Reduced| {
                let at = r.point.loads.iter().position(|l| l.name == *load);
                let (value, moved) = at.map_or((0.0, 0.0), |l| (r.point.loads[l].value, r.moves[k].loads_n[l]));
                vec![moved - 2.0 * value * r.moves[k].speed_m_s / r.point.speed_m_s]
            };
            ((*load).to_owned(), reduced.iter().map(row).collect::<Vec<_>>())
        };
        let directions: Vec<(String, Vec<Vec<f64>>)> = loads.iter().map(of_load).collect();
        let is_there = directions.iter().any(|(_, rows)| rows.iter().any(|row| row[0] != 0.0));
        // In standard uncertainties.
        is_there.then(|| SharedError { directions, ..SharedError::of_load(name, name, &[], 1.0, f64::INFINITY) })
    };
    ERRORS.iter().enumerate().filter_map(one).collect()
}
