//! A campaign on this machine: chains, faults, plans over plans, files that were edited.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::stub::{Stub, assert_whole, case, chains, run};
use froude_cfd::case::Case;
use froude_cfd::change::plan;
use froude_cfd::collect::collect;
use froude_cfd::engine::{Event, local};
use froude_cfd::outcome::Status;
use froude_cfd::result;
use froude_cfd::retry::retry;
use froude_cfd::status::{CampaignStatus, Standing};
use froude_cfd::store::{State, Store};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn reason(store: &Store, id: &str) -> String {
    match store.state(id) {
        State::Done(attempted) => attempted.outcome.reason,
        other => panic!("{id}: {other:?}"),
    }
}

#[test]
fn each_case_ends_behind_the_one_that_it_starts_from_and_says_so() {
    let folder = folder();
    let (store, change) = plan(folder.path(), &chains(4), "sha256").unwrap();
    assert_eq!(change.new.len(), 12);
    let ended = Mutex::new(Vec::new());
    let cancel = AtomicBool::new(false);
    let ran = local::run(&store, &Stub::default(), 3, &cancel, &|event| {
        if let Event::Ended { id, .. } = event {
            ended.lock().unwrap().push(id);
        }
    })
    .unwrap();
    assert_eq!(ran.progress.done[&Status::Converged], 12);
    assert!(ran.left.is_empty() && !ran.was_cancelled);
    assert_whole(folder.path());
    let ended = ended.into_inner().unwrap();
    for case in chains(4) {
        let Some(from) = case.start_from else { continue };
        let at = |id: &str| ended.iter().position(|e| e == id).unwrap();
        assert!(at(&from) < at(&case.id));
        let State::Done(attempted) = store.state(&case.id) else { panic!("{}", case.id) };
        assert_eq!(attempted.outcome.start_from, Some(from));
    }
    let again = run(&store, &Stub { fails: vec!["a000"], ..Stub::default() }, 2);
    assert_eq!(again.progress, ran.progress, "what has a result is not run again");
}

#[test]
fn a_case_that_fails_in_any_way_stops_no_other_and_its_successor_starts_from_the_inflow() {
    let folder = folder();
    let (store, _) = plan(folder.path(), &chains(4), "sha256").unwrap();
    let solver = Stub {
        diverges: vec!["a000"],
        fails: vec!["a003"],
        panics: vec!["a006"],
        is_infinite: vec!["a009"],
        ..Stub::default()
    };
    let ran = run(&store, &solver, 2);
    assert_eq!(ran.progress.done[&Status::Converged], 8);
    assert_eq!(ran.progress.done[&Status::Diverged], 1);
    assert_eq!(ran.progress.done[&Status::Failed], 3);
    assert_eq!(reason(&store, "a003"), "simpleFoam ended with 1");
    assert_eq!(reason(&store, "a006"), "the solver's driver broke off: index out of range");
    assert_eq!(reason(&store, "a009"), "the solver's loads are not finite numbers");
    assert_eq!(reason(&store, "a001"), "as the test wants it; it started from the inflow, as a000 diverged");
    assert_eq!(reason(&store, "a004"), "as the test wants it; it started from the inflow, as a003 failed");
    assert_eq!(reason(&store, "a005"), "as the test wants it");
}

#[test]
fn what_is_cancelled_ends_soon_without_a_result_and_goes_on_later() {
    let folder = folder();
    let (store, _) = plan(folder.path(), &chains(3), "sha256").unwrap();
    let slow = Stub { takes: Duration::from_mins(1), ..Stub::default() };
    let cancel = AtomicBool::new(false);
    let start = Instant::now();
    let ran = std::thread::scope(|scope| {
        let ran = scope.spawn(|| local::run(&store, &slow, 2, &cancel, &|_| {}));
        while !store.case_folder("a003").join("attempt-001/reserve").exists() {
            std::thread::yield_now();
        }
        cancel.store(true, Ordering::SeqCst);
        ran.join().unwrap().unwrap()
    });
    assert!(ran.was_cancelled && start.elapsed() < Duration::from_secs(20));
    assert_eq!(store.state("a003"), State::Interrupted);
    assert_eq!(store.state("a006"), State::Planned);
    run(&store, &Stub::default(), 2);
    assert_whole(folder.path());
}

#[test]
fn two_coordinators_do_not_run_one_campaign() {
    let folder = folder();
    let (store, _) = plan(folder.path(), &chains(3), "sha256").unwrap();
    let slow = Stub { takes: Duration::from_millis(30), ..Stub::default() };
    let cancel = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let first = scope.spawn(|| run(&store, &slow, 1));
        while !matches!(store.state("a000"), State::Running(_)) {
            std::thread::yield_now();
        }
        let refused = local::run(&store, &slow, 1, &cancel, &|_| {}).unwrap_err().to_string();
        assert!(refused.contains("works on it; wait for it to end, or end it"), "{refused}");
        let refused = plan(folder.path(), &chains(1), "sha256").unwrap_err().to_string();
        assert!(refused.contains("works on it"), "{refused}");
        first.join().unwrap();
    });
    assert_whole(folder.path());
}

#[test]
fn a_file_that_was_edited_is_said_with_both_checksums_and_is_neither_run_nor_used() {
    let folder = folder();
    let (store, _) = plan(folder.path(), &chains(2), "sha256").unwrap();
    run(&store, &Stub::default(), 2);
    let result = store.case_folder("a000").join("result.json");
    let text = std::fs::read_to_string(&result).unwrap();
    std::fs::write(&result, text.replace("-0.0004", "-0.0005")).unwrap();
    let State::Edited(why) = store.state("a000") else { panic!("{:?}", store.state("a000")) };
    let stated = text.split('"').nth(3).unwrap();
    assert!(why.contains("result.json") && why.contains(&format!("and {stated} was written")), "{why}");

    let inputs = store.case_folder("a004").join("case.json");
    let text = std::fs::read_to_string(&inputs).unwrap();
    std::fs::write(&inputs, text.replace("0.06", "0.07")).unwrap();
    let State::Edited(why) = store.state("a004") else { panic!("{:?}", store.state("a004")) };
    assert!(why.contains("case.json: it was changed after it was written"), "{why}");
    let hash = chains(2)[4].hash();
    assert!(why.contains(&format!("and {hash} was written")), "{why}");
    assert_eq!(store.fields_of("a004"), None);
    let ran = run(&store, &Stub::default(), 1);
    assert_eq!(ran.left.len(), 2);
    assert_eq!(ran.progress.done[&Status::Converged], 4);
}

#[test]
fn a_result_moved_to_another_case_does_not_count_there() {
    let folder = folder();
    let (store, _) = plan(folder.path(), &chains(1), "sha256").unwrap();
    run(&store, &Stub::default(), 1);
    let [first, second] = ["a000", "a001"].map(|id| store.case_folder(id).join("result.json"));
    std::fs::remove_file(&second).unwrap();
    std::fs::copy(first, second).unwrap();
    let State::Edited(why) = store.state("a001") else { panic!("{:?}", store.state("a001")) };
    assert!(why.contains("it is the result of other inputs"), "{why}");
}

#[test]
fn a_plan_over_a_campaign_keeps_what_is_the_same_and_deletes_nothing() {
    let folder = folder();
    let first: Vec<_> = ["a", "b", "c"].map(|id| case(id, 0.1, None)).to_vec();
    let (store, _) = plan(folder.path(), &first, "sha256").unwrap();
    run(&store, &Stub::default(), 1);
    let mut second = first.clone();
    second[1].flow.speed_m_s = 0.2;
    second[2] = case("d", 0.3, Some("a"));

    let (store, change) = plan(folder.path(), &second, "sha256").unwrap();
    assert_eq!((change.kept, change.new), (vec!["a".to_owned()], vec!["b".to_owned(), "d".to_owned()]));
    let aside: Vec<&str> = change.aside.iter().map(|(id, _)| id.as_str()).collect();
    assert_eq!(aside, ["b", "c"]);
    assert!(folder.path().join("aside/001/c/result.json").exists());
    assert!(matches!(store.state("a"), State::Done(_)) && store.state("b") == State::Planned);

    let (store, change) = plan(folder.path(), &first, "sha256").unwrap();
    assert_eq!(change.back, ["b", "c"]);
    assert_eq!(change.aside.len(), 2);
    assert!(matches!(store.state("b"), State::Done(_)), "its result came back with it");
    assert_whole(folder.path());
}

#[test]
fn a_plan_that_cannot_be_is_refused() {
    let folder = folder();
    let refused = |cases: &[Case]| plan(folder.path(), cases, "sha256").unwrap_err().to_string();
    let said = refused(&[case("a/b", 0.1, None)]);
    assert_eq!(
        said,
        "case \"a/b\" cannot be taken: its name is that of a folder: 1 to 200 letters, digits, and -_.+ behind the first"
    );
    let said = refused(&[case("a", 0.1, Some("b")), case("b", 0.1, None)]);
    assert_eq!(said, "case \"a\" cannot be taken: it starts from \"b\", which does not stand before it");
    let said = refused(&[case("a", 0.1, None), case("a", 0.2, None)]);
    assert_eq!(said, "case \"a\" cannot be taken: another case has the same name");
    let said = Store::open(folder.path()).unwrap_err().to_string();
    assert!(said.ends_with("nothing is planned yet; froude cfd plan plans it"), "{said}");
}

#[test]
fn a_case_keeps_its_hash_through_its_file() {
    let folder = folder();
    for k in 1..300 {
        let mut case = case("a", 1.0 / f64::from(k), None);
        case.flow.angle_rad = f64::from(k).to_radians();
        case.water.viscosity_m2_s = 1e-6 / (1.0 + 0.033 * f64::from(k));
        std::fs::write(folder.path().join("case.json"), serde_json::to_string(&case).unwrap()).unwrap();
        assert_eq!(Case::read(folder.path()).unwrap().hash(), case.hash());
    }
}

#[test]
fn what_failed_or_diverged_is_tried_again_and_its_old_attempts_stay() {
    let folder = folder();
    let (store, _) = plan(folder.path(), &chains(2), "sha256").unwrap();
    run(&store, &Stub { diverges: vec!["a001"], fails: vec!["a003"], ..Stub::default() }, 2);
    let refused = retry(&store, &["a000".to_owned()]).unwrap_err().to_string();
    assert_eq!(refused, "case \"a000\" cannot be taken: its result counts");
    assert_eq!(retry(&store, &["a003".to_owned()]).unwrap(), ["a003"]);
    assert_eq!(store.state("a003"), State::Planned);
    run(&store, &Stub { fails: vec!["a003"], ..Stub::default() }, 1);
    assert_eq!(retry(&store, &[]).unwrap(), ["a001", "a003"]);
    run(&store, &Stub::default(), 2);
    assert_whole(folder.path());
    for attempt in ["attempt-001", "attempt-002", "attempt-003"] {
        assert!(store.case_folder("a003").join(attempt).join("result.json").exists(), "{attempt}");
    }
    let result = store.case_folder("a005").join("result.json");
    std::fs::write(&result, "{}").unwrap();
    let State::Edited(why) = store.state("a005") else { panic!("{:?}", store.state("a005")) };
    assert!(why.ends_with("froude cfd retry with its name computes the case again"), "{why}");
    assert_eq!(retry(&store, &[]).unwrap(), Vec::<String>::new());
    retry(&store, &["a005".to_owned()]).unwrap();
    run(&store, &Stub::default(), 1);
    assert_whole(folder.path());
}

#[test]
fn the_table_holds_what_counts_and_says_of_the_rest_why_not() {
    let folder = folder();
    let (store, _) = plan(folder.path(), &chains(2), "sha256").unwrap();
    let nothing = collect(&store);
    assert!(nothing.rows.is_empty());
    assert_eq!(nothing.without[0].1, "nobody has begun it; froude cfd run computes it");
    run(&store, &Stub { diverges: vec!["a001"], fails: vec!["a003"], ..Stub::default() }, 2);
    // Forces that were edited under a result that was not.
    let fields = store.case_folder("a005").join("attempt-001/fields");
    std::fs::write(&fields, "other").unwrap();
    let collection = collect(&store);
    let ids: Vec<&str> = collection.rows.iter().map(|r| r.case.id.as_str()).collect();
    assert_eq!(ids, ["a000", "a002", "a004"]);
    let row = &collection.rows[1];
    assert_eq!((row.case.configuration.as_str(), row.case.flow.speed_m_s, row.loads[0]), ("H3LT", 0.04, -0.0016));
    let why: Vec<&str> = collection.without.iter().map(|(_, why)| why.as_str()).collect();
    assert_eq!(why[..2], ["diverged: as the test wants it", "failed: simpleFoam ended with 1"]);
    assert!(why[2].contains("attempt-001/fields: it was changed after it was written"), "{}", why[2]);
    assert!(retry(&store, &["a005".to_owned()]).is_ok(), "its result does not count any more");
}

#[test]
fn the_status_puts_first_what_needs_a_hand_and_tells_time_and_room() {
    let folder = folder();
    let mut cases = chains(2);
    for late in &mut cases[3..] {
        late.mesh = "finer".to_owned();
    }
    let (store, _) = plan(folder.path(), &cases, "sha256").unwrap();
    let before = CampaignStatus::of(&store);
    assert_eq!(before.counts, [(Standing::Planned, 6)].into());
    // That of simpleFoam, until a case has ended here.
    assert!((before.s_per_cell_iteration - 3.2e-6).abs() < 1e-18);
    let cancel = AtomicBool::new(false);
    local::run(&store, &Stub { fails: vec!["a001"], writes: 5000, ..Stub::default() }, 1, &cancel, &|event| {
        let is_last = matches!(event, Event::Ended { id, .. } if id == "a002");
        cancel.fetch_or(is_last, Ordering::SeqCst);
    })
    .unwrap();
    let status = CampaignStatus::of(&store);
    assert_eq!(status.rows[0].id, "a001");
    assert_eq!((status.rows[0].standing, status.rows[0].attempts), (Standing::Failed, 1));
    assert_eq!(status.rows[0].reason, "simpleFoam ended with 1");
    assert_eq!(status.counts, [(Standing::Failed, 1), (Standing::Planned, 3), (Standing::Converged, 2)].into());
    let measured = status.s_per_cell_iteration;
    assert!((measured - 1e-6).abs() < 1e-18, "{measured}");
    assert!((status.cpu_s - 0.02).abs() < 1e-12 && (status.left_cpu_s - 0.03).abs() < 1e-12, "{status:?}");
    assert!(status.disk_bytes > 10_000, "{}", status.disk_bytes);
    assert!(serde_json::to_string(&status).unwrap().contains("\"standing\":\"failed\""));
}

#[test]
fn of_two_results_of_one_case_the_first_counts() {
    let folder = folder();
    let (store, _) = plan(folder.path(), &chains(1), "sha256").unwrap();
    run(&store, &Stub::default(), 1);
    let case_folder = store.case_folder("a000");
    let State::Done(first) = store.state("a000") else { panic!("a000") };
    // A worker that was taken for dead ends its attempt.
    let (attempt, _) = result::begin(&case_folder).unwrap();
    let mut late = (*first).clone();
    late.attempt = attempt;
    late.outcome.reason = "late".to_owned();
    result::write(&case_folder, &late).unwrap();
    assert!(!result::accept(&case_folder, attempt).unwrap());
    assert_eq!(store.state("a000"), State::Done(first));
}

/// On a disk of one mebibyte, where this program may mount one.
#[cfg(target_os = "linux")]
#[test]
fn on_a_full_disk_cases_fail_with_that_reason_and_are_tried_again_when_there_is_room() {
    let folder = folder();
    let place = folder.path().to_str().unwrap();
    let mount = |options: &str| {
        std::process::Command::new("mount").args(["-t", "tmpfs", "-o", options, "tmpfs", place]).status()
    };
    if !mount("size=1m").is_ok_and(|status| status.success()) {
        println!("left out: only root mounts a disk");
        return;
    }
    let (store, _) = plan(folder.path(), &chains(2), "sha256").unwrap();
    let large = Stub { writes: 3 << 20, ..Stub::default() };
    let full = run(&store, &large, 1);
    let said = reason(&store, "a000");
    let left = full.left.clone();
    mount("remount,size=60m").unwrap();
    assert_eq!(retry(&store, &[]).unwrap(), ["a000"]);
    let roomy = run(&store, &large, 2);
    let whole = std::panic::catch_unwind(|| assert_whole(folder.path()));
    std::process::Command::new("umount").args(["-l", place]).status().unwrap();
    assert!(said.ends_with("; the disk is full: make room, and let froude cfd retry compute the case again"), "{said}");
    assert_eq!(left.len(), 5);
    assert!(left.iter().all(|(_, why)| why.contains("the disk is full")), "{left:?}");
    assert!(roomy.left.is_empty() && whole.is_ok(), "{roomy:?}");
}
