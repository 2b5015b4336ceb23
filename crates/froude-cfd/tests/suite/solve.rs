//! Whole cases by OpenFOAM on a mesh of a few thousand cells.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use froude_cfd::case::{Case, Flow, Model, Reference, Stop, Water};
use froude_cfd::flow_field::FlowField;
use froude_cfd::history;
use froude_cfd::midplane::Midplane;
use froude_cfd::o_grid::OGrid;
use froude_cfd::openfoam::OpenFoam;
use froude_cfd::outcome::{Outcome, Status};
use froude_cfd::solve::{How, Progress, SolveError, solve};
use froude_cfd::surface_pressure::{facets, pressure_force_n};
use froude_mesh::sections::SectionBody;
use froude_mesh::vector::norm;

/// A laminar sphere of the diameter 0.1 m at the Reynolds number 100.
fn sphere() -> Case {
    let radius_m = 0.05;
    Case {
        id: "sphere".to_owned(),
        configuration: "sphere".to_owned(),
        mesh: "sphere".to_owned(),
        is_half: true,
        flow: Flow { speed_m_s: 0.001, angle_rad: 0.5, pitch_rad: 0.0 },
        water: Water { density_kg_m3: 1000.0, viscosity_m2_s: 1e-6 },
        model: Model::Laminar,
        stop: Stop { iterations: 400, window: 40, drift: 1e-3, spread: 1e-3 },
        reference: Reference {
            length_m: 2.0 * radius_m,
            width_m: 2.0 * radius_m,
            area_m2: std::f64::consts::PI * radius_m * radius_m,
            point_m: [0.0; 3],
        },
        start_from: None,
    }
}

struct Room {
    root: tempfile::TempDir,
    mesh: PathBuf,
    openfoam: OpenFoam,
}

impl Room {
    /// `None` where OpenFOAM is absent: said here, and not allowed in the pipeline.
    fn new() -> Option<Self> {
        let openfoam = match OpenFoam::find() {
            Ok(found) => found,
            Err(e) => {
                assert!(std::env::var_os("CI").is_none(), "{e}");
                println!("left out: {e}");
                return None;
            }
        };
        let root = tempfile::tempdir().unwrap();
        let grid =
            OGrid { stations: 16, layers: 20, around: 8, first_layer_m: 0.008, outer_radius_m: 1.25, is_half: true };
        let (mesh, _) = grid.mesh(&SectionBody::ellipsoid([0.05; 3], 1)).unwrap();
        let meshes = root.path().join("meshes");
        std::fs::create_dir(&meshes).unwrap();
        let mesh = mesh.write(&meshes).unwrap();
        Some(Self { root, mesh, openfoam })
    }

    fn attempt(&self, name: &str) -> PathBuf {
        let attempt = self.root.path().join("cases").join(name);
        std::fs::create_dir_all(&attempt).unwrap();
        attempt
    }

    fn solve(
        &self,
        case: &Case,
        ranks: usize,
        start_from: Option<&Path>,
        attempt: &Path,
    ) -> Result<Outcome, SolveError> {
        let how = How { openfoam: &self.openfoam, ranks, cancel: &AtomicBool::new(false), tell: &|_| {} };
        solve(case, &self.mesh, start_from, attempt, &how)
    }
}

#[test]
fn a_sphere_is_pushed_along_the_water_and_mpi_says_the_same() {
    let Some(room) = Room::new() else { return };
    let mut case = sphere();
    // Many iterations: what remains then is the order of additions.
    case.stop = Stop { drift: 1e-10, spread: 1e-10, iterations: 120, window: 60 };
    let serial = room.solve(&case, 1, None, &room.attempt("serial")).unwrap();
    println!("{serial:?}");
    let loads = serial.loads.unwrap();
    let (sin, cos) = case.flow.angle_rad.sin_cos();
    let drag_n = loads[1] * sin - loads[0] * cos;
    let scale_n = 0.5 * 1000.0 * case.flow.speed_m_s.powi(2) * case.reference.area_m2;
    // 1.087 of Clift, Grace and Weber; this mesh is coarse.
    assert!((drag_n / scale_n - 1.087).abs() < 0.1, "C_D {}", drag_n / scale_n);
    // Cells along the axis and across it differ, and so do their errors.
    assert!((loads[0] * sin + loads[1] * cos).abs() < 0.03 * drag_n, "{loads:?}");
    assert_eq!((loads[2], loads[3], loads[4], serial.cells), (0.0, 0.0, 0.0, 2560));

    let kept = |attempt: &str| -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(room.attempt(attempt))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| !name.starts_with("log."))
            .collect();
        names.sort();
        names
    };
    assert_eq!(kept("serial"), ["120", "constant", "postProcessing", "system"]);
    what_it_left_is_the_flow_of_its_forces(&room, &case, &room.attempt("serial"));

    let parallel = room.solve(&case, 2, None, &room.attempt("parallel")).unwrap();
    println!("{parallel:?}");
    assert_eq!(parallel.iterations, serial.iterations);
    assert_eq!(kept("parallel"), kept("serial"));
    for (one, two) in loads.iter().zip(parallel.loads.unwrap()) {
        assert!((one - two).abs() < 1e-6 * drag_n, "{loads:?} {parallel:?}");
    }
}

/// The pressure on the surface sums up to the force that the solver wrote, is that of stagnation where the water meets the sphere, and the water far away is undisturbed.
fn what_it_left_is_the_flow_of_its_forces(room: &Room, case: &Case, attempt: &Path) {
    let field = FlowField::read(&room.mesh, attempt).unwrap();
    assert_eq!(field.time, 120.0);
    let facets = facets(case, &field);
    assert_eq!(facets.len(), 2 * 16 * 8);
    let written = history::read(attempt, true).unwrap().last().unwrap().pressure;
    let summed = pressure_force_n(case, &facets);
    // Thirteen digits are written.
    let size_n = written[0].hypot(written[1]);
    for axis in [0, 1] {
        assert!((summed[axis] - written[axis]).abs() < 1e-10 * size_n, "{summed:?} {written:?}");
    }
    assert!(summed[2].abs() < 1e-12 * size_n, "{summed:?}");

    let most = facets.iter().max_by(|a, b| a.pressure_coefficient.total_cmp(&b.pressure_coefficient)).unwrap();
    let towards = norm(most.area_m2);
    let against = case.flow.velocity_m_s().iter().zip(most.area_m2).map(|(v, s)| -v * s).sum::<f64>();
    let cosine = against / (case.flow.speed_m_s * towards);
    println!("C_p {} at {}° from the stagnation point", most.pressure_coefficient, cosine.acos().to_degrees());
    // A cell of the meridian is 11°, one around 22°.
    assert!(cosine > 12_f64.to_radians().cos(), "{cosine}");
    // Homann (1936): 1 + 6/(Re + 0.455 √Re) at the point itself, Re of the radius: 1.113. On this mesh 0.903 is found, on one twice as fine
    // in all directions 1.037: the mesh's error. This tests the place and the size; that values are read right, the sum above tests.
    let homann = 1.0 + 6.0 / (50.0 + 0.455 * 50.0_f64.sqrt());
    assert!((homann - 0.25..homann).contains(&most.pressure_coefficient), "{} of {homann}", most.pressure_coefficient);

    let slice = Midplane::of(case, &field);
    assert_eq!((slice.cells.len(), slice.body_m.len()), (2 * 16 * 20, 2 * 16));
    // Ahead of the sphere, beyond 8 of its radii: a source of the displaced water leaves 1/8³ of the speed.
    let (sin, cos) = case.flow.angle_rad.sin_cos();
    let ahead = slice.cells.iter().filter(|cell| {
        let count = cell.corners_m.len() as f64;
        cell.corners_m.iter().map(|[x, y]| x * cos - y * sin).sum::<f64>() / count > 0.4
    });
    let far: Vec<f64> = ahead.map(|cell| cell.speed_ratio).collect();
    assert!(far.len() > 20 && far.iter().all(|ratio| (ratio - 1.0).abs() < 0.01), "{far:?}");
    // No slip at the wall, and no water faster than potential flow has it, 3/2.
    let range =
        slice.cells.iter().fold([1.0_f64; 2], |[low, high], c| [low.min(c.speed_ratio), high.max(c.speed_ratio)]);
    assert!(range[0] < 0.1 && range[1] < 1.5, "{range:?}");
}

#[test]
fn a_case_that_starts_from_another_ends_sooner_at_the_same_force() {
    let Some(room) = Room::new() else { return };
    let first = sphere();
    let from = room.attempt("first");
    let cold = room.solve(&first, 1, None, &from).unwrap();
    assert_eq!(cold.status, Status::Converged, "{cold:?}");

    let mut case = sphere();
    case.flow.speed_m_s *= 1.5;
    case.start_from = Some("first".to_owned());
    let cold = room.solve(&case, 1, None, &room.attempt("cold")).unwrap();
    let warm = room.solve(&case, 1, Some(&from), &room.attempt("warm")).unwrap();
    println!("{cold:?}\n{warm:?}");
    assert_eq!((cold.status, warm.status), (Status::Converged, Status::Converged), "{cold:?} {warm:?}");
    assert!(warm.iterations < cold.iterations, "{} {}", warm.iterations, cold.iterations);
    assert_eq!(warm.start_from.as_deref(), Some("first"));
    for load in [0, 1] {
        let apart = (warm.loads.unwrap()[load] - cold.loads.unwrap()[load]).abs();
        let std = warm.std_iterative.unwrap()[load].hypot(cold.std_iterative.unwrap()[load]);
        assert!(apart < 2.0 * std, "{apart} {std}");
    }
}

#[test]
fn a_case_that_is_cancelled_stops_at_once_and_has_no_outcome() {
    let Some(room) = Room::new() else { return };
    let mut case = sphere();
    case.stop = Stop { drift: 0.0, spread: 0.0, iterations: 100_000, window: 50_000 };
    let cancel = AtomicBool::new(false);
    let told = Mutex::new(Vec::new());
    let tell = |progress: Progress| {
        told.lock().unwrap().push(progress);
        cancel.store(true, Ordering::Relaxed);
    };
    let how = How { openfoam: &room.openfoam, ranks: 2, cancel: &cancel, tell: &tell };
    let refused = solve(&case, &room.mesh, None, &room.attempt("cancelled"), &how).unwrap_err();
    assert!(refused.is_cancelled(), "{refused}");
    let told = told.into_inner().unwrap();
    assert!(told[0].iteration > 0 && told[0].of == 100_000 && told[0].force_n[0] < 0.0, "{told:?}");
}

#[test]
fn a_mesh_with_crossed_cells_is_said_to_diverge() {
    let Some(room) = Room::new() else { return };
    let points = room.mesh.join("points");
    let text = std::fs::read_to_string(&points).unwrap();
    let mut lines: Vec<&str> = text.lines().collect();
    let is_inner = |line: &str| {
        let z = line.trim_matches(['(', ')']).split(' ').nth(2).and_then(|z| z.parse::<f64>().ok());
        z.is_some_and(|z| z > 0.02)
    };
    let inner: Vec<usize> = (0..lines.len()).filter(|i| is_inner(lines[*i])).collect();
    // Two points change their places: cells about them are inside out.
    lines.swap(inner[300], inner[400]);
    std::fs::write(&points, lines.join("\n")).unwrap();
    let outcome = room.solve(&sphere(), 1, None, &room.attempt("crossed")).unwrap();
    assert_eq!(outcome.status, Status::Diverged, "{outcome:?}");
    println!("{outcome:?}");
}

#[test]
fn a_solver_that_refuses_its_case_has_failed_with_its_own_words() {
    let Some(room) = Room::new() else { return };
    let owner = room.mesh.join("owner");
    let text = std::fs::read_to_string(&owner).unwrap();
    std::fs::write(&owner, &text[..text.len() / 2]).unwrap();
    let outcome = room.solve(&sphere(), 1, None, &room.attempt("cut")).unwrap();
    assert_eq!((outcome.status, outcome.loads), (Status::Failed, None));
    assert!(outcome.reason.starts_with("the solver ended with the error: "), "{}", outcome.reason);
}
