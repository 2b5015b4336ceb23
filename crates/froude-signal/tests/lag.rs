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
            [0.1 / omega, omega, rng.random_range(0.0..std::f64::consts::TAU)]
        })
        .collect();
    move |t, d| {
        parts
            .iter()
            .map(|[a, w, p]| a * w.powi(d) * (w * t + p + 0.5 * f64::from(d) * std::f64::consts::PI).sin())
            .sum()
    }
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
    let (mut held, mut wander, mut squares) = ([0; 2], 0, [0.0; 2]);
    for seed in 0..seeds {
        let found = of(&mut Pcg64Mcg::seed_from_u64(1000 + seed)).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        wander += usize::from(found.left_s > 0.0);
        for (held, is_in) in held.iter_mut().zip(contains(&found)) {
            *held += usize::from(is_in);
        }
        let lag = LAG_S + DRIFT * found.origin_s;
        squares[0] += ((found.lag_s - lag) / found.standard[0]).powi(2);
        squares[1] += ((found.drift - DRIFT) / found.standard[1]).powi(2);
    }
    // Neither too narrow nor too wide: the error over its standard uncertainty is 1, with a standard deviation of 1/√(2n) where that is known, and half of it is not.
    for square in squares {
        let (rms, n) = ((square / seeds as f64).sqrt(), seeds as f64);
        assert!((rms - 1.0).abs() < 3.0 * (1.0 / n).sqrt(), "{rms}");
    }
    println!("{held:?} of {seeds}, {wander} said to wander");
    assert!(100 * wander <= 5 * seeds as usize, "{wander} of {seeds} are said to wander");
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
    let phase = rng.random_range(0.0..std::f64::consts::TAU);
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
        let least = 0.95 - 3.0 * (0.95 * 0.05 / n as f64).sqrt();
        assert!(held.iter().all(|held| *held as f64 >= least * n as f64), "{held:?}");
    }
}

#[test]
fn what_does_not_tell_lag_and_drift_is_refused() {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let all = sines(&mut rng);
    let noise = [2e-3, 0.1];
    let mut twice =
        |motion: &dyn Fn(f64) -> f64, other: &dyn Fn(f64) -> f64, stamp: &dyn Fn(f64) -> f64, known: &Known| {
            let a = log(motion, [0.0, 40.0], 50.0, &|t| t, noise, &mut rng);
            let b = log(other, [1.0, 39.0], 83.0, stamp, noise, &mut rng);
            find(&a.record(), &b.record(), known)
        };
    let (free, motion) = (Known::default(), |t: f64| all(t, 0));
    let sine = |t: f64| 0.1 * (3.0 * t).sin();
    // One period is 2.09 s.
    let found = twice(&sine, &sine, &second, &free);
    assert!(
        matches!(found, Err(LagError::Ambiguous { lag_s, other_s }) if ((lag_s - other_s).abs() / 2.0944).fract() < 0.03 || ((lag_s - other_s).abs() / 2.0944).fract() > 0.97),
        "{found:?}"
    );
    let found = twice(&sine, &sine, &second, &Known { lag_s: Some([0.3, 0.5]), ..free });
    assert!(found.is_ok_and(|lag| contains(&lag)[0]));
    let other = sines(&mut Pcg64Mcg::seed_from_u64(8));
    let found = twice(&motion, &|t| other(t, 0), &second, &free);
    assert!(
        matches!(found, Err(LagError::NotAlike { .. } | LagError::Ambiguous { .. } | LagError::Undetermined)),
        "{found:?}"
    );
    let found = twice(&motion, &|t| -all(t, 0), &second, &free);
    assert!(matches!(found, Err(LagError::Opposite { correlation }) if correlation > 0.9), "{found:?}");
    let found = twice(&motion, &motion, &|t| second(t) + if t > 22.0 { 0.15 } else { 0.0 }, &free);
    assert!(
        // It is found between two of twelve windows of 3.2 s, and the one that it lies in takes up to a third of it.
        matches!(found, Err(LagError::Jump { jump_s, time_s }) if (jump_s - 0.15).abs() < 0.05 && (time_s - 22.0).abs() < 3.2),
        "{found:?}"
    );
    let found = twice(&motion, &motion, &|t| t + 0.25 * (0.3 * t).sin(), &free);
    assert!(matches!(found, Err(LagError::NotLinear { .. } | LagError::Jump { .. })), "{found:?}");
    let found = twice(&motion, &motion, &second, &Known { lag_s: Some([0.8, 0.3]), ..free });
    assert!(found.is_err(), "{found:?}");
    // One trigger: a lag, and no drift until it is declared.
    let trigger = |t: f64| if (20.0..20.4).contains(&t) { 5.0 } else { 0.0 };
    let found = twice(&trigger, &trigger, &second, &free);
    assert!(matches!(found, Err(LagError::DriftOpen { .. })), "{found:?}");
    let found = twice(&trigger, &trigger, &second, &Known { drift: Some([0.0, 1e-4]), ..free }).unwrap();
    assert!((found.lag_s - LAG_S - DRIFT * found.origin_s).abs() < 1.96 * found.standard[0], "{found:?}");
    // Both clocks' rounding: (20 ms ⊕ 12 ms)/√12.
    assert!((found.standard[0] - 6.7e-3).abs() < 0.5e-3 && found.standard[1] == 1e-4, "{found:?}");
    let found = twice(&|t| 0.3 * t, &|t| 0.3 * t, &second, &free);
    assert!(
        matches!(found, Err(LagError::Undetermined | LagError::DriftOpen { .. } | LagError::Ambiguous { .. })),
        "{found:?}"
    );
}

/// Two quartz clocks are declared to drift by 0 ± 50 ppm, and drift by 20: no clock was set. By 400 ppm the declaration is wrong.
#[test]
fn a_declared_drift_holds_within_its_uncertainty() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let all = sines(&mut rng);
    let mut of = |drift: f64| {
        let stamp = |t: f64| (t + LAG_S) / (1.0 - drift);
        let a = log(&|t| all(t, 0), [0.0, 1000.0], 20.0, &|t| t, [1e-4, 0.0], &mut rng);
        let b = log(&|t| all(t, 0), [1.0, 990.0], 25.0, &stamp, [1e-4, 0.0], &mut rng);
        find(&a.record(), &b.record(), &Known { drift: Some([0.0, 50e-6]), ..Known::default() })
    };
    let found = of(20e-6).unwrap();
    let lag = LAG_S + 20e-6 * found.origin_s;
    assert!((found.lag_s - lag).abs() < 4.0 * found.standard[0] && found.standard[1] < 1e-6, "{found:?}");
    assert!((found.drift - 20e-6).abs() < 4.0 * found.standard[1], "{found:?}");
    let wrong = of(400e-6);
    assert!(
        matches!(wrong, Err(LagError::DriftContradicted { found, .. }) if (found - 400e-6).abs() < 20e-6),
        "{wrong:?}"
    );
}

/// A tow: a ramp of position beside the acceleration that it has, with the wobble of its drive.
#[test]
fn the_position_of_a_tow_is_compared_with_its_acceleration() {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    let all = sines(&mut rng);
    let a = log(&|t| 0.5 * t + 0.2 * all(t, 0), [0.0, 60.0], 60.0, &|t| t, [1e-4, 0.0], &mut rng);
    let b = log(&|t| 0.2 * all(t, 2), [1.0, 58.0], 100.0, &second, [1e-3, 0.0], &mut rng);
    let found = find(&a.record(), &b.record(), &Known { derivative: 2, ..Known::default() }).unwrap();
    assert!((found.lag_s - LAG_S - DRIFT * found.origin_s).abs() < 3.0 * found.standard[0], "{found:?}");
    assert!(found.standard[0] < 1e-3, "{found:?}");
}

/// Ten samples a period are no trigger, and a pause of four months takes no memory.
#[test]
fn a_coarse_record_is_known_by_its_motion_and_a_long_pause_is_passed_over() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let sine = |t: f64| (std::f64::consts::TAU * t).sin() + 0.3 * (4.1 * t).sin();
    // Splines of so few samples err by 14 µs, which the interval does not have.
    let [a, b] = [0.0, 0.03].map(|from| log(&sine, [from, 60.0], 10.0, &|t| t, [1e-3, 0.0], &mut rng));
    let found = find(&a.record(), &b.record(), &Known { lag_s: Some([0.0, 0.2]), ..Known::default() }).unwrap();
    assert!(found.standard[0] < 1e-3 && found.lag_s.abs() < 4.0 * found.standard[0], "{found:?}");

    let mut paused = log(&sine, [0.0, 120.0], 100.0, &|t| if t < 60.0 { t } else { t + 1e7 }, [1e-4, 0.0], &mut rng);
    paused.step_s = 0.01;
    let (before, after) = (paused.time_s[5999], paused.time_s[6000]);
    let gaps = [[before, after]];
    let record = Record { gaps_s: &gaps, ..paused.record() };
    let found = find(&record, &record, &Known { lag_s: Some([0.0, 0.2]), ..Known::default() });
    assert!(found.is_err() || found.is_ok_and(|lag| lag.lag_s.abs() < 1e-3));
}

/// The camera of the NTNU section beside its accelerometers: skews by the preparer of the data from sliding fits, ± 1.5 ms/s, and a run whose clocks are not aligned by a line.
#[test]
fn the_clocks_of_the_ntnu_section_come_out() {
    let read = |name: &str| -> Vec<f64> {
        let line = include_str!("golden/ntnu_clocks.txt").lines().find_map(|line| line.strip_prefix(name)).unwrap();
        line.split_whitespace().map(|x| x.parse().unwrap()).collect()
    };
    // Periods of 1.210, 1.074 and 0.802 s: waves repeat, so that the lag is known beforehand to less than half of one.
    for (run, skew) in [("6041_1", Some(-7.3e-3)), ("6081_1", Some(8.5e-3)), ("6111_1", None)] {
        let [camera, acceleration] = ["camera", "acceleration"].map(|name| read(&format!("{name}_{run} ")));
        let time_s: Vec<f64> = (0..camera.len()).map(|i| 0.04 * i as f64).collect();
        let record = |values| Record { time_s: &time_s, values, step_s: 0.04, gaps_s: &[] };
        let known = Known { lag_s: Some([0.0, 0.4]), drift: None, derivative: 2 };
        let found = find(&record(camera.as_slice()), &record(acceleration.as_slice()), &known);
        match skew {
            // The lead of the camera grows as its clock's gain: as the accelerometers' clock loses.
            Some(skew) => {
                let found = found.unwrap();
                assert!((found.drift - skew).abs() < 1.5e-3 && found.standard[1] < 0.75e-3, "{run}: {found:?}");
            }
            // Its lags leave a line by 34 ms, 15° of a period: refused, or known to no better than some of that.
            None => assert!(found.is_err() || found.is_ok_and(|lag| 1.96 * lag.standard_s() > 20e-3), "{run}"),
        }
    }
}
