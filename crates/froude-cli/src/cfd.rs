//! `froude cfd`: parse, call, print.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::available_parallelism;

use froude::cfd::verb::{self, Engine, Job, Running, SlurmOptions};
use froude::pipeline::{default_out, read_campaign};
use froude::records::results::can_be_written;
use froude::report::write::write_folder;
use froude::swing::swing;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::flag;

use crate::args::{CfdJob, EngineName};
use crate::failure::Failure;
use crate::out::{self, Spinner, note, say};
use crate::print::{self, Form};
use crate::signals::{self, STOPPED};

pub fn job(job: CfdJob, form: Form) -> Result<(), Failure> {
    // A mistake that only identify would meet is found before hours are computed.
    if let CfdJob::Plan { of, .. } | CfdJob::Run { of, .. } | CfdJob::Swing { of, .. } = &job {
        read_campaign(&of.campaign)?;
    }
    let found = match job {
        CfdJob::Plan { of, jobs } => {
            let (bar, cancel) = (Spinner::new(), cancel()?);
            let tell = |what: &str| bar.set_message(what);
            verb::plan(&of.campaign, of.source.as_deref(), processors(jobs), &cancel, &tell)?
        }
        CfdJob::Run { of, engine, jobs, ranks, batch, time, memory, partition } => {
            let engine = match engine {
                EngineName::Local => Engine::Local { jobs: processors(jobs), ranks: 1 },
                EngineName::Mpi => Engine::Local { jobs: jobs.unwrap_or(1), ranks: ranks.unwrap_or(2) },
                EngineName::Slurm => {
                    let program = std::env::current_exe().map_err(Failure::system)?;
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
            out::go_on_unread();
            let (bar, cancel) = (Spinner::new(), cancel()?);
            let now = |text: &str| bar.set_message(text);
            let line = |text: &str| {
                if form == Form::Lines {
                    bar.suspend(|| note!("{text}"));
                }
            };
            let job = Job { campaign: of.campaign, source: of.source, engine };
            verb::run(&job, &cancel, &Running::new(&now, &line))?
        }
        CfdJob::Status { of } => verb::status(&of.campaign, of.source.as_deref())?,
        CfdJob::Collect { of } => verb::collect(&of.campaign, of.source.as_deref())?,
        CfdJob::Report { of, cases, out } => {
            let out = out.unwrap_or_else(|| default_out(&of.campaign, "cfd"));
            can_be_written(&out)?;
            let bar = Spinner::new();
            let tell = |what: &str| bar.set_message(what);
            let found = verb::report(&of.campaign, of.source.as_deref(), &cases, &out, Some(crate::today()), &tell)?;
            tell("the page");
            write_folder(&found, &out)?;
            found
        }
        CfdJob::Retry { of, cases } => verb::retry(&of.campaign, of.source.as_deref(), &cases)?,
        CfdJob::Suggest { of, count } => verb::suggest(&of.campaign, of.source.as_deref(), count)?,
        CfdJob::Swing { of, jobs } => {
            let (bar, cancel) = (Spinner::new(), cancel()?);
            let now = |what: &str| bar.set_message(what);
            swing(&of.campaign, of.source.as_deref(), processors(jobs), &cancel, &now)?
        }
        CfdJob::Case { folders, ranks } => return cases(&folders, ranks),
    };
    print::answer(&found, form)
}

fn processors(jobs: Option<usize>) -> usize {
    jobs.unwrap_or_else(|| available_parallelism().map_or(1, usize::from))
}

/// Set by Ctrl-C and its like; a second one ends the program.
fn cancel() -> Result<Arc<AtomicBool>, Failure> {
    let cancel = Arc::new(AtomicBool::new(false));
    signals::take_over();
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        flag::register_conditional_shutdown(signal, STOPPED.into(), Arc::clone(&cancel)).map_err(Failure::system)?;
        flag::register(signal, Arc::clone(&cancel)).map_err(Failure::system)?;
    }
    Ok(cancel)
}

/// What any queue runs: each folder is one case.
fn cases(folders: &[PathBuf], ranks: usize) -> Result<(), Failure> {
    let cancel = cancel()?;
    let mut failed = None;
    for folder in folders {
        match verb::run_case(folder, ranks, &cancel) {
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
