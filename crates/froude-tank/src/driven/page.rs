//! A joint fit with a motor-driven body on the page: coefficients and what follows from them, laws beside each other, runs and fit.

use froude_records::block::{Block, ResultTable, Section, TableBuilder};
use froude_records::text::counted;

use super::derived::Derived;
use super::fit::views;
use super::fitted::Fitted;
use super::method::MotorDriven;
use super::record::criteria;
use super::setup::Setup;
use super::spec::Point;
use super::still_page;
use crate::joint::JointFit;
use crate::joint::forecast::total;
use crate::joint::page::{self, Timed};

/// The coefficients of the recommended law, their correlation, and what they mean.
#[must_use]
pub fn results<M: MotorDriven>(fits: &[(Setup<M>, JointFit)], chosen: &Fitted<'_, M>) -> Section {
    let (spec, law) = (M::SPEC, chosen.setup.method.law());
    let of_law = if law == spec.law { String::new() } else { format!(" with the law {law}") };
    let mut blocks = Vec::new();
    if fits.len() > 1 {
        blocks.push(laws(fits).into());
    }
    blocks.push(page::coefficients(chosen.fit, &of_law).into());
    if !chosen.derived.is_empty() {
        blocks.push(meanings(chosen.derived).into());
    }
    blocks.push(correlations(chosen.fit).into());
    blocks.extend(still_page::blocks(chosen.setup));
    blocks.extend(chosen.setup.method.blocks(chosen));
    if fits.len() > 1 {
        let sentence = format!(
            "Recommended is {law}: of the laws whose AICc lies within 2 of the smallest, the one with the fewest coefficients. AICc counts effective observations, not samples."
        );
        blocks.push(Block::words([sentence]));
    }
    Section::new("Results", blocks)
}

/// Runs and fit.
#[must_use]
pub fn section<M: MotorDriven>(fitted: &Fitted<'_, M>) -> Section {
    let (spec, Fitted { fit, setup, runs, motions, .. }) = (M::SPEC, fitted);
    let law = setup.method.law();
    let named = if law == spec.law { String::new() } else { format!("Law {law}. ") };
    let loads: Vec<&str> = spec.loads.iter().map(|load| load.name).collect();
    let paragraph = format!(
        "{named}In each run, {} left out as start-up. All later whole cycles are used, or the number requested; an incomplete cycle at the end is counted with the last one. \
         The {} is fitted by {} harmonics; rate and acceleration are their derivatives. Then the zeros of {}, the delay and {} are fitted together, to all runs at once; {}.",
        counted(setup.cycles.skip, "cycle is", "cycles are"),
        spec.motion.name,
        setup.harmonics,
        loads.join(", "),
        spec.found,
        setup.method.held()
    );
    let timed: Vec<Timed<'_>> = views(runs, motions).into_iter().zip(runs.iter().map(|run| run.time_s)).collect();
    let points: Vec<&Point> = runs.iter().map(|run| &run.point).collect();
    let mounted = setup.method.mounted(&TableBuilder::new("", "", &points));
    page::section(fit, &timed, (&spec.motion, spec.loads), paragraph, mounted)
}

/// The laws beside each other.
fn laws<M: MotorDriven>(fits: &[(Setup<M>, JointFit)]) -> ResultTable {
    let spec = M::SPEC;
    let rows: Vec<_> = fits.iter().zip(criteria(fits)).collect();
    let (name, _) = spec.added;
    let first = |fit: &JointFit| fit.unknown(name).and_then(|u| u.value.zip(u.combined));
    let t = TableBuilder::new("laws", "Drag laws beside each other.", &rows);
    let unit = spec.loads[0].unit;
    let (key, head) = (format!("residual_rms_{}", spec.loads[0].key()), format!("residual, rms [{unit}]"));
    t.build(vec![
        t.text("law", "drag law", |((_, fit), _)| fit.law.clone()),
        t.count("drag_coefficients", "drag coefficients", |((setup, _), _)| {
            setup.method.coefficients().iter().filter(|c| c.is_bounded).count()
        }),
        t.number("aicc", "AICc", |(_, aicc)| *aicc).places(1),
        t.number(&key, &head, |((_, fit), _)| fit.sigma[0]).significant(3),
        t.uncertain(
            [name, "standard_uncertainty"],
            &format!("{name} [1]"),
            |((_, fit), _)| first(fit).map(|(value, _)| value),
            |((_, fit), _)| first(fit).map(|(_, c)| c.standard),
        ),
    ])
}

fn meanings(derived: &[Derived]) -> ResultTable {
    let t =
        TableBuilder::new("derived", "What follows from the coefficients; standard uncertainty in brackets.", derived);
    t.build(vec![
        t.text("derived", "derived", |d| d.name.to_owned()),
        t.uncertain(["value", "standard_uncertainty"], "value", |d| d.value, |d| d.combined.standard),
        t.text("unit", "unit", |d| d.unit.to_owned()),
        t.interval("interval_95", "95 % interval", |d| d.combined.interval(d.value)),
        t.text("formula", "formula", |d| d.formula.to_owned()),
    ])
}

fn correlations(fit: &JointFit) -> ResultTable {
    let rows: Vec<usize> = (0..fit.unknowns.len()).collect();
    let covariance = total(&fit.parts, rows.len());
    let t = TableBuilder::new("correlation", "Correlation of the coefficients, from all errors together.", &rows);
    let name = |i: &usize| fit.unknowns[*i].name.clone();
    let each =
        rows.iter().map(|j| t.number(&name(j), &name(j), |i| crate::joint::correlation(&covariance, *i, *j)).places(3));
    t.build(std::iter::once(t.text("coefficient", "correlation", name)).chain(each).collect())
}
