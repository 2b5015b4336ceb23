//! A forced oscillation on the page: runs, force as measured and as fitted, spectrum of what is left, budget.

use froude_records::block::{Block, Digits, Section, TableBuilder};
use froude_records::text::counted;

use super::fit::{ADDED, OscillationFit};
use super::forces::Drag;
use super::record::criteria;
use super::setup::{OscillationRun, Setup};
use crate::joint::Run;
use crate::joint::page::{self, Load, Timed};
use crate::motion::Motion;

const FORCE: Load = Load { name: "Force", unit: "N", table_unit: "N", key: "n", digits: Digits::Plain(3) };

/// The section of the recommended law.
#[must_use]
pub fn section(fit: &OscillationFit, runs: &[OscillationRun<'_>], motions: &[Motion], setup: &Setup) -> Section {
    let paragraph = format!(
        "Drag law {}. Of each run {} of start-up are left out, as many whole cycles as there are (or as were asked for) are used, and a broken one at the end belongs to the last. \
         The angle is fitted by {} harmonics; velocity and acceleration are their derivatives. Force, zero, delay, added mass, drag and buoyancy are then fitted together, to all runs at \
         once: {}.",
        fit.law,
        counted(setup.cycles.skip, "cycle", "cycles"),
        setup.harmonics,
        setup.pivot.words()
    );
    let timed =
        runs.iter().zip(motions).map(|(run, motion)| (Run { id: run.id, load: run.force_n, motion }, run.time_s));
    let timed: Vec<Timed<'_>> = timed.collect();
    let t = TableBuilder::new("", "", runs);
    let mounted = vec![
        t.text("configuration", "configuration", |run| setup.bodies[run.body].name.clone()),
        t.number("flow_m_s", "stream [m/s]", |run| run.flow_m_s).significant(3),
    ];
    page::section(fit, &timed, &FORCE, paragraph, mounted)
}

/// The drag laws beside each other, which of them is recommended, and its coefficients.
#[must_use]
pub fn laws(fits: &[(Drag, OscillationFit)], chosen: usize) -> Section {
    let best = &fits[chosen].1;
    let coefficients = page::coefficients(best, &format!(" with drag law {}", best.law)).into();
    if fits.len() < 2 {
        return Section::new("Results", [coefficients]);
    }
    let rows: Vec<_> = fits.iter().zip(criteria(fits)).map(|((drag, fit), aicc)| (drag, fit, aicc)).collect();
    let added = |fit: &OscillationFit| fit.unknown(ADDED).and_then(|u| u.value.zip(u.combined));
    let t = TableBuilder::new("laws", "Drag laws beside each other.", &rows);
    let beside = t.build(vec![
        t.text("law", "drag law", |(_, fit, _)| fit.law.clone()),
        t.count("drag_coefficients", "drag coefficients", |(drag, ..)| drag.columns.len()),
        t.number("aicc", "AICc", |(.., aicc)| *aicc).places(1),
        t.number("residual_rms_n", "residual, rms [N]", |(_, fit, _)| fit.sigma).significant(3),
        t.uncertain(
            [ADDED, "standard_uncertainty"],
            "C_A [1]",
            |(_, fit, _)| added(fit).map(|(value, _)| value),
            |(_, fit, _)| added(fit).map(|(_, c)| c.standard),
        ),
    ]);
    let sentence = format!(
        "Recommended is {}: of the laws whose AICc lies within 2 of the smallest, the one with the fewest coefficients. AICc counts effective observations, not samples.",
        best.law
    );
    Section::new("Results", [beside.into(), coefficients, Block::words([sentence])])
}
