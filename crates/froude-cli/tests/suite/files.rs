//! Files and signals: what is read is a regular file within a limit, what is written lies in the verb's folder, and a signal ends every verb as
//! the README says.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use crate::bench::SMOOTH_BODY;

/// Longest that anything here takes to end.
const PATIENCE: Duration = Duration::from_mins(1);

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

fn froude(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).args(args).current_dir(folder).output().unwrap()
}

/// Exit code and standard error.
fn outcome(folder: &Path, args: &[&str]) -> (Option<i32>, String) {
    let output = froude(folder, args);
    (output.status.code(), String::from_utf8_lossy(&output.stderr).trim_end().to_owned())
}

const TABLE: &str = "speed [m/s],f_x [N]\n0.1,-0.5\n0.2,-2.0\n0.3,-4.4\n0.4,-8.1\n0.5,-12.4\n";

const CFD: &str = r#"schema = 1
name = "computed"
[fluid]
density = "1025 kg/m^3"
kinematic_viscosity = "1.19e-6 m^2/s"
[[source]]
name  = "CFD"
kind  = "cfd"
cases = "flow"
[source.cfd]
body = "body.toml"
mesh = { stations = 20, layers = 20, azimuth = 8, first_layer = "0.5 mm" }
[[source.plan]]
configurations = ["H1LT"]
speed = "0.4 m/s"
angle = ["0 deg", "90 deg"]
"#;

/// A folder with a CFD campaign in `lab/`.
fn cfd(from: &str, to: &str) -> tempfile::TempDir {
    assert!(CFD.contains(from), "{from}");
    let folder = tempfile::tempdir().unwrap();
    let lab = folder.path().join("lab");
    std::fs::create_dir(&lab).unwrap();
    std::fs::write(lab.join("body.toml"), SMOOTH_BODY).unwrap();
    std::fs::write(lab.join("c.toml"), CFD.replacen(from, to, 1)).unwrap();
    folder
}

#[test]
fn a_pipe_or_a_device_is_rejected_at_once_by_every_reader() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let pipe = |name: &str| assert!(Command::new("mkfifo").arg(at.join(name)).status().unwrap().success());
    let zero = |name: &str| std::os::unix::fs::symlink("/dev/zero", at.join(name)).unwrap();
    for name in ["p.csv", "p.toml", "p.parquet", "p.mcap", "p.json", "p.stl", "p.urdf", "p.obj"] {
        pipe(name);
    }
    for name in ["z.csv", "z.toml", "z.parquet", "z.mcap", "z.json", "z.stl", "z.urdf", "z.obj"] {
        zero(name);
    }
    std::fs::write(at.join("t.csv"), TABLE).unwrap();
    let verbs: &[&[&str]] = &[
        &["inspect", "?.csv"],
        &["inspect", "?.parquet"],
        &["inspect", "?.mcap"],
        &["inspect", "?.json"],
        &["identify", "?.csv"],
        &["identify", "?.parquet"],
        &["identify", "?.toml"],
        &["identify", "t.csv", "--sidecar", "?.toml"],
        &["compare", "?.json", "?.json"],
        &["predict", "?.json", "t.csv"],
        &["plan", "?.toml"],
        &["simulate", "?.toml"],
        &["run", "?.toml", "--check"],
        &["cfd", "plan", "?.toml"],
        &["cfd", "collect", "?.toml"],
        &["added-mass", "?.toml", "--check"],
        &["added-mass", "?.stl", "--check"],
        &["added-mass", "?.obj", "--check"],
        &["robot", "inspect", "?.toml"],
        &["robot", "inspect", "?.urdf"],
        &["swim", "?.toml", "--amplitude", "30 deg", "--frequency", "80 deg/s", "--phase", "40 deg"],
        &["carriage", "identify", "?.mcap"],
        &["carriage", "drag", "?.mcap"],
    ];
    for verb in verbs {
        for kind in ["p", "z"] {
            let args: Vec<String> = verb.iter().map(|arg| arg.replace('?', kind)).collect();
            let begun = Instant::now();
            let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
                .args(&args)
                .current_dir(at)
                .stdout(Stdio::null())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            while child.try_wait().unwrap().is_none() {
                if begun.elapsed() > PATIENCE {
                    child.kill().unwrap();
                    panic!("{args:?} blocks");
                }
                std::thread::sleep(Duration::from_millis(5));
            }
            let mut said = String::new();
            child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
            assert_eq!(child.wait().unwrap().code(), Some(2), "{args:?}: {said}");
            assert!(said.contains("a regular file is needed"), "{args:?}: {said}");
        }
    }
}

#[test]
fn a_write_beyond_the_limit_of_the_shell_is_an_error_with_a_message() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), TABLE).unwrap();
    let out = Command::new("sh")
        .args(["-c", "ulimit -f 8; exec \"$0\" identify t.csv", env!("CARGO_BIN_EXE_froude")])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(1), "{said}");
    assert!(said.contains("larger than the limit of this shell (ulimit -f)"), "{said}");
    let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, ["t.csv"], "nothing is left");
}

/// Sends Ctrl-C once `is_begun`, and gives the exit code with what was said.
fn interrupted(folder: &Path, args: &[&str], is_begun: impl Fn() -> bool) -> (Option<i32>, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
        .args(args)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !is_begun() && begun.elapsed() < PATIENCE {
        assert!(child.try_wait().unwrap().is_none(), "{args:?} ended by itself");
        std::thread::sleep(Duration::from_millis(5));
    }
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    let output = child.wait_with_output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn ctrl_c_ends_every_long_verb_with_130_and_leaves_nothing_half_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let example = |path: &str| root().join("examples").join(path);
    std::fs::copy(example("towing-carriage/campaign.toml"), at.join("tow.toml")).unwrap();
    let runs = at.join("tow-runs");
    let (code, said) = interrupted(at, &["run", "tow.toml", "--yes"], || {
        runs.read_dir().is_ok_and(|entries| {
            entries.flatten().filter(|e| e.path().extension().is_some_and(|x| x == "mcap")).count() > 1
        })
    });
    assert_eq!(code, Some(130), "{said}");
    assert!(said.contains("run the campaign again to resume from there"), "{said}");

    let robot = example("mamba-swim/robot.toml");
    let sweep = [
        "swim",
        robot.to_str().unwrap(),
        "--frequency",
        "80 deg/s",
        "--sweep",
        "amplitude=20..30 deg:60, phase=40..60 deg:60",
        "--out",
        "sweep",
    ];
    let (code, said) = interrupted(at, &sweep, || at.join("sweep").exists());
    assert_eq!(code, Some(130), "{said}");
    assert!(said.contains("stopped by Ctrl-C; results that were not finished are not written"), "{said}");

    // A flat body at this tolerance takes twenty times as long as the wait.
    let body = "schema = 1\nname = \"fin\"\n[fluid]\ndensity = \"1025 kg/m^3\"\n[body]\nshape = \"ellipsoid\"\nsemi_axis_x = \"2 m\"\n\
                semi_axis_y = \"0.3 m\"\nsemi_axis_z = \"0.05 m\"\n";
    std::fs::write(at.join("fin.toml"), body).unwrap();
    let start = Instant::now();
    let (code, said) = interrupted(at, &["added-mass", "fin.toml", "--tolerance", "0.001 %"], || {
        start.elapsed() > Duration::from_millis(300)
    });
    assert_eq!(code, Some(130), "{said}");
    let mut left: Vec<String> =
        std::fs::read_dir(at).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    left.sort();
    assert_eq!(left, ["fin.toml", "sweep", "tow-runs", "tow.toml"]);
}

#[test]
fn cfd_writes_below_the_campaign_only() {
    for cases in ["../victim", "/tmp/froude-victim", ".", "link", "flow/../../victim"] {
        let folder = cfd("cases = \"flow\"", &format!("cases = {cases:?}"));
        let (lab, victim) = (folder.path().join("lab"), folder.path().join("victim"));
        std::fs::create_dir(&victim).unwrap();
        std::os::unix::fs::symlink(&victim, lab.join("link")).unwrap();
        for verb in ["plan", "status", "collect"] {
            let (code, said) = outcome(&lab, &["cfd", verb, "c.toml"]);
            assert_eq!(code, Some(2), "{cases} {verb}: {said}");
            assert!(
                said.contains("c.toml:9:9: `cases` is") && said.contains("leads out of the campaign's folder"),
                "{said}"
            );
        }
        assert!(std::fs::read_dir(&victim).unwrap().next().is_none() && !Path::new("/tmp/froude-victim").exists());
    }
    // A link below the folder.
    let folder = cfd("", "");
    let (lab, victim) = (folder.path().join("lab"), folder.path().join("victim"));
    std::fs::create_dir(&victim).unwrap();
    std::fs::create_dir(lab.join("flow")).unwrap();
    std::os::unix::fs::symlink(&victim, lab.join("flow/meshes")).unwrap();
    let (code, said) = outcome(&lab, &["cfd", "plan", "c.toml"]);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("flow/meshes: is a link that leads out of the campaign's folder"), "{said}");
    assert!(std::fs::read_dir(&victim).unwrap().next().is_none());
}

#[test]
fn cfd_replaces_no_file_that_it_did_not_write() {
    let folder = cfd("", "");
    let lab = folder.path().join("lab");
    let flow = lab.join("flow");
    std::fs::create_dir_all(flow.join("cases/photos")).unwrap();
    std::fs::write(flow.join("cases/photos/a.jpg"), "mine").unwrap();
    let (code, said) = outcome(&lab, &["cfd", "plan", "c.toml"]);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("photos: was not written by Froude"), "{said}");
    std::fs::remove_dir_all(flow.join("cases")).unwrap();
    for mine in ["{\"mine\": true}\n", "not JSON", "{\"cases\": [], \"mine\": 1}"] {
        std::fs::write(flow.join("campaign.json"), mine).unwrap();
        let (code, said) = outcome(&lab, &["cfd", "plan", "c.toml"]);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.contains("campaign.json") && said.contains("move this one away"), "{said}");
        assert_eq!(std::fs::read_to_string(flow.join("campaign.json")).unwrap(), mine);
    }
    std::fs::remove_file(flow.join("campaign.json")).unwrap();
    assert_eq!(outcome(&lab, &["cfd", "plan", "c.toml"]).0, Some(0));
    assert_eq!(outcome(&lab, &["cfd", "plan", "c.toml"]).0, Some(0));
}

#[test]
fn predictions_and_sweeps_replace_no_file_that_they_did_not_write() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("t.csv"), TABLE).unwrap();
    assert_eq!(outcome(at, &["identify", "t.csv", "--models", "quadratic"]).0, Some(0));
    let predict = ["predict", "t-results/estimate.json", "t.csv", "--out", "p"];
    assert_eq!((outcome(at, &predict).0, outcome(at, &predict).0), (Some(0), Some(0)));
    let table = std::fs::read_dir(at.join("p"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .find(|p| p.extension().is_some_and(|e| e == "csv"))
        .unwrap();
    std::fs::write(&table, "mine").unwrap();
    let (code, said) = outcome(at, &predict);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("was changed after Froude wrote it, and would be replaced"), "{said}");
    assert_eq!(std::fs::read_to_string(&table).unwrap(), "mine");

    let robot = root().join("examples/mamba-swim/robot.toml");
    let sweep = [
        "swim",
        robot.to_str().unwrap(),
        "--frequency",
        "80 deg/s",
        "--phase",
        "40 deg",
        "--sweep",
        "amplitude=20..30 deg:2",
        "--out",
        "s",
    ];
    std::fs::create_dir(at.join("s")).unwrap();
    std::fs::write(at.join("s/result.json"), "mine").unwrap();
    let (code, said) = outcome(at, &sweep);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("result.json was not written by Froude"), "{said}");
    std::fs::remove_file(at.join("s/result.json")).unwrap();
    assert_eq!((outcome(at, &sweep).0, outcome(at, &sweep).0), (Some(0), Some(0)));
}

/// Each block is within its limit; together they are not. Nothing of them is simulated.
#[test]
fn a_plan_is_counted_before_it_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let block = |n: usize| {
        "[[source.plan]]\namplitude = \"10 deg\"\nfrequency = \"70 deg/s\"\nperiods = 10\nrate = \"10 Hz\"\nrepeats = 2500\n".repeat(n)
    };
    let text = |blocks: &str| {
        format!(
            "schema = 1\nname = \"x\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"s\"\nkind = \"tank\"\nruns = \"runs\"\n\
             method = \"forced_oscillation\"\n[source.forced_oscillation]\npivot = \"stream\"\nradius = \"0.5 m\"\nmass = \"1 kg\"\n\
             buoyancy = \"0 N\"\ndelay = \"0 ms\"\n{blocks}"
        )
    };
    let long =
        "[[source.plan]]\namplitude = \"10 deg\"\nfrequency = \"70 deg/s\"\nperiods = 100000\nrate = \"1 kHz\"\n";
    let cfd_plan = CFD.replacen(
        "speed = \"0.4 m/s\"",
        "speed = { start = \"0.001 m/s\", stop = \"5.001 m/s\", step = \"0.001 m/s\" }",
        1,
    );
    for (text, said) in [
        (text(&block(5)), "`plan` asks for 12500 runs up to this block; at most 10000 are made"),
        (text(long), "samples up to this block; at most 10000000 samples are simulated"),
        (cfd_plan, "`speed` (5001) × `angle` (2) × `pitch` (1) × `repeats` (1) is 10002; at most 10000 are made"),
    ] {
        std::fs::write(at.join("c.toml"), text).unwrap();
        let (code, found) = outcome(at, &["plan", "c.toml"]);
        assert_eq!(code, Some(2), "{found}");
        assert!(found.contains(said), "{found}");
    }
    // Each configuration has a mesh in each domain of a study.
    let names: Vec<String> = (1..=399).map(|links| format!("\"H{links}LT\"")).collect();
    let radii: Vec<String> = (0..30).map(|k| format!("{}", 6 + k)).collect();
    let study = format!("[[source.cfd.study]]\nspeed = \"0.4 m/s\"\nradius = [{}]\n[[source.plan]]", radii.join(", "));
    let many = CFD.replace("\"H1LT\"", &names.join(", ")).replace("[[source.plan]]", &study);
    std::fs::write(at.join("c.toml"), many).unwrap();
    std::fs::write(at.join("body.toml"), SMOOTH_BODY).unwrap();
    let (code, found) = outcome(at, &["cfd", "plan", "c.toml"]);
    assert!(code == Some(2) && found.contains("asks for 12369 meshes") && found.contains("at most 10000"), "{found}");
}

/// Files are opened in `froude_records::read` alone: what is listed reads the system, or is no input.
#[test]
fn input_files_are_opened_in_one_place() {
    const ELSEWHERE: [(&str, &str); 9] = [
        ("froude-records/src/read.rs", "the one place"),
        ("froude-records/src/unfinished.rs", "locks folders that this program made"),
        ("froude-records/src/write.rs", "synchronises a folder"),
        ("froude-cfd/src/workers/process.rs", "/proc"),
        ("froude-cfd/src/workers/orphans.rs", "/proc"),
        ("froude-panel/src/refine.rs", "/proc/meminfo"),
        ("froude-cfd/src/folder/lock.rs", "a lock, opened for writing"),
        ("froude-rig/src/drive/serial.rs", "a port"),
        ("froude-link/src", "a port"),
    ];
    let mut found = Vec::new();
    let mut folders: Vec<PathBuf> =
        std::fs::read_dir(root().join("crates")).unwrap().map(|e| e.unwrap().path().join("src")).collect();
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(&folder).into_iter().flatten().map(|e| e.unwrap().path()) {
            let name = path.strip_prefix(root().join("crates")).unwrap().display().to_string();
            if path.is_dir() {
                folders.push(path);
            } else if !name.ends_with("tests.rs") && !ELSEWHERE.iter().any(|(file, _)| name.starts_with(file)) {
                let text = std::fs::read_to_string(&path).unwrap();
                let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
                let opens = ["File::open(", "fs::read(", "fs::read_to_string(", "OpenOptions::new()"];
                let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
                found.extend(
                    lines
                        .filter(|line| opens.iter().any(|o| line.contains(o)))
                        .map(|line| format!("{name}: {}", line.trim())),
                );
            }
        }
    }
    assert!(found.is_empty(), "open these with froude_records::read:\n{}", found.join("\n"));
}
