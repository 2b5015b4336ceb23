//! Flows whose forces are known, beside what is known of them.
//!
//! `cargo run --release -p froude-cfd --example known_flows -- FOLDER sphere|plate|cylinder|capsule`

mod flows;

use std::error::Error;
use std::path::PathBuf;

use flows::{Room, capsule, capsule_grid, cylinder, plate, plate_friction, sphere};
use froude_cfd::grid_error::grid_error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let room = Room::new(PathBuf::from(arguments.next().ok_or("name an empty folder to work in")?))?;
    match arguments.next().as_deref() {
        Some("sphere") => {
            let mut grids = Vec::new();
            for level in 0..4 {
                let found = sphere(&room, level)?;
                println!("{} cells: C_D {:.4}, CPU {:.0} s", found.outcome.cells, found.value, found.outcome.cpu_s);
                grids.push(found.on_grid());
            }
            println!("{:?}", grid_error(&grids, 3)?);
        }
        Some("plate") => {
            for (reynolds, far_m) in [(100.0, 8.0), (1000.0, 4.0), (1e4, 3.0)] {
                let (found, known) = (plate(&room, reynolds, far_m)?.value, plate_friction(reynolds));
                println!("Re {reynolds}: C_F {found:.5}, {known:.5} is known, {:+.2} %", 100.0 * (found / known - 1.0));
            }
        }
        Some("cylinder") => {
            let [drag, strouhal, cpu_s] = cylinder(&room)?;
            println!("C_D {drag:.4}, St {strouhal:.4}, CPU {cpu_s:.0} s");
        }
        Some("capsule") => {
            let coarse = capsule_grid(40, 35, 16, 0.12e-3);
            let mut near = None;
            for (angle, speed, is_warm) in [
                (0.0, 0.4, false),
                (60.0, 0.4, false),
                (90.0, 0.4, false),
                (30.0, 0.4, false),
                (33.0, 0.4, true),
                (33.0, 0.4, false),
            ] {
                let (name, outcome) = capsule(&room, &coarse, angle, speed, near.as_deref().filter(|_| is_warm))?;
                let [x, y, ..] = outcome.loads.unwrap_or([f64::NAN; 6]);
                println!(
                    "{name}: f_x {x:.4} N, f_y {y:.4} N, {} iterations, {:.0} s, {}",
                    outcome.iterations, outcome.cpu_s, outcome.reason
                );
                near = Some(name);
            }
        }
        _ => return Err("say sphere, plate, cylinder or capsule".into()),
    }
    Ok(())
}
