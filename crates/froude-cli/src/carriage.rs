//! `froude run` and `froude carriage …`: call, show progress, print.

use std::path::{Path, PathBuf};

use froude::carriage::drive::{DriveJob, Prepared, drive, prepare};
use froude::carriage::tune::{find_resonance, tune};
use froude::fit::budget::Uncertain;
use froude::methods::carriage::drag::calibration::encoder_scale;
use froude::methods::carriage::runs;
use froude::pipeline::{Input, Job, Purpose};
use froude::records::carriage::plan::{PlannedRun, Step};
use froude::records::page::TextTable;
use froude::records::run::Role;
use froude::records::text::counted;
use froude::records::units::{Dimension, parse_quantity};
use froude::rig::campaign::preflight::Objection;
use serde_json::json;

use crate::args::{CarriageJob, Experiment};
use crate::failure::Failure;
use crate::mistaken::{self, Takes};
use crate::out::say;
use crate::print;
use crate::stage::Stage;

/// `froude run`.
pub fn run(campaign: PathBuf, out: Option<PathBuf>, check: bool, yes: bool, is_json: bool) -> Result<(), Failure> {
    let job = drive_job(campaign, out);
    let prepared = prepare(&job).map_err(|error| mistaken::RUN.explain(error, &[job.campaign]))?;
    let stage = if check { None } else { Some(Stage::set(&prepared, yes, prepared.steps.len())?) };
    if !is_json {
        preflight(&prepared);
    }
    let Some(Stage { switch, mut person, mut bar }) = stage else {
        if is_json {
            print::json(&preflight_json(&prepared))?;
        }
        return refused(&prepared, is_json);
    };
    let outcome = drive(&prepared, &switch, &mut person, &mut bar);
    bar.end();
    let outcome = outcome?;
    if is_json {
        print::json(&json!({
            "folder": prepared.folder, "driven": outcome.driven, "resumed": outcome.resumed, "spared": outcome.spared,
            "enough": outcome.enough, "cut": outcome.cut,
        }))?;
        return Ok(outcome.whole()?);
    }
    say!(
        "\n{} driven, {} already there, {} left out. Runs in {}",
        counted(outcome.driven, "run", "runs"),
        counted(outcome.resumed, "was", "were"),
        outcome.spared,
        prepared.folder.display()
    );
    if let Some(why) = &outcome.enough {
        say!("{why}");
    }
    say!("\nNext: froude carriage drag {0}\n      froude carriage identify {0}", prepared.folder.display());
    Ok(outcome.whole()?)
}

fn drive_job(campaign: PathBuf, out: Option<PathBuf>) -> DriveJob {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    DriveJob { campaign, out, start_unix_ns: since.as_nanos() as u64, date: crate::today() }
}

fn preflight(prepared: &Prepared) {
    let runs = counted(prepared.forecasts.len(), "run", "runs");
    say!("{}: {runs}, about {} on the rig\n", prepared.name(), minutes(prepared.duration_s));
    let detectable_n = prepared.detectable_n();
    let mut rows: Vec<(Vec<String>, usize)> = Vec::new();
    for (run, f) in prepared.runs().zip(&prepared.forecasts) {
        let drag = f.drag_n.map_or_else(|| "–".to_owned(), |d| format!("{d:.3}"));
        let pairs = f.drag_n.filter(|d| *d > 0.0);
        let pairs = pairs.map_or_else(|| "–".to_owned(), |d| format!("{:.0}", pairs_to_see(detectable_n, d)));
        let cells = vec![
            match run.role {
                Role::Calibration => format!("{} {} N", run.role.name(), run.hung_weight_n),
                _ => run.role.name().to_owned(),
            },
            run.speed_m_s().map_or_else(|| "–".to_owned(), |v| format!("{v:.3}")),
            runs::way(run.direction()).to_owned(),
            format!("{:.1}", f.duration_s),
            format!("{:.1}", f.steady_s),
            format!("{:.2}", f.command_v),
            format!("{:.2}", f.rms_current_a),
            format!("{:.3}", f.coast_m),
            if f.margin_m.is_finite() { format!("{:.3}", f.margin_m) } else { "held".to_owned() },
            drag,
            pairs,
        ];
        match rows.iter_mut().find(|(other, _)| *other == cells) {
            Some((_, n)) => *n += 1,
            None => rows.push((cells, 1)),
        }
    }
    let table = TextTable {
        caption: String::new(),
        head: [
            "kind",
            "speed [m/s]",
            "direction",
            "time [s]",
            "steady [s]",
            "command [V]",
            "rms current [A]",
            "coast [m]",
            "margin [m]",
            "drag [N]",
            "differences to see it",
            "runs",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows
            .into_iter()
            .map(|(mut cells, n)| {
                cells.push(n.to_string());
                cells
            })
            .collect(),
    };
    print::text_table(&table);
    say!(
        "\nOne wet-minus-dry difference is expected to show {detectable_n:.2} N (friction repeating within 2 %, assumed until the dry runs show it)."
    );
    if !prepared.is_shaped() {
        say!(
            "The reference is not shaped (shaped_mode): after each ramp the load swings on the chain, and runs in which it then drives the gear \
             are left out of the evaluation by motor current. froude carriage resonance finds the mode."
        );
    }
    if let Some(few) = few_pairs(prepared, detectable_n) {
        say!("{few}");
    }
}

/// Speeds that are planned with fewer differences than their drag needs; `None` where all have enough, or no drag is expected.
fn few_pairs(prepared: &Prepared, detectable_n: f64) -> Option<String> {
    let drags = prepared.runs().zip(&prepared.forecasts).filter_map(|(run, f)| run.speed_m_s().zip(f.drag_n));
    // Speed, drag, wet runs: each gives one difference.
    let mut planned: Vec<(f64, f64, usize)> = Vec::new();
    for (speed, drag) in drags.filter(|d| d.1 > 0.0) {
        match planned.iter_mut().find(|p| p.0 == speed) {
            Some(p) => p.2 += 1,
            None => planned.push((speed, drag, 1)),
        }
    }
    let few: Vec<String> = planned
        .iter()
        .filter_map(|&(speed, drag, runs)| {
            let needed = pairs_to_see(detectable_n, drag);
            let are = counted(runs, "is", "are");
            (needed > runs as f64).then(|| format!("{needed:.0} at {speed:.3} m/s, where {are} planned"))
        })
        .collect();
    (!few.is_empty()).then(|| {
        format!(
            "To detect the drag at each speed separately, more runs are needed: {} (out and back count as two). D_d depends on the fast runs and does \
             not need them.",
            few.join("; ")
        )
    })
}

/// Repeats until a drag exceeds what one pair shows.
fn pairs_to_see(detectable_n: f64, drag_n: f64) -> f64 {
    (detectable_n / drag_n).powi(2).ceil().max(1.0)
}

fn refused(prepared: &Prepared, is_json: bool) -> Result<(), Failure> {
    if prepared.objections.is_empty() {
        if !is_json {
            say!("\nPre-flight passed. Nothing was moved.");
        }
        return Ok(());
    }
    // The same sentence for many runs is printed once, with their number.
    let mut sentences: Vec<(&str, &str, usize)> = Vec::new();
    for o in &prepared.objections {
        match sentences.iter_mut().find(|t| t.1 == o.text) {
            Some(t) => t.2 += 1,
            None => sentences.push((&o.id, &o.text, 0)),
        }
    }
    let more = |n: usize, one: &str, many: &str| match n {
        0 => String::new(),
        n => format!(" (and {})", counted(n, one, many)),
    };
    let mut lines: Vec<String> =
        sentences.iter().map(|(id, text, n)| format!("  {id}{}: {text}", more(*n, "more run", "more runs"))).collect();
    if sentences.len() > MOST_SENTENCES {
        // One cause makes a sentence for every run: the first of each kind tells it.
        let mut kinds: Vec<(&str, &Objection, usize)> = Vec::new();
        for o in &prepared.objections {
            match kinds.iter_mut().find(|k| k.0 == o.kind) {
                Some(k) => k.2 += 1,
                None => kinds.push((o.kind, o, 0)),
            }
        }
        lines = kinds
            .iter()
            .map(|(_, o, n)| format!("  {}{}: {}", o.id, more(*n, "more like it", "more like it"), o.text))
            .collect();
        let is_refused = |run: &PlannedRun| prepared.objections.iter().any(|o| o.id == run.id);
        let (refused, all) = (prepared.runs().filter(|r| is_refused(r)).count(), prepared.runs().count());
        let are = if refused == 1 { "is" } else { "are" };
        lines.push(format!(
            "{refused} of {} {are} refused; froude run --check --json has a sentence for each",
            counted(all, "run", "runs")
        ));
    }
    Err(Failure::Refused { objections: lines })
}

/// More different objections than this are reported by kind.
const MOST_SENTENCES: usize = 10;

fn preflight_json(prepared: &Prepared) -> serde_json::Value {
    let rows: Vec<_> = prepared
        .forecasts
        .iter()
        .map(|f| {
            json!({"run": f.id, "duration_s": f.duration_s, "steady_s": f.steady_s, "command_v": f.command_v,
                   "rms_current_a": f.rms_current_a, "coast_m": f.coast_m,
                   "margin_m": f.margin_m.is_finite().then_some(f.margin_m), "drag_n": f.drag_n})
        })
        .collect();
    let objections: Vec<_> =
        prepared.objections.iter().map(|o| json!({"run": o.id, "kind": o.kind, "text": o.text})).collect();
    json!({"name": prepared.name(), "duration_s": prepared.duration_s, "runs": rows, "objections": objections,
           "detectable_n": prepared.detectable_n()})
}

fn minutes(seconds: f64) -> String {
    if seconds < 120.0 { format!("{seconds:.0} s") } else { format!("{:.0} min", seconds / 60.0) }
}

/// `froude carriage …`.
pub fn job(job: CarriageJob, is_json: bool) -> Result<(), Failure> {
    match job {
        CarriageJob::Identify { input, sidecar, validate, out } => {
            let is_same = |path: &PathBuf| validate.as_ref().is_some_and(|other| same_file(path, other));
            if let Some(path) = input.iter().find(|path| is_same(path)) {
                return Err(Failure::ValidatesItself { path: path.clone() });
            }
            let job = Job { sidecar, validation: validate, purpose: Some(Purpose::Servo), ..servo(&input, out)? };
            crate::identify(job, is_json, false).map_err(|error| mistaken::SERVO.explain(error, &input))
        }
        CarriageJob::Drag { runs, campaign, out } => {
            let job = Job { out, ..Job::of(Input::Runs { paths: runs.clone(), campaign }) };
            crate::identify(job, is_json, false).map_err(|error| mistaken::DRAG.explain(error, &runs))
        }
        CarriageJob::Calibrate { runs, campaign, out, measured, measured_standard, counted } => {
            let explain = |error| mistaken::CALIBRATE.explain(error, &runs);
            if let Some(measured) = measured {
                scale(&runs, &measured, &measured_standard, &counted).map_err(explain)?;
            }
            let input = Input::Runs { paths: runs.clone(), campaign };
            let job = Job { out, purpose: Some(Purpose::Calibration), ..Job::of(input) };
            crate::identify(job, is_json, false).map_err(explain)
        }
        CarriageJob::Tune(e) => {
            let (job, Stage { switch, mut person, mut bar }) = experiment(&e, &mistaken::TUNE)?;
            let outcome = tune(&job, &switch, &mut person, &mut bar);
            bar.end();
            crate::print_found(&outcome?, is_json, false)
        }
        CarriageJob::Resonance(e) => {
            let (job, Stage { switch, mut person, mut bar }) = experiment(&e, &mistaken::RESONANCE)?;
            let outcome = find_resonance(&job, &switch, &mut person, &mut bar);
            bar.end();
            crate::print_found(&outcome?, is_json, false)
        }
    }
}

fn same_file(a: &Path, b: &Path) -> bool {
    let real = |path: &Path| std::fs::canonicalize(path);
    real(a).is_ok_and(|a| real(b).is_ok_and(|b| a == b))
}

/// Folders of runs and runs, or one log of another program, whose results lie beside it.
fn servo(input: &[PathBuf], out: Option<PathBuf>) -> Result<Job, Failure> {
    let is_log = |path: &&PathBuf| path.extension().is_some_and(|e| e == "csv" || e == "parquet");
    if let (Some(log), true) = (input.iter().find(is_log), input.len() > 1) {
        return Err(Failure::Instead {
            path: log.clone(),
            found: "a log of its own",
            verb: "carriage identify",
            takes: "one log, or runs of one rig",
            instead:
                "identify each log by itself, and compare their records: froude compare A/estimate.json B/estimate.json"
                    .to_owned(),
        });
    }
    Ok(match input {
        [log] if is_log(&log) => {
            let stem = log.file_stem().unwrap_or_default().to_string_lossy();
            let beside = log.with_file_name(format!("{stem}-servo"));
            Job { out: Some(out.unwrap_or(beside)), ..Job::new(log) }
        }
        runs => Job { out, ..Job::of(Input::Runs { paths: runs.to_vec(), campaign: None }) },
    })
}

/// Sprocket radius that makes the counted distances the measured one.
fn scale(paths: &[PathBuf], measured: &str, standard: &str, counted: &[String]) -> Result<(), Failure> {
    let length = |option: &'static str, text: &str| {
        parse_quantity(text).and_then(|q| q.expect(Dimension::LENGTH)).map_err(|source| Failure::Length {
            option,
            text: text.to_owned(),
            source,
        })
    };
    let known = Uncertain::new(length("--measured", measured)?, length("--measured-standard", standard)?);
    let counted_m = counted.iter().map(|text| length("--counted", text)).collect::<Result<Vec<_>, _>>()?;
    let factor = encoder_scale(&counted_m, known)?;
    let kinds = [Role::Calibration, Role::Jog];
    let read = runs::read(paths, &kinds, None)?;
    let Some(axis) = read.logs.iter().find_map(|log| log.meta.moving_axis()) else {
        return Err(Failure::NoRig);
    };
    let radius_mm = 1e3 * axis.sprocket_radius_m.value;
    say!(
        "encoder scale {}: sprocket_radius = {{ value = \"{:.4} mm\", standard = \"{:.4} mm\" }} (declared {radius_mm:.4} mm)",
        froude::records::number::short_form(factor.value, factor.standard),
        radius_mm * factor.value,
        radius_mm * factor.standard
    );
    Ok(())
}

fn experiment(e: &Experiment, takes: &Takes) -> Result<(DriveJob, Stage), Failure> {
    let job = drive_job(e.campaign.clone(), e.out.clone());
    let prepared = prepare(&job).map_err(|error| takes.explain(error, std::slice::from_ref(&e.campaign)))?;
    let runs = prepared.steps.iter().filter(|s| matches!(s, Step::Run(_))).count();
    let stage = Stage::set(&prepared, e.yes, runs.min(3))?;
    Ok((job, stage))
}
