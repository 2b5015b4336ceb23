//! A robot swims at the verb: figures of an independent program, a trajectory that closes its energy, and what is refused.

use std::path::{Path, PathBuf};

use crate::bench::{froude, text};
use froude::records::table_file::read_table;
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
    let out = folder.path().join("still");
    let still = swum(&example(), &["--out", text(&out)]);
    let table = read_table(&out.join("trajectory.parquet"), None).unwrap();
    // What the terminal says, the record holds too; the page stands by itself.
    let record: Value = serde_json::from_slice(&std::fs::read(out.join("result.json")).unwrap()).unwrap();
    assert_eq!(record, still);
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    for part in ["0.1899", "Figure 6", "angle to the flow [deg]", "torque [N m]"] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("http://") || page.matches("http://").count() == page.matches("http://www.w3.org").count());
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

const SERVO: &str = "limit = \"90 deg\"\nkp = \"40 N m/rad\"\nkd = \"1 N m s/rad\"\nefficiency = 0.6\nfriction = { viscous = \"0.02 N m s/rad\" }";

/// Servos come near the exact gait, take more from the battery than they give, and refuse a step beyond 2.785 over the largest eigenvalue of k_d and inertia with the one that would do.
#[test]
fn servos_swim_and_refuse_a_step_that_is_not_stable() {
    let folder = tempfile::tempdir().unwrap();
    let exact = swum(&example(), &[]);
    let robot = changed(folder.path(), "limit = \"90 deg\"", SERVO);
    let out = folder.path().join("servo");
    let found = swum(&robot, &["--out", text(&out)]);
    assert!((number(&found, "speed_m_s") / number(&exact, "speed_m_s") - 1.0).abs() < 0.05, "{found}");
    let balance = number(&found, "power_loss_w") + number(&found, "power_friction_w");
    assert!((balance / number(&found, "power_net_w") - 1.0).abs() < 1e-4, "{found}");
    // Nothing goes back to the battery.
    let electric = number(&found, "power_positive_w") / 0.6;
    assert!((number(&found, "power_electric_w") / electric - 1.0).abs() < 1e-12, "{found}");
    let table = read_table(&out.join("trajectory.parquet"), None).unwrap();
    let residuals = table.number("energy_residual", Dimension::new(2, 1, -2)).unwrap();
    let last = *table.number("time", Dimension::TIME).unwrap().last().unwrap();
    assert!(residuals.iter().all(|r| r.abs() < 1e-6 * number(&found, "power_net_w") * last), "{residuals:?}");

    // A limit below what they reach is said.
    let narrow = changed(
        folder.path(),
        "limit = \"90 deg\"",
        &SERVO.replace("90 deg", "30.5 deg").replace("= \"1 N m s", "= \"0.1 N m s"),
    );
    let beyond = swum(&narrow, &[]);
    assert!(beyond["remarks"].to_string().contains("beyond the joints: servos take a joint to"), "{beyond}");
    changed(folder.path(), "limit = \"90 deg\"", SERVO);

    let servo = &found["servo"];
    let (eigenvalue, longest) = (number(servo, "damping_eigenvalue_per_s"), number(servo, "longest_stable_step_s"));
    let slow = refused(&robot, &[&GAIT[..], &["--step", "50 ms"]].concat());
    let by_damping = format!("2.785/{eigenvalue:.6}");
    assert!(slow.contains("0.05 s is not stable") && slow.contains(&by_damping), "{slow}");
    let would_do = slow.split("--step '").nth(1).unwrap().split('\'').next().unwrap();
    let taken = swum(&robot, &["--step", would_do]);
    assert!((number(&taken, "speed_m_s") / number(&found, "speed_m_s") - 1.0).abs() < 1e-3, "{taken}");
    assert!(would_do.trim_end_matches(" s").parse::<f64>().unwrap() <= longest * 1.001, "{would_do}");
}

/// A curve that gives what the gait needs allows it up to a frequency at which it needs all of it; a weak one is said to be beyond, with how far.
#[test]
fn a_motor_says_how_fast_a_gait_may_be() {
    let folder = tempfile::tempdir().unwrap();
    let motor = folder.path().join("motor.toml");
    let write =
        |curve: &str| std::fs::write(&motor, format!("schema = 1\ncurve = {curve}\nefficiency = 0.5\n")).unwrap();
    write("[[\"0 rpm\", \"3 N m\"], [\"60 rpm\", \"0 N m\"]]");
    let found = swum(&example(), &["--motor", text(&motor)]);
    assert!(number(&found, "motor_share_peak") < 1.0, "{found}");
    let fastest = format!("{} rad/s", number(&found, "motor_fastest_rad_s"));
    let args =
        ["--amplitude", "30 deg", "--frequency", &fastest, "--phase", "40 deg", "--motor", text(&motor), "--json"];
    let output = froude(&[&["swim", text(&example())], &args[..]].concat());
    let at_most: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!((number(&at_most, "motor_share_peak") - 1.0).abs() < 0.01, "{at_most}");
    write("[[\"0 rpm\", \"0.1 N m\"], [\"60 rpm\", \"0 N m\"]]");
    let weak = swum(&example(), &["--motor", text(&motor)]);
    assert!(weak["remarks"].to_string().contains("beyond the motors"), "{weak}");
    write("[[\"0 rpm\", \"0.1 N m\"]]");
    let none = refused(&example(), &[&GAIT[..], &["--motor", text(&motor)]].concat());
    assert!(none.contains("motor.toml:2:9") && none.contains("two at least"), "{none}");
}

/// A gait file is what was typed; a trajectory that starts elsewhere begins there; its joint angles, recorded, swim the same way again.
#[test]
fn gait_files_starts_and_recordings_swim() {
    let folder = tempfile::tempdir().unwrap();
    let gait = folder.path().join("gait.toml");
    let wave = "schema = 1\nkind = \"lateral\"\namplitude = \"30 deg\"\nfrequency = \"80 deg/s\"\n";
    std::fs::write(&gait, format!("{wave}phase = \"40 deg\"\nramp = \"3 s\"\n")).unwrap();
    let start = "[start]\nplace = [\"1 m\", \"2 m\"]\nheading = \"90 deg\"\n[joint]";
    let robot = changed(folder.path(), "[joint]", start);
    let args = |more: &[&str]| -> Value {
        let output = froude(&[&["swim", text(&robot), "--json"], more].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let out = folder.path().join("from-rest");
    let found = args(&["--gait", text(&gait), "--out", text(&out), "--periods", "3"]);
    assert_eq!(found["speed_m_s"], swum(&example(), &[])["speed_m_s"]);
    let table = read_table(&out.join("trajectory.parquet"), None).unwrap();
    let column = |name: &str, dimension| table.number(name, dimension).unwrap().to_vec();
    let (heading, phi) = (column("heading", Dimension::ANGLE), column("phi_1", Dimension::ANGLE));
    assert_eq!((heading[0], phi[0]), (std::f64::consts::FRAC_PI_2, 0.0));
    // Nine modules behind the head, which is at y = 2 m and looks along y.
    assert!((column("y", Dimension::LENGTH)[0] - (2.0 - 4.5 * 0.18)).abs() < 1e-12);
    let track = args(&["--track", text(&out.join("trajectory.parquet"))]);
    let end = |name| *column(name, Dimension::LENGTH).last().unwrap() - column(name, Dimension::LENGTH)[0];
    let speed = end("x").hypot(end("y")) / number(&track, "length_s");
    assert!((number(&track, "speed_m_s") / speed - 1.0).abs() < 1e-4, "{track} {speed}");

    let none = refused(&robot, &["--gait", text(&gait), "--amplitude", "100 deg"]);
    assert!(none.contains("100 deg at joint 1"), "{none}");
    let missing = refused(&robot, &["--amplitude", "30 deg", "--phase", "40 deg"]);
    assert!(missing.contains("--frequency '80 deg/s'"), "{missing}");
    std::fs::write(&gait, wave).unwrap();
    let missing = refused(&robot, &["--gait", text(&gait)]);
    assert!(missing.contains("gait.toml has no phase") || missing.contains("gait.toml: has no phase"), "{missing}");
    std::fs::write(&gait, format!("{wave}phase = \"1 deg\"\n").replace("lateral\"", "envelope\"\nenvelope = [1, 2]"))
        .unwrap();
    let few = refused(&robot, &["--gait", text(&gait)]);
    assert!(few.contains("2 factors") && few.contains("9 joints"), "{few}");
}

/// The page's own numbers, in metres and newtons: neighbours meet at their joint, the centre of mass goes as the trajectory has it, and the drag of a motion that repeats has no mean.
#[test]
fn an_animation_is_to_scale_and_loads_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let named = changed(folder.path(), "\"Mamba, ten links\"", "\"</script><b>{{DATA}}\"");
    let out = folder.path().join("out");
    swum(&named, &["--out", text(&out)]);
    let page = std::fs::read_to_string(out.join("animation.html")).unwrap();
    assert!(page.len() < 2_000_000, "{} bytes", page.len());
    for far in ["http:", "https:", "src=", "href=", "@import", "url(", "fetch("] {
        assert!(!page.contains(far), "{far}");
    }
    assert!(page.contains("default-src 'none'") && page.contains("&lt;/script&gt;") && !page.contains("<b>"));
    let data = page.split("type=\"application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
    let data: Value = serde_json::from_str(data).unwrap();
    let unit = number(&data, "length_unit_m");
    let list = |key: &str, frame: usize| -> Vec<f64> {
        data[key][frame].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
    };
    let table = read_table(&out.join("trajectory.parquet"), None).unwrap();
    let (x, y) = (table.number("x", Dimension::LENGTH).unwrap(), table.number("y", Dimension::LENGTH).unwrap());
    assert_eq!(data["centre"].as_array().unwrap().len(), x.len());
    for frame in [0, 37, 500] {
        let (place, heading, centre) = (list("place", frame), list("heading_mrad", frame), list("centre", frame));
        // Half a unit of each number.
        assert!((centre[0] * unit - x[frame]).hypot(centre[1] * unit - y[frame]) < unit);
        let end = |i: usize, way: f64| {
            let (s, c) = (heading[i] * 1e-3).sin_cos();
            [place[2 * i] * unit + way * 0.09 * c, place[2 * i + 1] * unit + way * 0.09 * s]
        };
        for i in 0..9 {
            let (aft, fore) = (end(i, -1.0), end(i + 1, 1.0));
            // Two units of places, and half a milliradian of 90 mm twice.
            assert!((aft[0] - fore[0]).hypot(aft[1] - fore[1]) < 2.0 * unit + 9e-5, "{i}: {aft:?} {fore:?}");
        }
    }
    // Over periods that repeat, drag and what takes the water along leave no mean force: the mean drag is a small part of its largest.
    let parts = |axis: usize| -> (f64, f64) {
        let sums = (0..100).map(|frame| list("force", frame).iter().skip(axis).step_by(2).sum::<f64>());
        sums.fold((0.0, 0.0), |(sum, most), f| (sum + f / 100.0, f64::max(most, f.abs())))
    };
    for axis in 0..2 {
        let (mean, most) = parts(axis);
        assert!(mean.abs() < 0.01 * most, "axis {axis}: {mean} of {most}");
    }
}

/// f6 of CFD at 20 deg and 60 deg of phase: straight swimming at 0.1007 m/s and 3.04 mW is unstable (multiplier 1.12). The figures are those of the motion that it settles into, and 600 periods from a start a little aside end on it.
#[test]
fn an_unstable_gait_is_reported_as_the_motion_it_settles_into() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let record = "circulation_tank_restricted.json\", select = \"circulation_tank_restricted/f2\"";
    let robot = changed(folder.path(), record, "cfd.json\", select = \"cfd/f6\"");
    let toml = std::fs::read_to_string(&robot).unwrap();
    let aside = "velocity = [\"0.1 m/s\", \"-0.002 m/s\"]\nturn_rate = \"0 deg/s\"\n";
    std::fs::write(&robot, format!("{toml}\n[start]\nplace = [\"0 m\", \"0 m\"]\nheading = \"0 deg\"\n{aside}"))
        .unwrap();
    let gait = ["--frequency", "80 deg/s", "--phase", "60 deg"];
    let run = |more: &[&str]| {
        let output = froude(&[&["swim", text(&robot)], &gait[..], more].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let amplitude = ["--amplitude", "20 deg"];
    let out = at("long");
    let answer = run(&[&amplitude[..], &["--periods", "600", "--out", text(&out), "--json"]].concat());
    let found: Value = serde_json::from_str(&answer).unwrap();
    let left = &found["unstable_motion"];
    for (key, expected) in [("speed_m_s", 0.1007), ("power_net_w", 3.042e-3)] {
        assert!((number(left, key) / expected - 1.0).abs() < 1e-3, "{left}");
    }
    assert!(left["floquet_multipliers"][0].as_f64().unwrap() > 1.1, "{left}");
    assert!(found["floquet_multipliers"][0].as_f64().unwrap() < 1.0, "{found}");
    let table = read_table(&out.join("trajectory.parquet"), None).unwrap();
    let last = |name: &str, dimension: Dimension| {
        let si = table.number(name, dimension).unwrap();
        si[si.len() - 1] - si[si.len() - 101]
    };
    // Turn and power are those of its mirror image too, on which it may end.
    let turn = last("heading", Dimension::ONE) / number(&found, "turn_per_period_rad");
    assert!((turn.abs() - 1.0).abs() < 1e-6, "{turn} {found}");
    let power = table.number("power_net", Dimension::new(2, 1, -3)).unwrap();
    let power = power[power.len() - 100..].iter().sum::<f64>() / 100.0 / number(&found, "power_net_w");
    assert!((power - 1.0).abs() < 1e-6, "{power} {found}");
    // The word comes first, and the unstable figures stand beside the others.
    let answer = run(&amplitude);
    assert!(answer.contains("settles into a circle of 3.68 m radius or its mirror image"), "{answer}");
    assert!(answer.find("unstable: ").unwrap() < answer.find("net power").unwrap(), "{answer}");
    assert!(answer.contains("speed of the unstable motion"), "{answer}");
    // A sweep has both, and ranks gaits by the motion that they settle into.
    let out = at("sweep");
    let swept = run(&["--sweep", "amplitude=20..20.1 deg:2", "--out", text(&out)]);
    assert!(swept.contains("2 gaits leave an unstable motion"), "{swept}");
    let table = read_table(&out.join("sweep.parquet"), None).unwrap();
    for (column, expected) in [("unstable_speed", 0.1007), ("speed", number(&found, "speed_m_s"))] {
        let speed = table.number(column, Dimension::new(1, 0, -1)).unwrap()[0];
        assert!((speed / expected - 1.0).abs() < 1e-3, "{column}: {speed}");
    }
}
