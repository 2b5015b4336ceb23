//! A record and its derivatives as a Gaussian window sees them, at even times.
//!
//! x̂⁽ᵈ⁾(t) = ∫ x(t') K⁽ᵈ⁾(t − t') dt' with K of standard deviation w: no delay, gain exp(−(2πfw)²/2) at a frequency f, the same for every derivative. Two records under one window
//! can be compared although their samples lie elsewhere: from w = 1 step on, what is left above half a rate is below 1 %.
//!
//! **Units.** Time in s; d is 0, 1 or 2.
//!
//! # Source
//!
//! Lindeberg (1994), *Scale-Space Theory in Computer Vision*, ch. 2 (derivatives by derivatives of the window).

use std::collections::VecDeque;
use std::ops::RangeInclusive;

use crate::error::SignalError;
use crate::resample::Spline;

/// Half the width R of the window in its standard deviations: cut there, the second derivative keeps −2Rφ(R)/w² = −7e-8/w² of a constant.
const REACH: f64 = 6.0;

/// A record at even times.
#[derive(Debug, Clone, PartialEq)]
pub struct Smooth {
    /// Time of each value, s.
    pub time_s: Vec<f64>,
    /// Step between them, s.
    pub step_s: f64,
    /// The values, in the unit of the record over s^d.
    pub values: Vec<f64>,
    /// Whether the window of each saw no gap.
    pub is_whole: Vec<bool>,
}

/// A record, which needs increasing times but no even ones, under a window of `width_s`, at steps of `step_s`; `own_step_s` is the usual one of the record, `gaps_s` are stretches without samples.
///
/// # Errors
///
/// Those of [`Spline::through`]; [`SignalError::TooShort`] for a record shorter than twice the window.
pub fn smooth(
    time_s: &[f64],
    record: &[f64],
    own_step_s: f64,
    gaps_s: &[[f64; 2]],
    [width_s, step_s]: [f64; 2],
    derivative: usize,
) -> Result<Smooth, SignalError> {
    let spline = Spline::through(time_s, record)?;
    let (first, last) = (time_s[0], time_s[time_s.len() - 1]);
    let n_own = ((last - first) / own_step_s).round().max(1.0);
    let h = (last - first) / n_own;
    // About the mean, so that a large one costs no digits, and the sum over K' and K'' need not be exactly zero.
    let mean = record.iter().sum::<f64>() / record.len() as f64;
    let own = |i: usize| spline.at((first + i as f64 * h).min(last)).unwrap_or(mean) - mean;
    let reach = REACH * width_s;
    let room = last - first - 2.0 * reach;
    if room < step_s {
        let needed = (2.0 * reach / own_step_s).ceil() as usize + 1;
        return Err(SignalError::TooShort { what: "the window of a search", needed, found: time_s.len() });
    }
    let kernel = |u: f64| {
        let k = (-0.5 * (u / width_s).powi(2)).exp() / (width_s * std::f64::consts::TAU.sqrt());
        match derivative {
            0 => k,
            1 => -u / (width_s * width_s) * k,
            _ => (u * u / width_s.powi(4) - 1.0 / (width_s * width_s)) * k,
        }
    };
    let offset = if derivative == 0 { mean } else { 0.0 };
    let times: Vec<f64> = (0..=(room / step_s) as usize).map(|k| first + reach + k as f64 * step_s).collect();
    let seen = |t: f64| -> RangeInclusive<usize> {
        let from = ((t - reach - first) / h).ceil().max(0.0) as usize;
        from..=(((t + reach - first) / h) as usize).min(n_own as usize)
    };
    let is_whole = |t: &f64| gaps_s.iter().all(|[a, b]| *b <= t - reach || *a >= t + reach);
    let is_whole: Vec<bool> = times.iter().map(is_whole).collect();
    // What the window sees, from the sample `start` on: a long gap takes no memory.
    let (mut window, mut start) = (VecDeque::new(), 0);
    let value = |(t, is_whole): (&f64, &bool)| {
        if !is_whole {
            return offset;
        }
        let span = seen(*t);
        window.drain(..span.start().saturating_sub(start).min(window.len()));
        start = *span.start();
        window.extend((start + window.len()..=*span.end()).map(own));
        let sum: f64 = span.zip(&window).map(|(i, x)| x * kernel(t - first - i as f64 * h)).sum();
        offset + sum * h
    };
    Ok(Smooth { values: times.iter().zip(&is_whole).map(value).collect(), is_whole, time_s: times, step_s })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine keeps exp(−(ωw)²/2) of its amplitude, and its derivatives are those of the sine. The ends of the window add at most 2φ(R)/(ωw) to the first and
    /// 2Rφ(R)/(ωw)² to the second, 8e-8 and 3e-6 here; the spline between the samples the rest.
    /// Parts of the amplitude of each derivative.
    const MOST: [f64; 3] = [1e-8, 1e-7, 4e-6];

    #[test]
    fn derivatives_of_a_sine_are_its_own_times_the_gain() {
        let (omega, w) = (3.0_f64, 0.05);
        let time: Vec<f64> = (0..800).map(|i| 0.01 * f64::from(i) + 2e-3 * f64::from(i * 7 % 5)).collect();
        let record: Vec<f64> = time.iter().map(|t| 40.0 + (omega * t).sin()).collect();
        let gain = (-0.5 * (omega * w).powi(2)).exp();
        for (d, exact) in [(0, f64::sin as fn(f64) -> f64), (1, f64::cos), (2, |x| -x.sin())] {
            let found = smooth(&time, &record, 0.01, &[[3.0, 3.5]], [w, 0.02], d).unwrap();
            for ((t, x), _) in found.time_s.iter().zip(&found.values).zip(&found.is_whole).filter(|(_, whole)| **whole)
            {
                let mean = if d == 0 { 40.0 } else { 0.0 };
                let expected = mean + gain * omega.powi(d as i32) * exact(omega * t);
                assert!((x - expected).abs() < MOST[d] * omega.powi(d as i32), "{d} at {t}: {x} for {expected}");
            }
            let [before, inside] = [2.7, 3.2].map(|t| found.time_s.partition_point(|own| *own < t));
            assert!(found.is_whole[before] && !found.is_whole[inside]);
        }
        assert!(smooth(&time[..40], &record[..40], 0.01, &[], [w, 0.02], 0).is_err());
    }
}
