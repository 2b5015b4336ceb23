//! One clock against another, from a periodic motion that both channels saw.
//!
//! In windows of a few periods the fundamental of both channels is fitted; the phase between them is a lead of the second, their amplitudes a gain.
//! A constant lead is an offset of the clocks, one that grows is a skew: lead(t) = offset + skew (t − t₀). What is left of the leads shows whether
//! offset and skew are all: where it is not, no resampling aligns the two.
//!
//! **Units.** Time in s; gain in the unit of the second channel over that of the first.
//! **Range.** Leads are known to within whole periods only; the one nearest to zero is taken at the first window.
//!
//! # Source
//!
//! Least squares of phases; ours. Phase of a windowed harmonic fit: IEEE Std 1057-2017, 4.7.

use crate::error::{SignalError, in_range, positive};
use crate::harmonic::Harmonics;

/// Harmonics of a window.
const ORDER: usize = 3;
/// Clocks that leave more than this of phase are not aligned by offset and skew, rad: beyond 10° the part of the motion taken for its derivative is a
/// sixth of it.
pub const MOST_LEFT_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// Fewest windows for a line and what is left of it.
const FEWEST_WINDOWS: usize = 4;

/// Lead and gain of one window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Its middle, s.
    pub time_s: f64,
    /// By how much the second channel is ahead of the first, s.
    pub lead_s: f64,
    /// Its amplitude over that of the first.
    pub gain: f64,
}

/// How the clock of one channel runs against that of another.
#[derive(Debug, Clone, PartialEq)]
pub struct Alignment {
    /// Lead of the second channel at [`Alignment::origin_s`], s.
    pub offset_s: f64,
    /// Its growth, s/s.
    pub skew: f64,
    /// t₀: mean time of the windows, s.
    pub origin_s: f64,
    /// Median of the gains.
    pub gain: f64,
    /// Standard uncertainty of offset (s) and skew (s/s), from what is left; windows that overlap count once.
    pub standard: [f64; 2],
    /// Root mean square of what is left of the leads, s.
    pub left_s: f64,
    /// The same as a phase, rad.
    pub left_rad: f64,
    /// The windows.
    pub windows: Vec<Window>,
}

impl Alignment {
    /// Whether offset and skew are all that lies between the clocks: what is left is below [`MOST_LEFT_RAD`].
    #[must_use]
    pub fn is_linear(&self) -> bool {
        self.left_rad <= MOST_LEFT_RAD
    }

    /// The lead at a time, s.
    #[must_use]
    pub fn lead_s(&self, time_s: f64) -> f64 {
        self.offset_s + self.skew * (time_s - self.origin_s)
    }
}

/// Aligns `second` to `first`, both stamped with `time_s`, by windows of `periods` periods of `omega_rad_s` that move on by one.
///
/// # Errors
///
/// [`SignalError::TooShort`] for fewer than four windows; those of [`Harmonics::held`].
pub fn align(
    time_s: &[f64],
    first: &[f64],
    second: &[f64],
    omega_rad_s: f64,
    periods: usize,
) -> Result<Alignment, SignalError> {
    positive("angular frequency (rad/s)", omega_rad_s)?;
    in_range("periods of a window", periods, 1, 1_000)?;
    for (what, channel) in [("the first channel", first), ("the second channel", second)] {
        if channel.len() != time_s.len() {
            return Err(SignalError::Length { what, found: channel.len(), expected: time_s.len() });
        }
    }
    let period_s = std::f64::consts::TAU / omega_rad_s;
    let length_s = periods as f64 * period_s;
    let mut windows: Vec<Window> = Vec::new();
    let begin = time_s.first().copied().unwrap_or(0.0);
    let end = time_s.last().copied().unwrap_or(0.0);
    for k in 0.. {
        let from = begin + f64::from(k) * period_s;
        if from + length_s > end {
            break;
        }
        let rows = time_s.partition_point(|t| *t < from)..time_s.partition_point(|t| *t < from + length_s);
        let fit = |channel: &[f64]| Harmonics::held(&time_s[rows.clone()], &channel[rows.clone()], ORDER, omega_rad_s);
        let (a, b) = (fit(first)?, fit(second)?);
        // A cosine of phase θ is late by θ/ω.
        let phase = a.phase_rad(1) - b.phase_rad(1);
        let before = windows.last().map_or(0.0, |w| w.lead_s * omega_rad_s);
        let turns = ((phase - before) / std::f64::consts::TAU).round();
        windows.push(Window {
            time_s: a.origin_s,
            lead_s: (phase - turns * std::f64::consts::TAU) / omega_rad_s,
            gain: b.amplitude(1) / a.amplitude(1),
        });
    }
    if windows.len() < FEWEST_WINDOWS {
        return Err(SignalError::TooShort {
            what: "windows of an alignment",
            needed: FEWEST_WINDOWS - 1,
            found: windows.len(),
        });
    }
    let n = windows.len() as f64;
    let origin_s = windows.iter().map(|w| w.time_s).sum::<f64>() / n;
    let offset_s = windows.iter().map(|w| w.lead_s).sum::<f64>() / n;
    let spread: f64 = windows.iter().map(|w| (w.time_s - origin_s).powi(2)).sum();
    let skew = windows.iter().map(|w| (w.time_s - origin_s) * w.lead_s).sum::<f64>() / spread;
    let left = |w: &Window| w.lead_s - offset_s - skew * (w.time_s - origin_s);
    let squares: f64 = windows.iter().map(|w| left(w).powi(2)).sum();
    let left_s = (squares / (n - 2.0)).sqrt();
    let overlap = (periods as f64).sqrt();
    let mut gains: Vec<f64> = windows.iter().map(|w| w.gain).collect();
    gains.sort_by(f64::total_cmp);
    Ok(Alignment {
        offset_s,
        skew,
        origin_s,
        gain: gains[gains.len() / 2],
        standard: [overlap * left_s / n.sqrt(), overlap * left_s / spread.sqrt()],
        left_s,
        left_rad: left_s * omega_rad_s,
        windows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn channels(lead: impl Fn(f64) -> f64, gain: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..6_000).map(|i| 10.0 + f64::from(i) * 0.01).collect();
        let motion = |t: f64| 0.2 + (5.2 * t).sin() + 0.1 * (10.4 * t).cos();
        let first = time.iter().map(|t| motion(*t)).collect();
        let second = time.iter().map(|t| gain * motion(t + lead(*t))).collect();
        (time, first, second)
    }

    proptest! {
        #[test]
        fn offset_skew_and_gain_come_out(offset in -0.3_f64..0.3, skew in -8e-3_f64..8e-3, gain in 0.5_f64..2.0) {
            let (time, first, second) = channels(|t| offset + skew * (t - 40.0), gain);
            let found = align(&time, &first, &second, 5.2, 4).unwrap();
            // The skew changes the period by 0.8 %: the held frequency is off by as much over four periods, which tilts the mean column by 1e-3.
            prop_assert!((found.skew - skew).abs() < 1e-4, "{found:?}");
            prop_assert!((found.lead_s(40.0) - offset).abs() < 2e-3 && (found.gain / gain - 1.0).abs() < 5e-3);
            prop_assert!(found.is_linear());
        }
    }

    #[test]
    fn a_clock_that_wanders_is_not_aligned_by_a_line() {
        let (time, first, second) = channels(|t| 0.08 * (0.2 * t).sin(), 1.0);
        let found = align(&time, &first, &second, 5.2, 4).unwrap();
        assert!(!found.is_linear() && found.left_rad > 0.25, "{}", found.left_rad);
    }
}
