//! The times of a log as they are used: those of its stamps, or the even ones that these are the rounded ones of, with what was found and done.

use std::ops::Range;

use crate::error::{Place, RecordError};
use crate::finding::{Finding, Severity};
use crate::number::{percent, plain};
use crate::run::clock_jumps::{ClockJumps, in_order, twice};
use crate::run::log::{Gap, GapCause};
use crate::run::stamps::{LACKS, even_times, gaps, median, resolution, timer_step, usual_step_s};
use crate::table::{ColumnData, Table};
use crate::text::counted;
use crate::units::Dimension;

/// Steps that differ less than this from their median, relative to it, are even but for the clock's resolution.
pub const EVEN: f64 = 0.01;

/// Part of a step by which stamps of many digits may be off even times.
const FINE: f64 = 1e-6;

/// Steps between ticks, s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TimeSteps {
    /// The median: gaps do not move it.
    pub median_s: f64,
    /// The shortest.
    pub shortest_s: f64,
    /// The longest.
    pub longest_s: f64,
}

/// The times of a table, s.
///
/// # Errors
///
/// No such column, or one of another dimension.
pub fn time_column(table: &Table) -> Result<&[f64], RecordError> {
    if !table.columns.iter().any(|column| column.name == "time") {
        let advice = "a log needs its times: head the column `time [s]`, or map it with { name = \"time\", unit = \"s\" } in the sidecar";
        return Err(RecordError::unknown_column(Place::whole(&table.path), "time", advice));
    }
    table.number("time", Dimension::TIME)
}

impl TimeSteps {
    /// The steps between increasing times.
    #[must_use]
    pub fn of(time_s: &[f64]) -> Self {
        let mut steps: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
        let median_s = median(&mut steps).unwrap_or(f64::NAN);
        let (shortest_s, longest_s) =
            steps.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), step| (low.min(*step), high.max(*step)));
        Self { median_s, shortest_s, longest_s }
    }
}

/// Ticks that are missing between two times.
#[must_use]
pub fn gap(from_s: f64, to_s: f64, step_s: f64) -> Gap {
    let ticks = (((to_s - from_s) / step_s).round() as u64).saturating_sub(1);
    Gap {
        from_s: Some(from_s),
        to_s: Some(to_s),
        ticks: Some(ticks),
        cause: GapCause::Link,
        text: format!(
            "{} missing between {from_s} s and {to_s} s of the log",
            counted(ticks as usize, "tick is", "ticks are")
        ),
    }
}

/// The times of a log as they are used.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LogTimes {
    /// Rows of the table that are used.
    pub rows: Range<usize>,
    /// Their times, s, increasing.
    pub time_s: Vec<f64>,
    /// The steps between them.
    pub steps: TimeSteps,
    /// Gaps.
    pub lost: Vec<Gap>,
    /// What was found, and done.
    pub findings: Vec<Finding>,
}

impl LogTimes {
    /// The times of a table, by what is declared of its clock.
    ///
    /// # Errors
    ///
    /// No times, fewer than two; a clock that goes back where nothing is declared; equal times that are no rounding.
    pub fn of(table: &Table, jumps: ClockJumps) -> Result<Self, RecordError> {
        let stamps = time_column(table)?;
        if stamps.len() < 2 {
            let problem = "has one value; a log needs two ticks at least".to_owned();
            return Err(RecordError::value(table.place_of_row(0), "time", problem));
        }
        let order = in_order(table, stamps, jumps)?;
        let unit_s = unit_of_times_s(table);
        let written: Vec<f64> = stamps.iter().map(|t| t / unit_s).collect();
        let digits = resolution(&written);
        let timer = digits.and_then(|digits| timer_step(&written, digits));
        let recorded = TimeSteps::of(&order.time_s);
        let of = |resolution_s: f64| even_times(&order.time_s, resolution_s).map(|even| (even, resolution_s));
        let fine = digits.map_or(FINE * recorded.median_s, |digits| digits * unit_s);
        let found = of(fine).or_else(|| of(timer? * unit_s));
        let resolution_s =
            found.as_ref().map(|(_, r)| *r).or(digits.map(|digits| digits * unit_s)).filter(|_| digits.is_some());
        let even = found.map(|(even, _)| even);
        let is_rounded = even.as_ref().is_some_and(|even| even.off_s > EVEN * even.step_s);
        let step_s = even.as_ref().map(|even| even.step_s).or_else(|| usual_step_s(&order.time_s));
        let time_s = match even.as_ref().filter(|_| is_rounded) {
            Some(even) => even.times_s(),
            None => order.time_s,
        };
        if let Some(row) = time_s.windows(2).position(|w| w[1] <= w[0]) {
            return Err(twice(table.place_of_row(order.rows.start + row + 1), time_s[row]));
        }
        let step_s = step_s.unwrap_or(recorded.median_s);
        let lost: Vec<Gap> = gaps(&time_s).into_iter().map(|[a, b]| gap(time_s[a], time_s[b], step_s)).collect();
        let found = Found { recorded, resolution_s, rounded: is_rounded.then_some(step_s) };
        let place = table.path.display().to_string();
        let mut findings = vec![found.finding(&time_s, step_s, &lost, &place)];
        findings.extend(order.done.map(|done| {
            let code = if jumps.is_split { "clock-split" } else { "clock-unwrapped" };
            let severity = if jumps.is_split { Severity::Warning } else { Severity::Note };
            Finding { place: Some(place), ..Finding::new(severity, code, done) }
        }));
        Ok(Self { rows: order.rows, steps: TimeSteps::of(&time_s), time_s, lost, findings })
    }
}

/// Whether the steps that lack no samples are even.
fn are_even(time_s: &[f64], step_s: f64) -> bool {
    let whole = time_s.windows(2).map(|w| w[1] - w[0]).filter(|step| *step <= LACKS * step_s);
    whole.fold(0.0_f64, |off, step| off.max((step - step_s).abs())) <= EVEN * step_s
}

/// Seconds in one unit of the column of times.
fn unit_of_times_s(table: &Table) -> f64 {
    let unit = table.columns.iter().find(|column| column.name == "time").map(|column| &column.data);
    match unit {
        Some(ColumnData::Number { unit, .. }) if unit.factor > 0.0 => unit.factor,
        _ => 1.0,
    }
}

/// What the stamps of a log show.
struct Found {
    recorded: TimeSteps,
    resolution_s: Option<f64>,
    /// Step of the even times that are used in the place of the stamps, s.
    rounded: Option<f64>,
}

impl Found {
    fn finding(&self, time_s: &[f64], step_s: f64, gaps: &[Gap], place: &str) -> Finding {
        let missing = Missing::of(time_s, step_s, gaps);
        let words = match (self.rounded, self.resolution_s) {
            (Some(step_s), Some(resolution_s)) => format!(
                "the stamps are rounded to {} ms; they fit even times {} ms apart within half of that, and these even times are used instead",
                plain(1e3 * resolution_s, 6),
                plain(1e3 * step_s, 7)
            ),
            (_, Some(resolution_s)) => format!(
                "the stamps fit no even times within half their resolution ({} ms) and are used as they are",
                plain(1e3 * resolution_s, 6)
            ),
            _ => "the stamps fit no even times and are used as they are".to_owned(),
        };
        // Rounding that is undone costs nothing.
        let severity = if self.rounded.is_some() { Severity::Note } else { Severity::Warning };
        let even = (self.rounded.is_some() || !are_even(time_s, step_s)).then_some((severity, words));
        steps_finding(self.recorded, even, &missing, gaps, place)
    }
}

/// Samples that a log lacks beside its gaps.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Missing {
    /// Ticks without a sample.
    pub ticks: usize,
    /// Most of them in a row.
    pub in_a_row: usize,
    /// Samples that are there.
    pub samples: usize,
}

impl Missing {
    fn of(time_s: &[f64], step_s: f64, gaps: &[Gap]) -> Self {
        let mut out = Self { samples: time_s.len(), ..Self::default() };
        for w in time_s.windows(2) {
            let step = w[1] - w[0];
            if step > LACKS * step_s && !gaps.iter().any(|gap| gap.from_s == Some(w[0])) {
                out.add(((step / step_s).round() as usize).saturating_sub(1));
            }
        }
        out
    }

    /// Takes a step in which so many ticks have no sample.
    pub fn add(&mut self, ticks: usize) {
        self.ticks += ticks;
        self.in_a_row = self.in_a_row.max(ticks);
    }

    fn words(&self) -> Option<String> {
        let part = self.ticks as f64 / (self.ticks + self.samples).max(1) as f64;
        (self.ticks > 0).then(|| {
            format!("{} of the samples ({}) are missing, at most {} in a row", percent(part), self.ticks, self.in_a_row)
        })
    }
}

/// What is said of the time steps of a log: `even` is what was done to stamps that are not even, and how grave that is.
#[must_use]
pub fn steps_finding(
    recorded: TimeSteps,
    even: Option<(Severity, String)>,
    missing: &Missing,
    gaps: &[Gap],
    place: &str,
) -> Finding {
    let TimeSteps { median_s, shortest_s, longest_s } = recorded;
    let numbers = format!(
        "time steps have a median of {:.6} ms, from {:.6} ms to {:.6} ms",
        1e3 * median_s,
        1e3 * shortest_s,
        1e3 * longest_s
    );
    let length = |gap: &&Gap| gap.to_s.unwrap_or(0.0) - gap.from_s.unwrap_or(0.0);
    let longest = gaps.iter().max_by(|a, b| length(a).total_cmp(&length(b))).map(|gap| {
        let ticks: u64 = gaps.iter().filter_map(|gap| gap.ticks).sum();
        let (from_s, to_s) = (gap.from_s.unwrap_or(0.0), gap.to_s.unwrap_or(0.0));
        format!(
            "{} missing in {}, the longest of {} s from {} s on; no steady window, cycle or filter runs across them",
            counted(ticks as usize, "tick is", "ticks are"),
            counted(gaps.len(), "gap", "gaps"),
            plain(to_s - from_s, 4),
            plain(from_s, 6)
        )
    });
    let (severity, code) = match (&longest, missing.ticks, &even) {
        (Some(_), ..) => (Severity::Warning, "time-gaps"),
        (None, 0, None) => (Severity::Note, "time-steps"),
        (None, 0, Some((severity, _))) => (*severity, "uneven-time-steps"),
        _ => (Severity::Warning, "uneven-time-steps"),
    };
    let said: Vec<String> = even.into_iter().map(|(_, words)| words).chain(missing.words()).chain(longest).collect();
    let message = if said.is_empty() {
        let off = (longest_s - median_s).max(median_s - shortest_s);
        format!("{numbers}: uniform to {:.1e} of a step", off / median_s)
    } else {
        format!("{numbers}: {}", said.join("; "))
    };
    Finding { place: Some(place.to_owned()), ..Finding::new(severity, code, message) }
}
