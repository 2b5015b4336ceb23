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
use froude::records::question::asked_by;
use froude::records::settle::settle;
use froude::report::write::write_files;
use froude::swim::verb::look;
use froude::{demo, inspect, plan, twin};
use out::Spinner;
use print::Form;

fn main() -> ExitCode {
    // Where signals cannot be watched they end the program as they always do.
    let _ = signals::watch();
    last_word::guarded(|| {
        let cli = match Cli::try_parse() {
            Ok(cli) => cli,
            Err(error) => return out::usage(&error),
        };
        let done = answered(cli);
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

/// Does what was asked; where a file can be read in several ways and a person is there, asks them, writes the answer into the sidecar, and tries again.
fn answered(cli: Cli) -> Result<(), Failure> {
    let mut done = run(cli);
    let mut settled = None;
    while let Err(error) = &done
        && let Some(question) = asked_by(error).filter(|question| settled.as_ref() != Some(*question)).cloned()
        && let Some(answer) = out::ask(&question).map_err(Failure::system)?
        && let Ok(again) = Cli::try_parse()
    {
        settle(&question, answer)?;
        out::note!("written in {}", question.sidecar.display());
        settled = Some(question);
        done = run(again);
    }
    done
}

fn run(cli: Cli) -> Result<(), Failure> {
    let form = match (cli.json, cli.csv) {
        (true, _) => Form::Json,
        (_, true) => Form::Csv,
        _ => Form::Lines,
    };
    match cli.verb {
        Verb::Demo { dir } => {
            let bar = Spinner::new();
            let outcome = demo::run(&dir, Some(today()), &|step| bar.set_message(step.to_owned()))?;
            drop(bar);
            print::answer(&outcome, form)?;
        }
        Verb::Identify { input, out, sidecar, models } => {
            let job = Job { out, sidecar, models, ..Job::new(&input) };
            mistaken::IDENTIFY.or(identify(job, form, false), &[input])?;
        }
        Verb::Compare { estimates, all, out } => {
            let job = Job { out, ..Job::of(Input::Records(estimates.clone())) };
            mistaken::COMPARE.or(identify(job, form, all), &estimates)?;
        }
        Verb::Predict { record, table, sidecar, laws, out } => {
            let job = prediction::Job { record: record.clone(), table: table.clone(), sidecar, laws, out };
            // Which of the two is no such file says the reader; that they were taken for each other is said here.
            let found = mistaken::PREDICT.or(prediction::predict(&job), &[record, table])?;
            write_files(&found)?;
            print::answer(&found, form)?;
        }
        Verb::Inspect { file, sidecar, write_sidecar: true } => {
            print::answer(&froude::records::proposal::propose(&file, sidecar.as_deref())?, form)?;
        }
        Verb::Inspect { file, sidecar, .. } => {
            let found = mistaken::INSPECT.or(inspect::inspect(&file, sidecar.as_deref()), &[file])?;
            print::answer(&found.outcome(), form)?;
        }
        Verb::Convert { input, out, sidecar } => {
            print::answer(&froude::records::convert::convert(&input, sidecar.as_deref(), &out)?, form)?;
        }
        Verb::New { kind, out } => print::answer(&froude::records::starter::start(&kind, &out)?, form)?,
        Verb::Plan { campaign } => print::answer(&mistaken::PLAN.or(plan::plan(&campaign), &[campaign])?, form)?,
        Verb::Simulate { campaign, replace } => {
            print::answer(&mistaken::SIMULATE.or(twin::simulate(&campaign, replace), &[campaign])?, form)?;
        }
        Verb::Run { campaign, out, check, yes } => carriage::run(campaign, out, check, yes, form)?,
        Verb::Cfd { job } => cfd::job(job, form)?,
        Verb::Carriage { job } => carriage::job(job, form)?,
        Verb::AddedMass(args) => {
            let input = args.input.clone();
            mistaken::ADDED_MASS.or(added_mass::added_mass(*args, form), &[input])?;
        }
        Verb::Swim(args) => swim::swim(*args, form)?,
        Verb::Robot { job: RobotJob::Inspect { robot } } => {
            print::answer(&mistaken::ROBOT.or(look(&robot), &[robot])?, form)?;
        }
        Verb::Schema { of } => match froude::records::schema::of_verb(&of) {
            Some(schema) => out::say!("{schema}"),
            None => out::say!("{:#}", froude::campaign_schema()),
        },
    }
    Ok(())
}

/// `identify`, `compare` and `carriage drag`: one job, one way through it, one outcome, printed or as its record.
fn identify(job: Job, form: Form, all: bool) -> Result<(), Failure> {
    print::answer_with(&identified(job)?.outcome(), form, all)
}

fn identified(job: Job) -> Result<Identified, Failure> {
    let bar = Spinner::new();
    Ok(pipeline::identify(&Job { date: Some(today()), ..job }, &|step| bar.set_message(step.to_owned()))?)
}

/// Today's date (UTC) as `2026-11-21`.
fn today() -> String {
    jiff::Timestamp::now().strftime("%F").to_string()
}
