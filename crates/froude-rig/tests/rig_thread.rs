//! A rig whose time passes by itself, driven by a campaign that is held up: by a person, by a disk, by whoever watches.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Excitation, Request};
use froude_control::status::Phase;
use froude_records::Place;
use froude_records::run::{Axis, BodyState, Role, RunStatus, read_run};
use froude_rig::campaign::runner::{Driven, Known, Operator, Progress, RunnerError, Setting, drive};
use froude_rig::campaign::stop::StopSwitch;
use froude_rig::carriage::plan::{Drive, OperatorStep, PlannedRun, Step};
use froude_rig::carriage::{CarriagePlan, Directions, Order};
use froude_rig::defaults::control_config;
use froude_rig::drive::twin::TwinRig;
use froude_rig::drive::{Rig, RigError, Sample, Stranger};
use froude_rig::load::Load;
use froude_rig::twin::TwinConfig;
use froude_rig::{Injection, Scheduled};
use indexmap::IndexMap;

/// The twin as a rig that does not wait for anybody: its ticks come at most ten times as fast as those of a board.
struct Running {
    twin: TwinRig,
    seen: Arc<Seen>,
    /// The tick from which on the port is gone.
    gone: u64,
}

/// What the test sees of it.
#[derive(Default)]
struct Seen {
    ticks: AtomicU64,
    is_moving: AtomicBool,
    /// Another host asks for a stop at the next tick.
    is_stop_near: AtomicBool,
}

impl Rig for Running {
    fn tick(&mut self, request: Option<Request>) -> Result<Sample, RigError> {
        let ticks = self.seen.ticks.fetch_add(1, Ordering::SeqCst);
        if ticks >= self.gone {
            return Err(RigError::Port { port: "here".to_owned(), reason: "it was pulled".to_owned() });
        }
        if ticks.is_multiple_of(40) {
            std::thread::sleep(Duration::from_millis(1));
        }
        let is_stopped = request.is_none() && self.seen.is_stop_near.swap(false, Ordering::SeqCst);
        let request = if is_stopped { Some(Request::Stop(StopCategory::One)) } else { request };
        let mut sample = self.twin.tick(request)?;
        sample.stranger = is_stopped.then_some(Stranger::Stopped(0xb));
        let is_at_rest = sample.axes.iter().all(|a| matches!(a.phase, Phase::Disabled | Phase::Holding));
        self.seen.is_moving.store(!is_at_rest, Ordering::SeqCst);
        Ok(sample)
    }
    fn rate_hz(&self) -> f64 {
        self.twin.rate_hz()
    }
    fn is_real_time(&self) -> bool {
        true
    }
    fn begin_run(&mut self, load: &Load, run_number: u64) {
        self.twin.begin_run(load, run_number);
    }

    fn begin_recording(&mut self) {
        self.twin.begin_recording();
    }
    fn version(&self) -> String {
        self.twin.version()
    }
}

impl Running {
    fn new() -> Self {
        let mut config = TwinConfig::loaded(Load::default());
        for axis in &mut config.axes {
            axis.start_m = 0.01;
        }
        let load = Load::default();
        let twin = TwinRig::new(&config, control_config(&[load; 2]), 7).unwrap();
        Self { twin, seen: Arc::default(), gone: u64::MAX }
    }
}

/// One slow tow of 25 s, after somebody has confirmed that the body is off.
fn steps() -> Vec<Step> {
    let prompt = "The body is off".to_owned();
    let tow = PlannedRun {
        id: "001-tow".to_owned(),
        role: Role::Dry,
        axis: Axis::Y,
        set: None,
        pair: None,
        drive: Drive::Profile { from_m: 0.5, to_m: 1.5, speed_m_s: 0.04 },
        body: BodyState::None,
        is_ballasted: false,
        hung_weight_n: 0.0,
        floor_m: None,
        settle_s: 0.1,
    };
    vec![Step::Operator(OperatorStep { prompt, body: BodyState::None, hung_weight_n: 0.0 }), Step::Run(tow)]
}

fn setting(folder: &Path) -> Setting {
    let asked = CarriagePlan {
        axis: Axis::Y,
        speed_m_s: vec![0.04],
        repeats: 1,
        order: Order::Abba,
        directions: Directions::Forward,
        distance_m: 1.0,
        start_m: None,
        acceleration_m_s2: 0.5,
        jerk_m_s3: None,
        settling_dry_s: 0.1,
        settling_wet_s: 0.1,
        still_s: 0.1,
        warm_up: None,
        friction: None,
        calibration: None,
        excitation: None,
        is_ballasted: true,
        stop_at_relative_half_width: None,
        expected_drag_n_s2_m2: None,
        expected_scatter_n: None,
        strut_drag_n_s2_m2: None,
        place: Place::whole(Path::new("campaign.toml")),
    };
    Setting {
        campaign: "held up".to_owned(),
        campaign_sha256: String::new(),
        folder: folder.to_owned(),
        asked,
        return_speed_m_s: 0.4,
        homing_s: [300.0; 2],
        is_shaped: true,
        travel: None,
        constants: IndexMap::new(),
        load: Load::default(),
        twin_seed: None,
        decimation: 1,
        start_unix_ns: 0,
        date: "2026-11-22".to_owned(),
    }
}

/// Longest wait for something that has to happen.
const PATIENCE: Duration = Duration::from_mins(1);

fn wait(is_done: impl Fn() -> bool) -> bool {
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        if is_done() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    false
}

/// Whether the carriage is at the speed of the tow, and not on its way to its start.
fn is_towing(sample: &Sample) -> bool {
    (sample.axes[0].reference_m_s - 0.04).abs() < 1e-9
}

/// What holds the campaign up.
type Hold<'a> = &'a mut dyn FnMut(&dyn Fn() -> bool) -> bool;

/// A person who answers when `asked` says so.
struct Person<'a>(Hold<'a>);

impl Operator for Person<'_> {
    fn confirm(&mut self, _: &str, is_over: &dyn Fn() -> bool) -> bool {
        (self.0)(is_over)
    }
}

/// Somebody who watches, and holds up who tells them.
struct Watch<'a>(&'a mut dyn FnMut(&Sample, f64));

impl Progress for Watch<'_> {
    fn run_begins(&mut self, _: &PlannedRun, _: usize, _: usize) {}
    fn sample(&mut self, _: &PlannedRun, sample: &Sample, time_s: f64) {
        (self.0)(sample, time_s);
    }
    fn say(&mut self, _: &str) {}
}

fn run(
    folder: &Path,
    rig: &mut Running,
    switch: &StopSwitch,
    asked: Hold<'_>,
    watch: &mut dyn FnMut(&Sample, f64),
) -> Result<Driven, RunnerError> {
    drive(&steps(), &setting(folder), rig, switch, &mut Person(asked), &mut Watch(watch), &mut |_, _| Known::default())
}

#[test]
fn while_a_person_takes_their_time_the_rig_is_ticked_and_nothing_moves() {
    let folder = tempfile::tempdir().unwrap();
    let mut rig = Running::new();
    let seen = Arc::clone(&rig.seen);
    let mut asked = |_: &dyn Fn() -> bool| {
        let before = seen.ticks.load(Ordering::SeqCst);
        // Two seconds of the board's time: twice what makes a board that is not listened to a silent one.
        let is_ticked = wait(|| seen.ticks.load(Ordering::SeqCst) > before + 8_000);
        is_ticked && !seen.is_moving.load(Ordering::SeqCst)
    };
    let outcome = run(folder.path(), &mut rig, &StopSwitch::default(), &mut asked, &mut |_, _| {}).unwrap();
    assert_eq!(outcome.driven, 1);
    let log = read_run(&folder.path().join("001-tow.mcap")).unwrap();
    assert_eq!((log.meta.status, log.lost_ticks()), (RunStatus::Complete, 0));
}

#[test]
fn a_fault_or_a_lost_port_while_a_person_is_asked_ends_the_prompt_and_says_what_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let mut asked = |is_over: &dyn Fn() -> bool| {
        assert!(wait(is_over), "nobody said that it is over");
        false
    };
    let mut rig = Running::new();
    rig.twin.twin_mut().inject(Scheduled { tick: 2_000, axis: 0, injection: Injection::EmergencyStop });
    match run(folder.path(), &mut rig, &StopSwitch::default(), &mut asked, &mut |_, _| {}).unwrap_err() {
        error @ RunnerError::FaultAtRest { fault: Fault::EmergencyStop } => {
            assert!(error.to_string().contains("EmergencyStop (category 0 stop)"), "{error}");
        }
        other => panic!("{other}"),
    }
    let mut rig = Running { gone: 2_000, ..Running::new() };
    let error = run(folder.path(), &mut rig, &StopSwitch::default(), &mut asked, &mut |_, _| {}).unwrap_err();
    assert!(error.to_string().starts_with("here: it was pulled"), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_stop_is_carried_out_while_who_records_is_held_up() {
    let folder = tempfile::tempdir().unwrap();
    let mut rig = Running::new();
    let (seen, switch) = (Arc::clone(&rig.seen), StopSwitch::default());
    let mut is_held = false;
    let mut watch = |sample: &Sample, time_s: f64| {
        if !is_held && is_towing(sample) && time_s > 2.0 {
            is_held = true;
            switch.press();
            // A terminal that takes no more, or a disk: until the carriage stands.
            assert!(wait(|| !seen.is_moving.load(Ordering::SeqCst)), "the rig waited for the campaign");
        }
    };
    let error = run(folder.path(), &mut rig, &switch, &mut |_| true, &mut watch).unwrap_err();
    assert_eq!(error.to_string(), "stopped by the operator in 001-tow; run the campaign again to resume from there");
    let log = read_run(&folder.path().join("001-tow.mcap")).unwrap();
    assert_eq!((log.meta.status, log.lost_ticks()), (RunStatus::Interrupted, 0));
    assert_eq!(*log.channels["y/state"].values.last().unwrap(), 1.0, "holding");
}

/// An excitation that somebody else stops is not one that a soft limit cut: the campaign does not go on to the next run.
#[test]
fn a_stop_from_another_host_ends_the_campaign_in_a_run_and_between_two() {
    let folder = tempfile::tempdir().unwrap();
    let mut steps = steps();
    if let Some(Step::Run(run)) = steps.last_mut() {
        let excitation = Excitation::Pulses { volts: 0.5, period_s: 1.0, duty: 0.5, duration_s: 20.0 };
        run.drive = Drive::Excitation { from_m: 0.5, excitation };
    }
    let mut rig = Running::new();
    let seen = Arc::clone(&rig.seen);
    let mut is_stopped = false;
    let mut watch = |sample: &Sample, time_s: f64| {
        if !is_stopped && sample.axes[0].phase == Phase::Exciting && time_s > 2.0 {
            is_stopped = true;
            seen.is_stop_near.store(true, Ordering::SeqCst);
        }
    };
    let (setting, switch) = (setting(folder.path()), StopSwitch::default());
    let mut ready = |_: &dyn Fn() -> bool| true;
    let mut person = Person(&mut ready);
    let error =
        drive(&steps, &setting, &mut rig, &switch, &mut person, &mut Watch(&mut watch), &mut |_, _| Known::default());
    let said = error.unwrap_err().to_string();
    assert!(
        said.starts_with("another program on the line (session 0000000b) stopped the carriage in 001-tow. "),
        "{said}"
    );
    let log = read_run(&folder.path().join("001-tow.mcap")).unwrap();
    assert_eq!((log.meta.status, &log.meta.note), (RunStatus::Interrupted, &said));
    let event = log.events.iter().find(|e| e.text.contains("asked for a stop")).unwrap();
    let last_s = *log.time_s.last().unwrap();
    assert!(event.time_s > 2.0 && event.time_s < last_s, "{} s of {last_s} s", event.time_s);

    let folder = tempfile::tempdir().unwrap();
    let mut rig = Running::new();
    let seen = Arc::clone(&rig.seen);
    let mut asked = |is_over: &dyn Fn() -> bool| {
        seen.is_stop_near.store(true, Ordering::SeqCst);
        assert!(wait(is_over), "nobody said that it is over");
        false
    };
    match run(folder.path(), &mut rig, &switch, &mut asked, &mut |_, _| {}).unwrap_err() {
        RunnerError::StoppedAtRest { session: 0xb } => {}
        other => panic!("{other}"),
    }
}

#[test]
fn a_disk_that_stays_ten_seconds_behind_stops_the_carriage() {
    let folder = tempfile::tempdir().unwrap();
    let mut rig = Running::new();
    let (seen, mut is_held) = (Arc::clone(&rig.seen), false);
    let mut watch = |sample: &Sample, time_s: f64| {
        if !is_held && is_towing(sample) && time_s > 1.0 {
            is_held = true;
            assert!(wait(|| !seen.is_moving.load(Ordering::SeqCst)), "it went on unrecorded");
        }
    };
    let error = run(folder.path(), &mut rig, &StopSwitch::default(), &mut |_| true, &mut watch).unwrap_err();
    assert!(error.to_string().starts_with("the carriage was stopped in 001-tow because the disk is 10 s behind it"));
    let log = read_run(&folder.path().join("001-tow.mcap")).unwrap();
    assert_eq!(log.meta.status, RunStatus::Interrupted);
    assert!(log.meta.note.starts_with("the carriage was stopped in 001-tow"), "{}", log.meta.note);
}
