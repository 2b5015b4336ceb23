//! `froude run` on a board at a pseudo-terminal, with a person at another: slow answers, signals, and readers that go away.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use froude::records::run::{RunStatus, read_run};
use froude_control::fault::StopCategory;
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::Phase;
use froude_link::{FrameWriter, ToBoard};
use froude_rig::defaults::control_config;
use froude_rig::load::Load;
use rustix::process::{Pid, Signal, kill_process};

#[path = "../../froude-rig/tests/board/mod.rs"]
mod board;
use board::{BoardAtTerminal, BoardConfig, keyboard};

/// Longest wait for something that has to happen, on a computer that is busy with other tests.
const PATIENCE: Duration = Duration::from_mins(2);
/// An answer that comes late: the host's patience with a silent board is 1 s, the board's with a silent host 0.2 s.
const LATE: Duration = Duration::from_secs(5);
/// What the board forgives a computer that is busy with other tests; an answer that comes [`LATE`] is later than that.
const BUSY: Duration = Duration::from_secs(3);
/// A motor that has moved no farther than this has not been driven, m.
const STILL_M: f64 = 1e-4;

/// The example as it is shipped, on a board: 205 runs.
fn shipped(folder: &Path, port: &Path) -> PathBuf {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/towing-carriage/campaign.toml");
    let mut text = std::fs::read_to_string(example).unwrap();
    for (from, to) in on_a_board(port) {
        assert!(text.contains(from), "the example has no {from}");
        text = text.replace(from, &to);
    }
    let path = folder.join("campaign.toml");
    std::fs::write(&path, text).unwrap();
    path
}

/// What makes the example's rig a board, and no twin.
fn on_a_board(port: &Path) -> [(&'static str, String); 4] {
    let serial = format!("kind = \"serial\"\nport = \"{}\"\nbaud = 3_000_000 #", port.display());
    [
        ("kind = \"twin\"  ", serial),
        ("seed = 1\n", String::new()),
        ("[rig.twin]                        # the truth that identification has to find\n", String::new()),
        ("drag = \"20 N s^2/m^2\"\npulley_friction = \"1 %\"\n", String::new()),
    ]
}

/// The example, on the twin or on a board: two jogs, then runs with the body dry; the warm-up on request.
fn campaign(folder: &Path, port: Option<&Path>, has_warm_up: bool) -> PathBuf {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/towing-carriage/campaign.toml");
    let mut text = std::fs::read_to_string(example).unwrap();
    let mut changes = vec![
        (r#"still = "5 s""#, r#"still = "2 s""#.to_owned()),
        (r#"settling = { dry = "5 s", wet = "120 s" }"#, r#"settling = { dry = "0.5 s", wet = "0.5 s" }"#.to_owned()),
        (r#"duration = "1 min""#, r#"duration = "10 s""#.to_owned()),
        (r#"speed = "0.3 m/s""#, r#"speed = "0.55 m/s""#.to_owned()),
        (
            r#"speeds = ["0.05 m/s", "0.15 m/s", "0.25 m/s", "0.35 m/s", "0.45 m/s", "0.55 m/s"]"#,
            r#"speeds = ["0.55 m/s"]"#.to_owned(),
        ),
        (
            r#"speeds = ["0.02 m/s", "0.05 m/s", "0.1 m/s", "0.2 m/s", "0.35 m/s", "0.55 m/s"]"#,
            r#"speeds = ["0.55 m/s"]"#.to_owned(),
        ),
        ("repeats = 5  ", "repeats = 1  ".to_owned()),
        ("repeats = 6", "repeats = 1".to_owned()),
        (r#"stop_when = "2.5 %""#, String::new() + "#"),
    ];
    if let Some(port) = port {
        changes.extend(on_a_board(port));
    }
    for (from, to) in &changes {
        assert!(text.contains(from), "the example has no {from}");
        text = text.replace(from, to);
    }
    let excitation = text.find("[carriage.excitation]").unwrap();
    text.truncate(excitation);
    if !has_warm_up {
        let (begins, ends) =
            (text.find("[carriage.warm_up]").unwrap(), text.find("[carriage.friction_sweep]").unwrap());
        text.replace_range(begins..ends, "");
    }
    let path = folder.join("campaign.toml");
    std::fs::write(&path, text).unwrap();
    path
}

fn board() -> BoardAtTerminal {
    BoardAtTerminal::new(&BoardConfig { start_m: [0.01, 0.01], patience: BUSY }).unwrap()
}

/// `froude`, with a person at its standard input.
struct Driven {
    child: Child,
    keyboard: File,
    /// What it wrote on standard error so far.
    said: Arc<Mutex<String>>,
}

impl Driven {
    fn new(args: &[&str]) -> Self {
        let (keyboard, stdin) = keyboard().unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
            .args(args)
            .stdin(stdin)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let (mut stderr, said) = (child.stderr.take().unwrap(), Arc::new(Mutex::new(String::new())));
        let heard = Arc::clone(&said);
        std::thread::spawn(move || {
            let mut chunk = [0_u8; 1_024];
            while let Ok(n @ 1..) = stderr.read(&mut chunk) {
                heard.lock().unwrap().push_str(&String::from_utf8_lossy(&chunk[..n]));
            }
        });
        Self { child, keyboard, said }
    }

    fn said(&self) -> String {
        self.said.lock().unwrap().clone()
    }

    /// Waits until it is so, or fails with what the program said.
    fn until(&mut self, what: &str, is_so: impl Fn(&str) -> bool) {
        let begun = Instant::now();
        while !is_so(&self.said()) {
            let ended = self.child.try_wait().unwrap();
            std::thread::sleep(Duration::from_millis(10));
            assert!(ended.is_none() || is_so(&self.said()), "{what}: it ended with {ended:?}: {}", self.said());
            assert!(begun.elapsed() < PATIENCE, "{what}: {}", self.said());
        }
    }

    /// Waits until it has asked so many times.
    fn until_asked(&mut self, times: usize) {
        self.until("a question", |said| said.matches("confirm with y").count() >= times);
    }

    fn type_in(&mut self, text: &str) {
        self.keyboard.write_all(text.as_bytes()).unwrap();
    }

    fn signal(&self, signal: Signal) {
        send(&self.child, signal);
    }

    fn end(&mut self) -> (ExitStatus, String) {
        let status = ended(&mut self.child);
        // What it said last is read by another thread.
        std::thread::sleep(Duration::from_millis(100));
        (status, self.said())
    }
}

impl Drop for Driven {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn send(child: &Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).unwrap();
}

fn ended(child: &mut Child) -> ExitStatus {
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        assert!(begun.elapsed() < PATIENCE, "it does not end");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// The run that a campaign with a warm-up drives third, 2.2 m at 0.55 m/s.
const WARM_UP: &str = "003-warm-up-forward";

/// Waits until the carriage is at speed in its third run.
fn until_at_speed(board: &BoardAtTerminal, runs: &Path) {
    let begun = Instant::now();
    while !(runs.join(format!("{WARM_UP}.mcap")).exists() && board.watched().speed_m_s[0] > 0.5) {
        assert!(begun.elapsed() < PATIENCE, "it never came to speed: {:?}", board.watched());
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// How the third run is marked, and the last state of its axis: 0 disabled, 1 holding.
fn end_of_record(runs: &Path) -> (RunStatus, f64) {
    let log = read_run(&runs.join(format!("{WARM_UP}.mcap"))).unwrap();
    (log.meta.status, *log.channels["y/state"].values.last().unwrap())
}

/// Runs both cases at once: a board and its host run in real time and are mostly idle.
fn both<T: Copy + Send>(cases: [T; 2], case: impl Fn(T) + Sync) {
    std::thread::scope(|scope| {
        for of in cases {
            let case = &case;
            scope.spawn(move || case(of));
        }
    });
}

#[test]
fn a_person_may_take_their_time_and_ctrl_c_at_the_prompt_ends_it_without_enter() {
    let (folder, board) = (tempfile::tempdir().unwrap(), board());
    let campaign = campaign(folder.path(), Some(&board.port), false);
    let mut driven = Driven::new(&["run", text(&campaign)]);
    // Nothing moves before somebody has said that it may; and this answer is late already.
    driven.until_asked(1);
    assert!(driven.said().contains("Homing moves both axes now"), "{}", driven.said());
    std::thread::sleep(LATE);
    assert!(board.watched().moved_m < STILL_M && board.watched().fault.is_none(), "{:?}", board.watched());
    driven.type_in("y\n");
    // After both jogs the body is put on; the carriage holds meanwhile.
    driven.until_asked(2);
    assert_eq!(board.watched().phases[0], Phase::Holding);
    std::thread::sleep(LATE);
    assert_eq!((board.watched().phases[0], board.watched().fault), (Phase::Holding, None), "{}", driven.said());
    driven.type_in("y\n");
    driven.until("the third run", |said| said.contains("3/") && board.watched().phases[0] == Phase::Moving);
    driven.signal(Signal::INT);
    let (status, said) = driven.end();
    assert_eq!(status.code(), Some(130), "{said}");
    assert!(said.contains("stopped by the operator in 003-"), "{said}");

    // Resumed: what is mounted, then the ways; a late answer, and no answer but Ctrl-C.
    let mut driven = Driven::new(&["run", text(&campaign)]);
    driven.until_asked(1);
    std::thread::sleep(LATE);
    driven.type_in("y\n");
    driven.until_asked(2);
    let asked = Instant::now();
    driven.signal(Signal::INT);
    let (status, said) = driven.end();
    assert!(asked.elapsed() < Duration::from_secs(5), "{:?}", asked.elapsed());
    assert_eq!(status.code(), Some(130), "{said}");
    assert!(said.contains("stopped by the operator, who was asked: Homing moves both axes now"), "{said}");
}

#[test]
fn to_terminate_and_to_hang_up_however_often_stop_under_control() {
    both([Signal::TERM, Signal::HUP], |signal| {
        let (folder, board) = (tempfile::tempdir().unwrap(), board());
        let campaign = campaign(folder.path(), Some(&board.port), true);
        let runs = folder.path().join("campaign-runs");
        let mut driven = Driven::new(&["run", text(&campaign)]);
        driven.until_asked(1);
        driven.type_in("y\n");
        until_at_speed(&board, &runs);
        driven.signal(signal);
        std::thread::sleep(Duration::from_millis(50));
        driven.signal(signal);
        let (status, said) = driven.end();
        assert_eq!(status.code(), Some(130), "{said}");
        assert_eq!(end_of_record(&runs), (RunStatus::Interrupted, 1.0), "{said}");
        assert!(board.watched().speed_m_s[0].abs() < 0.05, "{:?}", board.watched());
    });
}

/// `froude run … 2>&1 | tee`, and Ctrl-C, which ends tee as well: once, and twice.
#[test]
fn ctrl_c_stops_the_carriage_when_nobody_reads_what_is_said_and_again_cuts_the_torque() {
    both([1, 2], |presses| {
        let (folder, board) = (tempfile::tempdir().unwrap(), board());
        let campaign = campaign(folder.path(), Some(&board.port), true);
        let runs = folder.path().join("campaign-runs");
        let (mut read, write) = std::io::pipe().unwrap();
        let (mut keyboard, stdin) = keyboard().unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
            .args(["run", text(&campaign)])
            .stdin(stdin)
            .stdout(write.try_clone().unwrap())
            .stderr(write)
            .spawn()
            .unwrap();
        let (mut said, mut chunk) = (String::new(), [0_u8; 1_024]);
        while !said.contains("confirm with y") {
            let n = read.read(&mut chunk).unwrap();
            assert!(n > 0, "{said}");
            said.push_str(&String::from_utf8_lossy(&chunk[..n]));
        }
        keyboard.write_all(b"y\n").unwrap();
        until_at_speed(&board, &runs);
        drop(read);
        for _ in 0..presses {
            send(&child, Signal::INT);
            std::thread::sleep(Duration::from_millis(50));
        }
        // Braking from 0.55 m/s takes half a second: the second press comes into it.
        let status = ended(&mut child);
        assert_eq!(status.code(), Some(130), "{presses} presses: {status:?}");
        let last = if presses == 1 { 1.0 } else { 0.0 };
        assert_eq!(end_of_record(&runs), (RunStatus::Interrupted, last), "{presses} presses");
    });
}

#[test]
fn without_a_terminal_and_without_yes_nothing_moves() {
    let folder = tempfile::tempdir().unwrap();
    let on_twin = campaign(folder.path(), None, false);
    let verbs: [&[&str]; 3] = [&["run"], &["carriage", "tune"], &["carriage", "resonance"]];
    for verb in verbs {
        let mut command = Command::new(env!("CARGO_BIN_EXE_froude"));
        let out = command.args(verb).arg(&on_twin).stdin(Stdio::null()).output().unwrap();
        let error = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(2), "{error}");
        assert!(
            error.contains("nothing was moved: nobody can confirm, because standard input is not a terminal"),
            "{error}"
        );
        assert!(error.contains("or give --yes, which the twin accepts"), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "only the campaign");
    }
    let board = board();
    let on_board = campaign(folder.path(), Some(&board.port), false);
    let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
        .args(["run", text(&on_board)])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Neither does who pipes answers in, as `yes | froude run` does.
    let _ = child.stdin.take().unwrap().write_all(b"y\ny\ny\n");
    let out = child.wait_with_output().unwrap();
    let error = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2), "{error}");
    assert!(error.contains("Run it in a terminal") && !error.contains("--yes"), "{error}");
    assert_eq!((board.watched().moved_m, board.watched().phases), (0.0, [Phase::Disabled; 2]));
}

#[test]
fn a_port_that_is_not_there_is_reported_before_anybody_is_asked() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = campaign(folder.path(), Some(Path::new("/dev/no-such-port")), false);
    let (status, said) = Driven::new(&["run", text(&campaign)]).end();
    assert_eq!(status.code(), Some(1), "{said}");
    assert!(said.contains("/dev/no-such-port") && !said.contains("confirm with y"), "{said}");
}

#[test]
fn on_the_twin_too_a_person_is_asked_first_and_what_was_typed_before_is_no_answer() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = campaign(folder.path(), None, false);
    let (mut keyboard, stdin) = keyboard().unwrap();
    keyboard.write_all(b"y\n").unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
        .args(["run", text(&campaign)])
        .stdin(stdin)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (mut stderr, mut said, mut chunk) = (child.stderr.take().unwrap(), String::new(), [0_u8; 1_024]);
    while !said.contains("confirm with y") {
        let n = stderr.read(&mut chunk).unwrap();
        assert!(n > 0, "{said}");
        said.push_str(&String::from_utf8_lossy(&chunk[..n]));
    }
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none(), "it took what was typed before it had asked");
    keyboard.write_all(b"no\n").unwrap();
    let status = ended(&mut child);
    stderr.read_to_string(&mut said).unwrap();
    assert_eq!(status.code(), Some(1), "{said}");
    assert!(said.contains("the operator did not confirm: Homing moves both axes now"), "{said}");
    let names: Vec<_> = std::fs::read_dir(folder.path().join("campaign-runs")).unwrap().collect();
    let is_log = |path: PathBuf| path.extension().is_some_and(|e| e == "mcap");
    assert!(!names.iter().any(|n| is_log(n.as_ref().unwrap().path())), "{names:?}");
}

/// `froude run … --yes | head -1`: what is driven is driven whole, whoever reads about it.
#[test]
fn a_reader_who_goes_away_neither_stops_a_campaign_nor_leaves_it_undriven() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = campaign(folder.path(), None, false);
    let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
        .args(["run", text(&campaign), "--yes"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let status = ended(&mut child);
    assert_eq!(status.code(), Some(0));
    let again =
        Command::new(env!("CARGO_BIN_EXE_froude")).args(["run", text(&campaign), "--yes", "--json"]).output().unwrap();
    let outcome: serde_json::Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(outcome["driven"], 0, "{outcome}");
    assert!(outcome["resumed"].as_u64().unwrap() >= 10, "{outcome}");
    // A pre-flight only prints: `| head` ends it, as it ends every other listing.
    let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
        .args(["run", text(&campaign), "--check"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert_eq!(ended(&mut child).code(), Some(0));
}

/// How long the long drive takes where somebody asks for hours, s.
fn hours() -> Option<u64> {
    std::env::var("FROUDE_TEST_DRIVE_S").ok().map(|text| text.parse().unwrap())
}

/// Another host on the line, which says all that it can, every two seconds, and now and then asks for a stop.
struct SecondHost {
    line: File,
    writer: FrameWriter,
    said: Instant,
    stopped: Instant,
    stop_every: Duration,
    stops: usize,
}

impl SecondHost {
    const SESSION: u32 = 0xbad;

    fn new(board: &BoardAtTerminal, stop_every: Duration) -> Self {
        let (line, now) = (board.line.try_clone().unwrap(), Instant::now());
        Self { line, writer: FrameWriter::default(), said: now, stopped: now, stop_every, stops: 0 }
    }

    fn say(&mut self, says: &ToBoard) {
        let mut wire = [0_u8; 1_024];
        let frame = self.writer.write(&(*says).from_session(Self::SESSION), &mut wire);
        self.line.write_all(frame).unwrap();
    }

    fn speak(&mut self) {
        if self.said.elapsed() < Duration::from_secs(2) {
            return;
        }
        self.said = Instant::now();
        let profile = Move { target_m: 0.1, speed_m_s: 0.4, acceleration_m_s2: 0.5, jerk_m_s3: 0.0, is_shaped: false };
        let jog = Excitation::Jog { volts: 2.0, distance_m: 0.5, duration_s: 5.0 };
        self.say(&ToBoard::Hello);
        self.say(&ToBoard::Heartbeat);
        self.say(&ToBoard::Configure { id: 1, config: control_config(&[Load::default(); 2]) });
        let requests = [
            Request::Move { axis: 0, profile },
            Request::Excite { axis: 0, excitation: jog },
            Request::Disable { axis: 0 },
            Request::Home { axis: 1 },
        ];
        for (id, request) in (2..).zip(requests) {
            self.say(&ToBoard::Request { id, request });
        }
        if self.stopped.elapsed() > self.stop_every {
            (self.stopped, self.stops) = (Instant::now(), self.stops + 1);
            // Twice, as a program does whose answer was lost.
            for _ in 0..2 {
                self.say(&ToBoard::Request { id: 9, request: Request::Stop(StopCategory::Two) });
            }
        }
    }
}

/// The program and the logs of two runs, the most that it has to look at together, KiB.
const MOST_KIB: u64 = 40 << 10;

/// Resident memory of a process, KiB; `None` once it has ended.
fn resident_kib(pid: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    status.lines().find_map(|l| l.strip_prefix("VmRSS:"))?.trim().strip_suffix(" kB")?.parse().ok()
}

/// Driven for as long as one likes: late answers, signals in turn, a second `froude run`, and another host on the line that asks for
/// everything and for a stop. What is complete is whole, every end is explained, and the memory does not grow.
#[test]
fn a_long_drive_with_prompts_signals_and_a_second_host_on_the_line_stays_in_its_memory() {
    let (folder, board) = (tempfile::tempdir().unwrap(), board());
    // In short: both jogs, a signal in the third run, and a stop from the second host while both axes are homed again.
    let [length, each, stop_every] = hours().map_or([45, 25, 40], |s| [s, s / 12, s / 5]).map(Duration::from_secs);
    let campaign = if hours().is_some() {
        shipped(folder.path(), &board.port)
    } else {
        campaign(folder.path(), Some(&board.port), true)
    };
    let (runs, elsewhere) = (folder.path().join("campaign-runs"), folder.path().join("elsewhere"));
    let mut second_host = SecondHost::new(&board, stop_every);
    let begun = Instant::now();
    let (mut most_kib, mut sessions, mut stopped_by_another) = ([0; 2], 0, 0);
    while begun.elapsed() < length {
        let mut driven = Driven::new(&["run", text(&campaign)]);
        let signal = [Signal::INT, Signal::TERM, Signal::HUP][sessions % 3];
        sessions += 1;
        let (session, mut answered, mut signalled, mut is_refused) = (Instant::now(), 0, 0, false);
        while driven.child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(20));
            second_host.speak();
            let half = usize::from(begun.elapsed() > length / 2);
            most_kib[half] = resident_kib(driven.child.id()).unwrap_or(0).max(most_kib[half]);
            if driven.said().matches("confirm with y").count() > answered {
                let asked = Instant::now();
                while asked.elapsed() < LATE {
                    std::thread::sleep(Duration::from_millis(20));
                    second_host.speak();
                }
                answered += 1;
                driven.type_in("y\n");
            }
            if !is_refused && session.elapsed() > each / 2 {
                is_refused = true;
                let (status, said) = Driven::new(&["run", text(&campaign), "--out", text(&elsewhere)]).end();
                assert!(status.code() == Some(1) && said.contains("another program"), "{status}: {said}");
            }
            let is_over = session.elapsed() > each + Duration::from_secs(signalled);
            // Hanging up twice is hanging up; one press of Ctrl-C is enough.
            if is_over && signalled < if signal == Signal::INT { 1 } else { 2 } {
                signalled += 1;
                driven.signal(signal);
            }
        }
        let (status, said) = driven.end();
        // The last line: the next session reports what stopped the run that it sets aside.
        let last = said.lines().last().unwrap_or_default();
        let is_by_another = last.contains("another program on the line (session 00000bad)");
        stopped_by_another += usize::from(is_by_another);
        let is_explained = is_by_another || last.contains("stopped by the operator");
        let code = if is_by_another { 1 } else { 130 };
        assert!(status.code() == Some(code) && is_explained, "{status} after {:?}: {said}", session.elapsed());
        let logs = std::fs::read_dir(&runs)
            .unwrap()
            .filter(|e| e.as_ref().unwrap().path().extension().is_some_and(|e| e == "mcap"))
            .count();
        let s = begun.elapsed().as_secs();
        println!(
            "{s} s: session {sessions}, {logs} logs, froude took at most {most_kib:?} KiB; {}",
            said.lines().last().unwrap()
        );
    }
    let (mut complete, mut lost) = (0, 0);
    for entry in std::fs::read_dir(&runs).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "mcap") {
            let log = read_run(&path).unwrap();
            assert!(log.doubts.is_empty(), "{}: {:?}", path.display(), log.doubts);
            complete += usize::from(log.meta.status == RunStatus::Complete);
            lost += log.lost_ticks();
        }
    }
    println!(
        "{} s: {sessions} sessions, {complete} runs complete, {lost} ticks lost; the second host asked for {} stops, {stopped_by_another} \
         ended a session; memory by halves {most_kib:?} KiB; {:?}",
        begun.elapsed().as_secs(),
        second_host.stops,
        board.watched()
    );
    assert!(complete > 0 && stopped_by_another > 0);
    assert!(most_kib.iter().all(|most| *most < MOST_KIB), "{most_kib:?} KiB in the first and in the second half");
}
