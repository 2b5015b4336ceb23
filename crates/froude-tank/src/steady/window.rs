//! The steady window of a run, by a stated rule.
//!
//! The speed is averaged over blocks. Steady is a stretch of blocks whose speeds lie within ± `tolerance` of the middle of their range; the longest
//! such stretch that moves counts, of several as long as it the first. Left out of it are `settle` at its start, in which wake and rig settle, and, where
//! the log goes on, the last block, into which the braking may reach. At rest is what comes before the first block, and `settle` after the last, that
//! moves at more than 2 % of the largest speed.

use std::ops::Range;

use froude_records::run::marks::{Mark, Segment, SegmentKind};

use super::section::SteadySpec;
use crate::conditioning::stretches::{in_words, longest_free, rows, touching};
use crate::error::TankError;

/// What moves more slowly than this part of the largest speed is at rest.
const AT_REST: f64 = 0.02;
/// A stretch that is steady moves at this part of the largest speed, or faster.
const MOVES: f64 = 0.1;

/// Fewest samples of a window.
const FEWEST: usize = 4;

/// What a sidecar declares of a run's parts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Told<'a> {
    /// What is not to be used.
    pub marks: &'a [Mark],
    /// What a person has named.
    pub segments: &'a [Segment],
}

/// What is known of the motion of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion<'a> {
    /// Its speed, m/s.
    Speed(&'a [f64]),
    /// Its position, m.
    Position(&'a [f64]),
    /// It is held in a stream of constant speed, m/s.
    Stream(f64),
}

impl Motion<'_> {
    /// Mean speed over samples, m/s: of positions the way over the time.
    #[must_use]
    pub fn mean_m_s(&self, time_s: &[f64], rows: Range<usize>) -> f64 {
        match self {
            Self::Speed(speed) => speed[rows.clone()].iter().sum::<f64>() / rows.len() as f64,
            Self::Position(position) => {
                let end = rows.end.min(position.len() - 1);
                (position[end] - position[rows.start]) / (time_s[end] - time_s[rows.start])
            }
            Self::Stream(speed) => *speed,
        }
    }
}

/// Parts of a run, as samples.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Window {
    /// The steady window.
    pub steady: Range<usize>,
    /// At rest before it; may be empty.
    pub before: Range<usize>,
    /// At rest after it; may be empty.
    pub after: Range<usize>,
}

/// The parts of a run.
///
/// # Errors
///
/// No motion, no window.
pub fn window(run: &str, time_s: &[f64], motion: Motion<'_>, spec: &SteadySpec) -> Result<Window, TankError> {
    let n = time_s.len();
    let step_s = (time_s[n - 1] - time_s[0]) / (n - 1) as f64;
    let samples = |seconds: f64| (seconds / step_s).round() as usize;
    let settle = samples(spec.settle_s);
    let needed_s = spec.settle_s + spec.shortest_s;
    let no_window = |longest_s: f64, from_s: f64, speed_m_s: f64, needed_s: f64| {
        let what = format!(
            "no steady window: the speed stays within ± {:.2} % for {longest_s:.2} s at most (from {from_s:.2} s, {speed_m_s:.4} m/s), and {needed_s:.2} s are \
             needed, settling included; tow longer, or allow more (tolerance, shortest and settle in [source.steady])",
            1e2 * spec.tolerance
        );
        TankError::of_run(run, what)
    };
    if let Motion::Stream(speed_m_s) = motion {
        let steady = settle.min(n)..n;
        if (steady.len() as f64) * step_s < spec.shortest_s {
            return Err(no_window(n as f64 * step_s, time_s[0], speed_m_s, needed_s));
        }
        return Ok(Window { steady, before: 0..0, after: n..n });
    }
    let block = samples(spec.block_s).max(1);
    let count = n / block;
    let speeds: Vec<f64> = (0..count).map(|b| motion.mean_m_s(time_s, b * block..(b + 1) * block)).collect();
    let top = speeds.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if count == 0 || top.is_nan() || top <= 0.0 {
        return Err(TankError::of_run(run, "the body does not move; a run at rest has the role \"still\""));
    }
    let blocks = longest(&speeds, spec.tolerance, MOVES * top);
    let long_s = blocks.len() as f64 * block as f64 * step_s;
    // Its last block may hold the first of the braking.
    let ends = if blocks.end == count { count } else { (blocks.end - 1).max(blocks.start) } * block;
    let steady = (blocks.start * block + settle).min(ends)..ends;
    if (steady.len() as f64) * step_s < spec.shortest_s {
        let from = (blocks.start * block).min(n - 1);
        let speed_m_s = if blocks.is_empty() { 0.0 } else { motion.mean_m_s(time_s, from..blocks.end * block) };
        let needed_s = needed_s + if blocks.end == count { 0.0 } else { spec.block_s };
        return Err(no_window(long_s, time_s[from], speed_m_s, needed_s));
    }
    let moves = |v: &f64| v.abs() > AT_REST * top;
    let first = speeds.iter().position(moves).unwrap_or(0);
    let last = speeds.iter().rposition(moves).unwrap_or(count - 1);
    // A block that moves may have begun to move at its start: the one before it may hold that start.
    let before = 0..first.saturating_sub(1) * block;
    let after = ((last + 1) * block + settle).min(n)..n;
    Ok(Window { steady, before, after })
}

/// The parts of a run without what is marked, by the rules or as a person has named them.
///
/// A segment `steady` is the window, whatever the rule says; segments `still` are the parts at rest, the nearest before and after the window. Where the window by
/// the rule holds a mark, it is looked for between the marks. A part at rest that holds one is cut to its longest stretch without.
///
/// # Errors
///
/// As [`window`]; also where marks leave no window, and for one that a person has named and that is none.
pub fn window_told(
    run: &str,
    time_s: &[f64],
    motion: Motion<'_>,
    spec: &SteadySpec,
    told: &Told<'_>,
) -> Result<Window, TankError> {
    let named = |kind: SegmentKind| told.segments.iter().filter(move |segment| segment.kind == kind);
    let mut found = match named(SegmentKind::Steady).next() {
        Some(segment) => {
            let steady = rows(time_s, segment.from_s, segment.to_s);
            if steady.len() < FEWEST {
                let what = format!(
                    "the segment steady, from {:.3} s to {:.3} s, has {} samples of the log; correct it in [[segments]] of its sidecar",
                    segment.from_s,
                    segment.to_s,
                    steady.len()
                );
                return Err(TankError::of_run(run, what));
            }
            let marks = touching(time_s, &steady, told.marks);
            if !marks.is_empty() {
                return Err(marked(run, &marks));
            }
            // At rest is what the rule says, where there is a rule that finds anything.
            let by_rule = window(run, time_s, motion, spec).ok();
            let (before, after) = by_rule.map_or((0..0, time_s.len()..time_s.len()), |w| (w.before, w.after));
            let (before, after) = (before.start..before.end.min(steady.start), after.start.max(steady.end)..after.end);
            Window {
                before: before.start..before.end.max(before.start),
                after: after.start..after.end.max(after.start),
                steady,
            }
        }
        None => between(run, time_s, motion, spec, told.marks)?,
    };
    let stills: Vec<Range<usize>> =
        named(SegmentKind::Still).map(|segment| rows(time_s, segment.from_s, segment.to_s)).collect();
    if !stills.is_empty() {
        let n = time_s.len();
        found.before = stills.iter().rfind(|rows| rows.end <= found.steady.start).cloned().unwrap_or(0..0);
        found.after = stills.iter().find(|rows| rows.start >= found.steady.end).cloned().unwrap_or(n..n);
    }
    for part in [&mut found.before, &mut found.after] {
        *part = longest_free(time_s, part.clone(), told.marks).unwrap_or(part.end..part.end);
    }
    Ok(found)
}

fn marked(run: &str, marks: &[Mark]) -> TankError {
    let what = format!(
        "its steady window holds {}; what is left of it is too short: tow longer, widen the sensor's range, or name a window without marks ([[segments]] name = \"steady\")",
        in_words(marks)
    );
    TankError::of_run(run, what)
}

/// The window by the rule, between the marks where it holds one.
fn between(
    run: &str,
    time_s: &[f64],
    motion: Motion<'_>,
    spec: &SteadySpec,
    marks: &[Mark],
) -> Result<Window, TankError> {
    let whole = window(run, time_s, motion, spec)?;
    let within = touching(time_s, &whole.steady, marks);
    if within.is_empty() {
        return Ok(whole);
    }
    // Of a steady stretch every part is steady: settled already, and as long as is left.
    let step_s = (time_s[time_s.len() - 1] - time_s[0]) / (time_s.len() - 1) as f64;
    match longest_free(time_s, whole.steady.clone(), marks).filter(|rows| rows.len() as f64 * step_s >= spec.shortest_s)
    {
        Some(steady) => Ok(Window { steady, ..whole }),
        None => Err(marked(run, &within)),
    }
}

/// The longest stretch of numbers within ± `tolerance` of the middle of their range, that middle being `least` or more in size; the first of several.
fn longest(speeds: &[f64], tolerance: f64, least: f64) -> Range<usize> {
    let mut best = 0..0;
    for start in 0..speeds.len() {
        let (mut low, mut high) = (speeds[start], speeds[start]);
        let mut end = start;
        while end < speeds.len() {
            (low, high) = (low.min(speeds[end]), high.max(speeds[end]));
            let middle = 0.5 * (low + high);
            if 0.5 * (high - low) > tolerance * middle.abs() || middle.abs() < least {
                break;
            }
            end += 1;
        }
        if end - start > best.len() {
            best = start..end;
        }
        if speeds.len() - start <= best.len() {
            break;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trapezoid() -> (Vec<f64>, Vec<f64>) {
        // 3 s of rest, 2 s up to 0.4 m/s, 6 s there, 2 s down, 3 s of rest; 50 Hz.
        let time_s: Vec<f64> = (0..800).map(|i| 0.02 * f64::from(i)).collect();
        let speed = time_s.iter().map(|t| (0.2 * (t - 3.0)).min(0.2 * (13.0 - t)).clamp(0.0, 0.4)).collect();
        (time_s, speed)
    }

    #[test]
    fn the_window_is_the_constant_part_less_settling_and_the_last_block() {
        let (time_s, speed) = trapezoid();
        let found = window("a", &time_s, Motion::Speed(&speed), &SteadySpec::default()).unwrap();
        // Constant from 5 s to 11 s; settled at 6 s; the last whole block within a per cent ends at 11 s, and is left out.
        assert_eq!((time_s[found.steady.start], time_s[found.steady.end]), (6.0, 10.5));
        assert_eq!((found.before.start, found.after.end), (0, 800));
        assert!(time_s[found.before.end] <= 3.0 && time_s[found.after.start] >= 14.0 - 1e-9);
    }

    #[test]
    fn speed_and_its_integral_have_one_window() {
        let (time_s, speed) = trapezoid();
        let mut position = vec![0.0];
        for v in &speed[1..] {
            position.push(position[position.len() - 1] + 0.02 * v);
        }
        let spec = SteadySpec::default();
        let (a, b) = (
            window("a", &time_s, Motion::Speed(&speed), &spec).unwrap(),
            window("a", &time_s, Motion::Position(&position), &spec).unwrap(),
        );
        assert_eq!(a, b);
        let mean = Motion::Position(&position).mean_m_s(&time_s, b.steady);
        assert!((mean - 0.4).abs() < 1e-12, "{mean}");
    }

    #[test]
    fn a_run_that_never_settles_says_how_long_it_nearly_did() {
        let (time_s, speed) = trapezoid();
        let spec = SteadySpec { shortest_s: 8.0, ..SteadySpec::default() };
        let refused = window("a", &time_s, Motion::Speed(&speed), &spec).unwrap_err().to_string();
        assert!(refused.contains("for 6.00 s at most (from 5.00 s, 0.4000 m/s)"), "{refused}");
        let still = vec![0.0; 800];
        let found = window("a", &time_s, Motion::Speed(&still), &spec);
        let refused = found.unwrap_err().to_string();
        assert_eq!(refused, "run \"a\": the body does not move; a run at rest has the role \"still\"");
    }

    #[test]
    fn a_slow_second_speed_is_no_rest() {
        // 0.05 m/s for 4 s, then 0.4 m/s for 6 s.
        let time_s: Vec<f64> = (0..500).map(|i| 0.02 * f64::from(i)).collect();
        let speed: Vec<f64> = time_s.iter().map(|t| if *t < 4.0 { 0.05 } else { 0.4 }).collect();
        let found = window("a", &time_s, Motion::Speed(&speed), &SteadySpec::default()).unwrap();
        assert!(found.before.is_empty() && found.steady.start == 250, "{found:?}");
    }
}
