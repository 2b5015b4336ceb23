//! How even the samples of a log are, behind stamps that are rounded, jitter, or lack samples.
//!
//! A stamp rounded to a resolution r is off by up to r/2, at 60 Hz in milliseconds by 3 % of a step. Where all stamps of a log lie within r/2 of even times
//! t₀ + k h (k whole, h and t₀ by least squares), the samples were even and only the stamps are rounded: the even times are then the better ones. Where
//! they do not (jitter, a drifting clock), the stamps are taken as they are.
//!
//! **Units.** s.

use std::ops::Range;

/// Fewest stamps that can prove an even rate.
const FEWEST: usize = 20;
/// Largest resolution, as part of a step, at which missing samples can be counted step by step.
const COUNTABLE: f64 = 0.4;
/// Distance from a whole number of median steps at which a step counts as one.
const WHOLE: f64 = 1e-6;
/// Part of the rows that repeat their stamp below which they are rows logged twice.
const FEW_REPEATS: f64 = 0.02;
/// Largest resolution as part of the length of a log, which is how wrong the rate behind the stamps may be.
const MOST_RATE_ERROR: f64 = 2e-3;
/// A step longer than this many usual steps lacks samples.
pub const LACKS: f64 = 1.5;
/// A step longer than this many usual steps is a gap, at which windows end; a shorter one merely lacks samples.
pub const GAP: f64 = 10.5;
/// Steps to either side of a long one that say what is usual there: a log may be slower at rest.
const BESIDE: usize = 11;

/// The middle one, in the order of size; `None` of none.
pub fn median(steps: &mut [f64]) -> Option<f64> {
    let middle = steps.len() / 2;
    (!steps.is_empty()).then(|| *steps.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Even times that the stamps of a log are the rounded ones of.
#[derive(Debug, Clone, PartialEq)]
pub struct EvenTimes {
    /// Time of tick 0, s.
    pub start_s: f64,
    /// Step, s.
    pub step_s: f64,
    /// The tick of each stamp, increasing.
    pub ticks: Vec<f64>,
    /// Largest distance of a stamp from its tick, s.
    pub off_s: f64,
}

impl EvenTimes {
    /// The time of each stamp, s.
    #[must_use]
    pub fn times_s(&self) -> Vec<f64> {
        self.ticks.iter().map(|k| self.start_s + k * self.step_s).collect()
    }
}

/// The power of ten, in the unit that the stamps are written in, that all of them are multiples of; `None` where digits beyond 10⁻⁹ count.
#[must_use]
pub fn resolution(stamps: &[f64]) -> Option<f64> {
    let is_multiple = |resolution: f64| {
        stamps.iter().all(|x| (x - (x / resolution).round() * resolution).abs() <= 8.0 * f64::EPSILON * x.abs())
    };
    (-9..=9).map(|digits| 10.0_f64.powi(-digits)).find(|resolution| is_multiple(*resolution))
}

/// The largest step that all differences between stamps are multiples of, where that is coarser than their digits: a timer of 5 ms whose stamps are in milliseconds.
#[must_use]
pub fn timer_step(stamps: &[f64], resolution: f64) -> Option<f64> {
    let first = *stamps.first()?;
    let divisor = stamps.iter().map(|x| ((x - first) / resolution).round().abs() as u64).fold(0, gcd);
    (divisor > 1).then_some(divisor as f64 * resolution)
}

fn gcd(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// The even times that stamps, which do not decrease, lie within half a resolution of; `None` where there are none.
#[must_use]
pub fn even_times(stamps_s: &[f64], resolution_s: f64) -> Option<EvenTimes> {
    let n = stamps_s.len();
    if n < FEWEST || resolution_s.is_nan() || resolution_s <= 0.0 {
        return None;
    }
    // A rate is known no better than the resolution over the length of the log.
    let length_s = stamps_s.last()? - stamps_s.first()?;
    let of = |ticks: Vec<f64>| fitted(stamps_s, ticks, resolution_s);
    match whole_steps(stamps_s) {
        // The stamps are the times, and samples are missing where a step is a multiple.
        Some(ticks) if ticks.windows(2).all(|w| w[1] > w[0]) => return of(ticks),
        // A row that is there twice looks like rounding to a whole step; that gives many such rows.
        Some(ticks) if (ticks.windows(2).filter(|w| w[1] == w[0]).count() as f64) < FEW_REPEATS * n as f64 => {
            return None;
        }
        _ => {}
    }
    if resolution_s > MOST_RATE_ERROR * length_s {
        return None;
    }
    of((0..n).map(|i| i as f64).collect()).or_else(|| {
        let step_s = usual_step_s(stamps_s)?;
        if resolution_s > COUNTABLE * step_s {
            return None;
        }
        let step_s = (0..2).fold(step_s, |step_s, _| step_between_gaps_s(stamps_s, step_s));
        let mut tick = 0.0;
        let counted = std::iter::once(0.0).chain(stamps_s.windows(2).map(|w| {
            tick += ((w[1] - w[0]) / step_s).round().max(1.0);
            tick
        }));
        let (start_s, step_s) = line(&counted.collect::<Vec<f64>>(), stamps_s)?;
        // Over a long gap the first step is not exact enough to count by; that of all stamps is.
        let first = ((stamps_s.first()? - start_s) / step_s).round();
        of(stamps_s.iter().map(|t| ((t - start_s) / step_s).round() - first).collect())
    })
}

/// The step by all stamps but those beside gaps: over a long gap the usual step is not exact enough to count by.
fn step_between_gaps_s(stamps_s: &[f64], step_s: f64) -> f64 {
    let counted = stamps_s.windows(2).map(|w| (w[1] - w[0], ((w[1] - w[0]) / step_s).round().max(1.0)));
    let (time_s, ticks) =
        counted.filter(|(_, ticks)| *ticks <= GAP).fold((0.0, 0.0), |(t, n), (dt, ticks)| (t + dt, n + ticks));
    if ticks > 0.0 { time_s / ticks } else { step_s }
}

/// The ticks of stamps whose steps are all whole multiples of their median.
fn whole_steps(stamps_s: &[f64]) -> Option<Vec<f64>> {
    let step_s =
        median(&mut stamps_s.windows(2).map(|w| w[1] - w[0]).collect::<Vec<f64>>()).filter(|step| *step > 0.0)?;
    let mut ticks = vec![0.0];
    for w in stamps_s.windows(2) {
        let steps = (w[1] - w[0]) / step_s;
        if (steps - steps.round()).abs() > WHOLE {
            return None;
        }
        ticks.push(ticks.last()? + steps.round());
    }
    Some(ticks)
}

/// The even times through stamps of these ticks, where all lie within half a resolution.
fn fitted(stamps_s: &[f64], ticks: Vec<f64>, resolution_s: f64) -> Option<EvenTimes> {
    if ticks.windows(2).any(|w| w[1] <= w[0]) {
        return None;
    }
    let (start_s, step_s) = line(&ticks, stamps_s)?;
    let (mut low, mut high, mut largest) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for (k, t) in ticks.iter().zip(stamps_s) {
        let off = t - (start_s + k * step_s);
        (low, high) = (low.min(off), high.max(off));
        largest = largest.max(t.abs());
    }
    // Stamps that are cut off instead of rounded are late by half a resolution on average, which is the same for all. The line is known to r/√(3n) or so.
    let allowed = resolution_s * (1.0 + 2.0 / (ticks.len() as f64).sqrt()) + 16.0 * f64::EPSILON * largest;
    (step_s > 0.0 && high - low <= allowed).then_some(EvenTimes { start_s, step_s, ticks, off_s: high.max(-low) })
}

/// Least squares of a straight line: its value at 0, and its slope.
fn line(x: &[f64], y: &[f64]) -> Option<(f64, f64)> {
    let n = x.len() as f64;
    let middle = x.iter().sum::<f64>() / n;
    // Differences from the first keep the digits of calendar times.
    let first = *y.first()?;
    let mean = y.iter().map(|y| y - first).sum::<f64>() / n;
    let (xx, xy) = x.iter().zip(y).fold((0.0, 0.0), |(xx, xy), (x, y)| {
        let off = x - middle;
        (xx + off * off, xy + off * (y - first - mean))
    });
    (xx > 0.0).then(|| {
        let slope = xy / xx;
        (first + mean - slope * middle, slope)
    })
}

/// Mean of the steps that lack no samples, s; `None` where no step is longer than nothing.
#[must_use]
pub fn usual_step_s(time_s: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
    let middle = median(&mut steps)?;
    if middle == 0.0 {
        // Two samples and more to a stamp.
        return Some(steps.iter().sum::<f64>() / steps.len() as f64).filter(|step| *step > 0.0);
    }
    let whole = steps.iter().filter(|step| **step <= LACKS * middle);
    let (n, sum) = whole.fold((0.0, 0.0), |(n, sum), step| (n + 1.0, sum + step));
    Some(sum / n).filter(|step| *step > 0.0)
}

/// Gaps: pairs of rows, the last before and the first after, whose step is longer than [`GAP`] steps that are usual there.
#[must_use]
pub fn gaps(time_s: &[f64]) -> Vec<[usize; 2]> {
    let Some(usual_s) = usual_step_s(time_s) else { return Vec::new() };
    let step = |i: usize| time_s[i + 1] - time_s[i];
    let beside = |rows: Range<usize>| median(&mut rows.map(step).collect::<Vec<f64>>()).unwrap_or(0.0);
    let last = time_s.len() - 1;
    let is_gap = |i: &usize| {
        step(*i) > GAP * usual_s && {
            let before = beside(i.saturating_sub(BESIDE)..*i);
            let after = beside(i + 1..last.min(i + 1 + BESIDE));
            step(*i) > GAP * before.max(after)
        }
    };
    (0..last).filter(is_gap).map(|i| [i, i + 1]).collect()
}

/// Rows between the gaps.
#[must_use]
pub fn parts(time_s: &[f64]) -> Vec<Range<usize>> {
    let gaps = gaps(time_s);
    let starts = std::iter::once(0).chain(gaps.iter().map(|[_, after]| *after));
    let ends = gaps.iter().map(|[before, _]| before + 1).chain([time_s.len()]);
    starts.zip(ends).map(|(start, end)| start..end).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rounded(rate_hz: f64, resolution_s: f64, keep: impl Fn(u32) -> bool) -> Vec<f64> {
        let stamp = |i: u32| (f64::from(i) / rate_hz / resolution_s).round() * resolution_s;
        (0..2000).filter(|i| keep(*i)).map(stamp).collect()
    }

    #[test]
    fn the_resolution_is_the_last_digit_that_is_written() {
        assert_eq!(resolution(&[0.0, 0.017, 0.033, 0.05]), Some(1e-3));
        assert_eq!(resolution(&[0.0, 10.0, 30.0]), Some(10.0));
        assert_eq!(resolution(&[1_700_000_000.123, 1_700_000_000.456]), Some(1e-3));
        assert_eq!(resolution(&[0.1 + 1e-12, 0.3]), None);
    }

    #[test]
    fn a_lost_or_doubled_row_of_exact_stamps_is_no_rounding() {
        for step_s in [1e-3, 1e-2, 2e-2, 0.1, 1.0] {
            let stamps = |skip: u32| {
                (0..1000).filter(move |i| *i != skip).map(move |i| f64::from(i) * step_s).collect::<Vec<_>>()
            };
            let lost = stamps(500);
            let even = even_times(&lost, step_s).unwrap();
            assert!((even.step_s / step_s - 1.0).abs() < 1e-9 && even.ticks[500] == 501.0, "{step_s}");
            assert!(even.times_s().iter().zip(&lost).all(|(a, b)| (a - b).abs() < 1e-9 * step_s.max(1.0)), "{step_s}");
            let mut doubled = stamps(2000);
            doubled.insert(501, doubled[500]);
            assert_eq!(even_times(&doubled, step_s), None);
        }
    }

    #[test]
    fn stamps_in_whole_seconds_make_up_no_rate() {
        for resolution_s in [0.5, 1.0, 2.0, 10.0] {
            let stamps: Vec<f64> =
                (0..700).map(|i| (f64::from(i) * 0.02 / resolution_s).round() * resolution_s).collect();
            assert_eq!(even_times(&stamps, resolution_s), None, "{resolution_s}");
        }
    }

    /// The step is known to r/√n over the length of the log: 1 ms/√(2000/12)/2000 steps.
    #[test]
    fn rounded_stamps_give_back_the_even_times_with_and_without_lost_samples() {
        for (rate_hz, resolution_s) in [(60.0, 1e-3), (30.0, 1e-2), (144.0, 1e-3)] {
            let lost = |i: u32| i % 33 != 5 && i % 71 != 3 && !(700..900).contains(&i);
            for keep in [&(|_| true) as &dyn Fn(u32) -> bool, &lost] {
                let even = even_times(&rounded(rate_hz, resolution_s, keep), resolution_s)
                    .unwrap_or_else(|| panic!("{rate_hz} Hz, {resolution_s} s"));
                assert!((even.step_s * rate_hz - 1.0).abs() < 1e-5, "{rate_hz}: {}", even.step_s);
                assert_eq!(even.ticks.last(), Some(&1999.0));
                for (t, i) in even.times_s().iter().zip((0..2000).filter(|i| keep(*i))) {
                    assert!((t - f64::from(i) / rate_hz).abs() < 0.1 * resolution_s, "{rate_hz} Hz, {i}: {t}");
                }
            }
        }
    }

    /// Two or more samples to a millisecond: none may be missing, since nothing would tell which.
    #[test]
    fn equal_stamps_are_rounding_where_an_even_rate_explains_them() {
        let stamps = rounded(2300.0, 1e-3, |_| true);
        assert!(stamps.windows(2).any(|w| w[0] == w[1]));
        let even = even_times(&stamps, 1e-3).unwrap();
        assert!((even.step_s * 2300.0 - 1.0).abs() < 1e-5);
        assert_eq!(even_times(&rounded(2300.0, 1e-3, |i| i != 400 && i != 401 && i != 900), 1e-3), None);
    }

    #[test]
    fn a_timer_is_told_from_the_digits() {
        let stamps: Vec<f64> = (0..300).map(|i| (f64::from(i) / 60.0 / 5e-3).round() * 5e-3).collect();
        assert_eq!(resolution(&stamps), Some(1e-3));
        let timer = timer_step(&stamps, 1e-3).unwrap();
        assert!((timer - 5e-3).abs() < 1e-12 && even_times(&stamps, 1e-3).is_none());
        assert!((even_times(&stamps, timer).unwrap().step_s * 60.0 - 1.0).abs() < 1e-4);
        assert_eq!(timer_step(&[0.0, 0.017, 0.033], 1e-3), None);
    }

    #[test]
    fn jitter_and_a_drifting_clock_are_not_rounding() {
        let jitter: Vec<f64> = (0..500).map(|i| 5e-3 * (f64::from(i) + 0.3 * f64::from(i * 7 % 11) / 11.0)).collect();
        assert_eq!(even_times(&jitter, 1e-6), None);
        let drift: Vec<f64> = (0..2000).map(|i| 5e-3 * f64::from(i) + 1e-9 * f64::from(i * i)).collect();
        let stamps: Vec<f64> = drift.iter().map(|t| (t / 1e-3).round() * 1e-3).collect();
        assert_eq!(even_times(&stamps, 1e-3), None);
        assert!(even_times(&drift[..5], 1e-3).is_none());
    }

    /// A log of 1 Hz at rest and 100 Hz in motion has no gap; one of 50 samples in either has.
    #[test]
    fn a_gap_is_long_for_where_it_is() {
        let mut time: Vec<f64> = (0..30).map(f64::from).collect();
        time.extend((1..500).map(|i| 29.0 + 0.01 * f64::from(i)));
        assert_eq!(gaps(&time), Vec::<[usize; 2]>::new());
        let without: Vec<f64> =
            time.iter().enumerate().filter(|(i, _)| !(200..250).contains(i)).map(|(_, t)| *t).collect();
        assert_eq!(gaps(&without), [[199, 200]]);
        assert_eq!(gaps(&[]), Vec::<[usize; 2]>::new());
        assert_eq!(gaps(&[1.0]), Vec::<[usize; 2]>::new());
    }
}
