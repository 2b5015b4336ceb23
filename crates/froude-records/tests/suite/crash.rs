//! Crashes while a run is recorded: `kill -9` at any moment, and a disk that fills up.
//!
//! The recorder under test is this test program itself, started again with [`FOLDER`] in its environment: it records two
//! axes at real 4 kHz and, before it hands over a tick, writes that tick's number where its parent finds it. What the
//! parent finds is therefore never behind what the recorder was given, whatever else the machine is doing.

use std::os::unix::fs::FileExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{RATE_HZ, layout, meta, row};
use froude_records::RecordError;
use froude_records::run::{EventKind, GapCause, Packing, Recorder, RunStatus, read_run};

/// Set only for the program that is killed: where it records.
const FOLDER: &str = "FROUDE_TEST_RECORD_INTO";

/// How often it is killed; the long validation sets 200.
const KILLS: &str = "FROUDE_TEST_KILLS";

/// Records until it is killed; does nothing in an ordinary test run.
#[test]
fn the_program_that_is_killed() {
    let Ok(folder) = std::env::var(FOLDER) else { return };
    let folder = Path::new(&folder);
    let progress = std::fs::File::create(folder.join("progress")).unwrap();
    let mut recorder = Recorder::create(folder, meta("run"), layout(), Packing::Lz4).unwrap();
    let begun = Instant::now();
    for tick in 0u32.. {
        let due = Duration::from_secs_f64(f64::from(tick) / RATE_HZ);
        // Sleeping is coarser than a tick: a few come together then, as from a serial port.
        if let Some(early) = due.checked_sub(begun.elapsed()) {
            std::thread::sleep(early);
        }
        let tick = u64::from(tick);
        progress.write_all_at(&(tick + 1).to_le_bytes(), 0).unwrap();
        recorder.record(tick, &row(tick)).unwrap();
        if tick % 1000 == 999 {
            recorder.event(tick, &EventKind::Note, "a quarter of a second").unwrap();
        }
    }
}

fn start(folder: &Path) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "crash::the_program_that_is_killed", "--nocapture"])
        .env(FOLDER, folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Ticks that were about to be handed over, or had been.
fn begun_ticks(folder: &Path) -> u64 {
    let mut bytes = [0; 8];
    let read = std::fs::File::open(folder.join("progress")).and_then(|f| f.read_exact_at(&mut bytes, 0));
    read.map_or(0, |()| u64::from_le_bytes(bytes))
}

/// Uneven waits between 0 and 0.6 s, the same in every test run (splitmix64).
fn wait(k: u64) -> Duration {
    let mut z = k.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    Duration::from_micros((z ^ (z >> 31)) % 600_000)
}

/// Recovers as the `recover` example of the official library does: its own reader up to the first thing that cannot be
/// read, its own writer.
fn official_recovery(path: &Path) -> (PathBuf, usize) {
    let out = path.with_extension("recovered.mcap");
    let input = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut writer = mcap::Writer::new(std::io::BufWriter::new(std::fs::File::create(&out).unwrap())).unwrap();
    let options = mcap::sans_io::LinearReaderOptions::default().with_skip_end_magic(true);
    let messages = mcap::io::MessageReader::new_with_options(input, options);
    let n = messages.map_while(Result::ok).map(|message| writer.write(&message).unwrap()).count();
    writer.finish().unwrap();
    (out, n)
}

#[test]
fn killed_at_random_moments_nothing_older_than_50_ms_is_lost() {
    let kills = std::env::var(KILLS).ok().and_then(|n| n.parse().ok()).unwrap_or(15);
    let mut largest_loss_s: f64 = 0.0;
    for k in 0..kills {
        let folder = tempfile::tempdir().unwrap();
        let mut child = start(folder.path());
        while begun_ticks(folder.path()) == 0 {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(wait(k));
        child.kill().unwrap();
        child.wait().unwrap();
        let begun = begun_ticks(folder.path());

        let path = folder.path().join("run.mcap");
        let log = read_run(&path).unwrap();
        // Tick `begun − 1` was being handed over. A chunk spans 40 ms, 161 ticks, and is handed over with the last of them;
        // the kill may fall before that. So these may be lost, and none before: 10 ms less than is claimed.
        let lost = begun - log.len() as u64;
        assert!(lost <= 161, "kill {k}: {lost} of {begun} ticks are lost");
        largest_loss_s = largest_loss_s.max(lost as f64 / RATE_HZ);
        for (i, time_s) in log.time_s.iter().enumerate() {
            assert_eq!(*time_s, i as f64 / RATE_HZ, "from the first tick on, none is missing");
        }
        for (column, (name, channel)) in log.channels.iter().enumerate() {
            for tick in (0..log.len()).step_by(97) {
                assert_eq!(channel.values[tick].to_bits(), row(tick as u64)[column].to_bits(), "{name}");
            }
        }
        assert_eq!(log.meta.status, RunStatus::Interrupted);
        assert_eq!(log.lost.iter().map(|gap| gap.cause).collect::<Vec<_>>(), [GapCause::CutOff]);
        assert_eq!(log.events.len() as u64, log.len() as u64 / 1000);

        let (recovered, n_messages) = official_recovery(&path);
        assert!(n_messages >= 4 * log.len() + log.events.len(), "kill {k}");
        assert_eq!(read_run(&recovered).unwrap().time_s[..log.len()], log.time_s);
    }
    eprintln!("{kills} kills; at most {:.1} ms before one were lost", 1e3 * largest_loss_s);
}

/// A small file system of its own, unmounted at the end; `None` where this user may not mount.
struct SmallDisk(tempfile::TempDir);

impl SmallDisk {
    fn mount(size: &str) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let done = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &format!("size={size}"), "tmpfs"])
            .arg(folder.path())
            .output();
        done.is_ok_and(|o| o.status.success()).then_some(Self(folder))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).status();
    }
}

#[test]
fn a_full_disk_stops_the_recording_with_an_error_and_keeps_the_run() {
    let Some(disk) = SmallDisk::mount("600k") else {
        eprintln!("this user may not mount a small disk: a full one is not tested");
        return;
    };
    let mut recorder = Recorder::create(disk.0.path(), meta("run"), layout(), Packing::None).unwrap();
    let path = recorder.path().to_owned();
    let mut tick = 0;
    let error = loop {
        match recorder.record(tick, &row(tick)) {
            Ok(()) => tick += 1,
            Err(error) => break error,
        }
    };
    let RecordError::Recording { ticks, .. } = &error else { panic!("{error}") };
    let kept = *ticks;
    assert!(error.is_output());
    assert_eq!(
        error.to_string(),
        format!(
            "cannot go on recording {}: the disk is full; the {kept} ticks before it are kept: stop the carriage, free the \
             disk, and repeat the run",
            path.display()
        )
    );
    assert!(tick - kept <= 161, "at most one chunk is lost: {kept} of {tick}");
    let again = recorder.record(tick + 1, &row(tick + 1)).unwrap_err();
    assert!(again.to_string().contains("it failed before"), "{again}");
    // The torn chunk was cut off again, which leaves room for the sidecar.
    recorder.finish(RunStatus::Interrupted).unwrap();
    let log = read_run(&path).unwrap();
    assert_eq!(log.len() as u64, kept);
    assert!(kept > 1000, "{kept}");
    assert_eq!(log.meta.status, RunStatus::Interrupted);
    assert_eq!(log.lost.len(), 1);
    let (recovered, n_messages) = {
        let elsewhere = tempfile::tempdir().unwrap();
        let copy = elsewhere.path().join("run.mcap");
        std::fs::copy(&path, &copy).unwrap();
        let (recovered, n) = official_recovery(&copy);
        (read_run(&recovered).unwrap(), n)
    };
    assert_eq!(n_messages as u64, 4 * kept);
    assert_eq!(recovered.time_s, log.time_s);
}
