//! `froude run` and `froude carriage …`: call, show progress, print.

use std::path::{Path, PathBuf};

use froude::carriage::drive::{DriveJob, drive, prepare};
use froude::carriage::scale::scale;
use froude::carriage::tune::{find_resonance, tune};
use froude::fit::budget::Uncertain;
use froude::pipeline::{Input, Job, Purpose};
use froude::records::block::Block;
use froude::records::units::{Dimension, parse_quantity};
use froude::rig::carriage::plan::Step;

use crate::args::{CarriageJob, Experiment};
use crate::failure::Failure;
use crate::mistaken::{self, Takes};
use crate::print;
use crate::stage::Stage;

/// `froude run`.
pub fn run(campaign: PathBuf, out: Option<PathBuf>, check: bool, yes: bool, is_json: bool) -> Result<(), Failure> {
    let job = drive_job(campaign, out);
    let prepared = prepare(&job).map_err(|error| mistaken::RUN.explain(error, &[job.campaign]))?;
    let stage = if check { None } else { Some(Stage::set(&prepared, yes, prepared.steps.len())?) };
    let Some(Stage { switch, mut person, mut bar }) = stage else {
        return print::answer(&prepared.outcome(), is_json);
    };
    if !is_json {
        print::blocks(&prepared.blocks());
    }
    let driven = drive(&prepared, &switch, &mut person, &mut bar);
    bar.end();
    print::answer(&driven?.outcome(&prepared.folder), is_json)
}

fn drive_job(campaign: PathBuf, out: Option<PathBuf>) -> DriveJob {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    DriveJob { campaign, out, start_unix_ns: since.as_nanos() as u64, date: crate::today() }
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
            let scale = measured.map(|measured| encoder_scale(&runs, &measured, &measured_standard, &counted));
            let scale = scale.transpose().map_err(explain)?;
            let input = Input::Runs { paths: runs.clone(), campaign };
            let job = Job { out, purpose: Some(Purpose::Calibration), ..Job::of(input) };
            let mut outcome = crate::identified(job).map_err(explain)?.outcome();
            outcome.blocks.splice(0..0, scale);
            print::answer(&outcome, is_json)
        }
        CarriageJob::Tune(e) => {
            let (job, Stage { switch, mut person, mut bar }) = experiment(&e, &mistaken::TUNE)?;
            let outcome = tune(&job, &switch, &mut person, &mut bar);
            bar.end();
            print::answer(&outcome?.outcome(), is_json)
        }
        CarriageJob::Resonance(e) => {
            let (job, Stage { switch, mut person, mut bar }) = experiment(&e, &mistaken::RESONANCE)?;
            let outcome = find_resonance(&job, &switch, &mut person, &mut bar);
            bar.end();
            print::answer(&outcome?.outcome(), is_json)
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

/// A length as somebody typed it, m.
fn length(option: &'static str, text: &str) -> Result<f64, Failure> {
    parse_quantity(text).and_then(|q| q.expect(Dimension::LENGTH)).map_err(|source| Failure::Length {
        option,
        text: text.to_owned(),
        source,
    })
}

fn encoder_scale(paths: &[PathBuf], measured: &str, standard: &str, counted: &[String]) -> Result<Block, Failure> {
    let known = Uncertain::new(length("--measured", measured)?, length("--measured-standard", standard)?);
    let counted_m = counted.iter().map(|text| length("--counted", text)).collect::<Result<Vec<_>, _>>()?;
    scale(paths, known, &counted_m)?.ok_or(Failure::NoRig)
}

fn experiment(e: &Experiment, takes: &Takes) -> Result<(DriveJob, Stage), Failure> {
    let job = drive_job(e.campaign.clone(), e.out.clone());
    let prepared = prepare(&job).map_err(|error| takes.explain(error, std::slice::from_ref(&e.campaign)))?;
    let runs = prepared.steps.iter().filter(|s| matches!(s, Step::Run(_))).count();
    let stage = Stage::set(&prepared, e.yes, runs.min(3))?;
    Ok((job, stage))
}
