//! The same logs held in memory and averaged while they are read.

use std::cell::RefCell;
use std::path::Path;

use froude_identify::answer::Answer;
use froude_records::campaign::read_campaign;
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};
use froude_records::table::{prepare_table, read_table};

use super::*;

/// Nine rows a block, 111 Hz.
const AVERAGED: Lengths = Lengths { longest: 20_000, kept: 5_000 };

/// The example campaign with eight runs at 1 kHz, 44 s each, and the white noise of a fast logger beside the slow one.
fn logged() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut text = std::fs::read_to_string(root.join("examples/mamba-oscillation/campaign.toml")).unwrap();
    for (from, to) in [
        ("[\"10 deg\", \"15 deg\", \"20 deg\"]", "[\"10 deg\", \"20 deg\"]"),
        ("[\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]", "[\"60 deg/s\", \"80 deg/s\"]"),
        ("rate      = \"100 Hz\"", "rate      = \"1000 Hz\""),
    ] {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let path = folder.path().join("campaign.toml");
    std::fs::write(&path, text).unwrap();
    let campaign = read_campaign(&path).unwrap();
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    for file in simulate::files(&campaign, &campaign.sources[0]).unwrap() {
        std::fs::write(folder.path().join("runs").join(file.name), file.content).unwrap();
    }
    folder
}

fn found(folder: &Path, lengths: Lengths) -> Result<(Vec<Estimate>, Vec<Finding>, Vec<String>), MethodError> {
    let campaign = read_campaign(&folder.join("campaign.toml")).unwrap();
    let steps = RefCell::new(Vec::new());
    let found = identified(&campaign, &campaign.sources[0], lengths, &|step| steps.borrow_mut().push(step.to_owned()))?;
    let estimates = found.results.iter().flat_map(Answer::estimates).cloned().collect();
    Ok((estimates, found.findings, steps.into_inner()))
}

/// Lost of a cosine is common to angle and force; what is not common is of second order. A fiftieth of the standard uncertainty is far above both,
/// and the scatter itself changes by what white noise within a block and the end of the last one, eight rows, have of it.
#[track_caller]
fn alike(whole: &[Estimate], averaged: &[Estimate]) {
    assert_eq!(whole.len(), averaged.len());
    for (a, b) in whole.iter().zip(averaged) {
        assert_eq!(a.recommended, b.recommended);
        for ((name, a), b) in a.coefficients.iter().zip(b.coefficients.values()) {
            let (Some([x, u]), Some([y, v])) = (
                a.value.zip(a.standard_uncertainty).map(|(x, u)| [x, u]),
                b.value.zip(b.standard_uncertainty).map(|(x, u)| [x, u]),
            ) else {
                assert_eq!((a.value, a.status), (b.value, b.status), "{name}");
                continue;
            };
            assert!((x - y).abs() < 0.02 * u, "{name}: {x} and {y} with {u}");
            assert!((u / v - 1.0).abs() < 0.02, "{name}: {u} and {v}");
        }
    }
}

#[test]
fn coefficients_of_averaged_logs_are_those_of_the_logs_and_the_step_is_stated() {
    let folder = logged();
    let (whole, findings, _) = found(folder.path(), LENGTHS).unwrap();
    assert!(findings.iter().all(|f| f.code != "log-averaged"));
    let (averaged, findings, steps) = found(folder.path(), AVERAGED).unwrap();
    alike(&whole, &averaged);
    let words = &averaged[0].method.words;
    // Eight runs of 7 periods and a second: 43,000 and 32,500 rows.
    assert!(
        words.starts_with(
            "8 of 8 logs averaged in blocks of 7 to 9 rows while read (no delay; gain at the highest harmonic 0.99"
        ),
        "{words}"
    );
    let note = findings.iter().find(|f| f.code == "log-averaged").unwrap();
    assert!(
        note.severity == Severity::Note
            && note.message.contains("43000 rows at 1000 Hz are averaged in blocks of 9")
            && note.message.contains("noise bandwidth 55.6 Hz"),
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
    let log = folder.path().join("runs/002.csv");
    rewrite(&log, |i| !(15_000..15_400).contains(&i), |_, line| line.to_owned());
    let (whole, in_memory, _) = found(folder.path(), LENGTHS).unwrap();
    let (averaged, findings, _) = found(folder.path(), AVERAGED).unwrap();
    alike(&whole, &averaged);
    let gaps = |findings: &[Finding]| findings.iter().find(|f| f.code == "time-gaps").unwrap().message.clone();
    assert_eq!(gaps(&in_memory), gaps(&findings));
    assert!(gaps(&findings).contains("400 ticks are missing"));
    // Before the gap 15,000 = 1666·9 + 6 rows, behind it 27,600 (or so) again.
    let note = findings.iter().find(|f| f.code == "log-averaged" && f.message.contains("002.csv")).unwrap();
    assert!(note.message.contains("of blocks that a gap or the end cuts are left out"), "{note:?}");

    let limited = |_: usize, line: &str| {
        let (before, force) = line.rsplit_once(',').unwrap();
        format!("{before},{:.6}", force.parse::<f64>().unwrap().min(3.2))
    };
    rewrite(&log, |_| true, limited);
    let said = |lengths: Lengths| found(folder.path(), lengths).unwrap_err().to_string();
    assert!(said(LENGTHS).contains("run \"002\": force stays at 3.2 N for"), "{}", said(LENGTHS));
    assert_eq!(said(AVERAGED), said(LENGTHS));
}

#[test]
fn averages_that_are_too_coarse_for_the_motion_are_doubted() {
    let folder = logged();
    let (_, findings, _) = found(folder.path(), Lengths { longest: 20_000, kept: 700 }).unwrap();
    // 62 rows at 1 kHz and 0.5 Hz, 47 and 0.667 Hz: (π·0.062·0.5)²/6 = 1.6e-3.
    let doubt = findings.iter().find(|f| f.code == "averages-too-coarse").unwrap();
    assert!(doubt.severity == Severity::Warning && doubt.message.contains("0.998"), "{doubt:?}");
}
