//! Campaigns on a real Slurm of two virtual nodes: arrays, and all that happens to jobs.
//!
//! The coordinator and the workers are this program again, told by their environment.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test breaks off")]

mod lab;
#[path = "../stub/mod.rs"]
mod stub;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use froude_cfd::case::Case;
use froude_cfd::change::plan;
use froude_cfd::engine::slurm::{SlurmOptions, run};
use froude_cfd::result::attempts;
use froude_cfd::store::{State, Store};
use froude_cfd::work::work;
use lab::{Lab, wait};
use stub::{Stub, assert_whole, chains};

const CAMPAIGN: &str = "FROUDE_TEST_CAMPAIGN";
const CASES: &str = "FROUDE_TEST_CASES";
const LIMIT: &str = "FROUDE_TEST_LIMIT_MIN";
/// Set: the scenarios that take minutes too.
const LONG: &str = "FROUDE_TEST_LONG";

/// Not a test of its own: what a job runs. A file `takes` in a case's folder says how many milliseconds the solver takes, a file `dies` how many attempts end the whole job.
#[test]
fn worker() {
    let Ok(folders) = std::env::var(CASES) else { return };
    let cancel = AtomicBool::new(false);
    for folder in folders.split(' ') {
        let (store, id) = Store::of_case(Path::new(folder)).unwrap();
        let asked = |name: &str| -> u64 {
            let text = std::fs::read_to_string(store.case_folder(&id).join(name));
            text.ok().and_then(|t| t.parse().ok()).unwrap_or(0)
        };
        let solver = Stub { takes: Duration::from_millis(asked("takes")), ..Stub::default() };
        let begun = |attempt, _: Option<&str>| {
            if u64::from(attempt) <= asked("dies") {
                std::process::abort();
            }
        };
        work(&store, &id, &solver, Duration::from_secs(20), &cancel, &begun, &|_| {}).unwrap();
    }
}

/// Not a test of its own: what the others start, and kill. It prints what was left; a file `cancel` in the campaign's folder cancels it.
#[test]
fn coordinator() {
    let Ok(root) = std::env::var(CAMPAIGN) else { return };
    let root = Path::new(&root);
    let program = vec!["/bin/sh".to_owned(), root.join("worker.sh").display().to_string()];
    let options = SlurmOptions {
        memory_mib: Some(10),
        partition: Some("main".to_owned()),
        time_limit_min: std::env::var(LIMIT).ok().map(|min| min.parse().unwrap()),
        // Three cases, by what they are assumed to cost.
        task_s: 4.5,
        poll: Duration::from_millis(200),
        ..SlurmOptions::new(program)
    };
    let cancel = Arc::new(AtomicBool::new(false));
    let (asked, request) = (cancel.clone(), root.join("cancel"));
    std::thread::spawn(move || {
        while !request.exists() {
            std::thread::sleep(Duration::from_millis(20));
        }
        asked.store(true, Ordering::SeqCst);
    });
    let ran = match run(&Store::open(root).unwrap(), &options, &cancel, &|_| {}) {
        Ok(ran) => ran,
        Err(error) => return println!("ERROR {error}"),
    };
    println!("CANCELLED {}", ran.was_cancelled);
    for (id, why) in ran.left {
        println!("LEFT {id}: {why}");
    }
}

#[test]
fn where_there_is_no_slurm_a_sentence_says_where_to_run() {
    let folder = tempfile::tempdir().unwrap();
    plan(folder.path(), &chains(1), "sha256").unwrap();
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "coordinator", "--nocapture"])
        .env(CAMPAIGN, folder.path())
        .env("PATH", folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    let sentence = "ERROR scontrol: there is no such program on PATH; run this on a host of the cluster that jobs are submitted from";
    assert!(said.contains(sentence), "{said}");
}

struct Campaign {
    folder: tempfile::TempDir,
    store: Store,
    conf: PathBuf,
}

impl Campaign {
    fn new(lab: &Lab, cases: &[Case]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (store, _) = plan(folder.path(), cases, "sha256").unwrap();
        let me = std::env::current_exe().unwrap();
        let script = format!("#!/bin/sh\n{CASES}=\"$*\" exec {} --exact worker --nocapture\n", me.display());
        std::fs::write(folder.path().join("worker.sh"), script).unwrap();
        Self { folder, store, conf: lab.conf() }
    }

    fn ask(&self, id: &str, name: &str, number: u64) {
        std::fs::write(self.store.case_folder(id).join(name), number.to_string()).unwrap();
    }

    fn take(&self, takes_ms: u64) {
        self.store.ids().for_each(|id| self.ask(id, "takes", takes_ms));
    }

    fn start(&self) -> Child {
        Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "coordinator", "--nocapture"])
            .env(CAMPAIGN, self.folder.path())
            .env("SLURM_CONF", &self.conf)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap()
    }

    /// What the coordinator says at its end.
    fn run(&self) -> String {
        let output = self.start().wait_with_output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    }

    fn is_running(&self, id: &str) -> bool {
        matches!(self.store.state(id), State::Running(_)) && !attempts(&self.store.case_folder(id)).unwrap().is_empty()
    }

    fn submissions(&self) -> usize {
        std::fs::read_dir(self.folder.path().join("slurm")).map_or(0, Iterator::count)
    }

    fn number(&self) -> String {
        let text = std::fs::read_to_string(self.folder.path().join("slurm/0001/number"));
        text.unwrap_or_default().trim().to_owned()
    }
}

#[test]
fn campaigns_come_to_exactly_one_result_of_each_case_whatever_happens_to_their_jobs() {
    let start = Instant::now();
    let Some(mut lab) = Lab::start() else { return };
    println!("{:.1} s: Slurm is there", start.elapsed().as_secs_f64());
    std::thread::scope(|scope| {
        let told = |name: &'static str, scenario: fn(&Lab)| {
            let lab = &lab;
            scope.spawn(move || {
                scenario(lab);
                println!("{:.1} s: {name}", start.elapsed().as_secs_f64());
            });
        };
        told("an array larger than the cluster takes is split", arrays_are_split);
        told("a coordinator that was killed goes on with its jobs", a_killed_coordinator_goes_on);
        told("a requeued job does its cases again", a_requeued_job_goes_on);
        told("a job that dies is submitted again, up to three times", a_dying_job_is_submitted_again);
        told("jobs are cancelled with their campaign", cancelled_jobs_end);
        if std::env::var_os(LONG).is_some() {
            told("a job at its time limit is submitted again", a_time_limit_is_hit);
        } else {
            println!("left out: a time limit takes minutes; set {LONG}");
        }
    });
    a_dead_node_loses_no_case(&mut lab);
    println!("{:.1} s: a dead node loses no case", start.elapsed().as_secs_f64());
}

fn arrays_are_split(lab: &Lab) {
    let campaign = Campaign::new(lab, &chains(6));
    assert_eq!(campaign.run().matches("LEFT").count(), 0);
    assert_whole(campaign.folder.path());
    assert_eq!(campaign.submissions(), 2, "six chains of three; arrays here have five tasks at most");
    let State::Done(last) = campaign.store.state("a017") else { panic!("a017") };
    assert_eq!(last.outcome.start_from.as_deref(), Some("a016"));
}

fn a_killed_coordinator_goes_on(lab: &Lab) {
    let campaign = Campaign::new(lab, &chains(3));
    campaign.take(700);
    for forget in [false, true] {
        let mut first = campaign.start();
        wait("a job", || !campaign.number().is_empty() && campaign.is_running("a000") || campaign.is_running("a001"));
        first.kill().unwrap();
        first.wait().unwrap();
        if forget {
            // As if it had been killed before sbatch wrote the number.
            std::fs::remove_file(campaign.folder.path().join("slurm/0001/number")).unwrap();
        }
    }
    campaign.run();
    assert_whole(campaign.folder.path());
    assert_eq!(campaign.submissions(), 1, "nothing that lives is submitted twice");
    for id in campaign.store.ids() {
        assert_eq!(attempts(&campaign.store.case_folder(id)).unwrap(), [1], "{id}");
    }
}

fn a_requeued_job_goes_on(lab: &Lab) {
    let campaign = Campaign::new(lab, &chains(1));
    campaign.take(1000);
    let coordinator = campaign.start();
    wait("the second case", || campaign.is_running("a001"));
    lab.ask("scontrol", &["requeue", &format!("{}_0", campaign.number())]);
    assert!(coordinator.wait_with_output().unwrap().status.success());
    assert_whole(campaign.folder.path());
    assert_eq!(campaign.submissions(), 1);
    assert_eq!(attempts(&campaign.store.case_folder("a000")).unwrap(), [1]);
    assert_eq!(attempts(&campaign.store.case_folder("a001")).unwrap().len(), 2);
}

fn cancelled_jobs_end(lab: &Lab) {
    let campaign = Campaign::new(lab, &chains(2));
    campaign.take(60_000);
    let coordinator = campaign.start();
    wait("both jobs", || campaign.is_running("a000") && campaign.is_running("a003"));
    std::fs::write(campaign.folder.path().join("cancel"), "").unwrap();
    let output = coordinator.wait_with_output().unwrap();
    assert!(String::from_utf8(output.stdout).unwrap().contains("CANCELLED true"));
    wait("the end of the jobs", || lab.ask("squeue", &["-h", "-j", &campaign.number()]).trim().is_empty());
    wait("the end of the workers", || campaign.store.states().values().all(|s| !matches!(s, State::Running(_))));
    std::fs::remove_file(campaign.folder.path().join("cancel")).unwrap();
    campaign.take(0);
    assert!(campaign.run().contains("CANCELLED false"));
    assert_whole(campaign.folder.path());
}

fn a_dying_job_is_submitted_again(lab: &Lab) {
    let campaign = Campaign::new(lab, &chains(2));
    campaign.ask("a000", "dies", 1);
    campaign.ask("a004", "dies", 99);
    let said = campaign.run();
    assert_eq!(said.matches("LEFT").count(), 1, "{said}");
    assert!(said.contains("LEFT a004: job "), "{said}");
    assert!(said.contains("has left no result of it; it printed slurm/"), "{said}");
    assert!(said.contains("; that was the last of 3 tries"), "{said}");
    campaign.ask("a004", "dies", 0);
    assert_eq!(campaign.store.state("a004"), State::Interrupted);
    assert_eq!(campaign.run().matches("LEFT").count(), 0);
    assert_whole(campaign.folder.path());
    let State::Done(last) = campaign.store.state("a005") else { panic!("a005") };
    assert!(last.outcome.reason.ends_with("it started from the inflow, as a004 has no result"), "{last:?}");
}

fn a_time_limit_is_hit(lab: &Lab) {
    let campaign = Campaign::new(lab, &[stub::case("a000", 0.1, None)]);
    campaign.ask("a000", "takes", 600_000);
    let coordinator = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "coordinator", "--nocapture"])
        .env(CAMPAIGN, campaign.folder.path())
        .env("SLURM_CONF", &campaign.conf)
        .env(LIMIT, "1")
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let output = coordinator.wait_with_output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("which ended as TIMEOUT, has left no result"), "{said}");
    assert!(said.contains("that was the last of 3 tries; give jobs more time"), "{said}");
    campaign.ask("a000", "takes", 0);
    campaign.run();
    assert_whole(campaign.folder.path());
}

fn a_dead_node_loses_no_case(lab: &mut Lab) {
    let campaign = Campaign::new(lab, &chains(2));
    campaign.take(1500);
    let coordinator = campaign.start();
    wait("both jobs", || campaign.is_running("a000") && campaign.is_running("a003"));
    let node = lab.ask("squeue", &["-h", "-r", "-t", "running", "-j", &campaign.number(), "-o", "%N"]);
    lab.kill_node(node.lines().next().unwrap().trim());
    assert!(coordinator.wait_with_output().unwrap().status.success());
    assert_whole(campaign.folder.path());
    let all = campaign.store.ids().map(|id| attempts(&campaign.store.case_folder(id)).unwrap().len()).sum::<usize>();
    assert!(all > 6, "the node's cases were begun again: {all} attempts");
}
