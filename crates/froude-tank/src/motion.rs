//! The motion of a run: which part of it is used, cycle by cycle, and the harmonics of its angle there.

use std::ops::Range;

use froude_records::run::marks::Mark;
use froude_records::text::counted;
use froude_signal::harmonic::Harmonics;
use indexmap::IndexMap;

use crate::conditioning::stretches::{in_words, touching};
use crate::error::TankError;
use crate::extremes::{Extremes, Oscillating, Stay};
use crate::log::TankLog;

/// The motion has begun where the angle is this part of its size away from its middle.
const BEGUN: f64 = 0.1;
/// It goes on while the angle still reaches this part of it.
const GOES_ON: f64 = 0.5;
/// A motion that begins within this part of a period from the start of the log was there before.
const QUARTER: f64 = 0.25;
/// The size of an angle: this part of its samples are nearer to the middle.
const SIZE: f64 = 0.9;

/// Which cycles of a run are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cycles {
    /// Whole cycles left out after the motion has begun.
    pub skip: usize,
    /// Whole cycles used after those; `None` for all, and the broken one at the end.
    pub used: Option<usize>,
    /// Fewest whole cycles.
    pub fewest: usize,
}

impl Default for Cycles {
    fn default() -> Self {
        Self { skip: 1, used: None, fewest: 5 }
    }
}

/// Motion and loads of a run, as they were logged: of each its channel, its unit and its values.
#[derive(Debug, Clone)]
pub(crate) struct Logged<'a> {
    /// Name of the run, for messages.
    pub id: &'a str,
    /// Time, s.
    pub time_s: &'a [f64],
    /// The motion, rad or m.
    pub motion: (&'static str, &'static str, &'a [f64]),
    /// What the cells show.
    pub loads: Vec<(&'static str, &'static str, &'a [f64])>,
    pub sampled: Sampled<'a>,
}

/// What a log says of its samples.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sampled<'a> {
    /// What is not used.
    pub marks: &'a [Mark],
    /// Extremes of the channels whose samples are not those recorded: only what was recorded tells whether a sensor stood at its end.
    pub recorded: Option<&'a IndexMap<String, Extremes>>,
    /// Whether rows are means, of which marks show a part of what is clipped.
    pub is_averaged: bool,
}

impl<'a> Sampled<'a> {
    pub(crate) fn of(log: &'a TankLog) -> Self {
        Self { marks: &log.declared.marks, recorded: Some(&log.recorded), is_averaged: log.averaged.is_some() }
    }
}

/// A run as it is used.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// The angle, rad, or the place, m, over the time of the log.
    pub angle: Harmonics,
    /// Samples of each cycle used; a broken one at the end belongs to the last whole one.
    pub cycles: Vec<Range<usize>>,
    /// Whole cycles used.
    pub whole: usize,
    /// Half of what it moves through in each cycle, rad or m.
    pub amplitudes: Vec<f64>,
    /// Which cycles they are, counted from 0 after those left out at the start: what is marked is missing among them.
    pub numbers: Vec<usize>,
    /// Whole cycles that are not used because a mark touches them.
    pub dropped: usize,
}

impl Motion {
    /// Samples used.
    #[must_use]
    pub fn count(&self) -> usize {
        self.cycles.iter().map(ExactSizeIterator::len).sum()
    }

    /// The longest stretch of cycles that follow each other.
    #[must_use]
    pub fn longest(&self) -> Range<usize> {
        let mut best = 0..0;
        let mut now = 0..0;
        for cycle in &self.cycles {
            now = if cycle.start == now.end { now.start..cycle.end } else { cycle.clone() };
            if now.len() > best.len() {
                best = now.clone();
            }
        }
        best
    }

    /// From the first sample used to the last; cycles that a mark touches lie between them and are not used.
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

/// The motion of a run, by so many harmonics of its angle.
///
/// # Errors
///
/// Columns of different lengths, no harmonics, too few cycles, a clipped channel.
pub(crate) fn motion(run: &Logged<'_>, asked: Cycles, harmonics: usize) -> Result<Motion, TankError> {
    let (moved, _, places) = run.motion;
    let n = run.time_s.len();
    for (column, _, values) in std::iter::once(&run.motion).chain(&run.loads) {
        let found = values.len();
        if found != n {
            return Err(TankError::of_run(run.id, format!("{column} has {found} samples where time has {n}")));
        }
    }
    let refused = |why| TankError::of_run(run.id, format!("the {moved} cannot be fitted by harmonics: {why}"));
    let rough = Harmonics::fit(run.time_s, places, 1, None).map_err(refused)?;
    let period_s = rough.period_s();
    let marks = run.sampled.marks;
    if run.sampled.is_averaged || marks.iter().all(|mark| mark.why != "clipped") {
        let loads = run.loads.iter().map(|load| (*load, Oscillating::Load));
        for ((channel, unit, values), kind) in std::iter::once((run.motion, Oscillating::Motion)).chain(loads) {
            let recorded = run.sampled.recorded.and_then(|recorded| recorded.get(channel).cloned());
            let extremes = recorded.unwrap_or_else(|| Extremes::of(run.time_s, values));
            if let Some(Stay { value, samples, from_s }) = extremes.clipped(period_s, kind) {
                let what = format!(
                    "{channel} stays at {value} {unit} for {samples} samples from {from_s:.2} s on, longer than a smooth motion does: it is clipped; \
                     repeat the run with a larger range, or a smaller amplitude"
                );
                return Err(TankError::of_run(run.id, what));
            }
        }
    }
    let (first, end) = moving(run, rough.mean, period_s);
    let start_s = run.time_s[first] + asked.skip as f64 * period_s;
    let at = |time_s: f64| run.time_s.partition_point(|t| *t < time_s).min(end);
    let step_s = (run.time_s[n - 1] - run.time_s[0]) / (n - 1) as f64;
    let end_s = run.time_s[end - 1] + step_s;
    // A sample's worth may be missing at the end of a record that was cut to whole cycles.
    let there = (((end_s - start_s) + step_s) / period_s).max(0.0).floor() as usize;
    let whole = asked.used.map_or(there, |used| used.min(there));
    if whole < asked.fewest.max(1) {
        return Err(TankError::new(format!(
            "run {:?} has {} of {period_s:.2} s after {} of start-up; {} are needed: record longer, or lower \
             cycles.fewest and read the intervals with care",
            run.id,
            counted(whole, "whole cycle", "whole cycles"),
            asked.skip,
            asked.fewest.max(1)
        )));
    }
    let last = if asked.used.is_some_and(|used| used <= there) { at(start_s + whole as f64 * period_s) } else { end };
    let begins = |cycle: usize| at(start_s + cycle as f64 * period_s);
    let cycles = (0..whole).map(|c| begins(c)..if c + 1 == whole { last } else { begins(c + 1) });
    let is_free = |(_, rows): &(usize, Range<usize>)| touching(run.time_s, rows, marks).is_empty();
    let (numbers, cycles): (Vec<usize>, Vec<Range<usize>>) = cycles.enumerate().filter(is_free).unzip();
    let dropped = whole - cycles.len();
    if cycles.len() < asked.fewest.max(1) {
        let what = format!(
            "of its {whole} whole cycles {} are left without a mark, and {} are needed: {}; repeat the run, widen the sensor's range, or lower cycles.fewest and read the intervals with care",
            cycles.len(),
            asked.fewest.max(1),
            in_words(marks)
        );
        return Err(TankError::of_run(run.id, what));
    }
    let whole = cycles.len();
    let used =
        |values: &[f64]| cycles.iter().flat_map(|rows| values[rows.clone()].iter().copied()).collect::<Vec<f64>>();
    let angle =
        Harmonics::fit(&used(run.time_s), &used(places), harmonics, Some(rough.omega_rad_s)).map_err(refused)?;
    let half_range = |rows: &Range<usize>| {
        let (low, high) = (places[rows.clone()].iter())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
        0.5 * (high - low)
    };
    Ok(Motion { angle, whole, amplitudes: cycles.iter().map(half_range).collect(), numbers, dropped, cycles })
}

/// From where to where a run oscillates, as samples.
fn moving(run: &Logged<'_>, middle: f64, period_s: f64) -> (usize, usize) {
    let mut away: Vec<f64> = run.motion.2.iter().map(|x| (x - middle).abs()).collect();
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
