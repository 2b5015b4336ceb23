//! The force sensor between platform and body.
//!
//! It feels the body's drag and the inertia of the body with its water and added mass; the strut's tare only when the strut is
//! below it. First-order filter, noise, drift, steps of 1/48 N, range ± 125 N (MCD II.B, IV.C).
//!
//! **Frame.** Along y; resistance to +y motion is positive. **Units.** N.

use crate::noise::OrnsteinUhlenbeck;
use rand::RngExt;
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

/// How the zero wanders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drift {
    /// Not at all.
    None,
    /// Constant in a run, uniform in ± this from run to run, N.
    PerRun(f64),
    /// A slow walk: standard deviation, N, and correlation time, s.
    Walk(f64, f64),
}

/// What the sensor is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceSensorConfig {
    /// Smallest step, N; 0 is none.
    pub step_n: f64,
    /// Range, ± N.
    pub range_n: f64,
    /// Noise of a sample before rounding, N rms.
    pub noise_n: f64,
    /// Corner of the filter, Hz.
    pub filter_hz: f64,
    /// The zero.
    pub drift: Drift,
}

impl Default for ForceSensorConfig {
    fn default() -> Self {
        Self { step_n: 1.0 / 48.0, range_n: 125.0, noise_n: 0.05, filter_hz: 200.0, drift: Drift::PerRun(0.2) }
    }
}

/// The sensor in one run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceSensor {
    config: ForceSensorConfig,
    gain: f64,
    filtered_n: f64,
    zero_n: f64,
    walk: Option<OrnsteinUhlenbeck>,
}

impl ForceSensor {
    /// Draws the run's drift.
    #[must_use]
    pub fn new(config: ForceSensorConfig, tick_s: f64, rng: &mut Pcg64Mcg) -> Self {
        let zero_n = match config.drift {
            Drift::PerRun(half_n) => half_n * (2.0 * rng.random::<f64>() - 1.0),
            Drift::None | Drift::Walk(..) => 0.0,
        };
        let gain = 1.0 - libm::exp(-2.0 * core::f64::consts::PI * config.filter_hz * tick_s);
        let mut sensor = Self { config, gain, filtered_n: 0.0, zero_n, walk: None };
        sensor.wander_anew(tick_s, rng);
        sensor
    }

    /// A zero that walks sets out anew, anywhere in its range.
    pub fn wander_anew(&mut self, tick_s: f64, rng: &mut Pcg64Mcg) {
        if let Drift::Walk(rms_n, time_s) = self.config.drift {
            self.walk = Some(OrnsteinUhlenbeck::new(rms_n, time_s, tick_s, rng));
        }
    }

    /// A sample of the true force.
    pub fn read(&mut self, force_n: f64, rng: &mut Pcg64Mcg) -> f64 {
        self.filtered_n += self.gain * (force_n - self.filtered_n);
        let drift_n = match &mut self.walk {
            Some(walk) => walk.step(rng),
            None => self.zero_n,
        };
        let noise: f64 = rng.sample(StandardNormal);
        let seen_n =
            (self.filtered_n + drift_n + self.config.noise_n * noise).clamp(-self.config.range_n, self.config.range_n);
        let step_n = self.config.step_n;
        if step_n > 0.0 { libm::rint(seen_n / step_n) * step_n } else { seen_n }
    }

    /// The zero's present error, N (truth).
    #[must_use]
    pub fn drift_n(&self) -> f64 {
        self.walk.map_or(self.zero_n, |w| w.value())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn a_constant_force_reads_itself_plus_the_drift_of_the_run() {
        let mut rng = Pcg64Mcg::seed_from_u64(4);
        let mut sensor = ForceSensor::new(ForceSensorConfig::default(), 250e-6, &mut rng);
        for _ in 0..4_000 {
            sensor.read(6.0, &mut rng);
        }
        let n = 40_000;
        let mean_n = (0..n).map(|_| sensor.read(6.0, &mut rng)).sum::<f64>() / f64::from(n);
        assert!(sensor.drift_n().abs() <= 0.2);
        // White noise of 0.05 N and steps of 1/48 N (0.006 N rms): four standard errors of the mean.
        assert!((mean_n - 6.0 - sensor.drift_n()).abs() < 4.0 * 0.0504 / f64::from(n).sqrt(), "{mean_n}");
    }

    #[test]
    fn readings_are_multiples_of_the_step_within_the_range() {
        let mut rng = Pcg64Mcg::seed_from_u64(5);
        let mut sensor = ForceSensor::new(ForceSensorConfig::default(), 250e-6, &mut rng);
        for i in 0..2_000 {
            let n = sensor.read(f64::from(i - 1_000), &mut rng);
            assert!(n.abs() <= 125.0 + 1.0 / 48.0);
            assert!((n * 48.0 - (n * 48.0).round()).abs() < 1e-9);
        }
    }
}
