//! A campaign by OpenFOAM whose coordinator is killed while the solver runs.

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use froude_cfd::case::{Case, Flow, Model, Reference, Stop, Water};
use froude_cfd::change::plan;
use froude_cfd::collect::collect;
use froude_cfd::engine::local;
use froude_cfd::foam_solver::FoamSolver;
use froude_cfd::o_grid::OGrid;
use froude_cfd::openfoam::OpenFoam;
use froude_cfd::result::attempts;
use froude_cfd::store::Store;
use froude_mesh::sections::SectionBody;

const CAMPAIGN: &str = "FROUDE_TEST_CAMPAIGN";

fn case(id: &str, mesh: &str, angle_rad: f64, start_from: Option<&str>) -> Case {
    Case {
        id: id.to_owned(),
        configuration: "sphere".to_owned(),
        mesh: mesh.to_owned(),
        is_half: true,
        flow: Flow { speed_m_s: 0.001, angle_rad, pitch_rad: 0.0 },
        water: Water { density_kg_m3: 1000.0, viscosity_m2_s: 1e-6 },
        model: Model::Laminar,
        stop: Stop { iterations: 300, window: 40, drift: 1e-2, spread: 1e-2 },
        reference: Reference { length_m: 0.1, width_m: 0.1, area_m2: 0.00785, point_m: [0.0; 3] },
        start_from: start_from.map(str::to_owned),
    }
}

/// Not a test of its own: what is killed.
#[test]
fn coordinator() {
    let Ok(root) = std::env::var(CAMPAIGN) else { return };
    let solver = FoamSolver { openfoam: OpenFoam::find().unwrap(), ranks: 1 };
    let store = Store::open(Path::new(&root)).unwrap();
    local::run(&store, &solver, 1, &AtomicBool::new(false), &|_| {}).unwrap();
}

/// Processes that work in a folder.
fn at_work(folder: &Path) -> usize {
    let folder = folder.canonicalize().unwrap();
    let processes = std::fs::read_dir("/proc").unwrap().flatten();
    processes.filter(|p| std::fs::read_link(p.path().join("cwd")).is_ok_and(|cwd| cwd == folder)).count()
}

#[test]
fn a_solver_that_outlived_its_coordinator_is_ended_and_the_chain_goes_on() {
    let solver = match OpenFoam::find() {
        Ok(openfoam) => FoamSolver { openfoam, ranks: 1 },
        Err(e) => {
            assert!(std::env::var_os("CI").is_none(), "{e}");
            println!("left out: {e}");
            return;
        }
    };
    let folder = tempfile::tempdir().unwrap();
    let grid = OGrid { stations: 16, layers: 16, around: 8, first_layer_m: 0.01, outer_radius_m: 1.0, is_half: true };
    let (mesh, _) = grid.mesh(&SectionBody::ellipsoid([0.05; 3], 1)).unwrap();
    let meshes = folder.path().join("meshes");
    std::fs::create_dir(&meshes).unwrap();
    let written = mesh.write(&meshes).unwrap();
    let name = written.file_name().unwrap().to_str().unwrap();
    let cases = [case("cold", name, 0.2, None), case("warm", name, 0.25, Some("cold"))];
    let (store, _) = plan(folder.path(), &cases, "sha256").unwrap();

    let mut first = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "foam_campaign::coordinator"])
        .env(CAMPAIGN, folder.path())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let attempt = store.case_folder("cold").join("attempt-001");
    let start = Instant::now();
    while !(attempt.exists() && at_work(&attempt) > 0) {
        assert!(start.elapsed() < Duration::from_secs(30), "the solver did not begin");
        std::thread::sleep(Duration::from_millis(5));
    }
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(at_work(&attempt) > 0, "the solver outlives its coordinator");

    let ran = local::run(&store, &solver, 1, &AtomicBool::new(false), &|_| {}).unwrap();
    assert!(ran.left.is_empty(), "{ran:?}");
    assert_eq!(at_work(&attempt), 0);
    assert_eq!(attempts(&store.case_folder("cold")).unwrap().len(), 2);
    let collection = collect(&store);
    assert!(collection.without.is_empty(), "{collection:?}");
    let [cold, warm] = &collection.rows[..] else { panic!("{collection:?}") };
    assert_eq!((&cold.outcome.start_from, warm.outcome.start_from.as_deref()), (&None, Some("cold")));
    // One sphere: the force turns with the flow.
    let size = |row: &froude_cfd::collect::Collected| row.loads[0].hypot(row.loads[1]);
    assert!((size(cold) / size(warm) - 1.0).abs() < 0.02, "{} {}", size(cold), size(warm));
}
