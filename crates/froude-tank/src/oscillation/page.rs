//! A forced oscillation on the page: runs, force as measured and as fitted, spectrum of what is left, budget.

use froude_records::number;
use froude_records::page::{Chart, ChartPanel, DocumentSection, Mark, Scale, Series, TextTable};
use froude_signal::spectrum::density;

use super::fit::{ADDED, OscillationFit};
use super::forces::Drag;
use super::motion::Motion;
use super::record::criteria;
use super::setup::{OscillationRun, Setup};

/// Runs that are drawn; more would be a page of the same.
const DRAWN: usize = 6;
/// Segments that a run is cut into for its spectrum, at least.
const SEGMENTS: usize = 4;

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
    DocumentSection {
        title: "Runs and fit".to_owned(),
        paragraphs: vec![paragraph],
        tables: vec![table(fit, runs, motions, setup), budget(fit)],
        charts: std::iter::once(forces(fit, runs, motions)).chain(spectrum(fit, runs, motions)).collect(),
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
            number::significant(fit.sigma_n, 3),
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
        tables: is_choice.then_some(beside).into_iter().chain([coefficients(best)]).collect(),
        charts: Vec::new(),
    }
}

fn coefficients(fit: &OscillationFit) -> TextTable {
    let rows = fit.unknowns.iter().map(|u| {
        let known = u.value.zip(u.combined);
        let value = match (known, u.value) {
            (Some((value, c)), _) => number::short_form(value, c.standard),
            (None, Some(value)) => number::plain(value, 5),
            (None, None) => "not determined".to_owned(),
        };
        let of = |figure: &dyn Fn(f64, froude_fit::budget::Combined) -> String| {
            known.map_or_else(|| "–".to_owned(), |(value, c)| figure(value, c))
        };
        vec![
            u.name.clone(),
            value,
            u.unit.clone(),
            of(&|value, c| number::interval(c.interval(value))),
            of(&|_, c| number::significant(c.type_a, 2)),
            of(&|_, c| number::significant(c.type_b, 2)),
        ]
    });
    TextTable {
        caption: format!("Coefficients with drag law {}; standard uncertainty in brackets.", fit.law),
        head: ["coefficient", "value", "unit", "95 % interval", "type A", "type B"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
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
            number::plain(fitted.zero_n, 3),
            number::significant(fitted.residual_rms_n, 2),
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

/// What costs what: standard uncertainties by error and coefficient.
fn budget(fit: &OscillationFit) -> TextTable {
    let head = std::iter::once("error (type)".to_owned())
        .chain(fit.unknowns.iter().map(|u| format!("{} [{}]", u.name, u.unit)));
    let mut rows: Vec<Vec<String>> = fit
        .parts
        .iter()
        .map(|part| {
            let each = (0..fit.unknowns.len()).map(|j| number::significant(part.standard(j), 2));
            std::iter::once(format!("{} ({})", part.name, part.kind)).chain(each).collect()
        })
        .collect();
    let combined =
        fit.unknowns.iter().map(|u| u.combined.map_or_else(|| "–".to_owned(), |c| number::significant(c.standard, 2)));
    rows.push(std::iter::once("combined".to_owned()).chain(combined).collect());
    TextTable { caption: "Standard uncertainties, by error.".to_owned(), head: head.collect(), rows }
}

fn forces(fit: &OscillationFit, runs: &[OscillationRun<'_>], motions: &[Motion]) -> Chart {
    let panel = |((run, motion), fitted): ((&OscillationRun<'_>, &Motion), &super::fit::Fitted)| {
        let used = motion.samples();
        let series = |name: &str, mark: Mark, x: &[f64], y: &[f64]| Series {
            name: name.to_owned(),
            mark,
            x: x.to_vec(),
            y: y.to_vec(),
            ..Series::default()
        };
        ChartPanel {
            y_label: format!("{} [N]", run.id),
            series: vec![
                series("measured", Mark::Points, run.time_s, run.force_n),
                series("fitted, where used", Mark::Line, &run.time_s[used], &fitted.force_n),
            ],
            ..ChartPanel::default()
        }
    };
    let panels: Vec<ChartPanel> = runs.iter().zip(motions).zip(&fit.fitted).take(DRAWN).map(panel).collect();
    let of = if panels.len() < runs.len() { format!("the first {} of ", panels.len()) } else { String::new() };
    Chart {
        name: "forces".to_owned(),
        title: "Force and fit".to_owned(),
        caption: format!("Force of the rig on the body in {of}the runs, as measured, and the fit where it was used."),
        x_label: "time [s]".to_owned(),
        panels,
        ..Chart::default()
    }
}

/// The spectrum of what the fit leaves, mean over the runs of one length of segment.
fn spectrum(fit: &OscillationFit, runs: &[OscillationRun<'_>], motions: &[Motion]) -> Option<Chart> {
    let shortest = motions.iter().map(|m| m.longest().len()).min()?;
    let segment = (shortest / SEGMENTS).checked_ilog2().map(|bits| 1_usize << bits).filter(|n| *n >= 16)?;
    let mut sum: Vec<f64> = Vec::new();
    let mut frequency = Vec::new();
    for ((run, motion), fitted) in runs.iter().zip(motions).zip(&fit.fitted) {
        let (used, first) = (motion.longest(), motion.samples().start);
        let rate_hz = (used.len() - 1) as f64 / (run.time_s[used.end - 1] - run.time_s[used.start]);
        let left: Vec<f64> = used.map(|i| run.force_n[i] - fitted.force_n[i - first]).collect();
        let (f, p) = density(&left, rate_hz, segment).ok()?;
        if sum.is_empty() {
            (frequency, sum) = (f, p);
        } else {
            sum.iter_mut().zip(&p).for_each(|(a, b)| *a += b);
        }
    }
    let n = runs.len() as f64;
    // The mean was taken off: the first line says nothing.
    let series = Series {
        name: "residual".to_owned(),
        mark: Mark::Line,
        x: frequency[1..].to_vec(),
        y: sum[1..].iter().map(|p| p / n).collect(),
        ..Series::default()
    };
    Some(Chart {
        name: "residual-spectrum".to_owned(),
        title: "Spectrum of the residuals".to_owned(),
        caption: "Power density of measured less fitted force, mean over the runs. A line at a multiple of the driven frequency is a term that the law lacks; a rise towards low frequencies is \
                  slow noise, which the scatter between clusters counts."
            .to_owned(),
        x_label: "frequency [Hz]".to_owned(),
        x_scale: Scale::Logarithmic,
        panels: vec![ChartPanel { y_label: "power density [N²/Hz]".to_owned(), y_scale: Scale::Logarithmic, series: vec![series] }],
    })
}
