//! A vehicle of which thrust and speed are logged, the speed late: mass, drag and lag, over seeds.

use froude_carriage::servo::load::Load;
use froude_carriage::servo::{Chain, Friction, SpeedLog, identify_speeds};
use froude_identify::formula::Formula;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// A vehicle and its log.
#[derive(Debug, Clone, Copy)]
struct Vehicle {
    /// Mass, kg; drag, N s/m and N s²/m²; lag, s: a delay and a filter's time constant.
    truths: [f64; 4],
    /// What of the lag is the filter's.
    filter_s: f64,
    /// Standard deviation of the measured speed, m/s.
    noise_m_s: f64,
    /// Standard deviation of a disturbance of the force, N, and the time in which it falls to 1/e, s.
    disturbed: [f64; 2],
    rate_hz: f64,
    length_s: f64,
    /// Frequencies of the thrust, Hz; none for ramps of 6 s between levels.
    tones_hz: &'static [f64],
    /// Gain of a loop that holds the speed to a tenth of a metre a second for each 10 N of the levels, N s/m; 0 without.
    gain: f64,
}

const NAMES: [&str; 4] = ["M", "F_v", "D_II", "delay"];
const RAMP_S: f64 = 6.0;
/// Step of the simulation, s.
const STEP_S: f64 = 0.001;

/// Of a vehicle that is driven by hand, at the rate of a Doppler log.
const BY_HAND: Vehicle = Vehicle {
    truths: [95.0, 31.0, 200.0, 0.30],
    filter_s: 0.0,
    noise_m_s: 0.004,
    disturbed: [0.3, 1.0],
    rate_hz: 10.0,
    length_s: 180.0,
    tones_hz: &[],
    gain: 0.0,
};

/// Steps of a millisecond with the thrust of their middle.
fn log(vehicle: Vehicle, seed: u64) -> SpeedLog {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let ramps = (vehicle.length_s / RAMP_S) as usize + 2;
    let levels: Vec<f64> = (0..ramps).map(|_| [0.0, 12.0, 25.0, 40.0, -20.0, 30.0][rng.random_range(0..6)]).collect();
    let mut normal = move || -> f64 { StandardNormal.sample(&mut rng) };
    let thrust = |t: f64| {
        let (k, part) = ((t.max(0.0) / RAMP_S) as usize, (t.max(0.0) / RAMP_S).fract());
        let ramp = (1.0 - part) * levels[k] + part * levels[k + 1];
        let tone = |(k, hz): (usize, &f64)| 40.0 / 1.5 * (std::f64::consts::TAU * hz * t + k as f64).sin();
        if vehicle.tones_hz.is_empty() { ramp } else { vehicle.tones_hz.iter().enumerate().map(tone).sum() }
    };
    let [mass, f_v, d, lag_s] = vehicle.truths;
    let [disturbed_n, time_s] = vehicle.disturbed;
    let lag_s = lag_s - vehicle.filter_s;
    let (mut v, mut filtered, mut disturbance) = (0.0_f64, 0.0, 0.0);
    let steps = (1.0 / (vehicle.rate_hz * STEP_S)).round() as u32;
    let decay = (-1.0 / (vehicle.rate_hz * time_s)).exp();
    let mut out = SpeedLog::default();
    for i in 0..(vehicle.length_s * vehicle.rate_hz) as u32 {
        let t = f64::from(i) / vehicle.rate_hz;
        out.time_s.push(t);
        out.speed.push(filtered + vehicle.noise_m_s * normal());
        let in_loop = vehicle.gain * (0.01 * thrust(t) - out.speed[i as usize]);
        out.command_v.push(if vehicle.gain > 0.0 { in_loop } else { thrust(t) + 0.05 * normal() });
        disturbance = decay * disturbance + (1.0 - decay * decay).sqrt() * disturbed_n * normal();
        for k in 0..steps {
            let now = t + (f64::from(k) + 0.5) * STEP_S - lag_s;
            let force = if vehicle.gain > 0.0 { command(&out, vehicle.rate_hz, now) } else { thrust(now) };
            v += STEP_S * (force + disturbance - f_v * v - d * v * v.abs()) / mass;
            filtered = if vehicle.filter_s > 0.0 { filtered + STEP_S * (v - filtered) / vehicle.filter_s } else { v };
        }
    }
    out
}

/// The logged command at a time before its last stamp, by straight lines.
fn command(log: &SpeedLog, rate_hz: f64, t: f64) -> f64 {
    let at = (t * rate_hz).max(0.0);
    let k = (at as usize).min(log.command_v.len() - 1);
    let next = log.command_v[(k + 1).min(log.command_v.len() - 1)];
    log.command_v[k] + at.fract() * (next - log.command_v[k])
}

/// How many intervals of the coefficients hold the truth, of how many seeds, and the median half-widths.
fn covered(vehicle: Vehicle, logs: u64, seeds: u64) -> [(u64, f64); 4] {
    let speed = |name: &str| (name == "v_y").then_some([1, 0, -1, 0, 0]);
    let drag = Formula::parse("drive", "D_II*v_y*abs(v_y)", &speed, [1, 1, -2, 0, 0], &[]).unwrap();
    let load = Load { terms: vec![(drag, vec!["kg/m".to_owned()])], known: None };
    let friction = Friction { is_viscous: true, ..Friction::symmetric() };
    let chain = Chain { load, ..Chain::of_log(1.0, vehicle.rate_hz, friction) };
    let of = |seed: u64| {
        let logs: Vec<SpeedLog> = (0..logs).map(|k| log(vehicle, 1000 * k + seed)).collect();
        let report = identify_speeds(&logs, &chain, 0.0).unwrap();
        std::array::from_fn(|k| {
            let c = report.fit.coefficient(NAMES[k]).unwrap();
            let ([low, high], truth) = (c.interval, vehicle.truths[k]);
            (u64::from(low <= truth && truth <= high), 0.5 * (high - low))
        })
    };
    let all: Vec<[(u64, f64); 4]> = (0..seeds).into_par_iter().map(of).collect();
    std::array::from_fn(|k| {
        let mut widths: Vec<f64> = all.iter().map(|one| one[k].1).collect();
        widths.sort_by(f64::total_cmp);
        (all.iter().map(|one| one[k].0).sum(), widths[widths.len() / 2])
    })
}

/// 95 % of the intervals hold the truth, less two standard deviations of the count; none is wider than a careful person would accept. The first three vehicles, and all with
/// `FROUDE_SEEDS`.
#[test]
fn intervals_of_mass_drag_and_lag_hold() {
    let asked: Option<u64> = std::env::var("FROUDE_SEEDS").ok().and_then(|n| n.parse().ok());
    let (seeds, vehicles) = asked.map_or((20, 3), |seeds| (seeds, usize::MAX));
    let least = 0.95 - 2.0 * (0.95 * 0.05 / seeds as f64).sqrt();
    // The motion that a filter takes out; a drift that lasts; a fast log of a slow motion; three logs.
    let small = Vehicle { truths: [20.0, 15.0, 60.0, 0.30], noise_m_s: 0.0005, ..BY_HAND };
    for (words, vehicle, logs, widest) in [
        ("by hand", BY_HAND, 1, [0.05, 0.1, 0.05, 0.2]),
        ("half of the lag a filter's", Vehicle { filter_s: 0.15, ..BY_HAND }, 1, [0.1, 0.1, 0.05, 0.3]),
        ("tones of 0.8 and 1 Hz", Vehicle { tones_hz: &[0.8, 1.0, 0.03], ..small }, 1, [0.05, 0.2, 0.1, 0.1]),
        (
            "a disturbance of 5 s",
            Vehicle {
                truths: [20.0, 15.0, 60.0, 0.10],
                noise_m_s: 0.002,
                disturbed: [3.0, 5.0],
                rate_hz: 20.0,
                tones_hz: &[0.5, 0.8, 0.03],
                ..BY_HAND
            },
            1,
            [0.1, 0.5, 0.5, 0.3],
        ),
        (
            "1 cm/s at 50 Hz",
            Vehicle { noise_m_s: 0.01, rate_hz: 50.0, length_s: 90.0, ..BY_HAND },
            1,
            [0.15, 0.15, 0.1, 0.4],
        ),
        ("a loop on the speed", Vehicle { gain: 100.0, ..BY_HAND }, 1, [0.1, 0.2, 0.2, 0.3]),
        ("three logs of a minute", Vehicle { length_s: 60.0, ..BY_HAND }, 3, [0.3, 0.5, 0.3, 0.6]),
    ]
    .into_iter()
    .take(vehicles)
    {
        let found = covered(vehicle, logs, seeds);
        println!("{words}: {found:?} of {seeds}");
        for (((name, truth), (held, width)), widest) in NAMES.iter().zip(vehicle.truths).zip(found).zip(widest) {
            assert!(held as f64 >= least * seeds as f64, "{words}, {name}: {held} of {seeds}");
            assert!(width < widest * truth, "{words}, {name}: {width}");
        }
    }
}
