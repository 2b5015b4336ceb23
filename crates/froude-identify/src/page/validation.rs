//! The comparison with measurements by ASME V&V 20, as a page and a terminal show it.

use froude_records::block::{Block, Section, TableBuilder};
use froude_records::campaign::SourceKind;
use froude_records::comparison::Validation;
use froude_records::number::{percent, significant};
use froude_records::page::{Chart, ChartPanel, Mark, Scale, Series};

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
pub fn sections(found: &Validated, result: &SourceResult) -> Vec<Section> {
    let (loads, coefficients): (Vec<&Validation>, Vec<&Validation>) =
        found.numbers.iter().partition(|number| number.flows.is_some());
    let recommended = result.estimates.iter().find(|e| e.recommended).map(|e| e.id.as_str());
    let (first, others): (Vec<&Validation>, Vec<&Validation>) =
        coefficients.into_iter().partition(|number| Some(number.simulation.as_str()) == recommended);
    let mut out = Vec::new();
    if !loads.is_empty() || !first.is_empty() || !found.without_range.is_empty() {
        let tables = [load_table(&loads), coefficient_table(&first)].into_iter().flatten();
        let said = Block::words(paragraphs(found, &loads));
        let chart = chart(found, &result.data, &result.name).map(Block::Chart);
        out.push(Section::new(format!("Validation of {}", result.name), tables.chain([said]).chain(chart)));
    }
    out.extend(
        coefficient_table(&others).map(|table| {
            Section::new(format!("Validation of {}: coefficients of the other laws", result.name), [table])
        }),
    );
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

fn load_table(loads: &[&Validation]) -> Option<Block> {
    let t = TableBuilder::new("validated_loads", "Computed and measured loads", loads);
    let columns = vec![
        t.text("load", "load", |v| v.quantity.clone()),
        t.text("measured_by", "measured", |v| v.data.clone()),
        t.count("flows", "flows", |v| v.flows),
        t.number("computed", "S", |v| v.computed).significant(3),
        t.number("measured", "D", |v| v.measured).significant(3),
        t.number("ratio", "S over D", |v| v.ratio).significant(3),
        t.number("error", "E", |v| v.error).significant(3),
        t.number("u_numerical", "u_num", |v| v.u_numerical).significant(2),
        t.number("u_input", "u_input", |v| v.u_input).significant(2),
        t.number("u_data", "", |v| v.u_data),
        t.text("", "u_D", |v| data_uncertainty(v)),
        t.number("u_validation", "u_val", |v| v.u_validation).significant(2),
        t.count("beyond", "beyond 2 u_val", |v| v.beyond),
        t.text("unit", "unit", |v| v.unit.clone()),
    ];
    (!loads.is_empty()).then(|| t.build(columns).into())
}

/// Where it is not stated it is in no u_val either.
fn data_uncertainty(v: &Validation) -> String {
    v.u_data.map_or_else(|| "not stated".to_owned(), |u| significant(u, 2))
}

fn coefficient_table(coefficients: &[&Validation]) -> Option<Block> {
    let t = TableBuilder::new("validated_coefficients", "Computed and measured coefficients", coefficients);
    let verdict = |v: &&Validation| if v.is_beyond() { "beyond 2 u_val" } else { "within" }.to_owned();
    let columns = vec![
        t.text("coefficient", "coefficient", |v| v.quantity.clone()),
        t.text("computed_by", "computed", |v| v.simulation.clone()),
        t.text("measured_by", "measured", |v| v.data.clone()),
        t.number("computed", "S", |v| v.computed).significant(3),
        t.number("measured", "D", |v| v.measured).significant(3),
        t.number("error", "E", |v| v.error).significant(2),
        t.number("u_numerical", "u_num", |v| v.u_numerical).significant(2),
        t.number("u_input", "u_input", |v| v.u_input).significant(2),
        t.number("u_fit", "u_fit", |v| v.u_fit).significant(2),
        t.number("u_data", "", |v| v.u_data),
        t.text("", "u_D", |v| data_uncertainty(v)),
        t.number("u_validation", "u_val", |v| v.u_validation).significant(2),
        t.text("verdict", "verdict", verdict),
        t.text("unit", "unit", |v| v.unit.clone()),
    ];
    (!coefficients.is_empty()).then(|| t.build(columns).into())
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
