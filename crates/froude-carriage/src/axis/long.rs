//! A servo's log of more rows than are kept: rigid models, read in chunks in bounded memory.
//!
//! Twice through the file: once for its clock, whose mean step every filter needs, and once for all models together ([`LongServo`]). Coefficients
//! equal those of the log in memory; the intervals are those of HAC with the lag of a block, since blocks would need all rows at once. There is
//! no test of whiteness and no figure of the force.

use std::path::Path;

use froude_identify::answer::Made;
use froude_identify::large::MOST_KEPT;
use froude_identify::method::{Found, MethodError};
use froude_identify::wild;
use froude_records::block::{Block, Section};
use froude_records::chunks::{for_each_chunk, has_more_rows};
use froude_records::finding::{Finding, Severity};
use froude_records::number;
use froude_records::table::Table;
use froude_records::units::Dimension;

use super::page::{Pieces, coefficient_table, with_declared};
use super::{AxisModel, friction_of, one_excitation};
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
    /// The shortest and the longest, each with the time before it.
    shortest: (f64, f64),
    longest: (f64, f64),
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

/// The clock of a log.
fn clock(path: &Path, sidecar: Option<&Path>) -> Result<Clock, MethodError> {
    let mut out = Clock {
        rows: 0,
        first_s: f64::NAN,
        last_s: f64::NAN,
        shortest: (f64::INFINITY, f64::NAN),
        longest: (f64::NEG_INFINITY, f64::NAN),
    };
    for_each_chunk(path, sidecar, &mut |table| {
        for &time_s in table.number("time", Dimension::TIME)? {
            if out.rows == 0 {
                out.first_s = time_s;
            } else {
                let step = (time_s - out.last_s, out.last_s);
                out.shortest = if step.0 < out.shortest.0 { step } else { out.shortest };
                out.longest = if step.0 > out.longest.0 { step } else { out.longest };
            }
            out.last_s = time_s;
            out.rows += 1;
        }
        Ok::<(), MethodError>(())
    })?;
    Ok(out)
}

impl Clock {
    fn mean_s(&self) -> f64 {
        (self.last_s - self.first_s) / self.rows.saturating_sub(1) as f64
    }

    /// Rate of the log, Hz; its steps must be even.
    fn rate_hz(&self) -> Result<f64, ServoError> {
        let mean_s = self.mean_s();
        for (step_s, time_s) in [self.shortest, self.longest] {
            if !is_even(step_s, mean_s) {
                return Err(ServoError::Uneven { time_s, step_s, mean_s });
            }
        }
        rate_of(mean_s)
    }

    fn finding(&self) -> Finding {
        let [mean_ms, shortest_ms, longest_ms] = [self.mean_s(), self.shortest.0, self.longest.0].map(|s| 1e3 * s);
        let text = format!(
            "time steps have a mean of {mean_ms:.6} ms, from {shortest_ms:.6} ms to {longest_ms:.6} ms: uniform"
        );
        Finding::new(Severity::Note, "time-steps", text)
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
    let rate_hz = clock.rate_hz().map_err(MethodError::refused)?;
    let rigid = asked.iter().filter_map(|model| Some((model.friction()?, friction_of(*model))));
    let mut under_way = rigid
        .map(|(words, friction)| Ok((words, LongServo::new(&Chain::of_log(gain.n_v, rate_hz, friction), rate_hz)?)))
        .collect::<Result<Vec<_>, ServoError>>()
        .map_err(MethodError::refused)?;
    for_each_chunk(path, sidecar, &mut |table| {
        let position_m = column(&table, "position", Dimension::LENGTH)?;
        let command_v = column(&table, "command", Dimension::VOLTAGE)?;
        let times = table.number("time", Dimension::TIME)?;
        if let Some(what) = wild::sample_of("position", "m", times, position_m, &[]) {
            return Err(MethodError::input(path, format!("{what}; correct the sample, or cut the log there")));
        }
        under_way.iter_mut().try_for_each(|(_, servo)| servo.push(position_m, command_v)).map_err(MethodError::refused)
    })?;
    let text = format!(
        "the log has {} rows, more than the {} that are kept: it was read in chunks. Its intervals are those of HAC, with no test whether residuals \
         are white, and without a figure of the force",
        number::count(clock.rows),
        number::count(MOST_KEPT)
    );
    let mut out = Found {
        findings: vec![clock.finding(), Finding::new(Severity::Note, "long-log", text), one_excitation()],
        ..Found::default()
    };
    let mut tables: Vec<Block> = Vec::new();
    for (words, servo) in under_way {
        let fit = servo.finish().map_err(MethodError::refused)?;
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
        tables.push(with_declared(table, Some(&estimate)).into());
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

    /// Both sides round alike but in another order: some 20,000 roundings times a condition of some 100.
    const TOLERANCE: f64 = 1e-9;

    /// The clock's digits make its steps uneven by up to 1 µs, and the first one is not the mean: a rate by that one would show.
    const STEP_S: f64 = 1.000_37e-3;

    #[test]
    fn a_log_in_chunks_gives_what_it_gives_in_memory() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let mut text = "time [s],position [m],command [V]\n".to_owned();
        for i in 0..(MOST_KEPT + 5000) {
            let t = STEP_S * i as f64;
            let x = 0.2 * (1.3 * t).sin() + 0.1 * (3.1 * t).sin();
            let v = 0.26 * (1.3 * t).cos() + 0.31 * (3.1 * t).cos();
            let a = -0.338 * (1.3 * t).sin() - 0.961 * (3.1 * t).sin();
            let u = (6.0 * a + 2.0 * v + 2.5 * v.signum() + 0.3 + 0.1 * (17.0 * t).sin()) / 6.0;
            writeln!(text, "{t:.6},{x:.9},{u:.9}").unwrap();
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
                assert!((value - known).abs() <= TOLERANCE * known.abs().max(1.0), "{name}: {value} {known}");
                // HAC and the resampled blocks are two estimates of one scatter.
                let ratio = c.standard_uncertainty.unwrap() / e.standard_uncertainty.unwrap();
                assert!((0.5..2.0).contains(&ratio), "{name}: {ratio}");
            }
            let [sigma, known] = [estimate, expected].map(|e| e.sigma["drive_force"].value);
            assert!((sigma / known - 1.0).abs() < TOLERANCE, "{sigma} {known}");
        }
        assert!(found.findings.iter().any(|f| f.code == "long-log"));
    }
}
