//! The motion of a run: which part of it is used, cycle by cycle, and the harmonics of its angle there.

use std::ops::Range;

use froude_records::run::{Extremes, Stay};
use froude_signal::harmonic::Harmonics;

use super::error::OscillationError;
use super::setup::{OscillationRun, Setup};

/// The motion has begun where the angle is this part of its size away from its middle.
const BEGUN: f64 = 0.1;
/// It goes on while the angle still reaches this part of it.
const GOES_ON: f64 = 0.5;
/// A motion that begins within this part of a period from the start of the log was there before.
const QUARTER: f64 = 0.25;
/// The size of an angle: this part of its samples are nearer to the middle.
const SIZE: f64 = 0.9;

/// A run as it is used.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// The angle, rad, over the time of the log.
    pub angle: Harmonics,
    /// Samples of each cycle used; a broken one at the end belongs to the last whole one.
    pub cycles: Vec<Range<usize>>,
    /// Whole cycles used.
    pub whole: usize,
    /// Half of what the angle moves through in each cycle, rad.
    pub amplitudes_rad: Vec<f64>,
}

impl Motion {
    /// All samples used.
    #[must_use]
    pub fn samples(&self) -> Range<usize> {
        self.cycles.first().map_or(0, |c| c.start)..self.cycles.last().map_or(0, |c| c.end)
    }

    /// Whole cycles and the broken one.
    #[must_use]
    pub fn periods(&self, time_s: &[f64]) -> f64 {
        let used = self.samples();
        (time_s[used.end - 1] - time_s[used.start]) / self.angle.period_s()
    }
}

/// The motion of every run.
///
/// # Errors
///
/// [`OscillationError::Length`], [`OscillationError::Clipped`], [`OscillationError::Angle`], [`OscillationError::TooFewCycles`] of the first run that
/// has one.
pub fn motions(runs: &[OscillationRun<'_>], setup: &Setup) -> Result<Vec<Motion>, OscillationError> {
    runs.iter().map(|run| motion(run, setup)).collect()
}

fn motion(run: &OscillationRun<'_>, setup: &Setup) -> Result<Motion, OscillationError> {
    let n = run.time_s.len();
    for (column, found) in [("angle", run.angle_rad.len()), ("force", run.force_n.len())] {
        if found != n {
            return Err(OscillationError::Length { run: run.id.to_owned(), column, found, expected: n });
        }
    }
    let refused = |source| OscillationError::Angle { run: run.id.to_owned(), source };
    let rough = Harmonics::fit(run.time_s, run.angle_rad, 1, None).map_err(refused)?;
    let period_s = rough.period_s();
    for (channel, values, unit) in [("angle", run.angle_rad, "rad"), ("force", run.force_n, "N")] {
        not_clipped(run.id, channel, unit, &Extremes::of(run.time_s, values), period_s)?;
    }
    let (first, end) = moving(run, rough.mean, period_s);
    let start_s = run.time_s[first] + setup.cycles.skip as f64 * period_s;
    let at = |time_s: f64| run.time_s.partition_point(|t| *t < time_s).min(end);
    let step_s = (run.time_s[n - 1] - run.time_s[0]) / (n - 1) as f64;
    let end_s = run.time_s[end - 1] + step_s;
    // A sample's worth may be missing at the end of a record that was cut to whole cycles.
    let there = (((end_s - start_s) + step_s) / period_s).max(0.0).floor() as usize;
    let whole = setup.cycles.used.map_or(there, |used| used.min(there));
    if whole < setup.cycles.fewest.max(1) {
        let (found, skipped, fewest) = (whole, setup.cycles.skip, setup.cycles.fewest.max(1));
        return Err(OscillationError::TooFewCycles { run: run.id.to_owned(), found, period_s, skipped, fewest });
    }
    let last =
        if setup.cycles.used.is_some_and(|used| used <= there) { at(start_s + whole as f64 * period_s) } else { end };
    let begins = |cycle: usize| at(start_s + cycle as f64 * period_s);
    let cycles: Vec<Range<usize>> =
        (0..whole).map(|c| begins(c)..if c + 1 == whole { last } else { begins(c + 1) }).collect();
    let used = cycles[0].start..last;
    let angle =
        Harmonics::fit(&run.time_s[used.clone()], &run.angle_rad[used], setup.harmonics, Some(rough.omega_rad_s))
            .map_err(refused)?;
    let half_range = |rows: &Range<usize>| {
        let (low, high) = (run.angle_rad[rows.clone()].iter())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
        0.5 * (high - low)
    };
    Ok(Motion { angle, whole, amplitudes_rad: cycles.iter().map(half_range).collect(), cycles })
}

/// From where to where a run oscillates, as samples.
fn moving(run: &OscillationRun<'_>, middle: f64, period_s: f64) -> (usize, usize) {
    let mut away: Vec<f64> = run.angle_rad.iter().map(|x| (x - middle).abs()).collect();
    let first = |part: f64, away: &[f64], size: f64| away.iter().position(|x| *x > part * size).unwrap_or(0);
    let place = ((SIZE * away.len() as f64) as usize).min(away.len() - 1);
    let size = *away.clone().select_nth_unstable_by(place, f64::total_cmp).1;
    // A log that begins in the motion may begin at rest of the swing.
    let begun = first(BEGUN, &away, size);
    let begun = if run.time_s[begun] - run.time_s[0] < QUARTER * period_s { 0 } else { begun };
    away.reverse();
    let n = run.time_s.len();
    let end = n - first(GOES_ON, &away, size);
    // Likewise one that ends in the motion.
    let end = if run.time_s[n - 1] - run.time_s[end - 1] < QUARTER * period_s { n } else { end };
    (begun, end)
}

/// A channel that stands at its largest or smallest value for longer than a smooth motion with its resolution would.
pub(super) fn not_clipped(
    run: &str,
    channel: &'static str,
    unit: &'static str,
    extremes: &Extremes,
    period_s: f64,
) -> Result<(), OscillationError> {
    match extremes.clipped(period_s) {
        None => Ok(()),
        Some(Stay { value, samples, from_s }) => {
            Err(OscillationError::Clipped { run: run.to_owned(), channel, value, unit, samples, from_s })
        }
    }
}
