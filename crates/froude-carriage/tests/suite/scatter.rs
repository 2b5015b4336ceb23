//! The interval of D_d from a few pairs covers whatever makes the pairs differ.

use froude_carriage::drag::DragSetup;
use froude_carriage::drag::detectability::{DryMean, predict};
use froude_carriage::drag::differences::of_differences;
use froude_carriage::drag::point::Point;
use froude_fit::budget::Uncertain;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// D_d, N s²/m².
const TRUTH: f64 = 20.0;
/// Six speeds, both ways.
const SPEEDS: [f64; 6] = [0.05, 0.15, 0.25, 0.35, 0.45, 0.55];

/// What makes pairs differ, beside 0.07 N from run to run.
#[derive(Debug, Clone, Copy)]
struct Trouble {
    /// The mount repeats to this part of D_d from pair to pair.
    mount: f64,
    /// Flow left over in the wet half of a pair, N.
    wet_half_n: f64,
    /// Friction drifts over the campaign by ± this, wet and dry alike, N.
    drift_n: f64,
}

/// Whether the interval of one campaign holds the truth, and its half-width.
fn campaign(pairs: u32, trouble: Trouble, seed: u64) -> (bool, f64) {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    // Force per volt exact, one: what is tested is the scatter.
    let calibration = Some(Uncertain::new(1.0, 0.0));
    let setup = DragSetup {
        calibration,
        torque_constant_drift_relative: 0.0,
        speed_scale_relative: 0.0,
        ..DragSetup::of_the_paper()
    };
    let (mut points, mut dry) = (Vec::new(), Vec::new());
    for pair in 0..pairs {
        let (mount, flow_n) = (1.0 + trouble.mount * normal(), trouble.wet_half_n * normal());
        let drift_n = trouble.drift_n * (2.0 * f64::from(pair) / f64::from(pairs - 1) - 1.0);
        for velocity_m_s in SPEEDS.iter().flat_map(|v| [*v, -v]) {
            let friction_n = [0, 1].map(|_| 3.0 + drift_n + 0.07 * normal());
            dry.push(DryMean { velocity_m_s, pair, resistance_v: friction_n[0] });
            let drag_n = mount * TRUTH * velocity_m_s * velocity_m_s + flow_n;
            points.push(Point {
                run: String::new(),
                speed_m_s: velocity_m_s,
                force_n: velocity_m_s.signum() * (drag_n + friction_n[1] - friction_n[0]),
                standard_n: 0.02,
                effective_n: 10.0,
                pair,
                position_m: [1.0, 2.0],
                trend_n: None,
            });
        }
    }
    let promised = predict(&dry, 2 * pairs as usize, pairs as usize, &setup);
    let c = of_differences(points, promised.as_ref(), &setup).unwrap().unwrap();
    let [low, high] = c.interval_95.unwrap();
    ((low..=high).contains(&TRUTH), 0.5 * (high - low))
}

/// 2,000 campaigns a case: the binomial standard deviation at 95 % is 0.5 %. Three of them below: 93 % (the jackknife of unequal pairs is a
/// little small); above 98.5 %, because where nothing is wrong the larger of two estimates of one scatter is taken (simulated: 97.6 %).
#[test]
fn intervals_cover_whether_mounts_repeat_or_not() {
    let none = Trouble { mount: 0.0, wet_half_n: 0.0, drift_n: 0.0 };
    let cases = [
        (5, none),
        (3, none),
        (5, Trouble { mount: 0.01, ..none }),
        (5, Trouble { mount: 0.02, ..none }),
        (3, Trouble { mount: 0.02, ..none }),
        (5, Trouble { wet_half_n: 0.07, ..none }),
        (5, Trouble { drift_n: 0.2, ..none }),
    ];
    for (pairs, trouble) in cases {
        let all: Vec<(bool, f64)> = (0..2000).map(|seed| campaign(pairs, trouble, seed)).collect();
        let rate = all.iter().filter(|c| c.0).count() as f64 / 2000.0;
        assert!((0.93..=0.985).contains(&rate), "{pairs} pairs, {trouble:?}: {rate}");
    }
}

/// Friction that drifts alike wet and dry cancels in the difference and must not widen the interval.
#[test]
fn a_drift_that_cancels_costs_nothing() {
    let width = |drift_n: f64| {
        let trouble = Trouble { mount: 0.0, wet_half_n: 0.0, drift_n };
        (0..200).map(|seed| campaign(5, trouble, seed).1).sum::<f64>() / 200.0
    };
    let (still, drifting) = (width(0.0), width(0.2));
    assert!((drifting / still - 1.0).abs() < 0.02, "{still} {drifting}");
}
