//! Steady tows: a carriage that comes up to speed, stays there and comes to rest, with a body on a load cell. The twin of that tank.
//!
//! The load follows that of the law at the present speed with the lag of its wake; the cell shows it with the inertia of what hangs below it,
//! f = f_D(v) lagged − M v̇ along x, with zero, drift, white and slow noise and resolution.
//!
//! **Setting.** Even acceleration; the wake's lag is one of first order. **Units.** SI.
//!
//! Not here: waves, a wake that comes back, a carriage whose speed ripples.

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use crate::noise::OrnsteinUhlenbeck;

/// Lag of the load behind the speed, s: some body heights at a tenth of a metre per second.
pub const WAKE_S: f64 = 0.2;
/// Body and added water below the cell, kg: what the cell shows of the ramps.
pub const INERTIA_KG: f64 = 3.0;

/// One tow: still, up to speed, steady, to rest, still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tow {
    /// At rest before and after, s.
    pub still_s: f64,
    /// Up to speed and to rest, m/s².
    pub acceleration_m_s2: f64,
    /// At constant speed, s.
    pub steady_s: f64,
    /// Samples a second.
    pub rate_hz: f64,
}

/// How one channel is read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reading {
    /// Standard deviation of its noise, white or slow.
    pub noise: f64,
    /// Time over which that is correlated, s; `None` for white noise.
    pub correlation_s: Option<f64>,
    /// Its step; 0 is none.
    pub step: f64,
    /// Its zero.
    pub zero: f64,
    /// Drift of that, per second.
    pub drift_per_s: f64,
    /// It shows so many times what is there.
    pub gain: f64,
}

/// A channel over time: a reading with its slow noise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Channel {
    reading: Reading,
    slow: Option<OrnsteinUhlenbeck>,
}

impl Channel {
    /// One for each reading.
    pub(crate) fn of(readings: &[Reading], step_s: f64, rng: &mut Pcg64Mcg) -> Vec<Self> {
        let slow = |r: &Reading, rng: &mut Pcg64Mcg| {
            r.correlation_s.map(|time| OrnsteinUhlenbeck::new(r.noise, time, step_s, rng))
        };
        readings.iter().map(|reading| Self { reading: *reading, slow: slow(reading, rng) }).collect()
    }

    /// What it shows of a value.
    pub(crate) fn read(&mut self, value: f64, time_s: f64, rng: &mut Pcg64Mcg) -> f64 {
        let r = self.reading;
        let noise = match &mut self.slow {
            Some(process) => process.step(rng),
            None => r.noise * rng.sample::<f64, _>(StandardNormal),
        };
        stepped(r.gain * value + r.zero + r.drift_per_s * time_s + noise, r.step)
    }
}

/// What a channel shows of these values over time; the same seed gives the same log.
#[must_use]
pub fn read(reading: &Reading, time_s: &[f64], values: &[f64], seed: u64) -> Vec<f64> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let step_s = time_s.get(1).map_or(1.0, |second| second - time_s[0]);
    let mut channels = Channel::of(std::slice::from_ref(reading), step_s, &mut rng);
    time_s.iter().zip(values).map(|(t, value)| channels[0].read(*value, *t, &mut rng)).collect()
}

/// A number in steps; 0 is none.
pub(crate) fn stepped(value: f64, step: f64) -> f64 {
    if step > 0.0 { libm::round(value / step) * step } else { value }
}

/// What is logged of a tow.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TowTrace {
    /// Time, s, in even steps from 0.
    pub time_s: Vec<f64>,
    /// Speed as sensed, m/s.
    pub speed_m_s: Vec<f64>,
    /// Loads of the water on the body as sensed, N.
    pub loads_n: Vec<Vec<f64>>,
}

/// One tow to `speed_m_s` as it is logged.
///
/// `loads_n` gives the loads of the water at a speed, N; `readings` is that of the speed, then one for each load. The same seed gives the same log.
#[must_use]
pub fn tow(tow: Tow, speed_m_s: f64, readings: &[Reading], loads_n: &dyn Fn(f64) -> Vec<f64>, seed: u64) -> TowTrace {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let step_s = 1.0 / tow.rate_hz;
    let ramp_s = speed_m_s.abs() / tow.acceleration_m_s2;
    let [up, down] = [tow.still_s, tow.still_s + ramp_s + tow.steady_s];
    let end_s = down + ramp_s + tow.still_s;
    let mut channels = Channel::of(readings, step_s, &mut rng);
    let samples = libm::round(end_s * tow.rate_hz) as usize;
    let loads = readings.len() - 1;
    let mut out = TowTrace { loads_n: vec![Vec::with_capacity(samples); loads], ..TowTrace::default() };
    let mut lagged: Vec<f64> = vec![0.0; loads];
    let follow = 1.0 - libm::exp(-step_s / WAKE_S);
    for i in 0..samples {
        let t = i as f64 * step_s;
        let rises = ((t - up) / ramp_s).min((down + ramp_s - t) / ramp_s).clamp(0.0, 1.0);
        let speed = speed_m_s * rises;
        let is_rising = t > up && t < up + ramp_s;
        let is_falling = t > down && t < down + ramp_s;
        let acceleration = tow.acceleration_m_s2
            * speed_m_s.signum()
            * (f64::from(u8::from(is_rising)) - f64::from(u8::from(is_falling)));
        out.time_s.push(t);
        out.speed_m_s.push(channels[0].read(speed, t, &mut rng));
        let there = if speed == 0.0 { vec![0.0; loads] } else { loads_n(speed) };
        for (l, load) in there.into_iter().enumerate() {
            lagged[l] += follow * (load - lagged[l]);
            let inertia = if l == 0 { -INERTIA_KG * acceleration } else { 0.0 };
            out.loads_n[l].push(channels[1 + l].read(lagged[l] + inertia, t, &mut rng));
        }
    }
    out
}
