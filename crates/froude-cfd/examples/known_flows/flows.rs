//! Flows whose forces are known, by cases of this library: a sphere and a circular cylinder at Re 100, a flat plate, a capsule that another program computed.

use std::error::Error;
use std::f64::consts::{PI, SQRT_2};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use froude_cfd::case::{Case, Flow, Model, Reference, Stop, Water};
use froude_cfd::grid_error::OnGrid;
use froude_cfd::o_grid::OGrid;
use froude_cfd::openfoam::OpenFoam;
use froude_cfd::outcome::Outcome;
use froude_cfd::poly_mesh::PolyMesh;
use froude_cfd::solve::{How, solve};
use froude_cfd::transient::{Times, solve_in_time};
use froude_mesh::sections::SectionBody;

#[path = "cylinder_mesh.rs"]
mod cylinder_mesh;
#[path = "plate_mesh.rs"]
mod plate_mesh;

use cylinder_mesh::Cylinder;
use plate_mesh::Plate;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Where cases are computed, and by what.
pub struct Room {
    folder: PathBuf,
    openfoam: OpenFoam,
}

/// A coefficient with what it was computed on.
#[derive(Debug, Clone)]
pub struct Found {
    pub value: f64,
    pub std_iterative: f64,
    pub outcome: Outcome,
}

impl Found {
    pub fn on_grid(&self) -> OnGrid {
        OnGrid { cells: self.outcome.cells, value: self.value, std_iterative: self.std_iterative }
    }

    /// The drag over `scale_n`.
    fn drag(outcome: Outcome, scale_n: f64) -> Self {
        let of = |loads: Option<[f64; 6]>| loads.unwrap_or([f64::NAN; 6])[0].abs() / scale_n;
        Self { value: of(outcome.loads), std_iterative: of(outcome.std_iterative), outcome }
    }
}

/// C_D of a sphere at Re 100 on a grid finer by √2 in each direction for each level: 14,400 cells at level 0, out to 25 diameters.
///
/// 1.087 ± 1 %: Clift, Grace & Weber, Bubbles, Drops and Particles (1978); Johnson & Patel, J. Fluid Mech. 378 (1999), have 1.08 to 1.09.
pub fn sphere(room: &Room, level: i32) -> Result<Found> {
    let finer = SQRT_2.powi(level);
    let [stations, layers, around] = [30.0, 30.0, 16.0].map(|n: f64| (n * finer).round() as usize);
    // Layers from the wall to the far sphere grow 237-fold on each grid.
    let all = 237.0_f64;
    let first_layer_m = 24.5 * (all.powf(1.0 / layers as f64) - 1.0) / (all - 1.0);
    let grid = OGrid { stations, layers, around, first_layer_m, outer_radius_m: 25.0, is_half: true };
    let case = laminar(100.0, 1.0, PI / 4.0, true);
    let mesh = room.mesh(&grid.mesh(&SectionBody::ellipsoid([0.5; 3], 1))?.0)?;
    Ok(Found::drag(room.solve(&case, &mesh, &format!("sphere-{level}"))?, 0.5 * PI / 4.0))
}

/// C_F of one side of a plate of the length 1 m, with the domain that it needs.
pub fn plate(room: &Room, reynolds: f64, far_m: f64) -> Result<Found> {
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
    Ok(Found::drag(room.solve(&case, &mesh, &format!("plate-{reynolds}"))?, 0.5 * plate.span_m))
}

/// `1.328/√Re + 2.67/Re^(7/8)`: Blasius, and what the trailing edge adds (Stewartson 1969, Messiter 1970). Kuo's `2.3/Re` of 1953 has the leading edge alone.
pub fn plate_friction(reynolds: f64) -> f64 {
    1.328 / reynolds.sqrt() + 2.67 / reynolds.powf(7.0 / 8.0)
}

/// C_D and the Strouhal number of a circular cylinder at Re 100 in time, out to 25 diameters; and the time of a processor, s.
///
/// 1.33 to 1.36 and 0.164 to 0.167: Williamson, J. Fluid Mech. 206 (1989); Park, Kwon & Choi, KSME Int. J. 12 (1998).
pub fn cylinder(room: &Room) -> Result<[f64; 3]> {
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
    let drag = found.window.mean[0].abs() / (0.5 * cylinder.span_m);
    Ok([drag, found.frequency_hz.unwrap_or(f64::NAN), found.cpu_s])
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

/// A grid about the capsule, out to 4 m.
pub const fn capsule_grid(stations: usize, layers: usize, around: usize, first_layer_m: f64) -> OGrid {
    OGrid { stations, layers, around, first_layer_m, outer_radius_m: 4.0, is_half: true }
}

/// The capsule: 1 m long, 0.09 m wide.
pub fn capsule_body() -> SectionBody {
    SectionBody::capsule(0.455, 0.045, 0.045, 0.045, [1; 2])
}

/// Loads on the capsule at 0.4 m/s, k-ω SST, from the inflow or from another case in this room.
pub fn capsule(
    room: &Room,
    grid: &OGrid,
    angle_deg: f64,
    speed_m_s: f64,
    from: Option<&str>,
) -> Result<(String, Outcome)> {
    let mesh = room.mesh(&grid.mesh(&capsule_body())?.0)?;
    let case = Case {
        id: format!("capsule-a{angle_deg:03}"),
        configuration: "capsule".to_owned(),
        mesh: "capsule".to_owned(),
        is_half: true,
        flow: Flow { speed_m_s, angle_rad: angle_deg.to_radians(), pitch_rad: 0.0 },
        water: Water { density_kg_m3: 1000.0, viscosity_m2_s: 1e-6 },
        model: Model::Sst { intensity: 0.01, viscosity_ratio: 1.0 },
        stop: Stop { iterations: 600, window: 60, drift: 2e-5, spread: 5e-4 },
        reference: Reference { length_m: 1.0, width_m: 0.09, area_m2: 0.0883, point_m: [0.0; 3] },
        start_from: from.map(str::to_owned),
    };
    let [s, l, a] = [grid.stations, grid.layers, grid.around];
    let name = format!("capsule-{s}x{l}x{a}-u{speed_m_s}-a{angle_deg}{}", if from.is_some() { "-warm" } else { "" });
    let attempt = room.attempt(&name)?;
    let start = from.map(|from| room.folder.join("cases").join(from));
    let outcome = solve(&case, &mesh, start.as_deref(), &attempt, &room.how(&AtomicBool::new(false)))?;
    Ok((name, outcome))
}

impl Room {
    /// # Errors
    ///
    /// OpenFOAM is not installed.
    pub fn new(folder: PathBuf) -> Result<Self> {
        Ok(Self { folder, openfoam: OpenFoam::find()? })
    }

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
