//! Statistics of loads over a window of iterations.

use crate::history::Sample;
use crate::outcome::Loads;

/// Of a window, a number a load.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Window {
    /// Iterations.
    pub length: usize,
    /// Mean.
    pub mean: Loads,
    /// Mean of the part by pressure.
    pub pressure: Loads,
    /// Mean of its second half less that of its first.
    pub drift: Loads,
    /// Largest distance from the mean.
    pub spread: Loads,
    /// How far the mean still has to go: the part of its error that has a sign.
    pub still_to_go: Loads,
    /// Standard deviation of the iterative error of the mean: what its neighbours' likeness leaves of the window's scatter, and what the mean still has to go. Of forces that swing and settle at many rates, 97 in 100 are within twice as much.
    pub std_of_mean: Loads,
    /// Whether it goes to and fro about a mean that stands still: it crosses its mean four times and more, and drifts no further than such a cycle does by chance.
    pub is_cycle: [bool; 6],
}

impl Window {
    /// Of the last `length` samples; those before them say how fast the means settle.
    #[must_use]
    pub fn of(samples: &[Sample], length: usize) -> Self {
        let length = length.min(samples.len());
        let start = samples.len() - length;
        let mut window = Self { length, ..Self::default() };
        for load in 0..6 {
            let all: Vec<f64> = samples.iter().map(|sample| sample.total()[load]).collect();
            let (before, series) = all.split_at(start);
            let (first, second) = series.split_at(length / 2);
            let half_before = &before[start.saturating_sub(length / 2)..];
            let middle = mean(series);
            window.mean[load] = middle;
            window.pressure[load] =
                mean(&samples[start..].iter().map(|sample| sample.pressure[load]).collect::<Vec<_>>());
            window.drift[load] = mean(second) - mean(first);
            window.spread[load] = series.iter().map(|x| (x - middle).abs()).fold(0.0, f64::max);
            let std = std_of_mean(series);
            let crossings = series.windows(2).filter(|pair| (pair[0] < middle) != (pair[1] < middle)).count();
            // Halves of a window deviate by √2 each of what the whole does, their difference by twice as much.
            window.is_cycle[load] = crossings >= 4 && window.drift[load].abs() <= 2.0 * std;
            let still_to_go = if window.is_cycle[load] {
                window.drift[load]
            } else {
                still_to_go(mean(first) - mean(half_before), window.drift[load])
            };
            window.still_to_go[load] = still_to_go;
            window.std_of_mean[load] = std.hypot(still_to_go);
        }
        window
    }
}

/// How far the mean of a window is from where it goes, from the last two changes of the means of half windows.
///
/// Changes that shrink by the ratio r each sum up to `d (1/2 + r/(1 − r))` beyond the window's middle. The ratio is taken to be no less than 1/3 and no more than 0.9, as two changes do not tell it well.
fn still_to_go(change_before: f64, change: f64) -> f64 {
    let ratio = (change / change_before).abs();
    let ratio = if ratio.is_nan() { 0.9 } else { ratio.clamp(1.0 / 3.0, 0.9) };
    change * (0.5 + ratio / (1.0 - ratio))
}

/// NaN of none.
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard deviation of the mean of a series whose neighbours are alike.
///
/// `n` values that are correlated count as `n / (1 + 2 Σ ρ_k)` free ones; correlations are summed up to where they first fall below zero.
///
/// # Source
///
/// Geyer (1992), Practical Markov chain Monte Carlo, Statistical Science 7(4), section 3.3: the initial positive sequence.
#[must_use]
pub fn std_of_mean(series: &[f64]) -> f64 {
    let count = series.len();
    let middle = mean(series);
    let covariance = |lag: usize| {
        let pairs = series.iter().zip(series.iter().skip(lag));
        pairs.map(|(a, b)| (a - middle) * (b - middle)).sum::<f64>() / count as f64
    };
    let variance = covariance(0);
    if count < 2 || variance.is_nan() || variance <= 0.0 {
        return 0.0;
    }
    let correlated: f64 = (1..count).map(|lag| covariance(lag) / variance).take_while(|r| *r > 0.0).sum();
    (variance * (1.0 + 2.0 * correlated) / count as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_values_have_the_textbooks_deviation_of_their_mean() {
        // A shuffled series without correlation: 1, −1 in the order of a pseudo-random bit.
        let mut state = 1_u32;
        let series: Vec<f64> = (0..4000)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                if state >> 31 == 0 { 1.0 } else { -1.0 }
            })
            .collect();
        let ratio = std_of_mean(&series) * (series.len() as f64).sqrt();
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    }

    #[test]
    fn values_that_follow_each_other_count_less() {
        // An autoregression x' = 0.9 x + e: its mean deviates by √((1+0.9)/(1−0.9)) = 4.36 times that of free values.
        let mut state = 7_u32;
        let mut x = 0.0;
        let series: Vec<f64> = (0..20_000)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                x = 0.9 * x + f64::from(state) / f64::from(u32::MAX) - 0.5;
                x
            })
            .collect();
        let middle = mean(&series);
        let variance = mean(&series.iter().map(|x| (x - middle).powi(2)).collect::<Vec<_>>());
        let ratio = std_of_mean(&series) / (variance / series.len() as f64).sqrt();
        assert!((ratio - 4.36).abs() < 0.8, "{ratio}");
    }

    /// Of forces that go to −5 N, damped by `per_iteration`, swinging with a period or not: the error of the mean over its standard deviation.
    fn error_over_std(per_iteration: f64, period: f64, count: usize) -> f64 {
        let force = |i: f64| -5.0 + per_iteration.powf(i) * (std::f64::consts::TAU * i / period).cos();
        let sample = |i: usize| {
            let load = force(i as f64);
            Sample { time: i as f64, pressure: [load, 0.0, 0.0, 0.0, 0.0, 0.0], viscous: [0.0; 6] }
        };
        let window = Window::of(&(1..=count).map(sample).collect::<Vec<_>>(), 40);
        (window.mean[0] + 5.0).abs() / window.std_of_mean[0]
    }

    #[test]
    fn what_is_still_to_go_is_within_two_standard_deviations_nearly_always() {
        // What shrinks by half in 13 to 130 iterations, alone and with swings longer and shorter than the window.
        let mut found = Vec::new();
        for per_iteration in [0.95, 0.97, 0.98, 0.99, 0.995] {
            for period in [f64::INFINITY, 90.0, 70.0, 50.0, 40.0, 30.0, 25.0, 15.0, 10.0] {
                found.extend((60..=200).step_by(20).map(|count| error_over_std(per_iteration, period, count)));
            }
        }
        let within = found.iter().filter(|ratio| **ratio < 2.0).count() as f64 / found.len() as f64;
        assert!(within > 0.95, "{within}");
        // What goes straight is known to a factor of two and a half.
        for per_iteration in [0.95, 0.97, 0.98, 0.99] {
            let found = error_over_std(per_iteration, f64::INFINITY, 100);
            assert!((0.4..1.1).contains(&found), "{per_iteration}: {found}");
        }
    }

    #[test]
    fn a_constant_and_an_empty_series_are_known() {
        assert_eq!(std_of_mean(&[]), 0.0);
        assert_eq!(std_of_mean(&[3.0]), 0.0);
        assert_eq!(std_of_mean(&[3.0; 50]), 0.0);
    }
}
