//! A rotation on the page: coefficients and what they mean, runs, torque as measured and as fitted, spectrum of what is left, budget.

use froude_records::block::{Block, Digits, ResultTable, Section, TableBuilder};
use froude_records::text::counted;

use super::derive::{Derived, law_behind};
use super::fit::RotationFit;
use super::setup::{RotationRun, Setup, words};
use crate::joint::Run;
use crate::joint::forecast::total;
use crate::joint::page::{self, Load, Timed};
use crate::motion::Motion;

const TORQUE: Load =
    Load { name: "Torque", unit: "N m", table_unit: "mN m", key: "n_m", digits: Digits::Significant(3) };

/// The coefficients, their correlation, and what they mean.
#[must_use]
pub fn results(fit: &RotationFit, derived: &[Derived]) -> Section {
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
    Section::new("Results", tables.into_iter().map(Block::from).chain([Block::words(paragraphs)]))
}

/// Runs and fit.
#[must_use]
pub fn section(fit: &RotationFit, runs: &[RotationRun<'_>], motions: &[Motion], setup: &Setup) -> Section {
    let paragraph = format!(
        "Of each run {} of start-up are left out, as many whole cycles as there are (or as were asked for) are used, and a broken one at the end belongs to the last. The angle is fitted \
         by {} harmonics; rate and acceleration are their derivatives. Torque, zero, delay and λ₁, λ₂, λ₃ are then fitted together, to all runs at once.",
        counted(setup.cycles.skip, "cycle", "cycles"),
        setup.harmonics
    );
    let timed =
        runs.iter().zip(motions).map(|(run, motion)| (Run { id: run.id, load: run.torque_n_m, motion }, run.time_s));
    let timed: Vec<Timed<'_>> = timed.collect();
    let t = TableBuilder::new("", "", runs);
    let mounted = t.text("mounted", "mounted", |run| words(run.mounted).to_owned());
    page::section(fit, &timed, &TORQUE, paragraph, vec![mounted])
}

fn meanings(derived: &[Derived]) -> ResultTable {
    let caption = "What follows from the coefficients, by the strip integrals of one link; standard uncertainty in brackets, v_ref = 1 m/s.";
    let t = TableBuilder::new("derived", caption, derived);
    t.build(vec![
        t.text("derived", "derived", |d| d.name.to_owned()),
        t.uncertain(["value", "standard_uncertainty"], "value", |d| d.value, |d| d.combined.standard),
        t.text("unit", "unit", |d| d.unit.to_owned()),
        t.interval("interval_95", "95 % interval", |d| d.combined.interval(d.value)),
        t.text("formula", "formula", |d| d.formula.to_owned()),
    ])
}

fn correlations(fit: &RotationFit) -> ResultTable {
    let rows: Vec<usize> = (0..fit.unknowns.len()).collect();
    let covariance = total(&fit.parts, rows.len());
    let correlation = |i: usize, j: usize| {
        let norm = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        (norm > 0.0).then(|| covariance[(i, j)] / norm)
    };
    let t = TableBuilder::new("correlation", "Correlation of the coefficients, from all errors together.", &rows);
    let name = |i: &usize| fit.unknowns[*i].name.clone();
    let each = rows.iter().map(|j| t.number(&name(j), &name(j), |i| correlation(*i, *j)).places(3));
    t.build(std::iter::once(t.text("coefficient", "correlation", name)).chain(each).collect())
}
