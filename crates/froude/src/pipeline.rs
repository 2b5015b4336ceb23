//! From a campaign or a bare table to estimates and a report.

use std::path::{Path, PathBuf};

use froude_identify::compare::{Comparison, compare, named};
use froude_identify::source::{SourceResult, asked_models};
use froude_records::campaign::{Campaign, Input, Source, read_campaign};
use froude_records::estimate::{ESTIMATE_SCHEMA, EstimateFile};
use froude_records::finding::{Finding, Severity};
use froude_records::json::read_estimates;
use indexmap::IndexMap;

use crate::Error;
use crate::data_files::DataFiles;
use crate::{method, observations, results, sections};

/// What to identify and where the results go.
#[derive(Debug, Clone)]
pub struct Job {
    /// A campaign (`.toml`) or a bare table (`.csv`, `.parquet`).
    pub input: PathBuf,
    /// Folder of the results; beside the input, named after it, unless said.
    pub out: Option<PathBuf>,
    /// A sidecar for a bare table that is not beside it.
    pub sidecar: Option<PathBuf>,
    /// Models for a bare table, or instead of the campaign's.
    pub models: Vec<String>,
    /// Date for the report's title page, as text; the pipeline reads no clock.
    pub date: Option<String>,
}

impl Job {
    /// A job with nothing but its input.
    #[must_use]
    pub fn new(input: impl Into<PathBuf>) -> Self {
        Self { input: input.into(), out: None, sidecar: None, models: Vec::new(), date: None }
    }
}

/// What came out.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The record, as it stands in `estimate.json`.
    pub file: EstimateFile,
    /// Where the record lies.
    pub estimate: PathBuf,
    /// Where the report lies.
    pub report: PathBuf,
    /// The figures beside it.
    pub figures: Vec<PathBuf>,
    /// The observations of every fitted source, row by row.
    pub observations: Vec<PathBuf>,
    /// Everything that is known about each fitted source.
    pub sources: Vec<SourceResult>,
    /// Sources side by side.
    pub comparison: Comparison,
}

/// Reads, fits, chooses, reports; `progress` is told each step.
///
/// Nothing is written before everything is computed, and the results replace those of an earlier job as a whole, or not at all.
///
/// # Errors
///
/// See [`Error`].
pub fn identify(job: &Job, progress: &dyn Fn(&str)) -> Result<Outcome, Error> {
    let mut campaign = campaign_of(job)?;
    let out = job.out.clone().unwrap_or_else(|| default_out(&job.input));
    results::can_be_written(&out)?;
    if !job.models.is_empty() {
        campaign.identify.models.clone_from(&job.models);
        // No file names these.
        campaign.identify.model_places.clear();
        for source in &mut campaign.sources {
            source.models.clear();
        }
    }
    runs_once(&campaign)?;
    let mut sources = Vec::new();
    let mut published: Vec<(String, EstimateFile)> = Vec::new();
    let named_as = |path: &Path| relative(path, &campaign.path);
    let mut files = DataFiles::new(&named_as);
    if is_campaign(&job.input) {
        files.key(&campaign.path, "campaign")?;
    }
    let mut findings: Vec<Finding> = Vec::new();
    for source in &campaign.sources {
        if let Input::Record { path, select } = &source.input {
            progress(&format!("{}: reading the record", source.name));
            let mut record = read_estimates(path)?;
            if let Some(select) = select {
                let one = froude_identify::select::one_estimate(&record, Some(select), path)?.clone();
                record.estimates = vec![one];
            }
            files.key(path, "record")?;
            findings.push(froude_identify::source::published_note(source));
            published.push((relative(path, &campaign.path), record));
            continue;
        }
        let (method, asked) = method::of(source)?;
        let results = method.identify(&campaign, source, &asked, &|step| {
            progress(&format!("{}: {step}", source.name));
        })?;
        for mut result in results {
            for estimate in &mut result.estimates {
                estimate.data = files.keys_of(&result.files, |role| method.observes(&estimate.method.name, role))?;
            }
            findings.extend(result.findings.iter().cloned());
            sources.push(result);
        }
    }
    findings.extend(laws_not_asked(&campaign));
    if sources.is_empty() && published.is_empty() {
        return Err(Error::Nothing(format!("{}: the campaign has no [[source]]", job.input.display())));
    }
    progress("comparing the sources");
    let data = files.into_map();
    let fitted = EstimateFile {
        schema: ESTIMATE_SCHEMA.to_owned(),
        data: data.clone(),
        versions: IndexMap::new(),
        estimates: sources.iter().flat_map(|s| s.estimates.iter().cloned()).collect(),
        findings: Vec::new(),
    };
    let mut all = vec![("this campaign".to_owned(), fitted)];
    all.extend(published.iter().cloned());
    let comparison =
        if all.iter().map(|f| f.1.estimates.len()).sum::<usize>() > 1 && (sources.len() > 1 || !published.is_empty()) {
            compare(&named(&all))
        } else {
            Comparison::default()
        };
    findings.extend(comparison.findings.iter().cloned());
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    let file = EstimateFile {
        schema: ESTIMATE_SCHEMA.to_owned(),
        data,
        versions: IndexMap::from([("froude".to_owned(), env!("CARGO_PKG_VERSION").to_owned())]),
        estimates: all[0].1.estimates.clone(),
        findings,
    };
    progress("writing the report");
    let records: Vec<_> = published.iter().flat_map(|(_, f)| f.estimates.iter().cloned()).collect();
    let report = sections::report(&campaign, &sources, &records, &comparison, &file, job.date.clone())?;
    let html = froude_report::html(&report)?;
    let figures = froude_report::figures(&report)?;
    let tables = observations::tables(&sources, &campaign)?;
    let written = results::write(&out, &file, &tables, &figures, &html)?;
    Ok(Outcome {
        file,
        estimate: written.estimate,
        report: written.report,
        figures: written.figures,
        observations: written.observations,
        sources,
        comparison,
    })
}

/// Refuses the same runs in two sources: readings of one current would be compared as if they were independent.
fn runs_once(campaign: &Campaign) -> Result<(), Error> {
    let folder = |source: &Source| match &source.input {
        Input::Runs(path) => Some(std::fs::canonicalize(path).unwrap_or_else(|_| path.clone())),
        _ => None,
    };
    for (i, b) in campaign.sources.iter().enumerate() {
        if let Some(a) = campaign.sources[..i].iter().find(|a| folder(a).is_some() && folder(a) == folder(b)) {
            return Err(Error::Nothing(format!(
                "{}: {} and {} name the same runs; name them once, with all methods in `method`",
                b.place, a.name, b.name
            )));
        }
    }
    Ok(())
}

/// Laws of a person that no source is fitted with: a source that names its models is fitted with these alone.
fn laws_not_asked(campaign: &Campaign) -> Option<Finding> {
    let tables: Vec<_> = campaign.sources.iter().filter(|s| matches!(s.input, Input::Table(_))).collect();
    let asked: Vec<String> =
        tables.iter().flat_map(|source| asked_models(campaign, source).unwrap_or_default()).collect();
    let own = campaign.identify.user_models.iter().map(|model| model.name.as_str());
    let left: Vec<&str> = own.filter(|name| !asked.iter().any(|a| a == name)).collect();
    (!left.is_empty() && !tables.is_empty()).then(|| {
        let it = if left.len() == 1 { "it" } else { "them" };
        let text = format!(
            "[[identify.model]] {}: fitted to no source, since each names its models without {it}; add {it} to `models`",
            left.join(", "),
        );
        Finding::new(Severity::Warning, "law-not-asked", text)
    })
}

/// A campaign as it is read, or the one that a bare table stands for.
///
/// # Errors
///
/// Whatever the campaign reader finds.
pub fn campaign_of(job: &Job) -> Result<Campaign, Error> {
    if is_campaign(&job.input) {
        return Ok(read_campaign(&job.input)?);
    }
    Ok(Campaign::of_table(&job.input, job.sidecar.clone()))
}

fn is_campaign(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

fn default_out(input: &Path) -> PathBuf {
    let stem = input.file_stem().map_or_else(|| "froude".to_owned(), |s| s.to_string_lossy().into_owned());
    input.with_file_name(format!("{stem}-results"))
}

/// A path as seen from the campaign's folder, where it lies below it.
fn relative(path: &Path, campaign: &Path) -> String {
    let base = campaign.parent().unwrap_or(Path::new(""));
    path.strip_prefix(base).unwrap_or(path).display().to_string()
}
