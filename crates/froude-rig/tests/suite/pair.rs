//! What resuming learns about a run that lies in a folder.

use std::path::{Path, PathBuf};

use crate::common::{layout, meta, row};
use froude_records::run::{
    CampaignMark, Packing, Recorder, RunMeta, RunStatus, parse_run_meta, read_run, write_run_meta,
};
use froude_rig::campaign::pair::{Pair, check_pair};

/// Records ticks 0..n, and gives the file.
fn recorded(folder: &Path, id: &str, ticks: u64) -> PathBuf {
    let mut recorder = Recorder::create(folder, meta(id), layout(), Packing::Lz4).unwrap();
    (0..ticks).for_each(|tick| recorder.record(tick, &row(tick)).unwrap());
    recorder.finish(RunStatus::Complete).unwrap()
}

/// What resuming learns about a run.
fn pair(folder: &Path, id: &str) -> Result<Pair, froude_records::RecordError> {
    let campaign = meta(id).campaign;
    check_pair(folder, id, CampaignMark { name: &campaign, sha256: "" })
}

fn reason(folder: &Path, id: &str) -> String {
    match pair(folder, id).unwrap() {
        Pair::Again { reason } => reason,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_run_is_complete_only_when_log_and_sidecar_are_what_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    assert_eq!(pair(at, "run").unwrap(), Pair::Absent);
    let path = recorded(at, "run", 300);
    let sidecar = path.with_extension("toml");
    assert!(matches!(pair(at, "run").unwrap(), Pair::Complete { is_compared: true, .. }));

    let (log, text) = (std::fs::read(&path).unwrap(), std::fs::read(&sidecar).unwrap());
    std::fs::write(&path, &log[..log.len() - 1]).unwrap();
    let cut = format!("run.mcap has {} of the {} bytes that were recorded: it was cut off", log.len() - 1, log.len());
    assert_eq!(reason(at, "run"), cut);
    std::fs::remove_file(&path).unwrap();
    assert_eq!(reason(at, "run"), "the log run.mcap is gone; run.toml says complete");
    std::fs::write(&path, &log).unwrap();
    std::fs::remove_file(&sidecar).unwrap();
    assert_eq!(reason(at, "run"), "run.mcap has no sidecar run.toml");

    // Of an earlier version: without a hash only the log's own checksums speak.
    let old = RunMeta { log: None, ..parse_run_meta(&sidecar, std::str::from_utf8(&text).unwrap()).unwrap() };
    write_run_meta(&sidecar, &old).unwrap();
    assert!(matches!(pair(at, "run").unwrap(), Pair::Complete { is_compared: false, .. }));
    std::fs::write(&path, &log[..log.len() / 2]).unwrap();
    assert!(reason(at, "run").starts_with("run is damaged: "), "{}", reason(at, "run"));
    std::fs::write(&path, &log).unwrap();

    // Of another run, of another campaign.
    let other = CampaignMark { name: "another", sha256: "" };
    let error = check_pair(at, "run", other).unwrap_err().to_string();
    assert!(error.ends_with("and \"another\" is driven here: move run.mcap and run.toml out of the folder, or name another folder with --out"), "{error}");
    for extension in ["mcap", "toml"] {
        std::fs::copy(path.with_extension(extension), at.join("next").with_extension(extension)).unwrap();
    }
    let error = pair(at, "next").unwrap_err().to_string();
    let expected = "is the sidecar of run run, not of next: it was renamed or exchanged; give log and sidecar the name of their own run, or move \
                both out of the folder";
    assert_eq!(error, format!("{} {expected}", at.join("next.toml").display()));
}

#[test]
fn a_run_without_its_end_is_driven_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::create(folder.path(), meta("run"), layout(), Packing::Lz4).unwrap();
    (0..500).for_each(|tick| recorder.record(tick, &row(tick)).unwrap());
    drop(recorder);
    assert_eq!(reason(folder.path(), "run"), "run was interrupted without notice: it has no end");
    // Cut off in silence is what a crash does: it is no damage of the log.
    assert_eq!(read_run(&folder.path().join("run.mcap")).unwrap().doubts, []);
    let mut recorder = Recorder::create(folder.path(), meta("next"), layout(), Packing::Lz4).unwrap();
    recorder.record(0, &row(0)).unwrap();
    "stopped by the operator".clone_into(&mut recorder.meta_mut().note);
    recorder.finish(RunStatus::Interrupted).unwrap();
    assert_eq!(reason(folder.path(), "next"), "next is interrupted: stopped by the operator");
}

#[test]
fn runs_whose_logs_were_exchanged_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let short = recorded(folder.path(), "045-wet", 300);
    let long = recorded(folder.path(), "046-dry", 900);
    let aside = folder.path().join("aside");
    std::fs::rename(&short, &aside).unwrap();
    std::fs::rename(&long, &short).unwrap();
    std::fs::rename(&aside, &long).unwrap();
    for id in ["045-wet", "046-dry"] {
        let error = pair(folder.path(), id).unwrap_err().to_string();
        let text = "they were exchanged or renamed; give each log and each sidecar the name of its own run";
        assert!(error.contains(text), "{error}");
    }
}
