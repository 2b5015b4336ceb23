//! Computed sources of a campaign held against its measured ones, by ASME V&V 20.

use std::path::PathBuf;

use froude_records::block::Section;
use froude_records::campaign::{Campaign, Input, Source, SourceKind};
use froude_records::comparison::Validation;
use froude_records::csv_table::csv_bytes;
use froude_records::estimate::EstimateFile;
use froude_records::table::{Column, ColumnData, Table};
use froude_records::text::in_a_file_name;
use froude_records::units::{Dimension, Unit, parse_unit};

use super::validation::{is_measured, sections};
use crate::IdentifyError;
use crate::answer::Answer;
use crate::compare::Named;
use crate::method::Export;
use crate::source::SourceResult;
use crate::validation::{ComparedFlow, Simulation, validate};

/// What the comparison came to, of all computed sources.
#[derive(Default)]
pub struct Validated {
    /// For the record.
    pub numbers: Vec<Validation>,
    /// What a person reads first.
    pub first: Option<Section>,
    /// The others.
    pub others: Vec<Section>,
    /// A table of the flows of each computed source.
    pub exports: Vec<Export>,
}

/// Holds every computed source that was fitted here against everything that is measured; `all` are the campaign's own estimates and then the records of its sources, in turn.
///
/// # Errors
///
/// A law that its own data do not fit.
pub fn against(
    campaign: &Campaign,
    answers: &[Answer],
    all: &[(String, EstimateFile)],
) -> Result<Validated, IdentifyError> {
    let of_name = |name: &str| campaign.sources.iter().find(|source| source.name == name);
    let is_of_measured = |source: &str| of_name(source).is_some_and(|source| is_measured(source.kind));
    let records = campaign.sources.iter().filter(|source| matches!(source.input, Input::Record { .. }));
    let mut measured: Vec<Named<'_>> = Vec::new();
    for (k, (file, record)) in all.iter().enumerate() {
        // The first is what was fitted here.
        let source: Option<&Source> = k.checked_sub(1).and_then(|k| records.clone().nth(k));
        let is_meant = |estimate: &str| source.map_or_else(|| is_of_measured(estimate), |s| is_measured(s.kind));
        let own = record.estimates.iter().filter(|estimate| is_meant(&estimate.source));
        measured.extend(own.map(|estimate| Named { file, record, estimate }));
    }
    let mut out = Validated::default();
    let mut computed =
        answers.iter().filter_map(Answer::fitted).filter(|result| result.kind == SourceKind::Cfd).peekable();
    if measured.is_empty() || computed.peek().is_none() {
        return Ok(out);
    }
    for result in computed {
        let budget = of_name(&result.name).map_or(&[][..], |source| &source.uncertainty);
        let found = validate(Simulation { result, budget }, &measured)?;
        let mut pages = sections(&found, result).into_iter();
        match out.first {
            None => out.first = pages.next(),
            Some(_) => out.others.extend(pages.next()),
        }
        out.others.extend(pages);
        for (what, dimension) in [("", Dimension::FORCE), ("-moments", Dimension::MOMENT)] {
            let is_meant = |flow: &&ComparedFlow| result.data.dimension(&flow.load) == Some(dimension);
            let flows: Vec<&ComparedFlow> = found.flows.iter().filter(is_meant).collect();
            if !flows.is_empty() {
                let name = format!("validation-{}{what}.csv", in_a_file_name(&result.name));
                out.exports.push(Export { content: table(&flows, dimension, result, &name)?, name });
            }
        }
        out.numbers.extend(found.numbers);
    }
    Ok(out)
}

/// The flows of loads of one dimension as a table, a row per load and flow; our own reader takes no empty cell.
fn table(flows: &[&ComparedFlow], of: Dimension, result: &SourceResult, name: &str) -> Result<Vec<u8>, IdentifyError> {
    let data = &result.data;
    let text = |name: &str, of: &dyn Fn(&ComparedFlow) -> String| Column {
        name: name.to_owned(),
        data: ColumnData::Text(flows.iter().map(|flow| of(flow)).collect()),
    };
    let degrees = || parse_unit("deg").unwrap_or_else(|_| Unit::si(Dimension::ANGLE));
    let number = |name: &str, dimension: Dimension, of: &dyn Fn(&ComparedFlow) -> f64| Column {
        name: name.to_owned(),
        data: ColumnData::Number {
            unit: if name == "angle" { degrees() } else { Unit::si(dimension) },
            dimension,
            si: flows.iter().map(|flow| of(flow)).collect(),
        },
    };
    let configuration = |f: &ComparedFlow| data.configuration.get(f.row).cloned().unwrap_or_default();
    // A body of one form has none.
    let has_configurations = flows.iter().all(|flow| !configuration(flow).is_empty());
    let mut columns: Vec<Column> =
        has_configurations.then(|| text("configuration", &configuration)).into_iter().collect();
    for (name, dimension) in [("speed", Dimension::SPEED), ("angle", Dimension::ONE)] {
        columns.extend(data.values(name).map(|values| number(name, dimension, &|f| values[f.row])));
    }
    columns.extend([text("load", &|f| f.load.clone()), text("measured", &|f| f.data.clone())]);
    columns.extend([
        number("S", of, &|f| f.computed),
        number("D", of, &|f| f.measured),
        number("E", of, &ComparedFlow::error),
        number("u_num", of, &|f| f.u_numerical),
        number("u_input", of, &|f| f.u_input),
        if flows.iter().all(|f| f.u_data.is_some()) {
            number("u_D", of, &|f| f.u_data.unwrap_or_default())
        } else {
            text("u_D", &|f| f.u_data.map_or_else(|| "not stated".to_owned(), |u| u.to_string()))
        },
        number("u_val", of, &ComparedFlow::u_validation),
    ]);
    let table = Table::of(PathBuf::from(name), columns, (2..2 + flows.len()).collect());
    Ok(csv_bytes(&table)?)
}
