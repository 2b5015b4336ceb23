//! Which part of a log is looked at: the declared test, without what is marked.

use std::ops::Range;

use crate::findings::warning;
use crate::log::TankLog;
use crate::names::{EXCITED_RESPONSE, FREE_DECAY, WEIGHT_TOW};
use froude_identify::method::MethodError;
use froude_records::finding::Finding;
use froude_records::number::plain;
use froude_records::run::RunLog;
use froude_records::run::marks::{Mark, Segment, SegmentKind};
use froude_records::run::stamps::GAP;
use froude_records::run::step::Step;
use froude_records::text::counted;

/// Methods whose windows do not leave marks out themselves: a log is cut to its longest stretch without one.
pub const MARK_UNAWARE: [&str; 2] = [FREE_DECAY, EXCITED_RESPONSE];
/// Fewest samples that are a log.
const FEWEST: usize = 4;

/// Marks the gaps of a log, so that no window runs across them; missing ticks that are fewer than a gap are left. Where channels are read by a spline, the samples at
/// either end of a gap are marked too. A weight tow has one motion, which is fitted to the samples on both sides.
pub(super) fn mark_gaps(run: &mut TankLog, method: &str, is_resampled: bool) {
    if method == WEIGHT_TOW && !is_resampled {
        return;
    }
    let longest_s = GAP * run.steps.median_s;
    let ends = run.log.lost.iter().filter_map(|gap| Some((gap.from_s?, gap.to_s?, gap.ticks)));
    let marks = ends.filter(|(from_s, to_s, _)| to_s - from_s > longest_s).map(|(from_s, to_s, ticks)| {
        let (from_s, to_s) = if is_resampled { (from_s, to_s) } else { (from_s.next_up(), to_s.next_down()) };
        let ticks = ticks.map_or(0, |ticks| ticks as usize);
        let by = format!("rule: {} missing", counted(ticks, "tick is", "ticks are"));
        Mark { from_s, to_s, why: "dropped".to_owned(), by, note: String::new() }
    });
    run.declared.marks.extend(marks);
}

/// Cuts a log to its declared test and, where the method does not leave marks out itself, to its longest stretch without one.
///
/// # Errors
///
/// Nothing is left.
pub fn cut(run: &mut TankLog, method: &str) -> Result<(), MethodError> {
    let segments: Vec<Segment> = run.declared.segments.clone();
    for segment in &segments {
        let by = if segment.by.is_empty() { String::new() } else { format!(", by {}", segment.by) };
        let words = format!(
            "{} from {} s to {} s{by}{}",
            segment.kind.name(),
            plain(segment.from_s, 6),
            plain(segment.to_s, 6),
            note(&segment.note)
        );
        run.done.push(step_of("segment", words, segment.from_s, segment.to_s));
        if segment.kind == SegmentKind::Test {
            let rows = rows(&run.log.time_s, segment.from_s, segment.to_s);
            if rows.len() < FEWEST {
                let what = format!(
                    "the segment test, from {} s to {} s, has {}; the log goes from {} s to {} s: correct [[segments]]",
                    plain(segment.from_s, 6),
                    plain(segment.to_s, 6),
                    counted(rows.len(), "sample", "samples"),
                    plain(run.log.time_s.first().copied().unwrap_or(0.0), 6),
                    plain(run.log.time_s.last().copied().unwrap_or(0.0), 6)
                );
                return Err(MethodError::input(&run.log.path, what));
            }
            keep_rows(&mut run.log, rows);
        }
    }
    // What a rule clipped is a step already.
    let told = run.declared.marks.iter().filter(|mark| mark.why != "clipped" || !mark.by.starts_with("rule: "));
    let steps: Vec<Step> = told
        .map(|mark| {
            let is_in = run.log.time_s.first().zip(run.log.time_s.last()).is_some_and(|(a, b)| mark.touches(*a, *b));
            let words = format!(
                "{} s to {} s {}: {}, by {}{}",
                plain(mark.from_s, 6),
                plain(mark.to_s, 6),
                if is_in { "are not used" } else { "lie beyond what is looked at" },
                mark.why,
                mark.by,
                note(&mark.note)
            );
            step_of("mark", words, mark.from_s, mark.to_s)
        })
        .collect();
    run.done.extend(steps);
    if !MARK_UNAWARE.contains(&method) || run.declared.marks.is_empty() {
        return Ok(());
    }
    let n = run.log.time_s.len();
    let Some(rows) = longest_free(&run.log.time_s, 0..n, &run.declared.marks).filter(|rows| rows.len() >= FEWEST)
    else {
        let what = format!("nothing is left of it: {}", in_words(&run.declared.marks));
        return Err(MethodError::input(&run.log.path, what));
    };
    if rows.len() < n {
        let (from_s, to_s) = (run.log.time_s[rows.start], run.log.time_s[rows.end - 1]);
        let words = format!(
            "{} s to {} s, the longest stretch without a mark, are used ({})",
            plain(from_s, 6),
            plain(to_s, 6),
            counted(rows.len(), "sample", "samples")
        );
        let text = format!("{}: {words}: {}", run.log.path.display(), in_words(&run.declared.marks));
        run.findings.push(warning("marks-left-out", text));
        run.done.push(step_of("cut", words, from_s, to_s));
        keep_rows(&mut run.log, rows);
    }
    Ok(())
}

/// Marks beyond the log: a slip of the pen, another clock, or another log's.
pub(super) fn astray(log: &RunLog, marks: &[Mark]) -> Option<Finding> {
    let (from_s, to_s) = (*log.time_s.first()?, *log.time_s.last()?);
    let beyond: Vec<Mark> = marks.iter().filter(|mark| !mark.touches(from_s, to_s)).cloned().collect();
    (!beyond.is_empty()).then(|| {
        let text = format!(
            "{}: beyond the log ({} s to {} s) lies {}: nothing is left out there; correct [[marks]], in seconds of the log's own time",
            log.path.display(),
            plain(from_s, 6),
            plain(to_s, 6),
            in_words(&beyond)
        );
        warning("mark-beyond-log", text)
    })
}

fn note(note: &str) -> String {
    if note.is_empty() { String::new() } else { format!(" ({note})") }
}

fn step_of(step: &str, words: String, from_s: f64, to_s: f64) -> Step {
    Step::new(step, "", words).with("from", from_s, "s").with("to", to_s, "s")
}

/// Marks in words, for a message: how many, and the first of them.
#[must_use]
pub fn in_words(marks: &[Mark]) -> String {
    let Some(first) = marks.first() else { return "no mark".to_owned() };
    format!(
        "{}, the first from {} s to {} s, {} by {}{}",
        counted(marks.len(), "mark", "marks"),
        plain(first.from_s, 6),
        plain(first.to_s, 6),
        first.why,
        first.by,
        note(&first.note)
    )
}

/// Rows from a time to a time, both included.
#[must_use]
pub fn rows(time_s: &[f64], from_s: f64, to_s: f64) -> Range<usize> {
    let start = time_s.partition_point(|t| *t < from_s);
    start..time_s.partition_point(|t| *t <= to_s).max(start)
}

/// The marks that touch rows.
#[must_use]
pub fn touching(time_s: &[f64], rows: &Range<usize>, marks: &[Mark]) -> Vec<Mark> {
    if rows.is_empty() {
        return Vec::new();
    }
    let (from_s, to_s) = (time_s[rows.start], time_s[rows.end - 1]);
    marks.iter().filter(|mark| mark.touches(from_s, to_s)).cloned().collect()
}

/// Parts of rows without a mark, in their order; a mark between two samples parts them too.
#[must_use]
pub fn free(time_s: &[f64], within: Range<usize>, marks: &[Mark]) -> Vec<Range<usize>> {
    if within.is_empty() {
        return Vec::new();
    }
    let mut cuts: Vec<(usize, usize)> = (marks.iter())
        .map(|mark| {
            let rows = rows(time_s, mark.from_s, mark.to_s);
            (rows.start.clamp(within.start, within.end), rows.end.clamp(within.start, within.end))
        })
        .collect();
    cuts.sort_unstable();
    let (mut out, mut from) = (Vec::new(), within.start);
    for (start, end) in cuts {
        if start > from {
            out.push(from..start);
        }
        from = from.max(end);
    }
    if from < within.end {
        out.push(from..within.end);
    }
    out
}

/// The longest part of rows without a mark, the first of several.
#[must_use]
pub fn longest_free(time_s: &[f64], within: Range<usize>, marks: &[Mark]) -> Option<Range<usize>> {
    let parts = free(time_s, within, marks);
    let most = parts.iter().map(ExactSizeIterator::len).max()?;
    parts.into_iter().find(|rows| rows.len() == most)
}

/// The part of a still run that is used: the one that is named, without marks.
pub(crate) fn still_part(log: &TankLog) -> Result<Range<usize>, MethodError> {
    let (time_s, declared) = (&log.log.time_s, &log.declared);
    let named = declared.segments.iter().find(|segment| segment.kind == SegmentKind::Still);
    let whole = named.map_or(0..time_s.len(), |segment| rows(time_s, segment.from_s, segment.to_s));
    longest_free(time_s, whole, &declared.marks).filter(|rows| rows.len() >= FEWEST).ok_or_else(|| {
        let what = format!("nothing is left of this still run: {}; take another", in_words(&declared.marks));
        MethodError::input(&log.log.path, what)
    })
}

/// Keeps that part of a still run.
///
/// # Errors
///
/// A sensor stood at the end of its range: what is left would be the lower part of its noise.
pub(crate) fn keep_still_part(log: &mut TankLog) -> Result<(), MethodError> {
    if let Some(mark) = log.declared.marks.iter().find(|mark| mark.why == "clipped") {
        let what = format!(
            "a channel of this still run is clipped from {} s to {} s: hold the body where the load cell does not reach its end",
            plain(mark.from_s, 4),
            plain(mark.to_s, 4)
        );
        return Err(MethodError::input(&log.log.path, what));
    }
    let rows = still_part(log)?;
    keep_rows(&mut log.log, rows);
    Ok(())
}

/// Keeps rows of a log.
pub(super) fn keep_rows(log: &mut RunLog, rows: Range<usize>) {
    let (Some(&from_s), Some(&to_s)) = (log.time_s.get(rows.start), log.time_s.get(rows.end.saturating_sub(1))) else {
        return;
    };
    *log = log.between(from_s, to_s.next_up());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(from_s: f64, to_s: f64) -> Mark {
        Mark { from_s, to_s, why: "outlier".to_owned(), by: "a test".to_owned(), note: String::new() }
    }

    #[test]
    fn a_mark_beyond_the_log_is_said() {
        let log = RunLog { time_s: vec![0.0, 1.0, 2.0], ..RunLog::default() };
        assert_eq!(astray(&log, &[mark(1.2, 1.4), mark(-1.0, 0.0)]), None);
        let found = astray(&log, &[mark(1.2, 1.4), mark(120.0, 125.0)]).unwrap();
        assert!(found.message.contains("1 mark, the first from 120 s to 125 s"), "{}", found.message);
    }

    #[test]
    fn what_is_free_of_marks_is_what_lies_between_them() {
        let time_s: Vec<f64> = (0..10).map(f64::from).collect();
        let marks = [mark(6.0, 6.5), mark(2.0, 3.0)];
        assert_eq!(free(&time_s, 0..10, &marks), [0..2, 4..6, 7..10]);
        assert_eq!(free(&time_s, 3..7, &marks).first(), Some(&(4..6)));
        assert_eq!(longest_free(&time_s, 0..10, &marks), Some(7..10));
        assert_eq!(longest_free(&time_s, 0..10, &[mark(-1.0, 20.0)]), None);
        // Between samples: nothing is lost, and no window runs across.
        assert_eq!(free(&time_s, 0..10, &[mark(4.2, 4.8)]), [0..5, 5..10]);
        assert_eq!(touching(&time_s, &(0..5), &marks).len(), 1);
    }
}
