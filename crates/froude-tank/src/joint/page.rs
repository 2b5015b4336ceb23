//! The parts of a page that follow from a joint fit alone: coefficients, budget, load as measured and as fitted, spectrum of what is left.

use froude_records::block::{Block, Digits, ResultColumn, ResultTable, Section, TableBuilder};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark};

use super::{Fitted, JointFit, Run, Unknown};
use crate::drawn::{self, first_of, over_time, series};
use crate::residual_spectrum::{self, Left};

/// Runs that are drawn; more would be a page of the same.
const DRAWN: usize = 6;

/// What the cell measures.
pub(crate) struct Load {
    pub name: &'static str,
    pub unit: &'static str,
    /// In the table of runs.
    pub table_unit: &'static str,
    /// At the end of keys.
    pub key: &'static str,
    /// Of its zero.
    pub digits: Digits,
}

/// A run with its times, s.
pub(crate) type Timed<'a> = (Run<'a>, &'a [f64]);

/// Runs and fit; `mounted` says of each run how it was made.
pub(crate) fn section(
    fit: &JointFit,
    runs: &[Timed<'_>],
    load: &Load,
    said: String,
    mounted: Vec<ResultColumn>,
) -> Section {
    let tables = [table(fit, runs, load, mounted), budget(fit)].map(Block::from);
    let charts = std::iter::once(loads(fit, runs, load)).chain(spectrum(fit, runs, load)).map(Block::from);
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
fn table(fit: &JointFit, runs: &[Timed<'_>], load: &Load, mounted: Vec<ResultColumn>) -> ResultTable {
    let Load { name, table_unit: unit, key, digits, .. } = load;
    let name = name.to_lowercase();
    let rows: Vec<_> = runs.iter().map(|(run, time_s)| (run, run.motion, time_s)).zip(&fit.fitted).collect();
    let t = TableBuilder::new("runs", "Each run as it was used.", &rows);
    let zero = t.number(&format!("zero_{key}"), &format!("zero of the {name} [{unit}]"), |(_, fitted)| fitted.zero);
    let (rms_key, rms) = (format!("residual_rms_{key}"), format!("residual of the {name}, rms [{unit}]"));
    let used = [
        t.number("amplitude_rad", "amplitude [deg]", |((_, motion, _), _)| motion.angle.amplitude(1)).plain(3),
        t.number("period_s", "period [s]", |((_, motion, _), _)| motion.angle.period_s()).plain(4),
        t.number("periods", "periods used", |((_, motion, time_s), _)| motion.periods(time_s)).plain(3),
        t.number("residual_angle_rad", "residual of the angle [deg]", |((_, motion, _), _)| motion.angle.residual_std)
            .significant(2),
        ResultColumn { digits: *digits, ..zero },
        t.number(&rms_key, &rms, |(_, fitted)| fitted.residual_rms).significant(2),
        t.number("correlation_samples", "correlation time τ [samples]", |(_, fitted)| fitted.correlation)
            .significant(2),
    ];
    let run = t.text("run", "run", |((run, ..), _)| run.id.to_owned());
    t.build(std::iter::once(run).chain(mounted).chain(used).collect())
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

/// The load in time, as measured and as fitted.
fn loads(fit: &JointFit, runs: &[Timed<'_>], &Load { name, unit, .. }: &Load) -> Chart {
    let panel = |((run, time_s), fitted): (&Timed<'_>, &Fitted)| {
        let used = run.motion.samples();
        let measured = series("measured", Mark::Points, *time_s, run.load);
        let fitted = series("fitted, where used", Mark::Line, &time_s[used], &fitted.load[..]);
        drawn::panel(format!("{} [{unit}]", run.id), vec![measured, fitted])
    };
    let panels: Vec<ChartPanel> = runs.iter().zip(&fit.fitted).take(DRAWN).map(panel).collect();
    let of = first_of(panels.len(), runs.len());
    let caption = format!("{name} of the rig on the body in {of}the runs, as measured, and the fit where it was used.");
    over_time([&format!("{}s", name.to_lowercase()), &format!("{name} and fit")], caption, panels)
}

/// The spectrum of what the fit leaves.
fn spectrum(fit: &JointFit, runs: &[Timed<'_>], &Load { name, unit, .. }: &Load) -> Option<Chart> {
    let left = runs.iter().zip(&fit.fitted).map(|((run, time_s), fitted)| {
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
