//! Two people at one rig: the second `froude run` into a folder is refused, and the next one after a crash is not.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Drives the example's 205 runs on the twin, until somebody ends it.
fn run(campaign: &Path, runs: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_froude"));
    command.args(["run", "--yes"]).arg(campaign).arg("--out").arg(runs).stdin(Stdio::null()).stdout(Stdio::null());
    command
}

/// Waits until the folder holds what is looked for.
fn until<T>(child: &mut Child, found: impl Fn() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = found() {
            return found;
        }
        assert!(child.try_wait().unwrap().is_none(), "it ended too early");
        assert!(begun.elapsed() < Duration::from_mins(2), "nothing came in two minutes");
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn a_second_run_into_a_folder_is_refused_with_who_is_first_and_a_dead_one_blocks_nobody() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/towing-carriage/campaign.toml");
    let runs = folder.path().join("runs");
    let mut first = run(&campaign, &runs).stderr(Stdio::null()).spawn().unwrap();
    let has_log = || names(&runs).iter().any(|name| name.strip_suffix(".mcap").is_some()).then_some(());
    until(&mut first, has_log);

    let second = run(&campaign, &runs).output().unwrap();
    assert!(first.try_wait().unwrap().is_none(), "the first goes on");
    let error = String::from_utf8_lossy(&second.stderr);
    assert_eq!(second.status.code(), Some(1), "{error}");
    let host =
        std::fs::read_to_string("/proc/sys/kernel/hostname").map(|h| format!(" on {}", h.trim())).unwrap_or_default();
    let who = format!("another froude is driving into this folder (process {}{host}", first.id());
    assert!(error.contains(&who), "{error}");
    // When it began: today, by the clock.
    let since = error.split(", since ").nth(1).unwrap().split(" UTC").next().unwrap();
    let is_time = since.len() == "2026-01-01 00:00:00".len() && since.matches(':').count() == 2;
    assert!(is_time, "{error}");
    assert!(error.contains("nothing was moved and nothing changed"), "{error}");
    let aside: Vec<_> = names(&runs).into_iter().filter(|name| name.contains("interrupted")).collect();
    assert!(aside.is_empty(), "the first one's logs are where they were: {aside:?}");

    first.kill().unwrap();
    first.wait().unwrap();
    let mut third = run(&campaign, &runs).stderr(Stdio::null()).spawn().unwrap();
    let id = third.id();
    until(&mut third, || {
        let who = std::fs::read_to_string(runs.join("drive.lock")).ok()?;
        who.starts_with(&format!("process {id} ")).then_some(())
    });
    third.kill().unwrap();
    third.wait().unwrap();
}
