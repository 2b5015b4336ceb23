//! Rows that repeat a setting, and rows that are copies.

use froude_records::finding::{Finding, Severity};
use indexmap::IndexMap;

use crate::dataset::{Dataset, LOADS, distinct};

/// How well rigs repeat a setting, as part of the largest: 2 mm/s in 1 m/s moves a drag by 0.4 % there.
pub(crate) const REPEATS_WITHIN: f64 = 2e-3;

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

/// How many settings were repeated, which is what pure error comes from.
pub(crate) fn repeats(data: &Dataset) -> Option<Finding> {
    data.values("speed")?;
    let groups = repeat_groups(data);
    let repeated = distinct_usize(&groups);
    let spare = data.rows - repeated;
    (spare == 0 && data.rows >= 4).then(|| {
        Finding::new(
            Severity::Note,
            "no-repeats",
            "no setting was repeated: lack of fit cannot be distinguished from scatter".to_owned(),
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
    let texts: Vec<String> = labels.iter().map(usize::to_string).collect();
    distinct(&texts).len()
}
