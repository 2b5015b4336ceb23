//! A rotation on the page: coefficients and what they mean, runs, torque as measured and as fitted, spectrum of what is left, budget.

use froude_records::number;
use froude_records::page::{DocumentSection, TextTable};
use froude_records::text::counted;

use super::derive::{Derived, law_behind};
use super::fit::RotationFit;
use super::plan::words;
use super::setup::{RotationRun, Setup};
use crate::joint::forecast::total;
use crate::joint::{Run, page};
use crate::motion::Motion;

/// The load, and its unit.
const TORQUE: (&str, &str) = ("Torque", "N m");

/// The coefficients, their correlation, and what they mean.
#[must_use]
pub fn results(fit: &RotationFit, derived: &[Derived]) -> DocumentSection {
    let mut tables = vec![page::coefficients(fit, "")];
    let mut paragraphs = Vec::new();
    if !derived.is_empty() {
        paragraphs.push(
            "C_M is what the printed formula of λ₁ would need: that formula gives kg m⁴, so that its C_M is a number of 1/m² and no coefficient of added mass; C_A is."
                .to_owned(),
        );
        tables.push(meanings(derived));
    }
    paragraphs.extend(law_behind(derived).map(|found| format!("The law behind λ₃: {}.", found.words())));
    tables.push(correlations(fit));
    DocumentSection { title: "Results".to_owned(), paragraphs, tables, charts: Vec::new() }
}

/// Runs and fit.
#[must_use]
pub fn section(fit: &RotationFit, runs: &[RotationRun<'_>], motions: &[Motion], setup: &Setup) -> DocumentSection {
    let paragraph = format!(
        "Of each run {} of start-up are left out, as many whole cycles as there are (or as were asked for) are used, and a broken one at the end belongs to the last. The angle is fitted \
         by {} harmonics; rate and acceleration are their derivatives. Torque, zero, delay and λ₁, λ₂, λ₃ are then fitted together, to all runs at once.",
        counted(setup.cycles.skip, "cycle", "cycles"),
        setup.harmonics
    );
    let views: Vec<Run<'_>> =
        runs.iter().zip(motions).map(|(run, motion)| Run { id: run.id, load: run.torque_n_m, motion }).collect();
    let times_s: Vec<&[f64]> = runs.iter().map(|run| run.time_s).collect();
    let charts = std::iter::once(page::loads(fit, &views, &times_s, TORQUE));
    DocumentSection {
        title: "Runs and fit".to_owned(),
        paragraphs: vec![paragraph],
        tables: vec![table(fit, runs, motions), page::budget(fit)],
        charts: charts.chain(page::spectrum(fit, &views, &times_s, TORQUE)).collect(),
    }
}

fn meanings(derived: &[Derived]) -> TextTable {
    let rows = derived.iter().map(|d| {
        vec![
            d.name.to_owned(),
            number::short_form(d.value, d.combined.standard),
            d.unit.to_owned(),
            number::interval(d.combined.interval(d.value)),
            d.formula.to_owned(),
        ]
    });
    TextTable {
        caption: "What follows from the coefficients, by the strip integrals of one link; standard uncertainty in brackets, v_ref = 1 m/s.".to_owned(),
        head: ["derived", "value", "unit", "95 % interval", "formula"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
    }
}

fn correlations(fit: &RotationFit) -> TextTable {
    let n = fit.unknowns.len();
    let covariance = total(&fit.parts, n);
    let cell = |i: usize, j: usize| {
        let norm = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        if norm > 0.0 { number::fixed(covariance[(i, j)] / norm, 3) } else { "–".to_owned() }
    };
    let rows =
        (0..n).map(|i| std::iter::once(fit.unknowns[i].name.clone()).chain((0..n).map(|j| cell(i, j))).collect());
    let head = std::iter::once("correlation".to_owned()).chain(fit.unknowns.iter().map(|u| u.name.clone()));
    TextTable {
        caption: "Correlation of the coefficients, from all errors together.".to_owned(),
        head: head.collect(),
        rows: rows.collect(),
    }
}

fn table(fit: &RotationFit, runs: &[RotationRun<'_>], motions: &[Motion]) -> TextTable {
    let rows = runs.iter().zip(motions).zip(&fit.fitted).map(|((run, motion), fitted)| {
        vec![
            run.id.to_owned(),
            words(run.mounted).to_owned(),
            number::plain(motion.angle.amplitude(1).to_degrees(), 3),
            number::plain(motion.angle.period_s(), 4),
            number::plain(motion.periods(run.time_s), 3),
            number::significant(motion.angle.residual_std.to_degrees(), 2),
            number::significant(1e3 * fitted.zero, 3),
            number::significant(1e3 * fitted.residual_rms, 2),
            fitted.correlation.map_or_else(|| "–".to_owned(), |tau| number::significant(tau, 2)),
        ]
    });
    TextTable {
        caption: "Each run as it was used.".to_owned(),
        head: [
            "run",
            "mounted",
            "amplitude [deg]",
            "period [s]",
            "periods used",
            "residual of the angle [deg]",
            "zero of the torque [mN m]",
            "residual of the torque, rms [mN m]",
            "correlation time τ [samples]",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.collect(),
    }
}
