//! Runs on disk: what was recorded is read back, whatever became of the file.

use std::path::{Path, PathBuf};

use crate::common::{RATE_HZ, START_NS, layout, meta, row};
use froude_records::hash::fingerprint_of_file;
use froude_records::run::{
    Axis, Block, BodyState, CarriageFacts, Direction, DoubtKind, EventKind, Frame, GapCause, Meaning, Mounted, Packing,
    Recorder, Role, RunLog, RunMeta, RunReader, RunStatus, TOW, parse_run_meta, read_run, read_run_meta, run_meta_text,
};
use froude_records::units::Dimension;

/// Records ticks 0..n, and gives the file.
fn recorded(folder: &Path, id: &str, ticks: impl IntoIterator<Item = u64>, packing: Packing) -> PathBuf {
    let mut recorder = Recorder::create(folder, meta(id), layout(), packing).unwrap();
    for tick in ticks {
        recorder.record(tick, &row(tick)).unwrap();
    }
    recorder.finish(RunStatus::Complete).unwrap()
}

/// Every value of the run is the one that was recorded in the tick of its time.
fn assert_values(log: &RunLog) {
    let names: Vec<_> = layout().channels().iter().map(|c| c.name.clone()).collect();
    assert_eq!(log.channels.keys().cloned().collect::<Vec<_>>(), names);
    for (i, time_s) in log.time_s.iter().enumerate() {
        let tick = (time_s * RATE_HZ).round() as u64;
        assert_eq!(*time_s, tick as f64 / RATE_HZ, "times are ticks over the rate, to the last bit");
        for (channel, expected) in log.channels.values().zip(row(tick)) {
            assert_eq!(channel.values[i].to_bits(), expected.to_bits());
        }
    }
}

#[test]
fn a_run_reads_back_to_the_bits_that_were_recorded_in_every_packing() {
    let folder = tempfile::tempdir().unwrap();
    for (id, packing) in [("plain", Packing::None), ("lz4", Packing::Lz4), ("zstd", Packing::Zstd)] {
        let path = recorded(folder.path(), id, 0..9000, packing);
        let log = read_run(&path).unwrap();
        assert_eq!(log.len(), 9000);
        assert_values(&log);
        assert_eq!((log.lost.len(), log.doubts.len()), (0, 0), "{:?} {:?}", log.lost, log.doubts);
        // The sidecar knows every byte of the log: the hash that was taken while it was written is that of the file.
        let fingerprint = Some(fingerprint_of_file(&path).unwrap());
        let channels = log.channels.iter().map(|(name, c)| (name.clone(), c.meaning.clone())).collect();
        let expected = RunMeta { status: RunStatus::Complete, log: fingerprint, channels, ..meta(id) };
        assert_eq!(log.meta, expected);
        assert_eq!(log.sample_rate_hz().unwrap().round(), RATE_HZ);
        assert!((log.duration_s() - 8999.0 / RATE_HZ).abs() < 1e-9);
    }
}

#[test]
fn the_same_run_is_the_same_file_byte_for_byte() {
    let bytes =
        |folder: &tempfile::TempDir| std::fs::read(recorded(folder.path(), "run", 0..3000, Packing::Lz4)).unwrap();
    let (a, b) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    assert_eq!(bytes(&a), bytes(&b));
}

#[test]
fn the_file_alone_says_what_the_sidecar_says() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path(), "run", 0..100, Packing::Lz4);
    let sidecar = path.with_extension("toml");
    let with = read_run(&path).unwrap().meta;
    assert_eq!(read_run_meta(&sidecar).unwrap(), with);
    std::fs::remove_file(sidecar).unwrap();
    let alone = read_run(&path).unwrap();
    // But for its own hash, which no file can hold.
    assert_eq!(alone.meta, RunMeta { log: None, ..with });
    let [doubt] = alone.doubts.as_slice() else { panic!("{:?}", alone.doubts) };
    assert_eq!(doubt.kind, DoubtKind::NoSidecar);
    assert_eq!(
        doubt.text,
        format!("{} has no sidecar run.toml: only the log's own checksums vouch for it", path.display())
    );
}

#[test]
fn a_sidecar_is_for_people_and_reads_back() {
    let meta = meta("0007-wet");
    let text = run_meta_text(&meta);
    assert!(text.contains("target_speed = \"0.55 m/s\"\n"), "{text}");
    assert!(text.contains("[carriage.rig.y]\ntorque_constant.value = \"0.0267 N m/A\"\n"), "{text}");
    assert_eq!(parse_run_meta(Path::new("0007-wet.toml"), &text).unwrap(), meta);
}

fn means(quantity: &str, unit: &str, frame: Frame, sign: i8) -> Meaning {
    Meaning { quantity: quantity.to_owned(), unit: unit.to_owned(), frame, sign, clock: "board".to_owned() }
}

#[test]
fn every_channel_says_quantity_unit_frame_sign_and_clock() {
    let folder = tempfile::tempdir().unwrap();
    let log = read_run(&recorded(folder.path(), "run", 0..10, Packing::Lz4)).unwrap();
    let expected = [
        ("force", means("force", "N", Frame::Y, -1)),
        ("y/position", means("position", "m", Frame::Y, 1)),
        ("x/reference_velocity", means("velocity", "m/s", Frame::X, 1)),
        ("y/command", means("voltage", "V", Frame::Y, 1)),
        ("x/current", means("current", "A", Frame::X, 1)),
        ("y/encoder", means("count", "1", Frame::Sensor, 1)),
        ("y/state", means("code", "1", Frame::None, 1)),
        ("truth/y/load_position", means("position", "m", Frame::Y, 1)),
        ("truth/y/drag", means("force", "N", Frame::Y, -1)),
    ];
    for (name, meaning) in expected {
        assert_eq!((&log.channels[name].meaning, &log.meta.channels[name]), (&meaning, &meaning), "{name}");
    }
    let sidecar = std::fs::read_to_string(folder.path().join("run.toml")).unwrap();
    let line = "\nforce = { quantity = \"force\", unit = \"N\", frame = \"y\", sign = -1, clock = \"board\" }\n";
    assert!(sidecar.contains("\n[channels]\n\"y/encoder\" = {") && sidecar.contains(line), "{sidecar}");
}

#[test]
fn a_unit_or_a_sign_that_the_log_does_not_have_is_refused_with_both() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path(), "run", 0..10, Packing::Lz4);
    let sidecar = path.with_extension("toml");
    let text = std::fs::read_to_string(&sidecar).unwrap();
    let is_kept = |line: &&str| !line.starts_with("checksum");
    let text: String = text.lines().filter(is_kept).map(|line| line.to_owned() + "\n").collect();
    let at = |key: &str| 1 + text.lines().position(|line| line.starts_with(key)).unwrap();
    let error = |from: &str, to: &str| {
        assert!(text.contains(from), "{text}");
        std::fs::write(&sidecar, text.replace(from, to)).unwrap();
        read_run(&path).unwrap_err().to_string()
    };
    let (log, toml) = (path.display(), sidecar.display());
    assert_eq!(
        error("quantity = \"force\", unit = \"N\", frame = \"y\", sign = -1, clock", "unit = \"kN\", clock"),
        format!("{toml}: `channels.\"force\".unit` is \"kN\"; expected \"N\", in which {log} was recorded")
    );
    let line = at("\"y/position\"");
    let is_told = |error: String, problem: &str| {
        assert!(error.starts_with(&format!("{toml}:{line}:")) && error.ends_with(problem), "{error}");
    };
    let position = "\"y/position\" = { quantity = \"position\", unit = \"m\", frame = \"y\", sign = 1";
    is_told(
        error(position, &position.replace("sign = 1", "sign = -1")),
        "`sign` is -1; expected 1: the name y/position says it",
    );
    is_told(
        error(position, &position.replace("\"m\"", "\"m/s\"")),
        "`unit` is \"m/s\"; expected a length (m), which y/position is",
    );
    is_told(
        error(position, &position.replace("= \"position\"", "= \"velocity\"")),
        "`quantity` is \"velocity\", a speed (m/s); expected a length (m), as its unit says",
    );
    is_told(
        error(position, &position.replace("frame = \"y\"", "frame = \"z\"")),
        "`frame` is \"z\"; did you mean `y` or `x`?",
    );
    // Another word than the log's is an edit like any other: it is used, and said.
    std::fs::write(
        &sidecar,
        text.replace(&format!("{position}, clock = \"board\""), &format!("{position}, clock = \"host\"")),
    )
    .unwrap();
    let read = read_run(&path).unwrap();
    assert_eq!(read.channels["y/position"].meaning.clock, "host");
    assert_eq!(read.doubts[0].kind, DoubtKind::Edited);
}

#[test]
fn a_misspelt_key_of_a_sidecar_is_reported_with_its_line() {
    let error = |text: &str| parse_run_meta(Path::new("a.toml"), text).unwrap_err().to_string();
    let old = "schema = 1\nid = \"a\"\nkind = \"wet\"\nstatus = \"complete\"\n";
    assert_eq!(
        error(&(old.to_owned() + "target_sped = \"0.5 m/s\"\n")),
        "a.toml:5:1: unknown key `target_sped` in the file; did you mean `target_speed`?"
    );
    assert_eq!(error(&old.replace("wet", "wett")), "a.toml:3:8: `kind` is \"wett\"; did you mean `wet`?");
    let text = error(&(old.to_owned() + "travel = \"x\"\n"));
    assert!(text.starts_with("a.toml:5:1: unknown key `travel` in the file; known: axis, "), "{text}");
    let new = "schema = 2\nid = \"a\"\nmethod = \"tow\"\nrole = \"wet\"\nstatus = \"complete\"\n";
    assert_eq!(error(&new.replace("wet", "wett")), "a.toml:4:8: `role` is \"wett\"; did you mean `wet`?");
    assert_eq!(error(&new.replace("wet", "decoy")), "a.toml:4:8: `role` is \"decoy\"; did you mean `decay`?");
    assert_eq!(
        error(&(new.to_owned() + "[mounted]\nbody = \"wet\"\ntravel = \"up\"\n")),
        "a.toml:8:10: `travel` is \"up\"; known: x, y, z"
    );
    let text = error(&(new.to_owned() + "body = \"wet\"\n"));
    assert!(text.starts_with("a.toml:6:1: unknown key `body` in the file; known: campaign, "), "{text}");
    assert_eq!(
        error(&new.replace("schema = 2", "schema = 3")),
        "a.toml:1:10: this is run schema 3; this program reads up to run schema 2: use a newer Froude"
    );
    // A method that this version does not know is kept: whoever cannot use the run says so.
    let own = parse_run_meta(Path::new("a.toml"), &new.replace("tow", "planar_motion")).unwrap();
    assert_eq!((own.method.as_str(), own.role), ("planar_motion", Role::Wet));
    assert_eq!(parse_run_meta(Path::new("a.toml"), &run_meta_text(&own)).unwrap(), own);
}

/// Runs that the version before wrote: `tests/golden/runs-1`.
#[test]
fn runs_of_the_first_schema_are_read_as_what_the_newest_says_of_them() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/runs-1");
    let facts = |set, pair, speed| CarriageFacts {
        set,
        pair,
        repeat: pair,
        axis: Axis::Y,
        target_speed_m_s: speed,
        direction: Some(Direction::Forward),
        rig: [("y".to_owned(), meta("").carriage.rig["y"])].into_iter().collect(),
        twin_seed: Some(7),
    };
    let bare = Mounted::default();
    let hung = Mounted { body: BodyState::Dry, is_ballasted: true, hung_weight_n: Some(10.0), ..bare };
    let wet = Mounted { body: BodyState::Wet, is_ballasted: true, ..bare };
    let all = [
        ("001-jog-forward", Role::Jog, bare, facts(None, None, None)),
        ("005-calibration-10N-forward", Role::Calibration, hung, facts(None, None, Some(0.2))),
        ("010-wet-p1-300mm_s-forward", Role::Wet, wet, facts(Some(2), Some(1), Some(0.3))),
    ];
    for (id, role, mounted, carriage) in all {
        let path = folder.join(format!("{id}.mcap"));
        let log = read_run(&path).unwrap();
        assert_eq!((log.doubts.len(), log.lost.len()), (0, 0), "{:?} {:?}", log.doubts, log.lost);
        assert_eq!((log.meta.method.as_str(), log.meta.role), (TOW, role));
        // Which axis of the body lay along the travel, nobody wrote: none is guessed.
        assert_eq!((&log.meta.mounted, &log.meta.carriage), (&mounted, &carriage));
        // What a channel is, its name tells.
        assert_eq!(log.channels["force"].meaning, means("force", "N", Frame::Y, -1));
        assert_eq!(log.meta.channels["truth/y/spring"], means("force", "N", Frame::Y, 1));
        assert!(log.channels.iter().all(|(name, c)| log.meta.channels[name] == c.meaning));
        // Written again it is the newest form, and says the same.
        let text = run_meta_text(&log.meta);
        assert!(text.contains("schema = 2\n") && text.contains("method = \"tow\"\n"), "{text}");
        let sidecar = read_run_meta(&path.with_extension("toml")).unwrap();
        assert_eq!(parse_run_meta(&path, &run_meta_text(&sidecar)).unwrap(), sidecar);
        // The log alone says it too, but for its own hash.
        let alone = RunReader::new(&path, std::io::Cursor::new(std::fs::read(&path).unwrap()), None).unwrap();
        assert_eq!(alone.read_all().unwrap().meta, RunMeta { log: None, ..log.meta });
    }
}

#[test]
fn a_channel_is_asked_for_with_its_dimension() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path(), "run", 0..10, Packing::None);
    let log = read_run(&path).unwrap();
    assert_eq!(log.channel("force", Dimension::FORCE).unwrap().len(), 10);
    let at = path.display();
    assert_eq!(
        log.channel("y/positon", Dimension::LENGTH).unwrap_err().to_string(),
        format!("{at}: there is no column `y/positon`; did you mean `y/position`?")
    );
    assert_eq!(
        log.channel("force", Dimension::LENGTH).unwrap_err().to_string(),
        format!("{at}: column `force [N]`: wrong unit: expected a length (m), found a force (N)")
    );
}

#[test]
fn ticks_that_never_came_are_a_gap_and_in_no_column() {
    let folder = tempfile::tempdir().unwrap();
    let ticks = (10..500).chain(700..1000);
    let log = read_run(&recorded(folder.path(), "run", ticks, Packing::Lz4)).unwrap();
    assert_eq!(log.len(), 490 + 300);
    assert_values(&log);
    let [gap] = log.lost.as_slice() else { panic!("{:?}", log.lost) };
    assert_eq!((gap.from_s, gap.to_s), (Some(499.0 / RATE_HZ), Some(700.0 / RATE_HZ)));
    assert_eq!((gap.ticks, gap.cause), (Some(200), GapCause::Link));
    assert_eq!(gap.text, "200 ticks are missing before 0.175 s: they never reached the recorder");
    assert_eq!(log.lost_ticks(), 200);
    let part = log.between(0.1, 0.2);
    assert_eq!(part.len(), 100 + 100, "0.1 to 0.125 s and 0.175 to 0.2 s");
    assert_eq!(part.lost.len(), 1);
    assert_eq!(log.between(0.0, 0.1).lost, []);
}

#[test]
fn ticks_count_on_where_the_sequence_number_of_a_message_wraps() {
    let folder = tempfile::tempdir().unwrap();
    let first = u64::from(u32::MAX) - 500;
    let mut recorder = Recorder::create(folder.path(), meta("long"), layout(), Packing::Lz4).unwrap();
    (first..first + 1000).for_each(|tick| recorder.record(tick, &row(tick)).unwrap());
    let log = read_run(&recorder.finish(RunStatus::Complete).unwrap()).unwrap();
    assert_eq!(log.len(), 1000);
    assert_values(&log);
    assert_eq!(log.lost, []);
}

#[test]
fn events_keep_their_time_their_sort_and_their_words() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::create(folder.path(), meta("run"), layout(), Packing::Lz4).unwrap();
    let events = [
        (3, EventKind::Phase, "steady"),
        (40, EventKind::Other("odd".to_owned()), "käfer [µs] \u{1F6A2}"),
        (41, EventKind::Fault, "following error 12 mm, limit 10 mm: controlled stop"),
    ];
    for tick in 0..50 {
        recorder.record(tick, &row(tick)).unwrap();
        for (_, kind, text) in events.iter().filter(|(at, ..)| *at == tick) {
            recorder.event(tick, kind, text).unwrap();
        }
    }
    let log = read_run(&recorder.finish(RunStatus::Faulted).unwrap()).unwrap();
    let read: Vec<_> = log.events.iter().map(|e| (e.time_s, e.kind.clone(), e.text.as_str())).collect();
    assert_eq!(read, events.map(|(tick, kind, text)| (tick as f64 / RATE_HZ, kind, text)));
    assert_eq!(log.meta.status, RunStatus::Faulted);
}

#[test]
fn a_run_that_is_being_recorded_is_running_and_one_that_was_left_is_interrupted() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::create(folder.path(), meta("run"), layout(), Packing::Lz4).unwrap();
    (0..1000).for_each(|tick| recorder.record(tick, &row(tick)).unwrap());
    let path = recorder.path().to_owned();
    let now = read_run(&path).unwrap();
    assert_eq!(now.meta.status, RunStatus::Running);
    assert_eq!(now.len(), 966, "all but the ticks of the last chunk: one of 161 ticks is handed over");
    assert_eq!(read_run_meta(&path.with_extension("toml")).unwrap().status, RunStatus::Running);
    drop(recorder);
    let log = read_run(&path).unwrap();
    assert_eq!(log.meta.status, RunStatus::Interrupted);
    assert_eq!(log.len(), 1000);
    assert_eq!(log.lost.len(), 1);
    assert_eq!(log.lost[0].cause, GapCause::CutOff);
}

#[test]
fn nothing_older_than_50_ms_of_run_time_is_kept_back_even_when_ticks_stop_coming() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::create(folder.path(), meta("run"), layout(), Packing::Lz4).unwrap();
    let path = recorder.path().to_owned();
    for tick in 0..1000 {
        recorder.record(tick, &row(tick)).unwrap();
        if tick % 37 == 0 {
            let kept = read_run(&path).unwrap().time_s.last().map_or(0.0, |t| *t);
            assert!(tick as f64 / RATE_HZ - kept <= 0.05, "tick {tick}, kept up to {kept} s");
        }
    }
    recorder.advance(1200).unwrap();
    assert_eq!(read_run(&path).unwrap().len(), 1000);
}

#[test]
fn what_cannot_be_recorded_is_refused_in_words_and_recording_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::create(folder.path(), meta("run"), layout(), Packing::Lz4).unwrap();
    let path = recorder.path().display().to_string();
    recorder.record(5, &row(5)).unwrap();
    let error = recorder.record(5, &row(5)).unwrap_err().to_string();
    assert_eq!(error, format!("cannot record tick 5 of {path}: the last one was 5; ticks must increase"));
    let error = recorder.record(6, &[1.0]).unwrap_err().to_string();
    assert_eq!(error, format!("cannot record tick 6 of {path}: it has 1 values, the layout has 21 channels"));
    recorder.record(6, &row(6)).unwrap();
    let again = Recorder::create(folder.path(), meta("run"), layout(), Packing::Lz4);
    let error = again.err().unwrap().to_string();
    assert!(error.ends_with("a run of this name is there already; give the new run another id, or move the old one"));
    recorder.finish(RunStatus::Complete).unwrap();
    assert_eq!(read_run(Path::new(&path)).unwrap().len(), 2);
    let error = Recorder::create(folder.path(), meta("../a"), layout(), Packing::Lz4).err().unwrap().to_string();
    assert_eq!(
        error,
        "run \"../a\": `id` is \"../a\"; it names the run's files: write letters, digits, `-`, `_` and `.`"
    );
}

#[test]
fn a_tick_with_a_number_that_is_none_is_kept_in_the_file_and_reported_as_a_gap() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::create(folder.path(), meta("run"), layout(), Packing::Lz4).unwrap();
    for tick in 0..10 {
        let mut row = row(tick);
        if tick == 4 {
            row[5] = f64::NAN;
        }
        recorder.record(tick, &row).unwrap();
    }
    let log = read_run(&recorder.finish(RunStatus::Complete).unwrap()).unwrap();
    assert_eq!(log.len(), 9);
    let [gap] = log.lost.as_slice() else { panic!("{:?}", log.lost) };
    assert_eq!((gap.ticks, gap.cause), (Some(1), GapCause::NotFinite));
    assert_eq!(gap.text, "1 tick is missing before 0.00125 s: y/command is NaN in tick 4");
}

#[test]
fn a_log_cut_off_at_any_byte_gives_its_whole_chunks_and_says_what_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    for packing in [Packing::None, Packing::Lz4] {
        let id = format!("{packing:?}");
        let path = recorded(folder.path(), &id, 0..700, packing);
        let bytes = std::fs::read(&path).unwrap();
        let whole = read_run(&path).unwrap();
        std::fs::remove_file(path.with_extension("toml")).unwrap();
        let cut = folder.path().join("cut.mcap");
        let mut before = 0;
        // Every byte of the head, of a chunk's borders and of the end would do; a prime step meets all of them.
        let ends = (0..bytes.len()).step_by(if packing == Packing::None { 241 } else { 53 });
        for end in ends.chain(bytes.len() - 60..bytes.len()) {
            std::fs::write(&cut, &bytes[..end]).unwrap();
            let log = read_run(&cut).unwrap();
            assert!(log.len() >= before || end >= bytes.len() - 60, "a longer file holds no less");
            before = log.len();
            assert!([0, 161, 322, 483, 644, 700].contains(&log.len()), "{end} bytes gave {} ticks", log.len());
            assert_eq!(log.time_s, whole.time_s[..log.len()]);
            let is_ended = end >= bytes.len() - 8 - 29;
            assert_eq!(log.lost.len(), usize::from(log.meta.status != RunStatus::Complete), "{end}: {:?}", log.lost);
            if !is_ended && log.len() < 700 {
                assert_eq!(log.meta.status, RunStatus::Interrupted, "{end}");
                assert_eq!(log.lost[0].cause, GapCause::CutOff);
            }
        }
    }
}

#[test]
fn a_damaged_chunk_is_a_gap_with_its_byte_or_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path(), "run", 0..1000, Packing::Lz4);
    let mut bytes = std::fs::read(&path).unwrap();
    // Three chunks in: the first holds the channels, each later one 161 ticks.
    let chunks = chunks(&bytes);
    let (offset, length) = chunks[2];
    bytes[offset + length / 2] ^= 0x10;
    std::fs::write(&path, &bytes).unwrap();
    let log = read_run(&path).unwrap();
    assert_eq!(log.len(), 839);
    assert_values(&log);
    let [gap] = log.lost.as_slice() else { panic!("{:?}", log.lost) };
    assert_eq!((gap.from_s, gap.to_s), (Some(160.0 / RATE_HZ), Some(322.0 / RATE_HZ)));
    assert_eq!((gap.ticks, gap.cause), (Some(161), GapCause::Damaged));
    let begin = format!("161 ticks are missing before 0.0805 s: the chunk at byte {offset} is damaged: ");
    assert!(gap.text.starts_with(&begin), "{}", gap.text);
    assert_eq!(log.meta.status, RunStatus::Complete, "the run itself ended as planned");
}

#[test]
fn a_whole_file_is_read_even_when_the_chunk_with_its_channels_is_damaged() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path(), "run", 0..1000, Packing::None);
    let mut bytes = std::fs::read(&path).unwrap();
    let (offset, length) = chunks(&bytes)[0];
    bytes[offset + length / 2] ^= 0x10;
    std::fs::write(&path, &bytes).unwrap();
    let log = read_run(&path).unwrap();
    assert_eq!(log.len(), 1000);
    assert_values(&log);
    assert_eq!(log.lost.len(), 1);
}

/// Offset and length of each chunk record, from the index of the official library.
fn chunks(bytes: &[u8]) -> Vec<(usize, usize)> {
    let summary = mcap::Summary::read(bytes).unwrap().unwrap();
    summary.chunk_indexes.iter().map(|c| (c.chunk_start_offset as usize, c.chunk_length as usize)).collect()
}

#[test]
fn a_run_streams_in_blocks_of_a_chunk_and_only_what_is_wanted() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path(), "run", 0..4000, Packing::Lz4);
    let mut reader = RunReader::open(&path).unwrap().select(&["force", "y/position"]).unwrap();
    assert_eq!(reader.channels(), [("y/position".to_owned(), "m".to_owned()), ("force".to_owned(), "N".to_owned())]);
    let (mut block, mut ticks) = (Block::default(), 0u64);
    while reader.read_block(&mut block).unwrap() {
        assert!(block.time_s.len() <= 161, "one chunk at a time");
        for i in 0..block.time_s.len() {
            let row = row(ticks);
            assert_eq!((block.columns[0][i], block.columns[1][i]), (row[1], row[18]));
            ticks += 1;
        }
    }
    assert_eq!(ticks, 4000);
    let error = RunReader::open(&path).unwrap().select(&["forces"]).err().unwrap().to_string();
    assert_eq!(error, format!("{}: there is no column `forces`; did you mean `force`?", path.display()));
}

#[test]
fn the_official_library_counts_the_messages_that_were_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = std::fs::read(recorded(folder.path(), "run", 0..2000, Packing::Lz4)).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let statistics = summary.stats.unwrap();
    assert_eq!(statistics.message_count, 4 * 2000);
    assert_eq!(statistics.message_start_time, START_NS);
    assert_eq!(statistics.message_end_time, START_NS + 1999 * 250_000);
    let mut topics: Vec<_> = summary.channels.values().map(|c| c.topic.clone()).collect();
    topics.sort();
    assert_eq!(topics, ["/axis/x", "/axis/y", "/events", "/force", "/truth/y"]);
    let read = mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap);
    assert_eq!(read.filter(|m| m.channel.topic == "/axis/y" && m.data.len() == 4 + 7 * 8 + 2).count(), 2000);
}

#[test]
fn what_is_no_run_is_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, "time,force\n0,1\n").unwrap();
    assert_eq!(
        read_run(&path).unwrap_err().to_string(),
        format!(
            "{}, byte 0: the file does not begin as MCAP does; runs are MCAP files that `froude run` records",
            path.display()
        )
    );
    assert!(read_run(folder.path()).unwrap_err().to_string().ends_with("it is a folder"));
}

/// The next of a sequence that is the same in every test run (splitmix64).
fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[test]
fn bytes_changed_anywhere_give_a_run_or_an_error_and_never_a_panic() {
    // The long validation sets more; libFuzzer goes further, from the same seeds.
    let n: u64 = std::env::var("FROUDE_TEST_CHANGES").ok().and_then(|n| n.parse().ok()).unwrap_or(10_000);
    let seeds = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/seeds/run_mcap");
    let mut seeds: Vec<_> = std::fs::read_dir(seeds).unwrap().map(|e| e.unwrap().path()).collect();
    seeds.sort();
    let seeds: Vec<_> = seeds.iter().map(|path| std::fs::read(path).unwrap()).collect();
    assert_eq!(seeds.len(), 6);
    let (mut state, mut n_read) = (1, 0);
    for k in 0..n {
        let mut bytes = seeds[(k % 6) as usize].clone();
        for _ in 0..=next(&mut state) % 4 {
            let at = (next(&mut state) % bytes.len() as u64) as usize;
            match next(&mut state) % 4 {
                0 => bytes[at] ^= 1 << (next(&mut state) % 8),
                1 => bytes[at] = [0, 1, 0x7f, 0x80, 0xff, 5, 6, 12][(next(&mut state) % 8) as usize],
                2 => bytes.truncate(at.max(9)),
                _ => {
                    // A hostile length.
                    let value = (next(&mut state) >> (next(&mut state) % 64)).to_le_bytes();
                    let end = (at + 8).min(bytes.len());
                    bytes[at..end].copy_from_slice(&value[..end - at]);
                }
            }
        }
        let reader = RunReader::new(Path::new("run.mcap"), std::io::Cursor::new(&bytes), None);
        match reader.and_then(RunReader::read_all) {
            Ok(log) => {
                n_read += 1;
                assert!(log.time_s.windows(2).all(|w| w[0] < w[1]));
                assert!(log.channels.values().all(|c| c.values.len() == log.len()));
                assert!(log.channels.values().flat_map(|c| &c.values).all(|v| v.is_finite()));
            }
            Err(error) => assert!(error.to_string().starts_with("run.mcap"), "{error}"),
        }
    }
    assert!(n_read > n / 2, "most damage leaves something to read: {n_read} of {n}");
}

#[test]
fn logs_that_were_exchanged_are_reported_once_each_and_by_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let short = recorded(folder.path(), "045-wet", 0..300, Packing::Lz4);
    let long = recorded(folder.path(), "046-dry", 0..900, Packing::Lz4);
    let aside = folder.path().join("aside");
    std::fs::rename(&short, &aside).unwrap();
    std::fs::rename(&long, &short).unwrap();
    std::fs::rename(&aside, &long).unwrap();
    for (path, own, said) in [(&short, "046-dry", "045-wet"), (&long, "045-wet", "046-dry")] {
        let doubts = read_run(path).unwrap().doubts;
        let [doubt] = doubts.as_slice() else { panic!("{doubts:?}") };
        assert_eq!(doubt.kind, DoubtKind::Exchanged);
        let text = "they were exchanged or renamed; give each log and each sidecar the name of its own run";
        assert_eq!(
            doubt.text,
            format!("{} is the log of run {own} and its sidecar is that of {said}: {text}", path.display())
        );
    }
}

/// Topics of another program have rates of their own: joined by sequence number most of them would be lost.
#[test]
fn a_log_of_another_program_is_refused_by_name() {
    use std::collections::BTreeMap;
    let folder = tempfile::tempdir().unwrap();
    for (encoding, text) in [("json", &b"{\"x\": 1}"[..]), ("cdr", &[0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f])] {
        let path = folder.path().join(format!("{encoding}.mcap"));
        let mut writer = mcap::Writer::new(std::fs::File::create(&path).unwrap()).unwrap();
        let schema = writer.add_schema("lab_msgs/msg/X", "ros2msg", b"float64 x").unwrap();
        for topic in ["/imu", "/thruster"] {
            let id = writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap();
            let header = mcap::records::MessageHeader { channel_id: id, sequence: 0, log_time: 1, publish_time: 1 };
            writer.write_to_known_channel(&header, text).unwrap();
        }
        writer.finish().unwrap();
        assert_eq!(
            read_run(&path).unwrap_err().to_string(),
            format!(
                "{}: an MCAP log of another program (topics /imu, /thruster); expected a run that `froude run` recorded. `froude inspect \
                 {}` lists its topics and their fields; a sidecar with [columns] reads a topic as a table, and `froude convert` writes it as CSV",
                path.display(),
                path.display()
            )
        );
    }
}
