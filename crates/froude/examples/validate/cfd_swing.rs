//! The computed twin of a forced oscillation, beside panels and Table 12 of the paper.

use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use froude::methods::added_mass::water::Water;
use froude::pipeline::{Job, identify};
use froude::records::campaign_file::read_campaign;
use froude::swing::swing;
use froude_cfd::collect::collect;
use froude_cfd::history;
use froude_cfd::store::Store;

use crate::cfd::{campaign, finish};
use crate::claims::{Claims, Verdict};
use crate::potential::{in_water, sway_kg};

const ROOM: &str = "Computed flows: a body that swings";
/// ρμ_n, which C_A refers to, kg.
const LINK_KG: f64 = 1025.0 * 1.2723e-3;
/// From the pivot to the middle of the link, m.
const RADIUS_M: f64 = 0.476;

/// The example, and the same body by a tenth of its width: in water at rest, and in the stream.
pub fn swung(claims: &mut Claims, root: &Path) -> Result<(), Box<dyn Error>> {
    let text = std::fs::read_to_string(root.join("examples/mamba-swing-cfd/campaign.toml"))?;
    let water = Water::of(&read_campaign(&root.join("examples/mamba-swing-cfd/campaign.toml"))?);
    let found = in_water(&root.join("examples/mamba-swing-cfd/body.toml"), vec![1], &water)?;
    let panels = sway_kg(found.configurations.first().ok_or("no panels")?) / LINK_KG;
    let small = text
        .replace("[\"10 deg\", \"20 deg\"]", "\"1 deg\"")
        .replace("[\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]", "\"70 deg/s\"");
    let jobs = std::thread::available_parallelism().map_or(1, usize::from);
    let compute = |name: &str, text: &str| {
        let path = campaign(root, name, text)?;
        let found = swing(&path, None, jobs, &AtomicBool::new(false), &|_| {})?;
        Ok::<_, Box<dyn Error>>((path, serde_json::to_value(found.json())?))
    };
    let still = small
        .replace("\"0.2 m/s\"", "\"0 m/s\"")
        .replace("mesh = \"coarse\"", "mesh = \"coarse\"\nmodel = \"laminar\"");
    let (path, _) = compute("swing-small", &still)?;
    // Of the log, which is there whether it was computed now or before.
    let log = path.with_file_name("runs/H1LT-a1-w70-u0.csv");
    let ratio = last_period(&log, 70.0, 1.0)? / LINK_KG / panels;
    claims.holds(
        ROOM,
        "added mass of H1LT swung at rest by a tenth of its width, KC 0.44, β 2250, over that by panels",
        "1.02 to 1.10: Stokes' layer is 1.044 at this section in two dimensions, and 1.071 at a circular cylinder of its width",
        format!("{ratio:.4}"),
        (1.02..=1.10).contains(&ratio),
    );
    // A small swing leaves the force of the stream head on as it is: the sign and the size of the stream.
    let (path, _) = compute("swing-stream", &small)?;
    let history = history::read(&path.with_file_name("runs-cfd/H1LT-a1-w70-u0.2"), true)?;
    let last = history.get(history.len().saturating_sub(200)..).ok_or("no steps")?;
    let swung = last.iter().map(|s| s.total()[0]).sum::<f64>() / last.len() as f64;
    // The same flow steady, by a campaign of one case.
    let (head, _) = text.split_once("[[source]]").ok_or("no source")?;
    let steady = format!(
        "{head}[[source]]\nname = \"CFD\"\nkind = \"cfd\"\ncases = \"cfd\"\n[source.cfd]\nbody = \"body.toml\"\nmesh = \"coarse\"\n\
         [[source.plan]]\nconfigurations = [\"H1LT\"]\nspeed = \"0.2 m/s\"\n"
    );
    let path = campaign(root, "swing-steady", &steady)?;
    finish(&path)?;
    let rows = collect(&Store::open(&path.with_file_name("cfd"))?).rows;
    let head_on = rows.first().map_or(f64::NAN, |row| row.loads[0]);
    claims.holds(
        ROOM,
        "mean f_x of H1LT in a stream of 0.2 m/s while it swings by 1°, of the steady flow head on",
        "1 ± 0.1: the swing turns the flow by 3° at most",
        format!("{swung:.4} N of {head_on:.4} N: {:.3}", swung / head_on),
        (swung / head_on - 1.0).abs() <= 0.1,
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
                "H1LT swung in a stream of 0.2 m/s at KC 4.4 to 8.9, {} runs by froude cfd swing and identify, {}",
                found["runs"].as_array().map_or(0, Vec::len),
                estimate.law.name
            ),
            &format!("circulation tank 1.277 of the paper (Table 12), its simulation 1.267; panels {panels:.3}"),
            format!("C_A {}, C_d {}", of("C_A"), of("C_d")),
            Verdict::Measured,
        );
    }
    let one = text
        .replace("[\"10 deg\", \"20 deg\"]", "\"10 deg\"")
        .replace("[\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]", "\"70 deg/s\"");
    for (what, name, text) in [
        ("as the example", "swing", one.clone()),
        (
            "in the whole domain",
            "swing-whole",
            one.replace("mesh = \"coarse\"", "mesh = \"coarse\"\ndomain = \"full\""),
        ),
        ("on 92,160 cells", "swing-medium", one.replace("mesh = \"coarse\"", "mesh = \"medium\"")),
    ] {
        let path = if name == "swing" { path.clone() } else { compute(name, &text)?.0 };
        let mass = last_period(&path.with_file_name("runs/H1LT-a10-w70-u0.2.csv"), 70.0, 10.0)?;
        claims.add(
            ROOM,
            &format!("C_A of one run of it (10°, 70°/s), first harmonic of its last period, {what}"),
            "what the plane of symmetry and the mesh do to it",
            format!("{:.3}", mass / LINK_KG),
            Verdict::Measured,
        );
    }
    Ok(())
}

/// Added mass by the first harmonic of the last period of a log, kg: the force of the rig is that of the water with its sign turned.
fn last_period(log: &Path, omega_deg_s: f64, amplitude_deg: f64) -> Result<f64, Box<dyn Error>> {
    let (omega, amplitude_m) = (omega_deg_s.to_radians(), RADIUS_M * amplitude_deg.to_radians());
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
