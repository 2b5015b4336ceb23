//! Simulated logs of an axis with known parameters and a drive that holds its command, for twelve motions: how many have intervals, and how many of these contain the truth.

use std::f64::consts::TAU;

use froude_carriage::servo::simulate::Rigid;
use froude_carriage::servo::{Chain, Friction, ServoError, ServoLog, ServoReport, identify_servo};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

const AXIS: Rigid =
    Rigid { mass_kg: 1.2, viscous_n_s_m: [0.35; 2], coulomb_n: [0.8; 2], offset_n: 0.0, force_per_volt_n_v: 6.0 };
const RATE_HZ: f64 = 1000.0;
const LENGTH_S: f64 = 20.0;
/// A count of the encoder, m.
const COUNT_M: f64 = 1e-5;
/// What disturbs the axis: standard deviation and correlation time.
const DISTURBED_N: f64 = 0.02;
const CORRELATION_S: f64 = 0.3;

/// A motion: a command, or a reference with its speed for a loop.
enum Motion {
    Open(fn(f64) -> f64),
    Closed(fn(f64) -> [f64; 2]),
}

/// There and back between rest at both ends.
fn trapezoids(t: f64, [speed, acceleration, way, rest]: [f64; 4]) -> [f64; 2] {
    let rise = speed / acceleration;
    let flat = way / speed - rise;
    let moving = 2.0 * rise + flat;
    let half = moving + rest;
    let (s, is_back) = (t.rem_euclid(half), t.rem_euclid(2.0 * half) >= half);
    let [x, v] = if s < rise {
        [0.5 * acceleration * s * s, acceleration * s]
    } else if s < rise + flat {
        [0.5 * acceleration * rise * rise + speed * (s - rise), speed]
    } else if s < moving {
        let left = moving - s;
        [way - 0.5 * acceleration * left * left, acceleration * left]
    } else {
        [way, 0.0]
    };
    if is_back { [way - x, -v] } else { [x, v] }
}

fn sign(t: f64, half_s: f64) -> f64 {
    if t.rem_euclid(2.0 * half_s) < half_s { 1.0 } else { -1.0 }
}

fn sines(t: f64, parts: &[(f64, f64)]) -> [f64; 2] {
    let x = parts.iter().map(|(a, w)| a * (w * t).sin()).sum();
    [x, parts.iter().map(|(a, w)| a * w * (w * t).cos()).sum()]
}

const MOTIONS: [(&str, Motion); 12] = [
    ("pulses", Motion::Open(|t| if t.rem_euclid(1.0) < 0.25 { 0.6 * sign(t, 1.0) } else { 0.0 })),
    ("long pulses", Motion::Open(|t| if t.rem_euclid(2.0) < 0.6 { 0.3 * sign(t, 2.0) } else { 0.0 })),
    (
        "pulses that brake",
        Motion::Open(|t| {
            let s = t.rem_euclid(1.0);
            sign(t, 1.0)
                * if s < 0.2 {
                    0.8
                } else if s < 0.3 {
                    -0.5
                } else {
                    0.0
                }
        }),
    ),
    ("a chirp", Motion::Open(|t| 0.8 * (TAU * (0.5 * t + 0.1125 * t * t)).sin())),
    ("a sine", Motion::Closed(|t| sines(t, &[(0.2, 0.5 * TAU)]))),
    ("three sines", Motion::Closed(|t| sines(t, &[(0.15, 1.3), (0.08, 3.1), (0.03, 7.7)]))),
    ("trapezoids", Motion::Closed(|t| trapezoids(t, [0.3, 1.0, 0.5, 0.5]))),
    ("fast trapezoids", Motion::Closed(|t| trapezoids(t, [0.8, 3.0, 0.8, 0.3]))),
    ("slow trapezoids", Motion::Closed(|t| trapezoids(t, [0.05, 0.5, 0.1, 1.0]))),
    ("steps", Motion::Closed(|t| [if t.rem_euclid(2.0) < 1.0 { 0.1 } else { 0.0 }, 0.0])),
    ("one speed both ways", Motion::Closed(|t| trapezoids(t, [0.2, 20.0, 0.4, 0.0]))),
    ("a creep", Motion::Closed(|t| trapezoids(t, [0.01, 0.1, 0.02, 0.5]))),
];

/// What a rig records of a motion.
fn log(motion: &Motion, seed: u64) -> ServoLog {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let step_s = 1.0 / RATE_HZ;
    let within: f64 = rng.random_range(0.0..1.0);
    let decay = (-step_s / CORRELATION_S).exp();
    let mut disturbance = DISTURBED_N * {
        let z: f64 = StandardNormal.sample(&mut rng);
        z
    };
    let mut state = [0.0, 0.0];
    let mut before = [0.0; 2];
    let mut out = ServoLog::default();
    for k in 0..(LENGTH_S * RATE_HZ) as usize {
        let t = k as f64 * step_s;
        let position = ((state[0] / COUNT_M + within).floor()) * COUNT_M;
        let command = match motion {
            Motion::Open(command) => command(t),
            Motion::Closed(reference) => {
                let [x, v] = reference(t);
                let speed = (position - before[1]) / (2.0 * step_s);
                (40.0 * (x - position) + 6.0 * (v - speed)).clamp(-10.0, 10.0)
            }
        };
        before = [position, before[0]];
        out.time_s.push(t);
        out.position_m.push(position);
        out.command_v.push(command);
        let axis = Rigid { offset_n: -disturbance, ..AXIS };
        state = axis.after(state, command, step_s);
        let z: f64 = StandardNormal.sample(&mut rng);
        disturbance = decay * disturbance + (1.0 - decay * decay).sqrt() * DISTURBED_N * z;
    }
    out
}

fn report(motion: &Motion, seed: u64) -> Result<ServoReport, ServoError> {
    identify_servo(&log(motion, seed), &Chain::of_log(AXIS.force_per_volt_n_v, RATE_HZ, Friction::symmetric()))
}

const SEEDS: u64 = 40;
const TRUTHS: [(&str, f64); 3] = [("M", 1.2), ("F_v", 0.35), ("F_c", 0.8)];

/// For each coefficient, at least 80 % of the logs have an interval, and at least 90 % of these contain the truth (three quarters for each motion). The other logs name the motion that is needed.
#[test]
fn most_motions_get_intervals_and_these_hold() {
    let (mut given, mut held) = ([0; 3], [0; 3]);
    for (name, motion) in &MOTIONS {
        let found: Vec<Result<ServoReport, ServoError>> =
            (0..SEEDS).into_par_iter().map(|seed| report(motion, seed)).collect();
        for (k, (coefficient, truth)) in TRUTHS.iter().enumerate() {
            let intervals: Vec<[f64; 2]> = (found.iter().flatten())
                .map(|r| r.coefficient(coefficient).unwrap().interval)
                .filter(|interval| interval[0].is_finite())
                .collect();
            let holds = intervals.iter().filter(|i| (i[0]..=i[1]).contains(truth)).count();
            assert!(4 * holds >= 3 * intervals.len(), "{name}, {coefficient}: {holds} of {}", intervals.len());
            given[k] += intervals.len();
            held[k] += holds;
        }
        for (seed, report) in found.iter().enumerate() {
            let said = report.as_ref().map_or_else(ToString::to_string, |r| r.excitation.join("; "));
            let is_told = report.as_ref().is_ok_and(|r| r.coefficients.iter().all(|c| c.interval[0].is_finite()));
            assert_eq!(is_told, said.is_empty(), "{name}, seed {seed}: {said}");
            assert!(is_told || said.contains("move") || said.contains("motion"), "{name}, seed {seed}: {said}");
        }
    }
    let logs = MOTIONS.len() * SEEDS as usize;
    for k in 0..3 {
        let words = format!("{}: {} of {} in {logs} logs", TRUTHS[k].0, held[k], given[k]);
        assert!(10 * given[k] >= 8 * logs && 10 * held[k] >= 9 * given[k], "{words}");
        println!("{words}");
    }
}
