//! A robot's joint and other axes: inertia, friction and gravity out of somebody's logs.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use crate::tank::froude;

fn fixture(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/cases").join(name)).unwrap()
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let output = froude(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A campaign over one log with these lines of `[source.servo]`.
fn campaign(table: &str, section: &str) -> String {
    format!(
        "schema = 1\nname = \"joint\"\n[[source]]\nname = \"joint\"\nkind = \"towing\"\ntable = \"{table}\"\nmethod = \"servo\"\n[source.servo]\n{section}"
    )
}

fn identified(log: &str, section: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("log.csv"), log).unwrap();
    std::fs::write(folder.path().join("joint.toml"), campaign("log.csv", section)).unwrap();
    json(folder.path(), &["identify", "joint.toml", "--json"])
}

fn holds(record: &Value, truths: &[(&str, f64)], widest: f64) {
    let coefficients = &record["estimates"][0]["coefficients"];
    for (name, truth) in truths {
        let c = &coefficients[*name];
        let [low, high] =
            [0, 1].map(|k| c["interval_95"][k].as_f64().unwrap_or_else(|| panic!("{name}: {coefficients}")));
        assert!(low <= *truth && *truth <= high, "{name}: [{low}, {high}] without {truth}");
        assert!(high - low < 2.0 * widest * truth, "{name}: [{low}, {high}]");
    }
}

const JOINT: [(&str, f64); 4] = [("J", 0.0049), ("m_g_l", 0.20), ("F_v", 0.010), ("F_c", 0.020)];
const SECTION: &str = "drive_gain = \"0.35 N m/A\"\nloads = [\"m_g_l*sin(angle)\"]\n";

#[test]
fn a_servo_that_drives_a_pendulum_shows_inertia_gravity_and_friction() {
    let record = identified(&fixture("joint.csv"), SECTION);
    holds(&record, &JOINT, 0.1);
    let law = &record["estimates"][0]["law"]["outputs"]["drive_torque"];
    assert_eq!(law["formula"], "J*angle_dot_dot + F_v*angle_dot + F_c*sign(angle_dot) + offset + m_g_l*sin(angle)");
    assert_eq!(
        (&law["unit"], &record["estimates"][0]["coefficients"]["F_v"]["unit"]),
        (&"N m".into(), &"N m s".into())
    );
}

/// Two logs whose command acts at once, one with stamps in milliseconds, one with lost samples: the delay is found, and with it mass and friction.
#[test]
fn rounded_stamps_and_lost_samples_leave_mass_and_friction() {
    for log in ["axis-60hz-ms.csv", "axis-200hz-3-percent-lost.csv"] {
        let record = identified(&fixture(log), "drive_gain = \"35 N/V\"\n");
        holds(&record, &[("M", 12.0), ("F_v", 30.0), ("F_c", 4.0)], 0.15);
        // Positions of the twin are those after a step of 0.8 and 0.25 ms, so that its force is as much early. The second log is too noisy to tell.
        let findings = record["findings"].to_string();
        if log.contains("60hz") {
            let late_s = record["estimates"][0]["derived"]["delay"]["value"].as_f64().unwrap();
            assert!((late_s + 0.0008).abs() < 0.0003, "{late_s}");
            assert!(findings.contains("the force precedes its command by"), "{findings}");
        } else {
            assert!(findings.contains("no row is made where it is missing"), "{findings}");
        }
    }
}

/// A vehicle whose thrust and speed are logged, the speed 0.29 s late (15 steps of 20 ms, less the half step of the rule that made it): mass, drag and the lag.
#[test]
fn a_vehicle_whose_speed_lags_shows_mass_drag_and_the_lag() {
    let record = identified(&fixture("surge.csv"), "friction = \"viscous\"\nloads = [\"D_II*speed*abs(speed)\"]\n");
    holds(&record, &[("M", 95.0), ("F_v", 31.0), ("D_II", 200.0)], 0.15);
    let estimate = &record["estimates"][0];
    let [low, high] = [0, 1].map(|k| estimate["derived"]["delay"]["interval_95"][k].as_f64().unwrap());
    assert!(low <= 0.29 && 0.29 <= high && high - low < 0.06, "[{low}, {high}]");
    assert!(record["findings"].to_string().contains("the motion lags the command by 0.2"), "{}", record["findings"]);
    let law = &estimate["law"]["outputs"]["drive_force"]["formula"];
    assert_eq!(law, "M*v_y_dot + F_v*v_y + offset + D_II*v_y*abs(v_y)");
    // The record predicts: M is the mass, not the moment of that letter.
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("record.json"), record.to_string()).unwrap();
    std::fs::write(folder.path().join("t.csv"), "v_y [m/s],v_y_dot [m/s^2]\n0.3,0.1\n").unwrap();
    let predicted = json(folder.path(), &["predict", "record.json", "t.csv", "--json"]);
    let force = 95.0 * 0.1 + 31.0 * 0.3 + 200.0 * 0.09;
    let found = predicted["estimates"][0]["rows"][0]["predicted"].as_f64().unwrap();
    assert!((found / force - 1.0).abs() < 0.01, "{force}: {predicted}");
}

/// The same joint, its angle in other units or at the motor, its drive in other units: the same coefficients.
#[test]
fn units_counts_and_gear_change_no_coefficient() {
    let log = fixture("joint.csv");
    let own = identified(&log, SECTION);
    let turned = |head: &str, angle: f64, current: f64| {
        let mut out = format!("{head}\n");
        for line in log.lines().skip(1) {
            let [t, x, i] = [0, 1, 2].map(|k| line.split(',').nth(k).unwrap().parse::<f64>().unwrap());
            writeln!(out, "{t},{},{}", x * angle, i * current).unwrap();
        }
        out
    };
    let gravity = "loads = [\"m_g_l*sin(angle)\"]\n";
    for (log, section) in [
        (turned("time [s],angle [deg],current [mA]", 1.0_f64.to_degrees(), 1e3), SECTION.to_owned()),
        (
            turned("time [s],position [turns],torque [N m]", 1.0 / std::f64::consts::TAU, 0.35),
            gravity.replace("angle", "position"),
        ),
        (
            turned("time [s],enc [counts],i [A]", 4096.0, 1.0),
            format!("{SECTION}position = \"enc\"\ncommand = \"i\"\ncount = \"{:e} rad\"\n", 1.0 / 4096.0),
        ),
        (
            turned("time [s],angle [rad],voltage [V]", 50.0, 10.0),
            format!("drive_gain = \"0.0007 N m/V\"\ngear = 50\nencoder = \"motor\"\n{gravity}"),
        ),
    ] {
        let other = identified(&log, &section);
        for (name, _) in JOINT {
            let [a, b] = [&own, &other].map(|r| r["estimates"][0]["coefficients"][name]["value"].as_f64().unwrap());
            assert!((a / b - 1.0).abs() < 1e-6, "{name}: {a} {b} of {section}");
        }
    }
    // A motor behind a spindle of r = 2 mm/rad moves a mass of J/r² against F_v/r² and loads of F_c/r and m g l/r.
    let axis = identified(
        &turned("time [s],position [m],current [A]", 0.002, 1.0),
        "drive_gain = \"0.35 N m/A\"\ngear = \"500 rad/m\"\nencoder = \"axis\"\nloads = [\"m_g_l*sin(k*position)\"]\n[constants]\nk = \"500 m^-1\"\n",
    );
    for (name, of_joint, factor) in
        [("M", "J", 2.5e5), ("F_v", "F_v", 2.5e5), ("F_c", "F_c", 500.0), ("m_g_l", "m_g_l", 500.0)]
    {
        let value =
            |record: &Value, name: &str| record["estimates"][0]["coefficients"][name]["value"].as_f64().unwrap();
        let (a, b) = (value(&axis, name), factor * value(&own, of_joint));
        assert!((a / b - 1.0).abs() < 1e-6, "{name}: {a} {b}");
    }
    assert_eq!(axis["estimates"][0]["coefficients"]["M"]["unit"], "kg");
    // The record has the gain with the gear in it, and says so.
    let gain = &axis["estimates"][0]["law"]["constants"]["drive_gain_at_axis"];
    assert!((gain["value"].as_f64().unwrap() - 175.0).abs() < 1e-9, "{axis}");
}

#[test]
fn what_is_not_declared_or_does_not_fit_is_refused_with_the_line_to_write() {
    let log = &joint_log(1).lines().take(400).collect::<Vec<_>>().join("\n");
    for (log, section, told) in [
        (log, "", "write drive_gain = \"0.35 N m/A\""),
        (log, "drive_gain = \"35 N/V\"\n", "expected a moment or energy"),
        (log, "drive_gain = \"0.35 N m/A\"\ngear = 50\n", "write encoder = \"motor\" or encoder = \"axis\""),
        (
            log,
            "drive_gain = \"0.35 N m/A\"\nfriction = \"load_dependent\"\n",
            "in proportion to a load, and none is declared",
        ),
        (
            log,
            "drive_gain = \"0.35 N m/A\"\nloads = [\"k*sin(angel)\"]\n",
            "cannot be read: the formula is not linear in its coefficients",
        ),
        (
            log,
            "drive_gain = \"0.35 N m/A\"\nloads = [\"F_c*sin(angle)\"]\n",
            "names the coefficient F_c; names that begin with F_ are reserved for friction: rename it",
        ),
        (
            log,
            "drive_gain = \"0.35 N m/A\"\nloads = [\"angle_dot_dot*sin(angle)\"]\n",
            "names the coefficient angle_dot_dot, which is there already",
        ),
        (
            &log.replace("angle [rad]", "angular_speed [rad/s]"),
            &format!("{SECTION}friction = \"viscous\"\n"),
            "the logs have a speed but no position, which this load needs",
        ),
        (
            &log.replace("angle [rad]", "angular_speed [rad/s]"),
            "drive_gain = \"0.35 N m/A\"\n",
            "dry friction cannot be identified from a speed alone",
        ),
        (
            &log.replace("angle [rad]", "angular_speed [rad/s]"),
            "drive_gain = \"0.35 N m/A\"\nfriction = \"viscous\"\nloads = [\"c*sign(speed)\"]\n",
            "a jump is dry friction, which a speed alone does not tell",
        ),
        (
            log,
            "drive_gain = \"0.35 N m/A\"\nfriction = \"load_dependent\"\nloads = [\"d*speed*abs(speed)\"]\n",
            "is that of a bearing under its load, not under drag",
        ),
        (
            log,
            "drive_gain = \"0.35 N m/A\"\nposition = \"angle\"\nspeed = \"angle\"\n",
            "is for a log without a position; delete speed or position",
        ),
        (log, "drive_gain = \"0.35 N m/A\"\nload = \"k*angle\"\n", "did you mean `loads`"),
        (log, "drive_gain = \"0.35 N m/A\"\ncount = \"1 deg\"\n", "is of a position in counts, and angle"),
        (log, "drive_gain = \"0.35 N m/A\"\nposition = \"theta\"\n", "names \"theta\", which"),
        (
            &log.replace("angle [rad]", "position [counts]"),
            "drive_gain = \"0.35 N m/A\"\n",
            "write count = \"0.1 mm\" or count = \"0.088 deg\"",
        ),
        (
            &log.replace('\n', ",0\n")
                .replace("current [A],0", "current [A],voltage [V]")
                .trim_end_matches(|c| c != '\n')
                .to_owned(),
            "drive_gain = \"0.35 N m/A\"\n",
            "write command = \"current\" or command = \"voltage\"",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("log.csv"), log).unwrap();
        std::fs::write(folder.path().join("joint.toml"), campaign("log.csv", section)).unwrap();
        let output = froude(folder.path(), &["identify", "joint.toml"]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains(told), "{section}: {said}");
        assert!(!folder.path().join("joint-results").exists());
    }
}

/// What a sidecar declares of position or command and no fit applies is refused.
#[test]
fn a_delay_of_the_position_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("log.csv"), joint_log(1)).unwrap();
    let sidecar = "schema = 1\n[columns]\n\"time [s]\" = { name = \"time\" }\n\"angle [rad]\" = { name = \"angle\", delay = \"1 ms\" }\n\
                   \"current [A]\" = { name = \"current\" }\n";
    std::fs::write(folder.path().join("log.toml"), sidecar).unwrap();
    std::fs::write(folder.path().join("joint.toml"), campaign("log.csv", SECTION)).unwrap();
    let output = froude(folder.path(), &["identify", "joint.toml"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2), "{said}");
    assert!(said.contains("`range, resolution, filter or delay` is of the log of a run"), "{said}");
}

/// Numbers that look like noise, between −1 and 1.
fn noise(seed: u32) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state) / f64::from(u32::MAX) * 2.0 - 1.0
    }
}

/// A joint in a simulation of its own (Euler at 4 kHz): friction differs by up to 10 % from log to log.
fn joint_log(seed: u32) -> String {
    let mut noise = noise(seed);
    let phase: Vec<f64> = (0..6).map(|_| std::f64::consts::PI * noise()).collect();
    let (f_v, f_c) = (0.010 * (1.0 + 0.1 * noise()), 0.020 * (1.0 + 0.1 * noise()));
    let parts = [(0.22, 1.1), (0.18, 2.3), (0.15, 3.7), (0.12, 5.9), (0.1, 8.3), (0.08, 12.1)];
    let (mut x, mut v) = (0.0_f64, 0.0_f64);
    let mut out = "time [s],angle [rad],current [A]\n".to_owned();
    for i in 0..48_000_u32 {
        let t = f64::from(i) / 4000.0;
        let current: f64 = parts.iter().zip(&phase).map(|((a, w), p)| a * f64::sin(w * t + p)).sum();
        if i % 20 == 0 {
            writeln!(out, "{t:.3},{:.6},{current:.5}", x + 2e-5 * noise()).unwrap();
        }
        v += (0.35 * current - f_v * v - f_c * (v / 1e-3).tanh() - 0.20 * x.sin()) / 0.0049 / 4000.0;
        x += v / 4000.0;
    }
    out
}

/// From nothing: start, look, identify, compare with nothing else to write.
#[test]
fn logs_of_a_robots_joint_become_friction_in_three_commands() {
    let folder = tempfile::tempdir().unwrap();
    assert!(froude(folder.path(), &["new", "servo", "--out", "lab"]).status.success());
    let lab = folder.path().join("lab");
    std::fs::create_dir(lab.join("logs")).unwrap();
    for k in 1..=6_u32 {
        std::fs::write(lab.join(format!("logs/log_{k}.csv")), joint_log(k)).unwrap();
    }
    let seen = json(&lab, &["inspect", "logs/log_1.csv", "--json"]);
    assert!(seen.to_string().contains("current"), "{seen}");
    let record = json(&lab, &["identify", "campaign.toml", "--json"]);
    holds(&record, &JOINT, 0.5);
    assert_eq!(record["estimates"][0]["clusters"]["n"], 6);
    let page = std::fs::read_to_string(lab.join("campaign-results/report.html")).unwrap();
    assert!(page.contains("Drive torque and model") && page.contains("torque [N m]"));

    // A log that is there twice would count twice.
    std::fs::copy(lab.join("logs/log_1.csv"), lab.join("logs/log_7.csv")).unwrap();
    let output = froude(&lab, &["identify", "campaign.toml"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && said.contains("holds the same samples as"), "{said}");
}
