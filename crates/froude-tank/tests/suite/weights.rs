//! The weight-driven rig on its twin: what a single run states of its speed and its drag.

use froude_identify::method::Method as _;
use froude_records::campaign_file::read_campaign;
use froude_records::run::{Declared, Role};
use froude_rig::weight_tow::{WeightRig, pull};
use froude_tank::observed::plan::exact;
use froude_tank::observed::spec::{Point, Run};
use froude_tank::observed::twin::Twin;
use froude_tank::steady::window::Told;
use froude_tank::weight_tow::reduce::reduce;
use froude_tank::weight_tow::{PULLED, WeightTow};
use indexmap::IndexMap;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

/// Drag of 0.113 N at 0.3 m/s, a third of it linear; 4 kg, 0.8 m, errors of 0.6 mm at 50 frames a second.
#[test]
fn the_drag_of_a_run_that_still_accelerates_has_the_error_that_it_states() {
    let drag = |v: f64| 0.113 * (v / 0.9 + 2.0 / 3.0 * (v / 0.3).powi(2));
    let spec = WeightTow {
        scale_m: None,
        lens: None,
        moving_mass_kg: Some(Declared::exact(4.0)),
        friction_n: Declared::exact(0.0),
        window_m: 0.2,
        tolerance: 0.02,
        reached: 0.4,
        travel_m: 0.8,
        still_s: 2.0,
        rate_hz: 50.0,
        has_angle_error: false,
        noise_m: None,
    };
    for weight_n in [0.025, 0.06, 0.113] {
        let rig = WeightRig {
            moving_mass_kg: 4.0,
            below_cell_kg: 3.0,
            weight_n,
            friction_n: 0.0,
            travel_m: 0.8,
            still_s: 2.0,
            rate_hz: 50.0,
        };
        let trace = pull(rig, &[], &drag, &|_| Vec::new(), &[], 1);
        let mut rng = Pcg64Mcg::seed_from_u64(5);
        let (mut square, mut sum, n) = (0.0, 0.0, 300);
        for _ in 0..n {
            let mut error = || -> f64 { 6e-4 * rng.sample::<f64, _>(StandardNormal) };
            let position_m: Vec<f64> = trace.position_m.iter().map(|x| x + error()).collect();
            let run = Run {
                point: Point {
                    id: "a".to_owned(),
                    role: Role::Test,
                    configuration: String::new(),
                    conditions: IndexMap::from([("weight", weight_n)]),
                },
                time_s: &trace.time_s,
                channels: vec![("position", &position_m)],
                told: Told::default(),
            };
            let (_, found) = reduce(&run, &spec).unwrap();
            let v = found.track.speed_m_s;
            let slope = (drag(v + 1e-4) - drag(v - 1e-4)) / 2e-4;
            let law = found.moves[3].loads_n[0];
            let standard = found.drag_standard_n.hypot(slope * found.track.standard_m_s).hypot(law);
            let z = (found.drag_n - drag(v)) / standard;
            square += z * z / f64::from(n);
            sum += z / f64::from(n);
        }
        // The mean square of 300 has a standard deviation of 0.08; the law is the same in all of them, and moves their mean.
        assert!((square - 1.0).abs() < 0.35 && sum.abs() < 0.5, "{weight_n}: {sum} {square}");
    }
}

/// A wagon that is pulled less accelerates less: an error of the friction moves the drag, F − m v̇, by less than itself, and by more than nothing. In each of the example's 78
/// runs; where the fit of the motion stops early, it does not.
#[test]
fn an_error_of_the_friction_moves_the_drag_by_less_than_itself() {
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/mamba-weights/campaign.toml");
    let campaign = read_campaign(std::path::Path::new(example)).unwrap();
    let twin = Twin::<WeightTow>::of(&campaign, &campaign.sources[0]).unwrap();
    let (_, reduced) = exact(&twin, &campaign.simulate.unwrap().sensors).unwrap();
    assert_eq!(reduced.len(), 78);
    for run in reduced {
        let along = run.point.condition("angle").cos() * twin.method.friction_n.standard_uncertainty;
        let part = run.moves[2].loads_n[0] / along;
        assert!(part > 0.0 && part < 1.0, "{}: {part}", run.point.id);
    }
}

/// A rig that logs positions in metres declares no scale; its twin logs a mark all the same, and is planned.
#[test]
fn a_rig_without_a_scale_is_planned() {
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/mamba-weights/campaign.toml");
    let text = std::fs::read_to_string(example).unwrap();
    let scale = text.lines().find(|line| line.starts_with("scale ")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("campaign.toml");
    std::fs::write(&path, text.replace(scale, "")).unwrap();
    let campaign = read_campaign(&path).unwrap();
    assert_eq!(PULLED.plan(&campaign, &campaign.sources[0]).unwrap().unwrap().runs, 78);
}

/// δf = −L δ e with e = (cos θ, −sin θ): what the finding and the book state, by the twin's own balance of one run at 30 deg whose body lies δ off.
#[test]
fn an_angle_that_errs_moves_a_balanced_run_by_the_load_across() {
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/mamba-weights/campaign.toml");
    let mut campaign = read_campaign(std::path::Path::new(example)).unwrap();
    let source = campaign.sources[0].clone();
    let twin = Twin::<WeightTow>::of(&campaign, &source).unwrap();
    let row = twin.points.iter().position(|p| (p.condition("angle") - 30_f64.to_radians()).abs() < 1e-9).unwrap();
    let point = twin.points[row].clone();
    let (theta, delta) = (point.condition("angle"), 0.01_f64);
    let mut turned = point.clone();
    turned.conditions.insert("angle", theta + delta);
    campaign.sources[0] = source.clone();
    let log = Twin::with(&campaign, &source, twin.method, vec![turned]).unwrap().exactly().remove(0);
    let as_turned = reduce(&log.view(), &twin.method).unwrap();
    let mut stated = log.view();
    stated.point = point;
    let as_stated = reduce(&stated, &twin.method).unwrap();
    let load = |of: &froude_tank::steady::point::Point, name: &str| {
        of.loads.iter().find(|load| load.name == name).unwrap().value
    };
    let [x, y] = ["f_x", "f_y"].map(|name| load(&as_turned.0, name));
    let across = x * theta.sin() + y * theta.cos();
    for (name, expected) in [("f_x", -across * delta * theta.cos()), ("f_y", across * delta * theta.sin())] {
        let moved = load(&as_stated.0, name) - load(&as_turned.0, name);
        // To first order in δ.
        assert!((moved / expected - 1.0).abs() < 3.0 * delta, "{name}: {moved} {expected}");
    }
}
