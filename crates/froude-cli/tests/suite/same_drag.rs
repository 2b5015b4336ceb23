//! The drag of six campaigns on the twin, as the program gave it before all methods went one way.
//!
//! Whatever is rebuilt between a run and its record, these numbers stay: values within 1e-12, ends of intervals within 1e-9, both relative. Those of
//! the flexible axis stay within a thousand times that, 1e-7 of their standard uncertainty: its two masses are fitted by iteration, and the one matrix
//! exponential that took the place of two differs from the one that they stepped with by rounding.
//! `FROUDE_WRITE_FIXTURES=1` writes them anew.

use crate::bench;
use std::path::{Path, PathBuf};

use crate::bench::{campaign, json, text};
use serde_json::{Map, Value};

const CALIBRATION: &str = "[carriage.calibration]            # weights over a pulley, lifted and lowered\n";
const ONE_FRICTION_SPEED: &str = r#"speeds = ["0.4 m/s"]"#;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/drag").join(format!("{name}.json"))
}

/// What stays: every number of every estimate, what is recommended and which findings there are. The old program wrote D_x_II of `quadratic` as D_d
/// of a law of its own, and C_D beside it with an uncertainty of its own.
fn kept(record: &Value) -> Value {
    let estimates = record["estimates"].as_array().unwrap().iter().map(|estimate| {
        let mut d = estimate["coefficients"]["D_x_II"].clone();
        assert_eq!(
            (&estimate["law"]["name"], &d["label"], &d["unit"]),
            (&"quadratic".into(), &"D_d".into(), &"kg/m".into())
        );
        d.as_object_mut().unwrap().remove("label");
        d["unit"] = "N s^2/m^2".into();
        let (mut c, derived) = (d.clone(), &estimate["derived"]["C_D"]);
        let scale = derived["value"].as_f64().unwrap() / d["value"].as_f64().unwrap();
        for key in ["type_a", "type_b"] {
            c[key] = d[key].as_f64().map_or(Value::Null, |u| (u * scale).into());
        }
        for key in ["value", "unit", "standard_uncertainty", "interval_95"] {
            c[key] = derived[key].clone();
        }
        let old = serde_json::json!({
            "coefficients": { "D_d": d, "C_D": c },
            "recommended": estimate["recommended"],
            "n_observations": estimate["n"],
            "validity": { "speed": estimate["validity"]["speed"] },
        });
        (format!("drag_{}", estimate["method"]["name"].as_str().unwrap()), old)
    });
    let mut codes: Vec<&str> =
        record["findings"].as_array().unwrap().iter().map(|f| f["code"].as_str().unwrap()).collect();
    codes.sort_unstable();
    serde_json::json!({ "estimates": estimates.collect::<Map<_, _>>(), "findings": codes })
}

/// Compares two trees leaf by leaf; numbers within a part of themselves, which is wider where an interval or an uncertainty is meant.
fn compare(place: &str, before: &Value, now: &Value) {
    match (before, now) {
        (Value::Object(a), Value::Object(b)) => {
            assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>(), "{place}");
            a.iter().for_each(|(key, value)| compare(&format!("{place}/{key}"), value, &b[key]));
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{place}: {before} is {now}");
            a.iter().zip(b).enumerate().for_each(|(i, (a, b))| compare(&format!("{place}/{i}"), a, b));
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            let part = if place.ends_with("/value") { 1e-12 } else { 1e-9 };
            let part = if place.contains("/drag_mbdp_flexible/") { 1e3 * part } else { part };
            assert!((a - b).abs() <= part * a.abs(), "{place}: {a} is {b}");
        }
        _ => assert_eq!(before, now, "{place}"),
    }
}

/// What an estimate's observations came from, whatever its record calls the files.
fn fingerprints<'a>(record: &'a Value, estimate: &Value) -> Vec<&'a Value> {
    let keys = estimate["data"].as_array().unwrap().iter();
    keys.map(|key| &record["data"][key.as_str().unwrap()]["sha256"]).collect()
}

/// The same runs as a source of a campaign, by the same methods in another order: the same estimates, bit for bit.
fn as_a_source(folder: &Path, drag: &Value) {
    let estimates = drag["estimates"].as_array().unwrap();
    let method = |estimate: &Value| estimate["method"]["name"].as_str().unwrap().to_owned();
    let methods: Vec<String> = estimates.iter().rev().map(method).collect();
    let campaign = format!(
        "schema = 1\nname = \"x\"\n[[source]]\nname = \"carriage\"\nkind = \"towing\"\nruns = \"campaign-runs\"\nmethod = {methods:?}\n"
    );
    std::fs::write(folder.join("source.toml"), campaign).unwrap();
    let sourced = json(&["identify", text(&folder.join("source.toml")), "--json"]);
    let of_source = sourced["estimates"].as_array().unwrap();
    assert_eq!(of_source.len(), estimates.len());
    for (estimate, same) in estimates.iter().rev().zip(of_source) {
        assert_eq!(same["id"], format!("carriage/{}", method(estimate)));
        for (key, value) in estimate.as_object().unwrap() {
            let is_named_otherwise = ["id", "source", "data"].contains(&key.as_str());
            assert!(is_named_otherwise || &same[key] == value, "{key}: {value} is {}", same[key]);
        }
        assert_eq!(fingerprints(drag, estimate), fingerprints(&sourced, same));
    }
    assert_eq!(
        sourced["findings"].as_array().unwrap().iter().map(|f| &f["code"]).collect::<Vec<_>>(),
        drag["findings"].as_array().unwrap().iter().map(|f| &f["code"]).collect::<Vec<_>>()
    );
}

/// Drives a changed example, reduces it and compares the numbers with those of the old program.
fn stays(name: &str, changes: &[(&str, &str)]) {
    let folder = tempfile::tempdir().unwrap();
    let campaign = campaign(folder.path(), changes);
    json(&["run", text(&campaign), "--yes", "--json"]);
    let runs = folder.path().join("campaign-runs");
    let drag = json(&["carriage", "drag", text(&runs), "--json"]);
    as_a_source(folder.path(), &drag);
    let now = kept(&drag);
    let path = fixture(name);
    if std::env::var_os("FROUDE_WRITE_FIXTURES").is_some() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, serde_json::to_string_pretty(&now).unwrap() + "\n").unwrap();
    }
    let before: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    compare(name, &before, &now);
}

/// No look ends the campaign.
const TO_ITS_END: (&str, &str) = (r#"stop_when = "2.5 %""#, "");

#[test]
fn the_example() {
    stays("example", &[TO_ITS_END]);
}

#[test]
fn without_calibration() {
    let example = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/towing-carriage/campaign.toml"),
    )
    .unwrap();
    let from = example.find(CALIBRATION).unwrap();
    let to = example.find("[carriage.excitation]").unwrap();
    stays("uncalibrated", &[(&example[from..to], ""), ("repeats = 5  ", "repeats = 2  ")]);
}

#[test]
fn without_ballast() {
    stays("unballasted", &[("ballasted = true ", "ballasted = false "), ("repeats = 5  ", "repeats = 2  ")]);
}

#[test]
fn one_pair() {
    stays("one-pair", &[("repeats = 5  ", "repeats = 1  ")]);
}

#[test]
fn four_pairs() {
    stays(
        "four-pairs",
        &[("repeats = 5  ", "repeats = 4  "), (bench::SIX_FRICTION_SPEEDS, ONE_FRICTION_SPEED), TO_ITS_END],
    );
}

#[test]
fn stopped_early() {
    stays("stopped-early", &[(r#"stop_when = "2.5 %""#, r#"stop_when = "4 %""#)]);
}
