//! A whole small campaign on the twin: driven, stopped, resumed, and what happens when something breaks.

use std::path::Path;

use crate::faults::Faults;
use froude_control::fault::StopCategory;
use froude_control::request::Request;
use froude_control::status::Phase;
use froude_records::Place;
use froude_records::campaign::BodyAxis;
use froude_records::run::{Axis, Role, RunStatus, read_run};
use froude_rig::campaign::runner::{Driven, Known, Operator, Progress, RunnerError, Setting, drive};
use froude_rig::campaign::stop::StopSwitch;
use froude_rig::carriage::plan::{PlannedRun, Step, plan};
use froude_rig::carriage::{Calibration, CarriagePlan, Directions, Order, PulseTrain};
use froude_rig::defaults::control_config;
use froude_rig::drive::twin::TwinRig;
use froude_rig::drive::{Rig, RigError, Sample};
use froude_rig::encoder::EncoderFault;
use froude_rig::load::{BodyState, Load};
use froude_rig::twin::TwinConfig;
use froude_rig::{Injection, Scheduled};
use indexmap::IndexMap;

fn asked() -> CarriagePlan {
    CarriagePlan {
        axis: Axis::Y,
        speed_m_s: vec![0.3],
        repeats: 1,
        order: Order::Abba,
        directions: Directions::Forward,
        distance_m: 1.0,
        start_m: None,
        acceleration_m_s2: 0.5,
        jerk_m_s3: None,
        settling_dry_s: 0.5,
        settling_wet_s: 0.5,
        still_s: 0.5,
        warm_up: None,
        friction: None,
        calibration: Some(Calibration {
            weights_n: vec![10.0],
            weight_standard_n: 0.01,
            pulley_loss: None,
            speed_m_s: 0.2,
            repeats: 1,
            start_m: None,
            distance_m: None,
            floor_m: None,
        }),
        excitation: None,
        is_ballasted: true,
        stop_at_relative_half_width: None,
        expected_drag_n_s2_m2: Some(20.0),
        expected_scatter_n: None,
        strut_drag_n_s2_m2: None,
        place: Place::whole(Path::new("campaign.toml")),
    }
}

/// Says yes and remembers what it was asked; presses the switch when a certain run has gone on for a while.
#[derive(Default)]
struct Hand {
    asked: Vec<String>,
    begun: Vec<String>,
    press: Option<(&'static str, f64, usize)>,
    switch: StopSwitch,
}

impl Operator for Hand {
    fn confirm(&mut self, prompt: &str, _: &dyn Fn() -> bool) -> bool {
        self.asked.push(prompt.to_owned());
        true
    }
}

struct Watch<'a>(&'a mut Vec<String>, Option<(&'static str, f64, usize)>, StopSwitch);

impl Progress for Watch<'_> {
    fn run_begins(&mut self, run: &PlannedRun, _: usize, _: usize) {
        self.0.push(run.id.clone());
    }
    fn sample(&mut self, run: &PlannedRun, _: &Sample, time_s: f64) {
        if let Some((name, at_s, presses)) = self.1
            && run.id.contains(name)
            && time_s > at_s
        {
            (0..presses).for_each(|_| self.2.press());
            self.1 = None;
        }
    }
    fn say(&mut self, _: &str) {}
}

fn setting(folder: &Path) -> Setting {
    Setting {
        campaign: "small".to_owned(),
        campaign_sha256: String::new(),
        folder: folder.to_owned(),
        asked: asked(),
        return_speed_m_s: 0.4,
        homing_s: [300.0; 2],
        is_shaped: true,
        travel: Some(BodyAxis::Y),
        constants: IndexMap::new(),
        load: Load::default(),
        twin_seed: Some(7),
        decimation: 4,
        start_unix_ns: 0,
        date: "2026-11-21".to_owned(),
    }
}

fn rig() -> TwinRig {
    let load = Load::mounted(BodyState::Dry);
    let config = TwinConfig::loaded(Load::default());
    TwinRig::new(&config, control_config(&[load, load]), 7).unwrap()
}

fn run(folder: &Path, hand: &mut Hand, rig: &mut TwinRig) -> Result<Driven, RunnerError> {
    let steps = plan(&asked(), 1.5, 1);
    let mut begun = Vec::new();
    let switch = hand.switch.clone();
    let mut watch = Watch(&mut begun, hand.press, switch.clone());
    let outcome = drive(&steps, &setting(folder), rig, &switch, hand, &mut watch, &mut |_, _| Known::default());
    hand.begun = begun;
    outcome
}

fn names(steps: &[Step]) -> Vec<&str> {
    steps.iter().filter_map(|s| if let Step::Run(r) = s { Some(r.id.as_str()) } else { None }).collect()
}

#[test]
fn a_campaign_is_driven_recorded_and_not_driven_twice() {
    let folder = tempfile::tempdir().unwrap();
    let mut hand = Hand::default();
    let outcome = run(folder.path(), &mut hand, &mut rig()).unwrap();
    let steps = plan(&asked(), 1.5, 1);
    assert_eq!(outcome.driven, names(&steps).len());
    assert_eq!(hand.begun, names(&steps));
    // Four times something is mounted; before all that, somebody says that homing may begin.
    assert_eq!(hand.asked.len(), 5, "{:?}", hand.asked);
    assert!(hand.asked[0].starts_with("Homing moves both axes now"), "{:?}", hand.asked);
    for name in names(&steps) {
        let log = read_run(&folder.path().join(format!("{name}.mcap"))).unwrap();
        assert_eq!(log.meta.status, RunStatus::Complete);
        assert_eq!(log.lost_ticks(), 0);
        assert!((log.sample_rate_hz().unwrap() - 1_000.0).abs() < 1e-6);
    }
    // What hangs on the strut lies as the campaign says; where nothing hangs, nothing lies.
    let mounted = |name: &str| read_run(&folder.path().join(format!("{name}.mcap"))).unwrap().meta.mounted;
    for name in names(&steps) {
        let of_body = if name.contains("jog") { None } else { Some(BodyAxis::Y) };
        assert_eq!(mounted(name).travel, of_body, "{name}");
    }
    // The wet run's sensor sees the drag, 20 · 0.3² = 1.8 N, within its drift of ± 0.2 N and the ripple.
    let wet = names(&steps).into_iter().find(|n| n.contains("wet")).unwrap();
    let log = read_run(&folder.path().join(format!("{wet}.mcap"))).unwrap();
    let (force, speed) = (&log.channels["force"].values, &log.channels["y/reference_velocity"].values);
    let steady: Vec<f64> = force.iter().zip(speed).filter(|(_, v)| **v > 0.299).map(|(f, _)| *f).collect();
    let mean = steady.iter().sum::<f64>() / steady.len() as f64;
    assert!((mean - 1.8).abs() < 0.25, "{mean} N over {} ticks", steady.len());

    let again = run(folder.path(), &mut Hand::default(), &mut rig()).unwrap();
    assert_eq!((again.driven, again.resumed), (0, outcome.driven));
}

#[test]
fn the_first_press_stops_and_holds_and_the_campaign_goes_on_from_there() {
    let folder = tempfile::tempdir().unwrap();
    let mut hand = Hand { press: Some(("dry", 2.0, 1)), ..Hand::default() };
    let mut driven = rig();
    let error = run(folder.path(), &mut hand, &mut driven).unwrap_err();
    let stopped = hand.begun.last().unwrap().clone();
    assert_eq!(
        error.to_string(),
        format!("stopped by the operator in {stopped}; run the campaign again to resume from there")
    );
    // Stopped under control: at rest, and still holding.
    let log = read_run(&folder.path().join(format!("{stopped}.mcap"))).unwrap();
    assert_eq!(log.meta.status, RunStatus::Interrupted);
    assert_eq!(*log.channels["y/state"].values.last().unwrap(), 1.0, "holding");
    assert!(log.channels["truth/y/load_velocity"].values.last().unwrap().abs() < 0.02);

    let mut hand = Hand::default();
    let outcome = run(folder.path(), &mut hand, &mut rig()).unwrap();
    assert_eq!(hand.begun.first().unwrap(), &stopped);
    assert!(outcome.resumed > 0);
    // What was interrupted is kept beside the run that replaced it.
    assert!(folder.path().join(format!("{stopped}.interrupted-1.mcap")).exists());
    let log = read_run(&folder.path().join(format!("{stopped}.mcap"))).unwrap();
    assert_eq!((log.meta.role, log.meta.status), (Role::Dry, RunStatus::Complete));
}

#[test]
fn the_second_press_cuts_the_torque() {
    let folder = tempfile::tempdir().unwrap();
    let mut hand = Hand { press: Some(("dry", 2.0, 2)), ..Hand::default() };
    run(folder.path(), &mut hand, &mut rig()).unwrap_err();
    let log = read_run(&folder.path().join(format!("{}.mcap", hand.begun.last().unwrap()))).unwrap();
    assert_eq!(*log.channels["y/state"].values.last().unwrap(), 0.0, "disabled");
    assert_eq!(*log.channels["y/command"].values.last().unwrap(), 0.0);
}

#[test]
fn a_fault_ends_the_run_and_the_run_is_kept_and_marked() {
    let folder = tempfile::tempdir().unwrap();
    let mut driven = rig();
    // A hundred seconds after power-up: in the dry run. A count that stops while the carriage moves is a jump of its speed.
    driven.twin_mut().inject(Scheduled { tick: 400_000, axis: 0, injection: Injection::Encoder(EncoderFault::Stuck) });
    let mut hand = Hand::default();
    match run(folder.path(), &mut hand, &mut driven).unwrap_err() {
        RunnerError::Fault { fault, run } => {
            assert!(Injection::Encoder(EncoderFault::Stuck).accepted().contains(&fault), "{fault:?} in {run}");
        }
        other => panic!("{other}"),
    }
}

/// Pulses that drive the carriage to its far soft limit.
#[test]
fn an_excitation_that_ends_before_its_time_is_cut_and_the_campaign_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let long = PulseTrain { amplitude_v: 2.0, period_s: 8.0, duty: 0.6, duration_s: 20.0 };
    let asked = CarriagePlan { excitation: Some(long), calibration: None, ..asked() };
    let steps = plan(&asked, 1.5, 1);
    let setting = Setting { asked, ..setting(folder.path()) };
    let run = |rig: &mut TwinRig| {
        let (mut hand, mut begun) = (Hand::default(), Vec::new());
        let switch = StopSwitch::default();
        let mut watch = Watch(&mut begun, None, switch.clone());
        (drive(&steps, &setting, rig, &switch, &mut hand, &mut watch, &mut |_, _| Known::default()).unwrap(), begun)
    };
    let (outcome, begun) = run(&mut rig());
    assert_eq!(outcome.driven, names(&steps).len(), "the campaign went on");
    assert_eq!(outcome.cut.len(), 1, "{:?}", outcome.cut);
    let told = &outcome.cut[0];
    assert!(told.starts_with("003-pulses was cut: the pulses ended after "), "{told}");
    assert!(told.contains(" s of 20 s, at 4.") && told.ends_with("what would leave the soft limits"), "{told}");
    let log = read_run(&folder.path().join("003-pulses.mcap")).unwrap();
    assert_eq!(log.meta.status, RunStatus::Cut);
    assert!(told.ends_with(&log.meta.note), "{}", log.meta.note);
    assert!(log.events.iter().any(|e| e.text == log.meta.note), "{:?}", log.events);
    assert_eq!(begun.len(), outcome.driven);

    // Driven again it is the only one, and the first is kept.
    let (outcome, begun) = run(&mut rig());
    assert_eq!((begun, outcome.driven), (vec!["003-pulses".to_owned()], 1));
    assert!(folder.path().join("003-pulses.interrupted-1.mcap").exists());
}

/// 17 mm from zero: the way back ends at the soft limit at 10 mm, a little before the 10 mm of the jog.
#[test]
fn a_jog_that_a_soft_limit_ends_is_cut() {
    let folder = tempfile::tempdir().unwrap();
    let steps: Vec<Step> = plan(&asked(), 0.017, 1).into_iter().take(2).collect();
    let (mut hand, mut begun) = (Hand::default(), Vec::new());
    let switch = StopSwitch::default();
    let mut watch = Watch(&mut begun, None, switch.clone());
    let outcome = drive(&steps, &setting(folder.path()), &mut rig(), &switch, &mut hand, &mut watch, &mut |_, _| {
        Known::default()
    })
    .unwrap();
    assert_eq!((outcome.driven, outcome.cut.len()), (2, 1), "{:?}", outcome.cut);
    let told = &outcome.cut[0];
    assert!(told.starts_with("002-jog-backward was cut: the jog of -1 V went "), "{told}");
    assert!(told.contains(" mm of 10.0 mm: a soft limit or its 1 s ended it"), "{told}");
}

/// Somebody else stops the carriage in the middle of a tow: a stop that the board obeys from anybody, without a fault.
struct Stopped {
    rig: TwinRig,
    ticks: u32,
}

impl Rig for Stopped {
    fn tick(&mut self, request: Option<Request>) -> Result<Sample, RigError> {
        let sample = self.rig.tick(request)?;
        let is_towing = sample.axes[0].phase == Phase::Moving && sample.axes[0].reference_m_s > 0.19;
        self.ticks += u32::from(is_towing);
        if self.ticks == 8_000 {
            self.ticks += 1;
            return self.rig.tick(Some(Request::Stop(StopCategory::Two)));
        }
        Ok(sample)
    }
    fn rate_hz(&self) -> f64 {
        self.rig.rate_hz()
    }
    fn begin_run(&mut self, load: &Load, number: u64) {
        self.rig.begin_run(load, number);
    }

    fn begin_recording(&mut self) {
        self.rig.begin_recording();
    }
    fn version(&self) -> String {
        self.rig.version()
    }
}

#[test]
fn a_tow_that_somebody_else_stopped_is_not_complete() {
    let folder = tempfile::tempdir().unwrap();
    let steps = plan(&asked(), 1.5, 1);
    let mut driven = Stopped { rig: rig(), ticks: 0 };
    let (mut hand, mut begun) = (Hand::default(), Vec::new());
    let switch = StopSwitch::default();
    let mut watch = Watch(&mut begun, None, switch.clone());
    let error = drive(&steps, &setting(folder.path()), &mut driven, &switch, &mut hand, &mut watch, &mut |_, _| {
        Known::default()
    })
    .unwrap_err();
    let RunnerError::Elsewhere { run, target_m, at_m } = &error else { panic!("{error}") };
    assert!((target_m - at_m).abs() > 0.01, "{error}");
    if let Ok(log) = read_run(&folder.path().join(format!("{run}.mcap"))) {
        assert_eq!(log.meta.status, RunStatus::Interrupted);
    }
}
