//! Joins the log of a second program, with a clock of its own, to a log.
//!
//! Lag and drift are declared, or found from a channel that both recorded ([`froude_signal::lag`]). The columns of the second are then read at the rows of the first: by a cubic spline
//! between samples, after means of as many of them as make a step of the first; samples that repeat stay as they are, so that a clipped one is still seen. Rows outside of the second, or in a gap of it, are left
//! out: nothing is extrapolated, and a gap remains a gap.

use std::ops::Range;

use froude_signal::block_mean::BlockMean;
use froude_signal::lag::{Known, Lag, LagError, Record, find};
use froude_signal::resample::Spline;

use crate::error::{Place, RecordError};
use crate::finding::{Finding, Severity};
use crate::join_keys::Join;
use crate::nearest::suggestion;
use crate::number::{plain, significant};
use crate::run::clock_jumps::ClockJumps;
use crate::run::log_times::LogTimes;
use crate::run::stamps::gaps;
use crate::run::step::Step;
use crate::sidecar::Sidecar;
use crate::table::{Column, ColumnData, Joined, Table};
use crate::text::counted;
use crate::units::Dimension;

/// Half-width of a 95 % interval in standard uncertainties.
const COVERAGE: f64 = 1.96;
/// A lag that is declared beside `same` is looked for within so many standard uncertainties.
const WITHIN: f64 = 3.0;
/// Fewest rows that two logs have in common.
const FEWEST: usize = 20;
/// Part of the rows below which a join is doubtful.
const FEW: f64 = 0.5;
/// Part by which two channels of one quantity may differ in size.
const UNLIKE: f64 = 0.05;
/// The name of the finding.
const CODE: &str = "logs-joined";

/// Joins `other` to `table`, whose clock may go back as `jumps` declares; returns the rows that are left.
pub(crate) fn join(
    table: &mut Table,
    jumps: ClockJumps,
    other: &Table,
    own: Option<&Sidecar>,
    declared: &Join,
) -> Result<Vec<usize>, RecordError> {
    let times = LogTimes::of(table, jumps)?;
    let theirs = LogTimes::of(other, own.map(|own| own.run.declared.jumps).unwrap_or_default())?;
    let names = [&table.path, &other.path].map(|p| p.file_name().unwrap_or_default().to_string_lossy().into_owned());
    let (lag, how, is_one_quantity) = match &declared.same {
        Some(same) => found((table, &times), (other, &theirs), same, declared, &names)?,
        None => (stated(declared, &times, &theirs), "as declared".to_owned(), false),
    };
    let own_times: Vec<f64> = theirs.time_s.iter().map(|s| lag.time_s(*s)).collect();
    let averaged = (times.steps.median_s / theirs.steps.median_s).round().max(1.0) as usize;
    let parts = parts(&own_times);
    let at =
        |rows: &[f64]| -> Vec<f64> { parts.iter().flat_map(|part| means(&rows[part.clone()], averaged)).collect() };
    let knots = at(&own_times);
    // Parts may have lost all that is no whole block.
    let knot_parts = parts_of(&parts, averaged);
    let spanned = |t: f64| knot_parts.iter().position(|p| knots[p.start] <= t && t <= knots[p.end - 1]);
    let kept: Vec<usize> = (0..times.time_s.len()).filter(|row| spanned(times.time_s[*row]).is_some()).collect();
    if kept.len() < FEWEST {
        let ends = |t: &[f64]| format!("{} s to {} s", plain(t[0], 9), plain(t[t.len() - 1], 9));
        let problem = format!(
            "{} and {} overlap in only {}, and {FEWEST} are needed: by lag and drift, {} goes from {}, and {} from {} of the same clock; correct lag (stamp of {} less the time in {}), drift and origin",
            names[0],
            names[1],
            counted(kept.len(), "row", "rows"),
            names[1],
            ends(&own_times),
            names[0],
            ends(&times.time_s),
            names[1],
            names[0]
        );
        return Err(RecordError::value(declared.place.clone(), "lag", problem));
    }
    // A mean over q samples τ apart is f + (q² − 1) τ² f''/24: that is undone, since the joined channels alone would lose amplitude, (πfh)²/6 of it.
    let spread_s2 = ((averaged * averaged - 1) as f64) * theirs.steps.median_s.powi(2) / 24.0;
    let mut columns = Vec::new();
    for column in &other.columns {
        let is_compared = declared.same.as_ref().is_some_and(|[_, there]| *there == column.name);
        if column.name == "time" || is_compared {
            continue;
        }
        let ColumnData::Number { unit, dimension, si } = &column.data else {
            let problem =
                format!(": texts of {} cannot be read at the rows of {}; leave the column out", names[1], names[0]);
            return Err(RecordError::column(Place::whole(&other.path), &column.name, problem));
        };
        if table.columns.iter().any(|own| own.name == column.name) {
            let problem = format!(
                ": both {} and {} have it; leave it out of the columns of one, or name both in `same` if they show one thing",
                names[0], names[1]
            );
            return Err(RecordError::column(declared.place.clone(), &column.name, problem));
        }
        let values = at(&si[theirs.rows.clone()]);
        let splines: Vec<Option<Spline<'_>>> =
            knot_parts.iter().map(|p| Spline::through(&knots[p.clone()], &values[p.clone()]).ok()).collect();
        let read = |row: &usize| {
            let t = times.time_s[*row];
            let k = knots.partition_point(|knot| *knot <= t).clamp(1, knots.len() - 1);
            if values[k - 1] == values[k] {
                return values[k];
            }
            let read = spanned(t).and_then(|p| splines[p].as_ref()?.with_derivatives_at(t));
            read.map_or(values[k], |[value, _, second]| value - spread_s2 * second)
        };
        let si = kept.iter().map(read).collect();
        let data = ColumnData::Number { unit: unit.clone(), dimension: *dimension, si };
        columns.push(Column { name: column.name.clone(), data });
    }
    if columns.is_empty() {
        let problem = format!("{} has no column that {} lacks: there is nothing to join", names[1], names[0]);
        return Err(RecordError::value(declared.place.clone(), "file", problem));
    }
    let taken: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
    let words = words(&lag, &how, &names, &[&times, &theirs], (&taken, averaged), kept.len());
    let rows: Vec<usize> = kept.iter().map(|row| times.rows.start + row).collect();
    let mut findings = findings(&lag, &words, [&times, &theirs], kept.len(), table);
    findings.extend(declared.same.as_ref().filter(|_| is_one_quantity).and_then(|same| differs(&lag, same, &names)));
    keep(table, &rows);
    table.columns.extend(columns);
    let step = Step::new("join", "", words).with("lag", lag.lag_s, "s").with("drift", lag.drift, "1");
    let step = step.with("origin", lag.origin_s, "s").with("standard_of_lag", lag.standard[0], "s");
    let step = step.with("standard_of_drift", lag.standard[1], "1").with("left", lag.left_s, "s");
    let step = step.with("standard_uncertainty", lag.standard_s(), "s");
    let step = step.with("from", lag.overlap_s[0], "s").with("to", lag.overlap_s[1], "s");
    let sidecar = own.filter(|own| own.path != declared.place.path).map(|own| own.path.clone());
    table.joined.push(Joined { path: other.path.clone(), sidecar, columns: taken, lag, step, findings });
    Ok(rows)
}

/// Stretches of rows between gaps that a spline can be drawn through.
fn parts(time_s: &[f64]) -> Vec<Range<usize>> {
    let starts = gaps(time_s).into_iter().map(|[_, after]| after);
    let starts: Vec<usize> = std::iter::once(0).chain(starts).collect();
    let ends = starts.iter().skip(1).copied().chain([time_s.len()]);
    starts.iter().copied().zip(ends).map(|(from, to)| from..to).collect()
}

/// The stretches of the means of such stretches; those of fewer than four are empty and span nothing.
fn parts_of(parts: &[Range<usize>], averaged: usize) -> Vec<Range<usize>> {
    let mut end = 0;
    let mut of = |part: &Range<usize>| {
        let n = part.len() / averaged;
        end += n;
        end - n..end
    };
    parts.iter().map(&mut of).filter(|part| part.len() >= 4).collect()
}

fn means(values: &[f64], averaged: usize) -> Vec<f64> {
    let mut out = Vec::new();
    BlockMean::of(averaged).push(values, &mut out);
    out
}

/// Lag and drift as they are declared.
fn stated(declared: &Join, times: &LogTimes, theirs: &LogTimes) -> Lag {
    let [lag, drift] = [declared.lag_s, declared.drift].map(Option::unwrap_or_default);
    let ends = |t: &[f64]| [t.first().copied().unwrap_or(0.0), t.last().copied().unwrap_or(0.0)];
    let (own, [first, last]) = (ends(&times.time_s), ends(&theirs.time_s));
    let out = Lag {
        lag_s: lag.value,
        drift: drift.value,
        origin_s: declared.origin_s.unwrap_or(first),
        standard: [lag.standard_uncertainty, drift.standard_uncertainty],
        left_s: 0.0,
        gain: f64::NAN,
        correlation: f64::NAN,
        overlap_s: own,
    };
    Lag { overlap_s: [own[0].max(out.time_s(first)), own[1].min(out.time_s(last))], ..out }
}

/// Lag and drift from what both recorded, how that was found, and whether both are of one quantity.
fn found(
    (table, times): (&Table, &LogTimes),
    (other, theirs): (&Table, &LogTimes),
    [here, there]: &[String; 2],
    declared: &Join,
    names: &[String; 2],
) -> Result<(Lag, String, bool), RecordError> {
    let (x, mine) = numbers(table, here, declared)?;
    let (y, other_dimension) = numbers(other, there, declared)?;
    let of = |log: &LogTimes| -> Vec<[f64; 2]> {
        let end = |t: Option<f64>, otherwise: f64| t.unwrap_or(otherwise);
        log.lost.iter().map(|gap| [end(gap.from_s, f64::NEG_INFINITY), end(gap.to_s, f64::INFINITY)]).collect()
    };
    let (own_gaps, their_gaps) = (of(times), of(theirs));
    let first = Record {
        time_s: &times.time_s,
        values: &x[times.rows.clone()],
        step_s: times.steps.median_s,
        gaps_s: &own_gaps,
    };
    let second = Record {
        time_s: &theirs.time_s,
        values: &y[theirs.rows.clone()],
        step_s: theirs.steps.median_s,
        gaps_s: &their_gaps,
    };
    let (derivative, is_one_quantity) = derivative(mine, other_dimension);
    let known = Known {
        lag_s: declared.lag_s.map(|lag| [lag.value, WITHIN * lag.standard_uncertainty]),
        drift: declared.drift.map(|drift| [drift.value, drift.standard_uncertainty]),
        derivative,
    };
    let lag = find(&first, &second, &known).map_err(|error| {
        let advice = advice(&error, names, declared);
        let problem = format!(
            "the clocks cannot be aligned from {here} of {} and {there} of {}: {error}. {advice}",
            names[0], names[1]
        );
        RecordError::value(declared.place.clone(), "same", problem)
    })?;
    let differentiated = match derivative {
        0 => String::new(),
        d => format!(
            " ({} differentiated {})",
            if d > 0 { here } else { there },
            if d.abs() == 1 { "once" } else { "twice" }
        ),
    };
    let how = format!(
        "from {here} and {there}{differentiated}, correlation {}, ratio {}",
        plain(lag.correlation, 3),
        significant(lag.gain, 3)
    );
    Ok((lag, how, is_one_quantity))
}

/// The numbers of a channel that is compared.
fn numbers<'t>(table: &'t Table, name: &str, declared: &Join) -> Result<(&'t [f64], Dimension), RecordError> {
    match table.columns.iter().find(|column| column.name == name).map(|column| &column.data) {
        Some(ColumnData::Number { si, dimension, .. }) => Ok((si, *dimension)),
        _ => {
            let numbers =
                table.columns.iter().filter(|c| matches!(c.data, ColumnData::Number { .. }) && c.name != "time");
            let near = suggestion(name, numbers.map(|column| column.name.as_str()));
            let problem = format!("names {name:?}, which {} does not have as numbers; {near}", table.path.display());
            Err(RecordError::value(declared.place.clone(), "same", problem))
        }
    }
}

/// How often the first is differentiated to be the second, by their dimensions, and whether it then is: they differ by time alone.
fn derivative(first: Dimension, second: Dimension) -> (i32, bool) {
    let by_time = i32::from(first.s) - i32::from(second.s);
    let is_one = (Dimension { s: 0, ..first }) == (Dimension { s: 0, ..second }) && by_time.abs() <= 2;
    (if is_one { by_time } else { 0 }, is_one)
}

/// What to do, and what to write.
fn advice(error: &LagError, names: &[String; 2], declared: &Join) -> String {
    let about = |lag_s: f64, standard_s: f64| {
        format!(
            "lag = {{ value = \"{} s\", standard = \"{} s\" }}",
            rounded(lag_s, standard_s),
            significant(standard_s, 2)
        )
    };
    match error {
        LagError::Ambiguous { lag_s, other_s } => format!(
            "A motion that repeats fits as well a period later. State where the lag lies (stamp of {} less the time in {} at its first sample), to less than half of that difference: {}",
            names[1],
            names[0],
            about(*lag_s, (lag_s - other_s).abs() / 8.0)
        ),
        LagError::DriftOpen { .. } => "State the drift: drift = { value = \"0 ppm\", standard = \"50 ppm\" } is that of two good quartz clocks of which nothing else is known".to_owned(),
        LagError::Opposite { .. } => "Correct the `sign` of one of them in [columns]".to_owned(),
        LagError::AtTheEnd { .. } => "Correct lag, or give it a larger standard uncertainty: it is looked for within three of them".to_owned(),
        LagError::Jump { time_s, .. } => format!("A clock was set, or one log lost samples that its stamps do not show: cut both logs near {} s of {}", plain(*time_s, 6), names[0]),
        LagError::NotLinear { .. } => "Log both with one clock, or name a channel that both recorded better".to_owned(),
        LagError::DriftContradicted { .. } => "Correct drift, or leave it out, so that it is found".to_owned(),
        LagError::Record(_) => "Name another pair in `same`, or state lag and drift without it".to_owned(),
        LagError::Undetermined => "Name a pair that moves to and fro, or state lag and drift".to_owned(),
        _ if declared.lag_s.is_some() => "Correct lag, name another pair in `same`, or state lag and drift without it".to_owned(),
        _ => format!(
            "The logs may be of two runs, overlap in less than half of the shorter one, or a clock was set. Name another pair in `same`; state where the lag lies (stamp of {} less the time in {}): {}; or state lag and drift without `same`",
            names[1],
            names[0],
            about(0.0, 1.0)
        ),
    }
}

fn words(
    lag: &Lag,
    how: &str,
    names: &[String; 2],
    [times, theirs]: &[&LogTimes; 2],
    (taken, averaged): (&[String], usize),
    kept: usize,
) -> String {
    let length = |log: &LogTimes| log.time_s.last().unwrap_or(&0.0) - log.time_s.first().unwrap_or(&0.0);
    let common = lag.overlap_s[1] - lag.overlap_s[0];
    let means = if averaged > 1 { format!("as means of {averaged} samples, ") } else { String::new() };
    let left = if lag.left_s > 0.0 {
        format!("; the clocks wander about that by {} ms (rms), which is counted", significant(1e3 * lag.left_s, 2))
    } else {
        String::new()
    };
    format!(
        "stamps of {} read {} s ± {} ms more than the time in {} (at the stamp {} s), and gain {} ± {} ppm on it (95 %, {how}){left}; {} s are common to both ({} s and {} s long), {} of {} rows of {} are used; {} read there {means}by a cubic spline",
        names[1],
        rounded(lag.lag_s, lag.standard[0]),
        significant(1e3 * COVERAGE * lag.standard[0], 2),
        names[0],
        plain(lag.origin_s, 6),
        rounded(1e6 * lag.drift, 1e6 * lag.standard[1]),
        significant(1e6 * COVERAGE * lag.standard[1], 2),
        plain(common, 4),
        plain(length(times), 4),
        plain(length(theirs), 4),
        kept,
        times.time_s.len(),
        names[0],
        taken.join(", ")
    )
}

/// That two channels which show one quantity differ in size by more than their noise explains.
fn differs(lag: &Lag, [here, there]: &[String; 2], names: &[String; 2]) -> Option<Finding> {
    let noise = 1.0 - lag.correlation * lag.correlation;
    let text = || {
        format!(
            "{there} of {} is {} times {here} of {} where both are of one quantity: calibrate them, or correct the unit of one",
            names[1],
            significant(lag.gain, 3),
            names[0]
        )
    };
    ((lag.gain - 1.0).abs() > UNLIKE + 2.0 * noise)
        .then(|| Finding::new(Severity::Warning, "joined-channels-differ", text()))
}

fn findings(lag: &Lag, words: &str, [times, theirs]: [&LogTimes; 2], kept: usize, table: &Table) -> Vec<Finding> {
    let is_few = (kept as f64) < FEW * times.time_s.len() as f64;
    let severity = if is_few || lag.left_s > 0.0 { Severity::Warning } else { Severity::Note };
    let place = Some(table.path.display().to_string());
    let joined = Finding { place, ..Finding::new(severity, CODE, words.to_owned()) };
    // What was found in the first log's stamps is found again in those that are left, but for what was cut.
    let cut = times.findings.iter().filter(|finding| finding.code == "clock-split");
    let of_other = theirs.findings.iter().filter(|finding| finding.code != "time-steps");
    std::iter::once(joined).chain(cut.chain(of_other).cloned()).collect()
}

/// A number to a tenth of the leading digit of its standard uncertainty.
fn rounded(x: f64, standard: f64) -> String {
    let unit = 10.0_f64.powf((standard.log10()).floor() - 1.0);
    if unit.is_normal() { plain((x / unit).round() * unit, 12) } else { plain(x, 12) }
}

/// Leaves these rows of a table, in order.
fn keep(table: &mut Table, rows: &[usize]) {
    for column in &mut table.columns {
        match &mut column.data {
            ColumnData::Number { si, .. } => *si = rows.iter().filter_map(|row| si.get(*row).copied()).collect(),
            ColumnData::Text(texts) => *texts = texts.subset(rows),
        }
    }
    table.line_of_row = rows.iter().map(|row| table.line_of_row.get(*row).copied().unwrap_or(row + 1)).collect();
    table.n_rows = rows.len();
}
