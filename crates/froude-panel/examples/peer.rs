//! Times, memory and matrices for comparison with other programs, and the meshes to give them.
//!
//! `peer [--case NAME] [--write-mesh FILE] [--rounds N]`: a line of JSON a case: its panels, threads, least seconds of the rounds, peak memory
//! over that before it in MiB, and the matrix over ρ about the origin. `RAYON_NUM_THREADS` sets the threads. `--write-mesh` writes the mesh of
//! the case instead: `vertices N`, N lines of `x y z`; `panels M`, M lines of four vertex numbers from 0 (a triangle repeats its third).
//!
//! | case | body |
//! | --- | --- |
//! | spheroid-2000, -20000, -100000 | 6:1, in its closed form 0.045183, 0.917123 of its volume |
//! | robot-8064, robot-20064 | necked H3LT, joints bent by 10, −20, 25 and −15 degrees: no symmetry is used |
//! | spectral-spheroid, spectral-capsule | 6:1, and a capsule of L/D 10, by azimuthal modes, to 1e-8 |
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use std::fmt::Write as _;
use std::time::Instant;

use froude_mesh::Mesh;
use froude_mesh::robot::Robot;
use froude_mesh::sections::{Resolution, SectionBody};
use froude_panel::chain::Chain;
use froude_panel::problem::Problem;
use froude_panel::revolution::{self, Stretch};

const CASES: [&str; 7] = [
    "spheroid-2000",
    "robot-8064",
    "spheroid-20000",
    "robot-20064",
    "spheroid-100000",
    "spectral-spheroid",
    "spectral-capsule",
];

fn mesh(case: &str) -> Mesh {
    let spheroid =
        |along, around| SectionBody::ellipsoid([6.0, 1.0, 1.0], 5).mesh(Resolution { along, around }).unwrap().mesh;
    let robot = |along, around| {
        let angles = [10.0_f64, -20.0, 25.0, -15.0].map(f64::to_radians);
        let resolution = Resolution { along, around };
        Chain::new(&Robot::NECKED_MAMBA, 3, &angles, 0.05, resolution).unwrap().surface.mesh
    };
    match case {
        "spheroid-2000" => spheroid(5, 40),
        "robot-8064" => robot(7, 48),
        "robot-20064" => robot(11, 76),
        "spheroid-20000" => spheroid(20, 100),
        "spheroid-100000" => spheroid(40, 250),
        _ => panic!("{case} has no mesh"),
    }
}

fn meridian(case: &str) -> Vec<Stretch> {
    if case == "spectral-spheroid" { revolution::spheroid(6.0, 1.0, 2) } else { revolution::capsule(9.0, 1.0, 2, 4) }
}

fn text(mesh: &Mesh) -> String {
    let mut out = format!("vertices {}\n", mesh.vertices.len());
    for [x, y, z] in &mesh.vertices {
        writeln!(out, "{x:e} {y:e} {z:e}").unwrap();
    }
    writeln!(out, "panels {}", mesh.panels.len()).unwrap();
    for panel in &mesh.panels {
        let c = panel.corners();
        writeln!(out, "{} {} {} {}", c[0], c[1], c[2], c[c.len() - 1]).unwrap();
    }
    out
}

/// Resident memory in MiB: now, or its peak since the last time that it was set back (Linux; 0 elsewhere).
fn memory_mib(field: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix(field).map(str::to_owned));
    let kib = line.and_then(|l| l.trim().trim_end_matches(" kB").trim().parse::<f64>().ok());
    kib.unwrap_or(0.0) / 1024.0
}

/// Least seconds of the rounds, and peak memory over that before.
fn measured<T>(rounds: usize, run: impl Fn() -> T) -> (T, f64, f64) {
    let base = memory_mib("VmRSS:");
    // Sets the peak back to what is resident now.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
    let mut best = f64::INFINITY;
    let mut result = None;
    for _ in 0..rounds {
        let started = Instant::now();
        result = Some(run());
        best = best.min(started.elapsed().as_secs_f64());
    }
    (result.unwrap(), best, memory_mib("VmHWM:") - base)
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let after = |name: &str| arguments.iter().position(|a| a == name).and_then(|i| arguments.get(i + 1));
    let rounds = after("--rounds").map_or(1, |n| n.parse().unwrap());
    for case in CASES.into_iter().filter(|c| after("--case").is_none_or(|chosen| chosen == c)) {
        if let Some(file) = after("--write-mesh") {
            std::fs::write(file, text(&mesh(case))).unwrap();
            return;
        }
        #[expect(clippy::disallowed_methods, reason = "it is printed, and nothing is divided by it")]
        let threads = rayon::current_num_threads();
        let (kind, count, seconds, peak_mib, matrix) = if case.starts_with("spectral") {
            let panels = meridian(case);
            let (r, seconds, peak) = measured(rounds, || revolution::solve(&panels));
            let mut matrix = [[0.0; 6]; 6];
            let diagonal = [r.axial_m3, r.transverse_m3, r.transverse_m3, 0.0, r.rotary_m5, r.rotary_m5];
            (0..6).for_each(|i| matrix[i][i] = diagonal[i]);
            (matrix[1][5], matrix[5][1]) = (r.coupling_m4, r.coupling_m4);
            (matrix[2][4], matrix[4][2]) = (-r.coupling_m4, -r.coupling_m4);
            ("unknowns", r.unknowns, seconds, peak, matrix)
        } else {
            let problem = Problem::rigid(&mesh(case), &[]);
            let (solution, seconds, peak) = measured(rounds, || froude_panel::solve(&problem));
            ("panels", problem.facets.len(), seconds, peak, solution.added_mass(0).matrix)
        };
        let rows: Vec<String> = matrix.iter().map(|row| format!("{row:?}")).collect();
        println!(
            "{{\"case\": \"{case}\", \"{kind}\": {count}, \"threads\": {threads}, \"seconds\": {seconds:.4}, \"peak_mib\": {peak_mib:.1}, \
             \"matrix\": [{}]}}",
            rows.join(", ")
        );
    }
}
