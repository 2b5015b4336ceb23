//! `froude inspect`: what is in a file, units, ranges, and every finding of the lint.

use std::path::Path;

use froude_identify::{lint, reduce, validity};
use froude_records::campaign::{Campaign, Input, read_campaign};
use froude_records::finding::Finding;
use froude_records::json::read_estimates;
use froude_records::table::{ColumnData, Table, read_table};

use crate::Error;

/// A column of a table in short.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ColumnFacts {
    /// Name without unit.
    pub name: String,
    /// Unit as written; empty for text.
    pub unit: String,
    /// Smallest value in that unit.
    pub low: Option<f64>,
    /// Largest value in that unit.
    pub high: Option<f64>,
    /// Distinct values.
    pub distinct: usize,
}

/// What is in a file.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Inspection {
    /// `table`, `campaign` or `estimate`.
    pub kind: String,
    /// Facts in words, `(name, value)`.
    pub facts: Vec<(String, String)>,
    /// Columns of a table.
    pub columns: Vec<ColumnFacts>,
    /// Every finding.
    pub findings: Vec<Finding>,
}

/// Inspects a table, a campaign or an estimate record, by the ending of its name.
///
/// # Errors
///
/// Whatever the reader of the format finds.
pub fn inspect(path: &Path, sidecar: Option<&Path>) -> Result<Inspection, Error> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("toml") => campaign(path),
        Some("json") => estimates(path),
        _ => table(path, sidecar),
    }
}

fn table(path: &Path, sidecar: Option<&Path>) -> Result<Inspection, Error> {
    let table = read_table(path, sidecar)?;
    let campaign = Campaign::of_table(path, sidecar.map(Path::to_owned));
    let reduced = reduce::reduce(&campaign, &campaign.sources[0])?;
    let mut findings = reduced.findings;
    findings.extend(validity::ranges(&reduced.data, &campaign).1);
    findings.extend(lint::observations(&reduced.data, &campaign));
    let configurations = reduced.data.configurations();
    let mut facts = vec![("rows".to_owned(), table.n_rows.to_string())];
    if configurations.iter().any(|c| !c.is_empty()) {
        facts.push(("configurations".to_owned(), configurations.join(", ")));
    }
    if let Some(sidecar) = &table.sidecar {
        facts.push(("sidecar".to_owned(), sidecar.display().to_string()));
    }
    Ok(Inspection { kind: "table".to_owned(), facts, columns: columns(&table), findings })
}

fn columns(table: &Table) -> Vec<ColumnFacts> {
    table
        .columns
        .iter()
        .map(|c| match &c.data {
            ColumnData::Text(t) => ColumnFacts {
                name: c.name.clone(),
                unit: String::new(),
                low: None,
                high: None,
                distinct: t.iter().collect::<std::collections::BTreeSet<_>>().len(),
            },
            ColumnData::Number { unit, si, .. } => {
                let shown: Vec<f64> = si.iter().map(|v| unit.from_si(*v)).collect();
                ColumnFacts {
                    name: c.name.clone(),
                    unit: unit.text.clone(),
                    low: shown.iter().copied().reduce(f64::min),
                    high: shown.iter().copied().reduce(f64::max),
                    distinct: si.iter().map(|v| v.to_bits()).collect::<std::collections::BTreeSet<_>>().len(),
                }
            }
        })
        .collect()
}

fn campaign(path: &Path) -> Result<Inspection, Error> {
    let campaign = read_campaign(path)?;
    let mut findings = Vec::new();
    let mut facts = vec![("name".to_owned(), campaign.name.clone())];
    for source in &campaign.sources {
        let what = match &source.input {
            Input::Table(table) => {
                if table.exists() {
                    let reduced = reduce::reduce(&campaign, source)?;
                    findings.extend(reduced.findings);
                    let own = |f: Finding| f.of_source(&source.name);
                    findings.extend(validity::ranges(&reduced.data, &campaign).1.into_iter().map(own));
                    findings.extend(lint::observations(&reduced.data, &campaign).into_iter().map(own));
                    format!("table {}, {} observations kept of {}", table.display(), reduced.data.rows, reduced.n_read)
                } else {
                    format!("table {} is not there yet: froude simulate makes it", table.display())
                }
            }
            Input::Record { path, .. } => {
                let record = read_estimates(path)?;
                format!("record {}, {} estimates", path.display(), record.estimates.len())
            }
            Input::Runs(p) | Input::Cases(p) | Input::Mesh(p) => p.display().to_string(),
        };
        facts.push((format!("source {}", source.name), what));
    }
    facts.push(("models".to_owned(), campaign.identify.models.join(", ")));
    Ok(Inspection { kind: "campaign".to_owned(), facts, columns: Vec::new(), findings })
}

fn estimates(path: &Path) -> Result<Inspection, Error> {
    let record = read_estimates(path)?;
    let mut facts = vec![("schema".to_owned(), record.schema.clone())];
    for e in &record.estimates {
        let determined = e.coefficients.values().filter(|c| c.value.is_some()).count();
        let stated = e.coefficients.values().filter(|c| c.standard_uncertainty.is_some()).count();
        facts.push((
            e.id.clone(),
            format!(
                "{} coefficients, {determined} with a value, {stated} with an uncertainty; {} observations{}",
                e.coefficients.len(),
                e.n_observations,
                if e.recommended { "; recommended" } else { "" }
            ),
        ));
    }
    Ok(Inspection { kind: "estimate".to_owned(), facts, columns: Vec::new(), findings: record.findings })
}
