//! Times of a calendar, counted from the first sample.
//!
//! At 1.7·10⁹ s a double resolves 0.2 µs, which squares of times and small steps of a delay lose.

use crate::log::TankLog;
use froude_records::number::plain;
use froude_records::run::step::Step;

/// Name of the step.
pub const STEP: &str = "times";
/// Times that start this long after zero, some 12 days, are those of a calendar, s.
const OF_A_CALENDAR_S: f64 = 1e6;

/// Counts the times of a log, and all that its sidecar states in them, from its first sample where they are those of a calendar.
pub fn from_the_first_sample(run: &mut TankLog) {
    let Some(&start_s) = run.log.time_s.first() else { return };
    if start_s.abs() < OF_A_CALENDAR_S {
        return;
    }
    run.log.time_s.iter_mut().for_each(|t| *t -= start_s);
    for gap in &mut run.log.lost {
        for end in [&mut gap.from_s, &mut gap.to_s].into_iter().flatten() {
            *end -= start_s;
        }
    }
    run.recorded.values_mut().for_each(|extremes| extremes.shift(-start_s));
    for clock in run.declared.clocks.values_mut() {
        clock.origin_s -= start_s;
    }
    for mark in &mut run.declared.marks {
        mark.from_s -= start_s;
        mark.to_s -= start_s;
    }
    for segment in &mut run.declared.segments {
        segment.from_s -= start_s;
        segment.to_s -= start_s;
    }
    let words = format!("counted from the first sample, at {} s", plain(start_s, 13));
    run.done.push(Step::new(STEP, "", words).with("start", start_s, "s"));
}
