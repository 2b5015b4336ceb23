//! Where a log without a reference speed holds its speed.
//!
//! The position is differenced over 0.2 s. The median of the speeds within 10 % of the listed one is the speed of the run; the longest stretch within 5 % of
//! it, between gaps, is steady, less what the force and the flow need to settle. The rule is ours: carriages without a fast loop ripple by some per cent,
//! and a count that is 10 % off is no rounding.

use std::ops::Range;

use froude_fit::series::Line;
use froude_records::number::{percent, plain, significant};
use froude_records::run::median;
use froude_records::run::stamps::{parts, usual_step_s};

use crate::drag::steady::SteadySettings;

/// Time over which positions are differenced, s.
pub(super) const SPAN_S: f64 = 0.2;
/// Part of its median within which a held speed stays.
pub(super) const HELD_WITHIN: f64 = 0.05;
/// Part within which a held speed is the listed one: beyond it the length of a count, or the list, is wrong.
const LISTED_WITHIN: f64 = 0.1;
/// Dropped at the end of a held speed, s: half of the span, and a margin for the corner of the profile.
pub(super) const CORNER_S: f64 = 0.15;
/// What to write where the rule finds nothing.
const DECLARE: &str = "declare the stretch with [[segments]] name = \"steady\", from and to, in a sidecar for this log alone, which replaces that of the folder: copy its contents";

/// Where a log holds its speed.
pub(super) struct Held {
    /// Rows between the gaps around it.
    pub part: Range<usize>,
    /// Rows of the window.
    pub steady: Range<usize>,
    /// Speed at the rows of the part, m/s.
    pub local_m_s: Vec<f64>,
}

/// The longest stretch at the listed speed, less its settling, or the declared one, `[from, to]` in s.
///
/// # Errors
///
/// Says why no stretch of the log is steady.
pub(super) fn held(
    time_s: &[f64],
    position_m: &[f64],
    listed_m_s: f64,
    declared: Option<[f64; 2]>,
) -> Result<Held, String> {
    let listed = format!("the listed {} m/s", plain(listed_m_s, 4));
    let settings = SteadySettings::default();
    let length_s = |rows: &Range<usize>| time_s[rows.end - 1] - time_s[rows.start];
    let way_m = |rows: &Range<usize>| position_m[rows.end - 1] - position_m[rows.start];
    let mut found: Vec<(Range<usize>, Range<usize>, Vec<f64>)> = Vec::new();
    let mut fastest_m_s = 0.0_f64;
    for part in parts(time_s).into_iter().filter(|part| part.len() > 2) {
        let time = &time_s[part.clone()];
        let local_m_s = local_speed(time, &position_m[part.clone()]);
        fastest_m_s = local_m_s.iter().fold(fastest_m_s, |fastest, v| fastest.max(v.abs()));
        let rows: Vec<Range<usize>> = match declared {
            Some([from_s, to_s]) => {
                let rows = time.partition_point(|t| *t < from_s)..time.partition_point(|t| *t <= to_s);
                std::iter::once(rows).collect()
            }
            None => [1.0, -1.0].iter().filter_map(|sign| longest(&local_m_s, sign * listed_m_s)).collect(),
        };
        let rows = rows.into_iter().filter(|rows| rows.len() > 1);
        found
            .extend(rows.map(|rows| (part.clone(), part.start + rows.start..part.start + rows.end, local_m_s.clone())));
    }
    let Some((part, steady, local_m_s)) =
        found.iter().max_by(|a, b| length_s(&a.1).total_cmp(&length_s(&b.1))).cloned()
    else {
        return Err(format!(
            "no stretch within {} of {listed}; its largest speed is {} m/s. Check the length of a count, the unit of the times and the list, or {DECLARE}",
            percent(LISTED_WITHIN),
            significant(fastest_m_s, 3)
        ));
    };
    let long_s = length_s(&steady);
    let mean_m_s = way_m(&steady) / long_s;
    if declared.is_some() {
        if (mean_m_s.abs() - listed_m_s).abs() > LISTED_WITHIN * listed_m_s || long_s < settings.shortest_s {
            return Err(format!(
                "its declared steady stretch has {long_s:.2} s between gaps at a mean speed of {} m/s; expected {:.2} s or more at {listed}",
                significant(mean_m_s, 3),
                settings.shortest_s
            ));
        }
        return Ok(Held { part, steady, local_m_s });
    }
    let other_way = found.iter().map(|(_, rows, _)| rows).filter(|rows| way_m(rows) * mean_m_s < 0.0);
    let other_way_s = other_way.map(length_s).fold(0.0, f64::max);
    if other_way_s > 0.5 * long_s {
        return Err(format!(
            "it goes both ways at {listed}, for {long_s:.1} s and {other_way_s:.1} s, and a run has one direction: split the log, or {DECLARE}"
        ));
    }
    if long_s < settings.settle_s + CORNER_S + settings.shortest_s {
        return Err(format!(
            "{long_s:.2} s at {listed} are too short: {} s are dropped for settling and {CORNER_S} s at the end, and {:.2} s are needed; tow slower or \
             further, or {DECLARE}",
            settings.settle_s, settings.shortest_s
        ));
    }
    let (from_s, to_s) = (time_s[steady.start] + settings.settle_s, time_s[steady.end - 1] - CORNER_S);
    let steady = time_s.partition_point(|t| *t < from_s)..time_s.partition_point(|t| *t <= to_s);
    Ok(Held { part, steady, local_m_s })
}

/// Pieces of a window whose mean speeds a line is laid through, its degrees of freedom, and Student's t that one window in a hundred exceeds.
const PIECES: usize = 6;
const DOF: f64 = 4.0;
const CHANCE: f64 = 4.60;
/// Change of the speed over a window, as a part of it, that is reported: M v̇ of it is 1.5 % of the drag of a 6.5 kg carriage with 1.8 N s²/m² over 1.2 m.
const DRIFTS: f64 = 0.005;

/// Change of the speed over a window, as a part of its mean, where it is more than chance and half a per cent: a drive without a loop still accelerates.
pub(super) fn drift(time_s: &[f64], position_m: &[f64]) -> Option<f64> {
    let last = time_s.len().checked_sub(1).filter(|last| *last >= PIECES)?;
    let piece = |k: usize| {
        let (a, b) = (k * last / PIECES, (k + 1) * last / PIECES);
        (position_m[b] - position_m[a]) / (time_s[b] - time_s[a])
    };
    let speeds: Vec<f64> = (0..PIECES).map(piece).collect();
    let line = Line::through(&speeds);
    let left: f64 = speeds.iter().enumerate().map(|(k, v)| (v - line.at(k)).powi(2)).sum();
    let n = PIECES as f64;
    let standard = (left / DOF / (n * (n * n - 1.0) / 12.0)).sqrt();
    // From the first row to the last, and not from the middle of the first piece.
    let part = n * line.slope / line.middle;
    (line.slope.abs() > CHANCE * standard && part.abs() > DRIFTS).then_some(part)
}

/// The speed at each row: the way over [`SPAN_S`] around it.
fn local_speed(time_s: &[f64], position_m: &[f64]) -> Vec<f64> {
    let step_s = usual_step_s(time_s).unwrap_or(SPAN_S);
    let half = ((0.5 * SPAN_S / step_s).round() as usize).max(1);
    let last = time_s.len().saturating_sub(1);
    let of = |i: usize| {
        let (a, b) = (i.saturating_sub(half), (i + half).min(last));
        (position_m[b] - position_m[a]) / (time_s[b] - time_s[a])
    };
    (0..time_s.len()).map(of).collect()
}

/// The longest run of rows at about `target` m/s, signed.
fn longest(local_m_s: &[f64], target: f64) -> Option<Range<usize>> {
    let is_near = |v: &f64, of: f64, part: f64| (v - of).abs() <= part * of.abs();
    let mut near: Vec<f64> = local_m_s.iter().copied().filter(|v| is_near(v, target, LISTED_WITHIN)).collect();
    let middle = median(&mut near)?;
    let mut best = 0..0;
    let mut start = 0;
    for (i, v) in local_m_s.iter().enumerate() {
        if !is_near(v, middle, HELD_WITHIN) {
            start = i + 1;
        } else if i + 1 - start > best.len() {
            best = start..i + 1;
        }
    }
    (best.len() > 1).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At rest for 1 s, a ramp of 0.5 s, so long at the speed, a ramp and rest; 200 samples a second, counts of 0.1 mm.
    fn profile(speed_m_s: f64, held_s: f64) -> (Vec<f64>, Vec<f64>) {
        let rows = 600 + (200.0 * held_s) as usize;
        let time: Vec<f64> = (0..rows).map(|i| 0.005 * i as f64).collect();
        let mut x = 0.0;
        let position = time.iter().map(|t| {
            let up = (t - 1.0).clamp(0.0, 0.5) - (t - 1.5 - held_s).clamp(0.0, 0.5);
            x += 0.005 * speed_m_s * up / 0.5;
            (1e4 * x).round() / 1e4
        });
        let position = position.collect();
        (time, position)
    }

    /// The held speed begins at 1.5 s and ends at 5.5 s: 0.5 s and 0.15 s are dropped, and the 5 % are reached 25 ms before the one and 25 ms after the
    /// other, give or take the span.
    #[test]
    fn the_window_lies_inside_of_the_held_speed() {
        for speed_m_s in [0.1, -0.6] {
            let (time, position) = profile(speed_m_s, 4.0);
            let held = held(&time, &position, speed_m_s.abs(), None).unwrap();
            let (from, to) = (time[held.steady.start], time[held.steady.end - 1]);
            assert!((1.9..2.1).contains(&from) && (5.3..5.5).contains(&to), "{from} {to}");
            let declared = super::held(&time, &position, speed_m_s.abs(), Some([3.0, 5.0])).unwrap();
            assert_eq!((time[declared.steady.start], declared.steady.len()), (3.0, 401));
        }
    }

    /// A carriage of 6 kg that a constant force takes to its speed with a time constant of 3 s; and one that keeps it, whose counts of 0.1 mm are 0.3 % of a piece.
    #[test]
    fn a_speed_that_still_changes_is_seen_and_counts_are_not() {
        let time: Vec<f64> = (0..400).map(|i| 0.005 * f64::from(i)).collect();
        let x = |late_s: f64| -> Vec<f64> {
            let way = |t: f64| 0.1 * (t + 3.0 * (-(t + late_s) / 3.0).exp());
            time.iter().map(|t| (1e4 * way(*t)).round() / 1e4).collect()
        };
        // v = 0.1 (1 − e^−(t + 8)/3): from 0.9305 to 0.9643 of its end over 2 s, 3.6 % of its mean; the line through it is within a tenth.
        let found = drift(&time, &x(8.0)).unwrap();
        assert!((found - 0.0356).abs() < 0.004, "{found}");
        assert_eq!(drift(&time, &x(60.0)), None);
        assert_eq!(drift(&time[..3], &time[..3]), None);
    }

    #[test]
    fn a_log_without_the_listed_speed_says_what_it_has() {
        let (time, position) = profile(0.3, 4.0);
        let why = |listed, declared| held(&time, &position, listed, declared).err().unwrap();
        let none = why(0.03, None);
        assert!(none.starts_with("no stretch within 10 % of the listed 0.03 m/s; its largest speed is 0.3"), "{none}");
        assert!(
            why(0.03, Some([3.0, 5.0]))
                .contains("a mean speed of 0.300 m/s; expected 1.00 s or more at the listed 0.03")
        );
        let (time, position) = profile(0.3, 1.2);
        let short = held(&time, &position, 0.3, None).err().unwrap();
        assert!(short.contains("at the listed 0.3 m/s are too short: 0.5 s are dropped"), "{short}");
        let (forth, back) = (profile(0.3, 4.0), profile(-0.3, 4.0));
        let end = forth.1[forth.1.len() - 1];
        let position: Vec<f64> = forth.1.iter().copied().chain(back.1.iter().map(|x| x + end)).collect();
        let time: Vec<f64> = (0..position.len()).map(|i| 0.005 * i as f64).collect();
        let both = held(&time, &position, 0.3, None).err().unwrap();
        assert!(both.starts_with("it goes both ways at the listed 0.3 m/s, for 4.0 s and 4.0 s"), "{both}");
    }
}
