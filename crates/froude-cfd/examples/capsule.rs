//! Forces on a capsule of the length 1 m and the width 0.09 m: at 0.4 m/s beside those of another program's mesh, and near 30° from the inflow and from a neighbour's fields.
//!
//! `cargo run --release -p froude-cfd --example capsule -- FOLDER`

use std::error::Error;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use froude_cfd::case::{Case, Flow, Model, Reference, Stop, Water};
use froude_cfd::o_grid::OGrid;
use froude_cfd::openfoam::OpenFoam;
use froude_cfd::solve::{How, solve};
use froude_mesh::sections::SectionBody;

/// Angle in degrees, speed in m/s, the row whose fields it starts from.
const ROWS: [(f64, f64, Option<usize>); 8] = [
    (0.0, 0.4, None),
    (30.0, 0.4, None),
    (60.0, 0.4, None),
    (90.0, 0.4, None),
    (33.0, 0.4, None),
    (33.0, 0.4, Some(1)),
    (30.0, 0.3, None),
    (30.0, 0.3, Some(1)),
];

/// f_x, f_y of the first rows in N: OpenFOAM 1912 with the same conditions on an O-grid of as many cells by another program.
const OTHER: [(f64, f64); 4] = [(-0.1870, 0.0), (-0.1667, 1.831), (0.182, 4.429), (0.000, 5.238)];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("name a folder to work in")?);
    let openfoam = OpenFoam::find()?;
    let grid =
        OGrid { stations: 40, layers: 35, around: 16, first_layer_m: 0.12e-3, outer_radius_m: 4.0, is_half: true };
    let (mesh, _) = grid.mesh(&SectionBody::capsule(0.455, 0.045, 0.045, 0.045, [1; 2]))?;
    let meshes = folder.join("meshes");
    std::fs::create_dir_all(&meshes)?;
    let mesh = mesh.write(&meshes)?;
    let how = How { openfoam: &openfoam, ranks: 1, cancel: &AtomicBool::new(false), tell: &|_| {} };
    println!(
        "| angle, ° | speed, m/s | start | f_x, N | f_y, N | std of f_x, f_y | other f_x, f_y | iterations | CPU, s | y+ |"
    );
    for (row, (angle_deg, speed_m_s, from)) in ROWS.into_iter().enumerate() {
        let attempt = |row: usize| folder.join(format!("cases/{row}"));
        std::fs::create_dir_all(attempt(row))?;
        let start_from = from.map(attempt);
        let outcome = solve(&capsule(angle_deg, speed_m_s), &mesh, start_from.as_deref(), &attempt(row), &how)?;
        let [x, y, ..] = outcome.loads.unwrap_or([f64::NAN; 6]);
        let [std_x, std_y, ..] = outcome.std_iterative.unwrap_or([f64::NAN; 6]);
        println!(
            "| {angle_deg} | {speed_m_s} | {} | {x:.4} | {y:.4} | {std_x:.4}, {std_y:.4} | {} | {} | {:.1} | {:.2?} | {:?}: {}",
            from.map_or("inflow".to_owned(), |row| format!("{}°, {} m/s", ROWS[row].0, ROWS[row].1)),
            OTHER.get(row).map_or(String::new(), |(x, y)| format!("{x}, {y}")),
            outcome.iterations,
            outcome.cpu_s,
            outcome.y_plus.unwrap_or_default(),
            outcome.status,
            outcome.reason,
        );
    }
    Ok(())
}

fn capsule(angle_deg: f64, speed_m_s: f64) -> Case {
    Case {
        id: format!("capsule-a{angle_deg:03}"),
        configuration: "capsule".to_owned(),
        mesh: "e".to_owned(),
        is_half: true,
        flow: Flow { speed_m_s, angle_rad: angle_deg.to_radians(), pitch_rad: 0.0 },
        water: Water { density_kg_m3: 1000.0, viscosity_m2_s: 1e-6 },
        model: Model::Sst { intensity: 0.01, viscosity_ratio: 1.0 },
        stop: Stop { iterations: 500, window: 40, drift: 2e-4, spread: 5e-4 },
        reference: Reference { length_m: 1.0, width_m: 0.09, area_m2: 0.0883, point_m: [0.0; 3] },
        start_from: None,
    }
}
