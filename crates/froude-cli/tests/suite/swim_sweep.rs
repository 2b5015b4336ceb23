//! Sweeps of gaits at the verb: rows that are the single gaits, gaits without an answer, and a process that is killed.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::bench::{froude, text};
use froude::records::estimate::TypeA;
use froude::records::json::{read_estimates, write_estimates};
use froude::records::table_file::read_table;
use froude::records::units::Dimension;
use serde_json::Value;

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/mamba-swim/robot.toml")
}

/// The example with a record that states 5 % of each coefficient of f2 as its standard uncertainty, without correlation.
fn stated(folder: &Path) -> PathBuf {
    let published = example().parent().unwrap().join("../mamba/published/circulation_tank_restricted.json");
    let mut record = read_estimates(&published).unwrap();
    let e = record.estimates.iter_mut().find(|e| e.id == "circulation_tank_restricted/f2").unwrap();
    let names: Vec<String> = e.coefficients.keys().cloned().collect();
    let u: Vec<f64> = e.coefficients.values().map(|c| 0.05 * c.value.unwrap()).collect();
    let matrix = (0..u.len()).map(|i| (0..u.len()).map(|j| if i == j { u[i] * u[i] } else { 0.0 }).collect()).collect();
    e.type_a = Some(TypeA { dof: vec![None; names.len()], names, matrix, kind: "classical".to_owned() });
    write_estimates(&folder.join("stated.json"), &record).unwrap();
    let robot = std::fs::read_to_string(example()).unwrap();
    let path = folder.join("robot.toml");
    std::fs::write(&path, robot.replace("../mamba/published/circulation_tank_restricted.json", "stated.json")).unwrap();
    path
}

fn arguments<'a>(ranges: &'a str, out: &'a Path, robot: &'a Path) -> Vec<&'a str> {
    vec!["swim", text(robot), "--frequency", "80 deg/s", "--sweep", ranges, "--out", text(out), "--json"]
}

fn swept(ranges: &str, out: &Path) -> Value {
    let output = froude(&arguments(ranges, out, &example()));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A row is what the gait comes to alone, in the order of the ranges; beyond the limit of 90° it says so and the others go on.
#[test]
fn rows_are_the_gaits_alone_and_say_why_there_is_none() {
    let out = tempfile::tempdir().unwrap();
    let found = swept("amplitude=20..30 deg:2, phase=40..60 deg:3", out.path());
    let table = read_table(&out.path().join("sweep.parquet"), None).unwrap();
    let column = |name: &str, dimension| table.number(name, dimension).unwrap().to_vec();
    let (speed, phase) = (column("speed", Dimension::SPEED), column("phase", Dimension::ANGLE));
    assert_eq!((table.n_rows, found["rows"].as_u64()), (6, Some(6)));
    assert!((phase[1].to_degrees() - 50.0).abs() < 1e-12 && phase[0] == phase[3]);
    let alone = ["--amplitude", "30 deg", "--frequency", "80 deg/s", "--phase", "40 deg", "--json"];
    let alone: Value =
        serde_json::from_slice(&froude(&[&["swim", text(&example())], &alone[..]].concat()).stdout).unwrap();
    assert_eq!(alone["speed_m_s"].as_f64(), Some(speed[3]));
    assert_eq!(alone["power_positive_w"].as_f64(), Some(column("power_pos", Dimension::new(2, 1, -3))[3]));
    assert!(table.text("status").unwrap().iter().all(|status| status == "periodic"));
    let best = speed.iter().copied().fold(0.0, f64::max);
    assert_eq!(found["best"][0]["speed_m_s"].as_f64(), Some(best));

    let found = swept("amplitude=0..100 deg:3, phase=40..50 deg:2", out.path());
    let statuses: Value = serde_json::json!({"periodic": 2, "limit": 2, "still": 2});
    assert_eq!(found["statuses"], statuses, "{found}");
    assert!(found["remarks"].to_string().contains("2 of 6 gaits ask for more than the joints allow"), "{found}");
    // Whatever the order of the work: nothing is left beside the results and their list.
    let mut left: Vec<String> =
        std::fs::read_dir(out.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    left.sort();
    assert_eq!(left, ["froude-files.json", "report.html", "result.json", "sweep.parquet"]);
    // Two axes are maps with the best gait marked and gaits without an answer hatched; one axis is lines.
    let page = || std::fs::read_to_string(out.path().join("report.html")).unwrap();
    for part in ["Map of speed [m/s]", "Map of cost of transport [J/m]", "fastest", "Hatched: gaits without an answer"]
    {
        assert!(page().contains(part), "{part}");
    }
    swept("amplitude=20..30 deg:3, phase=40..41 deg:2", out.path());
    let record: Value = serde_json::from_slice(&std::fs::read(out.path().join("result.json")).unwrap()).unwrap();
    assert_eq!(record["rows"].as_u64(), Some(6));
    let robot = example();
    let lines = ["swim", text(&robot), "--frequency", "80 deg/s", "--phase", "40 deg", "--sweep"];
    let output = froude(&[&lines[..], &["amplitude=20..30 deg:3", "--out", text(out.path())]].concat());
    assert!(output.status.success() && page().contains("Speed, power and cost over the amplitude"));
}

/// Gaits that repeat and need more than a motor gives have figures, and none of them is the fastest.
#[test]
fn gaits_beyond_the_drives_are_neither_fastest_nor_cheapest() {
    let out = tempfile::tempdir().unwrap();
    let motor = out.path().join("motor.toml");
    std::fs::write(&motor, "schema = 1\ncurve = [[\"0 rpm\", \"0.5 N m\"], [\"60 rpm\", \"0 N m\"]]\n").unwrap();
    let (robot, ranges) = (example(), "amplitude=10..40 deg:4, phase=40..60 deg:2");
    let output =
        froude(&[&arguments(ranges, &out.path().join("map"), &robot)[..], &["--motor", text(&motor)]].concat());
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let (drives, periodic) =
        (found["statuses"]["drives"].as_u64().unwrap(), found["statuses"]["periodic"].as_u64().unwrap());
    assert!(drives > 0 && periodic > 0 && drives + periodic == 8, "{found}");
    assert!(found["best"][0]["torque_peak_n_m"].as_f64().unwrap() < 0.5, "{found}");
    let table = read_table(&out.path().join("map/sweep.parquet"), None).unwrap();
    assert!(table.number("speed", Dimension::SPEED).unwrap().iter().all(|u| *u > 0.0));
}

#[test]
fn what_cannot_be_swept_is_refused() {
    let out = tempfile::tempdir().unwrap();
    let refused = |ranges: &str, more: &[&str]| {
        let output = froude(&[&arguments(ranges, out.path(), &example())[..], more].concat());
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    let twice = refused("amplitude=10..50 deg:3", &["--amplitude", "20 deg"]);
    assert!(twice.contains("swept already"), "{twice}");
    let missing = refused("amplitude=10..50 deg:3", &[]);
    assert!(missing.contains("--phase '40 deg'"), "{missing}");
    let many = refused("amplitude=10..50 deg:10000, phase=10..80 deg:10000", &[]);
    assert!(many.contains("100000000 rows") && many.contains("1000000"), "{many}");
}

/// Intervals of a gait hold its figures, are those of the sweep's draws, and are not there where a published table states no covariance.
#[test]
fn draws_become_intervals_and_say_what_to_measure_next() {
    let folder = tempfile::tempdir().unwrap();
    let robot = stated(folder.path());
    let gait =
        ["--amplitude", "30 deg", "--frequency", "80 deg/s", "--phase", "40 deg", "--draws", "100", "--sensitivity"];
    let out = folder.path().join("out");
    let output = froude(&[&["swim", text(&robot), "--json", "--out", text(&out)], &gait[..]].concat());
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    // What the terminal says, record and page hold too.
    let record: Value = serde_json::from_slice(&std::fs::read(out.join("result.json")).unwrap()).unwrap();
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(record == found && page.contains("95 %") && page.contains("amplitude"), "{record}");
    let draws = &found["uncertainty"]["draws"];
    assert_eq!((draws["n"].as_u64(), draws["refused"].as_u64()), (Some(100), Some(0)), "{found}");
    for key in ["speed_m_s", "power_net_w", "cost_of_transport_j_m"] {
        let ends = draws["interval_95"][key].as_array().unwrap();
        let (low, high, value) = (ends[0].as_f64().unwrap(), ends[1].as_f64().unwrap(), found[key].as_f64().unwrap());
        // 5 % of each coefficient move each figure by less than 10 %.
        assert!(low < value && value < high && high - low < 0.4 * value, "{key} {found}");
    }
    let of = &found["uncertainty"]["sensitivities"];
    let known: Vec<f64> = of["coefficients"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|c| c["speed"]["variance_gone_if_known"].as_f64())
        .collect();
    // Not correlated: the parts are all of it.
    assert!((known.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{of}");

    let out = folder.path().join("out");
    let ranges = "amplitude=25..30 deg:2, phase=40..50 deg:2";
    let output = froude(&[&arguments(ranges, &out, &robot)[..], &["--draws", "100"]].concat());
    let swept: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((swept["gaits"].as_u64(), swept["rows"].as_u64()), (Some(4), Some(404)), "{swept}");
    let table = read_table(&out.join("sweep.parquet"), None).unwrap();
    let speed = table.number("speed", Dimension::SPEED).unwrap();
    let draw = table.number("draw", Dimension::ONE).unwrap();
    assert_eq!((draw[202], draw[203], draw[302]), (0.0, 1.0, 100.0));
    let mut of_gait = speed[203..303].to_vec();
    of_gait.sort_by(f64::total_cmp);
    // The place 0.025 of 101, counted from 1: 2.525.
    let low = of_gait[1] + 0.525 * (of_gait[2] - of_gait[1]);
    assert!((draws["interval_95"]["speed_m_s"][0].as_f64().unwrap() - low).abs() < 1e-12);

    let output = froude(&[&["swim", text(&example())], &gait[..]].concat());
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && told.contains("nothing can be drawn"), "{told}");
    let output = froude(&[&["swim", text(&example())], &gait[..6], &["--sensitivity"]].concat());
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(told.contains("the records state no uncertainty"), "{told}");
}

/// A front between the grid's points beats the grid, is the same each time, and says with what probability one gait is better than the next.
#[test]
fn a_front_is_refined_and_compared_by_paired_draws() {
    let folder = tempfile::tempdir().unwrap();
    let robot = stated(folder.path());
    let found = |out: &str, more: &[&str]| -> (Value, Vec<u8>) {
        let out = folder.path().join(out);
        let ranges = "amplitude=20..40 deg:3, phase=30..60 deg:3";
        let output = froude(&[&arguments(ranges, &out, &robot)[..], more].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let file = ["front.parquet", "sweep.parquet"].map(|name| out.join(name)).into_iter().find(|p| p.exists());
        (serde_json::from_slice(&output.stdout).unwrap(), std::fs::read(file.unwrap()).unwrap())
    };
    let (grid, _) = found("grid", &[]);
    let (front, bytes) = found("front", &["--optimise", "speed,power", "--draws", "100"]);
    assert_eq!(found("again", &["--optimise", "speed,power", "--draws", "100"]).1, bytes);
    let gaits = front["gaits"].as_array().unwrap();
    let number = |gait: &Value, key: &str| gait[key].as_f64().unwrap();
    assert!(gaits.len() == 12 && front["front_gaits"].as_u64().unwrap() >= 12, "{front}");
    assert!(number(&gaits[0], "speed_m_s") >= number(&grid["best"][0], "speed_m_s"));
    for pair in gaits.windows(2) {
        assert!(["speed_m_s", "power_net_w"].iter().all(|key| number(&pair[0], key) > number(&pair[1], key)));
        // Faster by the estimate is faster by most draws, and takes more power by most.
        let p = &pair[0]["better_than_next"];
        assert!(number(p, "speed") > 0.5 && number(p, "power") < 0.5, "{pair:?}");
    }
    let output = froude(
        &[
            &arguments("amplitude=20..40 deg:3", folder.path(), &robot)[..],
            &["--phase", "40 deg", "--optimise", "speed,speed"],
        ]
        .concat(),
    );
    assert!(String::from_utf8(output.stderr).unwrap().contains("not two different objectives"));
}

/// Folder of the parts, and how many are whole.
fn parts(out: &Path) -> Option<(PathBuf, usize)> {
    let is_parts = |p: &PathBuf| p.file_name().unwrap().to_string_lossy().starts_with(".sweep-");
    let folder = std::fs::read_dir(out).ok()?.flatten().map(|e| e.path()).find(is_parts)?;
    let whole = std::fs::read_dir(&folder).ok()?.flatten().filter(|e| is_whole(&e.path())).count();
    Some((folder, whole))
}

/// Whether it is a part and no file of a writer that was killed.
fn is_whole(path: &Path) -> bool {
    let name = path.file_name().unwrap().to_string_lossy();
    name.len() == 6 && name.bytes().all(|b| b.is_ascii_digit())
}

/// SIGKILL once so many parts are whole; `false` where it came to its end before.
fn killed(ranges: &str, out: &Path, at: usize) -> bool {
    let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
        .args(arguments(ranges, out, &example()))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    loop {
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        if parts(out).is_some_and(|(_, whole)| whole >= at) {
            child.kill().unwrap();
            child.wait().unwrap();
            return true;
        }
        std::thread::sleep(Duration::from_micros(200));
    }
}

/// Killed at its beginning, three times on its way and while its parts become the table: the table is that of a sweep that nobody killed.
#[test]
fn a_sweep_that_is_killed_goes_on_and_is_the_same_to_the_byte() {
    let ranges = "amplitude=15..45 deg:12, phase=20..70 deg:12";
    let whole = tempfile::tempdir().unwrap();
    assert_eq!(swept(ranges, whole.path())["resumed_rows"], 0);
    let expected = std::fs::read(whole.path().join("sweep.parquet")).unwrap();
    // 144 gaits in 72 parts.
    for kills in [&[0][..], &[20, 40, 60], &[72]] {
        let out = tempfile::tempdir().unwrap();
        let mut last = 0;
        for at in kills {
            if killed(ranges, out.path(), *at) {
                last = parts(out.path()).map_or(0, |(_, whole)| whole);
            }
        }
        // A part that is cut off; beside it there may be a file of a writer that was killed.
        if let Some((folder, _)) = parts(out.path()).filter(|_| last > 1) {
            let part = std::fs::read_dir(&folder).unwrap().flatten().map(|e| e.path());
            let part = part.filter(|p| is_whole(p)).min().unwrap();
            let bytes = std::fs::read(&part).unwrap();
            std::fs::write(&part, &bytes[..bytes.len() / 2]).unwrap();
            last -= 1;
        }
        let found = swept(ranges, out.path());
        assert_eq!(std::fs::read(out.path().join("sweep.parquet")).unwrap(), expected, "{kills:?}");
        if last < 72 {
            assert_eq!(found["resumed_rows"].as_u64(), Some(2 * last as u64), "{kills:?}");
        }
        assert!(parts(out.path()).is_none());
    }
    // Other gaits take nothing of what is there, and leave it.
    let out = tempfile::tempdir().unwrap();
    assert!(killed(ranges, out.path(), 5));
    let other = swept("amplitude=15..45 deg:3, phase=20..70 deg:2", out.path());
    assert_eq!(other["resumed_rows"], 0);
    assert!(other["remarks"].to_string().contains("holds an unfinished sweep"), "{other}");
    assert!(parts(out.path()).is_some());
}
