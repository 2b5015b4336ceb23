//! The comparison with measurements by ASME V&V 20, as a page and a terminal show it.

use froude_records::campaign::SourceKind;
use froude_records::comparison::Validation;
use froude_records::number::{percent, significant};
use froude_records::page::{Chart, ChartPanel, DocumentSection, Mark, Scale, Series, TextTable};

use crate::dataset::Dataset;
use crate::result::SourceResult;
use crate::validation::{ComparedFlow, Validated};

/// Fewest angles that a chart against the angle is drawn of.
const FEWEST_ANGLES: usize = 3;

/// Whether a source of this kind is measured, so that a computation can be held against it.
#[must_use]
pub const fn is_measured(kind: SourceKind) -> bool {
    matches!(kind, SourceKind::Tank | SourceKind::Towing | SourceKind::Published)
}

/// What a person reads first: loads, and the coefficients of the recommended law; then the coefficients of all others. Empty where nothing was compared.
#[must_use]
pub fn sections(found: &Validated, result: &SourceResult) -> Vec<DocumentSection> {
    let (loads, coefficients): (Vec<&Validation>, Vec<&Validation>) =
        found.numbers.iter().partition(|number| number.flows.is_some());
    let recommended = result.estimates.iter().find(|e| e.recommended).map(|e| e.id.as_str());
    let (first, others): (Vec<&Validation>, Vec<&Validation>) =
        coefficients.into_iter().partition(|number| Some(number.simulation.as_str()) == recommended);
    let mut out = Vec::new();
    if !loads.is_empty() || !first.is_empty() || !found.without_range.is_empty() {
        out.push(DocumentSection {
            title: format!("Validation of {}", result.name),
            paragraphs: paragraphs(found, &loads),
            tables: [load_table(&loads), coefficient_table(&first)].into_iter().flatten().collect(),
            charts: chart(found, &result.data, &result.name).into_iter().collect(),
        });
    }
    out.extend(coefficient_table(&others).map(|table| DocumentSection {
        title: format!("Validation of {}: coefficients of the other laws", result.name),
        tables: vec![table],
        ..DocumentSection::default()
    }));
    out
}

fn paragraphs(found: &Validated, loads: &[&Validation]) -> Vec<String> {
    let mut out = vec![
        "By ASME V&V 20: E = S − D is what was computed less what was measured, and u_val the standard uncertainty of everything in it but the error of the model, from mesh and iterations, inputs, and the measurement. The error of the model lies in E ± 2 u_val. Of a load, numbers are roots of mean squares over the flows.".to_owned(),
    ];
    if loads.iter().any(|load| load.u_data.is_none()) {
        out.push(
            "A record that states no uncertainty gives u_val without the measurement's part: an error of the model that stands on it may be one of the tank.".to_owned(),
        );
    }
    if !found.without_range.is_empty() {
        out.push(format!(
            "Loads are not compared with {}, which states no range of speed: nobody knows where its law holds.",
            found.without_range.join(", ")
        ));
    }
    for load in loads {
        let (Some(flows), Some(beyond), Some(ratio)) = (load.flows, load.beyond, load.ratio) else { continue };
        let declared = if load.declared_model_form == 0.0 {
            "none is declared".to_owned()
        } else {
            format!("{} is declared", percent(load.declared_model_form / load.computed))
        };
        out.push(format!(
            "Computed {} is {} times that of {}. {} |E| has a root of mean squares of {} of the computed load's, and for the form of the model {declared}.",
            load.quantity,
            significant(ratio, 3),
            load.data,
            if load.u_validation > 0.0 {
                format!("|E| is beyond 2 u_val in {beyond} of {flows} flows.")
            } else {
                "No uncertainty is stated on either side, so that all of E stands against the model.".to_owned()
            },
            percent(load.error / load.computed),
        ));
    }
    out
}

fn known(u: Option<f64>) -> String {
    u.map_or_else(|| "not stated".to_owned(), |u| significant(u, 2))
}

fn load_table(loads: &[&Validation]) -> Option<TextTable> {
    let row = |v: &&Validation| {
        vec![
            v.quantity.clone(),
            v.data.clone(),
            v.flows.unwrap_or(0).to_string(),
            significant(v.computed, 3),
            significant(v.measured, 3),
            v.ratio.map_or_else(String::new, |ratio| significant(ratio, 3)),
            significant(v.error, 3),
            significant(v.u_numerical, 2),
            significant(v.u_input, 2),
            known(v.u_data),
            significant(v.u_validation, 2),
            v.beyond.unwrap_or(0).to_string(),
            v.unit.clone(),
        ]
    };
    let head = [
        "load",
        "measured",
        "flows",
        "S",
        "D",
        "S over D",
        "E",
        "u_num",
        "u_input",
        "u_D",
        "u_val",
        "beyond 2 u_val",
        "unit",
    ];
    (!loads.is_empty()).then(|| TextTable {
        caption: "Computed and measured loads".to_owned(),
        head: head.map(str::to_owned).to_vec(),
        rows: loads.iter().map(row).collect(),
    })
}

fn coefficient_table(coefficients: &[&Validation]) -> Option<TextTable> {
    let row = |v: &&Validation| {
        vec![
            v.quantity.clone(),
            v.simulation.clone(),
            v.data.clone(),
            significant(v.computed, 3),
            significant(v.measured, 3),
            significant(v.error, 2),
            significant(v.u_numerical, 2),
            significant(v.u_input, 2),
            significant(v.u_fit, 2),
            known(v.u_data),
            significant(v.u_validation, 2),
            if v.is_beyond() { "beyond 2 u_val" } else { "within" }.to_owned(),
            v.unit.clone(),
        ]
    };
    let head = [
        "coefficient",
        "computed",
        "measured",
        "S",
        "D",
        "E",
        "u_num",
        "u_input",
        "u_fit",
        "u_D",
        "u_val",
        "E is",
        "unit",
    ];
    (!coefficients.is_empty()).then(|| TextTable {
        caption: "Computed and measured coefficients".to_owned(),
        head: head.map(str::to_owned).to_vec(),
        rows: coefficients.iter().map(row).collect(),
    })
}

/// Loads against the angle at the highest speed that has several, of the configuration that has the most flows.
fn chart(found: &Validated, data: &Dataset, name: &str) -> Option<Chart> {
    let (speed, angle) = (data.values("speed")?, data.values("angle")?);
    let configuration = |flow: &ComparedFlow| data.configuration.get(flow.row).map_or("", String::as_str);
    let count = |of: &dyn Fn(&&ComparedFlow) -> bool| {
        let mut angles: Vec<u64> = found.flows.iter().filter(of).map(|f| angle[f.row].to_bits()).collect();
        angles.sort_unstable();
        angles.dedup();
        angles.len()
    };
    let place = found.flows.iter().map(|f| (configuration(f), speed[f.row]));
    let (body, at) = place
        .filter(|(body, at)| count(&|f| configuration(f) == *body && speed[f.row] == *at) >= FEWEST_ANGLES)
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let is_here = |f: &&ComparedFlow| configuration(f) == body && speed[f.row] == at;
    let mut panels: Vec<ChartPanel> = Vec::new();
    let mut loads: Vec<&str> = Vec::new();
    for flow in found.flows.iter().filter(is_here) {
        if !loads.contains(&flow.load.as_str()) {
            loads.push(&flow.load);
        }
    }
    for load in loads {
        let mut own: Vec<&ComparedFlow> = found.flows.iter().filter(|f| is_here(f) && f.load == load).collect();
        own.sort_by(|a, b| angle[a.row].total_cmp(&angle[b.row]));
        let unit = own.first().map_or("", |f| f.unit.as_str());
        let mut series: Vec<Series> = Vec::new();
        for flow in &own {
            let x = angle[flow.row].to_degrees();
            let half = 2.0 * flow.u_numerical.hypot(flow.u_input);
            if !series.iter().any(|s| s.mark == Mark::Points && s.x.contains(&x)) {
                add(&mut series, name, Mark::Points, (x, flow.computed, Some(half)));
            }
            add(&mut series, &flow.data, Mark::Dashed, (x, flow.measured, flow.u_data.map(|u| 2.0 * u)));
        }
        panels.push(ChartPanel { y_label: format!("{load} [{unit}]"), y_scale: Scale::Linear, series });
    }
    Some(Chart {
        name: "validation".to_owned(),
        title: "Computed and measured loads against the angle".to_owned(),
        caption: format!(
            "{} at {} m/s: computed loads with twice the uncertainty of mesh, iterations and inputs, and what the measured laws give with twice theirs where it is stated.",
            if body.is_empty() { "The body" } else { body },
            significant(at, 3),
        ),
        x_label: "angle [deg]".to_owned(),
        x_scale: Scale::Linear,
        panels,
    })
}

/// Adds a point to the series of a name.
fn add(series: &mut Vec<Series>, name: &str, mark: Mark, (x, y, half): (f64, f64, Option<f64>)) {
    let at = series.iter().position(|s| s.name == name).unwrap_or(series.len());
    if at == series.len() {
        series.push(Series { name: name.to_owned(), mark, ..Series::default() });
    }
    let own = &mut series[at];
    own.x.push(x);
    own.y.push(y);
    if let Some(half) = half {
        own.low.push(y - half);
        own.high.push(y + half);
    }
}
