//! A robot of three dimensions, with joints one by one, and what it cannot be.

use std::path::Path;

use super::*;

fn read(text: &str) -> Result<RobotFile, RecordError> {
    parse_robot(Path::new("robot.toml"), text)
}

const SPATIAL: &str = r#"schema = 1
[fluid]
density = "1025 kg/m^3"
[coefficients]
drag = { record = "Cargo.toml", select = "tank/f2" }
added_mass = { surge = "0.1 kg", sway = "1.653 kg", heave = "0.742 kg", roll = "2e-4 kg m^2", pitch = "2e-3 kg m^2", yaw = "4.463e-3 kg m^2", sway_yaw = "0.01 kg m" }
[model]
space = "3d"
heave_drag = 0.5
roll_drag = { linear = "1e-3 N m s/rad", quadratic = "2e-3 N m s^2/rad^2" }
[[module]]
name = "head"
major_semi_axis = "58.8 mm"
minor_semi_axis = "39.4 mm"
half_length = "90 mm"
mass = "1.343 kg"
volume = "1.31e-3 m^3"
center_of_mass = ["0 mm", "1 mm", "5 mm"]
center_of_buoyancy = ["0 mm", "0 mm", "-5 mm"]
inertia = { roll = "1.7e-3 kg m^2", pitch = "4.8e-3 kg m^2", yaw = "4.1e-3 kg m^2" }
[[module]]
name = "link"
count = 3
major_semi_axis = "58.8 mm"
minor_semi_axis = "39.4 mm"
half_length = "90 mm"
mass = "1.343 kg"
volume = "1.31e-3 m^3"
[[joint]]
limit = "90 deg"
[[joint]]
index = 2
axis = "pitch"
torque = "2 N m"
[[joint]]
between = ["head", "link"]
limit = "45 deg"
"#;

#[test]
fn a_robot_of_three_dimensions_is_read() {
    let robot = read(SPATIAL).unwrap();
    assert!(robot.model.is_3d);
    assert_eq!((robot.model.heave_drag, robot.model.roll_drag), (Some(0.5), [1e-3, 2e-3]));
    let AddedFile::Declared(added) = &robot.added_mass else { panic!("{:?}", robot.added_mass) };
    assert_eq!((added[2][2], added[1][5], added[5][1]), (0.742, 0.01, 0.01));
    let head = &robot.modules[0];
    assert_eq!((head.centre_of_mass_m, head.centre_of_buoyancy_m), ([0.0, 0.001, 0.005], [0.0, 0.0, -0.005]));
    assert_eq!(head.inertia_kg_m2, [1.7e-3, 4.8e-3, 4.1e-3]);
    assert_eq!(robot.axes, [Axis::Yaw, Axis::Pitch, Axis::Yaw]);
    let limits: Vec<f64> = robot.joints.iter().filter_map(|j| Some(j.limits.angle_rad?.to_degrees().round())).collect();
    assert_eq!(limits, [45.0, 90.0, 90.0]);
    assert_eq!([0, 1].map(|i| robot.joints[i].limits.torque_n_m), [None, Some(2.0)]);
    // The same robot in the plane, but for what leaves it.
    let flat =
        SPATIAL.replace("\"3d\"", "\"planar\"").replace("\"1 mm\"", "\"0 mm\"").replace("axis = \"pitch\"\n", "");
    assert_eq!(read(&flat).unwrap().modules[0].inertia_kg_m2[2], 4.1e-3);
}

#[test]
fn what_three_dimensions_cannot_be_is_reported_with_its_place() {
    let refused = |from: &str, to: &str| {
        assert!(SPATIAL.contains(from), "{from}");
        read(&SPATIAL.replacen(from, to, 1)).unwrap_err().to_string()
    };
    let fat = refused("roll = \"1.7e-3", "roll = \"17e-3");
    assert!(
        fat.starts_with("robot.toml:20:11") && fat.contains("0.017 kg m² of roll") && fat.contains("0.0089"),
        "{fat}"
    );
    let pair = refused("\"0.01 kg m\"", "\"0.09 kg m\"");
    assert!(pair.starts_with("robot.toml:6") && pair.contains("at most 0.0858"), "{pair}");
    assert!(refused("heave = \"0.742 kg\", ", "").contains("all six"));
    assert!(refused("heave = \"0.742 kg\"", "heave = \"-0.742 kg\"").contains("zero or more"));
    assert!(refused("roll = \"1.7e-3 kg m^2\"", "roll = \"-1.7e-3 kg m^2\"").contains("larger than zero"));
    assert!(refused("space = \"3d\"", "space = \"3d\"\nadded_mass = \"usr\"").contains("plane only"));
    assert!(refused("space = \"3d\"", "space = \"3d\"\ndrag = \"lumped\"\ntorque = \"none\"").contains("strips only"));
    assert!(refused("volume = \"1.31e-3 m^3\"\n", "").contains("displaces"));
    assert!(refused("\"-5 mm\"]", "\"-60 mm\"]").contains("-0.06 m down"));
    assert!(refused("space = \"3d\"", "space = \"planar\"").contains("to starboard"));
    assert!(refused("index = 2", "index = 4").contains("joints 1 to 3"));
    assert!(refused("index = 2", "index = 1").contains("joint 1 again"));
    assert!(refused("[\"head\", \"link\"]", "[\"link\", \"head\"]").contains("head, link, link, link"));
    assert!(refused("index = 2\n", "").contains("second table without"));
    assert!(refused("torque = \"2 N m\"", "kp = \"4 N m/rad\"\nkd = \"1 N m s/rad\"").contains("joint 1 has none"));
    assert!(refused("torque = \"2 N m\"", "efficiency = 0.5").contains("efficiency"));
    let flat = SPATIAL.replace("\"3d\"", "\"planar\"").replace("\"1 mm\"", "\"0 mm\"");
    assert!(read(&flat).unwrap_err().to_string().contains("joints of a plane yaw"));
}

proptest::proptest! {
    /// Lines that are lost, doubled or torn, and values of other keys: a robot or a sentence with its place, and no panic.
    #[test]
    fn a_damaged_file_is_a_robot_or_a_sentence(
        damages in proptest::collection::vec((0_usize..36, 0_usize..36, 0_u8..5, 0_usize..200), 1..4)
    ) {
        let mut lines: Vec<String> = SPATIAL.lines().map(str::to_owned).collect();
        for (at, other, kind, cut) in damages {
            let (at, other) = (at % lines.len(), other % lines.len());
            let value = lines[other].split_once('=').map_or("", |(_, value)| value).to_owned();
            match kind {
                0 => lines[at] = String::new(),
                1 => lines.insert(at, lines[other].clone()),
                2 => lines[at] = lines[at].chars().take(cut).collect(),
                3 => {
                    if let Some((key, _)) = lines[at].clone().split_once('=') {
                        lines[at] = format!("{key}={value}");
                    }
                }
                _ => {
                    let digit = ["0", "9", "-1", "1e300", "nan"][cut % 5];
                    lines[at] = lines[at].replace(|c: char| c.is_ascii_digit(), digit);
                }
            }
        }
        match read(&lines.join("\n")) {
            Ok(robot) => {
                proptest::prop_assert_eq!([robot.joints.len(), robot.axes.len()], [robot.modules.len() - 1; 2]);
                proptest::prop_assert!(robot.modules.iter().all(|m| m.inertia_kg_m2.iter().all(|i| *i > 0.0)));
            }
            Err(error) => proptest::prop_assert!(error.to_string().starts_with("robot.toml"), "{}", error),
        }
    }
}
