//! Simulated logs of an axis with known parameters and a drive that holds its command, for twelve motions: how many have intervals, and how many of these contain the truth.

use std::f64::consts::TAU;

use froude_carriage::servo::{Chain, Friction, ServoError, ServoLog, ServoReport, identify_servo};
use froude_records::run::stamps::even_times;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use crate::rigid::Rigid;

const AXIS: Rigid =
    Rigid { mass_kg: 1.2, viscous_n_s_m: [0.35; 2], coulomb_n: [0.8; 2], offset_n: 0.0, force_per_volt_n_v: 6.0 };
/// Correlation time of what disturbs the axis.
const CORRELATION_S: f64 = 0.3;

/// What differs from rig to rig.
#[derive(Debug, Clone, Copy)]
struct Rig {
    rate_hz: f64,
    length_s: f64,
    /// A count of the encoder.
    count_m: f64,
    /// Standard deviation of what disturbs the axis.
    disturbed_n: f64,
}

const RIG: Rig = Rig { rate_hz: 1000.0, length_s: 20.0, count_m: 1e-5, disturbed_n: 0.02 };

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
fn log(motion: &Motion, rig: Rig, seed: u64) -> ServoLog {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let step_s = 1.0 / rig.rate_hz;
    // A loop with a low sample rate needs smaller gains to be stable.
    let slow = (rig.rate_hz / 500.0).min(1.0);
    let within: f64 = rng.random_range(0.0..1.0);
    let decay = (-step_s / CORRELATION_S).exp();
    let mut disturbance = rig.disturbed_n * {
        let z: f64 = StandardNormal.sample(&mut rng);
        z
    };
    let mut state = [0.0, 0.0];
    let mut before = [0.0; 2];
    let mut out = ServoLog::default();
    for k in 0..(rig.length_s * rig.rate_hz) as usize {
        let t = k as f64 * step_s;
        let position = ((state[0] / rig.count_m + within).floor()) * rig.count_m;
        let command = match motion {
            Motion::Open(command) => command(t),
            Motion::Closed(reference) => {
                let [x, v] = reference(t);
                let speed = (position - before[1]) / (2.0 * step_s);
                (40.0 * slow * slow * (x - position) + 6.0 * slow * (v - speed)).clamp(-10.0, 10.0)
            }
        };
        before = [position, before[0]];
        out.time_s.push(t);
        out.position_m.push(position);
        out.command_v.push(command);
        let axis = Rigid { offset_n: -disturbance, ..AXIS };
        state = axis.after(state, command, step_s);
        let z: f64 = StandardNormal.sample(&mut rng);
        disturbance = decay * disturbance + (1.0 - decay * decay).sqrt() * rig.disturbed_n * z;
    }
    out
}

fn report(motion: &Motion, rig: Rig, seed: u64) -> Result<ServoReport, ServoError> {
    identify_servo(&log(motion, rig, seed), &Chain::of_log(AXIS.force_per_volt_n_v, rig.rate_hz, Friction::symmetric()))
}

const TRUTHS: [(&str, f64); 3] = [("M", 1.2), ("F_v", 0.35), ("F_c", 0.8)];

/// Reports of each motion, seed by seed.
fn reports(rig: Rig, seeds: u64) -> Vec<Vec<Result<ServoReport, ServoError>>> {
    let of = |(_, motion): &(&str, Motion)| (0..seeds).into_par_iter().map(|seed| report(motion, rig, seed)).collect();
    MOTIONS.iter().map(of).collect()
}

/// Number of reports with an interval for the coefficient, and number of these intervals that contain the truth.
fn counts(found: &[Result<ServoReport, ServoError>], (coefficient, truth): (&str, f64)) -> [usize; 2] {
    let intervals: Vec<[f64; 2]> = (found.iter().flatten())
        .filter_map(|r| Some(r.fit.coefficient(coefficient)?.interval))
        .filter(|interval| interval[0].is_finite())
        .collect();
    [intervals.len(), intervals.iter().filter(|[low, high]| (*low..=*high).contains(&truth)).count()]
}

/// For each coefficient, at least 80 % of the logs have an interval, and at least 90 % of these contain the truth (three quarters for each motion). The other logs name the motion that is needed.
#[test]
fn most_motions_get_intervals_and_these_hold() {
    let seeds = 40;
    let all = reports(RIG, seeds);
    for truth in TRUTHS {
        let (mut given, mut held) = (0, 0);
        for ((name, _), found) in MOTIONS.iter().zip(&all) {
            let [n, holds] = counts(found, truth);
            assert!(4 * holds >= 3 * n, "{name}, {}: {holds} of {n}", truth.0);
            (given, held) = (given + n, held + holds);
        }
        let logs = MOTIONS.len() * seeds as usize;
        let words = format!("{}: {held} of {given} in {logs} logs", truth.0);
        assert!(10 * given >= 8 * logs && 10 * held >= 9 * given, "{words}");
        println!("{words}");
    }
    for ((name, _), found) in MOTIONS.iter().zip(&all) {
        for (seed, report) in found.iter().enumerate() {
            let said = report.as_ref().map_or_else(ToString::to_string, |r| r.fit.excitation.join("; "));
            let is_told = report.as_ref().is_ok_and(|r| r.fit.coefficients.iter().all(|c| c.interval[0].is_finite()));
            assert_eq!(is_told, said.is_empty(), "{name}, seed {seed}: {said}");
            assert!(is_told || said.contains("move") || said.contains("motion"), "{name}, seed {seed}: {said}");
        }
    }
}

/// Disturbances of up to a quarter of the friction, logs of minutes, coarse encoders, drives of 60 Hz to 4 kHz: for each coefficient, at least 85 % of the intervals on each rig contain the truth, and at least 90 % over all rigs.
#[test]
fn intervals_hold_on_rigs_of_other_rates_and_disturbances() {
    let rigs = [
        Rig { disturbed_n: 0.1, ..RIG },
        Rig { disturbed_n: 0.2, ..RIG },
        Rig { length_s: 200.0, ..RIG },
        Rig { rate_hz: 500.0, length_s: 100.0, disturbed_n: 0.1, ..RIG },
        Rig { count_m: 1e-4, ..RIG },
        Rig { rate_hz: 4000.0, ..RIG },
        Rig { rate_hz: 4000.0, count_m: 1e-4, ..RIG },
        Rig { rate_hz: 200.0, ..RIG },
        Rig { rate_hz: 100.0, ..RIG },
        Rig { rate_hz: 60.0, ..RIG },
    ];
    let mut sums = [[0; 2]; 3];
    for rig in rigs {
        let all = reports(rig, if rig.length_s > RIG.length_s { 4 } else { 12 });
        for (truth, sum) in TRUTHS.into_iter().zip(&mut sums) {
            let of_motions = all.iter().map(|found| counts(found, truth));
            let [given, held] = of_motions.fold([0, 0], |[a, b], [n, holds]| [a + n, b + holds]);
            println!("{rig:?}, {}: {held} of {given}", truth.0);
            assert!(given > 0 && 100 * held >= 85 * given, "{rig:?}, {}: {held} of {given}", truth.0);
            *sum = [sum[0] + given, sum[1] + held];
        }
    }
    for ((name, _), [given, held]) in TRUTHS.into_iter().zip(sums) {
        assert!(10 * held >= 9 * given, "{name}: {held} of {given}");
        println!("{name}: {held} of {given}");
    }
}

/// A drive of 60 samples a second: sines of 0.5 and 1 Hz determine all coefficients, one of 2 Hz the mass alone.
#[test]
fn a_slow_drive_determines_friction_in_slow_motions() {
    let rig = Rig { rate_hz: 60.0, disturbed_n: 0.0, ..RIG };
    let sines: [(Motion, usize); 3] = [
        (Motion::Open(|t| 0.8 * (TAU * 0.5 * t).sin()), 3),
        (Motion::Open(|t| 0.8 * (TAU * t).sin()), 3),
        (Motion::Open(|t| 0.8 * (TAU * 2.0 * t).sin()), 1),
    ];
    for (motion, told) in sines {
        let found = [report(&motion, rig, 1)];
        let told_of = TRUTHS.map(|truth| counts(&found, truth));
        assert_eq!(told_of.iter().map(|[given, _]| given).sum::<usize>(), told, "{told_of:?}");
        assert!(told_of.iter().all(|[given, held]| given == held), "{:?}", found[0].as_ref().unwrap().fit.coefficients);
    }
}

/// What is done to the stamps and rows of a log.
type Degraded = fn(ServoLog, &mut Pcg64Mcg) -> ServoLog;

/// Stamps in whole milliseconds, and 3 % of the rows lost.
fn lost(log: ServoLog, rng: &mut Pcg64Mcg) -> ServoLog {
    let keep: Vec<usize> = (0..log.time_s.len()).filter(|_| rng.random::<f64>() >= 0.03).collect();
    let of = |column: &[f64]| keep.iter().map(|i| column[*i]).collect::<Vec<f64>>();
    let stamps: Vec<f64> = of(&log.time_s).iter().map(|t| (1e3 * t).round() / 1e3).collect();
    let time_s = even_times(&stamps, 1e-3).expect("rounded stamps of an even rate").times_s();
    ServoLog { time_s, position_m: of(&log.position_m), command_v: of(&log.command_v) }
}

/// Two seconds missing.
fn cut(log: ServoLog, _: &mut Pcg64Mcg) -> ServoLog {
    let keep: Vec<usize> = (0..log.time_s.len()).filter(|i| !(8.0..10.0).contains(&log.time_s[*i])).collect();
    let of = |column: &[f64]| keep.iter().map(|i| column[*i]).collect::<Vec<f64>>();
    ServoLog { time_s: of(&log.time_s), position_m: of(&log.position_m), command_v: of(&log.command_v) }
}

/// Coefficients agree with those of the clean log within both intervals, and each interval holds the truth as often as that of the clean log, less 2.3 standard
/// deviations of 200.
#[test]
fn rounded_stamps_lost_samples_and_gaps_leave_the_coefficients_and_their_coverage() {
    let motions =
        [MOTIONS.iter().find(|(name, _)| *name == "a chirp"), MOTIONS.iter().find(|(name, _)| *name == "three sines")];
    let seeds = 200_u64;
    for rate_hz in [60.0, 200.0] {
        let rig = Rig { rate_hz, disturbed_n: 0.05, ..RIG };
        for (name, motion) in motions.into_iter().flatten() {
            let chain = Chain::of_log(AXIS.force_per_volt_n_v, rate_hz, Friction::symmetric());
            let of = |degraded: Option<Degraded>| -> Vec<_> {
                let one = |seed: u64| {
                    let mut rng = Pcg64Mcg::seed_from_u64(seed ^ 0x10_57);
                    let log = log(motion, rig, seed);
                    identify_servo(
                        &degraded.map_or_else(|| log.clone(), |degraded| degraded(log.clone(), &mut rng)),
                        &chain,
                    )
                };
                (0..seeds).into_par_iter().map(one).collect()
            };
            let clean = of(None);
            for (way, degraded) in [("lost", lost as Degraded), ("cut", cut)] {
                let found = of(Some(degraded));
                for truth in TRUTHS {
                    let ([given, held], [n, holds]) = (counts(&found, truth), counts(&clean, truth));
                    println!("{rate_hz} Hz, {name}, {way}, {}: {held} of {given}; clean {holds} of {n}", truth.0);
                    assert!(10 * given >= 9 * n, "{rate_hz} Hz, {name}, {way}, {}: {given} of {n}", truth.0);
                    if given == 0 {
                        continue;
                    }
                    let (p, clean) = (held as f64 / given as f64, (holds as f64 / n as f64).min(0.95));
                    let scatter = (2.0 * clean * (1.0 - clean) / given as f64).sqrt();
                    assert!(p >= clean - 2.3 * scatter, "{rate_hz} Hz, {name}, {way}, {}: {held} of {given}", truth.0);
                }
                let alike = found.iter().flatten().zip(clean.iter().flatten()).filter(|(a, b)| {
                    let pairs = a.fit.coefficients.iter().zip(&b.fit.coefficients);
                    pairs.into_iter().all(|(a, b)| {
                        let [low, high] = a.interval;
                        !low.is_finite()
                            || !b.interval[0].is_finite()
                            || (low <= b.interval[1] && b.interval[0] <= high)
                    })
                });
                assert!(
                    alike.count() as u64 * 100 >= 99 * found.iter().flatten().count() as u64,
                    "{rate_hz} Hz, {name}, {way}"
                );
            }
        }
    }
}
