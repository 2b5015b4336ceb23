//! The parts of a page that follow from a joint fit alone: coefficients, budget, load as measured and as fitted, spectrum of what is left.

use froude_records::block::{Block, ResultColumn, ResultTable, Section, TableBuilder};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark};

use super::{Fitted, JointFit, Run, Unknown};
use crate::channel::Channel;
use crate::drawn::{self, first_of, over_time, series};
use crate::residual_spectrum::{self, Left};

/// Runs that are drawn; more would be a page of the same.
const DRAWN: usize = 6;

/// A run with its times, s.
pub(crate) type Timed<'a> = (Run<'a>, &'a [f64]);

/// Runs and fit; `mounted` says of each run how it was made.
pub(crate) fn section(
    fit: &JointFit,
    runs: &[Timed<'_>],
    (motion, cells): (&Channel, &[Channel]),
    said: String,
    mounted: Vec<ResultColumn>,
) -> Section {
    let tables = [table(fit, runs, (motion, cells), mounted), budget(fit)].map(Block::from);
    let of_load = |(k, load)| std::iter::once(loads(fit, runs, (k, load))).chain(spectrum(fit, runs, (k, load)));
    let charts = cells.iter().enumerate().flat_map(of_load).map(Block::from);
    Section::new("Runs and fit", std::iter::once(Block::words([said])).chain(tables).chain(charts))
}

/// The coefficients with their intervals; `law` names it in the caption.
pub(crate) fn coefficients(fit: &JointFit, law: &str) -> ResultTable {
    let value = |u: &Unknown| match (u.value, u.combined) {
        (Some(value), Some(c)) => number::short_form(value, c.standard),
        (Some(value), None) => number::plain(value, 5),
        (None, _) => "not determined".to_owned(),
    };
    let caption = format!("Coefficients{law}; standard uncertainty in brackets.");
    let t = TableBuilder::new("coefficients", caption, &fit.unknowns);
    t.build(vec![
        t.text("coefficient", "coefficient", |u| u.name.clone()),
        t.text("", "value", value),
        t.uncertain(["value", "standard_uncertainty"], "", |u| u.value, |u| u.combined.map(|c| c.standard)),
        t.text("unit", "unit", |u| u.unit.clone()),
        t.interval("interval_95", "95 % interval", |u| Some(u.combined?.interval(u.value?))),
        t.number("type_a", "type A", |u| u.combined.map(|c| c.type_a)).significant(2),
        t.number("type_b", "type B", |u| u.combined.map(|c| c.type_b)).significant(2),
    ])
}

/// Each run as it was used.
fn table(
    fit: &JointFit,
    runs: &[Timed<'_>],
    (moved, cells): (&Channel, &[Channel]),
    mounted: Vec<ResultColumn>,
) -> ResultTable {
    let rows: Vec<_> = runs.iter().map(|(run, time_s)| (run, run.motion, time_s)).zip(&fit.fitted).collect();
    let t = TableBuilder::new("runs", "Each run as it was used.", &rows);
    let Channel { name, unit, shown, .. } = moved;
    let used = [
        t.number(&format!("amplitude_{unit}"), &format!("amplitude [{shown}]"), |((_, motion, _), _)| {
            motion.angle.amplitude(1)
        })
        .plain(3),
        t.number("period_s", "period [s]", |((_, motion, _), _)| motion.angle.period_s()).plain(4),
        t.number("periods", "periods used", |((_, motion, time_s), _)| motion.periods(time_s)).plain(3),
        t.number(
            &format!("residual_{name}_{unit}"),
            &format!("residual of the {name} [{shown}]"),
            |((_, motion, _), _)| motion.angle.residual_std,
        )
        .significant(2),
    ];
    let of_load = |(k, load): (usize, &Channel)| {
        let Channel { name, shown: unit, digits, .. } = load;
        let key = if cells.len() == 1 { load.key() } else { format!("{name}_{}", load.key()) };
        let zero = t.number(&format!("zero_{key}"), &format!("zero of the {name} [{unit}]"), |(_, f)| f[k].zero);
        let (rms_key, rms) = (format!("residual_rms_{key}"), format!("residual of the {name}, rms [{unit}]"));
        let correlated = if cells.len() == 1 { String::new() } else { format!(" of the {name}") };
        let (tau_key, tau) = (
            format!("correlation{}_samples", correlated.replace(" of the ", "_")),
            format!("correlation time τ{correlated} [samples]"),
        );
        [
            ResultColumn { digits: *digits, ..zero },
            t.number(&rms_key, &rms, |(_, f)| f[k].residual_rms).significant(2),
            t.number(&tau_key, &tau, |(_, f)| f[k].correlation).significant(2),
        ]
    };
    let of_loads = cells.iter().enumerate().flat_map(of_load);
    let run = t.text("run", "run", |((run, ..), _)| run.id.to_owned());
    t.build(std::iter::once(run).chain(mounted).chain(used).chain(of_loads).collect())
}

/// What costs what: standard uncertainties by error and coefficient.
fn budget(fit: &JointFit) -> ResultTable {
    let by_part = fit.parts.iter().map(|part| {
        let each = (0..fit.unknowns.len()).map(|j| Some(part.standard(j)));
        (format!("{} ({})", part.name, part.kind), each.collect())
    });
    let combined = ("combined".to_owned(), fit.unknowns.iter().map(|u| u.combined.map(|c| c.standard)).collect());
    let rows: Vec<(String, Vec<Option<f64>>)> = by_part.chain([combined]).collect();
    let t = TableBuilder::new("budget", "Standard uncertainties, by error.", &rows);
    let each = fit.unknowns.iter().enumerate().map(|(j, u)| {
        t.number(&u.name, &format!("{} [{}]", u.name, u.unit), |(_, standard)| standard[j]).significant(2)
    });
    t.build(std::iter::once(t.text("error", "error (type)", |(name, _)| name.clone())).chain(each).collect())
}

/// A load in time, as measured and as fitted.
fn loads(fit: &JointFit, runs: &[Timed<'_>], (k, load): (usize, &Channel)) -> Chart {
    let (name, unit) = (load.title(), load.unit);
    let panel = |((run, time_s), fitted): (&Timed<'_>, &Vec<Fitted>)| {
        let used = run.motion.samples();
        let measured = series("measured", Mark::Points, *time_s, run.loads[k]);
        let fitted = series("fitted, where used", Mark::Line, &time_s[used], &fitted[k].load[..]);
        drawn::panel(format!("{} [{unit}]", run.id), vec![measured, fitted])
    };
    let panels: Vec<ChartPanel> = runs.iter().zip(&fit.fitted).take(DRAWN).map(panel).collect();
    let of = first_of(panels.len(), runs.len());
    let caption = format!("{name} of the rig on the body in {of}the runs, as measured, and the fit where it was used.");
    over_time([&format!("{}s", load.name), &format!("{name} and fit")], caption, panels)
}

/// The spectrum of what the fit leaves.
fn spectrum(fit: &JointFit, runs: &[Timed<'_>], (k, load): (usize, &Channel)) -> Option<Chart> {
    let left = runs.iter().zip(&fit.fitted).map(|((run, time_s), fitted)| {
        let (used, first) = (run.motion.longest(), run.motion.samples().start);
        let values = used.clone().map(|i| run.loads[k][i] - fitted[k].load[i - first]).collect();
        Left::of(&time_s[used], values)
    });
    let what = format!("measured less fitted {}", load.name);
    residual_spectrum::chart(
        &left.collect::<Vec<_>>(),
        (&what, load.unit),
        "A line at a multiple of the driven frequency is a term that the law lacks; a rise towards low frequencies is slow noise, which the scatter between clusters counts.",
    )
}
