//! A servo's log of more rows than are kept: rigid models, read in chunks in bounded memory.
//!
//! Twice through the file: once for its clock, whose step every filter needs, and once for all models together ([`LongServo`]); where steps are uneven or samples
//! missing, through even times ([`Evener`]). Coefficients
//! are those of the log in memory for a delay within a step; the intervals are those of HAC with the lag of a block, since blocks would need all rows at once. There is
//! no test of whiteness and no figure of the force.

use std::collections::VecDeque;
use std::path::Path;

use froude_identify::answer::Made;
use froude_identify::large::MOST_KEPT;
use froude_identify::method::{Found, MethodError};
use froude_identify::wild;
use froude_records::block::{Block, Section};
use froude_records::chunks::{for_each_chunk, has_more_rows};
use froude_records::finding::{Finding, Severity};
use froude_records::number;
use froude_records::run::clock_jumps::{ClockJumps, Wraps, clock_back};
use froude_records::run::stamps::{GAP, LACKS, usual_step_s};
use froude_records::run::{LogTimes, Missing, TimeSteps, steps_finding};
use froude_records::sidecar_file::sidecar_of;
use froude_records::table::Table;
use froude_records::units::Dimension;

use super::page::{Pieces, coefficient_table, with_declared};
use super::{ANOTHER_LOG, AxisModel, friction_of, one_excitation};
use crate::runs::implausible;
use crate::servo::log::{is_even, rate_of};
use crate::servo::scale::ForcePerVolt;
use crate::servo::{Chain, LongServo, ServoError, record};

/// Whether a log has more rows than are kept.
pub(super) fn is_long(path: &Path) -> bool {
    has_more_rows(path, MOST_KEPT)
}

/// Steps of the clock, s.
struct Clock {
    rows: usize,
    first_s: f64,
    last_s: f64,
    shortest_s: f64,
    longest_s: f64,
    /// Sum and number of the steps that lack no samples.
    whole: (f64, f64),
    missing: Missing,
}

/// A column of an axis, as `y/name` or by its name alone.
fn column<'t>(table: &'t Table, name: &str, dimension: Dimension) -> Result<&'t [f64], MethodError> {
    let of_axis = format!("y/{name}");
    let is_there = table.columns.iter().any(|column| column.name == of_axis);
    let values = table.number(if is_there { &of_axis } else { name }, dimension)?;
    match values.iter().position(|x| implausible(*x)) {
        None => Ok(values),
        Some(i) => {
            let what = format!(
                "{name} is {:e} {dimension} in line {}, which no axis has: the log is damaged, or its unit is wrong",
                values[i],
                table.line_of_row.get(i).copied().unwrap_or_default()
            );
            Err(MethodError::input(&table.path, what))
        }
    }
}

/// The parts of a log, each with its times: those of the stamps, or the even ones that these are the rounded ones of.
fn for_each_part(
    path: &Path,
    sidecar: Option<&Path>,
    each: &mut dyn FnMut(&Table, &[f64]) -> Result<(), MethodError>,
) -> Result<(), MethodError> {
    let jumps = sidecar_of(path, sidecar)?.map(|sidecar| sidecar.run.declared.jumps).unwrap_or_default();
    if jumps.is_split {
        let what = "split_at_clock_jumps is not available for a log that is read in chunks; cut the log where its clock was set";
        return Err(MethodError::input(path, what));
    }
    let mut wraps = Wraps::default();
    for_each_chunk(path, sidecar, &mut |mut table| {
        wraps.undo(&mut table, jumps)?;
        // A chunk of one row has no steps to look at.
        if table.n_rows < 2 {
            return each(&table, table.number("time", Dimension::TIME)?);
        }
        each(&table, &LogTimes::of(&table, ClockJumps::default())?.time_s)
    })
}

/// The clock of a log.
fn clock(path: &Path, sidecar: Option<&Path>) -> Result<Clock, MethodError> {
    let mut out = Clock {
        rows: 0,
        first_s: f64::NAN,
        last_s: f64::NAN,
        shortest_s: f64::INFINITY,
        longest_s: 0.0,
        whole: (0.0, 0.0),
        missing: Missing::default(),
    };
    for_each_part(path, sidecar, &mut |table, times| {
        let usual_s = usual_step_s(times);
        for (row, &time_s) in times.iter().enumerate() {
            if out.rows == 0 {
                out.first_s = time_s;
            } else {
                let step_s = time_s - out.last_s;
                // Parts are evened by themselves: where they meet, a little may be missing.
                if step_s <= 0.0 {
                    let place = table.place_of_row(row);
                    return Err(clock_back(place, out.last_s, time_s, usual_s.unwrap_or(0.0)).into());
                }
                (out.shortest_s, out.longest_s) = (out.shortest_s.min(step_s), out.longest_s.max(step_s));
                match usual_s.map(|usual| step_s / usual) {
                    Some(steps) if steps > GAP => {
                        let what = format!(
                            "has a gap of {} s before {}, and a log that is read in chunks is filtered as one piece: cut it there",
                            number::plain(step_s, 4),
                            table.place_of_row(row)
                        );
                        return Err(MethodError::input(path, what));
                    }
                    Some(steps) if steps > LACKS => out.missing.add((steps.round() as usize).saturating_sub(1)),
                    _ => out.whole = (out.whole.0 + step_s, out.whole.1 + 1.0),
                }
            }
            out.last_s = time_s;
            out.rows += 1;
        }
        out.missing.samples = out.rows;
        Ok(())
    })?;
    Ok(out)
}

impl Clock {
    /// Mean of the steps that lack no samples.
    fn step_s(&self) -> f64 {
        self.whole.0 / self.whole.1
    }

    fn is_even(&self) -> bool {
        [self.shortest_s, self.longest_s].into_iter().all(|step_s| is_even(step_s, self.step_s()))
    }

    fn finding(&self, path: &Path) -> Finding {
        let steps = TimeSteps { median_s: self.step_s(), shortest_s: self.shortest_s, longest_s: self.longest_s };
        let words = "position and command are read at even times, the position by a cubic through four samples, the command by straight lines";
        let even = (!self.is_even()).then(|| (Severity::Warning, words.to_owned()));
        steps_finding(steps, even, &self.missing, &[], &path.display().to_string())
    }
}

/// Reads position and command at even times while they go by.
struct Evener {
    step_s: f64,
    /// The next even time.
    next_s: f64,
    /// The last samples, four at most: time, position, command.
    last: VecDeque<[f64; 3]>,
}

impl Evener {
    /// Takes a sample; what lies between the middle two of the last four is read.
    fn take(&mut self, sample: [f64; 3], position_m: &mut Vec<f64>, command_v: &mut Vec<f64>) {
        self.last.push_back(sample);
        if self.last.len() > 4 {
            self.last.pop_front();
        }
        if let Some(&[to_s, ..]) = self.last.get(2).filter(|_| self.last.len() == 4) {
            self.read_to(to_s, position_m, command_v);
        }
    }

    /// Reads up to a time, from the cubic through the last samples.
    fn read_to(&mut self, to_s: f64, position_m: &mut Vec<f64>, command_v: &mut Vec<f64>) {
        while self.next_s <= to_s {
            let t = self.next_s;
            let cubic = self.last.iter().map(|[own, x, _]| {
                let others = self.last.iter().filter(|[s, ..]| s != own);
                others.map(|[s, ..]| (t - s) / (own - s)).product::<f64>() * x
            });
            position_m.push(cubic.sum());
            let after = self.last.iter().position(|[s, ..]| *s >= t).unwrap_or(self.last.len() - 1).max(1);
            if let (Some([a, _, u]), Some([b, _, v])) = (self.last.get(after - 1), self.last.get(after)) {
                command_v.push(u + (t - a) / (b - a) * (v - u));
            }
            self.next_s += self.step_s;
        }
    }
}

/// Rigid models of a long log, called `name`, whose volt is a force of `gain`.
pub(super) fn of_table(
    path: &Path,
    sidecar: Option<&Path>,
    (name, kind): (&str, &str),
    gain: &ForcePerVolt<'_>,
    asked: &[AxisModel],
) -> Result<Found, MethodError> {
    let clock = clock(path, sidecar)?;
    let refused = |error: ServoError| MethodError::input(path, error.to_string());
    let rate_hz = rate_of(clock.step_s()).map_err(refused)?;
    let rigid = asked.iter().filter_map(|model| Some((model.friction()?, friction_of(*model))));
    let mut under_way = rigid
        .map(|(words, friction)| Ok((words, LongServo::new(&Chain::of_log(gain.n_v, rate_hz, friction), rate_hz)?)))
        .collect::<Result<Vec<_>, ServoError>>()
        .map_err(refused)?;
    let mut evener = (!clock.is_even()).then(|| Evener {
        step_s: clock.step_s(),
        next_s: clock.first_s,
        last: VecDeque::with_capacity(5),
    });
    let mut push = |position_m: &[f64], command_v: &[f64]| {
        under_way.iter_mut().try_for_each(|(_, servo)| servo.push(position_m, command_v)).map_err(refused)
    };
    for_each_part(path, sidecar, &mut |table, times| {
        let position_m = column(table, "position", Dimension::LENGTH)?;
        let command_v = column(table, "command", Dimension::VOLTAGE)?;
        if let Some(what) = wild::sample_of("position", "m", times, position_m, &[]) {
            return Err(MethodError::input(path, format!("{what}; correct the sample, or cut the log there")));
        }
        let Some(evener) = &mut evener else { return push(position_m, command_v) };
        let (mut positions, mut commands) = (Vec::new(), Vec::new());
        for ((t, x), u) in times.iter().zip(position_m).zip(command_v) {
            evener.take([*t, *x, *u], &mut positions, &mut commands);
        }
        push(&positions, &commands)
    })?;
    if let Some(evener) = &mut evener {
        let (mut positions, mut commands) = (Vec::new(), Vec::new());
        evener.read_to(clock.last_s, &mut positions, &mut commands);
        push(&positions, &commands)?;
    }
    let text = format!(
        "the log has {} rows, more than the {} that are kept: it was read in chunks. Its intervals are those of HAC, with no test whether residuals \
         are white, and without a figure of the force",
        number::count(clock.rows),
        number::count(MOST_KEPT)
    );
    let mut out = Found {
        findings: vec![
            clock.finding(path),
            Finding::new(Severity::Note, "long-log", text),
            one_excitation(ANOTHER_LOG),
        ],
        ..Found::default()
    };
    let mut tables: Vec<Block> = Vec::new();
    for (words, servo) in under_way {
        let fit = servo.finish().map_err(refused)?;
        out.findings.extend(super::doubts(words, &fit));
        let mut estimate = record::rigid(name, words, &fit, gain);
        kind.clone_into(&mut estimate.kind);
        let caption = format!(
            "Rigid model, friction {words} (relative force error {}), {} rows at {} Hz, {}.",
            number::percent(fit.relative_force_error),
            number::count(fit.n_rows),
            number::plain(fit.rate_hz, 4),
            fit.pieces
        );
        let table = coefficient_table(&estimate.method.name, caption, &fit.coefficients, Pieces::Hac);
        tables.push(with_declared(table, &fit.coefficients, Some(&estimate)).into());
        let name = format!("{name}, {}", estimate.method.name);
        out.results.push(Made { name, estimate, files: super::files_of_table(path, sidecar) }.into());
    }
    out.summary = Some(Section::new("Axis by every model", tables));
    Ok(out)
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::*;
    use crate::axis::of_table as in_memory;

    /// The command lies on straight lines, so that the law is linear in a delay within a step, and chunks give what the steps in memory do, here for one of 0.4 of a step.
    /// Stamps of 1 µs over 205 s leave their rates 5e-9 apart, which a mass has twice.
    const TOLERANCE: f64 = 1e-8;
    /// Part of a step by which the force is later than its command.
    const LATE: f64 = 0.4;

    /// The clock's digits make its steps uneven by up to 1 µs, and the first one is not the mean: a rate by that one would show.
    const STEP_S: f64 = 1.000_37e-3;

    /// A cubic through samples with one missing in thirty is off by less than (ω h)⁴ of the amplitude.
    #[test]
    fn samples_between_others_are_read_at_even_times() {
        let mut evener = Evener { step_s: 0.01, next_s: 0.0, last: VecDeque::new() };
        let (mut x, mut u) = (Vec::new(), Vec::new());
        for i in (0..3000).filter(|i| i % 30 != 7) {
            let t = 0.01 * f64::from(i);
            evener.take([t, (2.0 * t).sin(), t], &mut x, &mut u);
        }
        evener.read_to(29.99, &mut x, &mut u);
        assert!((2999..=3000).contains(&x.len()) && u.len() == x.len(), "{}", x.len());
        for (i, (x, u)) in x.iter().zip(&u).enumerate() {
            let t = 0.01 * i as f64;
            assert!((x - (2.0 * t).sin()).abs() < 0.02_f64.powi(4) && (u - t).abs() < 1e-9, "{t}: {x} {u}");
        }
    }

    #[test]
    fn a_log_in_chunks_gives_what_it_gives_in_memory() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let mut text = "time [s],position [m],command [V]\n".to_owned();
        for i in 0..(MOST_KEPT + 5000) {
            let t = STEP_S * i as f64;
            let x = 0.2 * (1.3 * t).sin() + 0.1 * (3.1 * t).sin();
            let (stamp_s, t) = (t, t + LATE * STEP_S);
            let v = 0.26 * (1.3 * t).cos() + 0.31 * (3.1 * t).cos();
            let a = -0.338 * (1.3 * t).sin() - 0.961 * (3.1 * t).sin();
            let u = (6.0 * a + 2.0 * v + 2.5 * v.signum() + 0.3 + 0.1 * (17.0 * t).sin()) / 6.0;
            writeln!(text, "{stamp_s:.6},{x:.9},{u:.9}").unwrap();
        }
        std::fs::write(&path, text).unwrap();
        let sidecar = "schema = 1\n[constants]\ndrive_gain = \"6 N/V\"\n[columns]\n\"time [s]\" = { name = \"time\", unit = \"s\" }\n\
                       \"position [m]\" = { name = \"position\", unit = \"m\" }\n\"command [V]\" = { name = \"command\", unit = \"V\" }\n";
        std::fs::write(path.with_extension("toml"), sidecar).unwrap();
        assert!(is_long(&path));
        let asked = [AxisModel::Symmetric, AxisModel::Asymmetric];
        let gain = ForcePerVolt::of_log(6.0, None);
        let found = of_table(&path, None, ("log", "towing"), &gain, &asked).unwrap();
        let whole = in_memory(&path, None, "log", &asked, &gain).unwrap();
        assert_eq!(found.results.len(), whole.estimates.len());
        for (found, (expected, files)) in found.results.iter().zip(&whole.estimates) {
            let [estimate] = found.estimates() else { panic!("one estimate") };
            assert_eq!((&estimate.id, found.files()), (&expected.id, files.as_slice()));
            assert_eq!(estimate.n_observations, expected.n_observations);
            for ((name, c), (own, e)) in estimate.coefficients.iter().zip(&expected.coefficients) {
                let (value, known) = (c.value.unwrap(), e.value.unwrap());
                assert_eq!(name, own);
                let standard = e.standard_uncertainty.unwrap();
                assert!(
                    (value - known).abs() <= TOLERANCE * known.abs().max(standard),
                    "{name}: {value} {known} ({standard})"
                );
                // HAC and the resampled blocks are two estimates of one scatter.
                let ratio = c.standard_uncertainty.unwrap() / e.standard_uncertainty.unwrap();
                assert!((0.5..2.0).contains(&ratio), "{name}: {ratio}");
            }
            let [sigma, known] = [estimate, expected].map(|e| e.sigma["drive_force"].value);
            // Less than half of what one row more or less would change.
            assert!((sigma / known - 1.0).abs() < 0.25 / estimate.n_observations as f64, "{sigma} {known}");
        }
        assert!(found.findings.iter().any(|f| f.code == "long-log"));
    }
}
