//! A CFD campaign at the verb: planned, priced, run by OpenFOAM, killed and gone on with, collected, identified, and what is refused.

use crate::held;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::AtomicBool;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::bench::{SMOOTH_BODY, has_openfoam};

const CAMPAIGN: &str = r#"schema = 1
name = "computed"
[fluid]
density = "1025 kg/m^3"
kinematic_viscosity = "1.19e-6 m^2/s"
[body]
link = { major_semi_axis = "58.8 mm", minor_semi_axis = "39.4 mm", half_length = "90 mm" }
head_side_area = "0.011 m^2"
tail_side_area = "0.008 m^2"
[[source]]
name  = "CFD"
kind  = "cfd"
cases = "flow"
[[source.uncertainty]]
quantity = "f_y"
standard = "10 %"
shared   = "campaign"
[source.cfd]
body = "body.toml"
mesh = { stations = 20, layers = 20, azimuth = 8, first_layer = "0.5 mm" }
iterations = 900
window = 40
cold = 0
[[source.plan]]
configurations = ["H1LT", "H2LT"]
speed = "0.4 m/s"
angle = ["0 deg", "45 deg", "90 deg"]
[identify]
models = ["f1"]
"#;

fn campaign(folder: &Path) -> PathBuf {
    std::fs::write(folder.join("body.toml"), SMOOTH_BODY).unwrap();
    let path = folder.join("campaign.toml");
    std::fs::write(&path, CAMPAIGN).unwrap();
    path
}

fn froude(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).args(arguments).output().unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[track_caller]
fn done(arguments: &[&str]) -> String {
    let output = froude(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[track_caller]
fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&done(&[arguments, &["--json"]].concat())).unwrap()
}

#[track_caller]
fn refused(arguments: &[&str]) -> String {
    let output = froude(arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", String::from_utf8_lossy(&output.stdout));
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn a_campaign_is_priced_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let planned = json(&["cfd", "plan", text(&campaign(folder.path()))]);
    let rows = planned["configurations"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    for row in rows {
        assert_eq!(
            (row["cells"].as_u64(), row["cases"].as_u64(), row["open"].as_u64()),
            (Some(3200), Some(3), Some(3))
        );
        // Three of 250 iterations, at 3.2 µs a cell.
        assert!((row["cpu_s"].as_f64().unwrap() - 750.0 * 3200.0 * 3.2e-6).abs() < 1e-9, "{row}");
    }
    let said = done(&["cfd", "plan", text(&folder.path().join("campaign.toml"))]);
    assert!(said.contains("6 cases are kept"), "{said}");
}

/// Six cases, stopped by SIGKILL on the way and gone on with; the answer has each once.
#[test]
fn a_campaign_that_was_killed_goes_on_and_is_identified() {
    if !has_openfoam() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = campaign(folder.path());
    let run = ["cfd", "run", text(&path), "--jobs", "2"];
    let counts = || json(&["cfd", "status", text(&path)])["counts"].clone();
    let usable = |counts: &Value| {
        ["converged", "oscillating"].iter().map(|word| counts[*word].as_u64().unwrap_or(0)).sum::<u64>()
    };
    done(&["cfd", "plan", text(&path)]);
    let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
        .args(run)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while usable(&counts()) == 0 && start.elapsed() < Duration::from_mins(1) {
        sleep(Duration::from_millis(50));
    }
    // While it runs nobody else does.
    let other = refused(&["cfd", "run", text(&path)]);
    assert!(other.contains("works on it") || usable(&counts()) == 6, "{other}");
    child.kill().unwrap();
    child.wait().unwrap();
    done(&run);
    assert_eq!(usable(&counts()), 6, "{}", done(&["cfd", "status", text(&path)]));
    let again = done(&run);
    assert!(again.contains("6 cases are kept") || again.contains("Computed") || again.contains("converged"), "{again}");

    let collected = json(&["cfd", "collect", text(&path)]);
    assert_eq!(collected["observations"].as_u64(), Some(6));
    let table = std::fs::read_to_string(folder.path().join("flow/observations.csv")).unwrap();
    assert_eq!(table.lines().count(), 7, "{table}");
    let found = json(&["identify", text(&path)]);
    let coefficients = &found["estimates"][0]["coefficients"];
    let c = |name: &str| coefficients[name]["value"].as_f64().unwrap();
    // f1 at 0.4 m/s has 1/0.4 of its linear term beside the square: a drag of 3.5 C_d, which of a short body with round ends is some 0.5; widely.
    assert!((0.08..0.3).contains(&c("C_d")) && (0.0..0.02).contains(&c("C_f")), "{coefficients}");

    reported(&path);
    let said = done(&["cfd", "suggest", text(&path)]);
    assert!(said.contains("plan five angles"), "{said}");

    // Changing the flow or the body makes the plan outdated; changing an uncertainty budget does not.
    let is_outdated = || {
        let found = json(&["identify", text(&path)]);
        let states = |found: &Value| found["findings"].to_string().contains("cfd-plan-outdated");
        let verbs = ["status", "collect"].map(|verb| json(&["cfd", verb, text(&path)])["is_outdated"] == true);
        let said = done(&["cfd", "collect", text(&path)]) + &done(&["cfd", "status", text(&path)]);
        [verbs[0], verbs[1], states(&found), said.matches("changed since the cases were planned").count() == 2]
    };
    std::fs::write(&path, CAMPAIGN.replace("\"10 %\"", "\"20 %\"")).unwrap();
    assert_eq!(is_outdated(), [false; 4]);
    std::fs::write(&path, CAMPAIGN.replace("\"0.4 m/s\"", "\"0.5 m/s\"")).unwrap();
    assert_eq!(is_outdated(), [true; 4]);
    std::fs::write(&path, CAMPAIGN).unwrap();
    std::fs::write(folder.path().join("body.toml"), SMOOTH_BODY.replace("\"31 mm\"", "\"32 mm\"")).unwrap();
    assert_eq!(is_outdated(), [true; 4]);
    std::fs::write(folder.path().join("body.toml"), SMOOTH_BODY).unwrap();
    assert_eq!(is_outdated(), [false; 4]);

    // Edited by hand: it reaches no fit, and is said.
    let result = std::fs::read_dir(folder.path().join("flow/cases/H1LT-u0.4-a90")).unwrap();
    let result = result.map(|e| e.unwrap().path()).find(|p| p.ends_with("result.json")).unwrap();
    let content = std::fs::read_to_string(&result).unwrap();
    std::fs::write(&result, content.replacen("\"iterations\":", "\"iterations\":1", 1)).unwrap();
    assert_eq!(counts()["edited"].as_u64(), Some(1), "{}", counts());
    assert_eq!(json(&["cfd", "collect", text(&path)])["observations"].as_u64(), Some(5));
    // So do forces that were edited under a result that was not.
    let forces = folder.path().join("flow/cases/H2LT-u0.4-a90");
    let attempt = std::fs::read_dir(&forces).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_dir()).max().unwrap();
    let forces = attempt.join("postProcessing/forces/0/force.dat");
    let content = std::fs::read_to_string(&forces).unwrap();
    std::fs::write(&forces, content + "9999 (0 0 0) (0 0 0) (0 0 0)\n").unwrap();
    let collected = json(&["cfd", "collect", text(&path)]);
    assert_eq!(collected["observations"].as_u64(), Some(4));
    assert!(collected["without"].to_string().contains("it was changed after it was written"), "{collected}");
}

/// The page of the same campaign, and the fitted law through its points in that of identify.
fn reported(path: &Path) {
    let folder = path.parent().unwrap();
    let read = |part: &str| std::fs::read_to_string(folder.join(part)).unwrap();
    let found = json(&["cfd", "report", text(path)]);
    let names: Vec<&str> = found["cases"].as_array().unwrap().iter().filter_map(|c| c["case"].as_str()).collect();
    // The middle of two configurations is the second; H2LT has one speed.
    assert_eq!(names, ["H2LT-u0.4-a0", "H2LT-u0.4-a45", "H2LT-u0.4-a90"]);
    assert_eq!(found["forces"].as_array().unwrap().len(), 6);
    assert_eq!(found["meshes"][0]["cells"].as_u64(), Some(3200));
    for case in found["cases"].as_array().unwrap() {
        let (convergence, pictures) = (&case["convergence"], &case["pictures"]);
        let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{case}"));
        // What was judged is a window of the campaign's, or twice that and so on.
        let window = convergence["window"]["iterations"].as_u64().unwrap();
        assert!(window % 40 == 0 && number(&convergence["last"]) >= window as f64, "{case}");
        // 1 where the water comes to rest; a cell is a tenth of a turn, and half of a first layer of 0.5 mm off the wall.
        let [least, most] = [0, 1].map(|end| number(&pictures["pressure_coefficient"][end]));
        assert!((most - 1.0).abs() < 0.15 && (-5.0..-0.3).contains(&least), "{case}");
        assert!((1.0..2.5).contains(&number(&pictures["largest_speed_ratio"])), "{case}");

        // The pressure on the surface is the force that the solver wrote at its last iteration.
        let id = case["case"].as_str().unwrap();
        let attempt = folder.join("flow/cases").join(id);
        let attempt =
            std::fs::read_dir(attempt).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_dir()).max().unwrap();
        let starts = std::fs::read_dir(attempt.join("postProcessing/forces")).unwrap().map(|e| e.unwrap().path());
        let last = starts.max_by_key(|p| p.file_name().unwrap().to_str().unwrap().parse::<u32>().unwrap()).unwrap();
        let last = std::fs::read_to_string(last.join("force.dat")).unwrap();
        let numbers: Vec<f64> =
            last.lines().last().unwrap().split(['(', ')', ' ', '\t']).filter_map(|w| w.parse().ok()).collect();
        for axis in [0, 1] {
            // Behind the time and the total; half of the body.
            let (written, summed) = (2.0 * numbers[4 + axis], number(&pictures["pressure_force_n"][axis]));
            let size = 2.0 * numbers[4].hypot(numbers[5]);
            assert!((written - summed).abs() < 1e-6 * size, "{written} {summed}");
        }

        // Half of the surface faces each eye: 20 x 16 faces seen from three sides.
        let polygons =
            |svg: &str| svg.lines().filter(|l| l.starts_with("<path")).map(|l| l.matches('z').count()).sum::<usize>();
        let surface = read(&format!("campaign-cfd/figures/surface-{id}.svg"));
        assert!((3 * 120..=3 * 160).contains(&polygons(&surface)), "{}", polygons(&surface));
        assert!(
            surface.contains("C_p [-]")
                && surface.contains("from port, where the water meets it") == !id.ends_with("-a0")
        );
        let wake = read(&format!("campaign-cfd/figures/wake-{id}.svg"));
        assert!((300..=800).contains(&polygons(&wake)), "{}", polygons(&wake));
        assert!(wake.starts_with("<svg ") && wake.ends_with("</svg>\n") && !wake.contains("NaN"));
    }
    let page = read("campaign-cfd/report.html");
    for id in ["H2LT-u0.4-a45", "H1LT-u0.4-a90"] {
        assert!(page.contains(id), "{id}");
    }
    // Two charts of forces against the angle, three of convergence, three pairs of pictures.
    assert_eq!((page.matches("<figure>").count(), found["figures"].as_array().unwrap().len()), (11, 11));
    assert!(!page.contains("<script") && page.len() < 1_500_000, "{}", page.len());
    let said = done(&["cfd", "report", text(path), "--case", "H1LT-u0.4-a90", "--out", text(&folder.join("one"))]);
    assert!(said.contains("pictures of H1LT-u0.4-a90"), "{said}");
    assert!(refused(&["cfd", "report", text(path), "--case", "H9LT-u1-a0"]).contains("H9LT-u1-a0"));

    for load in ["f_x", "f_y"] {
        let figures = std::fs::read_dir(folder.join("campaign-results/figures")).unwrap();
        let own =
            figures.map(|e| e.unwrap().path()).find(|p| text(p).ends_with(&format!("cfd-{load}-against-angle.svg")));
        let chart = std::fs::read_to_string(own.unwrap()).unwrap();
        // A line of the law through the computed points of each of two configurations.
        assert!(
            chart.matches("<polyline").count() >= 2 && chart.contains("computed") && chart.contains("f1"),
            "{load}"
        );
    }
}

const SWING: &str = r#"schema = 1
name = "swung"
[fluid]
density = "1025 kg/m^3"
kinematic_viscosity = "1.19e-6 m^2/s"
[body]
link = { major_semi_axis = "58.8 mm", minor_semi_axis = "39.4 mm", half_length = "90 mm" }
head_side_area = "0.011 m^2"
tail_side_area = "0.008 m^2"
link_volume = "1.2723e-3 m^3"
[[source]]
name   = "computed"
kind   = "cfd"
runs   = "runs"
method = "forced_oscillation"
models = ["f1"]
[source.forced_oscillation]
pivot    = "stream"
radius   = "476 mm"
mass     = "1.5 kg"
buoyancy = "0 N"
delay    = "0 ms"
cycles   = { skip = 1, fewest = 2 }
[source.cfd]
body = "body.toml"
mesh = { stations = 20, layers = 20, azimuth = 8, first_layer = "0.5 mm" }
model = "laminar"
[[source.plan]]
configurations = ["H1LT"]
amplitude = "2 deg"
frequency = ["60 deg/s", "70 deg/s", "80 deg/s"]
flow      = "0 m/s"
periods   = 3
"#;

/// Three runs, stopped by SIGKILL on the way and gone on with; identify has the added mass of potential flow and of a thin layer that goes along.
#[test]
fn a_swing_is_computed_and_identified_as_a_tank_s() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("body.toml"), SMOOTH_BODY).unwrap();
    let path = folder.path().join("campaign.toml");
    let with = |from: &str, to: &str| std::fs::write(&path, SWING.replacen(from, to, 1)).unwrap();
    with("\"stream\"", "\"upright\"");
    assert!(refused(&["cfd", "swing", text(&path)]).contains("pivot = \"stream\""));
    for (from, to, said) in [
        ("kind   = \"cfd\"", "kind   = \"tank\"", "no source that swings"),
        ("periods   = 3", "periods   = 2", "3 periods are needed"),
        ("periods   = 3", "periods   = 3\nrepeats = 2", "twice"),
    ] {
        with(from, to);
        let found = refused(&["cfd", "swing", text(&path)]);
        assert!(found.contains(said), "{to}: {found}");
    }
    with("", "");
    if !has_openfoam() {
        return;
    }
    let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
        .args(["cfd", "swing", text(&path)])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let forces = folder.path().join("runs-cfd/H1LT-a2-w60-u0/postProcessing/forces/0/force.dat");
    let start = Instant::now();
    while std::fs::metadata(&forces).map_or(0, |f| f.len()) < 2000 && start.elapsed() < Duration::from_mins(1) {
        sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(std::fs::read_dir(folder.path().join("runs")).unwrap().count(), 0, "killed before a run ended");
    let found = json(&["cfd", "swing", text(&path)]);
    assert_eq!((found["runs"].as_array().unwrap().len(), found["open"].as_u64()), (3, Some(0)), "{found}");
    let again = json(&["cfd", "swing", text(&path)]);
    assert!(again["runs"][0]["cpu_s"].is_null() && again["open"].as_u64() == Some(0), "{again}");
    held::of_verb("cfd-swing", &[&froude::swing::swing(&path, None, 2, &AtomicBool::new(false), &|_| ()).unwrap()]);

    let estimate = &json(&["identify", text(&path)])["estimates"][0];
    let added = estimate["coefficients"]["C_A"]["value"].as_f64().unwrap();
    // 1.385 by panels (froude added-mass), and Stokes' layer: ½ρδ∮(u/U)² ds with δ = √(2ν/ω) is 4.4 % of it at this section in two dimensions,
    // and 7 % of a circular cylinder's of this width. The mesh has 3200 cells.
    println!("C_A {added}, {:.3} of that by panels", added / 1.385);
    assert!((1.02..1.12).contains(&(added / 1.385)), "{estimate}");
    // The verb and the record speak of one KC.
    let range = &estimate["validity"]["KC"];
    for run in found["runs"].as_array().unwrap() {
        let kc = run["keulegan_carpenter"].as_f64().unwrap();
        let [low, high] = ["low", "high"].map(|end| range[end].as_f64().unwrap());
        assert!((0.99 * low..1.01 * high).contains(&kc), "{kc} {range}");
    }

    // Another plan: runs that it did not make are neither taken nor written over.
    with("\"2 deg\"", "\"3 deg\"");
    assert!(refused(&["cfd", "swing", text(&path)]).contains("is not of a run that this plan computes"));
}

#[test]
fn what_cannot_be_computed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = campaign(folder.path());
    let with = |from: &str, to: &str| {
        assert!(CAMPAIGN.contains(from), "{from}");
        std::fs::write(&path, CAMPAIGN.replacen(from, to, 1)).unwrap();
        refused(&["cfd", "plan", text(&path)])
    };
    for (from, to, said) in [
        ("body = \"body.toml\"", "", "names no body"),
        ("kinematic_viscosity = \"1.19e-6 m^2/s\"\n", "", "viscosity"),
        ("\"H2LT\"", "\"barge\"", "HkLT"),
        ("angle = [\"0 deg\"", "pitch = \"10 deg\"\nangle = [\"0 deg\"", "domain = \"full\""),
        ("first_layer = \"0.5 mm\"", "first_layer = \"2 m\"", "H1LT"),
    ] {
        let found = with(from, to);
        assert!(found.contains(said), "{to}: {found}");
    }
    let necked = SMOOTH_BODY.replace("ends =", "joint = { length = \"60 mm\", scale = 0.7, ramp = \"4 mm\" }\nends =");
    std::fs::write(folder.path().join("body.toml"), necked).unwrap();
    std::fs::write(&path, CAMPAIGN).unwrap();
    let found = refused(&["cfd", "plan", text(&path)]);
    assert!(found.contains("no mesh of H1LT") && found.contains("x ="), "{found}");
    assert!(refused(&["cfd", "status", text(&path)]).contains("froude cfd plan"));
}

/// An ellipsoid of 200 by 60 by 80 mm with its nose at x = 100, as a text of STL in millimetres; `keel` stretches what lies below.
fn ellipsoid_mm(keel: f64) -> String {
    let (along, around) = (12, 24);
    let point = |i: usize, j: usize| {
        let (a, b) = (std::f64::consts::PI * i as f64 / along as f64, std::f64::consts::TAU * j as f64 / around as f64);
        let (sin, cos) = if i == along { (0.0, -1.0) } else { a.sin_cos() };
        let z = 40.0 * sin * b.sin();
        // Zero has no sign.
        [100.0 * cos, 30.0 * sin * b.cos(), if z < 0.0 { keel * z } else { z }].map(|v| (1e6 * v).round() / 1e6 + 0.0)
    };
    let mut text = "solid hull\n".to_owned();
    let mut facet = |corners: [[f64; 3]; 3]| {
        text.push_str(" facet normal 0 0 0\n  outer loop\n");
        for [x, y, z] in corners {
            text.push_str(&format!("   vertex {x:.6} {y:.6} {z:.6}\n"));
        }
        text.push_str("  endloop\n endfacet\n");
    };
    for i in 0..along {
        for j in 0..around {
            let k = (j + 1) % around;
            let [p, q, r, s] = [point(i, j), point(i + 1, j), point(i + 1, k), point(i, k)];
            if i > 0 {
                facet([p, q, s]);
            }
            if i + 1 < along {
                facet([s, q, r]);
            }
        }
    }
    text + "endsolid hull\n"
}

#[test]
fn a_closed_mesh_is_meshed_once_computed_and_its_faults_are_told() {
    if !has_openfoam() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("hull.stl"), ellipsoid_mm(1.0)).unwrap();
    let path = at("campaign.toml");
    let with = |body: &str, plan: &str| {
        let a = CAMPAIGN.find("body = \"body.toml\"").unwrap();
        let b = CAMPAIGN.find("[identify]").unwrap();
        let text =
            format!("{}{body}\niterations = 400\nwindow = 40\ncold = 0\n[[source.plan]]\n{plan}\n", &CAMPAIGN[..a]);
        std::fs::write(&path, text + &CAMPAIGN[b..]).unwrap();
    };
    let cubes = "mesh = { surface_cell = \"8 mm\", first_layer = \"0.8 mm\", layers = 3 }\nradius = 5";
    let plan = "speed = \"0.4 m/s\"\nangle = \"90 deg\"";
    with(&format!("body = \"hull.stl\"\nunit = \"mm\"\n{cubes}"), plan);
    // A mesh by snappyHexMesh needs OpenFOAM; once it is made, planning does not.
    let bare = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_froude"));
        command.args(["cfd", "plan", text(&path)]).env("PATH", folder.path()).output().unwrap()
    };
    let said = String::from_utf8(bare().stderr).unwrap();
    assert!(said.contains("install the package openfoam"), "{said}");
    let planned = json(&["cfd", "plan", text(&path)]);
    assert!(bare().status.success());
    let row = &planned["configurations"][0];
    assert_eq!((row["mesher"].as_str(), row["layers"]["asked"].as_u64()), (Some("snappyHexMesh"), Some(3)));
    let near = |key: &str, expected: f64, part: f64| {
        let found = row[key].as_f64().unwrap();
        assert!((found / expected - 1.0).abs() < part, "{key}: {found}, {expected}");
    };
    near("length_m", 0.2, 1e-6);
    near("width_m", 0.06, 1e-6);
    // Polygons within an ellipse.
    near("area_m2", std::f64::consts::PI * 0.1 * 0.04, 0.03);
    assert!(row["cells"].as_u64().unwrap() > 2000 && row["layers"]["coverage"].as_f64().unwrap() > 0.5, "{row}");
    done(&["cfd", "run", text(&path), "--jobs", "1"]);
    let table = json(&["cfd", "collect", text(&path)]);
    assert_eq!(table["observations"].as_u64(), Some(1), "{}", done(&["cfd", "status", text(&path)]));
    let rows = std::fs::read_to_string(at("flow/observations.csv")).unwrap();
    let head: Vec<&str> = rows.lines().next().unwrap().split(',').collect();
    let row: Vec<&str> = rows.lines().nth(1).unwrap().split(',').collect();
    let of = |name: &str| {
        let column = head.iter().position(|h| h.starts_with(name)).unwrap();
        row[column].parse::<f64>().unwrap()
    };
    // An ellipse of 3 by 4 across the flow has a drag of 0.4 to 1.5 of ½ρU²A; the sides are alike.
    let scale_n = 0.5 * 1025.0 * 0.16 * 0.012566;
    assert!((0.3..1.6).contains(&(of("f_y") / scale_n)), "{rows}");
    assert!(of("f_x").abs() < 0.05 * of("f_y") && of("y_plus_mean") > 1.0, "{rows}");

    for (file, body, said) in [
        (ellipsoid_mm(1.0), "", "write unit = \"mm\""),
        (ellipsoid_mm(1.3), "unit = \"mm\"\n", "domain = \"full\""),
        (ellipsoid_mm(1.0).replacen("   vertex", "   vertex 1", 1), "unit = \"mm\"\n", "hull.stl"),
        (ellipsoid_mm(1.0), "unit = \"kg\"\n", "write the unit of the mesh"),
    ] {
        std::fs::write(at("hull.stl"), file).unwrap();
        with(&format!("body = \"hull.stl\"\n{body}{cubes}"), plan);
        let found = refused(&["cfd", "plan", text(&path)]);
        assert!(found.contains(said), "{said}: {found}");
    }
    let facets = ellipsoid_mm(1.0);
    let second = facets.match_indices(" facet").nth(1).unwrap().0;
    let first = facets.find(" facet").unwrap();
    std::fs::write(at("hull.stl"), format!("{}{}", &facets[..first], &facets[second..])).unwrap();
    with(&format!("body = \"hull.stl\"\nunit = \"mm\"\n{cubes}"), plan);
    let found = refused(&["cfd", "plan", text(&path)]);
    assert!(found.contains("the surface is open there") && found.contains("--repair"), "{found}");
}

/// Bare hull of the DARPA SUBOFF model (AFF-1), radius at the distance x behind the nose, both in ft.
///
/// Source: Groves, Huang and Chang (1989), Geometric characteristics of DARPA SUBOFF models, DTRC/SHD-1298-01.
fn suboff_radius_ft(x: f64) -> f64 {
    let largest = 5.0 / 6.0;
    if x <= 10.0 / 3.0 {
        let a = 0.3 * x - 1.0;
        let bow = 1.126_395_101 * x * a.powi(4) + 0.442_874_707 * x * x * a.powi(3) + 1.0 - a.powi(4) * (1.2 * x + 1.0);
        largest * bow.max(0.0).powf(1.0 / 2.1)
    } else if x <= 10.645_833 {
        largest
    } else if x <= 13.979_167 {
        let (s, h, k0, k1) = ((13.979_167 - x) / 3.333_333, 0.1175_f64, 10.0, 44.6244);
        let hh = h * h;
        let stern = hh
            + h * k0 * s.powi(2)
            + (20.0 - 20.0 * hh - 4.0 * h * k0 - k1 / 3.0) * s.powi(3)
            + (-45.0 + 45.0 * hh + 6.0 * h * k0 + k1) * s.powi(4)
            + (36.0 - 36.0 * hh - 4.0 * h * k0 - k1) * s.powi(5)
            + (-10.0 + 10.0 * hh + h * k0 + k1 / 3.0) * s.powi(6);
        largest * stern.sqrt()
    } else {
        0.1175 * largest * (1.0 - (3.2 * x - 44.733_333).powi(2)).max(0.0).sqrt()
    }
}

/// A closed surface of quadrilaterals between rings, in m; degenerate triangles at the tips are left out.
fn skin(rings: &[Vec<[f64; 3]>]) -> String {
    let mut text = "solid hull\n".to_owned();
    for pair in rings.windows(2) {
        let around = pair[0].len();
        for j in 0..around {
            let k = (j + 1) % around;
            let [p, q, r, s] = [pair[0][j], pair[1][j], pair[1][k], pair[0][k]];
            for [a, b, c] in [[p, s, q], [s, r, q]] {
                if a == b || b == c || c == a {
                    continue;
                }
                text.push_str(" facet normal 0 0 0\n  outer loop\n");
                for [x, y, z] in [a, b, c] {
                    text.push_str(&format!("   vertex {x:.7} {y:.7} {z:.7}\n"));
                }
                text.push_str("  endloop\n endfacet\n");
            }
        }
    }
    text + "endsolid hull\n"
}

fn suboff() -> String {
    let (length_ft, around, along) = (14.291_667, 96, 120);
    let ring = |i: usize| {
        let x = 0.5 * length_ft * (1.0 - (std::f64::consts::PI * i as f64 / along as f64).cos());
        let radius = if i == 0 || i == along { 0.0 } else { suboff_radius_ft(x) };
        let point = |j: usize| {
            let (sin, cos) = (std::f64::consts::TAU * j as f64 / around as f64).sin_cos();
            [7.0 - x, radius * sin, radius * cos].map(|ft| 0.3048 * ft)
        };
        (0..around).map(point).collect()
    };
    skin(&(0..=along).map(ring).collect::<Vec<_>>())
}

/// 1 m by 0.2 m by 0.2 m.
fn sharp_box() -> String {
    let ring = |x: f64, half: f64| {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[y, z]| [x, half * y, half * z]).to_vec()
    };
    skin(&[ring(-0.5, 0.0), ring(-0.5, 0.1), ring(0.5, 0.1), ring(0.5, 0.0)])
}

/// The default mesh adds all its layers to a slender hull and an ellipsoid. On a box they end at the sharp edges, and the part without them is in its uncertainty.
#[test]
fn the_default_mesh_of_a_surface_has_its_layers() {
    if !has_openfoam() {
        return;
    }
    for (name, surface, unit, part) in
        [("suboff", suboff(), "m", 0.95), ("ellipsoid", ellipsoid_mm(1.0), "mm", 0.95), ("box", sharp_box(), "m", 0.5)]
    {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("hull.stl"), surface).unwrap();
        let own = "body = \"body.toml\"\nmesh = { stations = 20, layers = 20, azimuth = 8, first_layer = \"0.5 mm\" }";
        let text = CAMPAIGN.replacen(own, &format!("body = \"hull.stl\"\nunit = \"{unit}\""), 1).replacen(
            "configurations = [\"H1LT\", \"H2LT\"]\n",
            "",
            1,
        );
        let path = folder.path().join("campaign.toml");
        std::fs::write(&path, text).unwrap();
        let planned = json(&["cfd", "plan", self::text(&path)]);
        let row = &planned["configurations"][0];
        let number = |key: &str| row["layers"][key].as_f64().unwrap();
        assert!(number("area_coverage") >= part, "{name}: {row}");
        assert!(name == "box" || number("mean") > 0.95 * number("asked"), "{name}: {row}");
    }
}

/// Rays of an O-grid cross in the necks, and a named mesh is then one of cubes; in a tank it is one too, a mesh an angle.
#[test]
fn necks_and_tanks_are_meshed_by_cubes() {
    if !has_openfoam() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = campaign(folder.path());
    let own = "mesh = { stations = 20, layers = 20, azimuth = 8, first_layer = \"0.5 mm\" }";
    let with = |mesh: &str| {
        let text = CAMPAIGN.replacen(own, mesh, 1).replacen(", \"H2LT\"", "", 1);
        assert!(text.contains(mesh) && !text.contains("H2LT"));
        std::fs::write(&path, text).unwrap();
        json(&["cfd", "plan", self::text(&path)])
    };
    let necked = SMOOTH_BODY.replace("ends =", "joint = { length = \"60 mm\", scale = 0.7, ramp = \"4 mm\" }\nends =");
    std::fs::write(folder.path().join("body.toml"), necked).unwrap();
    let planned = with("mesh = \"coarse\"");
    assert_eq!(planned["configurations"][0]["mesher"].as_str(), Some("snappyHexMesh"));
    assert!(planned["said"].to_string().contains("rays of an O-grid cross at"), "{}", planned["said"]);
    let tank = "mesh = { surface_cell = \"12 mm\", first_layer = \"2 mm\", layers = 2 }\n\
         tank = { width = \"1 m\", depth = \"0.6 m\", submergence = \"0.3 m\" }";
    let planned = with(tank);
    let rows = planned["configurations"].as_array().unwrap();
    assert_eq!(rows.len(), 3);
    let blocked: Vec<f64> = rows.iter().map(|row| row["blockage"].as_f64().unwrap()).collect();
    // Across, the side of some 0.023 m²; head on, the section.
    assert!(blocked[0] < blocked[1] && blocked[1] < blocked[2], "{blocked:?}");
    assert!((blocked[2] - rows[2]["area_m2"].as_f64().unwrap() / 0.6).abs() < 1e-9, "{blocked:?}");
    assert!(planned["said"].to_string().contains("the water slips"), "{}", planned["said"]);
}

/// Without OpenFOAM a sentence says what to install, and planning works.
#[test]
fn without_openfoam_a_sentence_says_what_to_install() {
    let folder = tempfile::tempdir().unwrap();
    let path = campaign(folder.path());
    let bare = |verb: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_froude"));
        command.args(["cfd", verb, text(&path)]).env("PATH", folder.path()).output().unwrap()
    };
    assert!(bare("plan").status.success());
    let output = bare("run");
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("OpenFOAM is not installed") && said.contains("install the package openfoam"), "{said}");
}
