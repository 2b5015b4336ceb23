//! A clock that goes back: a counter that wrapped around, or a clock that was set.
//!
//! ```toml
//! clock_wraps = "65.536 s"        # at the head of the sidecar: 16 bits of milliseconds; the times go on across each wrap
//! split_at_clock_jumps = true     # the log is split where its clock was set, and its longest stretch is used
//! ```
//!
//! Nothing is done that is not declared: sorting the rows would mix the samples of two stretches.

use std::ops::Range;

use crate::error::{Place, RecordError};
use crate::number::plain;
use crate::run::stamps::{GAP, usual_step_s};
use crate::section::Section;
use crate::table::{Column, ColumnData, Table};
use crate::text::counted;
use crate::units::Dimension;

/// Keys of a sidecar.
pub(crate) const KEYS: [&str; 2] = ["clock_wraps", "split_at_clock_jumps"];
/// Part of its period that a counter may skip where it wraps: more is a clock that was set.
const SKIPS: f64 = 0.1;
/// Part of the rows that go back beyond which a log is out of order.
const OUT_OF_ORDER: f64 = 0.01;

/// Counters that are in use, with their period in s.
const COUNTERS: [(f64, &str); 12] = [
    (0.065_536, "a counter of 16 bits in microseconds"),
    (1.0, "the milliseconds of a second"),
    (32.768, "a signed counter of 16 bits in milliseconds"),
    (60.0, "the seconds of a minute"),
    (65.536, "a counter of 16 bits in milliseconds"),
    (2_147.483_648, "a signed counter of 32 bits in microseconds"),
    (3_600.0, "minutes and seconds of an hour"),
    (4_294.967_296, "a counter of 32 bits in microseconds"),
    (65_536.0, "a counter of 16 bits in seconds, or in milliseconds if the unit of the column is wrong"),
    (86_400.0, "the time of day past midnight"),
    (2_147_483.648, "a signed counter of 32 bits in milliseconds"),
    (4_294_967.296, "a counter of 32 bits in milliseconds"),
];

/// What a sidecar declares of a clock that goes back.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ClockJumps {
    /// Period at which the counter of the times wraps around, s.
    pub wraps_s: Option<f64>,
    /// Whether the log is split where its clock goes back.
    pub is_split: bool,
}

impl ClockJumps {
    pub(crate) fn read(root: &Section<'_>) -> Result<Self, RecordError> {
        let wraps_s = root.positive("clock_wraps", Dimension::TIME)?;
        let is_split = root.flag("split_at_clock_jumps")?.unwrap_or(false);
        let both = "and clock_wraps exclude each other: write the one that is meant";
        root.refuse("split_at_clock_jumps", is_split && wraps_s.is_some(), both)?;
        Ok(Self { wraps_s, is_split })
    }
}

/// Times in order, with what was done for it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct InOrder {
    /// Rows of the table that they are of.
    pub rows: Range<usize>,
    /// Times that do not decrease, s.
    pub time_s: Vec<f64>,
    /// What was done.
    pub done: Option<String>,
}

/// The step by which times go on across a wrap, s; `None` where the counter would have skipped more than a tenth of its period.
fn across_wrap(before_s: f64, now_s: f64, period_s: f64) -> Option<f64> {
    Some(now_s + period_s - before_s).filter(|step| *step > 0.0 && *step <= SKIPS * period_s)
}

/// Wraps of a counter of times, undone while a log goes by in parts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wraps {
    last_s: Option<f64>,
    turned_s: f64,
}

impl Wraps {
    /// Lets the times of the next part go on across each wrap, where one is declared.
    ///
    /// # Errors
    ///
    /// A step back that the declared period does not explain.
    pub fn undo(&mut self, part: &mut Table, jumps: ClockJumps) -> Result<(), RecordError> {
        let Some(period_s) = jumps.wraps_s else { return Ok(()) };
        let places: Vec<Place> = (0..part.n_rows).map(|row| part.place_of_row(row)).collect();
        let time = part.columns.iter_mut().find(|column| column.name == "time");
        let Some(Column { data: ColumnData::Number { si, .. }, .. }) = time else { return Ok(()) };
        for (t, place) in si.iter_mut().zip(places) {
            let now = *t;
            if let Some(before) = self.last_s.replace(now).filter(|before| now < *before) {
                across_wrap(before, now, period_s).ok_or_else(|| not_a_wrap(place, before, now, period_s))?;
                self.turned_s += period_s;
            }
            *t += self.turned_s;
        }
        Ok(())
    }
}

/// Times that do not go back, by what is declared.
///
/// # Errors
///
/// A step back that is not declared, or does not fit the declared period.
pub(crate) fn in_order(table: &Table, stamps_s: &[f64], declared: ClockJumps) -> Result<InOrder, RecordError> {
    let back: Vec<usize> = (1..stamps_s.len()).filter(|&i| stamps_s[i] < stamps_s[i - 1]).collect();
    let Some(&first) = back.first() else {
        return Ok(InOrder { rows: 0..stamps_s.len(), time_s: stamps_s.to_vec(), done: None });
    };
    let place = |row: usize| table.place_of_row(row);
    if let Some(period_s) = declared.wraps_s {
        let (mut time_s, mut turned_s) = (Vec::with_capacity(stamps_s.len()), 0.0);
        for (row, &now) in stamps_s.iter().enumerate() {
            if row > 0 && now < stamps_s[row - 1] {
                let before = stamps_s[row - 1];
                if across_wrap(before, now, period_s).is_none() {
                    return Err(not_a_wrap(place(row), before, now, period_s));
                }
                turned_s += period_s;
            }
            time_s.push(now + turned_s);
        }
        let done = format!(
            "its clock wraps every {} s, as declared: {}, the first before {}",
            plain(period_s, 9),
            counted(back.len(), "wrap is undone", "wraps are undone"),
            place(first)
        );
        return Ok(InOrder { rows: 0..stamps_s.len(), time_s, done: Some(done) });
    }
    if !declared.is_split {
        return Err(goes_back(table, stamps_s, &back));
    }
    let ends = back.iter().copied().chain([stamps_s.len()]);
    let starts = std::iter::once(0).chain(back.iter().copied());
    let longest = starts.zip(ends).map(|(from, to)| from..to).max_by_key(ExactSizeIterator::len);
    let rows = longest.unwrap_or(0..stamps_s.len());
    let done = format!(
        "its clock goes back {}, first from {} s to {} s in {}, and the log is split there, as declared: of {} stretches the longest is used, {} \
         of {}, from {} on; cut the log to use the others",
        if back.len() == 1 { "once".to_owned() } else { format!("{} times", back.len()) },
        plain(stamps_s[first - 1], 9),
        plain(stamps_s[first], 9),
        place(first),
        back.len() + 1,
        rows.len(),
        counted(stamps_s.len(), "row", "rows"),
        place(rows.start)
    );
    Ok(InOrder { time_s: stamps_s[rows.clone()].to_vec(), rows, done: Some(done) })
}

/// The error for a clock that goes back in some rows.
fn goes_back(table: &Table, stamps_s: &[f64], back: &[usize]) -> RecordError {
    let Some(&row) = back.first() else { return RecordError::NoRows { path: table.path.clone() } };
    let usual_s = usual_step_s(&stamps_s[..row]).unwrap_or(0.0);
    let (before, now) = (stamps_s[row - 1], stamps_s[row]);
    if back.len() as f64 > OUT_OF_ORDER * stamps_s.len() as f64 && back.len() > 2 {
        let problem = format!(
            "is {now} s after {before} s, and goes back in {} of {} rows: the rows are not in the order of their times. Sort them by time if each row has the \
             stamp of its sample; if several logs lie in one file, cut it",
            back.len(),
            stamps_s.len()
        );
        return RecordError::value(table.place_of_row(row), "time", problem);
    }
    clock_back(table.place_of_row(row), before, now, usual_s)
}

/// The error for a clock that goes back between two rows of steps that are usually `usual_s`: which counter it may be, and what to declare.
#[must_use]
pub fn clock_back(place: Place, before_s: f64, now_s: f64, usual_s: f64) -> RecordError {
    let sidecar = format!(
        "at the head of its sidecar, {} or the one of the folder whose `files` covers it (to create one: schema = 1, this line, and [columns] with each header)",
        place.path.with_extension("toml").display()
    );
    let fits = |(period_s, _): &&(f64, &str)| {
        across_wrap(before_s, now_s, *period_s).is_some_and(|step| step <= GAP * usual_s) && before_s < *period_s
    };
    let problem = match COUNTERS.iter().find(fits) {
        Some((period_s, what)) => format!(
            "is {now_s} s after {before_s} s: {what} wraps around there, and goes on by {} s as usual. Write clock_wraps = \"{} s\" {sidecar}; do not sort \
             the rows",
            plain(now_s + period_s - before_s, 4),
            plain(*period_s, 10)
        ),
        None => format!(
            "is {now_s} s after {before_s} s: the clock was set back by {} s, or a second log begins there; no common counter wraps at this value. Write \
             split_at_clock_jumps = true {sidecar} to use the longest stretch between such jumps, or cut the log there; a counter with another \
             period is declared as clock_wraps = \"… s\". Do not sort the rows: that would mix both stretches",
            plain(before_s - now_s, 6)
        ),
    };
    RecordError::value(place, "time", problem)
}

/// The error for a step back that the declared period does not explain.
fn not_a_wrap(place: Place, before_s: f64, now_s: f64, period_s: f64) -> RecordError {
    let problem = format!(
        "is {now_s} s after {before_s} s, which is not a wrap of the declared {} s: the step would be {} s. Correct clock_wraps, or cut the log there",
        plain(period_s, 9),
        plain(now_s + period_s - before_s, 6)
    );
    RecordError::value(place, "time", problem)
}

/// The error for two rows of one time that no even rate explains.
#[must_use]
pub fn twice(place: Place, time_s: f64) -> RecordError {
    let problem = format!(
        "is {time_s} s as in the row before, and rounding at an even rate does not explain it: delete the row if it was logged \
         twice, or log the time with more digits"
    );
    RecordError::value(place, "time", problem)
}
