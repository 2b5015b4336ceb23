//! Places of an experiment: values of a channel that belong together.

use std::collections::BTreeSet;

/// Speeds of one setting differ by less than this part, angles by less than this: a measured speed is never twice the same number.
const SAME_SPEED: f64 = 0.03;
/// 0.5°.
const SAME_ANGLE_RAD: f64 = 0.0088;

/// Values of one channel as settings: the setting of each row, and the mean value of each.
pub(super) struct Settings {
    of_row: Vec<usize>,
    means: Vec<f64>,
}

/// Angles as settings.
pub(super) fn settings_of_angle(values: &[f64]) -> Settings {
    settings(values, |first, other| other - first <= SAME_ANGLE_RAD)
}

/// Speeds as settings.
pub(super) fn settings_of_speed(values: &[f64]) -> Settings {
    settings(values, |first, other| other - first <= SAME_SPEED * first.abs())
}

/// Values that belong together, counted from the smallest of them so that a fine sweep does not run together.
fn settings(values: &[f64], is_same: fn(f64, f64) -> bool) -> Settings {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut out = Settings { of_row: vec![0; values.len()], means: Vec::new() };
    let mut group: Vec<usize> = Vec::new();
    let mut close = |group: &mut Vec<usize>| {
        if group.is_empty() {
            return;
        }
        for &i in group.iter() {
            out.of_row[i] = out.means.len();
        }
        out.means.push(group.iter().map(|&i| values[i]).sum::<f64>() / group.len() as f64);
        group.clear();
    };
    for i in order {
        if group.first().is_some_and(|&first| !is_same(values[first], values[i])) {
            close(&mut group);
        }
        group.push(i);
    }
    close(&mut group);
    out
}

/// Settings of `held` at which at least three settings of `moving` were run, `most` at most and the most frequent first.
pub(super) fn frequent(held: &Settings, moving: &Settings, most: usize) -> Vec<f64> {
    let mut seen = vec![BTreeSet::new(); held.means.len()];
    for (h, m) in held.of_row.iter().zip(&moving.of_row) {
        seen[*h].insert(*m);
    }
    let mut out: Vec<(usize, f64)> =
        seen.iter().zip(&held.means).filter(|(m, _)| m.len() >= 3).map(|(m, mean)| (m.len(), *mean)).collect();
    out.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
    let mut values: Vec<f64> = out.into_iter().take(most).map(|(_, mean)| mean).collect();
    values.sort_by(f64::total_cmp);
    values
}
