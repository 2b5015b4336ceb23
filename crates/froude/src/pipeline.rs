//! From a campaign, a bare table, runs or records to estimates side by side and a report.

pub(crate) mod job;

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

use froude_identify::answer::Answer;
use froude_identify::compare::{MOST_COMPARED, compare, left_out, named, nothing_compared};
use froude_identify::data_files::DataFiles;
use froude_identify::dataset::Dataset;
use froude_identify::method::{Export, Found, Method, observes};
use froude_identify::page::against::against;
use froude_identify::page::campaign::report;
use froude_identify::page::told;
use froude_identify::prediction::{of_rows, same_rows};
use froude_identify::reduce::reduce;
use froude_identify::unexplained::unexplained;
use froude_identify::{IdentifyError, asked, observations, origins};
use froude_records::block::{Block, Section, facts};
use froude_records::campaign::{self, Campaign, Source};
use froude_records::comparison::Comparison;
use froude_records::estimate::{Estimate, EstimateFile};
use froude_records::finding::{Finding, Severity};
use froude_records::hash::sha256_of_file;
use froude_records::json::read_estimates;
use froude_records::outcome::{Content, Outcome, OutputFile};
use froude_records::table::Table;
use froude_records::text::in_a_file_name;
use froude_report::side_by_side;
use froude_report::write::write_folder;
use indexmap::IndexMap;

use crate::{Error, method, results};

pub use crate::method::{check_sections, read_campaign};
pub use crate::pipeline::job::default_out;
pub use crate::pipeline::job::{Identified, Input, Job};

/// Reads, fits, chooses, compares, reports; `progress` receives each step.
///
/// Nothing is written before everything is computed, and the results replace those of an earlier job as a whole, or not at all.
///
/// # Errors
///
/// See [`Error`].
pub fn identify(job: &Job, progress: &dyn Fn(&str)) -> Result<Identified, Error> {
    let mut campaign = campaign_of(job)?;
    let out = job.folder();
    if let Some(out) = &out {
        results::can_be_written(out)?;
        reads_nothing_in(out, &campaign)?;
    }
    campaign.sources.extend(job.validation.as_deref().map(Source::of_validation));
    if !job.models.is_empty() {
        campaign.identify.models.clone_from(&job.models);
        // No file names these.
        campaign.identify.model_places.clear();
        for source in &mut campaign.sources {
            source.models.clear();
        }
    }
    if !job.models.is_empty() {
        let taken = campaign.sources.iter().map(|source| method::takes_laws(source, job.method));
        if !taken.collect::<Result<Vec<_>, _>>()?.contains(&true) {
            let what = "names the laws of a table of loads, and there is none here: leave it out".to_owned();
            return Err(Error::Identify(IdentifyError::Campaign { place: "--models".to_owned(), what }));
        }
    }
    asked::runs_once(&campaign)?;
    let is_of_runs = matches!(job.input, Input::Runs { .. });
    let named_as = |path: &Path| match path.file_name() {
        Some(name) if is_of_runs => name.to_string_lossy().into_owned(),
        _ => relative(path, &campaign.path),
    };
    let mut files = DataFiles::new(&named_as);
    // A body file is no campaign, and has no key.
    if is_campaign(&campaign.path) && !campaign.key.is_empty() {
        files.key(&campaign.path, "campaign")?;
    }
    let mut gathered = Gathered::default();
    for source in campaign.sources.iter().filter(|source| !source.is_validation) {
        gathered.take(source, &campaign, &mut files, job, progress)?;
    }
    for source in campaign.sources.iter().filter(|source| source.is_validation) {
        progress(&format!("{}: validation against the fits", source.name));
        gathered.validate(source, &campaign, job.method)?;
    }
    origins::inherit(&campaign, &gathered.sources, &mut files)?;
    let nobodys = asked::held_by_no_law(&campaign.identify, gathered.sources.iter().flat_map(Answer::estimates));
    if let (Some([place, what]), true) = (&nobodys, job.models.is_empty() && !gathered.has_not_fitted()) {
        return Err(IdentifyError::Campaign { place: place.clone(), what: what.clone() }.into());
    }
    gathered.findings.extend(nobodys.map(|[_, what]| Finding::new(Severity::Warning, "held-by-no-law", what)));
    let Gathered { sources, mut summaries, mut blocks, mut exports, published, mut findings, beside, is_part } =
        gathered;
    findings.extend(asked::laws_not_asked(&campaign));
    // What a method says without an estimate is an answer too: jogs show the polarity.
    if sources.is_empty() && published.is_empty() && summaries.is_empty() {
        return Err(Error::NoSource { is_driven: campaign.is_driven(), path: campaign.path });
    }
    // Matrices of one body, or of one and more links, are no sources to be held against each other.
    let is_one =
        published.is_empty() && matches!(&campaign.sources[..], [one] if matches!(one.input, campaign::Input::Mesh(_)));
    progress("comparing the sources");
    let estimates: Vec<Estimate> = sources.iter().flat_map(|s| s.estimates().iter().cloned()).collect();
    let fitted = EstimateFile { data: files.into_map(), ..EstimateFile::of(estimates) };
    let mut all = vec![("this campaign".to_owned(), fitted)];
    all.extend(published);
    let comparison = if is_one { None } else { side_by_side(&all, &job.input)? };
    let mut comparison = comparison;
    if let Some(comparison) = &mut comparison {
        let validated = against(&campaign, &sources, &all)?;
        comparison.validation = validated.numbers;
        // It is of no source alone.
        summaries.extend(validated.first.map(|section| Summary { sources: 0..0, section: placed(section, "") }));
        blocks.extend(validated.others.into_iter().map(|section| placed(section, "")));
        exports.extend(validated.exports);
    }
    findings.extend(comparison.iter().flat_map(|c| c.findings.iter().cloned()));
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    let (_, fitted) = all.remove(0);
    let file = EstimateFile { versions: results::versions(), comparison, findings, ..fitted };
    let mut told = Outcome { blocks: told(&sources, &summaries, &blocks, &file), ..Outcome::default() };
    let Some(out) = out.or(beside) else { return Ok(Identified { file, sources, told }) };
    if is_part {
        replaces_no_more(&out, &file, job.out.is_some())?;
    }
    progress("writing the report");
    if campaign.name.is_empty() {
        campaign.name = file.estimates.first().map_or_else(String::new, |e| e.source.clone());
    }
    let records: Vec<Estimate> = all.iter().flat_map(|(_, record)| record.estimates.iter().cloned()).collect();
    let sections = summaries.into_iter().map(|summary| summary.section).chain(blocks).collect();
    let report = report(&campaign, &file, &sources, records, sections, job.date.clone())?;
    told.files = files_in(&out, observations::tables(&sources, &campaign)?, exports);
    told.records = vec![file.clone()];
    told.report = Some(Box::new(report));
    write_folder(&told, &out)?;
    // A report may have no figure.
    told.files.retain(|file| file.path.exists());
    Ok(Identified { file, sources, told })
}

/// A section of the report, which programs find in a list by its source and its title.
fn placed(section: Section, source: &str) -> Section {
    let f = facts("", "", &section.title);
    let about =
        f.build(vec![f.text("source", "", |_| source.to_owned()), f.text("title", "", |title| (*title).clone())]);
    Section { key: "sections[]".to_owned(), blocks: [vec![about.into()], section.blocks].concat(), ..section }
}

/// The coefficients of each source, or what its method states of all its results together; then records side by side. The rest of the report is
/// for its page and for programs.
fn told(sources: &[Answer], summaries: &[Summary], details: &[Section], file: &EstimateFile) -> Vec<Block> {
    let of_none = summaries.iter().filter(|summary| summary.sources.is_empty());
    let mut out: Vec<Block> = of_none.map(|summary| summary.section.clone().into()).collect();
    for (i, answer) in sources.iter().enumerate() {
        match summaries.iter().find(|summary| summary.sources.contains(&i)) {
            Some(Summary { sources, section }) if sources.start == i => out.push(section.clone().into()),
            Some(_) => {}
            None => out.extend(told::source(answer)),
        }
    }
    if let Some(comparison) = &file.comparison {
        let is_told = sources.is_empty();
        if !is_told && !comparison.coefficients.is_empty() {
            out.push(Block::words(["The sources are compared in the report.".to_owned()]));
        }
        out.push(side_by_side::verdicts(comparison));
        if is_told {
            out.extend(side_by_side::blocks(comparison));
        }
    }
    out.extend(details.iter().map(|section| Section { is_detail: true, ..section.clone() }.into()));
    out
}

/// The files of a folder of results.
fn files_in(out: &Path, observations: Vec<Table>, exports: Vec<Export>) -> Vec<OutputFile> {
    let file = |key, name: &str, content| OutputFile { key, path: out.join(name), content };
    let observed = observations.into_iter().map(|table| {
        let name = table.path.display().to_string();
        file("observations[]", &name, Content::Table(table))
    });
    let exported =
        exports.into_iter().map(|Export { name, content }| file("exports[]", &name, Content::Bytes(content)));
    let first = [
        file("estimates", "estimate.json", Content::Record),
        file("result", "result.json", Content::Result),
        file("report", "report.html", Content::Report),
        file("figures", "figures", Content::Figures),
    ];
    first.into_iter().chain(observed).chain(exported).collect()
}

/// What a method states about all results that it has from one source.
struct Summary {
    /// Which of them.
    sources: Range<usize>,
    section: Section,
}

/// What the sources gave.
#[derive(Default)]
struct Gathered {
    sources: Vec<Answer>,
    summaries: Vec<Summary>,
    blocks: Vec<Section>,
    exports: Vec<Export>,
    /// Records beside them, as they are called.
    published: Vec<(String, EstimateFile)>,
    findings: Vec<Finding>,
    beside: Option<PathBuf>,
    is_part: bool,
}

impl Gathered {
    /// Takes a source in: reads its record, or fits it by its method.
    fn take(
        &mut self,
        source: &Source,
        campaign: &Campaign,
        files: &mut DataFiles<'_>,
        job: &Job,
        progress: &dyn Fn(&str),
    ) -> Result<(), Error> {
        let step = |step: &str| match source.name.as_str() {
            "" => progress(step),
            name => progress(&format!("{name}: {step}")),
        };
        if let campaign::Input::Record { path, select } = &source.input {
            step("reading the record");
            let mut record = read_estimates(path)?;
            if let Some(select) = select {
                let one = froude_identify::select::one_estimate(&record, Some(select), path)?.clone();
                record.estimates = vec![one];
            }
            files.key(path, "record")?;
            self.findings.extend(errors_of(path, &record));
            // Whoever asks for records and nothing else knows that they are.
            let is_all = matches!(job.input, Input::Records(_));
            self.findings.extend((!is_all).then(|| froude_identify::source::published_note(source)));
            self.published.push((relative(path, &campaign.path), record));
            return Ok(());
        }
        for (method, asked) in method::of(source, job.method)? {
            let mut found = method.identify(campaign, source, &asked, &step)?;
            froude_identify::drag_coefficient::state(&mut found, campaign);
            let fitted = campaign.sources.iter().filter(|source| !source.is_validation).count();
            self.add(method, found, files, source, fitted == 1)?;
        }
        Ok(())
    }

    /// Adds what a method found in a source; of several sources each says whose its section is.
    fn add(
        &mut self,
        method: &dyn Method,
        found: Found,
        files: &mut DataFiles<'_>,
        source: &Source,
        is_one: bool,
    ) -> Result<(), Error> {
        let Found { mut results, summary, blocks, exports, findings, beside, is_part } = found;
        for result in &mut results {
            let read = result.files().to_vec();
            for estimate in result.estimates_mut() {
                let needs = method.needs(&estimate.method.name);
                estimate.data = files.keys_of(&read, |role| observes(needs, role))?;
            }
        }
        let titled = |section: Section| {
            let title = if is_one { section.title.clone() } else { format!("{}: {}", source.name, section.title) };
            Section { title, ..placed(section, &source.name) }
        };
        let first = self.sources.len();
        self.sources.append(&mut results);
        if let Some(section) = summary {
            self.summaries.push(Summary { sources: first..self.sources.len(), section: titled(section) });
        }
        self.blocks.extend(blocks.into_iter().map(titled));
        for export in exports {
            let name = if is_one { export.name } else { self.export_name(&source.name, &export.name) };
            self.exports.push(Export { name, ..export });
        }
        let of_source = |f: Finding| if source.name.is_empty() { f } else { f.of_source(&source.name) };
        let estimates = self.sources[first..].iter().flat_map(Answer::estimates);
        let left: Vec<Finding> = estimates.flat_map(unexplained).collect();
        self.findings.extend(findings.into_iter().chain(left).map(of_source));
        self.beside = self.beside.take().or(beside);
        self.is_part |= is_part;
        Ok(())
    }
}

impl Gathered {
    /// Whether a law could not be fitted, whose coefficients are then in no estimate.
    fn has_not_fitted(&self) -> bool {
        let of_sources = self.sources.iter().filter_map(Answer::fitted).any(|found| !found.not_fitted.is_empty());
        of_sources || self.findings.iter().any(|finding| finding.code == "not-fitted")
    }

    /// Holds the recommended estimates against the rows of a source that none of them was fitted to.
    fn validate(
        &mut self,
        source: &Source,
        campaign: &Campaign,
        method: Option<&'static dyn Method>,
    ) -> Result<(), Error> {
        let fitted = campaign.sources.iter().filter(|other| !other.is_validation);
        let same_file = fitted.map(|other| other.input.path()).find(|path| is_same_file(path, source.input.path()));
        if let Some((_, logs)) = method::of_logs(source, method)? {
            if let Some(path) = same_file {
                let text = format!(
                    "{} has the SHA-256 of {}, which was fitted, so this does not validate the law: errors are smaller than on new data",
                    source.input.path().display(),
                    path.display()
                );
                let finding = Finding::new(Severity::Warning, "validation-on-fitted-rows", text);
                self.findings.push(finding.of_source(&source.name));
            }
            let all: Vec<&Estimate> = self.sources.iter().flat_map(Answer::estimates).collect();
            let (findings, section) = (logs.hold_against)(source, &all)?;
            self.findings.extend(findings.into_iter().map(|f| f.of_source(&source.name)));
            self.blocks.push(placed(section, &source.name));
            return Ok(());
        }
        let observations = reduce(campaign, source)?;
        let of_source = |f: Finding| f.of_source(&source.name);
        self.findings.extend(observations.findings.into_iter().map(of_source));
        let every: Vec<&Estimate> = self.sources.iter().flat_map(Answer::estimates).collect();
        let all: Vec<&Estimate> = every.iter().copied().filter(|e| e.recommended).collect();
        if all.is_empty() {
            let what =
                "has role = \"validation\", and no other source of the campaign gave an estimate to be held against it"
                    .to_owned();
            return Err(IdentifyError::Campaign { place: format!("source {:?}", source.name), what }.into());
        }
        let seen = self.seen(&all, source, campaign, &observations.data);
        let found = of_rows(&every, &all, observations.data)?.seen(seen);
        for predicted in &found.estimates {
            self.findings.push(found.finding(predicted).of_source(&source.name));
            let section = found.section(predicted);
            let title = format!("{}: {}", source.name, section.title);
            self.blocks.push(Section { title, ..placed(section, &source.name) });
        }
        Ok(())
    }

    /// Why rows of a validation are those that an estimate was fitted to, by its id.
    fn seen(
        &self,
        all: &[&Estimate],
        source: &Source,
        campaign: &Campaign,
        data: &Dataset,
    ) -> IndexMap<String, String> {
        let why = |estimate: &&&Estimate| {
            let fitted = campaign.sources.iter().find(|other| !other.is_validation && other.name == estimate.source)?;
            let (own, other) = (source.input.path(), fitted.input.path());
            if is_same_file(own, other) && source.keep == fitted.keep {
                return Some(format!("{} has the SHA-256 of {}", own.display(), other.display()));
            }
            let found = self.sources.iter().filter_map(Answer::fitted).find(|found| found.name == estimate.source)?;
            same_rows(data, &found.data).map(|why| format!("{why} of source {:?}", fitted.name))
        };
        all.iter().filter_map(|estimate| Some((estimate.id.clone(), why(&estimate)?))).collect()
    }

    /// A name that no other export has: the source's before the file's own, and a number where two sources come to the same one.
    fn export_name(&self, source: &str, name: &str) -> String {
        let source = in_a_file_name(source);
        let names = std::iter::once(format!("{source}-{name}")).chain((2..).map(|k| format!("{source}-{k}-{name}")));
        let is_free = |name: &String| self.exports.iter().all(|other| !other.name.eq_ignore_ascii_case(name));
        names.into_iter().find(is_free).unwrap_or_default()
    }
}

/// The estimates of this job and those of records beside it, side by side; `None` where there is but one source.
fn side_by_side(all: &[(String, EstimateFile)], input: &Input) -> Result<Option<Comparison>, Error> {
    let is_asked = matches!(input, Input::Records(_));
    let estimates: usize = all.iter().map(|(_, record)| record.estimates.len()).sum();
    if is_asked && estimates > MOST_COMPARED {
        return Err(Error::TooMany { estimates });
    }
    let all = named(all);
    let sources: BTreeSet<_> = all.iter().map(|n| (n.file, &n.estimate.source)).collect();
    if !is_asked && sources.len() < 2 {
        return Ok(None);
    }
    let mut out = compare(&all);
    if is_asked {
        let found = nothing_compared(&all, &out).or_else(|| left_out(&all, &out));
        out.findings.extend(found);
    }
    Ok(Some(out))
}

/// Whether two files have the same content.
fn is_same_file(a: &Path, b: &Path) -> bool {
    a.is_file()
        && b.is_file()
        && sha256_of_file(a).ok().is_some_and(|sum| sha256_of_file(b).is_ok_and(|own| own == sum))
}

/// Refuses results in the folder of a file that is read: they would take its place.
fn reads_nothing_in(out: &Path, campaign: &Campaign) -> Result<(), Error> {
    let sources = campaign.sources.iter().filter(|source| {
        matches!(source.input, campaign::Input::Record { .. } | campaign::Input::Table(_) | campaign::Input::Mesh(_))
    });
    let inputs = sources.map(|source| source.input.path()).chain(origins::records(campaign));
    Ok(results::spares(out, inputs.chain([campaign.path.as_path()]))?)
}

/// What a record states about itself that a comparison must take into account.
fn errors_of(path: &Path, record: &EstimateFile) -> Option<Finding> {
    let mut errors = record.findings.iter().filter(|finding| finding.severity == Severity::Error);
    let first = errors.next()?;
    let more = errors.count();
    let more = if more > 0 { format!(" (and {more} more)") } else { String::new() };
    let text = format!("{} has an error of its own{more}: [{}] {}", path.display(), first.code, first.message);
    Some(Finding::new(Severity::Warning, "record-with-errors", text))
}

/// Refuses to replace the result of more runs by that of a part of them, and, in a place that nobody chose, that of other runs.
fn replaces_no_more(out: &Path, file: &EstimateFile, is_chosen: bool) -> Result<(), Error> {
    let path = out.join("estimate.json");
    if !path.exists() {
        return Ok(());
    }
    let old = read_estimates(&path)?;
    let named: BTreeSet<&str> = file.data.values().map(|data| data.path.as_str()).collect();
    let mut others = old.data.values().filter(|data| !named.contains(data.path.as_str()));
    let Some(first) = others.next() else { return Ok(()) };
    if is_chosen && old.data.len() <= named.len() {
        return Ok(());
    }
    Err(Error::ReplacesMore {
        out: out.to_owned(),
        there: old.data.len(),
        first: first.path.clone(),
        others: 1 + others.count(),
        named: named.len(),
    })
}

/// A campaign as it is read, or the one that a bare table, runs, a mesh or records stand for.
///
/// # Errors
///
/// Whatever the campaign reader finds.
pub fn campaign_of(job: &Job) -> Result<Campaign, Error> {
    Ok(match &job.input {
        Input::File(path) if is_campaign(path) => read_campaign(path)?,
        Input::File(table) => Campaign::of_table(table, job.sidecar.clone()),
        Input::Runs { paths, campaign } => Campaign::of_runs(paths.clone(), campaign.clone()),
        Input::Mesh { path, options } => Campaign::of_mesh(path, options.clone()),
        Input::Records(paths) => Campaign::of_records(paths),
    })
}

fn is_campaign(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// A path as seen from the campaign's folder, where it lies below it.
fn relative(path: &Path, campaign: &Path) -> String {
    let base = campaign.parent().unwrap_or(Path::new(""));
    path.strip_prefix(base).unwrap_or(path).display().to_string()
}
