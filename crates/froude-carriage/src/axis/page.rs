//! An axis on the page and on the terminal: its models in tables, the force of the drive beside that of the model.

use std::ops::Range;

use froude_records::block::{Block, ResultTable, Section, TableBuilder};
use froude_records::estimate::Estimate;
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark, Series};

use super::{AxisModels, CONSTANT, Model, Repeatability};
use crate::runs::mounted;
use crate::servo::ServoCoefficient;
use crate::servo::load::Shape;
use crate::servo::record::{TWO_MASS, in_formulas, law_of};
use crate::servo::report::effective;
use crate::servo::two_mass::FlexibleReport;

/// The axis on the page: its models in tables, which is the summary; how each was fitted, with its figure.
#[must_use]
pub fn sections(outcome: &AxisModels) -> (Section, Vec<Section>) {
    let mut blocks: Vec<Block> = Vec::new();
    for model in &outcome.models {
        let (r, law) = (&model.report.fit, law_of(&model.name));
        let (body, error) = (mounted(&outcome.rigid_mounts), number::percent(r.relative_force_error));
        let caption =
            format!("Rigid model, friction {}{body} (relative {} error {error}).", model.name, fitted(&r.shape));
        let pieces = match r.runs {
            Some(_) => Pieces::Clusters,
            None if r.shape.is_simulated => Pieces::Stretches,
            None => Pieces::Blocks,
        };
        let estimate = outcome.estimates.iter().map(|(estimate, _)| estimate).find(|e| e.law.name == law);
        let table = coefficient_table(&law, caption, &r.coefficients, pieces);
        blocks.push(with_declared(table, &r.coefficients, estimate).into());
        if let Some(motor) = outcome.motor.as_ref().filter(|_| model.name == CONSTANT) {
            let caption =
                "The same at the motor's shaft (MCD Table II). The losses of the gear are included in these numbers.";
            blocks.push(coefficient_table(&format!("{law}_at_motor"), caption, &effective(r, motor), pieces).into());
        }
    }
    blocks.extend(outcome.flexible.as_ref().map(|f| flexible_table(f, &mounted(&outcome.two_mass_mounts)).into()));
    if !outcome.repeatability.is_empty() {
        blocks.push(repeatability_table(&outcome.repeatability, outcome.motor.is_some()).into());
    }
    blocks.push(Block::words(outcome.flexible.iter().flat_map(splits)));
    let fit = |model: &Model| {
        let title = format!("Rigid, friction {}{}", model.name, mounted(&outcome.rigid_mounts));
        Section::new(title, [Block::words(of_fit(model)), force_chart(model).into()])
    };
    (Section::new("Axis by every model", blocks), outcome.models.iter().map(fit).collect())
}

/// What the residuals are of.
fn fitted(shape: &Shape) -> &'static str {
    if shape.is_simulated { "speed" } else { "force" }
}

/// How a rigid model was fitted, and what its residuals say.
fn of_fit(model: &Model) -> Vec<String> {
    let (r, fit) = (&model.report, &model.report.fit);
    let mut out = vec![format!(
        "{} rows at {} Hz ({}); relative {} error {}.",
        number::count(fit.n_rows),
        number::plain(fit.rate_hz, 4),
        fit.preparation,
        fitted(&fit.shape),
        number::percent(fit.relative_force_error)
    )];
    out.extend(r.whiteness.as_ref().map(|w| {
        format!(
            "Residuals: r₁ = {:.2}, Ljung–Box({}) = {:.0}, {}. Standard uncertainties of least squares with white noise are realistic \
             only where that p is large; the intervals are those of {}.",
            w.r1,
            w.lags,
            w.ljung_box,
            number::p_equation(w.p),
            fit.pieces
        )
    }));
    out
}

/// How friction and damping are shared between motor and load.
fn splits(f: &FlexibleReport) -> impl Iterator<Item = String> {
    f.splits.iter().map(|s| {
        let share = if s.is_identified {
            format!("{:.2}, interval {}", s.share_of_motor, number::interval(s.interval))
        } else {
            "not identifiable from the motor's side".to_owned()
        };
        format!("Share of the motor in the friction, {}: {share}.", s.name)
    })
}

/// What an interval was made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pieces {
    /// Whole runs.
    Clusters,
    /// Blocks of one excitation.
    Blocks,
    /// Long stretches of one excitation.
    Stretches,
    /// Scatter within one excitation, and declared errors.
    All,
    /// Autocovariances within one excitation.
    Hac,
}

impl Pieces {
    /// What the interval holds for, where not for every excitation, and its name.
    const fn words(self) -> [&'static str; 2] {
        match self {
            Self::Clusters => ["", "clusters"],
            Self::Blocks => [" for this excitation", "blocks"],
            Self::Stretches => [" for this excitation", "stretches"],
            Self::All => [" for this excitation", "scatter and declared"],
            Self::Hac => [" for this excitation", "HAC"],
        }
    }
}

/// Coefficients with the published-style standard deviation beside the realistic interval, which is that of `pieces`.
pub(super) fn coefficient_table(
    model: &str,
    caption: impl Into<String>,
    coefficients: &[ServoCoefficient],
    pieces: Pieces,
) -> ResultTable {
    let [interval, name] = pieces.words();
    let t = TableBuilder::new(&format!("coefficients/{model}"), caption, coefficients);
    let mut columns = vec![
        t.text("coefficient", "coefficient", |c| c.name.clone()),
        t.text("unit", "unit", |c| c.unit.clone().into_owned()),
        t.uncertain(["value", ""], "value", |c| c.value, |c| c.block_std),
        t.interval("interval_95", &format!("95 % interval{interval} ({name})"), |c| c.interval),
        t.number("standard_white_noise", "u (white noise)", |c| c.classical_std).significant(2),
    ];
    if pieces != Pieces::Hac {
        columns.push(t.number("standard_hac", "u (HAC)", |c| c.hac_std).significant(2));
    }
    columns.push(t.number("standard_uncertainty", &format!("u ({name})"), |c| c.block_std).significant(2));
    t.build(columns)
}

/// The intervals of scatter and declared errors together, where the estimate has any that are declared.
pub(super) fn with_declared(
    mut table: ResultTable,
    rows: &[ServoCoefficient],
    estimate: Option<&Estimate>,
) -> ResultTable {
    let Some(estimate) = estimate.filter(|estimate| !estimate.errors.is_empty()) else { return table };
    // A delay is no coefficient of the law, and has none.
    let all: Vec<Option<[f64; 2]>> =
        rows.iter().map(|row| estimate.coefficients.get(&in_formulas(&row.name))?.interval_95).collect();
    let t = TableBuilder::new("", "", &all);
    let head = "95 % interval (scatter and declared)";
    table.columns.push(t.interval("interval_95_with_declared", head, |interval| *interval));
    table
}

/// Two masses; behind a gear whose efficiency is not declared every row is marked as apparent.
fn flexible_table(report: &FlexibleReport, mounted: &str) -> ResultTable {
    let caption = format!("Two masses: motor, chain and load from motor-side signals{mounted}.");
    let mut table = coefficient_table(TWO_MASS, caption, &report.coefficients, Pieces::All);
    if report.is_apparent {
        // The rotor lies before the gear, and frequencies do not care.
        let is_apparent = |name: &str| !matches!(name, "m" | "J_m" | "f_antiresonance" | "f_resonance");
        let words = |c: &ServoCoefficient| {
            format!("{}{}", c.name, if is_apparent(&c.name) { " (apparent, through the gear)" } else { "" })
        };
        let t = TableBuilder::new("", "", &report.coefficients);
        table.columns[0].head.clear();
        let told = [t.text("", "coefficient", words), t.flag("is_apparent", "", |c| is_apparent(&c.name))];
        table.columns.splice(1..1, told);
    }
    table
}

/// Repeats by speed and direction.
fn repeatability_table(cells: &[Repeatability], has_gear: bool) -> ResultTable {
    let gear = if has_gear { ", with the gear taken as lossless," } else { "" };
    let caption = format!("Mean drive force of the steady windows{gear} and its standard deviation from run to run.");
    let t = TableBuilder::new("repeats", caption, cells);
    t.build(vec![
        t.number("speed_m_s", "speed [m/s]", |c| c.speed_m_s).plain(3),
        t.text("direction", "direction", |c| if c.direction > 0.0 { "forward" } else { "backward" }.to_owned()),
        t.number("force_n", "force [N]", |c| c.force_n).plain(4),
        t.number("std_n", "std [N]", |c| c.std_n).significant(2),
        t.number("relative_std", "relative std", |c| c.std_n.map(|s| s / c.force_n.abs())).percent(),
        t.count("runs", "runs", |c| c.runs),
    ])
}

fn force_chart(model: &Model) -> Chart {
    let r = &model.report;
    let axis = r.fit.shape.coordinate.names();
    let predicted: Vec<f64> = r.rows.force_n.iter().zip(&r.residuals_n).map(|(f, e)| f - e).collect();
    // A line through all runs would run back from the end of each to the start of the next.
    let series = |name: &str, y: &[f64], mark| -> Vec<Series> {
        let of_run = |run: &Range<usize>| Series {
            name: name.to_owned(),
            mark,
            x: r.rows.time_s[run.clone()].to_vec(),
            y: y[run.clone()].to_vec(),
            ..Series::default()
        };
        r.runs.iter().map(of_run).collect()
    };
    let (words, unit, title, caption, names) = if r.fit.shape.is_simulated {
        (
            "speed",
            axis.speed[1],
            "Speed".to_owned(),
            "Measured and simulated speed".to_owned(),
            ["measured", "simulated"],
        )
    } else {
        let (title, caption) =
            (format!("Drive {}", axis.words), format!("Drive {} of the command and of the model", axis.words));
        (axis.words, axis.load, title, caption, ["command", "model"])
    };
    Chart {
        name: format!("{words}-{}", model.name.replace(' ', "-")),
        title: format!("{title} and model, friction {}", model.name),
        caption: format!("{caption}, and the residual: one line per run, each against its own time."),
        x_label: "time [s]".to_owned(),
        panels: vec![
            ChartPanel {
                y_label: format!("{words} [{unit}]"),
                series: [series(names[0], &r.rows.force_n, Mark::Line), series(names[1], &predicted, Mark::Dashed)]
                    .concat(),
                ..ChartPanel::default()
            },
            ChartPanel {
                y_label: format!("residual [{unit}]"),
                series: series("residual", &r.residuals_n, Mark::Line),
                ..ChartPanel::default()
            },
        ],
        ..Chart::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::report::of_runs as of_several;
    use crate::servo::rows::Rows;
    use crate::servo::{Chain, Friction};

    /// Six runs, each in its own time from zero: a line that went through all would run back five times.
    #[test]
    fn the_figure_has_one_line_a_run() {
        let run = |k: u32| {
            let time_s: Vec<f64> = (0..60).map(|i| 0.1 * f64::from(i)).collect();
            let speed: Vec<f64> = time_s.iter().map(|t| (t + 0.3 * f64::from(k)).sin()).collect();
            Rows {
                rate_hz: 10.0,
                force_n: speed
                    .iter()
                    .zip(&time_s)
                    .map(|(v, t)| 3.0 * v + v.signum() + 0.01 * (7.0 * t).cos())
                    .collect(),
                names: vec![("F_v".to_owned(), "N s/m".into()), ("F_c".to_owned(), "N".into())],
                columns: vec![speed.clone(), speed.iter().map(|v| v.signum()).collect()],
                time_s,
            }
        };
        let runs: Vec<Rows> = (0..6).map(run).collect();
        let report = of_several(runs, &Chain::new(35.0, Friction::default())).unwrap();
        let chart = force_chart(&Model { name: CONSTANT.to_owned(), report });
        let [force, residual] = chart.panels.as_slice() else { panic!("two panels") };
        assert_eq!(
            (force.series.len(), residual.series.len()),
            (12, 6),
            "command and model of six runs, and the residual"
        );
        for series in force.series.iter().chain(&residual.series) {
            assert_eq!(series.x.len(), 60, "a run whole");
            assert!(series.x.windows(2).all(|t| t[0] < t[1]), "time runs forward along each line");
        }
        let names: std::collections::BTreeSet<&str> = force.series.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names.len(), 2, "one entry of the legend for all commands, one for all models");
    }
}
