//! A robot swims in three dimensions at the verb: in the plane where nothing leaves it, a trajectory that closes its energy, and what is refused.

use std::path::{Path, PathBuf};

use crate::bench::{froude, text};
use froude::records::estimate::{Coefficient, Measured};
use froude::records::json::{read_estimates, write_estimates};
use froude::records::table_file::read_table;
use froude::records::units::Dimension;
use serde_json::Value;

const GAIT: [&str; 6] = ["--amplitude", "30 deg", "--frequency", "80 deg/s", "--phase", "40 deg"];

/// The example with changes, in a folder, with the records where they are.
fn changed(folder: &Path, changes: &[(&str, &str)]) -> PathBuf {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/mamba-3d");
    let published = example.join("../mamba/published");
    let mut robot = std::fs::read_to_string(example.join("robot.toml")).unwrap();
    robot = robot.replace("../mamba/published", text(&published));
    for (from, to) in changes {
        assert!(robot.contains(from), "the example has no {from}");
        robot = robot.replacen(from, to, 1);
    }
    let path = folder.join("robot.toml");
    std::fs::write(&path, robot).unwrap();
    path
}

fn swum(robot: &Path, more: &[&str]) -> Value {
    let output = froude(&[&["swim", text(robot)], &GAIT[..], more, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refused(robot: &Path, more: &[&str]) -> String {
    let output = froude(&[&["swim", text(robot)], &GAIT[..], more].concat());
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
    String::from_utf8(output.stderr).unwrap()
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} of {value}"))
}

const PITCH: (&str, &str) = ("\n[[joint]]\nindex = [2, 4, 6, 8]\naxis  = \"pitch\"\n", "");
const LOW: (&str, &str) = ("\"4 mm\"]", "\"0 mm\"]");
const EXACT: (&str, &str) = ("volume             = \"1.310244e-3 m^3\"", "volume = \"1.3102439024390244e-3 m^3\"");

/// All joints yaw and the mass lies in the plane: the figures of the plane, to what both searches repeat by.
#[test]
fn the_same_file_in_the_plane_has_the_same_figures() {
    let folder = tempfile::tempdir().unwrap();
    let space = swum(&changed(folder.path(), &[PITCH, LOW, EXACT]), &[]);
    let plane = swum(&changed(folder.path(), &[PITCH, LOW, EXACT, ("\"3d\"", "\"planar\"")]), &[]);
    assert_eq!(space["space"], "3d");
    for key in ["speed_m_s", "power_net_w", "power_positive_w", "torque_peak_n_m", "loss_along_links"] {
        let (a, b) = (number(&space, key), number(&plane, key));
        assert!((a / b - 1.0).abs() < 1e-6, "{key}: {a} {b}");
    }
    // Nothing rights it, and that is said.
    assert!(space["remarks"].to_string().contains("nothing rights it"), "{space}");
}

const SERVO: (&str, &str) = ("limit = \"90 deg\"", "limit = \"90 deg\"\nkp = \"8 N m/rad\"\nkd = \"0.3 N m s/rad\"");

/// With servos, by a recording, and swept with servos: the figures of the plane there too.
#[test]
fn servos_recordings_and_sweeps_of_the_same_file_have_the_figures_of_the_plane() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("track.csv");
    let mut rows = String::from("time [s]");
    (1..=9).for_each(|i| rows.push_str(&format!(",phi_{i} [deg]")));
    for k in 0..=100 {
        let t = 0.09 * f64::from(k);
        rows.push_str(&format!("\n{t}"));
        (0..9).for_each(|i| rows.push_str(&format!(",{}", 25.0 * (1.4 * t - 0.7 * f64::from(i)).sin())));
    }
    std::fs::write(&table, rows).unwrap();
    let both = |more: &[&str]| {
        ["\"3d\"", "\"planar\""].map(|space| {
            let robot = changed(folder.path(), &[PITCH, LOW, EXACT, SERVO, ("\"3d\"", space)]);
            let output = froude(&[&["swim", text(&robot)], more, &["--json"]].concat());
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            serde_json::from_slice::<Value>(&output.stdout).unwrap()
        })
    };
    let near = |[a, b]: [f64; 2], what: &str| assert!((a / b - 1.0).abs() < 1e-6, "{what}: {a} {b}");
    let driven = both(&GAIT);
    for key in ["speed_m_s", "power_net_w", "torque_peak_n_m"] {
        near([0, 1].map(|k| number(&driven[k], key)), key);
    }
    near([0, 1].map(|k| number(&driven[k]["servo"], "away_from_gait_rad")), "distance from the gait");
    let out = folder.path().join("out");
    let tracked = both(&["--track", text(&table), "--out", text(&out)]);
    for key in ["speed_m_s", "power_net_w", "energy_gained_j", "length_s"] {
        near([0, 1].map(|k| number(&tracked[k], key)), key);
    }
    assert!(number(&tracked[0], "sinking_m").abs() < 1e-9, "{}", tracked[0]);
    let sweep = ["--sweep", "amplitude=20..30 deg:2", "--frequency", "80 deg/s", "--phase", "40 deg"];
    let swept = both(&[&sweep[..], &["--out", text(&folder.path().join("map"))]].concat());
    let best = swept.map(|found| number(&found["best"][0], "speed_m_s"));
    near(best, "fastest");
    assert!((best[0] / number(&driven[0], "speed_m_s") - 1.0).abs() < 1e-6, "{best:?}");
    let front =
        both(&[&sweep[..], &["--optimise", "speed,power", "--out", text(&folder.path().join("front"))]].concat());
    near(front.map(|found| number(&found["gaits"][0], "speed_m_s")), "fastest of the front");
}

/// A module with numbers of its own does not hear those of all.
#[test]
fn a_module_s_own_added_mass_stands_before_that_of_all() {
    let folder = tempfile::tempdir().unwrap();
    let own = (
        "volume ",
        "added_mass = { surge = \"0.1 kg\", sway = \"1.5 kg\", heave = \"0.7 kg\", roll = \"1e-4 kg m^2\", pitch = \"2e-3 kg m^2\", yaw = \"4e-3 kg m^2\" }\nvolume ",
    );
    for space in ["\"3d\"", "\"planar\""] {
        let speed = |sway: &str| {
            let changes = [PITCH, ("\"3d\"", space), own, ("\"1.653 kg\"", sway)];
            number(&swum(&changed(folder.path(), &changes), &[]), "speed_m_s")
        };
        assert_eq!(speed("\"1.653 kg\""), speed("\"2 kg\""));
    }
}

/// The example with a wave of its pitch joints, in a current: work, loss, kinetic and potential energy close over the trajectory, q is a unit quaternion, and the current carries.
#[test]
fn a_trajectory_closes_its_energy_with_that_of_height() {
    let folder = tempfile::tempdir().unwrap();
    let stream = ("[coefficients]", "current = [\"0.1 m/s\", \"0 m/s\"]\n[coefficients]");
    let robot = changed(folder.path(), &[stream]);
    let out = folder.path().join("out");
    let pitch = ["--pitch-amplitude", "10 deg", "--out", text(&out)];
    let found = swum(&robot, &pitch);
    // What is printed stands in the folder too.
    let record = std::fs::read_to_string(out.join("result.json")).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&record).unwrap(), found);
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("How the head lies") && !page.contains("<script src"), "{page}");
    assert!(found["pitch_rad"][1].as_f64().unwrap() > 0.05, "{found}");
    assert!(found["floquet_multipliers"][0].as_f64().unwrap() < 1.0, "{found}");
    let table = read_table(&out.join("trajectory.parquet"), None).unwrap();
    let column = |name: &str, dimension: Dimension| table.number(name, dimension).unwrap().to_vec();
    let energy = Dimension::new(2, 1, -2);
    let time = column("time", Dimension::TIME);
    // Fourth order in 400 steps a period.
    let most = number(&found, "power_net_w") * time[time.len() - 1] * 1e-6;
    assert!(column("energy_residual", energy).iter().all(|r| r.abs() < most));
    assert!(column("energy_potential", energy).iter().any(|e| e.abs() > 1e-4));
    let q = ["q_w", "q_x", "q_y", "q_z"].map(|name| column(name, Dimension::ONE));
    for i in 0..time.len() {
        assert!((q.iter().map(|q| q[i] * q[i]).sum::<f64>() - 1.0).abs() < 1e-12);
    }
    let x = column("x", Dimension::LENGTH);
    let way = x[x.len() - 1] - x[0];
    let swims = (number(&found, "speed_m_s") + 0.1) * time[time.len() - 1];
    // It turns by less than a degree on its way.
    assert!((way / swims - 1.0).abs() < 2e-3, "{way} {swims}");
}

/// C_A of a record with the volume of its link is sway and yaw of the plane: 1.2674 and 1.2723e-3 m³ give the 1.653 kg of the example to their digits. Three dimensions need six.
#[test]
fn an_added_mass_of_sway_alone_swims_in_the_plane_only() {
    let folder = tempfile::tempdir().unwrap();
    let published = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/mamba/published");
    let mut record = read_estimates(&published.join("circulation_tank_restricted.json")).unwrap();
    record.estimates.truncate(1);
    let e = &mut record.estimates[0];
    e.id = "link".to_owned();
    let of_one = e.coefficients.values().next().unwrap().clone();
    e.coefficients.insert("C_A".to_owned(), Coefficient { value: Some(1.2674), ..of_one });
    e.refers_to.insert("link_volume".to_owned(), Measured { value: 1.2723e-3, unit: "m^3".to_owned() });
    let path = folder.path().join("link.json");
    write_estimates(&path, &record).unwrap();
    let named = format!("record = \"{}\"", text(&path));
    let numbers = "surge = \"0.20 kg\", sway = \"1.653 kg\", heave = \"0.742 kg\", roll = \"2.63e-4 kg m^2\", pitch = \"2.004e-3 kg m^2\", yaw = \"4.4631e-3 kg m^2\"";
    let flat = ("\"3d\"", "\"planar\"");
    let by_record = swum(&changed(folder.path(), &[PITCH, flat, (numbers, &named)]), &[]);
    let alone = "sway = \"1.653 kg\", yaw = \"4.4631e-3 kg m^2\"";
    let by_numbers = swum(&changed(folder.path(), &[PITCH, flat, (numbers, alone)]), &[]);
    let (a, b) = (number(&by_record, "speed_m_s"), number(&by_numbers, "speed_m_s"));
    assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
    let said = refused(&changed(folder.path(), &[(numbers, &named)]), &[]);
    assert!(said.contains("link has C_A, which is of sway alone"), "{said}");
}

/// The matrix of `froude added-mass` is that of numbers, times the robot's water over that of the record.
#[test]
fn a_matrix_of_potential_flow_is_taken_for_a_module() {
    let folder = tempfile::tempdir().unwrap();
    let body = "schema = 1\n[body]\nshape = \"ellipsoid\"\nsemi_axis_x = \"90 mm\"\nsemi_axis_y = \"39.4 mm\"\nsemi_axis_z = \"58.8 mm\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n";
    std::fs::write(folder.path().join("module.toml"), body).unwrap();
    let out = folder.path().join("am");
    let module = folder.path().join("module.toml");
    for axes in ["ned", "enu"] {
        let made = froude(&["added-mass", text(&module), "--axes", axes, "--tolerance", "5 %", "--out", text(&out)]);
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        let record = format!("record = \"{}\"", text(&out.join("estimate.json")));
        let numbers = "surge = \"0.20 kg\", sway = \"1.653 kg\", heave = \"0.742 kg\", roll = \"2.63e-4 kg m^2\", pitch = \"2.004e-3 kg m^2\", yaw = \"4.4631e-3 kg m^2\"";
        let robot = changed(folder.path(), &[(numbers, &record)]);
        if axes == "enu" {
            let said = refused(&robot, &[]);
            assert!(said.contains("z down") && said.contains("--axes ned"), "{said}");
            continue;
        }
        let by_record = swum(&robot, &[]);
        assert_eq!(by_record["added_mass"], "body/added_mass_6x6");
        let long = ("half_length        = \"90 mm\"", "half_length = \"180 mm\"");
        let said = refused(&changed(folder.path(), &[(numbers, &record), long]), &[]);
        assert!(said.contains("0.18 m long") && said.contains("0.36 m"), "{said}");
        let text = std::fs::read_to_string(out.join("estimate.json")).unwrap();
        let file: Value = serde_json::from_str(&text).unwrap();
        let of = |name: &str| 1.025 * file["estimates"][0]["coefficients"][name]["value"].as_f64().unwrap();
        let written = format!(
            "surge = \"{} kg\", sway = \"{} kg\", heave = \"{} kg\", roll = \"{} kg m^2\", pitch = \"{} kg m^2\", yaw = \"{} kg m^2\"",
            of("A11"),
            of("A22"),
            of("A33"),
            of("A44"),
            of("A55"),
            of("A66")
        );
        let by_numbers = swum(&changed(folder.path(), &[(numbers, &written)]), &[]);
        let (a, b) = (number(&by_record, "speed_m_s"), number(&by_numbers, "speed_m_s"));
        // What panels leave of entries that are zero by symmetry.
        assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
    }
}

/// What is of the plane, and what is not in balance.
#[test]
fn what_three_dimensions_do_not_have_is_refused_and_what_is_odd_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let usr = refused(&changed(folder.path(), &[("space      = \"3d\"", "space = \"3d\"\nadded_mass = \"usr\"")]), &[]);
    assert!(usr.contains("robot.toml:20:14") && usr.contains("plane only"), "{usr}");
    let flat = changed(folder.path(), &[PITCH, ("\"3d\"", "\"planar\"")]);
    let pitch = ["--pitch-amplitude", "10 deg"];
    assert!(refused(&flat, &pitch).contains("is a planar model"));
    assert!(refused(&changed(folder.path(), &[PITCH]), &pitch).contains("no joint that pitches"));
    let gait = folder.path().join("gait.toml");
    let waves = "schema = 1\nkind = \"lateral\"\npitch = { amplitude = \"10 deg\" }\n";
    std::fs::write(&gait, waves).unwrap();
    let said = refused(&changed(folder.path(), &[PITCH, ("\"3d\"", "\"planar\"")]), &["--gait", text(&gait)]);
    assert!(said.contains("gait.toml") && said.contains("has pitch"), "{said}");
    // A file and the options say the same.
    let robot = changed(folder.path(), &[]);
    assert_eq!(swum(&robot, &["--gait", text(&gait)])["pitch_rad"], swum(&robot, &pitch)["pitch_rad"]);
    let wide = refused(&changed(folder.path(), &[]), &["--pitch-amplitude", "100 deg"]);
    assert!(wide.contains("100 deg at joint 2"), "{wide}");
    let top = swum(&changed(folder.path(), &[("\"4 mm\"]", "\"-1 mm\"]")]), &[]);
    assert!(
        top["remarks"].to_string().contains("top-heavy") && top["remarks"].to_string().contains("bottom up"),
        "{top}"
    );
    // Turned over it is stable: its roll stays within a degree of half a turn.
    let roll = [0, 1].map(|k| top["roll_rad"][k].as_f64().unwrap().abs());
    assert!(roll.iter().all(|r| (r - std::f64::consts::PI).abs() < 0.02), "{top}");
    assert!(number(&top, "righting_m") < 0.0 && top["floquet_multipliers"][0].as_f64().unwrap() < 1.0, "{top}");
    let heavy = swum(&changed(folder.path(), &[("\"1.310244e-3 m^3\"", "\"1.29e-3 m^3\"")]), &[]);
    assert!(number(&heavy, "sinking_m_s") > 0.0 && heavy["remarks"].to_string().contains("not neutral"), "{heavy}");
}

/// A body that nothing rights, with volumes rounded in digits that were and were not given: within them it is neutral and swims as in the plane, at 0.189 m/s. It rose at 3e-7 m/s over the ground, nose up, for 1e-7 of its weight.
#[test]
fn a_robot_that_is_neutral_within_its_digits_swims_as_in_the_plane() {
    let folder = tempfile::tempdir().unwrap();
    let plane = number(&swum(&changed(folder.path(), &[PITCH, LOW, ("\"3d\"", "\"planar\"")]), &[]), "speed_m_s");
    for volume in ["1.310244e-3", "1.31024e-3", "1.3102e-3", "1.310e-3", "1.31e-3"] {
        let rounded = ("\"1.310244e-3 m^3\"", format!("\"{volume} m^3\""));
        let changes = [PITCH, LOW, (rounded.0, rounded.1.as_str())];
        let found = swum(&changed(folder.path(), &changes), &[]);
        let speed = number(&found, "speed_m_s");
        assert!((speed / plane - 1.0).abs() < 1e-6 && (plane - 0.189).abs() < 5e-4, "{volume}: {speed} {plane}");
        assert!(number(&found, "sinking_m_s").abs() < 1e-9, "{found}");
        assert!(found["remarks"].to_string().contains("neutral within the digits given"), "{found}");
    }
    // One per cent is no rounding, however few the digits.
    let found = swum(&changed(folder.path(), &[("\"1.310244e-3 m^3\"", "\"1.3e-3 m^3\"")]), &[]);
    assert!(found["remarks"].to_string().contains("not neutral") && number(&found, "sinking_m_s") > 0.0, "{found}");
    // The equilibrium is stated before the figures.
    let robot = changed(folder.path(), &[PITCH, LOW]);
    let output = froude(&[&["swim", text(&robot)], &GAIT[..]].concat());
    let told = String::from_utf8(output.stdout).unwrap();
    let (warned, figures) = (told.find("no stable equilibrium").unwrap(), told.find("speed, level").unwrap());
    assert!(warned < figures && told.matches("no stable equilibrium").count() == 1, "{told}");
    let output = froude(&["robot", "inspect", text(&robot), "--json"]);
    assert!(String::from_utf8(output.stdout).unwrap().contains("no stable equilibrium"));
}

/// A gait that is unstable in the plane: in three dimensions too it is the circle that is reported, with the plane's figures, and the straight motion stands beside.
#[test]
fn an_unstable_gait_settles_into_the_circle_of_the_plane() {
    let folder = tempfile::tempdir().unwrap();
    let record = (
        "circulation_tank_restricted.json\", select = \"circulation_tank_restricted/f2\"",
        "cfd.json\", select = \"cfd/f6\"",
    );
    let gait = ["--amplitude", "20 deg", "--phase", "60 deg"];
    let swum = |changes: &[(&str, &str)]| {
        let robot = changed(folder.path(), changes);
        let output = froude(&[&["swim", text(&robot), "--frequency", "80 deg/s", "--json"], &gait[..]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    // The mass lies 4 mm low: on the circle the head rolls by hundredths of a degree, which moves the figures by less than a thousandth.
    let space = swum(&[record, PITCH, EXACT]);
    let plane = swum(&[record, PITCH, EXACT, ("\"3d\"", "\"planar\"")]);
    for key in ["speed_m_s", "power_net_w"] {
        let [a, b] = [&space, &plane].map(|found| number(found, key));
        assert!((a / b - 1.0).abs() < 1e-3, "{key}: {a} {b}");
        let [a, b] = [&space, &plane].map(|found| number(&found["unstable_motion"], key));
        assert!((a / b - 1.0).abs() < 1e-5, "{key} of the unstable motion: {a} {b}");
    }
    let remarks = space["remarks"].to_string();
    assert!(remarks.contains("unstable: the swimmer settles into a circle of 3.79 m radius"), "{remarks}");
    // Where nothing rights it, no other motion is looked for, and that is said.
    let never = swum(&[record, PITCH, LOW, EXACT])["remarks"].to_string();
    assert!(never.contains("no other was looked for, because nothing rights the robot"), "{never}");
}
