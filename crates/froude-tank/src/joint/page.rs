//! The parts of a page that follow from a joint fit alone: coefficients, budget, load as measured and as fitted, spectrum of what is left.

use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark, Series, TextTable};

use super::{Fitted, JointFit, Run};
use crate::residual_spectrum::{self, Left};

/// Runs that are drawn; more would be a page of the same.
const DRAWN: usize = 6;

/// The coefficients with their intervals; `law` names it in the caption.
pub(crate) fn coefficients(fit: &JointFit, law: &str) -> TextTable {
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
        caption: format!("Coefficients{law}; standard uncertainty in brackets."),
        head: ["coefficient", "value", "unit", "95 % interval", "type A", "type B"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
    }
}

/// What costs what: standard uncertainties by error and coefficient.
pub(crate) fn budget(fit: &JointFit) -> TextTable {
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

/// The load in time: its name and unit, as measured and as fitted.
pub(crate) fn loads(fit: &JointFit, runs: &[Run<'_>], times_s: &[&[f64]], (name, unit): (&str, &str)) -> Chart {
    let panel = |((run, time_s), fitted): ((&Run<'_>, &&[f64]), &Fitted)| {
        let used = run.motion.samples();
        let series = |name: &str, mark: Mark, x: &[f64], y: &[f64]| Series {
            name: name.to_owned(),
            mark,
            x: x.to_vec(),
            y: y.to_vec(),
            ..Series::default()
        };
        ChartPanel {
            y_label: format!("{} [{unit}]", run.id),
            series: vec![
                series("measured", Mark::Points, time_s, run.load),
                series("fitted, where used", Mark::Line, &time_s[used], &fitted.load),
            ],
            ..ChartPanel::default()
        }
    };
    let panels: Vec<ChartPanel> = runs.iter().zip(times_s).zip(&fit.fitted).take(DRAWN).map(panel).collect();
    let of = if panels.len() < runs.len() { format!("the first {} of ", panels.len()) } else { String::new() };
    Chart {
        name: format!("{}s", name.to_lowercase()),
        title: format!("{name} and fit"),
        caption: format!("{name} of the rig on the body in {of}the runs, as measured, and the fit where it was used."),
        x_label: "time [s]".to_owned(),
        panels,
        ..Chart::default()
    }
}

/// The spectrum of what the fit leaves.
pub(crate) fn spectrum(
    fit: &JointFit,
    runs: &[Run<'_>],
    times_s: &[&[f64]],
    (name, unit): (&str, &str),
) -> Option<Chart> {
    let left = runs.iter().zip(times_s).zip(&fit.fitted).map(|((run, time_s), fitted)| {
        let (used, first) = (run.motion.longest(), run.motion.samples().start);
        let values = used.clone().map(|i| run.load[i] - fitted.load[i - first]).collect();
        Left::of(&time_s[used], values)
    });
    let what = format!("measured less fitted {}", name.to_lowercase());
    residual_spectrum::chart(
        &left.collect::<Vec<_>>(),
        (&what, unit),
        "A line at a multiple of the driven frequency is a term that the law lacks; a rise towards low frequencies is slow noise, which the scatter between clusters counts.",
    )
}
