//! Records at the verb: a unit that is written otherwise changes no answer, data are counted once, and no input is overwritten.

use std::path::{Path, PathBuf};

use crate::bench::{froude, text};
use serde_json::Value;

const GAIT: [&str; 6] = ["--amplitude", "30 deg", "--frequency", "80 deg/s", "--phase", "40 deg"];
const DRAG: &str = "circulation_tank_restricted/f2";
/// Relative: printed digits of a swim that a factor of 1000 and its inverse may move.
const SAME: f64 = 1e-9;

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

/// The published record of the drag with one number in another unit, and a robot that swims by it.
fn robot(folder: &Path, place: &[&str], factor: f64, unit: &str) -> PathBuf {
    let published = examples().join("mamba/published");
    let from = published.join("circulation_tank_restricted.json");
    let mut record: Value = serde_json::from_slice(&std::fs::read(from).unwrap()).unwrap();
    record.as_object_mut().unwrap().remove("checksum");
    let estimate = record["estimates"].as_array_mut().unwrap().iter_mut().find(|e| e["id"] == DRAG).unwrap();
    let mut number = estimate;
    for key in place {
        number = &mut number[*key];
    }
    number["value"] = (number["value"].as_f64().unwrap() * factor).into();
    number["unit"] = unit.into();
    std::fs::write(folder.join("drag.json"), serde_json::to_string_pretty(&record).unwrap()).unwrap();
    let robot = std::fs::read_to_string(examples().join("mamba-swim/robot.toml")).unwrap();
    let robot = robot.replacen("../mamba/published/circulation_tank_restricted.json", "drag.json", 1);
    let path = folder.join("robot.toml");
    std::fs::write(&path, robot.replace("../mamba/published", text(&published))).unwrap();
    path
}

fn swum(robot: &Path) -> f64 {
    let output = froude(&[&["swim", text(robot)], &GAIT[..], &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice::<Value>(&output.stdout).unwrap()["speed_m_s"].as_f64().unwrap()
}

/// The message of a command that rejects its input.
#[track_caller]
fn rejected(args: &[&str]) -> String {
    let output = froude(args);
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn a_robot_swims_as_fast_whatever_units_its_record_is_written_in() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let as_written = swum(&robot(here, &["coefficients", "C_d_I"], 1.0, "m/s"));
    let cases: [(&[&str], f64, &str); 4] = [
        (&["coefficients", "C_d_I"], 1000.0, "mm/s"),
        (&["geometry", "half_length"], 1000.0, "mm"),
        (&["geometry", "head_side_area"], 1e4, "cm^2"),
        (&["density"], 1e-3, "g/cm^3"),
    ];
    for (place, factor, unit) in cases {
        let found = swum(&robot(here, place, factor, unit));
        assert!((found / as_written - 1.0).abs() < SAME, "{place:?} in {unit}: {found} and {as_written} m/s");
    }
}

#[test]
fn every_verb_rejects_a_unit_that_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let path = robot(here, &["coefficients", "C_d_I"], 1.0, "nonsense");
    let record = here.join("drag.json");
    let line = 1 + std::fs::read_to_string(&record).unwrap().lines().position(|l| l.contains("nonsense")).unwrap();
    let table = here.join("tank.csv");
    std::fs::write(&table, TABLE).unwrap();
    let campaign = |name: &str, more: &str| {
        let path = here.join(name);
        let text = format!(
            "schema = 1\nname = \"units\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"tank\"\nkind = \"tank\"\ntable = \"tank.csv\"\n{more}"
        );
        std::fs::write(&path, text).unwrap();
        path
    };
    let entry = "coefficient = \"D_x_l\", record = \"drag.json\", entry = \"C_d_I\"";
    let tare = campaign("tare.toml", &format!("tare = {{ record = \"drag.json\", select = \"{DRAG}\" }}\n"));
    let prior = campaign("prior.toml", &format!("[identify]\nprior = [{{ {entry} }}]\n"));
    let known = campaign("known.toml", &format!("[identify]\nknown = [{{ {entry} }}]\n"));
    let truth = campaign(
        "truth.toml",
        &format!(
            "[[source.plan]]\nconfigurations = [\"H1LT\"]\nspeed = [\"0.1 m/s\"]\nangle = [\"0 deg\"]\n[simulate]\nseed = 1\nrecord = \"drag.json\"\nselect = \"{DRAG}\"\n"
        ),
    );
    // No twin replaces a measured table.
    let simulated = std::fs::read_to_string(&truth).unwrap().replace("table = \"tank.csv\"", "table = \"twin.csv\"");
    std::fs::write(&truth, simulated).unwrap();
    let gait = [&["swim", text(&path)], &GAIT[..]].concat();
    let verbs: [&[&str]; 9] = [
        &gait,
        &["robot", "inspect", text(&path)],
        &["predict", text(&record), text(&table)],
        &["compare", text(&record), text(&record)],
        &["inspect", text(&record)],
        &["identify", text(&tare)],
        &["identify", text(&prior)],
        &["identify", text(&known)],
        &["simulate", text(&truth)],
    ];
    for verb in verbs {
        let said = rejected(verb);
        let place = format!(
            "drag.json:{line}: estimate {DRAG}: the unit of coefficients.C_d_I is rejected: unknown unit `nonsense`"
        );
        assert!(said.contains(&place), "{verb:?}: {said}");
    }
}

/// A resistance of 2 kg/s · v + 8 kg/m · v², with errors of some hundredths of a newton.
const TABLE: &str = "speed [m/s],angle [deg],f_x [N]\n0.1,0,-0.30\n0.2,0,-0.70\n0.3,0,-1.34\n0.4,0,-2.06\n0.5,0,-3.03\n0.6,0,-4.06\n0.7,0,-5.35\n0.8,0,-6.70\n";
const OTHER: &str = "speed [m/s],angle [deg],f_x [N]\n0.1,0,-0.27\n0.2,0,-0.74\n0.3,0,-1.30\n0.4,0,-2.10\n0.5,0,-2.97\n0.6,0,-4.10\n0.7,0,-5.30\n0.8,0,-6.74\n";

/// A campaign over one table, with a prior from a record if there is one.
fn fitted(here: &Path, name: &str, prior: Option<&str>) -> Vec<String> {
    let campaign = here.join(format!("{name}.toml"));
    let prior = prior.map_or_else(String::new, |record| {
        format!("prior = [{{ coefficient = \"D_x_II\", record = \"{record}\", entry = \"D_x_II\", select = \"{}/resistance\" }}]\n", record_source(record))
    });
    let text = format!(
        "schema = 1\nname = \"{name}\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"{name}\"\nkind = \"tank\"\ntable = \"{name}.csv\"\n[identify]\nmodels = []\n{prior}[[identify.model]]\nname = \"resistance\"\nf_x = \"-D_x_I*v_x - D_x_II*v_x*abs(v_x)\"\n"
    );
    std::fs::write(&campaign, text).unwrap();
    vec!["identify".to_owned(), campaign.display().to_string()]
}

/// Source of the record of a campaign: its folder is called after it.
fn record_source(record: &str) -> &str {
    record.split('-').next().unwrap()
}

fn run(args: &[String], out: &Path) -> Result<f64, String> {
    let output = froude(&[&args[0], &args[1], "--out", text(out)]);
    if !output.status.success() {
        assert_eq!(output.status.code(), Some(2));
        return Err(String::from_utf8(output.stderr).unwrap());
    }
    let record: Value = serde_json::from_slice(&std::fs::read(out.join("estimate.json")).unwrap()).unwrap();
    Ok(record["estimates"][0]["coefficients"]["D_x_II"]["standard_uncertainty"].as_f64().unwrap())
}

#[test]
fn a_prior_is_never_counted_against_its_own_data() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("a.csv"), TABLE).unwrap();
    std::fs::write(here.join("b.csv"), OTHER).unwrap();
    run(&fitted(here, "a", None), &here.join("a-first")).unwrap();
    // Its own record, in the folder of its results and in another.
    let own = fitted(here, "a", Some("a-first/estimate.json"));
    let said = run(&own, &here.join("a-first")).unwrap_err();
    assert!(said.contains("estimate.json, which is read: results there would replace it"), "{said}");
    let said = run(&own, &here.join("a-second")).unwrap_err();
    let twice = "was itself fitted to a.csv, which this job fits again: the same data would count twice";
    assert!(
        said.contains("a.toml: prior: ") && said.contains("a-first/estimate.json") && said.contains(twice),
        "{said}"
    );
    assert!(!here.join("a-second").exists());
    // Through another campaign: b takes a's record, and a takes b's.
    let [alone, together] = [None, Some("a-first/estimate.json")].map(|prior| {
        run(&fitted(here, "b", prior), &here.join(if prior.is_some() { "b-second" } else { "b-first" })).unwrap()
    });
    assert!(together < alone, "a prior of other data: {together} and {alone}");
    let record: Value = serde_json::from_slice(&std::fs::read(here.join("b-second/estimate.json")).unwrap()).unwrap();
    let roles: Vec<(&str, &str)> = record["data"]
        .as_object()
        .unwrap()
        .values()
        .map(|data| (data["path"].as_str().unwrap(), data["role"].as_str().unwrap()))
        .collect();
    assert_eq!(
        roles,
        [("b.toml", "campaign"), ("b.csv", "table"), ("a-first/estimate.json", "record"), ("a.csv", "inherited")]
    );
    // Nor are the two compared as if they were independent.
    let [first, second] = ["a-first", "b-second"].map(|name| here.join(name).join("estimate.json"));
    let output = froude(&["compare", text(&first), text(&second)]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(said.contains("[same-data]") && said.contains("come from the same data"), "{said}");
    let said = run(&fitted(here, "a", Some("b-second/estimate.json")), &here.join("a-third")).unwrap_err();
    assert!(said.contains("b-second/estimate.json") && said.contains(twice), "{said}");
}

#[test]
fn no_result_takes_the_place_of_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let path = robot(here, &["coefficients", "C_d_I"], 1.0, "m/s");
    let out = here.join("swim");
    let swim = |robot: &Path| froude(&[&["swim", text(robot), "--out", text(&out)], &GAIT[..]].concat());
    assert!(swim(&path).status.success());
    // What was read is listed with its fingerprint.
    let result: Value = serde_json::from_slice(&std::fs::read(out.join("result.json")).unwrap()).unwrap();
    let read: Vec<(&str, &str)> = result["data"]
        .as_array()
        .unwrap()
        .iter()
        .map(|data| (data["role"].as_str().unwrap(), data["path"].as_str().unwrap().rsplit('/').next().unwrap()))
        .collect();
    assert_eq!(read, [("robot", "robot.toml"), ("drag", "drag.json")]);
    assert!(result["data"].as_array().unwrap().iter().all(|data| data["sha256"].as_str().unwrap().len() == 64));
    // A record in the folder of an earlier swim.
    std::fs::copy(here.join("drag.json"), out.join("drag.json")).unwrap();
    let moved = std::fs::read_to_string(&path).unwrap().replacen("drag.json", "swim/drag.json", 1);
    std::fs::write(&path, moved).unwrap();
    let output = swim(&path);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("drag.json, which is read: results there would replace it"), "{said}");
    assert!(out.join("drag.json").exists() && out.join("trajectory.parquet").exists());
    // Rows that were predicted, predicted again in place.
    std::fs::write(here.join("a.csv"), TABLE).unwrap();
    run(&fitted(here, "a", None), &here.join("a-first")).unwrap();
    let record = here.join("a-first/estimate.json");
    let out = here.join("predicted");
    assert!(froude(&["predict", text(&record), text(&here.join("a.csv")), "--out", text(&out)]).status.success());
    let mut written = std::fs::read_dir(&out).unwrap().map(|e| e.unwrap().path());
    let table = written.find(|path| path.extension().is_some_and(|e| e == "csv")).unwrap();
    let before = std::fs::read(&table).unwrap();
    let said = rejected(&["predict", text(&record), text(&table), "--out", text(&out)]);
    assert!(said.contains("which is read: results there would replace it"), "{said}");
    assert_eq!(std::fs::read(&table).unwrap(), before);
}
