//! Two logs of one run with clocks of their own, at the verbs: joined, and what is refused.

use std::fmt::Write as _;
use std::path::Path;

use crate::tank::{froude, json, refused, replace_in, said, simulated};
use serde_json::Value;

const EXAMPLE: &str = "mamba-oscillation";
/// Two amplitudes at two frequencies: eight runs.
const SMALL: [(&str, &str); 2] = [
    ("[\"10 deg\", \"15 deg\", \"20 deg\"]", "[\"10 deg\", \"20 deg\"]"),
    ("[\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]", "[\"60 deg/s\", \"80 deg/s\"]"),
];
const IDENTIFY: [&str; 3] = ["identify", "campaign.toml", "--json"];

/// The clock of the load log: its stamps are late by 0.37 s at its zero, and gain 50 ppm.
const LAG_S: f64 = 0.37;
const DRIFT: f64 = 50e-6;

/// Splits each log of the twin in two: the angle at 50 Hz, and at 100 Hz by another clock the force, with the angle of a sensor of its own noise, in rad.
fn split(folder: &Path, own_noise: f64) {
    let runs = folder.join("runs");
    for entry in std::fs::read_dir(&runs).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "csv") {
            continue;
        }
        let id = path.file_stem().unwrap().to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).unwrap();
        let (mut motion, mut load) = ("time,phi\n".to_owned(), "t,potentiometer,force\n".to_owned());
        let mut state = 1;
        for (i, line) in text.lines().skip(1).enumerate() {
            let [t, phi, force] = line.split(',').map(|x| x.parse().unwrap()).collect::<Vec<f64>>().try_into().unwrap();
            if i % 2 == 0 {
                writeln!(motion, "{t},{phi}").unwrap();
            }
            let own = phi + own_noise * noise(&mut state);
            writeln!(load, "{:.7},{own},{force}", (t + LAG_S) / (1.0 - DRIFT)).unwrap();
        }
        std::fs::write(&path, motion).unwrap();
        std::fs::write(runs.join(format!("{id}_load.csv")), load).unwrap();
        let sidecar = path.with_extension("toml");
        let text = std::fs::read_to_string(&sidecar).unwrap();
        let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with("force")).collect();
        let join = format!(
            "\n[[log.join]]\nfile = \"{id}_load.csv\"\nsame = [\"angle\", \"angle\"]\n[log.join.columns]\nt = {{ name = \"time\", unit = \"s\" }}\n\
             potentiometer = {{ name = \"angle\", unit = \"rad\", sign = 1, frame = \"sensor\", clock = \"log\" }}\n\
             force = {{ name = \"force\", unit = \"N\", sign = 1, frame = \"body\", clock = \"log\" }}\n"
        );
        std::fs::write(&sidecar, lines.join("\n") + &join).unwrap();
    }
}

/// A number from −1 to 1, by Knuth's generator.
fn noise(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn interval(record: &Value, law: &str, name: &str) -> [f64; 2] {
    let all = record["estimates"].as_array().unwrap();
    let estimate = all.iter().find(|e| e["law"]["name"] == law).unwrap();
    [0, 1].map(|k| estimate["coefficients"][name]["interval_95"][k].as_f64().unwrap())
}

/// Half of the rows, at means of two, show what all of them do: the noise of the cell is correlated over fifty.
#[test]
fn an_oscillation_in_two_logs_comes_back_with_the_intervals_of_one() {
    let folder = simulated(EXAMPLE, &SMALL);
    let whole = json(&froude(folder.path(), &IDENTIFY));
    split(folder.path(), 5e-4);
    let joined = json(&froude(folder.path(), &IDENTIFY));
    let [[a, b], [c, d]] = [&whole, &joined].map(|record| interval(record, "added_mass_f4", "C_A"));
    assert!(c < 1.277 && 1.277 < d, "{c} to {d}");
    assert!(((d - c) / (b - a) - 1.0).abs() < 0.1, "{c} to {d} for {a} to {b}");
    assert!((0.5 * (c + d - a - b)).abs() < 0.2 * (b - a), "{c} to {d} for {a} to {b}");
    let data = joined["data"].as_object().unwrap();
    let file = |id: &str| data.values().find(|data| data["path"].as_str().unwrap().ends_with(id)).unwrap();
    assert!(file("/001_load.csv").is_object());
    let step = &file("/001.csv")["steps"][0];
    assert_eq!(step["step"], "join");
    let of = |name: &str| step["parameters"][name]["value"].as_f64().unwrap();
    assert!((of("lag") - LAG_S - DRIFT * of("origin")).abs() <= 3.0 * of("standard_of_lag"), "{step}");
    assert!((of("drift") - DRIFT).abs() <= 3.0 * of("standard_of_drift"), "{step}");
    assert!(of("standard_uncertainty") < 1e-3, "{step}");
    let findings = joined["findings"].as_array().unwrap();
    let message = findings.iter().find(|f| f["code"] == "logs-joined").unwrap()["message"].as_str().unwrap();
    assert!(message.contains("stamps of 001_load.csv read 0.3"), "{message}");
    let shown = froude(folder.path(), &["inspect", "runs"]);
    let shown = String::from_utf8_lossy(&shown.stdout).into_owned() + &said(&shown);
    assert!(shown.contains("more than the time in 001.csv") && shown.contains("force [N]"), "{shown}");
}

/// A part of the motion that repeats fits as well a period later: the lines to write are in the message, and they are enough.
#[test]
fn a_motion_that_repeats_asks_for_the_lag_and_takes_it() {
    let folder = simulated(EXAMPLE, &SMALL);
    // Ten times the noise that both have from the twin's one sensor, which would tell the lag.
    split(folder.path(), 1e-2);
    let runs = folder.path().join("runs");
    for name in ["001.csv", "001_load.csv"] {
        let path = runs.join(name);
        let text = std::fs::read_to_string(&path).unwrap();
        let late =
            |line: &&str| line.split(',').next().is_some_and(|t| t.parse().is_ok_and(|t: f64| t > 12.0 && t < 36.0));
        let kept: Vec<&str> = text.lines().take(1).chain(text.lines().skip(1).filter(late)).collect();
        std::fs::write(&path, kept.join("\n") + "\n").unwrap();
    }
    let text = refused(folder.path(), &["identify", "campaign.toml"]);
    assert!(text.contains("001.toml:") && text.contains("fit about as well"), "{text}");
    assert!(text.contains("State where the lag lies"), "{text}");
    replace_in(&runs.join("001.toml"), "same = [", "lag = { value = \"0.4 s\", standard = \"0.3 s\" }\nsame = [");
    // What is left is too short for the fit, and joined.
    let text = refused(folder.path(), &["identify", "campaign.toml"]);
    assert!(text.contains("whole cycles of 6.00 s"), "{text}");
}
