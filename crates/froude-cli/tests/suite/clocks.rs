//! Times and delays of logs at the verb, in every method of the tank: stamps of a calendar, channels that are stamped late.

use crate::tank;
use std::path::Path;

use crate::tank::{froude, json, replace_in, simulated};
use serde_json::Value;

/// Seconds of 2025, as other programs stamp their rows.
const CALENDAR_S: f64 = 1_764_230_400.0;

fn files(folder: &Path, extension: &str) -> Vec<std::path::PathBuf> {
    let all = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    all.filter(|path| path.extension().is_some_and(|e| e == extension)).collect()
}

/// The largest change of a coefficient, in standard uncertainties.
fn moved(before: &Value, after: &Value) -> f64 {
    let all = before["estimates"].as_array().unwrap().iter().zip(after["estimates"].as_array().unwrap());
    let mut most = 0.0_f64;
    for (a, b) in all {
        for (name, c) in a["coefficients"].as_object().unwrap() {
            let Some(standard) = c["standard_uncertainty"].as_f64() else { continue };
            let change = c["value"].as_f64().unwrap() - b["coefficients"][name]["value"].as_f64().unwrap();
            most = most.max((change / standard).abs());
        }
    }
    most
}

fn message(record: &Value, code: &str) -> Option<String> {
    let all = record["findings"].as_array().unwrap();
    all.iter().find(|f| f["code"] == code).map(|f| f["message"].as_str().unwrap().to_owned())
}

/// Stamps of a calendar change nothing. Free decay took 0.970 kg m² for 0.385 before, without a word.
#[test]
fn stamps_of_a_calendar_are_times_from_the_start() {
    for (name, runs) in [
        ("mamba-oscillation", "runs"),
        ("mamba-rotation", "runs"),
        ("mamba-steady", "runs"),
        ("mamba-weights", "runs"),
        ("mamba-accelerated", "runs"),
        ("mamba-decay", "releases"),
    ] {
        let folder = simulated(name, &[]);
        let before = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
        let logs = files(&folder.path().join(runs), "csv");
        for path in &logs {
            let text = std::fs::read_to_string(path).unwrap();
            let (head, rows) = text.split_once('\n').unwrap();
            let late = |row: &str| {
                let (time, rest) = row.split_once(',').unwrap();
                format!("{:.6},{rest}\n", time.parse::<f64>().unwrap() + CALENDAR_S)
            };
            std::fs::write(path, format!("{head}\n{}", rows.lines().map(late).collect::<String>())).unwrap();
        }
        let after = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
        // A double holds such a time to 0.2 µs.
        assert!(moved(&before, &after) < 0.01, "{name}: {}", moved(&before, &after));
        let said = message(&after, "times-from-start").unwrap();
        assert!(said.contains(&format!("the times of {} logs", logs.len())), "{said}");
    }
}

/// A force that its sidecars declare to be stamped 10 ms late is that of a delay 10 ms longer. It was "clipped", since splines leave no steps.
#[test]
fn a_declared_delay_moves_the_delay_that_is_found() {
    for (name, channel) in [("mamba-oscillation", "force"), ("mamba-rotation", "torque")] {
        let folder = simulated(name, &[]);
        let campaign = folder.path().join("campaign.toml");
        let identify = || json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
        let delay = |record: &Value| {
            let all = record["estimates"].as_array().unwrap();
            let best = all.iter().find(|e| e["recommended"] == true || all.len() == 1).unwrap().clone();
            (best["coefficients"]["delay"]["value"].as_f64().unwrap(), best)
        };
        // `delay` may be left out: it is found.
        let text = std::fs::read_to_string(&campaign).unwrap();
        let line = text.lines().find(|line| line.starts_with("delay ")).unwrap();
        replace_in(&campaign, line, "");
        let (found_s, _) = delay(&identify());
        for path in files(&folder.path().join("runs"), "toml") {
            let text = std::fs::read_to_string(&path).unwrap();
            let line = text.lines().find(|line| line.contains(&format!("name = \"{channel}\""))).unwrap();
            let late = line.replacen("clock = \"log\"", "clock = \"log\", delay = \"10 ms\"", 1);
            assert_ne!(line, late);
            std::fs::write(&path, text.replace(line, &late)).unwrap();
        }
        let after = identify();
        let (left_s, best) = delay(&after);
        let standard_s = best["coefficients"]["delay"]["standard_uncertainty"].as_f64().unwrap();
        assert!((found_s - left_s - 0.01).abs() < 0.1 * standard_s, "{name}: {found_s} {left_s} ± {standard_s}");
        assert_eq!(message(&after, "channel-clipped"), None, "{after}");
    }
}

/// A rig that is parked at an angle before the declared test, a sensor that is stamped late, times of a calendar: none of it makes a run clipped, and the numbers stay.
#[test]
fn a_parked_rig_before_the_test_is_at_no_sensors_end() {
    let folder = simulated("mamba-oscillation", &[]);
    let runs = folder.path().join("runs");
    let before = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    for path in files(&runs, "csv") {
        let text = std::fs::read_to_string(&path).unwrap();
        let (head, rows) = text.split_once('\n').unwrap();
        let parked = (0..3_000).map(|i| format!("{:.6},0.785398,0.000000\n", CALENDAR_S + 0.01 * f64::from(i)));
        let moved = rows.lines().map(|row| {
            let (time, rest) = row.split_once(',').unwrap();
            format!("{:.6},{rest}\n", time.parse::<f64>().unwrap() + CALENDAR_S + 30.0)
        });
        std::fs::write(&path, format!("{head}\n{}", parked.chain(moved).collect::<String>())).unwrap();
        let sidecar = path.with_extension("toml");
        let text = std::fs::read_to_string(&sidecar).unwrap();
        let line = text.lines().find(|line| line.contains("name = \"angle\"")).unwrap();
        let late = line.replacen("clock = \"log\"", "clock = \"log\", delay = \"10 ms\"", 1);
        let last = rows.lines().last().unwrap().split_once(',').unwrap().0.parse::<f64>().unwrap() + 30.0;
        let test = format!(
            "\n[[segments]]\nname = \"test\"\nfrom = \"{} s\"\nto = \"{} s\"\nby = \"A. Tester\"\n",
            CALENDAR_S + 30.0,
            CALENDAR_S + last
        );
        std::fs::write(&sidecar, text.replace(line, &late) + &test).unwrap();
    }
    let after = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let c_a = |record: &Value| {
        let all = record["estimates"].as_array().unwrap();
        let f4 = all.iter().find(|e| e["recommended"] == true).unwrap();
        ["value", "standard_uncertainty"].map(|key| f4["coefficients"]["C_A"][key].as_f64().unwrap())
    };
    let ([a, u], [b, _]) = (c_a(&before), c_a(&after));
    // The delay's prior is that of a force which is late by 10 ms less.
    assert!((a - b).abs() < u, "{a} ± {u}, {b}");
}

/// f1 without a declared delay does not converge on these runs: f4 is reported all the same, and the word says which was left out.
#[test]
fn a_law_that_does_not_converge_costs_itself_alone() {
    let folder = simulated("mamba-oscillation", &[("delay    = { value = \"0 ms\", standard = \"5 ms\" }", "")]);
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let names: Vec<&str> =
        record["estimates"].as_array().unwrap().iter().map(|e| e["law"]["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["added_mass_f4"]);
    let said = message(&record, "not-fitted").unwrap();
    assert!(said.contains("f1 could not be fitted and is left out: the delay of the load does not converge"), "{said}");
    // Alone it is an error.
    replace_in(&folder.path().join("campaign.toml"), "models = [\"f1\", \"f4\"]", "models = [\"f1\"]");
    let output = froude(folder.path(), &["identify", "campaign.toml"]);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(tank::said(&output).contains("declare the delay"), "{}", tank::said(&output));
}

/// What a twin does not simulate, and an error that this method cannot count, are refused with file, line and column.
#[test]
fn what_a_method_does_not_use_is_refused() {
    for (name, quantity) in [
        ("mamba-oscillation", "force"),
        ("mamba-rotation", "torque"),
        ("mamba-steady", "f_x"),
        ("mamba-weights", "f_x"),
        ("mamba-accelerated", "force"),
        ("mamba-decay", "angle"),
    ] {
        let folder = tank::example(name, &[]);
        let campaign = folder.path().join("campaign.toml");
        let text = std::fs::read_to_string(&campaign).unwrap();
        let sensor = |quantity: &str, key: &str| {
            let text = text.split("[[simulate.sensor]]").next().unwrap();
            std::fs::write(&campaign, format!("{text}\n[[simulate.sensor]]\nquantity = \"{quantity}\"\n{key}\n"))
                .unwrap();
            ["plan", "simulate"].map(|verb| tank::refused(folder.path(), &[verb, "campaign.toml"]))
        };
        let unit = match quantity {
            "torque" => "N m",
            "angle" => "rad",
            _ => "N",
        };
        for text in sensor(quantity, &format!("drift = \"0.1 {unit}\"")) {
            assert!(text.contains("campaign.toml:") && text.contains("drift is not simulated here"), "{name}: {text}");
        }
        for text in sensor("angel", "noise = \"0.1 rad\"") {
            assert!(text.contains("\"angel\" is not simulated by this twin: it has "), "{name}: {text}");
        }
    }
    for (name, quantity, section) in [
        ("mamba-oscillation", "force", "[source.forced_oscillation]"),
        ("mamba-rotation", "torque", "[source.rotation]"),
        ("mamba-accelerated", "force", "[source.accelerated_tow]"),
    ] {
        let entry = format!(
            "[[source.uncertainty]]\nquantity = \"{quantity}\"\nstandard = \"1 %\"\nshared = \"run\"\n\n{section}"
        );
        let folder = tank::example(name, &[(section, &entry)]);
        let text = tank::refused(folder.path(), &["plan", "campaign.toml"]);
        assert!(
            text.contains("campaign.toml:")
                && text.contains("shared = \"run\"")
                && text.contains("write shared = \"campaign\""),
            "{name}: {text}"
        );
    }
}
