//! The computed twin of a forced oscillation, beside panels and Table 12 of the paper.

use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use froude::cfd::swing::swing;
use froude::pipeline::{Job, identify};

use crate::cfd::campaign;
use crate::claims::{Claims, Verdict};

const ROOM: &str = "Computed flows: a body that swings";
/// C_A of H1LT by panels (`froude added-mass examples/mamba-cfd/body.toml --links 1`), over the reference volume of a link.
const PANELS: f64 = 1.80673 / (1025.0 * 1.2723e-3);

/// The example, and the same body at rest by a sixth of its width.
pub fn swung(claims: &mut Claims, root: &Path) -> Result<(), Box<dyn Error>> {
    let text = std::fs::read_to_string(root.join("examples/mamba-swing-cfd/campaign.toml"))?;
    let small = text
        .replace("[\"10 deg\", \"20 deg\"]", "\"1 deg\"")
        .replace("[\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]", "\"70 deg/s\"")
        .replace("\"0.2 m/s\"", "\"0 m/s\"");
    let jobs = std::thread::available_parallelism().map_or(1, usize::from);
    let compute = |name: &str, text: &str| {
        let path = campaign(root, name, text)?;
        let found = swing(&path, None, jobs, &AtomicBool::new(false), &|_| {})?;
        Ok::<_, Box<dyn Error>>((path, found))
    };
    let (path, _) = compute("swing-small", &small)?;
    // Of the log, which is there whether it was computed now or before.
    let found = last_period(&path.with_file_name("runs/001.csv"), 70_f64.to_radians(), 0.476 * 1_f64.to_radians())?;
    let added = found / (1025.0 * 1.2723e-3);
    let expected = (1e4 * PANELS * (1.0 + 4.0 / (std::f64::consts::PI * 1010.0_f64).sqrt())).round() / 1e4;
    claims.near(
        ROOM,
        "C_A of H1LT swung at rest at KC 0.66, β 1010",
        added,
        expected,
        0.05 * expected,
        "panels with Stokes' layer as a circular cylinder has it, ± 5 %",
    );
    let (path, found) = compute("swing", &text)?;
    let fitted = identify(&Job { out: Some(path.with_file_name("results")), ..Job::new(&path) }, &|_| {})?;
    for estimate in &fitted.file.estimates {
        let of = |name: &str| {
            let c = estimate.coefficients.get(name);
            let interval = c.and_then(|c| c.interval_95).map_or(String::new(), |[a, b]| format!(" [{a:.3}, {b:.3}]"));
            c.and_then(|c| c.value).map_or("–".to_owned(), |v| format!("{v:.3}{interval}"))
        };
        claims.add(
            ROOM,
            &format!(
                "H1LT swung in a stream of 0.2 m/s at KC 6.6 to 13, {} runs by froude cfd swing and identify, {}",
                found.runs.len(),
                estimate.law.name
            ),
            &format!("circulation tank 1.277 of the paper (Table 12), its simulation 1.267; panels {PANELS:.3}"),
            format!("C_A {}, C_d {}", of("C_A"), of("C_d")),
            Verdict::Measured,
        );
    }
    Ok(())
}

/// Added mass by the first harmonic of the last period of a log, kg: the force of the rig is that of the water with its sign turned.
fn last_period(log: &Path, omega: f64, amplitude_m: f64) -> Result<f64, Box<dyn Error>> {
    let text = std::fs::read_to_string(log)?;
    let rows: Vec<[f64; 2]> = text
        .lines()
        .skip(1)
        .filter_map(|line| {
            let cells: Vec<f64> = line.split(',').filter_map(|cell| cell.parse().ok()).collect();
            Some([*cells.first()?, *cells.get(2)?])
        })
        .collect();
    let last = rows.get(rows.len().saturating_sub(200)..).ok_or("no rows")?;
    let sum: f64 = last.iter().map(|[t, f]| f * (omega * t).sin()).sum();
    Ok(-2.0 * sum / (last.len() as f64 * amplitude_m * omega * omega))
}
