//! Slow correlated noise: the Ornstein–Uhlenbeck process, exact at any step.
//!
//! x' = a x + σ√(1 − a²) ξ with a = e^(−h/τ): variance σ² and autocorrelation e^(−|t|/τ) whatever the step.

use rand::RngExt;
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

/// One process.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrnsteinUhlenbeck {
    keep: f64,
    kick: f64,
    value: f64,
}

impl OrnsteinUhlenbeck {
    /// Starts in its stationary state: standard deviation `rms`, correlation time `time_s`, step `step_s`.
    #[must_use]
    pub fn new(rms: f64, time_s: f64, step_s: f64, rng: &mut Pcg64Mcg) -> Self {
        let keep = libm::exp(-step_s / time_s);
        let draw: f64 = rng.sample(StandardNormal);
        Self { keep, kick: rms * libm::sqrt(1.0 - keep * keep), value: rms * draw }
    }

    /// The next value.
    pub fn step(&mut self, rng: &mut Pcg64Mcg) -> f64 {
        let draw: f64 = rng.sample(StandardNormal);
        self.value = self.keep * self.value + self.kick * draw;
        self.value
    }

    /// The present value.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn variance_and_correlation_time_are_those_asked_for() {
        let (rms, tau, h) = (0.05, 0.3, 0.01);
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut x = OrnsteinUhlenbeck::new(rms, tau, h, &mut rng);
        let n = 2_000_000;
        let values: Vec<f64> = (0..n).map(|_| x.step(&mut rng)).collect();
        let mean_product = |lag: usize| {
            values.iter().zip(&values[lag..]).map(|(a, b)| a * b).sum::<f64>() / (n - lag) as f64 / (rms * rms)
        };
        // n h/τ = 66,667 correlation times: the variance has relative standard error √(τ/(n h)) = 0.39 %, a lagged product no more.
        // Four of them.
        let four_sigma = 4.0 * (tau / (n as f64 * h)).sqrt();
        assert!((mean_product(0) - 1.0).abs() < four_sigma, "{}", mean_product(0));
        assert!((mean_product(30) - (-1.0_f64).exp()).abs() < four_sigma, "{}", mean_product(30));
        assert!((mean_product(60) - (-2.0_f64).exp()).abs() < four_sigma, "{}", mean_product(60));
    }

    #[test]
    fn the_start_is_already_stationary() {
        let n = 20_000;
        let mut rng = Pcg64Mcg::seed_from_u64(2);
        let square: f64 = (0..n).map(|_| OrnsteinUhlenbeck::new(2.0, 0.3, 0.01, &mut rng).value().powi(2)).sum::<f64>()
            / f64::from(n);
        // Relative standard error of a variance from n independent values: √(2/n) = 1 %; four of them.
        assert!((square / 4.0 - 1.0).abs() < 0.04, "{square}");
    }
}
