//! A robot looked at before it swims.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bench;

use std::path::{Path, PathBuf};

use bench::{froude, text};
use serde_json::Value;

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/mamba-swim/robot.toml")
}

/// The example in a folder, beside the records that it names, with changes.
fn seen(folder: &Path, changes: &[(&str, &str)]) -> Value {
    let published = example().parent().unwrap().join("../mamba/published");
    let mut robot = std::fs::read_to_string(example()).unwrap().replace("../mamba/published", text(&published));
    for (from, to) in changes {
        assert!(robot.contains(from), "the example has no {from}");
        robot = robot.replacen(from, to, 1);
    }
    let path = folder.join("robot.toml");
    std::fs::write(&path, robot).unwrap();
    let output = froude(&["robot", "inspect", text(&path), "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} of {value}"))
}

/// Ten equal links are one kind; the force of the whole is ten times what the printed coefficients of one make of 0.3 m/s.
#[test]
fn masses_drag_and_forces_of_the_example() {
    let folder = tempfile::tempdir().unwrap();
    let found = seen(folder.path(), &[]);
    assert!((number(&found, "mass_kg") - 13.43).abs() < 1e-12 && found["displaced_kg"].is_null());
    assert!((number(&found, "added_mass_sway_kg") - 16.53).abs() < 1e-12);
    let kinds = found["kinds"].as_array().unwrap();
    assert_eq!((kinds.len(), kinds[0]["first"].as_u64(), kinds[0]["last"].as_u64()), (1, Some(1), Some(10)));
    for way in ["along", "across"] {
        let of = |unit: &str| number(&kinds[0]["drag"], &format!("{way}_{unit}"));
        let expected = -10.0 * (of("kg_s") + of("kg_m") * 0.3) * 0.3;
        assert!((number(&found, &format!("force_{way}_at_0.3_m_s_n")) / expected - 1.0).abs() < 1e-12, "{found}");
    }
    assert!(found["remarks"].to_string().contains("whether the robot is neutral is not known"));
    let output = froude(&["robot", "inspect", text(&example())]);
    assert!(String::from_utf8(output.stdout).unwrap().contains("1 to 10"));
}

/// Trim of a robot whose head is heavier ahead, slips of a unit, volumes beyond the shape, a law by origin that drives a module.
#[test]
fn what_does_not_fit_together_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let body = "mass = \"1.343 kg\"\nvolume = \"1.31e-3 m^3\"\ncenter_of_mass = \"9 mm\"";
    let trimmed = seen(folder.path(), &[("mass            = \"1.343 kg\"", body)]);
    assert!((number(&trimmed, "mass_ahead_of_buoyancy_m") - 0.009).abs() < 1e-12, "{trimmed}");
    assert!((number(&trimmed, "displaced_kg") - 13.4275).abs() < 1e-9);
    assert!(trimmed["remarks"].to_string().contains("neutral"), "{trimmed}");

    let mass = ("mass            = \"1.343 kg\"", "mass = \"1343 kg\"\nvolume = \"2e-3 m^3\"");
    let slipped = seen(folder.path(), &[mass, ("\"1.653 kg\"", "\"1653 kg\"")])["remarks"].to_string();
    for word in
        ["not neutral", "a mass of 1343 kg", "an added mass in sway of 1653 kg", "1.53 times that of the cylinder"]
    {
        assert!(slipped.contains(word), "{word}: {slipped}");
    }
    let driven = seen(
        folder.path(),
        &[("restricted/f2", "restricted/f4"), ("\"strip\"", "\"strip\"\ndistribution = \"by-origin\"")],
    );
    assert!(driven["remarks"].to_string().contains("not dissipative"), "{driven}");
}

/// Of two verbs that look at files, each names the other.
#[test]
fn a_robot_is_no_campaign_and_a_campaign_no_robot() {
    let told = |args: &[&str]| {
        let output = froude(args);
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    let robot = told(&["inspect", text(&example())]);
    assert!(robot.contains("is a robot file") && robot.contains("froude robot inspect"), "{robot}");
    let campaign = example().parent().unwrap().join("../mamba/campaign.toml");
    let campaign = told(&["robot", "inspect", text(&campaign)]);
    assert!(campaign.contains("is a campaign") && campaign.contains("takes a robot file"), "{campaign}");
}

/// The example's links as a URDF swim as its robot file does; what is no chain in a plane is refused with its line.
#[test]
fn a_urdf_with_a_sidecar_is_the_robot_file() {
    let folder = tempfile::tempdir().unwrap();
    let (urdf, sidecar) = (folder.path().join("mamba.urdf"), folder.path().join("mamba.toml"));
    let (b, l, m) = (0.0394_f64, 0.09_f64, 1.343_f64);
    let izz = m * (l * l / 3.0 + b * b / 4.0);
    let link = |i: usize| {
        format!(
            "<link name=\"link{i}\"><inertial><origin xyz=\"-0.09 0 0\"/><mass value=\"{m}\"/><inertia ixx=\"1e-3\" iyy=\"1e-3\" izz=\"{izz:e}\"/></inertial></link>\n"
        )
    };
    let joint = |i: usize| {
        format!(
            "<joint name=\"j{i}\" type=\"revolute\"><parent link=\"link{i}\"/><child link=\"link{}\"/><origin xyz=\"-0.18 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1.6\" upper=\"1.6\"/></joint>\n",
            i + 1
        )
    };
    let links: String = (1..=10).rev().map(link).collect();
    let joints: String = (1..10).map(joint).collect();
    let whole = format!("<?xml version=\"1.0\"?>\n<robot name=\"mamba\">\n{links}{joints}</robot>\n");
    std::fs::write(&urdf, &whole).unwrap();
    let published = example().parent().unwrap().join("../mamba/published");
    let robot = std::fs::read_to_string(example()).unwrap().replace("../mamba/published", text(&published));
    let head = robot.split("[[module]]").next().unwrap();
    let module = |i: usize| {
        let length = if i == 1 || i == 10 { "half_length = \"90 mm\"\n" } else { "" };
        format!(
            "[[module]]\nname = \"link{i}\"\nmajor_semi_axis = \"58.8 mm\"\nminor_semi_axis = \"39.4 mm\"\n{length}"
        )
    };
    let modules: String = (1..=10).map(module).collect();
    std::fs::write(&sidecar, format!("{head}{modules}")).unwrap();
    let swum = |robot: &Path| -> Value {
        let gait = ["--amplitude", "30 deg", "--frequency", "80 deg/s", "--phase", "40 deg", "--json"];
        let output = froude(&[&["swim", text(robot)], &gait[..]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let (one, other) = (swum(&urdf), swum(&example()));
    for key in ["speed_m_s", "power_net_w", "torque_peak_n_m"] {
        // Decimals of an inertia.
        assert!((number(&one, key) / number(&other, key) - 1.0).abs() < 1e-9, "{key}: {one} {other}");
    }
    let output = froude(&["robot", "inspect", text(&urdf), "--json"]);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!((number(&found, "mass_kg") - 13.43).abs() < 1e-9, "{found}");

    for (from, to, place, problem) in [
        ("type=\"revolute\"", "type=\"fixed\"", ":13:", "make one link of the two"),
        ("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 1 0\"/>", ":13:", "all joints turn about z"),
        ("child link=\"link2\"", "child link=\"link7\"", ":18:", "branches at link"),
        ("<origin xyz=\"-0.18 0 0\"/>", "<origin xyz=\"0.18 0 0\"/>", ":13:", "behind its own"),
        ("<origin xyz=\"-0.18 0 0\"/>", "<origin xyz=\"-0.18 0 0\" rpy=\"0 0 1\"/>", ":13:", "frames that are turned"),
        ("lower=\"-1.6\"", "lower=\"-1\"", ":13:", "alike to both sides"),
        ("mass value=\"1.343\"", "mass value=\"-1\"", ":3:", "more than zero"),
        ("</robot>", "", ":", "not XML"),
    ] {
        assert!(whole.contains(from), "{from}");
        std::fs::write(&urdf, whole.replacen(from, to, 1)).unwrap();
        let output = froude(&["robot", "inspect", text(&urdf)]);
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(
            output.status.code() == Some(2) && told.contains(&format!("mamba.urdf{place}")) && told.contains(problem),
            "{to}: {told}"
        );
    }
    std::fs::write(&urdf, &whole).unwrap();
    std::fs::write(&sidecar, format!("{head}{}", modules.replacen("\"link3\"", "\"link33\"", 1))).unwrap();
    let told = String::from_utf8(froude(&["robot", "inspect", text(&urdf)]).stderr).unwrap();
    assert!(told.contains("mamba.toml:") && told.contains("\"link33\""), "{told}");
    std::fs::remove_file(&sidecar).unwrap();
    let told = String::from_utf8(
        froude(&["swim", text(&urdf), "--amplitude", "1 deg", "--frequency", "1 Hz", "--phase", "1 deg"]).stderr,
    )
    .unwrap();
    assert!(told.contains("says nothing of the water") && told.contains("mamba.toml"), "{told}");
}
