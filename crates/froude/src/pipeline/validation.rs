//! Computed sources of a campaign held against its measured ones, by ASME V&V 20.

use froude_identify::IdentifyError;
use froude_identify::answer::Answer;
use froude_identify::compare::Named;
use froude_identify::method::Export;
use froude_identify::page::validation::{is_measured, sections};
use froude_identify::source::SourceResult;
use froude_identify::validation::{ComparedFlow, Simulation, validate};
use froude_records::campaign::{Campaign, Input, Source, SourceKind};
use froude_records::comparison::Validation;
use froude_records::estimate::EstimateFile;
use froude_records::page::DocumentSection;
use froude_records::text::in_a_file_name;

/// What the comparison came to, of all computed sources.
#[derive(Default)]
pub(super) struct Validated {
    pub numbers: Vec<Validation>,
    /// What a person reads first.
    pub first: Option<DocumentSection>,
    pub others: Vec<DocumentSection>,
    /// A table of the flows of each computed source.
    pub exports: Vec<Export>,
}

/// Holds every computed source that was fitted here against everything that is measured; `all` are the campaign's own estimates and then the records of its sources, in turn.
pub(super) fn against(
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
        if !found.flows.is_empty() {
            let name = format!("validation-{}.csv", in_a_file_name(&result.name));
            out.exports.push(Export { name, content: table(&found.flows, result).into_bytes() });
        }
        out.numbers.extend(found.numbers);
    }
    Ok(out)
}

/// The flows as a table, a row per load and flow.
fn table(flows: &[ComparedFlow], result: &SourceResult) -> String {
    let mut out = "configuration,speed [m/s],angle [rad],load,unit,measured,S,D,E,u_num,u_input,u_D,u_val\n".to_owned();
    let data = &result.data;
    let at = |name: &str, row: usize| data.values(name).map_or_else(String::new, |values| values[row].to_string());
    for flow in flows {
        let cells = [
            data.configuration.get(flow.row).cloned().unwrap_or_default(),
            at("speed", flow.row),
            at("angle", flow.row),
            flow.load.clone(),
            flow.unit.clone(),
            flow.data.clone(),
            flow.computed.to_string(),
            flow.measured.to_string(),
            flow.error().to_string(),
            flow.u_numerical.to_string(),
            flow.u_input.to_string(),
            flow.u_data.map_or_else(String::new, |u| u.to_string()),
            flow.u_validation().to_string(),
        ];
        out += &cells.map(|cell| quoted(&cell)).join(",");
        out.push('\n');
    }
    out
}

/// A cell as RFC 4180 has it.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.to_owned() }
}
