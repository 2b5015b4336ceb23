//! A coordinator killed at any moment: the next goes on, each case comes to exactly one result, and none is lost.
//!
//! The coordinator is this program again, told by its environment. What it does between two of its system calls is hit by chance: its cases take half a millisecond, so that most of its time goes into folders, results, links and locks.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::stub::{Stub, assert_whole, chains, run};
use froude_cfd::case::Case;
use froude_cfd::change::plan;
use froude_cfd::result::{attempt_folder, attempts};
use froude_cfd::store::{State, Store};

const CAMPAIGN: &str = "FROUDE_TEST_CAMPAIGN";
const KILLS: &str = "FROUDE_TEST_KILLS";

/// Not a test of its own: what the others start, and kill.
#[test]
fn coordinator() {
    let Ok(root) = std::env::var(CAMPAIGN) else { return };
    let store = Store::open(Path::new(&root)).unwrap();
    run(&store, &Stub { takes: Duration::from_micros(500), ..Stub::default() }, 2);
}

/// Not a test of its own: a plan of every second chain, with other speeds.
#[test]
fn planner() {
    let Ok(root) = std::env::var(CAMPAIGN) else { return };
    plan(Path::new(&root), &other_chains(), "sha256").unwrap();
}

fn other_chains() -> Vec<Case> {
    let mut cases: Vec<Case> = chains(40).chunks(3).step_by(2).flatten().cloned().collect();
    for case in cases.iter_mut().step_by(4) {
        case.flow.speed_m_s += 1.0;
    }
    cases
}

fn start(root: &Path) -> std::process::Child {
    start_test("coordinator", root)
}

fn start_test(name: &str, root: &Path) -> std::process::Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", &format!("kills::{name}"), "--test-threads", "1"])
        .env(CAMPAIGN, root)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// A number of kills: 60 here, more where `FROUDE_TEST_KILLS` says so.
#[test]
fn after_any_kill_the_campaign_goes_on_and_each_case_has_exactly_one_result() {
    let kills: u32 = std::env::var(KILLS).ok().and_then(|n| n.parse().ok()).unwrap_or(60);
    let mut phases = Phases::default();
    let (mut killed, mut started, mut campaigns) = (0, 0, 0);
    while killed < kills {
        campaigns += 1;
        let folder = tempfile::tempdir().unwrap();
        let (store, _) = plan(folder.path(), &chains(20), "sha256").unwrap();
        // Until a coordinator comes to the end by itself.
        loop {
            let mut child = start(folder.path());
            // Spread evenly over what a campaign takes, in an order that leaves no gap.
            started += 1;
            let part = (f64::from(started) * 0.618_033_988_75).fract();
            std::thread::sleep(Duration::from_micros(2000 + (50_000.0 * part) as u64));
            child.kill().unwrap();
            if child.wait().unwrap().success() {
                break;
            }
            killed += 1;
            for (id, state) in store.states() {
                assert!(!matches!(state, State::Running(_)), "{id}: the dead hold nothing");
                phases.see(&store.case_folder(&id), &state);
            }
            if killed >= kills {
                run(&store, &Stub::default(), 2);
                break;
            }
        }
        assert_whole(folder.path());
    }
    println!("{killed} kills in {campaigns} campaigns left {phases:?}");
    assert!(phases.solving + phases.in_result + phases.before_link + phases.in_lock + phases.in_begin > 0);
    if kills >= 500 {
        let Phases { in_lock, in_begin, solving, in_result, before_link } = phases;
        assert!([in_lock, in_begin, solving, in_result, before_link].iter().all(|n| *n > 0), "each phase was hit");
    }
}

/// Where the kills hit the cases that were begun and have no result.
#[derive(Debug, Default)]
struct Phases {
    /// The lock was being taken, or had just been.
    in_lock: usize,
    /// The attempt's folder was there, and nothing whole in it.
    in_begin: usize,
    /// The solver was at work, or had just been.
    solving: usize,
    /// The result was being written.
    in_result: usize,
    /// The result was there and did not count yet.
    before_link: usize,
}

impl Phases {
    fn see(&mut self, case_folder: &Path, state: &State) {
        let names = |folder: &Path| -> Vec<String> {
            let entries = std::fs::read_dir(folder).unwrap().flatten();
            entries.map(|e| e.file_name().into_string().unwrap()).collect()
        };
        let attempts = attempts(case_folder).unwrap();
        let phase = match (state, attempts.into_iter().max()) {
            (State::Planned, _) if names(case_folder).len() > 1 => &mut self.in_lock,
            (State::Interrupted, Some(last)) => {
                let files = names(&attempt_folder(case_folder, last));
                let has = |name: &str| files.iter().any(|f| f.starts_with(name));
                match () {
                    () if has("result.json") => &mut self.before_link,
                    () if has("reserve") => &mut self.solving,
                    () if has("fields") => &mut self.in_result,
                    () => &mut self.in_begin,
                }
            }
            _ => return,
        };
        *phase += 1;
    }
}

#[test]
fn of_many_coordinators_that_take_over_from_a_dead_one_one_runs() {
    let folder = tempfile::tempdir().unwrap();
    plan(folder.path(), &chains(20), "sha256").unwrap();
    let mut first = start(folder.path());
    std::thread::sleep(Duration::from_millis(50));
    first.kill().unwrap();
    first.wait().unwrap();
    let mut children: Vec<_> = (0..6).map(|_| start(folder.path())).collect();
    let successes = children.iter_mut().filter_map(|c| c.wait().unwrap().success().then_some(())).count();
    assert!(successes >= 1);
    assert_whole(folder.path());
    let begun: usize =
        chains(20).iter().map(|c| attempts(&folder.path().join("cases").join(&c.id)).unwrap().len()).sum();
    assert!(begun <= 62, "{begun} attempts at 60 cases, of which a kill interrupted two at most");
}

#[test]
fn a_plan_that_is_killed_is_ended_by_the_next_and_no_result_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let (store, _) = plan(root, &chains(40), "sha256").unwrap();
    run(&store, &Stub::default(), 2);
    let mut killed = 0;
    for round in 0..15 {
        let mut child = start_test("planner", root);
        std::thread::sleep(Duration::from_micros(2000 + 4000 * round));
        child.kill().unwrap();
        killed += usize::from(!child.wait().unwrap().success());
        if round % 3 == 0 {
            let (store, change) = plan(root, &chains(40), "sha256").unwrap();
            assert!(change.new.is_empty(), "all come back with their results: {:?}", change.new);
            assert_eq!(store.states().values().filter(|s| s.status().is_some()).count(), 120);
        }
    }
    assert!(killed > 5, "{killed} of 15 plans were killed");
    let (store, _) = plan(root, &other_chains(), "sha256").unwrap();
    run(&store, &Stub::default(), 2);
    assert_whole(root);
    plan(root, &chains(40), "sha256").unwrap();
    assert_whole(root);
}
