//! What the mesh and the domain do to the forces of a campaign, for a person and for a program.

use froude_records::block::{Block, ResultColumn, ResultTable, Section, TableBuilder, facts};
use froude_records::number::{count, percent, significant};
use froude_records::page::{Chart, ChartPanel, Mark, Series};
use froude_records::text::counted;

use super::loads::{LOADS, loads_of, unit};
use crate::case::{Case, Flow};
use crate::collect::Collected as Row;
use crate::family::refinement_ratio;
use crate::grid_error::GridError;
use crate::numerical::Numerical;
use crate::study::{DIRECTIONS, Study};

/// Points of a drawn law.
const DRAWN: usize = 40;

/// A section for each setting that was computed again, and one for the correction.
pub(super) fn blocks(numerical: &Numerical, rows: &[Row]) -> Vec<Block> {
    let loads = loads_of(rows.iter().all(|row| row.case.is_half));
    let mut out: Vec<Block> = numerical.studies.iter().map(|study| of_study(study, &loads).into()).collect();
    out.extend(of_fine(numerical, &loads));
    out
}

/// What stands at the head of all: how far forces are known, or what would say it.
pub(super) fn sentences(numerical: &Numerical, rows: &[Row]) -> Vec<String> {
    let largest = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).fold(0.0, f64::max);
    // Of f_x and f_y, as a part of the largest; one that is zero throughout has no part.
    let at_most = |of: &dyn Fn(&Case) -> Option<[f64; 6]>| {
        let part = |k: usize| {
            let most = largest(&|row| row.loads[k].abs());
            let found = largest(&|row| of(&row.case).map_or(0.0, |loads| loads[k].abs()));
            (most > 0.0).then(|| format!("{} of the largest {}", percent(found / most), LOADS[k]))
        };
        format!("{} at most", [0, 1].into_iter().filter_map(part).collect::<Vec<_>>().join(" and "))
    };
    let mut out = Vec::new();
    let families = numerical.studies.iter().filter(|study| study.grids.len() > 1).count();
    let known = rows.first().and_then(|row| numerical.std_of_mesh(&row.case));
    match (known, numerical.fine.is_empty()) {
        (None, _) => out.push(
            "the error of the mesh is in no interval: of an O-grid a [[source.cfd.study]] or fine = { mesh = \"medium\" } of [source.cfd] computes it; of cubes a second campaign \
             with a smaller surface_cell shows it"
                .to_owned(),
        ),
        (Some(_), true) => out.push(format!(
            "standard uncertainty of the mesh, by {}: {}",
            counted(families, "family of grids", "families of grids"),
            at_most(&|case| numerical.std_of_mesh(case))
        )),
        (Some(_), false) => {
            out.push(format!(
                "loads are corrected to the finer mesh by {}: {}; the table says by how much",
                counted(numerical.fine.len(), "case", "cases"),
                at_most(&|case| Some(numerical.correction(case)))
            ));
            let left = if families == 0 { "the index of two grids" } else { "the families of grids" };
            out.push(format!(
                "standard uncertainty of the mesh that is left, by {left} and by leaving each of these cases out: {}",
                at_most(&|case| numerical.std_of_mesh(case))
            ));
        }
    }
    if rows.first().is_some_and(|row| numerical.endless(&row.case).is_some()) {
        out.push(format!("an unbounded domain would change loads by {}", at_most(&|case| numerical.endless(case))));
    }
    if !numerical.alone.is_empty() {
        out.push(format!(
            "{} no result to be compared with: {}",
            counted(numerical.alone.len(), "case that is computed again has", "cases that are computed again have"),
            numerical.alone.join(", ")
        ));
    }
    out
}

fn of_study(study: &Study, loads: &[usize]) -> Section {
    let f = facts("", "", study);
    let mut blocks: Vec<Block> = vec![f.build(vec![f.text("case", "", |study| study.first.case.id.clone())]).into()];
    if study.grids.len() > 1 {
        blocks.push(Block::text("", vec!["An observed order is given if the loads converge monotonically, with changes above the iterative error, and 0.5 ≤ p ≤ 3. Digits in brackets behind a load are the standard deviation of its iterative error.".to_owned()]));
        blocks.push(grid_table(study, loads).into());
        blocks.push(error_table(study, loads).into());
        blocks.extend(grid_chart(study, loads).map(Block::Chart));
    }
    if !study.domains.is_empty() {
        blocks.push(domain_table(study, loads).into());
    }
    let title = format!("Grids and domains of {}", setting(&study.first.case));
    Section { key: "studies[]".to_owned(), title, blocks, ..Section::default() }
}

/// Its loads, with the standard deviation of their iterative errors.
fn load_columns<'r, R>(t: &TableBuilder<'r, R>, loads: &[usize], of: fn(&'r R) -> &'r Row) -> Vec<ResultColumn> {
    let one = |k: &usize| {
        let keys = [format!("loads/{}", LOADS[*k]), format!("std_iterative/{}", LOADS[*k])];
        let head = format!("{} [{}]", LOADS[*k], unit(*k));
        let std = |row| of(row).outcome.std_iterative.map(|std| std[*k]);
        t.uncertain([&keys[0], &keys[1]], &head, |row| of(row).loads[*k], std)
    };
    loads.iter().map(one).collect()
}

/// `H4LT at 0.3 m/s and 90°`.
fn setting(case: &Case) -> String {
    let Flow { speed_m_s, angle_rad, pitch_rad } = case.flow;
    let name = if case.configuration.is_empty() { "the body" } else { &case.configuration };
    let pitch = if pitch_rad == 0.0 {
        String::new()
    } else {
        format!(", {}° out of the plane", significant(pitch_rad.to_degrees(), 4))
    };
    format!("{name} at {} m/s and {}°{pitch}", significant(speed_m_s, 4), significant(angle_rad.to_degrees(), 4))
}

fn level(level: i32) -> String {
    match level {
        0 => "the campaign's".to_owned(),
        _ => crate::again::Again::Grid(level).suffix(),
    }
}

/// Size of a cell over that of the finest grid.
fn size(study: &Study, row: &Row) -> f64 {
    refinement_ratio(study.finest_cells(), row.outcome.cells, DIRECTIONS)
}

fn grid_table(study: &Study, loads: &[usize]) -> ResultTable {
    let caption =
        format!("{}: {}, finer by √2 each", setting(&study.first.case), counted(study.grids.len(), "grid", "grids"));
    let t = TableBuilder::new("grids", caption, &study.grids);
    let mut columns = vec![
        t.text("", "grid", |(step, _)| level(*step)),
        t.number("step", "", |(step, _)| f64::from(*step)),
        t.text("case", "", |(_, row)| row.case.id.clone()),
        t.count("cells", "cells", |(_, row)| row.outcome.cells),
        t.number("cell_size", "cell size [1]", |(_, row)| size(study, row)).significant(3),
    ];
    columns.extend(load_columns(&t, loads, |(_, row)| row));
    t.build(columns)
}

fn error_table(study: &Study, loads: &[usize]) -> ResultTable {
    let found: Vec<(usize, Result<GridError, String>)> = loads.iter().map(|k| (*k, study.error(*k))).collect();
    let caption = format!("{}: 95 % half-widths from the grid study alone", setting(&study.first.case));
    let t = TableBuilder::new("error", caption, &found);
    let of =
        |row: &(usize, Result<GridError, String>), of: &dyn Fn(&GridError) -> Option<f64>| of(row.1.as_ref().ok()?);
    t.build(vec![
        t.text("load", "load", |(k, _)| LOADS[*k].to_owned()),
        t.text("unit", "unit", |(k, _)| unit(*k).to_owned()),
        t.number("value", "value, campaign grid", |(k, _)| study.first.loads[*k]),
        t.number("order", "observed order", |row| of(row, &|e| e.order)).places(2),
        t.numbers("orders", "", |(_, found)| found.as_ref().ok().map(orders)),
        t.number("extrapolated", "extrapolated value", |row| of(row, &|e| e.extrapolated)),
        t.number("expanded_of_campaign", "U95, campaign grid", |row| {
            of(row, &|e| Some(e.at(size(study, &study.first))))
        })
        .significant(2),
        t.number("expanded_of_finest", "U95, finest grid", |row| of(row, &|e| e.of_grids.first().copied()))
            .significant(2),
        t.text("reason", "reason", |(_, found)| found.as_ref().map_or_else(Clone::clone, |e| e.reason.clone())),
    ])
}

/// Observed orders; NaN where none could be found.
fn orders(found: &GridError) -> Vec<f64> {
    found.orders.iter().map(|order| order.unwrap_or(f64::NAN)).collect()
}

fn domain_table(study: &Study, loads: &[usize]) -> ResultTable {
    let caption = format!(
        "{}: change of loads with the domain, over ½ρU²A and for moments the length",
        setting(&study.first.case)
    );
    let t = TableBuilder::new("domains", caption, &study.domains);
    let mut columns = vec![
        t.number("radius", "radius over length [1]", |(radius, _)| *radius).significant(3),
        t.text("case", "", |(_, row)| row.case.id.clone()),
        t.count("cells", "cells", |(_, row)| row.outcome.cells),
    ];
    for k in loads {
        let scale = study.first.case.load_scales()[*k];
        let change = |row: &Row| (row.loads[*k] - study.first.loads[*k]) / scale;
        columns.push(t.number(&format!("loads/{}", LOADS[*k]), "", |(_, row)| row.loads[*k]));
        columns.push(t.number(&format!("change/{}", LOADS[*k]), LOADS[*k], |(_, row)| change(row)).significant(2));
    }
    t.build(columns)
}

/// Loads over the size of cells, with the law through them and the interval of the campaign's grid.
fn grid_chart(study: &Study, loads: &[usize]) -> Option<Chart> {
    let panel = |k: &usize| {
        let found = study.error(*k).ok()?;
        let values = study.grids.iter().map(|(_, row)| row.loads[*k]);
        let stds: Vec<f64> =
            study.grids.iter().map(|(_, row)| row.outcome.std_iterative.map_or(0.0, |std| std[*k])).collect();
        let x: Vec<f64> = study.grids.iter().map(|(_, row)| size(study, row)).collect();
        let y: Vec<f64> = values.collect();
        let grids = Series {
            name: "grids".to_owned(),
            mark: Mark::Points,
            low: y.iter().zip(&stds).map(|(y, std)| y - std).collect(),
            high: y.iter().zip(&stds).map(|(y, std)| y + std).collect(),
            x,
            y,
        };
        let own = study.first.loads[*k];
        let at = size(study, &study.first);
        let expanded = found.at(at);
        let interval = Series {
            name: "U95, campaign grid".to_owned(),
            mark: Mark::Points,
            x: vec![at],
            y: vec![own],
            low: vec![own - expanded],
            high: vec![own + expanded],
        };
        let mut series = vec![interval, grids];
        series.extend(law(&found, at));
        Some(ChartPanel { y_label: format!("{} [{}]", LOADS[*k], unit(*k)), series, ..ChartPanel::default() })
    };
    let panels: Vec<ChartPanel> = loads.iter().filter_map(panel).collect();
    (!panels.is_empty()).then(|| Chart {
        name: format!("grids-{}", study.first.case.id),
        title: format!("Loads of {} over the size of cells", setting(&study.first.case)),
        caption: "Cell size over that of the finest grid; dashed: the law of the observed order, to its extrapolated value at 0."
            .to_owned(),
        x_label: "cell size [1]".to_owned(),
        panels,
        ..Chart::default()
    })
}

/// φ₀ + (φ₁ − φ₀) hᵖ, where an order is claimed.
fn law(found: &GridError, to: f64) -> Option<Series> {
    let (order, limit) = (found.order?, found.extrapolated?);
    let x: Vec<f64> = (0..=DRAWN).map(|i| to * i as f64 / DRAWN as f64).collect();
    let y = x.iter().map(|h| limit + (found.value - limit) * h.powf(order)).collect();
    Some(Series { name: "law of the order".to_owned(), mark: Mark::Dashed, x, y, ..Series::default() })
}

fn of_fine(numerical: &Numerical, loads: &[usize]) -> Vec<Block> {
    let mut out: Vec<Block> = Vec::new();
    let f = facts("", "", numerical);
    out.push(f.build(vec![f.texts("without_first", "", |n| n.alone.clone())]).into());
    let t = TableBuilder::new("fine", "", &numerical.fine);
    let mut columns = vec![
        t.text("case", "", |[own, _]| own.case.id.clone()),
        t.count("cells", "", |[own, _]| own.outcome.cells),
        t.count("cells_fine", "", |[_, fine]| fine.outcome.cells),
    ];
    for k in loads {
        columns.push(t.number(&format!("loads/{}", LOADS[*k]), "", |[own, _]| own.loads[*k]));
        columns.push(t.number(&format!("fine/{}", LOADS[*k]), "", |[_, fine]| fine.loads[*k]));
    }
    out.push(t.build(columns).into());
    let Some(left_out) = numerical.left_out else { return out };
    let points = numerical.difference.points();
    let panel = |k: &usize| ChartPanel {
        y_label: format!("Δ{} [1]", LOADS[*k]),
        series: configurations(numerical)
            .map(|name| {
                let own = || numerical.difference.points().iter().filter(|p| p.case.configuration == name);
                Series {
                    name: name.to_owned(),
                    mark: Mark::Points,
                    x: own().map(|p| p.case.flow.angle_rad.to_degrees()).collect(),
                    y: own().map(|p| p.values[*k]).collect(),
                    ..Series::default()
                }
            })
            .collect(),
        ..ChartPanel::default()
    };
    let chart = Chart {
        name: "fine-less-campaign".to_owned(),
        title: "What the finer mesh changes".to_owned(),
        caption: "Fine minus campaign mesh, over ½ρU²A and for moments the length: what loads are corrected by, between the angles.".to_owned(),
        x_label: "angle [deg]".to_owned(),
        panels: loads.iter().map(panel).collect(),
        ..Chart::default()
    };
    let cells = numerical.fine.first().map_or(0, |[_, fine]| fine.outcome.cells);
    let caption = format!("{} on {} cells", counted(points.len(), "case", "cases"), count(cells));
    let t = TableBuilder::new("differences", caption, loads);
    let largest = |k: usize| points.iter().map(|p| p.values[k].abs()).fold(0.0, f64::max);
    let table = t.build(vec![
        t.text("load", "load", |k| LOADS[*k].to_owned()),
        t.number("largest", "largest difference [1]", |k| largest(*k)).significant(2),
        t.number("missed_where_left_out", "leave-one-out error [1]", |k| left_out[*k]).significant(2),
    ]);
    let said = vec!["Differences over ½ρU²A are averaged over speeds and linear between angles, per configuration; absolute, as a force that changes sign has no ratio.".to_owned()];
    let blocks = vec![Block::text("", said), table.into(), Block::Chart(chart)];
    out.push(Section { title: "Correction to the finer mesh".to_owned(), blocks, ..Section::default() }.into());
    out
}

/// Names of configurations with a fine case, each once.
fn configurations(numerical: &Numerical) -> impl Iterator<Item = &str> {
    let points = numerical.difference.points();
    let first = |(i, name): &(usize, &str)| points.iter().position(|p| p.case.configuration == **name) == Some(*i);
    points.iter().map(|p| p.case.configuration.as_str()).enumerate().filter(first).map(|(_, name)| name)
}
