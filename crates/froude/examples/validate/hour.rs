//! An hour of eight channels at 10 kHz through the whole chain of a forced oscillation: what it takes, and what comes out.
//!
//! The reduction runs in a process of its own, so that its memory is its own and not that of the twin that made the log.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use froude::methods::tank::driven::twin::Twin;
use froude::methods::tank::oscillation::Oscillation;
use froude::pipeline::{Job, identify};
use froude::records::campaign_file::read_campaign;
use froude::records::table::{Column, ColumnData, Table};
use froude::records::table_file::prepare_table;
use froude::records::units::parse_unit;
use froude::rig::swung::SwungTrace;

use crate::claims::{Claims, Verdict};

const SECTION: &str = "Forced oscillation: an hour at 10 kHz";
/// Argument that makes this program reduce a campaign and say what that took.
pub const CHILD: &str = "--identify";
/// Peak of resident memory, MiB.
const MOST_MIB: f64 = 500.0;
const RATE_HZ: f64 = 10_000.0;
/// Seconds of a period: 72 deg/s.
const PERIOD_S: f64 = 5.0;

pub fn all(claims: &mut Claims, root: &Path, periods: usize) -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let rows = log(root, folder.path(), periods)?;
    let begun = Instant::now();
    let done = Command::new(std::env::current_exe()?).arg(CHILD).arg(folder.path().join("campaign.toml")).output()?;
    let wall_s = begun.elapsed().as_secs_f64();
    let said = String::from_utf8_lossy(&done.stdout);
    if !done.status.success() {
        return Err(format!("the reduction of an hour: {said}{}", String::from_utf8_lossy(&done.stderr)).into());
    }
    let of = |key: &str| -> Vec<f64> {
        let line = said.lines().find_map(|line| line.strip_prefix(key));
        line.unwrap_or_default().split_whitespace().filter_map(|word| word.parse().ok()).collect()
    };
    let what = format!(
        "identify of {:.1} million rows of 8 channels ({:.0} s), Parquet",
        rows as f64 / 1e6,
        rows as f64 / RATE_HZ
    );
    for (name, truth) in [("C_A", 1.277), ("C_d", 0.3268)] {
        let [value, standard] = of(name)[..] else { return Err(format!("no {name} in {said}").into()) };
        // Of one drawn campaign, seeded: its errors of radius, mass and buoyancy are within three of their standard uncertainties.
        claims.holds(
            SECTION,
            &format!("{what}: {name}"),
            &format!("{truth}, within 3 standard uncertainties"),
            format!("{value:.4} ± {standard:.4}"),
            (value - truth).abs() <= 3.0 * standard,
        );
    }
    match of("memory")[..] {
        [mib, cpu_s] => {
            let bar = format!("below {MOST_MIB} MiB resident at its peak");
            claims.holds(SECTION, &format!("{what}: memory"), &bar, format!("{mib:.0} MiB"), mib < MOST_MIB);
            let found = format!("{wall_s:.0} s, {cpu_s:.0} s of the processor");
            claims.add(SECTION, &format!("{what}: time"), "–", found, Verdict::Measured);
        }
        _ => claims.add(SECTION, "memory and time of it", "Linux counts them", String::new(), Verdict::Skipped),
    }
    let steps = of("steps").first().copied().unwrap_or(0.0);
    // A Parquet file is handed on in chunks of 16,384 rows: of a short log a chunk is more than a percent.
    let fewest = (rows / 16_384).min(100) as f64;
    let expected = format!("each percent of the log, or each chunk: {fewest} steps at least");
    claims.holds(SECTION, &format!("{what}: progress"), &expected, format!("{steps} steps shown"), steps >= fewest);
    Ok(())
}

/// A run of the example campaign's first configuration, and five channels that a rig records beside it.
fn log(root: &Path, folder: &Path, periods: usize) -> Result<usize, Box<dyn Error>> {
    let mut text = std::fs::read_to_string(root.join("examples/mamba-oscillation/campaign.toml"))?;
    for (from, to) in [
        ("[\"10 deg\", \"15 deg\", \"20 deg\"]", "[\"15 deg\"]"),
        ("[\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]", "[\"72 deg/s\"]"),
        ("configurations = [\"H1LT\", \"H2LT\"]", "configurations = [\"H1LT\"]"),
        ("rate      = \"100 Hz\"", "rate      = \"10000 Hz\""),
        ("cycles   = { skip = 1, used = 5 }", "cycles   = { skip = 1 }"),
        // At one frequency and on one configuration a law of one coefficient is what a run can tell, and a delay is no unknown beside it.
        ("models = [\"f1\", \"f4\"]", "models = [\"f1\"]"),
        ("model = \"f4\"", "model = \"f1\""),
        ("C_d_I    = \"0 m/s\"\n", "C_d      = 0.3268\n"),
        ("C_d_II   = 1.4272\n", ""),
        ("C_dHT_I  = \"0.1769 m/s\"\n", ""),
        ("C_dHT_II = 1.1770\n", ""),
        ("standard = \"5 ms\"", "standard = \"0 ms\""),
    ] {
        if !text.contains(from) {
            return Err(format!("the example campaign has no {from}").into());
        }
        text = text.replace(from, to);
    }
    let path = folder.join("campaign.toml");
    std::fs::write(&path, text)?;
    let campaign = read_campaign(&path)?;
    let source = campaign.sources.first().ok_or("no source")?;
    let mut twin = Twin::<Oscillation>::of(&campaign, source)?;
    let (seed, sensors) = campaign.simulate.as_ref().map_or((0, [].as_slice()), |s| (s.seed, s.sensors.as_slice()));
    // A campaign plans ten million samples at most, and an hour has 36.
    for run in &mut twin.planned {
        run.swing.periods = periods as f64;
    }
    let SwungTrace { time_s, motion, mut loads } = twin.simulated(sensors, seed)?.remove(0).trace;
    let rows = time_s.len();
    // A strain of the rod, two accelerations, a voltage and a temperature, with steps as of a 16-bit converter.
    let beside = |size: f64, offset: f64, k: f64| -> Vec<f64> {
        (time_s.iter())
            .map(|t| {
                ((offset + size * (TAU / PERIOD_S * k * t).sin() + 0.1 * size * (977.0 * k * t).sin()) * 3276.8).round()
                    / 3276.8
            })
            .collect()
    };
    let extra = [
        beside(1.0, 0.0, 1.0),
        beside(0.5, 0.0, 1.3),
        beside(0.3, 9.8, 2.0),
        beside(0.01, 5.0, 3.0),
        beside(0.02, 15.0, 0.01),
    ];
    let named = [
        ("time", "s"),
        ("phi", "rad"),
        ("force", "N"),
        ("strain", "1"),
        ("a_x", "m/s^2"),
        ("a_y", "m/s^2"),
        ("supply", "V"),
        ("room", "s"),
    ];
    let column = |((name, unit), si): ((&str, &str), Vec<f64>)| -> Result<Column, Box<dyn Error>> {
        let unit = parse_unit(unit)?;
        Ok(Column { name: name.to_owned(), data: ColumnData::Number { dimension: unit.dimension, unit, si } })
    };
    let values = [time_s, motion, loads.remove(0)].into_iter().chain(extra);
    let table = Table::of(
        folder.join("runs/001.parquet"),
        named.into_iter().zip(values).map(column).collect::<Result<_, _>>()?,
        (1..=rows).collect(),
    );
    std::fs::create_dir(folder.join("runs"))?;
    prepare_table(&table, &table.path)?.take_place()?;
    let declared = |header: &str, name: &str, unit: &str| {
        format!("{header:?} = {{ name = {name:?}, unit = {unit:?}, sign = 1, frame = \"body\", clock = \"log\" }}\n")
    };
    let mut sidecar = "schema = 1\nmethod = \"forced_oscillation\"\nrole = \"test\"\n\n[mounted]\nconfiguration = \"H1LT\"\n\n[conditions]\nflow = \"0.2 m/s\"\n\n[columns]\n\
                       \"time [s]\" = { name = \"time\", unit = \"s\" }\n"
        .to_owned();
    sidecar += &declared("phi [rad]", "angle", "rad");
    sidecar += &declared("force [N]", "force", "N");
    for (name, unit) in &named[3..] {
        sidecar += &declared(&format!("{name} [{unit}]"), name, unit);
    }
    std::fs::write(folder.join("runs/001.toml"), sidecar)?;
    Ok(rows)
}

/// Reduces a campaign, and says what it found and what it took.
pub fn child(campaign: &Path) -> Result<(), Box<dyn Error>> {
    let steps = std::cell::Cell::new(0);
    let job = Job::new(campaign);
    let outcome = identify(&job, &|_| steps.set(steps.get() + 1))?;
    println!("steps {}", steps.get());
    let best = outcome.file.estimates.iter().find(|e| e.recommended).ok_or("nothing is recommended")?;
    for (name, c) in &best.coefficients {
        if let (Some(value), Some(standard)) = (c.value, c.standard_uncertainty) {
            println!("{name} {value} {standard}");
        }
    }
    if let Some([mib, cpu_s]) = taken() {
        println!("memory {mib} {cpu_s}");
    }
    Ok(())
}

/// Peak of the resident memory of this process, MiB, and its time on the processor, s; of Linux alone.
fn taken() -> Option<[f64; 2]> {
    /// Of a second, in which Linux counts for programs.
    const TICK_S: f64 = 0.01;
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = peak.split_whitespace().next()?.parse().ok()?;
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Behind the name in brackets: state is the first, user and system time are the twelfth and thirteenth.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: f64 = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some([kib / 1024.0, ticks * TICK_S])
}
