//! Meshes of a capsule, a sphere and the smooth robot: their cells, quality and the time they take; written where an argument says.
//!
//! `cargo run --release -p froude-cfd --example o_grids -- meshes`

use std::path::Path;
use std::time::Instant;

use froude_cfd::mesh_error::MeshError;
use froude_cfd::o_grid::OGrid;
use froude_mesh::robot::{Robot, sections};
use froude_mesh::sections::SectionBody;

fn main() -> Result<(), MeshError> {
    let meshes = std::env::args().nth(1);
    let capsule = SectionBody::capsule(0.455, 0.045, 0.045, 0.045, [1; 2]);
    let sphere = SectionBody::ellipsoid([0.5; 3], 1);
    let grid = |stations, layers, around, first_layer_m, outer_radius_m| OGrid {
        stations,
        layers,
        around,
        first_layer_m,
        outer_radius_m,
        is_half: true,
    };
    let mut cases = vec![
        ("capsule e".to_owned(), capsule.clone(), grid(40, 35, 16, 0.12e-3, 4.0)),
        ("capsule d".to_owned(), capsule.clone(), grid(60, 48, 32, 0.10e-3, 4.0)),
        ("capsule f".to_owned(), capsule, grid(82, 67, 48, 0.07e-3, 4.0)),
        ("sphere".to_owned(), sphere, grid(24, 24, 24, 0.02, 25.0)),
    ];
    for links in 1..=9 {
        let length_m = Robot::SMOOTH_MAMBA.length_m(links);
        let stations = 30 + 6 * links;
        cases.push((
            format!("H{links}LT"),
            sections(&Robot::SMOOTH_MAMBA, links, 1.0),
            grid(stations, 36, 16, 0.12e-3, 4.0 * length_m.max(1.0)),
        ));
    }
    println!(
        "| mesh | cells | time, s | non-orthogonality max, mean, ° | skewness | aspect ratio | openness | written, s |"
    );
    for (name, body, grid) in cases {
        let start = Instant::now();
        match grid.mesh(&body) {
            Err(error) => println!("| {name} | {error} |"),
            Ok((mesh, quality)) => {
                let made_s = start.elapsed().as_secs_f64();
                let start = Instant::now();
                let folder = meshes.as_ref().map(|m| mesh.write(Path::new(m))).transpose()?;
                println!(
                    "| {name} | {} | {made_s:.2} | {:.2}, {:.2} | {:.3} | {:.0} | {:.0e} | {:.2} | {}",
                    mesh.cells,
                    quality.max_non_orthogonality_rad.value.to_degrees(),
                    quality.mean_non_orthogonality_rad.to_degrees(),
                    quality.max_skewness.value,
                    quality.max_aspect.value,
                    quality.max_openness.value,
                    start.elapsed().as_secs_f64(),
                    folder.map_or(String::new(), |f| f.display().to_string()),
                );
            }
        }
    }
    Ok(())
}
