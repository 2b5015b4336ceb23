//! What people and programs read of every verb that returns blocks is the same: each number of a table stands in the JSON at its key, in the SI unit that
//! the key ends in, and rounds to what is shown; and the published schema of the verb is that of its blocks.

use std::path::{Path, PathBuf};

use froude::carriage::drive::{DriveJob, drive, prepare};
use froude::carriage::tune::{find_resonance, tune};
use froude::demo;
use froude::identify::method::Method;
use froude::identify::prediction;
use froude::inspect::inspect;
use froude::methods::added_mass::options::Asked;
use froude::methods::added_mass::verb::{check, put_right};
use froude::methods::carriage::axis::source::Servo;
use froude::methods::carriage::drag::calibration::source::KnownWeights;
use froude::pipeline::{self, Input, identify};
use froude::plan::plan;
use froude::records::given_option::GivenOption;
use froude::report::write::{write_files, write_folder};
use froude::rig::campaign::runner::{Operator, Progress};
use froude::rig::campaign::stop::StopSwitch;
use froude::rig::carriage::plan::PlannedRun;
use froude::rig::drive::Sample;
use froude::swim::front::Objective;
use froude::swim::gait::{Envelope, Gait};
use froude::swim::sweep::Axis;
use froude::swim::verb::{Job, Moves, Pitching, Ranges, SweepJob, look, optimise, sweep, swim};
use froude::twin::simulate;

use crate::held::{holds, of_verb};

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name)
}

fn gait() -> Gait {
    let [amplitude, frequency, phase] = [30_f64, 80.0, 40.0].map(f64::to_radians);
    Gait::wave(amplitude, frequency, phase, Envelope::Lateral)
}

#[test]
fn robots_and_swimmers() {
    let folder = tempfile::tempdir().unwrap();
    let (mut looks, mut swims) = (Vec::new(), Vec::new());
    for name in ["mamba-swim", "mamba-3d"] {
        let robot = example(name).join("robot.toml");
        looks.push(look(&robot).unwrap());
        let out = folder.path().join(name);
        let job = Job {
            robot,
            moves: Moves::Wave(gait()),
            pitching: Pitching::default(),
            motor: None,
            step_s: None,
            out: Some(out.clone()),
            periods: 1,
            date: None,
            draws: None,
            is_sensitive: name == "mamba-swim",
        };
        let found = swim(&job, &|_, _| {}).unwrap();
        write_folder(&found, &out).unwrap();
        swims.push(found);
    }
    of_verb("robot-inspect", &looks.iter().collect::<Vec<_>>());
    let amplitude = Some(Axis { low: 20_f64.to_radians(), high: 30_f64.to_radians(), n: 2 });
    let job = SweepJob {
        robot: example("mamba-swim/robot.toml"),
        moves: Moves::Wave(gait()),
        ranges: Ranges { amplitude, ..Ranges::default() },
        motor: None,
        step_s: None,
        draws: None,
        out: folder.path().join("out"),
    };
    let objectives = [Objective::Speed, Objective::Power];
    for found in [sweep(&job, &|_, _| {}).unwrap(), optimise(&job, objectives, &|_, _| {}).unwrap()] {
        write_files(&found).unwrap();
        swims.push(found);
    }
    of_verb("swim", &swims.iter().collect::<Vec<_>>());
}

const ROWS: &str =
    "speed [m/s],f_x [N]\n0.1,-0.05\n0.2,-0.19\n0.3,-0.46\n0.4,-0.79\n0.5,-1.26\n0.6,-1.78\n0.7,-2.47\n0.8,-3.19\n";

#[test]
fn identify_and_what_reads_its_records() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("monday.csv"), ROWS).unwrap();
    std::fs::write(path("tuesday.csv"), ROWS.replace("-1.26", "-1.24").replace("-0.46", "-0.44")).unwrap();
    for day in ["monday", "tuesday"] {
        let found = identify(&pipeline::Job::new(path(&format!("{day}.csv"))), &|_| {}).unwrap();
        assert_eq!(found.path("result"), Some(&*path(&format!("{day}-results/result.json"))));
        holds(&found.outcome());
    }
    let [monday, tuesday] = ["monday", "tuesday"].map(|day| path(&format!("{day}-results/estimate.json")));
    let records = Input::Records(vec![monday.clone(), tuesday]);
    holds(&identify(&pipeline::Job::of(records), &|_| {}).unwrap().outcome());
    let (record, table) = (monday, path("tuesday.csv"));
    let job = prediction::Job { record, table, sidecar: None, laws: Vec::new(), out: None };
    of_verb("predict", &[&prediction::predict(&job).unwrap()]);
}

#[test]
fn campaigns_planned_and_simulated() {
    let folder = tempfile::tempdir().unwrap();
    let (mut plans, mut twins) = (Vec::new(), Vec::new());
    for name in
        ["accelerated", "decay", "oscillation", "rotation", "steady", "weights"].map(|name| format!("mamba-{name}"))
    {
        let to = folder.path().join(&name);
        copy(&example(&name), &to);
        plans.push(plan(&to.join("campaign.toml")).unwrap());
        twins.push(simulate(&to.join("campaign.toml"), false).unwrap());
    }
    of_verb("plan", &plans.iter().collect::<Vec<_>>());
    of_verb("simulate", &twins.iter().collect::<Vec<_>>());
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(Result::unwrap) {
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &to.join(entry.file_name()));
        } else {
            std::fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
        }
    }
}

#[test]
fn added_mass_of_a_shape_and_of_a_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("box.obj");
    // A tetrahedron, with one corner given twice.
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 5 3\n";
    std::fs::write(&mesh, text).unwrap();
    let repaired = folder.path().join("repaired.obj");
    let asked = Asked::read(&mesh, &[]).unwrap();
    let checked = [check(&asked).unwrap(), put_right(&asked, None, &repaired).unwrap()];
    of_verb("added-mass-check", &checked.iter().collect::<Vec<_>>());
    let body = folder.path().join("body.toml");
    std::fs::copy(example("mamba-necked/body.toml"), &body).unwrap();
    let links = GivenOption { name: "links".to_owned(), text: "2".to_owned(), place: None };
    let job = pipeline::Job::of(Input::Mesh { path: body, options: vec![links] });
    holds(&identify(&job, &|_| {}).unwrap().outcome());
}

/// Tables of two sources have the same keys; each stands with its source.
#[test]
fn two_sources_of_a_method_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut text = "schema = 1\nname = \"two\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n".to_owned();
    for (name, axis) in [("slender", "60 mm"), ("stout", "90 mm")] {
        let axes = format!("semi_axis_x = \"100 mm\"\nsemi_axis_y = \"{axis}\"\nsemi_axis_z = \"{axis}\"\n");
        let body = format!("schema = 1\nname = \"{name}\"\n[body]\nshape = \"ellipsoid\"\n{axes}");
        std::fs::write(path(&format!("{name}.toml")), body).unwrap();
        text += &format!("[[source]]\nname = \"{name}\"\nkind = \"potential\"\nmesh = \"{name}.toml\"\n");
    }
    std::fs::write(path("two.toml"), text).unwrap();
    let found = identify(&pipeline::Job::new(path("two.toml")), &|_| {}).unwrap().outcome();
    holds(&found);
    let result = std::fs::read_to_string(found.path("result").unwrap()).unwrap();
    let result: serde_json::Value = serde_json::from_str(&result).unwrap();
    let matrices: Vec<_> = result["sections"].as_array().unwrap().iter().filter(|of| !of["matrix"].is_null()).collect();
    assert_eq!(matrices.iter().map(|of| &of["source"]).collect::<Vec<_>>(), ["slender", "stout"]);
    let [slender, stout] = [0, 1].map(|i: usize| matrices[i]["matrix"][1]["sway"].as_f64().unwrap());
    assert!(stout > 1.5 * slender, "{slender} {stout}");
}

#[test]
fn the_demo() {
    let folder = tempfile::tempdir().unwrap();
    holds(&demo::run(&folder.path().join("demo"), None, &|_| {}).unwrap());
}

/// Confirms, and looks at nothing.
struct Nobody;

impl Operator for Nobody {
    fn confirm(&mut self, _: &str, _: &dyn Fn() -> bool) -> bool {
        true
    }
}

impl Progress for Nobody {
    fn run_begins(&mut self, _: &PlannedRun, _: usize, _: usize) {}

    fn sample(&mut self, _: &PlannedRun, _: &Sample, _: f64) {}

    fn say(&mut self, _: &str) {}
}

/// The towing carriage, driven in short; and all that can be looked at.
#[test]
fn a_carriage_and_what_is_inspected() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = folder.path().join("campaign.toml");
    let mut text = std::fs::read_to_string(example("towing-carriage/campaign.toml")).unwrap();
    for (from, to) in SHORT {
        assert!(text.contains(from), "the example has no {from}");
        text = text.replace(from, to);
    }
    std::fs::write(&campaign, text).unwrap();
    let job = DriveJob { campaign: campaign.clone(), out: None, start_unix_ns: 0, date: "2026-11-22".to_owned() };
    let prepared = prepare(&job).unwrap();
    let driven = drive(&prepared, &StopSwitch::default(), &mut Nobody, &mut Nobody).unwrap();
    of_verb("run", &[&prepared.outcome(), &driven.outcome(&prepared.folder)]);

    let runs = || Input::Runs { paths: vec![prepared.folder.clone()], campaign: None };
    for method in [None, Some(&Servo as &dyn Method), Some(&KnownWeights)] {
        let out = Some(folder.path().join(format!("{method:?}")));
        holds(&identify(&pipeline::Job { out, method, ..pipeline::Job::of(runs()) }, &|_| {}).unwrap().outcome());
    }
    holds(&tune(&job, &StopSwitch::default(), &mut Nobody, &mut Nobody).unwrap().outcome());
    holds(&find_resonance(&job, &StopSwitch::default(), &mut Nobody, &mut Nobody).unwrap().outcome());

    let table = folder.path().join("monday.csv");
    std::fs::write(&table, ROWS).unwrap();
    identify(&pipeline::Job::new(&table), &|_| {}).unwrap();
    let record = folder.path().join("monday-results/estimate.json");
    let log = std::fs::read_dir(&prepared.folder).unwrap().map(|entry| entry.unwrap().path());
    let log = log.filter(|path| path.extension().is_some_and(|e| e == "mcap")).min().unwrap();
    let all = [table, record, campaign, log, prepared.folder.clone()];
    let looked: Vec<_> = all.iter().map(|file| inspect(file, None).unwrap().outcome()).collect();
    of_verb("inspect", &looked.iter().collect::<Vec<_>>());
}

/// Two pairs at one speed, jogs and pulses, with short waits.
const SHORT: [(&str, &str); 10] = [
    (r#"settling = { dry = "5 s", wet = "120 s" }"#, r#"settling = { dry = "1 s", wet = "1 s" }"#),
    (r#"still = "5 s""#, r#"still = "2 s""#),
    (r#"speeds = ["0.05 m/s", "0.15 m/s", "0.25 m/s", "0.35 m/s", "0.45 m/s", "0.55 m/s"]"#, r#"speeds = ["0.5 m/s"]"#),
    ("repeats = 5  ", "repeats = 2  "),
    ("[carriage.warm_up]\nduration = \"1 min\"\nspeed = \"0.3 m/s\"\n", ""),
    (
        "[carriage.friction_sweep]\nspeeds = [\"0.02 m/s\", \"0.05 m/s\", \"0.1 m/s\", \"0.2 m/s\", \"0.35 m/s\", \"0.55 m/s\"]\nrepeats = 2\n",
        "",
    ),
    ("weights = [\"1.5 N\", \"10 N\"]", "weights = [\"1.5 N\"]"),
    ("repeats = 6\n", "repeats = 1\n"),
    ("duration = \"20 s\"", "duration = \"2 s\""),
    (r#"log_rate = "1 kHz""#, r#"log_rate = "250 Hz""#),
];
