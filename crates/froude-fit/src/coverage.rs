//! Whether the coverage of an interval is the nominal one.

use crate::distribution::normal_quantile;

/// How often an interval held the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Count {
    /// Repetitions in which it did.
    pub hits: u64,
    /// All repetitions.
    pub trials: u64,
}

impl Count {
    /// Counts one more repetition.
    pub fn add(&mut self, is_hit: bool) {
        self.trials += 1;
        self.hits += u64::from(is_hit);
    }

    /// Both counts together.
    #[must_use]
    pub fn merge(self, other: Self) -> Self {
        Self { hits: self.hits + other.hits, trials: self.trials + other.trials }
    }

    /// Part of the repetitions in which the interval held the truth.
    #[must_use]
    pub fn rate(self) -> f64 {
        self.hits as f64 / self.trials as f64
    }

    /// Distance of the rate from the nominal one, in binomial standard deviations.
    #[must_use]
    pub fn z_score(self, nominal: f64) -> f64 {
        let n = self.trials as f64;
        (self.hits as f64 - n * nominal) / (n * nominal * (1.0 - nominal)).sqrt()
    }
}

/// Largest `|z|` that chance allows among `cases` together, with a probability
/// `family_wise` of any beyond (Bonferroni: holds however the cases depend on
/// each other).
///
/// # Example
///
/// ```
/// let limit = froude_fit::coverage::z_limit(0.01, 34);
/// assert!((limit - 3.623).abs() < 0.01);
/// ```
#[must_use]
pub fn z_limit(family_wise: f64, cases: usize) -> f64 {
    normal_quantile(1.0 - 0.5 * family_wise / cases.max(1) as f64)
}
