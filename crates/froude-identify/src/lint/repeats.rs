//! Rows that repeat a setting, and rows that are copies.

use std::collections::BTreeSet;

use froude_records::finding::{Finding, Severity};
use froude_records::number::percent;
use indexmap::IndexMap;

use crate::dataset::{Dataset, LOADS};

/// How well rigs repeat a setting, as part of the largest: 2 mm/s in 1 m/s moves a drag by 0.4 % there.
pub(crate) const REPEATS_WITHIN: f64 = 2e-3;

/// So many copies, or settings, say how they came about.
const FEW_COPIES: usize = 3;
/// Standard deviations above their expected number that copies by chance may lie: of twelve pairs that a step of 0.8 σ makes alike, three were passed in 0.8 % of tables.
const DEVIATIONS: f64 = 3.5;
/// Differences below this part of a range are rounding.
const ROUNDED: f64 = 1e-9;
/// Step of readings over their range, below which no rig repeats every setting to the step.
const FINE: f64 = 1e-3;
/// Distance from a whole number of steps within which a difference is one: text rounds a step off.
const WHOLE: f64 = 0.02;
/// Steps at most in the smallest difference of readings.
const MOST_PARTS: u8 = 3;

/// Share of the speed along x from which a body shows its frontal area: within 8°.
pub(crate) const AHEAD: f64 = 0.99;

/// Rows equal to an earlier one in every column and text: (rows to keep, finding).
///
/// Repeats differ in their measured loads; a copy does not, and would count twice.
#[must_use]
pub fn identical_copies(data: &Dataset) -> (Vec<usize>, Option<Finding>) {
    let mut seen: IndexMap<Vec<u64>, usize> = IndexMap::new();
    let mut keep = Vec::new();
    let mut copies = Vec::new();
    let configurations = crate::dataset::labels(&data.configuration);
    let setups = crate::dataset::labels(&data.setup);
    let runs = crate::dataset::labels(&data.run);
    for i in 0..data.rows {
        let mut key: Vec<u64> = data.channels.values().map(|c| c.values[i].to_bits()).collect();
        key.extend([configurations[i], setups[i], runs[i]].map(|x| x as u64));
        if let Some(&first) = seen.get(&key) {
            copies.push((first, i));
        } else {
            seen.insert(key, i);
            keep.push(i);
        }
    }
    if copies.is_empty() {
        return (keep, None);
    }
    if let Some(chance) = coarse(data, &copies) {
        let text = format!(
            "{} of {} rows repeat an earlier one in every column, and are kept: by the steps of the readings real repeats read the same that often ({} of pairs)",
            copies.len(),
            data.rows,
            percent(chance)
        );
        return ((0..data.rows).collect(), Some(Finding::new(Severity::Note, "identical-rows", text)));
    }
    let line = |i: usize| data.line.get(i).copied().unwrap_or(i + 1);
    let shown: Vec<String> = copies.iter().take(4).map(|&(a, b)| format!("{} = {}", line(b), line(a))).collect();
    let more = if copies.len() > 4 { ", …" } else { "" };
    let finding = Finding::new(
        Severity::Warning,
        "identical-copies",
        format!(
            "{} of {} rows {} dropped (lines {}{more}); real repeats differ in their loads",
            copies.len(),
            data.rows,
            if copies.len() == 1 {
                "is an identical copy of an earlier one and is"
            } else {
                "are identical copies of earlier ones and are"
            },
            shown.join(", ")
        ),
    );
    (keep, Some(finding))
}

/// Chance that two true repeats read the same in every load, where that explains the copies: a sensor of coarse steps.
///
/// With the step Δ of the readings and the scatter σ of repeats that differ, two repeats read the same with a chance of Δ/(2√π σ). Where no repeats differ at all, and that at
/// several settings, the steps are coarser than the scatter, unless they are finer than any rig's, or one part of the table stands in it twice.
fn coarse(data: &Dataset, copies: &[(usize, usize)]) -> Option<f64> {
    let apart = copies.first().map_or(0, |(a, b)| b - a);
    // Row after row: of a sweep that was run again only some are alike.
    let is_block = copies.windows(2).all(|pair| pair[1].1 == pair[0].1 + 1);
    if copies.len() >= FEW_COPIES && apart >= FEW_COPIES && is_block && copies.iter().all(|(a, b)| b - a == apart) {
        return None;
    }
    let settings = repeat_groups(data);
    let loads: Vec<&[f64]> = LOADS.iter().filter_map(|load| data.values(load)).collect();
    // Of loads under names of the user's nothing tells which columns they are.
    if loads.is_empty() {
        return None;
    }
    let steps: Vec<f64> = loads.iter().map(|values| step(values)).collect();
    let chance = |(values, step): (&&[f64], &f64)| {
        // Of each setting the readings that differ: copies among them tell no scatter.
        let mut by_setting: IndexMap<usize, Vec<f64>> = IndexMap::new();
        for (setting, value) in settings.iter().zip(*values) {
            by_setting.entry(*setting).or_default().push(*value);
        }
        let (mut squares, mut count) = (0.0, 0.0);
        for readings in by_setting.values_mut() {
            readings.sort_by(f64::total_cmp);
            readings.dedup();
            let mean = readings.iter().sum::<f64>() / readings.len() as f64;
            squares += readings.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            count += readings.len() as f64 - 1.0;
        }
        let sigma = (squares / count).sqrt();
        (count > 0.0).then(|| (step / (2.0 * std::f64::consts::PI.sqrt() * sigma)).min(1.0))
    };
    let mut size: IndexMap<usize, f64> = IndexMap::new();
    for setting in &settings {
        *size.entry(*setting).or_default() += 1.0;
    }
    let pairs: f64 = size.values().map(|n| 0.5 * n * (n - 1.0)).sum();
    let repeated = size.values().filter(|n| **n > 1.0).count();
    let of_loads: Vec<Option<f64>> = loads.iter().zip(&steps).map(chance).collect();
    if of_loads.iter().all(Option::is_none) {
        return (repeated >= FEW_COPIES && loads.iter().all(|values| is_coarse(values))).then_some(1.0);
    }
    // A load that repeats always says nothing.
    let p: f64 = of_loads.into_iter().flatten().product();
    let expected = p * pairs;
    (copies.len() as f64 <= expected + DEVIATIONS * expected.sqrt()).then_some(p)
}

/// The step of readings: their smallest difference; 0 of readings that never change.
fn step(values: &[f64]) -> f64 {
    differences(values).into_iter().reduce(f64::min).unwrap_or_default()
}

/// Differences of neighbouring readings, but for rounding.
fn differences(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rounding = ROUNDED * range(values);
    sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|d| *d > rounding).collect()
}

/// Whether readings go by whole steps that are no finer than a rig repeats. With few readings the smallest difference may be several steps: halves and thirds of it are tried too.
fn is_coarse(values: &[f64]) -> bool {
    let (apart, smallest) = (differences(values), step(values));
    (1..=MOST_PARTS).map(|parts| smallest / f64::from(parts)).any(|step| {
        let is_whole = |d: &f64| (d / step - (d / step).round()).abs() < WHOLE;
        step >= FINE * range(values) && apart.iter().all(is_whole)
    })
}

fn range(values: &[f64]) -> f64 {
    let [low, high] = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(*v), h.max(*v)]);
    high - low
}

/// How many settings were repeated, which is what pure error comes from.
pub(crate) fn repeats(data: &Dataset) -> Option<Finding> {
    // Among rows that stand for many the settings are not there.
    data.values("speed").filter(|_| data.sample.is_none())?;
    let groups = repeat_groups(data);
    let repeated = distinct_usize(&groups);
    let spare = data.rows - repeated;
    (spare == 0 && data.rows >= 4).then(|| {
        Finding::new(
            Severity::Note,
            "no-repeats",
            "no setting was repeated: lack of fit cannot be distinguished from scatter; repeat some settings"
                .to_owned(),
        )
    })
}

/// Settings as labels: rows with the same configuration and setup, and the same motion as far as a rig repeats it.
///
/// A measured speed is never twice the same number. Values of a channel within 0.2 % of its largest belong
/// together, counted from the smallest of them, so that a fine sweep does not run together.
#[must_use]
pub fn repeat_groups(data: &Dataset) -> Vec<usize> {
    let mut keys = vec![crate::dataset::labels(&data.configuration), crate::dataset::labels(&data.setup)];
    for (name, channel) in &data.channels {
        if !is_outcome(name) {
            keys.push(within(&channel.values, REPEATS_WITHIN));
        }
    }
    let mut seen: IndexMap<Vec<usize>, usize> = IndexMap::new();
    (0..data.rows)
        .map(|i| {
            let next = seen.len();
            *seen.entry(keys.iter().map(|k| k[i]).collect()).or_insert(next)
        })
        .collect()
}

/// Channels that differ between repeats of a setting: what is measured, what counts the rows, and what follows from speed and angle.
pub(crate) fn is_outcome(name: &str) -> bool {
    LOADS.contains(&name)
        || name.starts_with("std_")
        || name.starts_with("zero_")
        || matches!(name, "repeat" | "run" | "time" | "temperature" | "density" | "kinematic_viscosity" | "v_x" | "v_y")
}

/// Labels of values that lie within a part of the largest from the smallest of their group.
pub(crate) fn within(values: &[f64], part: f64) -> Vec<usize> {
    let width = part * values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut out = vec![0; values.len()];
    let (mut label, mut first) = (0, order.first().map_or(0.0, |&i| values[i]));
    for i in order {
        if values[i] > first + width {
            label += 1;
            first = values[i];
        }
        out[i] = label;
    }
    out
}

pub(crate) fn distinct_usize(labels: &[usize]) -> usize {
    labels.iter().collect::<BTreeSet<_>>().len()
}
