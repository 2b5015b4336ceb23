//! Mean of a correlated series, with an uncertainty that counts the correlation.
//!
//! Samples of a steady force are correlated (friction wanders over tenths of a second), so that n of them are worth only n/(2τ) independent ones, τ
//! the integrated autocorrelation time in samples.
//!
//! **Source.** As [`crate::autocorrelation`].

use crate::autocorrelation::integrated_time_about_mean;

/// A trend is reported beyond this many of its standard uncertainties.
const TREND_REPORTED: f64 = 3.0;
/// Part of a window at each end over which the weights of its mean rise and fall …
const TAPERED: f64 = 0.25;
/// … and what that costs in independent samples: Σw² n/(Σw)² = (1 − 5r/8)/(1 − r/2)² with r = 2 · 0.25.
const TAPER_COST: f64 = 0.6875 / 0.5625;
/// Most blocks that a series is averaged to before its correlation is taken: 500 resolve a correlation time of a
/// hundredth of the window, below which it does not matter.
const MOST_BLOCKS: usize = 500;

/// Mean of a correlated series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// Its standard uncertainty (type A), the correlation counted.
    pub standard: f64,
    /// Integrated autocorrelation time, s: independent samples are 2τ apart.
    pub correlation_s: f64,
    /// Number of independent samples that it is worth.
    pub effective_n: f64,
    /// Change over the window by a straight line.
    pub trend: f64,
    /// Standard uncertainty of that.
    pub trend_standard: f64,
}

impl Mean {
    /// Whether the change over the window is more than chance (3 standard uncertainties).
    #[must_use]
    pub fn has_trend(&self) -> bool {
        self.trend.abs() > TREND_REPORTED * self.trend_standard
    }
}

/// Mean of a correlated series with step `step_s`; see the head of this module.
///
/// An empty series has a NaN mean; one of fewer than four samples no uncertainty (infinite).
///
/// # Example
///
/// Independent samples keep their number:
///
/// ```
/// use froude_fit::series::mean;
/// let alternating: Vec<f64> = (0..400).map(|i| f64::from(i * 7919 % 101)).collect();
/// let m = mean(&alternating, 0.005);
/// assert!((m.value - 50.0).abs() < 1.0 && m.effective_n > 200.0);
/// ```
#[must_use]
pub fn mean(series: &[f64], step_s: f64) -> Mean {
    let n = series.len();
    let value = tapered(series);
    if n < 4 {
        let unknown = f64::INFINITY;
        return Mean {
            value,
            standard: unknown,
            correlation_s: f64::NAN,
            effective_n: n as f64,
            trend: 0.0,
            trend_standard: unknown,
        };
    }
    let (blocks, per_block) = blocked(series);
    let m = blocks.len();
    let line = Line::through(&blocks);
    let left: Vec<f64> = blocks.iter().map(|x| x - line.middle).collect();
    let tau = integrated_time_about_mean(&left);
    // Subtracting the mean hides 2τ/m of the variance.
    let shown = (1.0 - 2.0 * tau / m as f64).max(0.2);
    let variance = left.iter().map(|x| x * x).sum::<f64>() / (m as f64 * shown);
    let effective_n = (m as f64 / (2.0 * tau * TAPER_COST)).max(1.0);
    let standard = (variance / effective_n).sqrt();
    Mean {
        value,
        standard,
        correlation_s: tau * per_block as f64 * step_s,
        effective_n,
        trend: line.slope * (m as f64 - 1.0),
        // A slope's uncertainty in units of the mean's: √12.
        trend_standard: 12.0_f64.sqrt() * standard,
    }
}

/// Mean with weights that rise over the first quarter as ½(1 − cos) and fall over the last (Tukey's window).
///
/// A swing in the series does not average out over a window that begins and ends anywhere in its period, and where all runs begin alike, it does so
/// alike in all of them. The taper leaves a tenth of it or less where the window holds six periods.
#[must_use]
pub fn tapered(series: &[f64]) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (x, w) in series.iter().zip(taper(series.len())) {
        sum += w * x;
        weights += w;
    }
    sum / weights
}

/// The weights of such a mean over `n` samples.
pub fn taper(n: usize) -> impl Iterator<Item = f64> {
    let ramp = n as f64 * TAPERED;
    (0..n).map(move |i| {
        let from_end = (i.min(n - 1 - i) as f64 + 0.5) / ramp;
        if from_end >= 1.0 { 1.0 } else { 0.5 * (1.0 - (std::f64::consts::PI * from_end).cos()) }
    })
}

/// Averages of blocks, at most 500 of them; what does not fill the last block is left out.
#[must_use]
pub fn blocked(series: &[f64]) -> (Vec<f64>, usize) {
    let per_block = series.len().div_ceil(MOST_BLOCKS).max(1);
    let blocks = series.chunks_exact(per_block).map(|c| c.iter().sum::<f64>() / per_block as f64).collect();
    (blocks, per_block)
}

/// A straight line through equally spaced values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Value at the middle: the mean.
    pub middle: f64,
    /// Change from one value to the next.
    pub slope: f64,
    centre: f64,
}

impl Line {
    /// Least squares.
    #[must_use]
    pub fn through(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let centre = 0.5 * (n - 1.0);
        let middle = values.iter().sum::<f64>() / n;
        let product: f64 = values.iter().enumerate().map(|(i, y)| (i as f64 - centre) * y).sum();
        let square = n * (n * n - 1.0) / 12.0;
        Self { middle, slope: if square > 0.0 { product / square } else { 0.0 }, centre }
    }

    /// At the value with index `i`.
    #[must_use]
    pub fn at(&self, i: usize) -> f64 {
        self.middle + self.slope * (i as f64 - self.centre)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use super::*;

    /// Wandering force of 0.05 N rms and 0.3 s over 4 s windows: the stated standard uncertainty is right.
    ///
    /// τ is estimated from some 7 independent samples. In the mean it is right, and its scatter only widens: the rms of the
    /// stated uncertainty may exceed that of the errors by a third (measured with 400 windows of 3 to 44 s: 1.36 to 1.02).
    #[test]
    fn the_uncertainty_of_a_mean_counts_the_correlation() {
        let mut rng = Pcg64::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let kept = (-0.005_f64 / 0.3).exp();
        let (mut squares, mut stated) = (0.0, 0.0);
        for _ in 0..2000 {
            let mut x = 0.05 * normal();
            let series: Vec<f64> = (0..800)
                .map(|_| {
                    x = kept * x + 0.05 * (1.0 - kept * kept).sqrt() * normal();
                    x
                })
                .collect();
            let m = mean(&series, 0.005);
            squares += m.value * m.value;
            stated += m.standard * m.standard;
        }
        let ratio = (stated / squares).sqrt();
        assert!((1.0..1.36).contains(&ratio), "{ratio}");
    }
}
