//! One bit of a file turned over: what is read is an error, a finding, or what was written. Never something else in silence.
//!
//! Files with a checksum: logs with their sidecar and without, sidecars, records, Parquet. All other files have none, so that a
//! digit more or less stays unseen there: they may give anything but a panic.
//!
//! `FROUDE_TEST_FLIPS` sets the number of flips for each kind of file; the long run has 1,500.

use std::fmt::Debug;
use std::path::{Path, PathBuf};

use froude::Error;
use froude::inspect::inspect;
use froude::records::campaign::BodyAxis;
use froude::records::finding::Finding;
use froude::records::json::{read_estimates, write_estimates};
use froude::records::run::{
    Axis, AxisSample, BodyState, CarriageFacts, CarriageSample, Direction, EventKind, Layout, Mounted, Packing,
    Recorder, Role, RunMeta, RunStatus, TOW, read_run,
};
use froude::records::table::Column;
use froude::records::table_file::read_table;

/// Flips for each kind of file.
fn flips() -> u64 {
    std::env::var("FROUDE_TEST_FLIPS").ok().and_then(|n| n.parse().ok()).unwrap_or(1_500)
}

/// The next of a sequence that is the same in every test run (splitmix64).
fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// How many flips were reported, changed nothing, and were taken for data.
#[derive(Debug, Default, PartialEq)]
struct Tally {
    reported: usize,
    harmless: usize,
    silent: Vec<(usize, u8)>,
}

/// Flips bits of `path`, between these bytes, and reads it each time.
fn tally<T: PartialEq + Debug>(
    path: &Path,
    within: std::ops::Range<usize>,
    read: impl Fn() -> Result<(T, Vec<Finding>), Error>,
) -> Tally {
    let whole = std::fs::read(path).unwrap();
    let (content, findings) = read().unwrap();
    let (mut tally, mut state) = (Tally::default(), 7);
    for _ in 0..flips() {
        let at = within.start + (next(&mut state) % within.len() as u64) as usize;
        let bit = (next(&mut state) % 8) as u8;
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << bit;
        std::fs::write(path, &bytes).unwrap();
        match read() {
            Err(_) => tally.reported += 1,
            Ok((_, found)) if found.len() > findings.len() => tally.reported += 1,
            Ok((found, _)) if found == content => tally.harmless += 1,
            Ok(_) => tally.silent.push((at, bit)),
        }
    }
    std::fs::write(path, &whole).unwrap();
    println!(
        "{}: {} reported, {} harmless, {} silent of {} flips in {} bytes",
        path.display(),
        tally.reported,
        tally.harmless,
        tally.silent.len(),
        flips(),
        within.len()
    );
    tally
}

/// A short run, as `froude run` records it.
fn run(folder: &Path) -> PathBuf {
    let meta = RunMeta {
        campaign: "small".to_owned(),
        id: "045-wet".to_owned(),
        method: TOW.to_owned(),
        role: Role::Wet,
        mounted: Mounted { body: BodyState::Wet, travel: Some(BodyAxis::X), ..Mounted::default() },
        carriage: CarriageFacts {
            pair: Some(3),
            axis: Axis::Y,
            target_speed_m_s: Some(0.55),
            direction: Some(Direction::Forward),
            ..CarriageFacts::default()
        },
        note: "ripples".to_owned(),
        log_rate_hz: 1000.0,
        date: "2026-11-21".to_owned(),
        ..RunMeta::default()
    };
    let layout = Layout::carriage(false, true, &[]).unwrap();
    let mut recorder = Recorder::create(folder, meta, layout, Packing::Lz4).unwrap();
    let mut row = Vec::new();
    for tick in 0..200 {
        let t = tick as f64 / 1000.0;
        let y = AxisSample { position_m: 0.55 * t, command_v: (37.0 * t).sin(), state: 2, ..AxisSample::default() };
        CarriageSample { y, x: None, force_n: 6.05 + 0.01 * t }.row(true, &[], &mut row);
        recorder.record(tick, &row).unwrap();
        if tick == 50 {
            recorder.event(tick, &EventKind::Phase, "the motion begins").unwrap();
        }
    }
    recorder.finish(RunStatus::Complete).unwrap()
}

#[test]
fn no_flip_in_a_log_with_its_sidecar_is_silent() {
    let folder = tempfile::tempdir().unwrap();
    let log = run(folder.path());
    let length = std::fs::read(&log).unwrap().len();
    let read = || Ok((read_run(&log)?, inspect(&log, None)?.findings));
    assert_eq!(tally(&log, 0..length, read).silent, []);
}

#[test]
fn no_flip_in_a_log_without_a_sidecar_is_silent() {
    let folder = tempfile::tempdir().unwrap();
    let log = run(folder.path());
    std::fs::remove_file(log.with_extension("toml")).unwrap();
    let length = std::fs::read(&log).unwrap().len();
    let read = || Ok((read_run(&log)?, inspect(&log, None)?.findings));
    assert_eq!(tally(&log, 0..length, read).silent, []);
}

#[test]
fn no_flip_in_the_sidecar_of_a_run_is_silent() {
    let folder = tempfile::tempdir().unwrap();
    let log = run(folder.path());
    let sidecar = log.with_extension("toml");
    let length = std::fs::read(&sidecar).unwrap().len();
    let read = || Ok((read_run(&log)?, inspect(&log, None)?.findings));
    assert_eq!(tally(&sidecar, 0..length, read).silent, []);
}

#[test]
fn no_flip_in_a_record_is_silent() {
    let folder = tempfile::tempdir().unwrap();
    let published = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/mamba/published");
    let published = std::fs::read_dir(published).unwrap().map(|e| e.unwrap().path());
    let published = published.filter(|p| p.extension().is_some_and(|e| e == "json")).min().unwrap();
    let record = folder.path().join("estimate.json");
    write_estimates(&record, &read_estimates(&published).unwrap()).unwrap();
    let length = std::fs::read(&record).unwrap().len();
    let read = || Ok((read_estimates(&record)?, inspect(&record, None)?.findings));
    assert_eq!(tally(&record, 0..length, read).silent, []);
}

fn columns(path: &Path) -> Result<Vec<Column>, Error> {
    Ok(read_table(path, None)?.columns)
}

/// A table as pyarrow writes it, with page checksums; its script lies beside it.
fn checksummed() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../froude-records/tests/golden/checksummed.parquet")
}

#[test]
fn no_flip_in_parquet_of_our_own_is_silent() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("table.parquet");
    froude_records::table_file::prepare_table(&read_table(&checksummed(), None).unwrap(), &table)
        .unwrap()
        .take_place()
        .unwrap();
    let length = std::fs::read(&table).unwrap().len();
    assert_eq!(tally(&table, 0..length, || Ok((columns(&table)?, Vec::new()))).silent, []);
}

#[test]
fn no_flip_in_the_pages_of_checksummed_parquet_is_silent() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("table.parquet");
    std::fs::copy(checksummed(), &table).unwrap();
    let bytes = std::fs::read(&table).unwrap();
    let footer = u32::from_le_bytes(*bytes[..bytes.len() - 4].last_chunk().unwrap()) as usize;
    let pages = 4..bytes.len() - 8 - footer;
    assert_eq!(tally(&table, pages, || Ok((columns(&table)?, Vec::new()))).silent, []);
}

/// Files without any checksum: what is read of them may be another number, and never a panic.
#[test]
fn no_flip_in_a_file_without_a_checksum_is_a_panic() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let campaign = std::fs::read(root.join("examples/towing-carriage/campaign.toml")).unwrap();
    let body = std::fs::read(root.join("examples/mamba-necked/body.toml")).unwrap();
    let csv = std::fs::read(root.join("examples/mamba/published/added_mass_table6.csv")).unwrap();
    let sidecar = std::fs::read(root.join("examples/unh-rm2/Tare-drag.toml")).unwrap();
    let stl = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0.5\nendloop\nendfacet\nendsolid a\n";
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0.5\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let at = Path::new("file");
    type Read<'a> = &'a dyn Fn(&[u8]) -> bool;
    let kinds: [(&str, &[u8], Read<'_>); 6] = [
        ("campaign", &campaign, &|b| {
            let read = froude::records::campaign_file::parse_campaign(at, &text(b));
            read.is_ok_and(|campaign| froude::pipeline::check_sections(&campaign).is_ok())
        }),
        ("body", &body, &|b| froude::methods::added_mass::body_file::parse_body(at, &text(b)).is_ok()),
        ("CSV", &csv, &|b| froude::records::csv_table::parse_csv(at, text(b), None).is_ok()),
        ("sidecar of a table", &sidecar, &|b| froude::records::sidecar::parse_sidecar(at, &text(b)).is_ok()),
        ("STL", stl, &|b| froude::mesh::files::read("a.stl", b).is_ok()),
        ("OBJ", obj, &|b| froude::mesh::files::read("a.obj", b).is_ok()),
    ];
    for (name, whole, read) in kinds {
        let (mut state, mut n_read) = (7, 0);
        for _ in 0..flips() {
            let mut bytes = whole.to_vec();
            let at = (next(&mut state) % bytes.len() as u64) as usize;
            bytes[at] ^= 1 << (next(&mut state) % 8);
            n_read += usize::from(read(&bytes));
        }
        println!("{name}: {n_read} of {} flips are read", flips());
    }
}
