//! Lag and drift between two clocks: twins with known ones, coverage of the intervals, and what is refused.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

use froude_signal::lag::{Known, Lag, LagError, Record, find};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Samples of a motion by a clock of its own.
struct Log {
    time_s: Vec<f64>,
    values: Vec<f64>,
    step_s: f64,
}

/// A normal number, by Box and Muller.
fn normal(rng: &mut Pcg64Mcg) -> f64 {
    let [a, b] = [rng.random_range(1e-12..1.0_f64), rng.random_range(0.0..1.0_f64)];
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// `motion` from `from_s` to `to_s` of true time at a rate, stamped by `stamp`, with noise of a standard deviation that is correlated over `memory_s`.
fn log(
    motion: &dyn Fn(f64) -> f64,
    [from_s, to_s]: [f64; 2],
    rate_hz: f64,
    stamp: &dyn Fn(f64) -> f64,
    [noise, memory_s]: [f64; 2],
    rng: &mut Pcg64Mcg,
) -> Log {
    let keep = if memory_s > 0.0 { (-1.0 / (rate_hz * memory_s)).exp() } else { 0.0 };
    let fresh = (1.0 - keep * keep).sqrt();
    let mut error = normal(rng);
    let (mut time_s, mut values) = (Vec::new(), Vec::new());
    for i in 0..((to_s - from_s) * rate_hz) as usize {
        let t = from_s + i as f64 / rate_hz;
        time_s.push(stamp(t));
        values.push(motion(t) + noise * error);
        error = keep * error + fresh * normal(rng);
    }
    let step_s = (time_s[time_s.len() - 1] - time_s[0]) / (time_s.len() - 1) as f64;
    Log { time_s, values, step_s }
}

impl Log {
    fn record(&self) -> Record<'_> {
        Record { time_s: &self.time_s, values: &self.values, step_s: self.step_s, gaps_s: &[] }
    }
}

/// Some sines whose frequencies have nothing in common, and the second derivative of their sum.
fn sines(rng: &mut Pcg64Mcg) -> impl Fn(f64, i32) -> f64 + use<> {
    let parts: Vec<[f64; 3]> = (0..5)
        .map(|k| {
            let omega = 1.1 * 1.37_f64.powi(k) * rng.random_range(0.9..1.1);
            [0.1 / omega, omega, rng.random_range(0.0..6.28)]
        })
        .collect();
    move |t, d| parts.iter().map(|[a, w, p]| a * w.powi(d) * (w * t + p + 0.5 * f64::from(d) * std::f64::consts::PI).sin()).sum()
}

/// True lag and drift.
const LAG_S: f64 = 0.37;
const DRIFT: f64 = 50e-6;
/// A stamp of the second clock: t = s − lag − drift s.
fn second(t: f64) -> f64 {
    (t + LAG_S) / (1.0 - DRIFT)
}

/// Whether the 95 % intervals of lag (at its origin) and drift contain the truth.
fn contains(found: &Lag) -> [bool; 2] {
    let lag = LAG_S + DRIFT * found.origin_s;
    [(found.lag_s - lag).abs() <= 1.96 * found.standard[0], (found.drift - DRIFT).abs() <= 1.96 * found.standard[1]]
}

fn covered(seeds: u64, of: &dyn Fn(&mut Pcg64Mcg) -> Result<Lag, LagError>) -> [usize; 2] {
    let mut held = [0; 2];
    for seed in 0..seeds {
        let found = of(&mut Pcg64Mcg::seed_from_u64(1000 + seed)).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        for (held, is_in) in held.iter_mut().zip(contains(&found)) {
            *held += usize::from(is_in);
        }
    }
    println!("{held:?} of {seeds}");
    held
}

/// Position at 60 Hz and at 100 Hz, both with noise that is correlated over 0.2 s.
fn two_positions(rng: &mut Pcg64Mcg) -> Result<Lag, LagError> {
    let sines = sines(rng);
    let motion = |t: f64| sines(t, 0);
    let a = log(&motion, [0.0, 40.0], 60.0, &|t| t, [5e-3, 0.2], rng);
    let b = log(&motion, [-3.0, 35.0], 100.0, &second, [5e-3, 0.2], rng);
    find(&a.record(), &b.record(), &Known::default())
}

/// A camera's position at 60 Hz, and an accelerometer at 200 Hz.
fn position_and_acceleration(rng: &mut Pcg64Mcg) -> Result<Lag, LagError> {
    let sines = sines(rng);
    let a = log(&|t| sines(t, 0), [0.0, 40.0], 60.0, &|t| t, [1e-3, 0.0], rng);
    let b = log(&|t| sines(t, 2), [-3.0, 35.0], 200.0, &second, [0.05, 0.1], rng);
    find(&a.record(), &b.record(), &Known { derivative: 2, ..Known::default() })
}

/// A forced oscillation that begins and ends in both logs, of which the lag is declared to half a second.
fn oscillation(rng: &mut Pcg64Mcg) -> Result<Lag, LagError> {
    let phase = rng.random_range(0.0..6.28_f64);
    let motion = move |t: f64| {
        let ramp = ((t - 4.0) / 2.0).clamp(0.0, 1.0);
        0.2 * ramp * (3.9 * t + phase).sin()
    };
    let a = log(&motion, [0.0, 30.0], 50.0, &|t| t, [2e-3, 0.3], rng);
    let b = log(&motion, [0.5, 31.0], 83.0, &second, [2e-3, 0.3], rng);
    find(&a.record(), &b.record(), &Known { lag_s: Some([0.6, 0.5]), ..Known::default() })
}

/// 95 % of 60, less three standard deviations of the count.
#[test]
fn intervals_of_lag_and_drift_contain_the_truth() {
    let n: u64 = std::env::var("SEEDS").ok().and_then(|n| n.parse().ok()).unwrap_or(60);
    for of in [two_positions, position_and_acceleration, oscillation] {
        let held = covered(n, &of);
        assert!(held.iter().all(|held| *held as f64 >= 0.866 * n as f64), "{held:?}");
    }
}
