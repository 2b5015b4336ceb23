//! Samples and logs that are orders of magnitude away from all others: a dropped bit, a lost decimal point, a time in milliseconds.
//!
//! Least squares follow one such number wherever it leads, so it is reported instead of down-weighted: the motion and the loads of a test are continuous, and the runs of a set come from one rig.
//!
//! - **A sample** is wild if it is further from all others of its channel than a hundred times their range. At most three samples may be, with ordinary samples before and after. Channels of few values (a mark, a command) are left alone.
//! - **A log** has steps of time three hundred times the longest of the others. Ranges of loads and motions are not compared: one run may move among many at rest.

use froude_records::number::{plain, significant};
use froude_records::run::RunLog;
use froude_records::run::marks::Mark;

/// Distance from all other samples, as a multiple of their range.
const BEYOND: f64 = 100.0;
/// Samples that may be wild at once.
const FEW: usize = 3;
/// Fewest samples, and fewest distinct values, that a range is taken from.
const FEWEST: usize = 20;
/// Runs that are needed to say what is usual.
const FEWEST_RUNS: usize = 3;
/// Ratio to the longest step of the other logs; a wrong prefix gives a thousand.
const TIMES: f64 = 300.0;
/// Units of motions and loads; a trigger may be of two samples.
const OF_TEST: [&str; 6] = ["m", "rad", "N", "N m", "m/s", "rad/s"];

/// What is said of a sample that no other sample of its channel comes near, with its time; what a mark leaves out is not asked.
#[must_use]
pub fn sample(log: &RunLog, marks: &[Mark]) -> Option<String> {
    log.channels
        .iter()
        .find_map(|(name, channel)| sample_of(name, channel.meaning.unit.as_str(), &log.time_s, &channel.values, marks))
}

/// [`sample`] for one channel.
#[must_use]
pub fn sample_of(name: &str, unit: &str, times: &[f64], values: &[f64], marks: &[Mark]) -> Option<String> {
    if values.len() != times.len() || !OF_TEST.contains(&unit) {
        return None;
    }
    let is_marked = |i: usize| marks.iter().any(|m| m.touches(times[i], times[i]));
    let (row, low, high) = wild((0..values.len()).filter(|i| !is_marked(*i)).map(|i| (i, values[i])).collect())?;
    // What a log begins or ends with may be at rest.
    let is_usual = |i: usize| (low..=high).contains(&values[i]);
    let is_between = (0..row).any(is_usual) && (row + 1..values.len()).any(is_usual);
    is_between.then(|| {
        format!(
            "{name} is {} {unit} at {} s, but otherwise lies between {} and {} {unit}: no load or motion jumps that far and back",
            significant(values[row], 4),
            plain(times[row], 5),
            significant(low, 3),
            significant(high, 3)
        )
    })
}

/// The row of the wildest of values, and the range of those that are not wild.
fn wild(mut values: Vec<(usize, f64)>) -> Option<(usize, f64, f64)> {
    let n = values.len();
    if n < FEWEST + FEW {
        return None;
    }
    // Of all values those at either end are enough: no sorting of a long log.
    let by_value = |a: &(usize, f64), b: &(usize, f64)| a.1.total_cmp(&b.1);
    values.select_nth_unstable_by(FEW, by_value);
    values[FEW + 1..].select_nth_unstable_by(n - 2 * FEW - 2, by_value);
    values[..FEW].sort_by(by_value);
    values[n - FEW..].sort_by(by_value);
    let at = |i: usize| values[i].1;
    // Cuts of k values below and m above; the first cuts nothing.
    let mut cuts = (0..=FEW).flat_map(|k| (0..=FEW - k).map(move |m| (k, n - 1 - m))).skip(1);
    let found = cuts.find_map(|(low, high)| {
        let range = at(high) - at(low);
        let far = |x: f64| x > BEYOND * range && range > 0.0;
        let below = low == 0 || far(at(low) - at(low - 1));
        let above = high == n - 1 || far(at(high + 1) - at(high));
        let place = if high < n - 1 { n - 1 } else { 0 };
        (below && above).then_some((values[place].0, at(low), at(high)))
    })?;
    let mut all: Vec<f64> = values.iter().map(|(_, value)| *value).collect();
    all.sort_by(f64::total_cmp);
    (all.windows(2).filter(|pair| pair[0] != pair[1]).count() >= FEWEST).then_some(found)
}

/// Slowest rate of a test that moves, Hz; a log of one sample in a second and slower is of no motion.
pub const SLOWEST_HZ: f64 = 1.0;
/// Fastest rate of a test, Hz, and its shortest duration, s.
const FASTEST_HZ: f64 = 1e5;
const SHORTEST_S: f64 = 0.5;
/// A log this slow, Hz, and this long, s, is in the wrong unit, or of no test.
const SLOW_AND_LONG: (f64, f64) = (2.0, 3000.0);

/// Wrong units of time: by which factor times change, what is written, and what may be meant.
const UNITS: [(f64, &str, &str); 4] = [(1e-3, "s", "ms"), (1e-6, "s", "us"), (1e3, "ms", "s"), (60.0, "s", "min")];

/// What is said of a log whose rate or duration is none of a test that needs `slowest_hz` and more: which unit its times would fit in.
#[must_use]
pub fn times(time_s: &[f64], slowest_hz: f64) -> Option<String> {
    let (first, last) = (time_s.first()?, time_s.last()?);
    let lasts_s = last - first;
    let rate_hz = time_s.len().saturating_sub(1) as f64 / lasts_s;
    let is_of_a_test = |factor: f64| {
        let (rate_hz, lasts_s) = (rate_hz / factor, lasts_s * factor);
        let is_slow = rate_hz < slowest_hz || rate_hz < SLOW_AND_LONG.0 && lasts_s > SLOW_AND_LONG.1;
        !is_slow && rate_hz <= FASTEST_HZ && (lasts_s >= SHORTEST_S || time_s.len() < FEWEST)
    };
    if !lasts_s.is_finite() || lasts_s <= 0.0 || is_of_a_test(1.0) {
        return None;
    }
    let fits: Vec<String> = UNITS
        .iter()
        .filter(|(factor, ..)| is_of_a_test(*factor))
        .map(|(factor, written, meant)| {
            format!(
                "`time [{meant}]` instead of `time [{written}]` would give {} Hz and {} s",
                significant(rate_hz / factor, 3),
                significant(lasts_s * factor, 3)
            )
        })
        .collect();
    let advice = if fits.is_empty() { "check the unit of its times".to_owned() } else { fits.join("; ") };
    Some(format!(
        "its times give a sampling rate of {} Hz and a duration of {} s, which no such test has; if their unit is wrong, so is every result that involves time; {advice}",
        significant(rate_hz, 3),
        significant(lasts_s, 3)
    ))
}

/// What is said of a log whose steps of time are far longer than those of the other logs, and which it is.
#[must_use]
pub fn steps(logs: &[&RunLog]) -> Option<(usize, String)> {
    let step_s = |log: &RunLog| {
        let times = &log.time_s;
        Some((times.last()? - times.first()?) / (times.len() as f64 - 1.0).max(1.0)).filter(|step| *step > 0.0)
    };
    let sizes: Vec<(usize, f64)> = logs.iter().enumerate().filter_map(|(k, log)| Some((k, step_s(log)?))).collect();
    if sizes.len() < FEWEST_RUNS {
        return None;
    }
    sizes.iter().find_map(|(k, own)| {
        let others = sizes.iter().filter(|(other, _)| other != k).map(|(_, size)| *size);
        let largest = others.fold(0.0, f64::max);
        (largest > 0.0 && *own > TIMES * largest).then(|| {
            let text = format!(
                "the step of its times is {} s, but at most {} s in the other {} logs: a log in the wrong unit would dominate every fit",
                significant(*own, 3),
                significant(largest, 3),
                sizes.len() - 1
            );
            (*k, text)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_in_milliseconds_headed_as_seconds_says_which_unit_fits() {
        let times_of = |step_s: f64, n: u32| (0..n).map(|i| step_s * f64::from(i)).collect::<Vec<f64>>();
        assert_eq!(
            times(&times_of(1000.0 / 60.0, 1440), SLOWEST_HZ).unwrap(),
            "its times give a sampling rate of 0.0600 Hz and a duration of 24000 s, which no such test has; if their unit is wrong, so is every result that \
             involves time; `time [ms]` instead of `time [s]` would give 60.0 Hz and 24.0 s"
        );
        // A kilohertz in milliseconds; a minute of 100 Hz, headed as milliseconds; sound logs, also of hours.
        assert!(times(&times_of(1.0, 20_000), SLOWEST_HZ).unwrap().contains("`time [ms]`"));
        assert!(times(&times_of(1e-5, 6000), SLOWEST_HZ).unwrap().contains("`time [s]` instead of `time [ms]`"));
        for (step_s, n) in [(0.01, 6000), (1.0, 600), (1e-4, 20_000), (0.1, 100_000)] {
            assert_eq!(times(&times_of(step_s, n), SLOWEST_HZ), None, "{step_s}");
        }
    }

    #[test]
    fn one_sample_of_a_million_newtons_is_wild_and_a_peak_is_not() {
        let motion = |peak: f64| -> Vec<(usize, f64)> {
            (0..200).map(|i| (i, if i == 7 { peak } else { (0.1 * i as f64).sin() })).collect()
        };
        for peak in [1e6, -1e6] {
            assert_eq!(wild(motion(peak)).map(|(row, ..)| row), Some(7));
        }
        assert_eq!(wild(motion(40.0)), None);
        // A mark: one sample of another value than all others.
        assert_eq!(wild((0..200).map(|i| (i, f64::from(u8::from(i == 7)))).collect()), None);
    }
}
