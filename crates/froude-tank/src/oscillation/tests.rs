//! The same logs held in memory and averaged while they are read.

use std::cell::RefCell;
use std::path::Path;

use froude_identify::answer::Answer;
use froude_records::campaign_file::read_campaign;
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};
use froude_records::table_file::{prepare_table, read_table};

use super::*;
use crate::driven::source::identified;
use crate::driven::twin::files;
use crate::long_logs::{LENGTHS, Lengths};

/// Of eight runs of 7 periods of 6 s or 4.5 s and a second, 151,000 rows: four rows a block, 125 Hz.
const AVERAGED: Lengths = Lengths { longest: 100_000, kept: 34_000 };

/// The example campaign with eight runs at 500 Hz.
fn logged() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut text = std::fs::read_to_string(root.join("examples/mamba-oscillation/campaign.toml")).unwrap();
    for (from, to) in [
        ("[\"10 deg\", \"15 deg\", \"20 deg\"]", "[\"10 deg\", \"20 deg\"]"),
        ("[\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]", "[\"60 deg/s\", \"80 deg/s\"]"),
        ("rate      = \"100 Hz\"", "rate      = \"500 Hz\""),
    ] {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let path = folder.path().join("campaign.toml");
    std::fs::write(&path, text).unwrap();
    let campaign = read_campaign(&path).unwrap();
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    for file in files::<Oscillation>(&campaign, &campaign.sources[0]).unwrap() {
        std::fs::write(folder.path().join("runs").join(file.name), file.content).unwrap();
    }
    folder
}

fn found(folder: &Path, lengths: Lengths) -> Result<(Vec<Estimate>, Vec<Finding>, Vec<String>), MethodError> {
    let campaign = read_campaign(&folder.join("campaign.toml")).unwrap();
    let steps = RefCell::new(Vec::new());
    let found = identified::<Oscillation>(&campaign, &campaign.sources[0], lengths, &|step| {
        steps.borrow_mut().push(step.to_owned());
    })?;
    let estimates = found.results.iter().flat_map(Answer::estimates).cloned().collect();
    Ok((estimates, found.findings, steps.into_inner()))
}

/// Lost of a cosine is common to angle and force, and what is not common of second order. What moves is where a run begins and ends, by four of
/// 15,000 rows each: √(8/15,000) = 0.023 of the standard uncertainty; twice that is the bar.
const PART: f64 = 0.05;

/// The law that holds: residuals of another repeat with the motion, and their correlation time, which weighs what is declared, is no figure.
fn best(all: &[Estimate]) -> Vec<Estimate> {
    all.iter().filter(|e| e.recommended).cloned().collect()
}

#[track_caller]
fn alike(whole: &[Estimate], averaged: &[Estimate]) {
    assert!(!whole.is_empty() && whole.len() == averaged.len());
    for (a, b) in whole.iter().zip(averaged) {
        assert_eq!(a.law.name, b.law.name);
        for ((name, a), b) in a.coefficients.iter().zip(b.coefficients.values()) {
            let known = |c: &froude_records::estimate::Coefficient| c.value.zip(c.standard_uncertainty);
            let (Some((x, u)), Some((y, v))) = (known(a), known(b)) else {
                assert_eq!((a.value, a.status), (b.value, b.status), "{name}");
                continue;
            };
            assert!((x - y).abs() < PART * u, "{name}: {x} and {y} with {u}");
            assert!((u / v - 1.0).abs() < PART, "{name}: {u} and {v}");
        }
    }
}

#[test]
fn coefficients_of_averaged_logs_are_those_of_the_logs_and_the_step_is_stated() {
    let folder = logged();
    let (whole, findings, _) = found(folder.path(), LENGTHS).unwrap();
    assert!(findings.iter().all(|f| f.code != "log-averaged"));
    let (averaged, findings, steps) = found(folder.path(), AVERAGED).unwrap();
    alike(&best(&whole), &best(&averaged));
    let words = &averaged[0].method.words;
    assert!(
        words.starts_with(
            "8 of 8 logs averaged in blocks of 4 rows while read (no delay; gain at the highest harmonic 0.99"
        ),
        "{words}"
    );
    let note = findings.iter().find(|f| f.code == "log-averaged").unwrap();
    assert!(
        note.severity == Severity::Note
            && note.message.contains("rows at 500.00 Hz are averaged in blocks of 4 while they are read")
            && note.message.contains("noise bandwidth 62.5 Hz"),
        "{note:?}"
    );
    assert!(steps.iter().any(|s| s == "reading 001.csv, 100 %"), "{steps:?}");
    // The same rows as Parquet.
    for entry in std::fs::read_dir(folder.path().join("runs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "csv") {
            let table = read_table(&path, None).unwrap();
            prepare_table(&table, &path.with_extension("parquet")).unwrap().take_place().unwrap();
            std::fs::remove_file(&path).unwrap();
            let sidecar = path.with_extension("toml");
            let text = std::fs::read_to_string(&sidecar).unwrap();
            let text = text
                .replace("time  =", "\"time [s]\" =")
                .replace("phi   =", "\"angle [rad]\" =")
                .replace("\nforce =", "\n\"force [N]\" =");
            std::fs::write(&sidecar, text).unwrap();
        }
    }
    let (parquet, _, _) = found(folder.path(), AVERAGED).unwrap();
    let values = |all: &[Estimate]| -> Vec<Option<f64>> {
        all.iter().flat_map(|e| e.coefficients.values().map(|c| c.value)).collect()
    };
    assert_eq!(values(&parquet), values(&averaged));
}

/// Nothing is weighed against the rows where all that is declared is exact: then every law has the same coefficients, the wrong one too.
#[test]
fn without_priors_every_law_has_the_coefficients_of_the_logs() {
    let folder = logged();
    let path = folder.path().join("campaign.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let exact = text
        .replace("standard = \"0.02 N\"", "standard = \"0 N\"")
        .replace("standard = \"5 ms\"", "standard = \"0 ms\"");
    assert_ne!(text, exact);
    std::fs::write(&path, exact).unwrap();
    let [(whole, ..), (averaged, ..)] = [LENGTHS, AVERAGED].map(|lengths| found(folder.path(), lengths).unwrap());
    assert_eq!(whole.len(), 2);
    alike(&whole, &averaged);
}

/// Rows of a log by their number.
fn rewrite(log: &Path, keep: impl Fn(usize) -> bool, change: impl Fn(usize, &str) -> String) {
    let text = std::fs::read_to_string(log).unwrap();
    let mut lines = text.lines();
    let mut out = format!("{}\n", lines.next().unwrap());
    for (i, line) in lines.enumerate().filter(|(i, _)| keep(*i)) {
        out += &(change(i, line) + "\n");
    }
    std::fs::write(log, out).unwrap();
}

#[test]
fn gaps_stay_gaps_and_a_clipped_sensor_is_seen_in_the_rows_recorded() {
    let folder = logged();
    let path = folder.path().join("campaign.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    // The gap cuts one of five cycles.
    let text = text.replace("models = [\"f1\", \"f4\"]", "models = [\"f4\"]");
    std::fs::write(&path, text.replace("used = 5 }", "used = 5, fewest = 4 }")).unwrap();
    let log = folder.path().join("runs/002.csv");
    rewrite(&log, |i| !(7_502..7_702).contains(&i), |_, line| line.to_owned());
    let (whole, in_memory, _) = found(folder.path(), LENGTHS).unwrap();
    let (averaged, findings, _) = found(folder.path(), AVERAGED).unwrap();
    alike(&best(&whole), &best(&averaged));
    let gaps = |findings: &[Finding]| findings.iter().find(|f| f.code == "time-gaps").unwrap().message.clone();
    assert_eq!(gaps(&in_memory), gaps(&findings));
    assert!(gaps(&findings).contains("200 ticks are missing"));
    // Of 7,502 rows before the gap two, of 8,548 behind it none.
    let note = findings.iter().find(|f| f.code == "log-averaged" && f.message.contains("002.csv")).unwrap();
    assert!(note.message.contains("; 2 rows of blocks that a gap or the end cuts are left out"), "{note:?}");

    let text = std::fs::read_to_string(&log).unwrap();
    let force = |line: &str| line.rsplit_once(',').unwrap().1.parse::<f64>().unwrap();
    // Start-up has the largest forces: the limit is that of a quarter of the rows.
    let mut forces: Vec<f64> = text.lines().skip(1).map(force).collect();
    forces.sort_by(f64::total_cmp);
    let limit = forces[3 * forces.len() / 4];
    let limited = |_: usize, line: &str| format!("{},{:.6}", line.rsplit_once(',').unwrap().0, force(line).min(limit));
    rewrite(&log, |_| true, limited);
    let said = |lengths: Lengths| found(folder.path(), lengths).unwrap_err().to_string();
    // In memory the readings are marked, and no cycle is left without a mark; averages would hide them, and the run is refused as it was recorded.
    let in_memory = said(LENGTHS);
    assert!(in_memory.contains("run \"002\": of its 5 whole cycles 0 are left without a mark"), "{in_memory}");
    assert!(in_memory.contains("and 4 are needed: 8 marks"), "{in_memory}");
    assert!(said(AVERAGED).contains("run \"002\": force stays at "), "{}", said(AVERAGED));
}

#[test]
fn averages_that_are_too_coarse_for_the_motion_are_doubted() {
    let folder = logged();
    let (_, findings, _) = found(folder.path(), Lengths { longest: 100_000, kept: 5_000 }).unwrap();
    // 30 rows at 500 Hz, 0.5 Hz: (π·0.060·0.5)²/6 = 1.5e-3.
    let doubt = findings.iter().find(|f| f.code == "averages-too-coarse").unwrap();
    assert!(doubt.severity == Severity::Warning && doubt.message.contains("0.998"), "{doubt:?}");
}
