//! Steady tows at the verbs: plan, simulate and identify of the example campaign; tares, still runs, streams; and what is refused.

use crate::tank::{froude, is_as_planned, json, refused, replace_in, said};
use std::fmt::Write as _;
use std::path::Path;

/// The arguments of what is refused.
const IDENTIFY: &[&str] = &["identify", "campaign.toml"];

fn example() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    std::fs::copy(root.join("examples/mamba-steady/campaign.toml"), folder.path().join("campaign.toml")).unwrap();
    folder
}

/// The example is planned, simulated and identified; the truth lies in every interval, and these are as wide as was planned.
#[test]
fn a_campaign_is_planned_simulated_and_identified() {
    let folder = example();
    let plan = json(&froude(folder.path(), &["plan", "campaign.toml", "--json"]));
    // 2 configurations, 4 speeds, 7 angles; 22 s each and two ramps of U/0.3 s.
    assert_eq!(plan["sources"][0]["runs"].as_u64(), Some(56));
    let duration = plan["sources"][0]["duration_s"].as_f64().unwrap();
    assert!((duration - 56.0 * (22.0 + 2.0 * 0.25 / 0.3)).abs() < 1e-6, "{duration}");
    let output = froude(folder.path(), &["simulate", "campaign.toml"]);
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "towing tank: 56 runs in runs");
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let estimates = record["estimates"].as_array().unwrap();
    let f4 = estimates.iter().find(|e| e["law"]["name"] == "f4").unwrap();
    assert_eq!((f4["method"]["name"].as_str(), f4["recommended"].as_bool()), (Some("steady"), Some(true)));
    // χ with 46 degrees of freedom has a standard deviation of a tenth.
    is_as_planned(&plan, f4, 0.7..1.3);
    let report = std::fs::read_to_string(folder.path().join("campaign-results/report.html")).unwrap();
    assert!(report.contains("Runs and windows") && report.contains("longest stretch whose blocks"));
    assert!(report.contains("Spectrum of the residuals of f_x") && report.contains("Spectrum of the residuals of f_y"));
}

/// Drag 50 U² and a rig of 10 U², U of 0.2, 0.3 and 0.4 m/s, a cell that reads 0.3 N of nothing.
struct Log {
    id: String,
    role: &'static str,
    speed: f64,
    drag: f64,
    /// Zero of the cell, N.
    zero: f64,
    /// Time at rest at either end, s.
    still: f64,
    conditions: String,
    columns: &'static str,
}

const COLUMNS: &str = "t = { name = \"time\", unit = \"s\" }\nu = { name = \"speed\", unit = \"m/s\", sign = 1, frame = \"body\", clock = \"log\" }\n\
                       fx = { name = \"f_x\", unit = \"N\", sign = 1, frame = \"body\", clock = \"log\" }\n";

impl Log {
    fn new(id: &str, role: &'static str, speed: f64, drag: f64) -> Self {
        let conditions = "angle = \"0 deg\"".to_owned();
        Self { id: id.to_owned(), role, speed, drag, zero: 0.3, still: 4.0, conditions, columns: COLUMNS }
    }

    fn write(&self, folder: &Path) {
        let mut text = String::from("t,u,fx\n");
        let (up, down) = (self.still, self.still + 10.0);
        for i in 0..=((down + self.still) * 50.0) as u32 {
            let t = 0.02 * f64::from(i);
            let u = if (up..down).contains(&t) { self.speed } else { 0.0 };
            // Noise of 2 mN that repeats nowhere.
            let noise = 2e-3 * (997.0 * t * t).sin();
            let _ = writeln!(text, "{t:.4},{u},{:.7}", self.zero - self.drag * u * u + noise);
        }
        std::fs::write(folder.join(format!("{}.csv", self.id)), text).unwrap();
        let sidecar = format!(
            "schema = 1\nmethod = \"steady\"\nrole = \"{}\"\n[conditions]\n{}\n[columns]\n{}",
            self.role, self.conditions, self.columns
        );
        std::fs::write(folder.join(format!("{}.toml", self.id)), sidecar).unwrap();
    }
}

const CAMPAIGN: &str = "schema = 1\nname = \"ball\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"tank\"\nkind = \"towing\"\nruns = \"runs\"\n\
                        method = \"steady\"\nmodels = [\"quadratic\"]\n[source.steady]\ndrift = { rate = \"1 mN/min\", most = \"5 mN\" }\n";

fn tows(logs: &[Log]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("campaign.toml"), CAMPAIGN).unwrap();
    let runs = folder.path().join("runs");
    std::fs::create_dir(&runs).unwrap();
    for log in logs {
        log.write(&runs);
    }
    folder
}

fn three(drag: f64) -> Vec<Log> {
    [0.2, 0.3, 0.4].map(|u| Log::new(&format!("t{u}"), "test", u, drag)).into_iter().collect()
}

fn coefficient(folder: &Path) -> (f64, serde_json::Value) {
    let record = json(&froude(folder, &["identify", "campaign.toml", "--json"]));
    let estimate = record["estimates"][0].clone();
    let (_, only) = estimate["coefficients"].as_object().unwrap().iter().next().unwrap();
    (only["value"].as_f64().unwrap().abs(), record)
}

/// The rig's 10 U² is taken off the 60 U² of rig and body; its error is one that all observations of a speed share.
#[test]
fn the_tare_is_subtracted_at_the_same_speed() {
    let mut logs = three(60.0);
    logs.extend([0.2, 0.3, 0.4].map(|u| Log::new(&format!("r{u}"), "tare", u, 10.0)));
    let folder = tows(&logs);
    let (with, record) = coefficient(folder.path());
    let (without, _) = coefficient(tows(&three(60.0)).path());
    // 2 mN of noise on 8 N.
    assert!((with / without - 50.0 / 60.0).abs() < 1e-3, "{with} {without}");
    let errors = record["estimates"][0]["errors"].as_object().unwrap();
    assert_eq!(errors.keys().filter(|key| key.contains("tare")).count(), 3, "{errors:?}");
    std::fs::remove_file(folder.path().join("runs/r0.3.csv")).unwrap();
    std::fs::remove_file(folder.path().join("runs/r0.3.toml")).unwrap();
    let text = refused(folder.path(), IDENTIFY);
    assert!(text.contains("no run of the role \"tare\" is at its speed and angle (0.3000 m/s"), "{text}");
}

/// Logs that begin and end in the tow take their zero from still runs, as far as its drift allows.
#[test]
fn a_zero_is_drawn_between_still_runs() {
    let still = |id: &str, at: &str, zero: f64| Log {
        zero,
        conditions: format!("at = \"{at}\""),
        ..Log::new(id, "still", 0.0, 0.0)
    };
    let tow = |u: f64, at: &str, zero: f64| Log {
        still: 0.0,
        zero,
        conditions: format!("angle = \"0 deg\"\nat = \"{at}\""),
        ..Log::new(&format!("t{u}"), "test", u, 50.0)
    };
    // 0.30 N to 0.34 N over 200 s.
    let logs = || {
        vec![
            still("s1", "0 s", 0.30),
            tow(0.2, "50 s", 0.31),
            tow(0.3, "100 s", 0.32),
            tow(0.4, "150 s", 0.33),
            still("s2", "200 s", 0.34),
        ]
    };
    let (drifting, _) = coefficient(tows(&logs()).path());
    let (quiet, _) = coefficient(tows(&three(50.0)).path());
    assert!((drifting / quiet - 1.0).abs() < 1e-3, "{drifting} {quiet}");
    let mut late = logs();
    late[4].conditions = "at = \"3000 s\"".to_owned();
    late[3].conditions = "angle = \"0 deg\"\nat = \"1200 s\"".to_owned();
    let folder = tows(&late);
    let output = froude(folder.path(), &["identify", "campaign.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    // 1,200 s at 1 mN/min are 20 mN.
    assert!(text.contains("nearest still run is 1200 s away"), "{text}");
    let none: Vec<Log> = logs().into_iter().filter(|log| log.role == "test").collect();
    let text = refused(tows(&none).path(), IDENTIFY);
    assert!(text.contains("nothing tells the zero of the sensor") && text.contains("seconds at rest"), "{text}");
}

/// Held in a stream there is no motion to look at: the speed is declared.
#[test]
fn a_body_in_a_stream_has_its_speed_from_its_sidecar() {
    let columns = "t = { name = \"time\", unit = \"s\" }\nfx = { name = \"f_x\", unit = \"N\", sign = 1, frame = \"body\", clock = \"log\" }\n";
    let held = |u: f64| Log {
        still: 0.0,
        conditions: format!("angle = \"0 deg\"\nspeed = \"{u} m/s\"\nat = \"60 s\""),
        columns,
        ..Log::new(&format!("t{u}"), "test", u, 50.0)
    };
    let still = Log { conditions: "at = \"0 s\"".to_owned(), columns, ..Log::new("s", "still", 0.0, 0.0) };
    let (value, _) = coefficient(tows(&[held(0.2), held(0.3), held(0.4), still]).path());
    let (towed, _) = coefficient(tows(&three(50.0)).path());
    assert!((value / towed - 1.0).abs() < 1e-3, "{value} {towed}");
    let silent = Log { conditions: "angle = \"0 deg\"".to_owned(), ..held(0.2) };
    let text = refused(tows(&[silent]).path(), IDENTIFY);
    assert!(text.contains("no channel speed or position") && text.contains("[conditions] speed"), "{text}");
}

#[test]
fn what_a_run_lacks_is_said_with_its_place() {
    let folder = tows(&three(50.0));
    let sidecar = folder.path().join("runs/t0.2.toml");
    replace_in(&sidecar, "unit = \"N\", sign = 1, frame = \"body\"", "unit = \"N\", frame = \"body\"");
    let text = refused(folder.path(), IDENTIFY);
    assert!(text.contains("t0.2.toml:") && text.contains("f_x states no sign"), "{text}");
    replace_in(&sidecar, "unit = \"N\", frame = \"body\"", "unit = \"N\", sign = 1, frame = \"y\"");
    let text = refused(folder.path(), IDENTIFY);
    assert!(text.contains("f_x is along the axes of \"y\"") && text.contains("frame = \"body\""), "{text}");
    replace_in(&sidecar, "frame = \"y\"", "frame = \"body\"");
    replace_in(&folder.path().join("campaign.toml"), "[source.steady]", "[source.steady]\nshortest = \"20 s\"");
    let text = refused(folder.path(), IDENTIFY);
    assert!(text.contains("no steady window") && text.contains("tolerance, shortest and settle"), "{text}");
    replace_in(&folder.path().join("campaign.toml"), "shortest = \"20 s\"", "shortest = \"20 m\"");
    let text = refused(folder.path(), IDENTIFY);
    assert!(text.contains("campaign.toml:12:") && text.contains("a time"), "{text}");
}

/// A run that gives nothing is left out and said; the others are fitted.
#[test]
fn a_clipped_run_is_left_out() {
    let mut logs = three(50.0);
    logs.push(Log::new("t0.5", "test", 0.5, 50.0));
    let folder = tows(&logs);
    let path = folder.path().join("runs/t0.5.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    let clipped: Vec<String> = text
        .lines()
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            match cells[2].parse::<f64>() {
                Ok(force) => format!("{},{},{}", cells[0], cells[1], force.max(-10.0)),
                Err(_) => line.to_owned(),
            }
        })
        .collect();
    std::fs::write(&path, clipped.join("\n")).unwrap();
    let output = froude(folder.path(), &["identify", "campaign.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("tank (3 observations)") && text.contains("the sensor is clipped"), "{text}");
}

/// In a narrow tank each run that blocks more than 5 % is named with its angle: H1LT of 0.040168 m² across and 0.0072782 m² ahead passes it in 1 m by 0.6 m where
/// 0.040168 sin θ + 0.0072782 cos θ = 0.03, at 37.0 deg.
#[test]
fn runs_that_block_the_tank_are_said_one_by_one() {
    let folder = example();
    let campaign = folder.path().join("campaign.toml");
    replace_in(&campaign, "configurations = [\"H1LT\", \"H2LT\"]", "configurations = [\"H1LT\"]");
    replace_in(&campaign, "[[source]]", "[tank]\nwidth = \"1 m\"\ndepth = \"0.6 m\"\n\n[[source]]");
    replace_in(&campaign, "models = [\"f2\", \"f4\"]", "models = [\"f6\"]");
    let made = froude(folder.path(), &["simulate", "campaign.toml"]);
    assert_eq!(made.status.code(), Some(0), "{}", said(&made));
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let findings = record["findings"].as_array().unwrap();
    let of_runs: Vec<&str> =
        findings.iter().filter(|f| f["code"] == "blockage-of-run").map(|f| f["message"].as_str().unwrap()).collect();
    // Four angles beyond it at four speeds.
    assert_eq!(of_runs.len(), 16, "{of_runs:?}");
    assert!(
        of_runs[0].contains("H1LT at 45.0 deg blocks 5.6 % of the tank's 1 m by 0.6 m and ends 0.35 m from its walls; it passes 5 % beyond 37.0 deg"),
        "{}",
        of_runs[0]
    );
}

/// Columns of a cell that shows volts, at 4.77 N/V ± 1 %.
const VOLTS: &str = "t = { name = \"time\", unit = \"s\" }\nu = { name = \"speed\", unit = \"m/s\", sign = 1, frame = \"body\", clock = \"log\" }\n\
                     fx = { name = \"f_x\", unit = \"V\", scale = \"gain\", sign = 1, frame = \"body\", clock = \"log\" }\n\
                     [constants]\ngain = { value = \"4.77 N/V\", standard = \"1 %\" }\n";

/// Volts become newtons, and the standard uncertainty of what scales them is the type B of every coefficient.
#[test]
fn a_scale_applies_to_the_volts_of_a_log_and_its_error_is_in_the_budget() {
    let logs: Vec<Log> = three(60.0).into_iter().map(|log| Log { columns: VOLTS, ..log }).collect();
    let folder = tows(&logs);
    let (scaled, record) = coefficient(folder.path());
    let (newtons, _) = coefficient(tows(&three(60.0)).path());
    assert!((scaled / newtons / 4.77 - 1.0).abs() < 1e-9, "{scaled} {newtons}");
    let only = &record["estimates"][0]["coefficients"].as_object().unwrap().values().next().unwrap().clone();
    assert!((only["type_b"].as_f64().unwrap() / scaled - 0.01).abs() < 1e-6, "{only}");
    let errors = record["estimates"][0]["errors"].to_string();
    assert!(errors.contains("gain, which scales f_x"), "{errors}");
    // Numbers without a unit, and a scale that gives another one.
    let sidecar = folder.path().join("runs/t0.2.toml");
    replace_in(&sidecar, "unit = \"V\", scale", "scale");
    let text = refused(folder.path(), IDENTIFY);
    assert!(text.contains("column `f_x [N/V]`: wrong unit: expected a force (N), found a quantity in N/V"), "{text}");
    replace_in(&sidecar, "4.77 N/V", "4.77 N");
    assert!((coefficient(folder.path()).0 / scaled - 1.0).abs() < 1e-9);
    replace_in(&sidecar, "scale = \"gain\"", "scale = \"gain\", range = \"±5 N\"");
    let text = refused(folder.path(), IDENTIFY);
    assert!(text.contains("`range` is not used of a scaled column; leave it out"), "{text}");
}
