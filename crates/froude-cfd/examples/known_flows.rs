//! Flows whose forces are known: a sphere at Re 100, a flat plate, a circular cylinder at Re 100 in time.
//!
//! `cargo run --release -p froude-cfd --example known_flows -- FOLDER sphere|plate|cylinder`

use std::error::Error;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use froude_cfd::case::{Case, Flow, Model, Reference, Stop, Water};
use froude_cfd::cylinder::Cylinder;
use froude_cfd::o_grid::OGrid;
use froude_cfd::openfoam::OpenFoam;
use froude_cfd::outcome::Outcome;
use froude_cfd::plate::Plate;
use froude_cfd::poly_mesh::PolyMesh;
use froude_cfd::solve::{How, solve};
use froude_cfd::transient::{Times, solve_in_time};
use froude_mesh::sections::SectionBody;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("name a folder to work in")?);
    let room = Room { folder, openfoam: OpenFoam::find()? };
    match arguments.next().as_deref() {
        Some("sphere") => sphere(&room),
        Some("plate") => plate(&room),
        Some("cylinder") => cylinder(&room),
        _ => Err("say sphere, plate or cylinder".into()),
    }
}

/// Four grids refined by √2 in each direction, out to 25 diameters; C_D is 1.087 (Clift, Grace & Weber 1978; Johnson & Patel 1999 have 1.08 to 1.09).
fn sphere(room: &Room) -> Result<()> {
    println!("| cells | C_D | std | iterations | CPU, s | |");
    let mut found = Vec::new();
    for level in 0..4 {
        let finer = 2.0_f64.sqrt().powi(level);
        let counts = [30.0, 30.0, 16.0].map(|n: f64| (n * finer).round() as usize);
        // Layers from the wall to the sphere grow 237-fold on each grid.
        let all = 237.0_f64;
        let first = 24.5 * (all.powf(1.0 / counts[1] as f64) - 1.0) / (all - 1.0);
        let grid = OGrid {
            stations: counts[0],
            layers: counts[1],
            around: counts[2],
            first_layer_m: first,
            outer_radius_m: 25.0,
            is_half: true,
        };
        let case = laminar(100.0, 1.0, PI / 4.0, true);
        let mesh = room.mesh(&grid.mesh(&SectionBody::ellipsoid([0.5; 3], 1))?.0)?;
        let outcome = room.solve(&case, &mesh, &format!("sphere-{level}"))?;
        let drag = |loads: Option<[f64; 6]>| loads.unwrap_or([f64::NAN; 6])[0].abs() / (0.5 * PI / 4.0);
        found.push((1.0 / finer, drag(outcome.loads)));
        println!(
            "| {} | {:.4} | {:.4} | {} | {:.0} | {}",
            outcome.cells,
            drag(outcome.loads),
            drag(outcome.std_iterative),
            outcome.iterations,
            outcome.cpu_s,
            outcome.reason
        );
    }
    for three in found.windows(3) {
        let [(_, coarse), (_, medium), (_, fine)] = three else { continue };
        let order = ((coarse - medium) / (medium - fine)).ln() / 2.0_f64.sqrt().ln();
        let limit = fine - (medium - fine) / (2.0_f64.sqrt().powf(order) - 1.0);
        println!("order {order:.2}, extrapolated C_D {limit:.4}");
    }
    Ok(())
}

/// Friction of one side is `1.328/√Re + 2.67/Re^(7/8)` of ½ρU²L: Blasius, and what the trailing edge adds (Stewartson 1969, Messiter 1970). Kuo's `2.3/Re` of 1953 has the leading edge alone, and is printed beside it.
fn plate(room: &Room) -> Result<()> {
    println!("| Re | cells | C_F | known | | leading edge alone | iterations | CPU, s | |");
    for (reynolds, far_m) in [(100.0_f64, 8.0), (1000.0, 4.0), (1e4, 3.0)] {
        let plate = Plate {
            length_m: 1.0,
            span_m: 0.1,
            along: 56,
            beyond: 50,
            layers: 80,
            first_layer_m: 0.05 / reynolds.sqrt(),
            far_m,
        };
        let mut case = laminar(reynolds, 1.0, plate.span_m, false);
        case.stop = Stop { iterations: 3000, window: 100, drift: 1e-5, spread: 1e-5 };
        let mesh = room.mesh(&plate.mesh()?.0)?;
        let outcome = room.solve(&case, &mesh, &format!("plate-{reynolds}"))?;
        let friction = outcome.loads.unwrap_or([f64::NAN; 6])[0].abs() / (0.5 * plate.span_m);
        let blasius = 1.328 / reynolds.sqrt();
        let known = blasius + 2.67 / reynolds.powf(7.0 / 8.0);
        println!(
            "| {reynolds} | {} | {friction:.5} | {known:.5} | {:+.2} % | {:.5} | {} | {:.0} | {}",
            outcome.cells,
            100.0 * (friction / known - 1.0),
            blasius + 2.3 / reynolds,
            outcome.iterations,
            outcome.cpu_s,
            outcome.reason
        );
    }
    Ok(())
}

/// C_D is 1.33 to 1.36, the Strouhal number 0.164 to 0.167 (Williamson 1989; Park, Kwon & Choi 1998).
fn cylinder(room: &Room) -> Result<()> {
    let cylinder =
        Cylinder { diameter_m: 1.0, span_m: 0.1, around: 140, layers: 80, first_layer_m: 0.01, outer_radius_m: 25.0 };
    let mesh = room.mesh(&cylinder.mesh()?.0)?;
    // From a steady flow at another angle, as a flow that is symmetric sheds late.
    let mut tilted = laminar(100.0, 1.0, cylinder.span_m, false);
    tilted.flow.angle_rad = 0.5;
    tilted.stop = Stop { iterations: 60, window: 60, drift: 0.0, spread: 0.0 };
    room.solve(&tilted, &mesh, "cylinder-tilted")?;
    let case = laminar(100.0, 1.0, cylinder.span_m, false);
    let times = Times { step_s: 0.02, from_s: 75.0, to_s: 93.5 };
    let start = room.folder.join("cases/cylinder-tilted");
    let attempt = room.attempt("cylinder")?;
    let found = solve_in_time(&case, times, &mesh, Some(&start), &attempt, &room.how(&AtomicBool::new(false)))?;
    println!(
        "cells {}, C_D {:.4}, St {:.4}, C_L up to {:.3}, CPU {:.0} s",
        mesh_cells(&cylinder),
        found.window.mean[0].abs() / (0.5 * cylinder.span_m),
        found.frequency_hz.unwrap_or(f64::NAN),
        found.window.spread[1] / (0.5 * cylinder.span_m),
        found.cpu_s
    );
    Ok(())
}

fn mesh_cells(cylinder: &Cylinder) -> usize {
    cylinder.around * cylinder.layers
}

/// A body of the length 1 m that moves along x at 1 m/s through water of the density 1 kg/m³.
fn laminar(reynolds: f64, length_m: f64, area_m2: f64, is_half: bool) -> Case {
    Case {
        id: "known".to_owned(),
        configuration: "known".to_owned(),
        mesh: "mesh".to_owned(),
        is_half,
        flow: Flow { speed_m_s: 1.0, angle_rad: 0.0, pitch_rad: 0.0 },
        water: Water { density_kg_m3: 1.0, viscosity_m2_s: 1.0 / reynolds },
        model: Model::Laminar,
        stop: Stop { iterations: 1500, window: 60, drift: 1e-4, spread: 1e-4 },
        reference: Reference { length_m, width_m: length_m, area_m2, point_m: [0.0; 3] },
        start_from: None,
    }
}

struct Room {
    folder: PathBuf,
    openfoam: OpenFoam,
}

impl Room {
    fn how<'a>(&'a self, cancel: &'a AtomicBool) -> How<'a> {
        How { openfoam: &self.openfoam, ranks: 1, cancel, tell: &|_| {} }
    }

    fn mesh(&self, mesh: &PolyMesh) -> Result<PathBuf> {
        let meshes = self.folder.join("meshes");
        std::fs::create_dir_all(&meshes)?;
        Ok(mesh.write(&meshes)?)
    }

    fn attempt(&self, name: &str) -> Result<PathBuf> {
        let attempt = self.folder.join("cases").join(name);
        std::fs::create_dir_all(&attempt)?;
        Ok(attempt)
    }

    fn solve(&self, case: &Case, mesh: &Path, name: &str) -> Result<Outcome> {
        Ok(solve(case, mesh, None, &self.attempt(name)?, &self.how(&AtomicBool::new(false)))?)
    }
}
