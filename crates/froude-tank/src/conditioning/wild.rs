//! Samples and logs that are orders of magnitude away from all others: a dropped bit, a lost decimal point, a time in milliseconds.
//!
//! Least squares follow one such number wherever it leads, so it is refused and not weighed: the motion and the loads of a test are continuous, and a set of runs is of one rig.
//!
//! - **A sample** lies further from all others of its channel than a hundred times their range, and at most three do, with others before and after. Channels of few values (a mark, a command) are left alone.
//! - **A log** has steps of time three hundred times the longest of the others. Ranges of loads and motions are not compared: one run may move among many at rest.

use froude_identify::method::MethodError;
use froude_records::number::{plain, significant};
use froude_records::run::{Channel, ImportedRun};

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

/// Refuses a sample that no other sample of its channel comes near; what a mark leaves out is not asked.
///
/// # Errors
///
/// The first such sample, with its time, and what the others are.
pub fn check(run: &ImportedRun) -> Result<(), MethodError> {
    let times = &run.log.time_s;
    let is_marked = |i: usize| times.get(i).is_some_and(|t| run.declared.marks.iter().any(|m| m.touches(*t, *t)));
    let has_rows =
        |channel: &&Channel| channel.values.len() == times.len() && OF_TEST.contains(&channel.meaning.unit.as_str());
    for (name, channel) in run.log.channels.iter().filter(|(_, channel)| has_rows(channel)) {
        let mut order: Vec<usize> = (0..channel.values.len()).filter(|i| !is_marked(*i)).collect();
        let value = |i: &usize| channel.values[*i];
        order.sort_by(|a, b| value(a).total_cmp(&value(b)));
        let Some((row, low, high)) = wild(&order.iter().map(value).collect::<Vec<_>>()) else { continue };
        let (row, unit) = (order[row], &channel.meaning.unit);
        // What a log begins or ends with may be at rest.
        let is_usual = |i: usize| (low..=high).contains(&channel.values[i]);
        if !(0..row).any(is_usual) || !(row + 1..times.len()).any(is_usual) {
            continue;
        }
        let what = format!(
            "{name} is {} {unit} at {} s, but otherwise lies between {} and {} {unit}: no load or motion jumps that far and back; correct the sample, or exclude it \
             ([[marks]] with from and to in {})",
            significant(channel.values[row], 4),
            plain(times[row], 5),
            significant(low, 3),
            significant(high, 3),
            run.log.path.with_extension("toml").display()
        );
        return Err(MethodError::input(&run.log.path, what));
    }
    Ok(())
}

/// The place of the wildest of sorted values, and the range of those that are not wild.
fn wild(sorted: &[f64]) -> Option<(usize, f64, f64)> {
    let n = sorted.len();
    let is_few_values = || sorted.windows(2).filter(|pair| pair[0] != pair[1]).count() < FEWEST;
    if n < FEWEST + FEW || is_few_values() {
        return None;
    }
    // Cuts of k values below and m above; the first cuts nothing.
    let mut cuts = (0..=FEW).flat_map(|k| (0..=FEW - k).map(move |m| (k, n - 1 - m))).skip(1);
    cuts.find_map(|(low, high)| {
        let range = sorted[high] - sorted[low];
        let far = |x: f64| x > BEYOND * range && range > 0.0;
        let below = low == 0 || far(sorted[low] - sorted[low - 1]);
        let above = high == n - 1 || far(sorted[high + 1] - sorted[high]);
        let place = if high < n - 1 { n - 1 } else { 0 };
        (below && above).then_some((place, sorted[low], sorted[high]))
    })
}

/// Refuses a log whose steps of time are far longer than those of the other logs.
///
/// # Errors
///
/// The first such log, with both numbers.
pub fn compare(runs: &[ImportedRun]) -> Result<(), MethodError> {
    let step_s = |run: &ImportedRun| {
        let times = &run.log.time_s;
        Some((times.last()? - times.first()?) / (times.len() as f64 - 1.0).max(1.0)).filter(|step| *step > 0.0)
    };
    one_of(runs, &step_s)
}

fn one_of(runs: &[ImportedRun], size: &dyn Fn(&ImportedRun) -> Option<f64>) -> Result<(), MethodError> {
    let sizes: Vec<(usize, f64)> = runs.iter().enumerate().filter_map(|(k, run)| Some((k, size(run)?))).collect();
    if sizes.len() < FEWEST_RUNS {
        return Ok(());
    }
    for (k, own) in &sizes {
        let others = sizes.iter().filter(|(other, _)| other != k).map(|(_, size)| *size);
        let largest = others.fold(0.0, f64::max);
        if largest > 0.0 && *own > TIMES * largest {
            let text = format!(
                "the step of its times is {} s, but at most {} s in the other {} logs: a log in the wrong unit would dominate every fit; correct the unit in {}, or remove the log from the folder",
                significant(*own, 3),
                significant(largest, 3),
                sizes.len() - 1,
                runs[*k].log.path.with_extension("toml").display()
            );
            return Err(MethodError::input(&runs[*k].log.path, text));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(mut of: Vec<f64>) -> Vec<f64> {
        of.sort_by(f64::total_cmp);
        of
    }

    #[test]
    fn one_sample_of_a_million_newtons_is_wild_and_a_peak_is_not() {
        let motion =
            |peak: f64| sorted((0..200).map(|i| if i == 7 { peak } else { (0.1 * f64::from(i)).sin() }).collect());
        assert_eq!(wild(&motion(1e6)).map(|(row, ..)| row), Some(199));
        assert_eq!(wild(&motion(-1e6)).map(|(row, ..)| row), Some(0));
        assert_eq!(wild(&motion(40.0)), None);
        // A mark: one sample of another value than all others.
        assert_eq!(wild(&sorted((0..200).map(|i| f64::from(u8::from(i == 7))).collect())), None);
    }
}
