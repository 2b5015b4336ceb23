//! A section in waves, held fast on a load cell in one run and free to heave in the other: the twin of that flume.
//!
//! The wavemaker starts from rest, comes to its stroke and sends a wave that reaches the body some time later. Held, the body shows the exciting force
//! F(t) = F₀ e(t) cos(ωt + φ), with e the envelope; free, it heaves by (m + A) z̈ + B ż + C z = F(t) and shows its acceleration. What the held body scatters may come
//! back from the wavemaker, as a share of the force from some time on.
//!
//! **Setting.** Linear; A and B are those of the wave's frequency from the start (the memory of the free surface is left out). **Units.** SI.
//!
//! | what                       | where                               | source                     |
//! | -------------------------- | ----------------------------------- | -------------------------- |
//! | body, wave, wavemaker      | [`WaveRig`]                         | Newman (1977), 6.17        |
//! | held and free runs         | [`WaveRig::held`], [`WaveRig::free`] | Hairer et al. (1993), II.1 |
//!
//! Not here: drift forces, roll, guides with friction, waves that are not harmonic.

use core::f64::consts::{PI, TAU};

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::steady::{Channel, Reading};

/// Longest step of the motion, rad of the wave: (0.05)⁵/120 = 3e-9 of the motion in a step.
const STEP_RAD: f64 = 0.05;

/// Body, wave and wavemaker of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaveRig {
    /// m, all that moves, kg.
    pub mass_kg: f64,
    /// A at the wave's frequency, kg.
    pub added_kg: f64,
    /// B there, N s/m.
    pub damping_n_s_m: f64,
    /// C, N/m.
    pub restoring_n_m: f64,
    /// ω, rad/s.
    pub omega_rad_s: f64,
    /// Amplitude of the wavemaker, m.
    pub stroke_m: f64,
    /// F₀: amplitude of the exciting force, N.
    pub force_n: f64,
    /// φ: phase of that before the wavemaker, rad.
    pub phase_rad: f64,
    /// At rest before the wavemaker starts, s.
    pub still_s: f64,
    /// To full stroke, s.
    pub ramp_s: f64,
    /// From the wavemaker's start until the wave reaches the body, s.
    pub travel_s: f64,
    /// From there to the end of the log, s.
    pub lasts_s: f64,
    /// Samples a second.
    pub rate_hz: f64,
    /// Share of the force on the held body that its own scattered wave brings back, and so long after the wavemaker's start, s.
    pub thrown_back: Option<[f64; 2]>,
}

/// How the channels of a run are read: wavemaker, and force or acceleration, with the delay of that behind the wavemaker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaveReadings {
    /// Of the wavemaker's position.
    pub reference: Reading,
    /// Of force or acceleration.
    pub signal: Reading,
    /// The signal is stamped so late, s.
    pub delay_s: f64,
}

impl WaveReadings {
    /// Both as they are.
    #[must_use]
    pub fn exact() -> Self {
        let exact = Reading { gain: 1.0, ..Reading::default() };
        Self { reference: exact, signal: exact, delay_s: 0.0 }
    }
}

/// What is logged of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WaveTrace {
    /// Time, s, in even steps from 0.
    pub time_s: Vec<f64>,
    /// Position of the wavemaker as sensed, m.
    pub reference_m: Vec<f64>,
    /// Force of the water on the held body, N, or acceleration of the free one, m/s², as sensed.
    pub signal: Vec<f64>,
}

impl WaveRig {
    /// The run in which the body is held; the same seed gives the same log.
    #[must_use]
    pub fn held(&self, readings: WaveReadings, seed: u64) -> WaveTrace {
        self.logged(readings, seed, |t| {
            let share = self.thrown_back.map_or(0.0, |[share, after]| share * self.envelope(t - self.still_s - after));
            (1.0 + share) * self.exciting_n(t)
        })
    }

    /// The run in which it is free; the same seed gives the same log.
    #[must_use]
    pub fn free(&self, readings: WaveReadings, seed: u64) -> WaveTrace {
        let mut state = [0.0_f64; 2];
        let mut time_s = 0.0_f64;
        self.logged(readings, seed, |t| {
            let fastest = self.omega_rad_s.max((self.restoring_n_m / (self.mass_kg + self.added_kg)).sqrt());
            let steps = libm::ceil((t - time_s) * fastest / STEP_RAD).clamp(0.0, 1e6);
            let h = if steps > 0.0 { (t - time_s) / steps } else { 0.0 };
            for i in 0..steps as u32 {
                let from = time_s + f64::from(i) * h;
                let along = |s: [f64; 2], d: [f64; 2], h: f64| [s[0] + h * d[0], s[1] + h * d[1]];
                let slope = |t: f64, s: [f64; 2]| [s[1], self.acceleration_m_s2(t, s)];
                let k1 = slope(from, state);
                let k2 = slope(from + 0.5 * h, along(state, k1, 0.5 * h));
                let k3 = slope(from + 0.5 * h, along(state, k2, 0.5 * h));
                let k4 = slope(from + h, along(state, k3, h));
                state = [0, 1].map(|j| state[j] + h / 6.0 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j]));
            }
            time_s = t.max(time_s);
            self.acceleration_m_s2(t, state)
        })
    }

    fn acceleration_m_s2(&self, t: f64, [z, speed]: [f64; 2]) -> f64 {
        (self.exciting_n(t) - self.damping_n_s_m * speed - self.restoring_n_m * z) / (self.mass_kg + self.added_kg)
    }

    /// From 0 to 1 within the ramp.
    fn envelope(&self, since_s: f64) -> f64 {
        if since_s <= 0.0 {
            0.0
        } else if since_s < self.ramp_s {
            0.5 * (1.0 - libm::cos(PI * since_s / self.ramp_s))
        } else {
            1.0
        }
    }

    /// Force of the wave on the body where it stands, N.
    fn exciting_n(&self, t: f64) -> f64 {
        let since_s = t - self.still_s;
        let phase = self.omega_rad_s * since_s + self.phase_rad;
        self.force_n * self.envelope(since_s - self.travel_s) * libm::cos(phase % TAU)
    }

    fn logged(&self, readings: WaveReadings, seed: u64, mut signal: impl FnMut(f64) -> f64) -> WaveTrace {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let step_s = 1.0 / self.rate_hz;
        let mut channels = Channel::of(&[readings.reference, readings.signal], step_s, &mut rng);
        let samples = libm::round((self.still_s + self.lasts_s) * self.rate_hz) as usize;
        let mut out = WaveTrace::default();
        for i in 0..samples {
            let t = i as f64 * step_s;
            let since_s = t - self.still_s;
            let reference = self.stroke_m * self.envelope(since_s) * libm::cos(self.omega_rad_s * since_s % TAU);
            out.time_s.push(t);
            out.reference_m.push(channels[0].read(reference, t, &mut rng));
            out.signal.push(channels[1].read(signal(t - readings.delay_s), t, &mut rng));
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIG: WaveRig = WaveRig {
        mass_kg: 46.8,
        added_kg: 32.0,
        damping_n_s_m: 100.0,
        restoring_n_m: 2_299.5,
        omega_rad_s: 5.2,
        stroke_m: 9e-3,
        force_n: 12.0,
        phase_rad: -0.7,
        still_s: 2.0,
        ramp_s: 2.0,
        travel_s: 5.0,
        lasts_s: 60.0,
        rate_hz: 200.0,
        thrown_back: None,
    };

    /// |z̈| = ω² F₀/|C − ω²(m + A) + iωB|, when the start has decayed: by e^(−B t/2(m + A)) = e^(−0.63·50) = 2e-14.
    #[test]
    fn the_motion_settles_to_the_response_of_its_formula() {
        let trace = RIG.free(WaveReadings::exact(), 1);
        let late = &trace.signal[trace.signal.len() - 600..];
        let largest = late.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let w = RIG.omega_rad_s;
        let expected = w * w * RIG.force_n / (RIG.restoring_n_m - w * w * 78.8).hypot(w * RIG.damping_n_s_m);
        // A sample may lie 2.5 ms from a peak: (ω·0.0025)²/2 = 8.5e-5. A step of 0.026 rad errs by 1e-10, over the 320 of the decay by 3e-8.
        assert!((-1e-7..9e-5).contains(&(1.0 - largest / expected)), "{largest} {expected}");
    }

    #[test]
    fn a_delay_shifts_the_signal_and_not_the_wavemaker() {
        let now = RIG.held(WaveReadings::exact(), 1);
        let late = RIG.held(WaveReadings { delay_s: 0.05, ..WaveReadings::exact() }, 1);
        assert_eq!(now.reference_m, late.reference_m);
        for i in 10..now.signal.len() {
            // Rounding of times of 60 s: 1e-14 s.
            assert!((now.signal[i - 10] - late.signal[i]).abs() < 1e-10, "{i}");
        }
    }

    #[test]
    fn what_is_thrown_back_comes_after_its_time() {
        let alone = RIG.held(WaveReadings::exact(), 1);
        let both = WaveRig { thrown_back: Some([0.2, 20.0]), ..RIG }.held(WaveReadings::exact(), 1);
        let at = |t: f64| (t * RIG.rate_hz) as usize;
        assert_eq!(alone.signal[..at(22.0)], both.signal[..at(22.0)]);
        let i = at(40.1);
        assert!((both.signal[i] / alone.signal[i] - 1.2).abs() < 1e-12);
    }
}
