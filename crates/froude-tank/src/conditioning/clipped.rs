//! Readings that are no measurements: at the end of the range, or flat at an extreme.
//!
//! Where a range is declared, a reading within half a step of its ends, or beyond, is clipped. Where none is, a load or a voltage that stands at its largest or
//! smallest value for 5 samples or more, and 10 times as long as at any other value, is: a smooth motion read in steps of q stays at its peak for
//! 2/(√2 − 1) = 4.8 times as long as at the step below, and noise repeats nowhere. What a log begins or ends with is at rest, and counts as another value.

use std::ops::Range;

use froude_records::number::plain;
use froude_records::run::marks::Mark;
use froude_records::run::step::Step;
use froude_records::run::{Channel, Told};
use froude_records::text::counted;
use froude_records::units::Dimension;

use super::align::Stamps;
use crate::findings::warning;
use crate::log::TankLog;

/// Fewest samples of a flat stretch.
const FEWEST: usize = 5;
/// A flat stretch is so many times as long as any other.
const LONGER: usize = 10;
/// This part of the samples are at neither extreme, or a flat stretch tells nothing.
const BETWEEN: f64 = 0.2;
/// Stretches that are fewer samples apart are one.
const APART: usize = 3;
/// Samples on either side of a stretch that a spline through it moves by more than a per cent.
const SPLINE: usize = 3;

/// What is clipped in a channel.
#[derive(Debug, Clone, PartialEq)]
struct Clipped {
    rows: Vec<Range<usize>>,
    samples: usize,
    words: String,
    by: &'static str,
}

/// Marks what is clipped; `stamps` are the times of channels whose samples are not of the log's rows.
pub fn mark(run: &mut TankLog, stamps: &Stamps) {
    let (mut marks, mut steps, mut findings) = (Vec::new(), Vec::new(), Vec::new());
    for (name, told) in &run.told {
        let Some(channel) = run.log.channels.get(name) else { continue };
        let Some(found) = clipped(channel, told) else { continue };
        let (times, wider) = stamps.get(name).map_or((&run.log.time_s, 0), |stamps| (stamps, SPLINE));
        let end = times.len() - 1;
        let at =
            |rows: &Range<usize>| (times[rows.start.saturating_sub(wider)], times[(rows.end - 1 + wider).min(end)]);
        marks.extend(found.rows.iter().map(|rows| {
            let (from_s, to_s) = at(rows);
            let note = format!("{name} stands {}: it is clipped", found.words);
            Mark { from_s, to_s, why: "clipped".to_owned(), by: found.by.to_owned(), note }
        }));
        let (from_s, to_s) = found.rows.first().map(at).unwrap_or_default();
        let words = format!(
            "{} in {} stand {}, the first from {} s to {} s, and are marked",
            counted(found.samples, "sample", "samples"),
            counted(found.rows.len(), "stretch", "stretches"),
            found.words,
            plain(from_s, 5),
            plain(to_s, 5)
        );
        findings.push(warning(
            "channel-clipped",
            format!(
                "{}: {name}: the sensor is clipped: {words}; widen its range, or move less",
                run.log.path.display()
            ),
        ));
        let step = Step::new("clipped", name, words).with("samples", found.samples as f64, "1");
        steps.push(step.with("stretches", found.rows.len() as f64, "1"));
    }
    run.declared.marks.extend(marks);
    run.done.extend(steps);
    run.findings.extend(findings);
}

fn clipped(channel: &Channel, told: &Told) -> Option<Clipped> {
    let values = &channel.values;
    let unit = &channel.meaning.unit;
    if let Some([low, high]) = told.sensor.range {
        let step = told.sensor.resolution.unwrap_or(0.0);
        let near = 0.5 * step + 1e-9 * (high - low);
        let is_at_end = |x: &f64| told.sign * x >= high - near || told.sign * x <= low + near;
        let bad: Vec<usize> = (0..values.len()).filter(|&i| is_at_end(&values[i])).collect();
        let words = format!("at the end of its range ({} to {} {unit})", plain(low, 6), plain(high, 6));
        return stretches(&bad).map(|rows| Clipped {
            rows,
            samples: bad.len(),
            words,
            by: "rule: at the end of the declared range",
        });
    }
    let is_load = [Dimension::FORCE, Dimension::MOMENT, Dimension::VOLTAGE].iter().any(|d| d.to_string() == *unit);
    if !is_load {
        return None;
    }
    let (value, rows) = flat(values)?;
    let samples = rows.iter().map(ExactSizeIterator::len).sum();
    let words = format!("at {} {unit}, where no range is declared", plain(value, 6));
    Some(Clipped { rows, samples, words, by: "rule: flat at an extreme" })
}

/// Rows as stretches.
fn stretches(rows: &[usize]) -> Option<Vec<Range<usize>>> {
    let mut out: Vec<Range<usize>> = Vec::new();
    for &row in rows {
        match out.last_mut() {
            Some(last) if row - last.end < APART => last.end = row + 1,
            _ => out.push(row..row + 1),
        }
    }
    (!out.is_empty()).then_some(out)
}

/// Flat stretches at an extreme, with its value.
fn flat(values: &[f64]) -> Option<(f64, Vec<Range<usize>>)> {
    let n = values.len();
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    let between = values.iter().filter(|x| **x != low && **x != high).count();
    if (between as f64) < BETWEEN * n as f64 {
        return None;
    }
    let mut runs: Vec<Range<usize>> = Vec::new();
    for i in 0..n {
        match runs.last_mut() {
            Some(last) if values[last.start] == values[i] => last.end = i + 1,
            _ => runs.push(i..i + 1),
        }
    }
    let is_at_rest = |run: &Range<usize>| run.start == 0 || run.end == n;
    let is_extreme = |run: &&Range<usize>| !is_at_rest(run) && (values[run.start] == low || values[run.start] == high);
    let elsewhere = runs.iter().filter(|run| !is_extreme(run)).map(ExactSizeIterator::len).max().unwrap_or(1);
    let long = |value: f64| -> Vec<Range<usize>> {
        let is_long = |run: &&Range<usize>| run.len() >= FEWEST.max(LONGER * elsewhere) && values[run.start] == value;
        runs.iter().filter(is_extreme).filter(is_long).cloned().collect()
    };
    [low, high].into_iter().map(|value| (value, long(value))).find(|(_, rows)| !rows.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_cut_at_its_peaks_is_flat_and_one_read_in_steps_is_not() {
        let sine = |i: u32| (0.05 * f64::from(i)).sin();
        let cut: Vec<f64> = (0..1000).map(|i| sine(i).min(0.8)).collect();
        let (value, rows) = flat(&cut).unwrap();
        // Above 0.8 for (π − 2 asin 0.8)/0.05 = 25.7 samples, eight times in 1000.
        assert!(value == 0.8 && rows.len() == 8 && rows.iter().all(|r| (25..=26).contains(&r.len())), "{rows:?}");
        for step in [1e-3, 1e-2, 0.05, 0.2] {
            let coarse: Vec<f64> = (0..1000).map(|i| (sine(i) / step).round() * step).collect();
            assert_eq!(flat(&coarse), None, "{step}");
        }
        // Cut at both ends: neither excuses the other.
        let both: Vec<f64> = (0..1000).map(|i| sine(i).clamp(-0.8, 0.8)).collect();
        assert!(flat(&both).is_some());
    }

    #[test]
    fn rest_at_zero_and_a_constant_without_noise_are_not_clipped() {
        let tow: Vec<f64> = (0..1000).map(|i| if (300..700).contains(&i) { -2.0 } else { 0.0 }).collect();
        assert_eq!(flat(&tow), None);
        assert_eq!(flat(&vec![1.0; 100]), None);
        assert_eq!(flat(&[]), None);
    }

    #[test]
    fn rows_near_each_other_are_one_stretch() {
        assert_eq!(stretches(&[3, 4, 6, 20]), Some(vec![3..7, 20..21]));
        assert_eq!(stretches(&[]), None);
    }
}
