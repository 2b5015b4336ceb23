//! `froude cfd`: parse, call, print.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::available_parallelism;

use froude::cfd::run::{Engine, Job, Running, SlurmOptions, run, run_case};
use froude::cfd::{collect, plan, report, retry, status, suggest, swing};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::flag;

use crate::args::{CfdCampaign, CfdJob, EngineName};
use crate::failure::Failure;
use crate::out::{self, Spinner, note, say};
use crate::print;
use crate::signals::{self, STOPPED};

pub fn job(job: CfdJob, json: bool) -> Result<(), Failure> {
    match job {
        CfdJob::Plan { of, jobs } => {
            let (bar, cancel) = (Spinner::new(), cancel()?);
            let planned = plan::plan(&of.campaign, of.source.as_deref(), &cancel, &|what| bar.set_message(what))?;
            bar.finish_and_clear();
            if json {
                return print::json(&planned.as_json());
            }
            print::summary(&planned.section(processors(jobs)));
        }
        CfdJob::Run { of, engine, jobs, ranks, batch, time, memory, partition } => {
            let engine = match engine {
                EngineName::Local => Engine::Local { jobs: processors(jobs), ranks: 1 },
                EngineName::Mpi => Engine::Local { jobs: jobs.unwrap_or(1), ranks: ranks.unwrap_or(2) },
                EngineName::Slurm => {
                    let program = std::env::current_exe().map_err(Failure::Program)?;
                    let ranks = ranks.unwrap_or(1);
                    let words = [&program.to_string_lossy(), "cfd", "case", "--ranks", &ranks.to_string()];
                    Engine::Slurm(SlurmOptions {
                        partition,
                        memory_mib: memory,
                        time_limit_min: time,
                        ranks,
                        task_s: 60.0 * f64::from(batch),
                        ..SlurmOptions::new(words.map(str::to_owned).to_vec())
                    })
                }
            };
            start(&of, engine, json)?;
        }
        CfdJob::Status { of } => {
            let found = status::status(&of.campaign, of.source.as_deref())?;
            if json {
                return print::json(&found.as_json());
            }
            print::summary(&found.section());
        }
        CfdJob::Collect { of } => {
            let found = collect::collect(&of.campaign, of.source.as_deref())?;
            if json {
                return print::json(&found.as_json());
            }
            found.sections().iter().for_each(print::summary);
        }
        CfdJob::Report { of, cases, out } => {
            let bar = Spinner::new();
            let tell = |what: &str| bar.set_message(what);
            let source = of.source.as_deref();
            let found = report::report(&of.campaign, source, &cases, out.as_deref(), Some(crate::today()), &tell)?;
            bar.finish_and_clear();
            if json {
                return print::json(&found.as_json());
            }
            print::summary(&found.section());
            say!("");
            say!("report     {}", found.report.display());
            say!("figures    {} in {}", found.figures.len(), found.report.with_file_name("figures").display());
        }
        CfdJob::Retry { of, cases } => {
            let again = retry(&of.campaign, of.source.as_deref(), &cases)?;
            if json {
                return print::json(&again);
            }
            for id in &again {
                say!("{id}");
            }
            say!("{} to be computed again: froude cfd run {}", again.len(), of.campaign.display());
        }
        CfdJob::Suggest { of, count } => {
            let found = suggest::suggest(&of.campaign, of.source.as_deref(), count)?;
            if json {
                return print::json(&found.as_json());
            }
            print::summary(&found.section());
            if !found.next.is_empty() {
                say!("");
                for line in found.plan().lines() {
                    say!("{line}");
                }
            }
        }
        CfdJob::Swing { campaign, source, jobs } => {
            let (bar, cancel) = (Spinner::new(), cancel()?);
            let now = |what: &str| bar.set_message(what);
            let found = swing::swing(&campaign, source.as_deref(), processors(jobs), &cancel, &now)?;
            bar.finish_and_clear();
            if json {
                print::json(&found.as_json())?;
            } else {
                print::summary(&found.section());
            }
            if found.was_cancelled {
                return Err(Failure::Cancelled { verb: "swing", again: campaign });
            }
            if !found.failed.is_empty() {
                return Err(Failure::RunsFailed { count: found.failed.len() });
            }
        }
        CfdJob::Case { folders, ranks } => return cases(&folders, ranks),
    }
    Ok(())
}

fn processors(jobs: Option<usize>) -> usize {
    jobs.unwrap_or_else(|| available_parallelism().map_or(1, usize::from))
}

/// Set by Ctrl-C and its like; a second one ends the program.
fn cancel() -> Result<Arc<AtomicBool>, Failure> {
    let cancel = Arc::new(AtomicBool::new(false));
    signals::take_over();
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        flag::register_conditional_shutdown(signal, STOPPED.into(), Arc::clone(&cancel)).map_err(Failure::Program)?;
        flag::register(signal, Arc::clone(&cancel)).map_err(Failure::Program)?;
    }
    Ok(cancel)
}

fn start(of: &CfdCampaign, engine: Engine, json: bool) -> Result<(), Failure> {
    out::go_on_unread();
    let cancel = cancel()?;
    let bar = Spinner::new();
    let now = |text: &str| bar.set_message(text);
    let line = |text: &str| {
        if !json {
            bar.suspend(|| note!("{text}"));
        }
    };
    let running = Running::new(&now, &line);
    let job = Job { campaign: of.campaign.clone(), source: of.source.clone(), engine };
    let ran = run(&job, &cancel, &running)?;
    bar.finish_and_clear();
    if json {
        print::json(&ran.as_json())?;
    } else {
        print::summary(&ran.section());
    }
    if ran.was_cancelled { Err(Failure::Cancelled { verb: "run", again: of.campaign.clone() }) } else { Ok(()) }
}

/// What any queue runs: each folder is one case.
fn cases(folders: &[PathBuf], ranks: usize) -> Result<(), Failure> {
    let cancel = cancel()?;
    let mut failed = None;
    for folder in folders {
        match run_case(folder, ranks, &cancel) {
            Ok(line) => say!("{}: {line}", name(folder)),
            Err(error) if error.was_stopped() => return Err(error.into()),
            // Another case may do better.
            Err(error) => {
                note!("{}: {error}", name(folder));
                failed = Some(error);
            }
        }
    }
    failed.map_or(Ok(()), |error| Err(error.into()))
}

fn name(folder: &Path) -> String {
    folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy().into_owned()
}
