//! What the mesh and the domain do to the forces of a campaign, for a person and for a program.

use froude_cfd::case::{Case, Flow};
use froude_cfd::collect::Collected as Row;
use froude_cfd::family::refinement_ratio;
use froude_cfd::grid_error::GridError;
use froude_cfd::numerical::Numerical;
use froude_cfd::study::{DIRECTIONS, Study};
use froude_records::number::{count, percent, significant};
use froude_records::page::{Chart, ChartPanel, DocumentSection, Mark, Series, TextTable};
use froude_records::text::counted;
use serde_json::{Value, json};

use super::collect::{LOADS, loads_of, unit};

/// Points of a drawn law.
const DRAWN: usize = 40;

/// What a person reads: a section for each setting that was computed again, and one for the correction.
pub(super) fn sections(numerical: &Numerical, rows: &[Row]) -> Vec<DocumentSection> {
    let is_half = rows.iter().all(|row| row.case.is_half);
    let mut out: Vec<DocumentSection> =
        numerical.studies.iter().map(|study| of_study(study, &loads_of(is_half))).collect();
    out.extend(of_fine(numerical, &loads_of(is_half)));
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
        out.push(format!("an endless domain would change loads by {}", at_most(&|case| numerical.endless(case))));
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

fn of_study(study: &Study, loads: &[usize]) -> DocumentSection {
    let mut out = DocumentSection {
        title: format!("Grids and domains of {}", setting(&study.first.case)),
        ..DocumentSection::default()
    };
    if study.grids.len() > 1 {
        out.paragraphs.push("An order is claimed where all grids approach a limit from one side by steps above their iterative error, and it lies between 0.5 and 3. ± behind a load is the standard deviation of its iterative error.".to_owned());
        out.tables.push(grid_table(study, loads));
        out.tables.push(error_table(study, loads));
        out.charts.extend(grid_chart(study, loads));
    }
    if !study.domains.is_empty() {
        out.tables.push(domain_table(study, loads));
    }
    out
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
        _ => froude_cfd::again::Again::Grid(level).suffix(),
    }
}

/// Size of a cell over that of the finest grid.
fn size(study: &Study, row: &Row) -> f64 {
    refinement_ratio(study.finest_cells(), row.outcome.cells, DIRECTIONS)
}

fn grid_table(study: &Study, loads: &[usize]) -> TextTable {
    let value = |row: &Row, k: usize| {
        let std = row.outcome.std_iterative.map_or_else(String::new, |std| format!(" ± {}", significant(std[k], 1)));
        significant(row.loads[k], 4) + &std
    };
    let head = ["grid", "cells", "cell size [1]"].map(str::to_owned);
    TextTable {
        caption: format!(
            "{}: {}, finer by √2 each",
            setting(&study.first.case),
            counted(study.grids.len(), "grid", "grids")
        ),
        head: head.into_iter().chain(loads.iter().map(|k| format!("{} [{}]", LOADS[*k], unit(*k)))).collect(),
        rows: (study.grids.iter())
            .map(|(step, row)| {
                let first = [level(*step), count(row.outcome.cells), significant(size(study, row), 3)];
                first.into_iter().chain(loads.iter().map(|k| value(row, *k))).collect()
            })
            .collect(),
    }
}

fn error_table(study: &Study, loads: &[usize]) -> TextTable {
    let row = |k: &usize| {
        let name = format!("{} [{}]", LOADS[*k], unit(*k));
        match study.error(*k) {
            Ok(found) => vec![
                name,
                significant(study.first.loads[*k], 4),
                found.order.map_or_else(|| "none".to_owned(), |p| format!("{p:.2}")),
                found.extrapolated.map_or_else(String::new, |limit| significant(limit, 4)),
                significant(found.at(size(study, &study.first)), 2),
                significant(found.of_grids.first().copied().unwrap_or(0.0), 2),
                found.reason,
            ],
            Err(why) => vec![
                name,
                significant(study.first.loads[*k], 4),
                String::new(),
                String::new(),
                String::new(),
                String::new(),
                why.to_string(),
            ],
        }
    };
    let head = ["load", "the campaign's grid", "order", "limit", "its 95 %", "95 % of the finest", "because"];
    TextTable {
        caption: format!("{}: half-widths of the intervals by the grids alone", setting(&study.first.case)),
        head: head.map(str::to_owned).to_vec(),
        rows: loads.iter().map(row).collect(),
    }
}

fn domain_table(study: &Study, loads: &[usize]) -> TextTable {
    let change = |row: &Row, k: usize| {
        let scale = study.first.case.load_scales()[k];
        format!("{:+.1e}", (row.loads[k] - study.first.loads[k]) / scale)
    };
    let head = ["radius over length [1]", "cells"].map(str::to_owned);
    TextTable {
        caption: format!(
            "{}: change of loads with the domain, over ½ρU²A and for moments the length",
            setting(&study.first.case)
        ),
        head: head.into_iter().chain(loads.iter().map(|k| LOADS[*k].to_owned())).collect(),
        rows: (study.domains.iter())
            .map(|(radius, row)| {
                let first = [significant(*radius, 3), count(row.outcome.cells)];
                first.into_iter().chain(loads.iter().map(|k| change(row, *k))).collect()
            })
            .collect(),
    }
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
            name: "95 % of the campaign's grid".to_owned(),
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
        caption: "Cell size over that of the finest grid; dashed: the law of the claimed order, to its limit at 0."
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

fn of_fine(numerical: &Numerical, loads: &[usize]) -> Option<DocumentSection> {
    let left_out = numerical.left_out?;
    let row = |k: &usize| {
        let largest = numerical.difference.points().iter().map(|p| p.values[*k].abs()).fold(0.0, f64::max);
        vec![LOADS[*k].to_owned(), format!("{largest:.1e}"), format!("{:.1e}", left_out[*k])]
    };
    let cells = numerical.fine.first().map_or(0, |[_, fine]| fine.outcome.cells);
    let angles: Vec<f64> = numerical.difference.points().iter().map(|p| p.case.flow.angle_rad.to_degrees()).collect();
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
        caption: "Fine less the campaign's mesh, over ½ρU²A and for moments the length: what loads are corrected by, between the angles.".to_owned(),
        x_label: "angle [deg]".to_owned(),
        panels: loads.iter().map(panel).collect(),
        ..Chart::default()
    };
    let head = ["load", "largest difference [1]", "missed where left out [1]"];
    Some(DocumentSection {
        title: "Correction to the finer mesh".to_owned(),
        paragraphs: vec!["Differences over ½ρU²A are averaged over speeds and linear between angles, per configuration; absolute, as a force that changes sign has no ratio.".to_owned()],
        tables: vec![TextTable {
            caption: format!("{} on {} cells", counted(angles.len(), "case", "cases"), count(cells)),
            head: head.map(str::to_owned).to_vec(),
            rows: loads.iter().map(row).collect(),
        }],
        charts: vec![chart],
    })
}

/// Names of configurations with a fine case, each once.
fn configurations(numerical: &Numerical) -> impl Iterator<Item = &str> {
    let points = numerical.difference.points();
    let first = |(i, name): &(usize, &str)| points.iter().position(|p| p.case.configuration == **name) == Some(*i);
    points.iter().map(|p| p.case.configuration.as_str()).enumerate().filter(first).map(|(_, name)| name)
}

/// The same for a program, in SI.
pub(super) fn as_json(numerical: &Numerical) -> Value {
    let named = |values: &[f64; 6]| -> Value {
        LOADS
            .iter()
            .zip(values)
            .map(|(name, value)| ((*name).to_owned(), json!(value)))
            .collect::<serde_json::Map<_, _>>()
            .into()
    };
    let on = |row: &Row| json!({"case": row.case.id, "cells": row.outcome.cells, "loads": named(&row.loads), "std_iterative": row.outcome.std_iterative.as_ref().map(named)});
    let with = |key: &str, value: Value, mut row: Value| {
        if let Some(object) = row.as_object_mut() {
            object.insert(key.to_owned(), value);
        }
        row
    };
    let error = |study: &Study, k: usize| match study.error(k) {
        Ok(found) => json!({
            "order": found.order,
            "orders": found.orders,
            "extrapolated": found.extrapolated,
            "expanded_of_campaign": found.at(size(study, &study.first)),
            "expanded_of_finest": found.of_grids.first(),
            "reason": found.reason,
        }),
        Err(why) => json!({"reason": why.to_string()}),
    };
    let study = |study: &Study| {
        json!({
            "case": study.first.case.id,
            "grids": study.grids.iter().map(|(step, row)| with("step", json!(step), on(row))).collect::<Vec<_>>(),
            "error": LOADS.iter().enumerate().map(|(k, name)| ((*name).to_owned(), error(study, k))).collect::<serde_json::Map<_, _>>(),
            "domains": study.domains.iter().map(|(radius, row)| with("radius", json!(radius), on(row))).collect::<Vec<_>>(),
        })
    };
    let fine = |[own, fine]: &[Row; 2]| json!({"case": own.case.id, "cells": [own.outcome.cells, fine.outcome.cells], "loads": named(&own.loads), "fine": named(&fine.loads)});
    json!({
        "studies": numerical.studies.iter().map(study).collect::<Vec<_>>(),
        "fine": numerical.fine.iter().map(fine).collect::<Vec<_>>(),
        "left_out": numerical.left_out.as_ref().map(named),
        "without_first": numerical.alone,
    })
}
