//! The error of a mesh, from the plan of a campaign to the coefficients: by a solver whose forces and errors are known in closed form.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use froude::cfd::store::Store;
use froude::cfd::verb::{self, Engine, Running, collect, plan, report, retry, status, suggest};
use froude::pipeline::{Job, identify};
use froude::records::estimate::Estimate;
use froude::records::outcome::Outcome as Answer;
use froude::report::write::write_folder;
use froude_cfd::engine::local;
use froude_cfd::foam_mesh::FoamMesh;
use froude_cfd::outcome::{Outcome, Status};
use froude_cfd::wall::{MeshQuality, WallLayers};
use froude_cfd::work::{Solve, Task};
use serde_json::Value;

use crate::held::of_verb;

const BODY: &str = "schema = 1\nname = \"smooth\"\n[body]\nshape = \"robot\"\n\
     link = { major_semi_axis = \"58.8 mm\", minor_semi_axis = \"39.4 mm\", half_length = \"90 mm\" }\nends = { length = \"31 mm\" }\n";

const CAMPAIGN: &str = r#"schema = 1
name = "computed"
[fluid]
density = "1025 kg/m^3"
kinematic_viscosity = "1.19e-6 m^2/s"
[[source]]
name  = "CFD"
kind  = "cfd"
cases = "flow"
group = "run"
[source.cfd]
body = "body.toml"
mesh = { stations = 20, layers = 20, azimuth = 8, first_layer = "0.5 mm" }
radius = 6
cold = 0
STUDY
[[source.plan]]
configurations = ["H1LT", "H2LT"]
speed = ["0.2 m/s", "0.4 m/s"]
angle = ["0 deg", "45 deg", "90 deg"]
[[identify.model]]
name = "sway"
f_y = "-Y_vav*v*abs(v)"
"#;

const STUDY: &str = "[[source.cfd.study]]\nspeed = \"0.4 m/s\"\nangle = [\"0 deg\", \"45 deg\", \"90 deg\"]\n";

/// kg/m: f_y = −K v|v| on cells of no size.
const K_KG_M: f64 = 30.0;
/// Part of the force that the campaign's mesh of 3,200 cells adds, which falls with the square of the cells' size.
const ERROR: f64 = 0.04;
const OWN_CELLS: f64 = 3200.0;

/// Answers with the law.
struct Known;

impl Solve for Known {
    fn solve(&self, task: &Task<'_>) -> Result<Outcome, String> {
        let cells = FoamMesh::read(task.mesh).map_err(|e| e.to_string())?.cells;
        let [_, v, _] = task.case.flow.velocity_m_s();
        // A right angle has a cosine of rounding.
        let v = if v.abs() < 1e-12 { 0.0 } else { v };
        let f_y = -K_KG_M * v * v.abs() * (1.0 + at(cells as f64));
        Ok(Outcome {
            status: Status::Converged,
            reason: String::new(),
            loads: Some([0.0, f_y, 0.0, 0.0, 0.0, 0.0]),
            pressure: None,
            std_iterative: Some([0.0; 6]),
            iterations: 100,
            cpu_s: 1.0,
            y_plus: None,
            mesh: None,
            start_from: None,
            cells,
            solver_version: "known".to_owned(),
        })
    }
}

/// Part of the force that a mesh adds.
fn at(cells: f64) -> f64 {
    ERROR * (OWN_CELLS / cells).powf(2.0 / 3.0)
}

fn planned(path: &Path) -> Value {
    json(&plan(path, None, 2, &AtomicBool::new(false), &|_| ()).unwrap())
}

fn json(answer: &Answer) -> Value {
    serde_json::to_value(answer.json()).unwrap()
}

/// A campaign with what it computes again, computed.
fn computed(folder: &Path, again: &str) -> PathBuf {
    std::fs::write(folder.join("body.toml"), BODY).unwrap();
    let path = folder.join("campaign.toml");
    std::fs::write(&path, CAMPAIGN.replace("STUDY", again)).unwrap();
    planned(&path);
    local::run(&Store::open(&folder.join("flow")).unwrap(), &Known, 2, &AtomicBool::new(false), &|_| ()).unwrap();
    path
}

fn fitted(path: &Path) -> Estimate {
    let done = identify(&Job::new(path), &|_| ()).unwrap();
    done.file.estimates.into_iter().find(|e| e.coefficients.contains_key("Y_vav")).unwrap()
}

/// Part of the coefficient that an error of the budget is.
fn part(estimate: &Estimate, name: &str) -> f64 {
    let c = &estimate.coefficients["Y_vav"];
    let value = c.value.unwrap();
    let own: f64 = estimate
        .errors
        .values()
        .filter(|e| e.name == name)
        .map(|e| (e.sensitivity[0][0].powi(2) * e.covariance[0][0]).sqrt())
        .sum();
    own / value
}

/// What each verb says of a campaign that is computed.
#[test]
fn what_is_said_of_a_campaign_is_what_programs_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = computed(folder.path(), STUDY);
    let idle = AtomicBool::new(false);
    of_verb("cfd-plan", &[&plan(&path, None, 2, &idle, &|_| ()).unwrap()]);
    of_verb("cfd-status", &[&status(&path, None).unwrap()]);
    of_verb("cfd-collect", &[&collect(&path, None).unwrap()]);
    of_verb("cfd-suggest", &[&suggest(&path, None, 3).unwrap()]);
    of_verb("cfd-retry", &[&retry(&path, None, &[]).unwrap()]);
    let job = verb::Job { campaign: path.clone(), source: None, engine: Engine::Local { jobs: 1, ranks: 1 } };
    of_verb("cfd-run", &[&verb::run(&job, &idle, &Running::new(&|_| (), &|_| ())).unwrap()]);
    let out = folder.path().join("page");
    let page = report(&path, None, &[], &out, None, &|_| ()).unwrap();
    write_folder(&page, &out).unwrap();
    of_verb("cfd-report", &[&page]);
}

/// An error of q % of all forces that all cases share is one of q % of a coefficient that they are proportional to.
#[test]
fn an_error_of_the_mesh_widens_a_coefficient_by_as_much() {
    let folder = tempfile::tempdir().unwrap();
    let path = computed(folder.path(), STUDY);
    let found = json(&collect(&path, None).unwrap());
    assert_eq!(found["observations"].as_u64(), Some(12), "{found}");
    let studies = found["numerical"]["studies"].as_array().unwrap();
    assert_eq!(studies.len(), 6);
    let f_y = &studies[1]["error"].as_array().unwrap().iter().find(|e| e["load"] == "f_y").unwrap();
    assert_eq!(studies[1]["grids"].as_array().unwrap().len(), 4);
    assert!((f_y["order"].as_f64().unwrap() - 2.0).abs() < 1e-6, "{f_y}");
    let limit_n = K_KG_M * 0.16 * 0.5;
    assert!((f_y["extrapolated"].as_f64().unwrap() / limit_n - 1.0).abs() < 1e-6, "{f_y}");
    // 1.25 times the distance to the limit.
    assert!((f_y["expanded_of_campaign"].as_f64().unwrap() / (1.25 * ERROR * limit_n) - 1.0).abs() < 1e-5, "{f_y}");

    let table = std::fs::read_to_string(folder.path().join("flow/observations.csv")).unwrap();
    let head = table.lines().next().unwrap();
    for column in ["std_iterative_f_x [N]", "std_iterative_m_z [N m]", "std_numerical_f_y [N]"] {
        assert!(head.contains(column), "{head}");
    }
    assert!(!head.contains("correction"), "{head}");

    let estimate = fitted(&path);
    let c = &estimate.coefficients["Y_vav"];
    assert!((c.value.unwrap() / (K_KG_M * (1.0 + ERROR)) - 1.0).abs() < 1e-6, "{c:?}");
    let expected = 0.5 * 1.25 * ERROR / (1.0 + ERROR);
    assert!((part(&estimate, "mesh (f_y)") / expected - 1.0).abs() < 1e-4, "{:?}", estimate.errors);
    let relative = c.standard_uncertainty.unwrap() / c.value.unwrap();
    assert!((relative / expected - 1.0).abs() < 1e-4, "{c:?}");
}

/// The forces of the finer mesh, at every setting; the study says what they leave.
#[test]
fn a_finer_mesh_at_some_cases_corrects_all() {
    let folder = tempfile::tempdir().unwrap();
    let fine = "fine = { mesh = { stations = 40, layers = 40, azimuth = 16, first_layer = \"0.25 mm\" }, every = 1 }\n";
    let path = computed(folder.path(), &format!("{fine}{STUDY}"));
    let found = json(&collect(&path, None).unwrap());
    assert_eq!(found["numerical"]["fine"].as_array().unwrap().len(), 12, "{found}");
    let words = found["findings"].to_string();
    assert!(words.contains("loads are corrected to the finer mesh by 12 cases"), "{words}");

    let estimate = fitted(&path);
    let value = estimate.coefficients["Y_vav"].value.unwrap();
    assert!((value / (K_KG_M * (1.0 + at(8.0 * OWN_CELLS))) - 1.0).abs() < 1e-6, "{value}");
    // A quarter of the error is left, and what leaving an angle out of three misses.
    assert!(part(&estimate, "mesh (f_y)") > 0.5 * 1.25 * 0.25 * ERROR / (1.0 + ERROR), "{:?}", estimate.errors);
}

/// Where nothing is computed again the error of the mesh is unknown, and that is said.
#[test]
fn a_mesh_that_nothing_is_known_of_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = computed(folder.path(), "");
    let words = json(&collect(&path, None).unwrap())["findings"].to_string();
    assert!(words.contains("the error of the mesh is in no interval"), "{words}");
    let table = std::fs::read_to_string(folder.path().join("flow/observations.csv")).unwrap();
    assert!(!table.contains("std_numerical"), "{table}");
    assert_eq!(part(&fitted(&path), "mesh (f_y)"), 0.0);
    let refused = |again: &str| {
        std::fs::write(&path, CAMPAIGN.replace("STUDY", again)).unwrap();
        plan(&path, None, 2, &AtomicBool::new(false), &|_| ()).unwrap_err().to_string()
    };
    let other = refused("[[source.cfd.study]]\nspeed = \"0.3 m/s\"\n");
    assert!(other.contains("campaign.toml") && other.contains("H1LT at 0.3 m/s and 0°"), "{other}");
    let other = refused("[[source.cfd.study]]\nconfigurations = [\"H3LT\"]\nspeed = \"0.4 m/s\"\n");
    assert!(other.contains("names \"H3LT\", which the plan does not compute"), "{other}");
}

/// Answers with the law, on a mesh whose wall is resolved as it says.
struct AtWall {
    mean_y_plus: f64,
    area_coverage: f64,
}

impl Solve for AtWall {
    fn solve(&self, task: &Task<'_>) -> Result<Outcome, String> {
        let layers = WallLayers {
            requested: 10,
            achieved: 10.0 * self.area_coverage,
            thickness_coverage: self.area_coverage,
            area_coverage: self.area_coverage,
        };
        let mesh = MeshQuality { max_non_orthogonality_rad: 1.0, max_skewness: 1.5, layers: Some(layers) };
        let y_plus = Some([0.5 * self.mean_y_plus, self.mean_y_plus, 2.0 * self.mean_y_plus]);
        Ok(Outcome { y_plus, mesh: Some(mesh), ..Known.solve(task)? })
    }
}

/// A campaign on such a mesh.
fn at_wall(folder: &Path, solver: &AtWall) -> PathBuf {
    std::fs::write(folder.join("body.toml"), BODY).unwrap();
    let path = folder.join("campaign.toml");
    std::fs::write(&path, CAMPAIGN.replace("STUDY", "")).unwrap();
    planned(&path);
    local::run(&Store::open(&folder.join("flow")).unwrap(), solver, 2, &AtomicBool::new(false), &|_| ()).unwrap();
    path
}

/// Layers that are missing on a part of the body, and a mean y+ between the sublayer and the end of the law of the wall, widen the coefficient, and the record says so.
#[test]
fn a_wall_that_is_resolved_in_part_widens_the_interval_and_is_a_finding() {
    for (mean_y_plus, area_coverage, half_width) in [(1.0, 1.0, 0.0), (1.0, 0.7, 0.3), (40.0, 1.0, 0.11)] {
        let folder = tempfile::tempdir().unwrap();
        let path = at_wall(folder.path(), &AtWall { mean_y_plus, area_coverage });
        let done = identify(&Job::new(&path), &|_| ()).unwrap();
        let estimate = done.file.estimates.iter().find(|e| e.coefficients.contains_key("Y_vav")).unwrap();
        let found = 2.0 * part(estimate, "mesh at the wall (f_y)");
        assert!((found - half_width).abs() < 1e-6, "{mean_y_plus} {area_coverage}: {found}");
        let record = std::fs::read_to_string(folder.path().join("campaign-results/estimate.json")).unwrap();
        assert_eq!(record.contains("\"cfd-wall\""), half_width > 0.0, "{mean_y_plus} {area_coverage}");
        let layers = format!("layers cover at least {:.0} % of the body's area", 100.0 * area_coverage);
        assert!(record.contains(&layers) && record.contains("non-orthogonality up to 57°"), "{record}");
        assert!(record.contains("the error of the mesh is in no interval"), "{record}");
        assert!(!record.contains("tare"), "{record}");
        assert!(record.contains("no uncertainty of the computation is declared"), "{record}");
        let table = std::fs::read_to_string(folder.path().join("flow/observations.csv")).unwrap();
        for column in ["layer_coverage", "layers_requested", "non_orthogonality", "skewness", "y_plus_mean"] {
            assert!(table.contains(column), "{table}");
        }
    }
}

/// Without layers on most of the body, or with a first cell beyond the law of the wall, a case has no result, in run, status and collect alike.
#[test]
fn a_wall_that_is_not_resolved_leaves_no_result() {
    for (mean_y_plus, area_coverage, said) in
        [(1.0, 0.2, "layers cover 20 % of the body's area"), (900.0, 1.0, "make first_layer of mesh")]
    {
        let folder = tempfile::tempdir().unwrap();
        let path = at_wall(folder.path(), &AtWall { mean_y_plus, area_coverage });
        let refused = collect(&path, None).unwrap_err().to_string();
        assert!(refused.contains(said), "{refused}");
        let status = json(&status(&path, None).unwrap());
        assert_eq!(status["counts"]["failed"].as_u64(), Some(12), "{status}");
    }
}

/// A wider domain that answers the same has no error, and stands in the plan with its cells.
#[test]
fn meshes_of_a_study_are_planned_and_priced() {
    let folder = tempfile::tempdir().unwrap();
    let again = format!("{STUDY}grids = 3\nradius = [12]\n");
    let path = computed(folder.path(), &again);
    let rows = planned(&path);
    let rows = rows["configurations"].as_array().unwrap();
    let of = |name: &str| rows.iter().find(|r| r["mesh"] == name && r["configuration"] == "H2LT").unwrap();
    let cells = |name: &str| of(name)["cells"].as_f64().unwrap();
    assert_eq!((rows.len(), of("")["cases"].as_u64(), of("r12")["cases"].as_u64()), (8, Some(6), Some(3)));
    for (name, ratio) in [("coarser", 8_f64.powf(-0.5)), ("finer", 8_f64.sqrt())] {
        assert!((cells(name) / (OWN_CELLS * ratio) - 1.0).abs() < 0.1, "{name}: {}", cells(name));
    }
    assert!((1.0..1.2).contains(&(cells("r12") / OWN_CELLS)), "{}", cells("r12"));
    let found = json(&collect(&path, None).unwrap());
    assert_eq!(found["numerical"]["studies"][0]["domains"][0]["radius"].as_f64(), Some(12.0), "{found}");
}
