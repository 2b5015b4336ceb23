//! `froude run` and `froude carriage …`: call, show progress, print.

use std::path::{Path, PathBuf};

use froude::carriage::drive::{DriveJob, drive, prepare};
use froude::carriage::scale::scale;
use froude::carriage::tune::{find_resonance, tune};
use froude::fit::budget::Uncertain;
use froude::methods::carriage::{axis::source::Servo, drag::calibration::source::KnownWeights};
use froude::pipeline::{Input, Job};
use froude::records::block::Block;
use froude::records::given_option::length_m;
use froude::records::outcome::Outcome;
use froude::rig::carriage::plan::Step;

use crate::args::{CarriageJob, Experiment};
use crate::failure::Failure;
use crate::mistaken::{self, Takes};
use crate::print::{self, Form};
use crate::stage::Stage;

/// `froude run`.
pub fn run(campaign: PathBuf, out: Option<PathBuf>, check: bool, yes: bool, form: Form) -> Result<(), Failure> {
    let job = drive_job(campaign, out);
    let prepared = mistaken::RUN.or(prepare(&job), &[job.campaign])?;
    let stage = if check { None } else { Some(Stage::set(&prepared, yes, prepared.steps.len())?) };
    let Some(Stage { switch, mut person, mut bar }) = stage else {
        return print::answer(&prepared.outcome(), form);
    };
    if form == Form::Lines {
        print::blocks(&prepared.blocks(), false);
    }
    let driven = drive(&prepared, &switch, &mut person, &mut bar);
    bar.end();
    print::answer(&driven?.outcome(&prepared.folder), form)
}

fn drive_job(campaign: PathBuf, out: Option<PathBuf>) -> DriveJob {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    DriveJob { campaign, out, start_unix_ns: since.as_nanos() as u64, date: crate::today() }
}

/// `froude carriage …`.
pub fn job(job: CarriageJob, form: Form) -> Result<(), Failure> {
    match job {
        CarriageJob::Identify { input, sidecar, validate, out } => {
            let is_same = |path: &PathBuf| validate.as_ref().is_some_and(|other| same_file(path, other));
            if let Some(path) = input.iter().find(|path| is_same(path)) {
                let why = "this is the fitted log itself; name a log of a different motion";
                return Err(Failure::refused(format_args!("--validate {}: {why}", path.display())));
            }
            let job = Job { sidecar, validation: validate, method: Some(&Servo), ..servo(&input, out)? };
            mistaken::SERVO.or(crate::identify(job, form, false), &input)
        }
        CarriageJob::Drag { runs, campaign, out } => {
            let job = Job { out, ..Job::of(Input::Runs { paths: runs.clone(), campaign }) };
            mistaken::DRAG.or(crate::identify(job, form, false), &runs)
        }
        CarriageJob::Calibrate { runs, campaign, out, measured, measured_standard, counted } => {
            let scale = measured.map(|measured| encoder_scale(&runs, &measured, &measured_standard, &counted));
            let scale = mistaken::CALIBRATE.or(scale.transpose(), &runs)?;
            let job =
                Job { out, method: Some(&KnownWeights), ..Job::of(Input::Runs { paths: runs.clone(), campaign }) };
            let mut outcome = mistaken::CALIBRATE.or(crate::identified(job), &runs)?.outcome();
            outcome.blocks.splice(0..0, scale);
            print::answer(&outcome, form)
        }
        CarriageJob::Tune(e) => experiment(&e, &mistaken::TUNE, form, |job, Stage { switch, person, bar }| {
            Ok(tune(job, switch, person, bar)?.outcome())
        }),
        CarriageJob::Resonance(e) => {
            experiment(&e, &mistaken::RESONANCE, form, |job, Stage { switch, person, bar }| {
                Ok(find_resonance(job, switch, person, bar)?.outcome())
            })
        }
    }
}

fn same_file(a: &Path, b: &Path) -> bool {
    std::fs::canonicalize(a).is_ok_and(|a| std::fs::canonicalize(b).is_ok_and(|b| a == b))
}

/// Folders of runs and runs, or one log of another program, whose results lie beside it.
fn servo(input: &[PathBuf], out: Option<PathBuf>) -> Result<Job, Failure> {
    let is_log = |path: &&PathBuf| path.extension().is_some_and(|e| e == "csv" || e == "parquet");
    if let (Some(log), true) = (input.iter().find(is_log), input.len() > 1) {
        let takes = "a log of its own; froude carriage identify takes one log, or runs of one rig";
        let instead =
            "identify each log by itself, and compare their records: froude compare A/estimate.json B/estimate.json";
        return Err(Failure::refused(format_args!("{} is {takes}. {instead}", log.display())));
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

fn encoder_scale(paths: &[PathBuf], measured: &str, standard: &str, counted: &[String]) -> Result<Block, Failure> {
    let length = |option, text: &str| length_m(option, text).map_err(Failure::refused);
    let known = Uncertain::new(length("--measured", measured)?, length("--measured-standard", standard)?);
    let counted_m = counted.iter().map(|text| length("--counted", text)).collect::<Result<Vec<_>, _>>()?;
    scale(paths, known, &counted_m)?.ok_or_else(|| Failure::refused("the runs do not state which rig they come from"))
}

fn experiment(
    e: &Experiment,
    takes: &Takes,
    form: Form,
    conduct: impl FnOnce(&DriveJob, &mut Stage) -> Result<Outcome, Failure>,
) -> Result<(), Failure> {
    let job = drive_job(e.campaign.clone(), e.out.clone());
    let prepared = takes.or(prepare(&job), std::slice::from_ref(&e.campaign))?;
    let runs = prepared.steps.iter().filter(|s| matches!(s, Step::Run(_))).count();
    let mut stage = Stage::set(&prepared, e.yes, runs.min(3))?;
    let outcome = conduct(&job, &mut stage);
    stage.bar.end();
    print::answer(&outcome?, form)
}
