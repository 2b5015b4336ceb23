//! What is in a table, a campaign or a record, and everything doubtful about it. Nothing is fitted.

mod told;

use std::path::Path;

use froude_records::campaign::{BudgetEntry, Campaign, Input, Source};
use froude_records::campaign_file::read_campaign;
use froude_records::estimate::Estimate;
use froude_records::finding::Finding;
use froude_records::json::read_estimates;
use froude_records::run::{Meaning, is_servo_log};
use froude_records::table::{ColumnData, Table};
use froude_records::table_file::{read_table, read_table_with_blanks};

use crate::error::IdentifyError;
use crate::reduce::{Observations, reduce};
use crate::select::one_estimate;
use crate::source::{asked_models, check_budget, laws};
use crate::{columns, lint, validity};

/// A column of a table in short.
#[derive(Debug, Clone, PartialEq)]
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
    /// What it is as a channel of a run; none for a column of a table.
    pub channel: Option<ChannelFacts>,
}

/// What the numbers of a run's channel are, beside their unit.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelFacts {
    /// `position`, `force`, ….
    pub quantity: String,
    /// What its direction is along: `y`, `x`, `sensor`, `body` or `none`.
    pub frame: String,
    /// +1 or −1: value times sign is along the positive direction of the frame.
    pub sign: i8,
    /// Which clock its times are of.
    pub clock: String,
}

impl ChannelFacts {
    /// What a run's sidecar says of a channel.
    #[must_use]
    pub fn of(meaning: &Meaning) -> Self {
        Self {
            quantity: meaning.quantity.clone(),
            frame: meaning.frame.name().to_owned(),
            sign: meaning.sign,
            clock: meaning.clock.clone(),
        }
    }
}

/// One entry of a sensor budget.
#[derive(Debug, Clone, PartialEq)]
pub struct BudgetFacts {
    /// The uncertain column.
    pub quantity: String,
    /// Standard uncertainty with its unit: `0.01 N`, `0.5 %`.
    pub standard: String,
    /// Who shares the error: `sample`, `run`, `setup` or `campaign`.
    pub shared: String,
    /// Degrees of freedom; none where infinite.
    pub dof: Option<f64>,
    /// Name in the budget table, where it has its own.
    pub name: Option<String>,
}

/// One source of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceFacts {
    /// Its name.
    pub name: String,
    /// `tank`, `towing`, `cfd`, `potential` or `published`.
    pub kind: String,
    /// `table`, `record`, `runs`, `cases` or `mesh`.
    pub input: String,
    /// The file or folder.
    pub path: String,
    /// Whether it is there.
    pub exists: bool,
    /// Observations in the table; none where no table was read.
    pub rows: Option<usize>,
    /// Those that are fitted: kept by `keep`, without copies.
    pub kept: Option<usize>,
    /// Columns of the table.
    pub columns: Vec<ColumnFacts>,
    /// Models that will be fitted, the defaults where none are asked for; of a record, the estimates in it.
    pub models: Vec<String>,
    /// The sensor budget.
    pub budget: Vec<BudgetFacts>,
    /// Runs of its plan; none where there is no plan.
    pub planned_runs: Option<usize>,
}

/// What is in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Inspection {
    /// `table`, `list` of logs, `campaign`, `estimate`, `run`, `runs` for a folder of them, or `logs` for one of other programs' logs.
    pub kind: String,
    /// Facts in words, `(name, value)`.
    pub facts: Vec<(String, String)>,
    /// Columns of a table or a run.
    pub columns: Vec<ColumnFacts>,
    /// Sources of a campaign.
    pub sources: Vec<SourceFacts>,
    /// Estimates of a record, as they stand in it.
    pub estimates: Vec<Estimate>,
    /// Every finding.
    pub findings: Vec<Finding>,
}

impl Inspection {
    /// Facts and findings of a file of that kind, with nothing else yet.
    #[must_use]
    pub fn new(kind: &str, facts: Vec<(String, String)>, findings: Vec<Finding>) -> Self {
        let (columns, sources, estimates) = (Vec::new(), Vec::new(), Vec::new());
        Self { kind: kind.to_owned(), facts, columns, sources, estimates, findings }
    }
}

/// Inspects a table, with a sidecar that is not beside it.
///
/// # Errors
///
/// Whatever the reader finds.
pub fn table(path: &Path, sidecar: Option<&Path>) -> Result<Inspection, IdentifyError> {
    let table = read_table_with_blanks(path, sidecar)?;
    let campaign = Campaign::of_table(path, sidecar.map(Path::to_owned));
    let reduced = reduce(&campaign, &campaign.sources[0])?;
    if let Some(files) = table.text("file").ok().filter(|_| reduced.data.loads().is_empty()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let next = format!("write list = \"{name}\" in the sidecar of these logs: each row then describes one log");
        let facts = [("files", files.len().to_string()), ("next", next)];
        let facts = facts.map(|(name, value)| (name.to_owned(), value)).into();
        return Ok(Inspection { columns: columns(&table), ..Inspection::new("list", facts, Vec::new()) });
    }
    let findings = doubts(&campaign, &campaign.sources[0], &reduced);
    let configurations = reduced.data.configurations();
    let mut facts = vec![("rows".to_owned(), table.n_rows.to_string())];
    if configurations.iter().any(|c| !c.is_empty()) {
        facts.push(("configurations".to_owned(), configurations.join(", ")));
    }
    if let Some(sidecar) = &table.sidecar {
        facts.push(("sidecar".to_owned(), sidecar.display().to_string()));
    }
    Ok(Inspection { columns: columns(&table), ..Inspection::new("table", facts, findings) })
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
                channel: None,
            },
            ColumnData::Number { unit, si, .. } => {
                let shown: Vec<f64> = si.iter().map(|v| unit.from_si(*v)).collect();
                ColumnFacts {
                    name: c.name.clone(),
                    unit: unit.text.clone(),
                    low: shown.iter().copied().reduce(f64::min),
                    high: shown.iter().copied().reduce(f64::max),
                    distinct: si.iter().map(|v| v.to_bits()).collect::<std::collections::BTreeSet<_>>().len(),
                    channel: None,
                }
            }
        })
        .collect()
}

/// Everything doubtful about the observations of a source.
fn doubts(campaign: &Campaign, source: &Source, reduced: &Observations) -> Vec<Finding> {
    let mut findings = reduced.findings.clone();
    findings.extend(validity::ranges(&reduced.data, campaign).1);
    // A table that cannot be fitted as it is says so when it is fitted.
    let laws = laws(campaign, source, &reduced.data);
    findings.extend(lint::observations(&reduced.data, campaign, laws.as_deref().unwrap_or_default()));
    if let Ok(laws) = &laws {
        findings.extend(columns::unused(&reduced.data, campaign, source, laws));
    }
    findings.into_iter().map(|f| f.of_source(&source.name)).collect()
}

/// Inspects a campaign and its sources; what a mesh or the log of a servo is asked for is checked by whoever computes it, and what is driven is said by whoever drives it.
///
/// # Errors
///
/// Whatever the reader of the campaign or of a source finds.
pub fn campaign(path: &Path) -> Result<(Campaign, Inspection), IdentifyError> {
    let campaign = read_campaign(path)?;
    let mut facts = vec![("name".to_owned(), campaign.name.clone())];
    facts.extend(campaign.cite.iter().map(|work| ("cite".to_owned(), work.clone())));
    let (mut sources, mut findings) = (Vec::new(), Vec::new());
    for source in &campaign.sources {
        let (facts, found) = source_facts(&campaign, source)?;
        sources.push(facts);
        findings.extend(found);
    }
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    let found = Inspection { sources, ..Inspection::new("campaign", facts, findings) };
    Ok((campaign, found))
}

fn source_facts(campaign: &Campaign, source: &Source) -> Result<(SourceFacts, Vec<Finding>), IdentifyError> {
    // A plan in the form of a method has no rows.
    let rows = source.rows().unwrap_or_default();
    let planned: usize =
        rows.iter().map(|p| p.configurations.len() * p.speed_m_s.len() * p.angle_rad.len() * p.repeats).sum();
    let input = match source.input {
        Input::Table(_) => "table",
        Input::Record { .. } => "record",
        Input::Runs { .. } => "runs",
        Input::Cases(_) => "cases",
        Input::Mesh(_) => "mesh",
    };
    let mut out = SourceFacts {
        name: source.name.clone(),
        kind: source.kind.name().to_owned(),
        input: input.to_owned(),
        path: source.input.path().display().to_string(),
        exists: source.input.path().exists(),
        rows: None,
        kept: None,
        columns: Vec::new(),
        models: Vec::new(),
        budget: source.uncertainty.iter().map(budget_facts).collect(),
        planned_runs: Some(planned).filter(|_| !rows.is_empty()),
    };
    let mut findings = Vec::new();
    match &source.input {
        Input::Table(log) if !source.methods.is_empty() || is_servo_log(log, source.sidecar.as_deref())? => {
            let table = read_table(log, source.sidecar.as_deref())?;
            (out.rows, out.columns) = (Some(table.n_rows), columns(&table));
        }
        Input::Table(table) => {
            out.models = asked_models(campaign, source)?;
            if out.exists {
                let reduced = reduce(campaign, source)?;
                // What a fit would refuse is refused here, before tank time is spent on it.
                laws(campaign, source, &reduced.data)?;
                check_budget(source, &reduced.data)?;
                out.columns = columns(&read_table_with_blanks(table, source.sidecar.as_deref())?);
                (out.rows, out.kept) = (Some(reduced.n_read), Some(reduced.data.rows));
                findings = doubts(campaign, source, &reduced);
            }
        }
        Input::Record { path, select } => {
            let mut record = read_estimates(path)?;
            if let Some(select) = select {
                let one = one_estimate(&record, Some(select), path)?.clone();
                record.estimates = vec![one];
            }
            out.models = record.estimates.iter().map(|e| e.id.clone()).collect();
        }
        Input::Runs { .. } | Input::Cases(_) | Input::Mesh(_) => {}
    }
    Ok((out, findings))
}

fn budget_facts(entry: &BudgetEntry) -> BudgetFacts {
    // Ten digits hide the rounding of the unit's factor.
    let shown = |x: f64| format!("{x:.9e}").parse::<f64>().unwrap_or(x);
    BudgetFacts {
        quantity: entry.quantity.clone(),
        standard: if entry.relative {
            format!("{} %", shown(100.0 * entry.standard))
        } else {
            format!("{} {}", shown(entry.standard), entry.dimension)
        },
        shared: entry.shared.name().to_owned(),
        dof: entry.dof,
        name: entry.name.clone(),
    }
}

/// Inspects a record.
///
/// # Errors
///
/// Whatever the reader finds.
pub fn estimates(path: &Path) -> Result<Inspection, IdentifyError> {
    let record = read_estimates(path)?;
    let mut facts = vec![("schema".to_owned(), record.schema.clone())];
    facts.extend(record.data.values().map(|d| ("data".to_owned(), d.path.clone())));
    Ok(Inspection { estimates: record.estimates, ..Inspection::new("estimate", facts, record.findings) })
}
