//! A robot swims at the verb: figures of an independent program, a trajectory that closes its energy, and what is refused.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bench;

use std::path::{Path, PathBuf};

use bench::{froude, text};
use froude::records::table::read_table;
use froude::records::units::Dimension;
use serde_json::Value;

const GAIT: [&str; 6] = ["--amplitude", "30 deg", "--frequency", "80 deg/s", "--phase", "40 deg"];

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/mamba-swim/robot.toml")
}

/// The example in a folder, beside the records that it names, with a change.
fn changed(folder: &Path, from: &str, to: &str) -> PathBuf {
    let published = example().parent().unwrap().join("../mamba/published");
    let robot = std::fs::read_to_string(example()).unwrap().replace("../mamba/published", text(&published));
    assert!(robot.contains(from), "the example has no {from}");
    let path = folder.join("robot.toml");
    std::fs::write(&path, robot.replacen(from, to, 1)).unwrap();
    path
}

fn swum(robot: &Path, more: &[&str]) -> Value {
    let output = froude(&[&["swim", text(robot)], &GAIT[..], more, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refused(robot: &Path, gait: &[&str]) -> String {
    let output = froude(&[&["swim", text(robot)], gait].concat());
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
    String::from_utf8(output.stderr).unwrap()
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} of {value}"))
}

/// f2 of the tank by strips: U 0.1899 m/s, 0.2237 W, 1.178 J/m, each within 0.3 %.
#[test]
fn the_example_swims_as_an_independent_program_has_it() {
    let found = swum(&example(), &[]);
    for (key, expected) in [("speed_m_s", 0.1899), ("power_net_w", 0.2237), ("cost_of_transport_j_m", 1.178)] {
        assert!((number(&found, key) / expected - 1.0).abs() < 0.003, "{key}: {found}");
    }
    // 80 deg/s in cycles; and the eel of the lumped law: .1380 m/s, .0844 W.
    let folder = tempfile::tempdir().unwrap();
    let lumped = changed(folder.path(), "= \"strip\"", "= \"lumped\"\ntorque = \"friction\"");
    let cycles = ["--amplitude", "30 deg", "--frequency", "0.222222222222 Hz", "--phase", "40 deg", "--gait", "eel"];
    let output = froude(&[&["swim", text(&lumped), "--json"], &cycles[..]].concat());
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!((number(&found, "speed_m_s") / 0.1380 - 1.0).abs() < 0.003, "{found}");
    assert!((number(&found, "power_net_w") / 0.0844 - 1.0).abs() < 0.003, "{found}");
}

/// Work, loss and kinetic energy close over the trajectory, in whose last moment a swimmer in a current has been carried.
#[test]
fn a_trajectory_closes_its_energy_and_a_current_carries_it() {
    let folder = tempfile::tempdir().unwrap();
    let still = swum(&example(), &["--out", text(folder.path())]);
    let table = read_table(&folder.path().join("trajectory.parquet"), None).unwrap();
    let last = |name: &str, dimension: Dimension| *table.number(name, dimension).unwrap().last().unwrap();
    let energy = Dimension::new(2, 1, -2);
    let (time, place) = (last("time", Dimension::TIME), last("x", Dimension::LENGTH));
    // Fourth order in 400 steps a period.
    let most = number(&still, "power_net_w") * time * 1e-6;
    let residuals = table.number("energy_residual", energy).unwrap();
    assert!(residuals.iter().all(|r| r.abs() < most), "{residuals:?}");
    let stream = changed(folder.path(), "[coefficients]", "current = [\"0.1 m/s\", \"0 m/s\"]\n[coefficients]");
    let other = folder.path().join("other");
    let carried = swum(&stream, &["--out", text(&other)]);
    assert_eq!(still["speed_m_s"], carried["speed_m_s"]);
    let table = read_table(&other.join("trajectory.parquet"), None).unwrap();
    let moved = *table.number("x", Dimension::LENGTH).unwrap().last().unwrap() - place;
    assert!((moved - 0.1 * time).abs() < 1e-9, "{moved} in {time} s");
}

/// Mass and volume that do not match are said; so are a law without a robot's terms, joints beyond their limits, an angle without its unit.
#[test]
fn what_does_not_fit_is_said_with_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let heavy = swum(
        &changed(folder.path(), "mass            = \"1.343 kg\"", "mass = \"1.343 kg\"\nvolume = \"1.25e-3 m^3\""),
        &[],
    );
    assert!((number(&heavy, "mass_less_displaced_kg") - (13.43 - 12.8125)).abs() < 1e-9);
    assert!(heavy["remarks"].to_string().contains("not neutral"), "{heavy}");
    let wide = refused(&example(), &["--amplitude", "100 deg", "--frequency", "80 deg/s", "--phase", "40 deg"]);
    assert!(wide.contains("100 deg at joint 1") && wide.contains("90 deg"), "{wide}");
    let bare = refused(&example(), &["--amplitude", "30", "--frequency", "80 deg/s", "--phase", "40 deg"]);
    assert!(bare.contains("--amplitude \"30\" has no unit"), "{bare}");
    // Slips of a unit: a chain of 180 m, and a link that takes tons along.
    for (from, to) in [("\"90 mm\"", "\"9 m\""), ("\"1.653 kg\"", "\"1653 kg\"")] {
        let slipped = refused(&changed(folder.path(), from, to), &GAIT);
        assert!(slipped.contains("a slip of a unit"), "{slipped}");
    }
    let tall = swum(&changed(folder.path(), "\"58.8 mm\"", "\"588 mm\""), &[]);
    assert!(tall["remarks"].to_string().contains("half height is 58.80 mm, and a module's is 588.0 mm"), "{tall}");
    let still = refused(&example(), &["--amplitude", "0 deg", "--frequency", "80 deg/s", "--phase", "40 deg"]);
    assert!(still.contains("does not swim"), "{still}");
    let none = changed(folder.path(), "restricted/f2", "restricted/f7");
    let none = refused(&none, &GAIT);
    assert!(none.contains("f7") && none.contains("circulation_tank_restricted/f4"), "{none}");
    let twice = refused(&changed(folder.path(), "= \"strip\"", "= \"strip\"\ntorque = \"friction\""), &GAIT);
    assert!(twice.contains("robot.toml:19:10") && twice.contains("count it twice"), "{twice}");
}
