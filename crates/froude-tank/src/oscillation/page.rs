//! A forced oscillation on the page: runs, force as measured and as fitted, spectrum of what is left, budget.

use froude_records::number;
use froude_records::page::{DocumentSection, TextTable};

use super::fit::{ADDED, OscillationFit};
use super::forces::Drag;
use super::record::criteria;
use super::setup::{OscillationRun, Setup};
use crate::joint::{Run, page};
use crate::motion::Motion;

/// The load, and its unit.
const FORCE: (&str, &str) = ("Force", "N");

/// The section of the recommended law.
#[must_use]
pub fn section(
    fit: &OscillationFit,
    runs: &[OscillationRun<'_>],
    motions: &[Motion],
    setup: &Setup,
) -> DocumentSection {
    let paragraph = format!(
        "Drag law {}. Of each run {} of start-up are left out, as many whole cycles as there are (or as were asked for) are used, and a broken one at the end belongs to the last. \
         The angle is fitted by {} harmonics; velocity and acceleration are their derivatives. Force, zero, delay, added mass, drag and buoyancy are then fitted together, to all runs at \
         once: {}.",
        fit.law,
        froude_records::text::counted(setup.cycles.skip, "cycle", "cycles"),
        setup.harmonics,
        setup.pivot.words()
    );
    let views: Vec<Run<'_>> =
        runs.iter().zip(motions).map(|(run, motion)| Run { id: run.id, load: run.force_n, motion }).collect();
    let times_s: Vec<&[f64]> = runs.iter().map(|run| run.time_s).collect();
    DocumentSection {
        title: "Runs and fit".to_owned(),
        paragraphs: vec![paragraph],
        tables: vec![table(fit, runs, motions, setup), page::budget(fit)],
        charts: std::iter::once(page::loads(fit, &views, &times_s, FORCE))
            .chain(page::spectrum(fit, &views, &times_s, FORCE))
            .collect(),
    }
}

/// The drag laws beside each other, which of them is recommended, and its coefficients.
#[must_use]
pub fn laws(fits: &[(Drag, OscillationFit)], chosen: usize) -> DocumentSection {
    let best = &fits[chosen].1;
    let rows = fits.iter().zip(criteria(fits)).map(|((drag, fit), criterion)| {
        let added = fit.unknown(ADDED).and_then(|u| u.value.zip(u.combined));
        vec![
            fit.law.clone(),
            drag.columns.len().to_string(),
            criterion.map_or_else(|| "–".to_owned(), |x| number::fixed(x, 1)),
            number::significant(fit.sigma, 3),
            added.map_or_else(|| "–".to_owned(), |(value, c)| number::short_form(value, c.standard)),
        ]
    });
    let beside = TextTable {
        caption: "Drag laws beside each other.".to_owned(),
        head: ["drag law", "drag coefficients", "AICc", "residual, rms [N]", "C_A [1]"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
    };
    let sentence = format!(
        "Recommended is {}: of the laws whose AICc lies within 2 of the smallest, the one with the fewest coefficients. AICc counts effective observations, not samples.",
        best.law
    );
    let is_choice = fits.len() > 1;
    DocumentSection {
        title: "Results".to_owned(),
        paragraphs: is_choice.then_some(sentence).into_iter().collect(),
        tables: is_choice
            .then_some(beside)
            .into_iter()
            .chain([page::coefficients(best, &format!(" with drag law {}", best.law))])
            .collect(),
        charts: Vec::new(),
    }
}

fn table(fit: &OscillationFit, runs: &[OscillationRun<'_>], motions: &[Motion], setup: &Setup) -> TextTable {
    let rows = runs.iter().zip(motions).zip(&fit.fitted).map(|((run, motion), fitted)| {
        vec![
            run.id.to_owned(),
            setup.bodies[run.body].name.clone(),
            number::significant(run.flow_m_s, 3),
            number::plain(motion.angle.amplitude(1).to_degrees(), 3),
            number::plain(motion.angle.period_s(), 4),
            number::plain(motion.periods(run.time_s), 3),
            number::significant(motion.angle.residual_std.to_degrees(), 2),
            number::plain(fitted.zero, 3),
            number::significant(fitted.residual_rms, 2),
            fitted.correlation.map_or_else(|| "–".to_owned(), |tau| number::significant(tau, 2)),
        ]
    });
    TextTable {
        caption: "Each run as it was used.".to_owned(),
        head: [
            "run",
            "configuration",
            "stream [m/s]",
            "amplitude [deg]",
            "period [s]",
            "periods used",
            "residual of the angle [deg]",
            "zero of the force [N]",
            "residual of the force, rms [N]",
            "correlation time τ [samples]",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.collect(),
    }
}
