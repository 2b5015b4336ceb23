//! A robot looked at before it swims.

use std::path::{Path, PathBuf};

use crate::bench::{froude, text};
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
        ("type=\"revolute\"", "type=\"prismatic\"", ":13:", "revolute, continuous or fixed"),
        ("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 1 0\"/>", ":13:", "joints of a planar chain turn about z"),
        ("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>", ":13:", "joints of a planar chain turn about z"),
        ("child link=\"link2\"", "child link=\"link7\"", ":18:", "second parent"),
        ("parent link=\"link2\"", "parent link=\"link1\"", ":14:", "branches"),
        ("<origin xyz=\"-0.18 0 0\"/>", "<origin xyz=\"0.18 0 0\"/>", ":13:", "behind its own"),
        ("<origin xyz=\"-0.18 0 0\"/>", "<origin xyz=\"-0.18 0 0\" rpy=\"0 0 1\"/>", ":13:", "rotated frames"),
        ("lower=\"-1.6\"", "lower=\"-1\"", ":13:", "same in both directions"),
        ("mass value=\"1.343\"", "mass value=\"-1\"", ":3:", "above zero"),
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
    assert!(
        told.contains("says nothing of the water: write") && told.contains("mamba.toml:\n  schema = 1\n"),
        "{told}"
    );
    assert!(told.contains("name = \"link3\"\n") && told.matches("half_length").count() == 2, "{told}");
}

/// Mass, centre of mass and inertia about z of a body, in the axes of a module.
const LINK: [f64; 3] = [1.5, 0.1, 0.006];

/// A six-link eel; extra links, and the joints and the root as they are changed.
fn eel(extra: &str, changes: &[(&str, &str)]) -> String {
    let [mass, behind, izz] = LINK;
    let link = |i: usize| {
        format!(
            "<link name=\"l{i}\"><inertial><origin xyz=\"-{behind} 0 0\"/><mass value=\"{mass}\"/><inertia ixx=\"0.002\" iyy=\"0.006\" izz=\"{izz}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n"
        )
    };
    let joint = |i: usize| {
        format!(
            "<joint name=\"j{i}\" type=\"revolute\"><parent link=\"l{i}\"/><child link=\"l{}\"/><origin xyz=\"-0.2 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1.2\" upper=\"1.2\" effort=\"5\" velocity=\"3\"/></joint>\n",
            i + 1
        )
    };
    let (links, joints): (String, String) = ((1..=6).map(link).collect(), (1..6).map(joint).collect());
    let mut whole = format!("<?xml version=\"1.0\"?>\n<robot name=\"eel\">\n{links}{joints}{extra}</robot>\n");
    for (from, to) in changes {
        assert!(whole.contains(from), "the eel has no {from}");
        whole = whole.replacen(from, to, 1);
    }
    whole
}

/// The sidecar of the eel; the head's module names one of its links.
fn eel_sidecar(head: &str) -> String {
    let published = example().parent().unwrap().join("../mamba/published");
    let robot = std::fs::read_to_string(example()).unwrap().replace("../mamba/published", text(&published));
    let water = robot.split("[[module]]").next().unwrap().to_owned();
    let module = |i: usize| {
        let length = if i == 1 || i == 6 { "half_length = \"100 mm\"\n" } else { "" };
        let name = if i == 1 { head.to_owned() } else { format!("l{i}") };
        format!("[[module]]\nname = \"{name}\"\nmajor_semi_axis = \"58.8 mm\"\nminor_semi_axis = \"39.4 mm\"\n{length}")
    };
    water + &(1..=6).map(module).collect::<String>()
}

fn eel_told(folder: &Path, head: &str, extra: &str, changes: &[(&str, &str)], verb: &[&str]) -> std::process::Output {
    let urdf = folder.join("eel.urdf");
    std::fs::write(&urdf, eel(extra, changes)).unwrap();
    std::fs::write(folder.join("eel.toml"), eel_sidecar(head)).unwrap();
    let (first, rest) = verb.split_at(if verb[0] == "swim" { 1 } else { 2 });
    froude(&[first, &[text(&urdf)], rest, &["--json"]].concat())
}

fn eel_seen(head: &str, extra: &str, changes: &[(&str, &str)], verb: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let output = eel_told(folder.path(), head, extra, changes, verb);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

const INSPECT: [&str; 2] = ["robot", "inspect"];
const SWIM: [&str; 7] = ["swim", "--amplitude", "30 deg", "--frequency", "80 deg/s", "--phase", "40 deg"];
const CAMERA: &str = "<link name=\"camera\"><inertial><mass value=\"0.05\"/><inertia ixx=\"1e-5\" iyy=\"1e-5\" izz=\"1e-5\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n<joint name=\"camera_mount\" type=\"fixed\"><parent link=\"l1\"/><child link=\"camera\"/><origin xyz=\"0.05 0 0.03\"/></joint>\n";

/// A camera on a fixed joint is part of the head (parallel axes), and a joint that turns about −z swims like one about z; both are said. The robot's mass is 6 · 1.5 + 0.05 kg.
#[test]
fn a_urdf_with_a_camera_and_a_joint_pointing_down_swims() {
    let down = (
        "<child link=\"l4\"/><origin xyz=\"-0.2 0 0\"/><axis xyz=\"0 0 1\"/>",
        "<child link=\"l4\"/><origin xyz=\"-0.2 0 0\"/><axis xyz=\"0 0 -1\"/>",
    );
    let seen = eel_seen("l1", CAMERA, &[down], &INSPECT);
    assert!((number(&seen, "mass_kg") - 9.05).abs() < 1e-12, "{seen}");
    let head = &seen["kinds"][0];
    let [mass, behind, izz] = LINK;
    let (camera, ahead, own) = (0.05, 0.05, 1e-5);
    let centre = (camera * ahead - mass * behind) / (mass + camera);
    let inertia = izz + own + mass * (behind + centre).powi(2) + camera * (ahead - centre).powi(2);
    assert!((number(head, "mass_kg") - 1.55).abs() < 1e-12);
    assert!((number(head, "inertia_kg_m2") / inertia - 1.0).abs() < 1e-12, "{inertia}: {head}");
    // The joint lies 0.2 m behind the frame, and the module's centre half of its length ahead of the joint.
    assert!((head["center_of_mass_m"][0].as_f64().unwrap() - (centre + 0.1)).abs() < 1e-12, "{head}");
    // z is up in the URDF and down in the robot file.
    assert!((head["center_of_mass_m"][2].as_f64().unwrap() + camera * 0.03 / 1.55).abs() < 1e-12, "{head}");
    let remarks = seen["remarks"].to_string();
    assert!(remarks.contains("camera (0.05 kg) is fixed to l1"), "{remarks}");
    assert!(remarks.contains("joint 3 (j3) turns about -z: phi_3 is minus its URDF angle"), "{remarks}");

    let (one, other) = (eel_seen("l1", CAMERA, &[down], &SWIM), eel_seen("l1", CAMERA, &[], &SWIM));
    assert!(number(&one, "speed_m_s") > 0.05, "{one}");
    assert!(one["remarks"].to_string().contains("minus its URDF angle"), "{one}");
    for key in ["speed_m_s", "power_net_w", "torque_peak_n_m"] {
        assert_eq!(number(&one, key), number(&other, key), "{key}");
    }
}

/// A point mass on chains of fixed joints with turned frames, at the root, within the chain and at its end: bodies and figures are those of the same masses written into one link.
#[test]
fn fixed_joints_anywhere_are_the_links_with_their_masses_in_them() {
    // From a massless world through a base whose frame is turned about x; its frame is rounded to four decimals.
    let root = "<link name=\"world\"/>\n<link name=\"base\"/>\n<joint name=\"w\" type=\"fixed\"><parent link=\"world\"/><child link=\"base\"/><origin xyz=\"1 2 3\" rpy=\"3.1416 0 0.5\"/></joint>\n<joint name=\"b\" type=\"fixed\"><parent link=\"base\"/><child link=\"l1\"/><origin xyz=\"0.1 0 0\" rpy=\"0 1.5708 0\"/></joint>\n";
    let plain = eel_seen("l1", "", &[], &INSPECT);
    for head in ["l1", "base", "world"] {
        let seen = eel_seen(head, root, &[], &INSPECT);
        let of = |seen: &Value| {
            let head = &seen["kinds"][0];
            [number(head, "mass_kg"), number(head, "inertia_kg_m2"), head["center_of_mass_m"][0].as_f64().unwrap()]
        };
        // Frames that are rotated and rotated back round in the last digits, of numbers up to 10.
        assert!(of(&seen).iter().zip(of(&plain)).all(|(a, b)| (a - b).abs() < 1e-14), "{head}: {seen}");
    }
    // l2 carries the joint of l3 on a bracket behind a bracket, whose frames are turned and turned back.
    let bracket = "<link name=\"arm\"/>\n<link name=\"bracket\"/>\n<joint name=\"a\" type=\"fixed\"><parent link=\"l2\"/><child link=\"arm\"/><origin xyz=\"-0.05 0 0\" rpy=\"1.5707963267948966 0 1.5707963267948966\"/></joint>\n<joint name=\"c\" type=\"fixed\"><parent link=\"arm\"/><child link=\"bracket\"/><origin xyz=\"0 0 -0.05\" rpy=\"0 -1.5707963267948966 -1.5707963267948966\"/></joint>\n";
    let at = (
        "<parent link=\"l2\"/><child link=\"l3\"/><origin xyz=\"-0.2 0 0\"/>",
        "<parent link=\"bracket\"/><child link=\"l3\"/><origin xyz=\"-0.1 0 0\"/>",
    );
    let (one, other) = (eel_seen("l1", bracket, &[at], &SWIM), eel_seen("l1", "", &[], &SWIM));
    for key in ["speed_m_s", "power_net_w", "torque_peak_n_m"] {
        assert!((number(&one, key) / number(&other, key) - 1.0).abs() < 1e-9, "{key}: {one} {other}");
    }
    // A rod of 0.12 kg whose own inertia lies along its y, turned so that y points up, 0.03 m below the tail's axis: its inertia about z is iyy of the rod.
    let rod = "<link name=\"rod\"><inertial><origin xyz=\"0 0.03 0\"/><mass value=\"0.12\"/><inertia ixx=\"1e-4\" iyy=\"7e-4\" izz=\"6e-4\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n<joint name=\"r\" type=\"fixed\"><parent link=\"l6\"/><child link=\"rod\"/><origin xyz=\"-0.1 0 -0.06\" rpy=\"1.5707963267948966 0 0\"/></joint>\n";
    let seen = eel_seen("l1", rod, &[], &INSPECT);
    let tail = seen["kinds"].as_array().unwrap().last().unwrap().clone();
    assert!((number(&tail, "inertia_kg_m2") - (0.006 + 7e-4)).abs() < 1e-12, "{tail}");
    // 0.06 m down to its joint, and 0.03 m up to its mass.
    assert!((tail["center_of_mass_m"][2].as_f64().unwrap() - 0.12 * 0.03 / 1.62).abs() < 1e-12, "{tail}");
}

/// What of fixed joints and axes stays rejected, each with its place.
#[test]
fn a_urdf_whose_rigid_parts_do_not_form_a_planar_chain_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let told = |head: &str, extra: &str, changes: &[(&str, &str)]| {
        let output = eel_told(folder.path(), head, extra, changes, &INSPECT);
        assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
        String::from_utf8(output.stderr).unwrap()
    };
    let aside = CAMERA.replace("0.05 0 0.03", "0.05 0.03 0");
    let said = told("l1", &aside, &[]);
    assert!(said.contains("eel.urdf:3:") && said.contains("beside the x axis"), "{said}");
    let branch = CAMERA.replace("type=\"fixed\"", "type=\"continuous\"");
    let said = told("l1", &branch, &[]);
    assert!(said.contains("eel.urdf:15:") && said.contains("branches"), "{said}");
    let turned = (
        "<child link=\"l4\"/><origin xyz=\"-0.2 0 0\"/>",
        "<child link=\"l4\"/><origin xyz=\"-0.2 0 0\" rpy=\"0 0 0.1\"/>",
    );
    let said = told("l1", "", &[turned]);
    assert!(said.contains("eel.urdf:11:") && said.contains("rotated frames"), "{said}");
    // One module for a rigid body, under the name of one of its links.
    let folder = tempfile::tempdir().unwrap();
    let urdf = folder.path().join("eel.urdf");
    std::fs::write(&urdf, eel(CAMERA, &[])).unwrap();
    let twice = eel_sidecar("l1")
        + "[[module]]\nname = \"camera\"\nmajor_semi_axis = \"58.8 mm\"\nminor_semi_axis = \"39.4 mm\"\nhalf_length = \"50 mm\"\n";
    std::fs::write(folder.path().join("eel.toml"), twice).unwrap();
    let said = String::from_utf8(froude(&["robot", "inspect", text(&urdf)]).stderr).unwrap();
    assert!(
        said.contains("eel.toml:") && said.contains("the rigid body of \"camera\" already has a module, \"l1\""),
        "{said}"
    );
    // All fixed: no chain is left.
    let all = eel("", &[]).replace("type=\"revolute\"", "type=\"fixed\"");
    std::fs::write(&urdf, all).unwrap();
    let said = String::from_utf8(froude(&["robot", "inspect", text(&urdf)]).stderr).unwrap();
    assert!(said.contains("eel.urdf:2:") && said.contains("1 rigid body"), "{said}");
}

/// Axes and limits written with the digits of a CAD export.
#[test]
fn axes_and_limits_of_a_urdf_are_read_within_their_rounding() {
    let (plain, axis) = (eel_seen("l1", "", &[], &SWIM), "<axis xyz=\"0 0 1\"/>");
    for other in ["0 0 2", "0 -3.6732E-06 1", "3.6732E-06 0 -1", "0.0005 0 0.9999999"] {
        let found = eel_seen("l1", "", &[(axis, &format!("<axis xyz=\"{other}\"/>"))], &SWIM);
        assert_eq!(number(&found, "speed_m_s"), number(&plain, "speed_m_s"), "{other}");
    }
    let limits = ("lower=\"-1.2\" upper=\"1.2\"", "lower=\"-0.5236\" upper=\"0.523599\"");
    // 30 deg is 0.5235988 rad, which the smaller of the two limits allows.
    let found = eel_seen("l1", "", &[limits], &SWIM);
    assert_eq!(number(&found, "speed_m_s"), number(&plain, "speed_m_s"));
}
