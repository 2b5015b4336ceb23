//! The program `froude`: parse, call, print.
//!
//! Exit code 0: done, whatever the findings say. 1: failed. 2: bad input. 130: stopped by Ctrl-C. With `--json` the result goes to
//! standard output as one JSON document; progress and messages go to standard error.

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod added_mass;
mod args;
mod carriage;
mod cfd;
mod failure;
mod last_word;
mod mistaken;
mod out;
mod print;
mod signals;
mod stage;
mod swim;

use std::process::ExitCode;

use args::{Cli, RobotJob, Verb};
use clap::Parser;
use failure::Failure;
use froude::identify::prediction;
use froude::pipeline::{self, Identified, Input, Job};
use froude::report::write::write_files;
use froude::swim::verb::look;
use froude::{demo, inspect, plan, twin};

fn main() -> ExitCode {
    // Where signals cannot be watched they end the program as they always do.
    let _ = signals::watch();
    last_word::guarded(|| {
        let cli = match Cli::try_parse() {
            Ok(cli) => cli,
            Err(error) => return out::usage(&error),
        };
        let done = run(cli);
        signals::wait_if_leaving();
        match done {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                out::note!("froude: {error}");
                ExitCode::from(error.exit_code())
            }
        }
    })
}

fn run(cli: Cli) -> Result<(), Failure> {
    match cli.verb {
        Verb::Demo { dir } => {
            let bar = spinner();
            let outcome = demo::run(&dir, Some(today()), &|step| bar.set_message(step.to_owned()))?;
            bar.finish_and_clear();
            print::answer(&outcome, cli.json)?;
        }
        Verb::Identify { input, out, sidecar, models } => {
            let job = Job { out, sidecar, models, ..Job::new(&input) };
            identify(job, cli.json, false).map_err(|error| mistaken::IDENTIFY.explain(error, &[input]))?;
        }
        Verb::Compare { estimates, all, out } => {
            let job = Job { out, ..Job::of(Input::Records(estimates.clone())) };
            identify(job, cli.json, all).map_err(|error| mistaken::COMPARE.explain(error, &estimates))?;
        }
        Verb::Predict { record, table, sidecar, laws, out } => {
            let job = prediction::Job { record: record.clone(), table: table.clone(), sidecar, laws, out };
            // Which of the two is no such file says the reader; that they were taken for each other is said here.
            let found =
                prediction::predict(&job).map_err(|error| mistaken::PREDICT.explain(error, &[record, table]))?;
            write_files(&found)?;
            print::answer(&found, cli.json)?;
        }
        Verb::Inspect { file, sidecar } => {
            let inspection = inspect::inspect(&file, sidecar.as_deref())
                .map_err(|error| mistaken::INSPECT.explain(error, &[file]))?;
            print::answer(&inspection.outcome(), cli.json)?;
        }
        Verb::Plan { campaign } => {
            let found = plan::plan(&campaign).map_err(|error| mistaken::PLAN.explain(error, &[campaign]))?;
            print::answer(&found, cli.json)?;
        }
        Verb::Simulate { campaign, replace } => {
            let found =
                twin::simulate(&campaign, replace).map_err(|error| mistaken::SIMULATE.explain(error, &[campaign]))?;
            print::answer(&found, cli.json)?;
        }
        Verb::Run { campaign, out, check, yes } => carriage::run(campaign, out, check, yes, cli.json)?,
        Verb::Cfd { job } => cfd::job(job, cli.json)?,
        Verb::Carriage { job } => carriage::job(job, cli.json)?,
        Verb::AddedMass(args) => {
            let input = args.input.clone();
            added_mass::added_mass(*args, cli.json).map_err(|error| mistaken::ADDED_MASS.explain(error, &[input]))?;
        }
        Verb::Swim(args) => swim::swim(*args, cli.json)?,
        Verb::Robot { job: RobotJob::Inspect { robot } } => {
            let found = look(&robot).map_err(|error| mistaken::ROBOT.explain(error, &[robot]))?;
            print::answer(&found, cli.json)?;
        }
        Verb::Schema => out::say!("{}", froude::records::schema::ESTIMATE_JSON_SCHEMA.trim_end()),
    }
    Ok(())
}

/// `identify`, `compare` and `carriage drag`: one job, one way through it, one outcome, printed or as its record.
fn identify(job: Job, is_json: bool, all: bool) -> Result<(), Failure> {
    print::answer_with(&identified(job)?.outcome(), is_json, all)
}

/// The same, not yet printed.
fn identified(job: Job) -> Result<Identified, Failure> {
    let bar = spinner();
    let outcome = pipeline::identify(&Job { date: Some(today()), ..job }, &|step| bar.set_message(step.to_owned()))?;
    bar.finish_and_clear();
    Ok(outcome)
}

/// What shows that the program works.
fn spinner() -> out::Spinner {
    out::Spinner::new()
}

/// Today's date (UTC) as `2026-11-21`.
fn today() -> String {
    jiff::Timestamp::now().strftime("%F").to_string()
}
