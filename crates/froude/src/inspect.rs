//! `froude inspect`: what is in a table, a campaign, a record or a carriage's run, and everything doubtful about it. Nothing is fitted.

use std::path::{Path, PathBuf};

use froude_added_mass::options::Asked;
use froude_identify::reduce::{Observations, reduce};
use froude_identify::source::{asked_models, check_budget, laws};
use froude_identify::{columns, lint, validity};
use froude_records::campaign::{BudgetEntry, Campaign, Input, Source, read_campaign};
use froude_records::carriage::{CarriageCampaign, Directions, RigKind};
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};
use froude_records::json::read_estimates;
use froude_records::run::{
    Block, BodyState, Doubt, DoubtKind, ImportedRun, Meaning, Mounted, Role, RunMeta, RunReader, RunStatus, TOW,
    import_run, read_run, read_run_meta,
};
use froude_records::table::{ColumnData, Table, read_table};
use froude_records::text::counted;

use indexmap::IndexMap;

use crate::Error;
use froude_carriage::runs;
use froude_carriage::runs::set::{Member, doubles, is_put_aside, strangers, summed_up};
use froude_carriage::runs::whole::Complete;
use froude_identify::runs::{files, logs_in};

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
    /// What it is as a channel of a run; none for a column of a table.
    #[serde(flatten)]
    pub channel: Option<ChannelFacts>,
}

/// What the numbers of a run's channel are, beside their unit.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
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
    fn of(meaning: &Meaning) -> Self {
        Self {
            quantity: meaning.quantity.clone(),
            frame: meaning.frame.name().to_owned(),
            sign: meaning.sign,
            clock: meaning.clock.clone(),
        }
    }
}

/// One entry of a sensor budget.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
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
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
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
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Inspection {
    /// `table`, `campaign`, `estimate`, `run`, `runs` for a folder of them, or `logs` for one of other programs' logs.
    pub kind: String,
    /// Facts in words, `(name, value)`.
    pub facts: Vec<(String, String)>,
    /// Columns of a table or a run.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub columns: Vec<ColumnFacts>,
    /// Sources of a campaign.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<SourceFacts>,
    /// Estimates of a record, as they stand in it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub estimates: Vec<Estimate>,
    /// Every finding.
    pub findings: Vec<Finding>,
}

impl Inspection {
    fn new(kind: &str, facts: Vec<(String, String)>, findings: Vec<Finding>) -> Self {
        let (columns, sources, estimates) = (Vec::new(), Vec::new(), Vec::new());
        Self { kind: kind.to_owned(), facts, columns, sources, estimates, findings }
    }
}

/// Inspects a table, a campaign, an estimate record or a run, by the ending of its name; a run also by its sidecar; a folder of
/// runs as a set.
///
/// # Errors
///
/// Whatever the reader of the format finds.
pub fn inspect(path: &Path, sidecar: Option<&Path>) -> Result<Inspection, Error> {
    if path.is_dir() {
        return folder(path);
    }
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        // A run's sidecar lies beside it and says less than the run itself.
        Some("toml") if path.with_extension("mcap").is_file() => run(&path.with_extension("mcap")),
        Some("toml") => match read_run_meta(path) {
            Ok(meta) => {
                let log = path.with_extension("mcap");
                let is_aside = is_put_aside(&log, &meta);
                let found = if is_aside { runs::put_aside(&log, &meta) } else { runs::gone(&log, &meta) };
                Err(Error::Nothing(found.message))
            }
            Err(_) => campaign(path),
        },
        Some("json") => estimates(path),
        Some("mcap") => run(path),
        _ => table(path, sidecar),
    }
}

/// A folder of runs: how many of what, and whether the files are what they say.
fn folder(path: &Path) -> Result<Inspection, Error> {
    let (mut metas, mut members, mut doubts, mut findings) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut n_aside, mut complete) = (0, Complete::default());
    let files = files(&[path.to_owned()])?;
    let shown = path.display();
    let Some(first) = files.iter().find(|file| file.exists()) else {
        let sidecars = files.iter().filter(|log| read_run_meta(&log.with_extension("toml")).is_ok()).count();
        if sidecars > 0 {
            return Err(Error::Nothing(format!(
                "{shown} has {} and no log: copy the .mcap files back, or froude run drives them again",
                counted(sidecars, "sidecar of a run", "sidecars of runs")
            )));
        }
        let others = logs_in(path)?;
        if !others.is_empty() {
            return Ok(logs(&others));
        }
        return Err(Error::Nothing(format!(
            "{shown} is a folder without runs; name a table (.csv, .parquet), a campaign (.toml), a record (.json) or a run (.mcap)"
        )));
    };
    for file in &files {
        if !file.exists() {
            // Another file of TOML may lie in the folder.
            if let Ok(meta) = read_run_meta(&file.with_extension("toml")) {
                let is_aside = is_put_aside(file, &meta);
                n_aside += usize::from(is_aside);
                findings.push(if is_aside { runs::put_aside(file, &meta) } else { runs::gone(file, &meta) });
            }
            continue;
        }
        let read = RunReader::open(file).and_then(|mut reader| {
            let mut block = Block::default();
            while reader.read_block(&mut block)? {}
            Ok(reader)
        });
        match read {
            Ok(reader) if is_put_aside(file, reader.meta()) => n_aside += 1,
            Ok(reader) => {
                if reader.meta().status == RunStatus::Complete {
                    members.push(Member::of(file, reader.meta())?);
                    let is_damaged = |doubt: &Doubt| matches!(doubt.kind, DoubtKind::Damaged | DoubtKind::Exchanged);
                    if !reader.doubts().iter().any(is_damaged) {
                        complete.add(file, reader.meta());
                    }
                }
                metas.push(reader.meta().clone());
                doubts.extend_from_slice(reader.doubts());
            }
            Err(error) => findings.push(Finding::new(Severity::Error, "run-unreadable", error.to_string())),
        }
    }
    let is_grave = |doubt: &&Doubt| matches!(doubt.kind, DoubtKind::Damaged | DoubtKind::Exchanged);
    findings.extend(doubts.iter().filter(is_grave).map(Doubt::finding));
    findings.extend(doubles(&members));
    findings.extend(strangers(&members)?);
    findings.extend(summed_up(&doubts));
    findings.extend(complete.against_plan(path, &Role::ALL));
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    let each = |name: &dyn Fn(&RunMeta) -> String| {
        let mut counts: IndexMap<String, usize> = IndexMap::new();
        for meta in &metas {
            *counts.entry(name(meta)).or_default() += 1;
        }
        counts.iter().map(|(name, n)| format!("{n} {name}")).collect::<Vec<_>>().join(", ")
    };
    let aside = counted(n_aside, "more was set aside", "more were set aside");
    let aside = if n_aside == 0 { String::new() } else { format!("; {aside}") };
    let is_towed = metas.iter().any(|meta| meta.method == TOW);
    let together =
        if is_towed { format!("froude carriage drag {shown} reduces them together; ") } else { String::new() };
    let facts = vec![
        ("campaign".to_owned(), each(&|meta| format!("of {:?}", meta.campaign))),
        ("runs".to_owned(), each(&|meta| meta.status.name().to_owned()) + &aside),
        ("methods".to_owned(), each(&|meta| named(&meta.method).to_owned())),
        ("roles".to_owned(), each(&|meta| meta.role.name().to_owned())),
        ("next".to_owned(), format!("{together}froude inspect {} shows one", first.display())),
    ];
    Ok(Inspection::new("runs", facts, findings))
}

fn table(path: &Path, sidecar: Option<&Path>) -> Result<Inspection, Error> {
    let table = read_table(path, sidecar)?;
    let campaign = Campaign::of_table(path, sidecar.map(Path::to_owned));
    let reduced = reduce(&campaign, &campaign.sources[0])?;
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
    findings.extend(lint::observations(&reduced.data, campaign));
    // A table that cannot be fitted as it is says so when it is fitted.
    if let Ok(laws) = laws(campaign, source, &reduced.data) {
        findings.extend(columns::unused(&reduced.data, campaign, source, &laws));
    }
    findings.into_iter().map(|f| f.of_source(&source.name)).collect()
}

fn campaign(path: &Path) -> Result<Inspection, Error> {
    let campaign = read_campaign(path)?;
    let mut facts = vec![("name".to_owned(), campaign.name.clone())];
    facts.extend(campaign.cite.iter().map(|work| ("cite".to_owned(), work.clone())));
    facts.extend(campaign.carriage.iter().flat_map(driven));
    let (mut sources, mut findings) = (Vec::new(), Vec::new());
    for source in &campaign.sources {
        let (facts, found) = source_facts(&campaign, source)?;
        sources.push(facts);
        findings.extend(found);
    }
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    Ok(Inspection { sources, ..Inspection::new("campaign", facts, findings) })
}

fn times(n: usize) -> String {
    counted(n, "time", "times")
}

/// What a campaign drives and is to do; `froude run --check` has the runs one by one.
fn driven(carriage: &CarriageCampaign) -> Vec<(String, String)> {
    let rig = match &carriage.rig.kind {
        RigKind::Twin { seed, truths } => {
            format!("twin, seed {seed}, {}", counted(truths.len(), "truth of its own", "truths of its own"))
        }
        RigKind::Serial { port, baud } => format!("board at {port}, {baud} baud"),
    };
    let [low, high] = carriage.rig.y.travel_m;
    let mut facts = vec![("rig".to_owned(), format!("{rig}; long axis from {low} m to {high} m"))];
    let Some(plan) = &carriage.plan else { return facts };
    let mut fact = |name: &str, value: String| facts.push((name.to_owned(), value));
    let speeds: Vec<String> = plan.speed_m_s.iter().map(f64::to_string).collect();
    fact("tows", format!("axis {}, {} m/s over {} m", plan.axis.name(), speeds.join(", "), plan.distance_m));
    let ways = if plan.directions == Directions::Both { "out and back" } else { "out" };
    let ballast = if plan.is_ballasted { "ballasted" } else { "not ballasted" };
    fact("pairs", format!("{} at each speed, {ways}; wet runs {ballast}", plan.repeats));
    if let Some(sweep) = &plan.friction {
        fact(
            "friction sweep",
            format!("{}, {}", counted(sweep.speed_m_s.len(), "speed", "speeds"), times(sweep.repeats)),
        );
    }
    if let Some(c) = &plan.calibration {
        let weights: Vec<String> = c.weights_n.iter().map(f64::to_string).collect();
        fact("calibration", format!("{} N over a pulley, {}", weights.join(", "), times(c.repeats)));
    }
    if let Some(part) = plan.stop_at_relative_half_width {
        fact("stops early", format!("when D_d is known within {} %", 100.0 * part));
    }
    facts
}

fn source_facts(campaign: &Campaign, source: &Source) -> Result<(SourceFacts, Vec<Finding>), Error> {
    let planned: usize =
        source.plan.iter().map(|p| p.configurations.len() * p.speed_m_s.len() * p.angle_rad.len() * p.repeats).sum();
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
        planned_runs: Some(planned).filter(|_| !source.plan.is_empty()),
    };
    let mut findings = Vec::new();
    match &source.input {
        Input::Table(table) => {
            out.models = asked_models(campaign, source)?;
            if out.exists {
                let reduced = reduce(campaign, source)?;
                // What a fit would refuse is refused here, before tank time is spent on it.
                laws(campaign, source, &reduced.data)?;
                check_budget(source, &reduced.data)?;
                out.columns = columns(&read_table(table, source.sidecar.as_deref())?);
                (out.rows, out.kept) = (Some(reduced.n_read), Some(reduced.data.rows));
                findings = doubts(campaign, source, &reduced);
            }
        }
        Input::Record { path, select } => {
            let mut record = read_estimates(path)?;
            if let Some(select) = select {
                let one = froude_identify::select::one_estimate(&record, Some(select), path)?.clone();
                record.estimates = vec![one];
            }
            out.models = record.estimates.iter().map(|e| e.id.clone()).collect();
        }
        Input::Mesh(path) => {
            Asked::read(path, &source.added_mass)?;
        }
        Input::Runs { .. } | Input::Cases(_) => {}
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

fn estimates(path: &Path) -> Result<Inspection, Error> {
    let record = read_estimates(path)?;
    let mut facts = vec![("schema".to_owned(), record.schema.clone())];
    facts.extend(record.data.values().map(|d| ("data".to_owned(), d.path.clone())));
    Ok(Inspection { estimates: record.estimates, ..Inspection::new("estimate", facts, record.findings) })
}

/// The method of a run as it stands in its files.
fn named(method: &str) -> &str {
    if method.is_empty() { "not stated" } else { method }
}

/// What is mounted, in words.
fn mounted(mounted: &Mounted) -> String {
    let Mounted { body, is_ballasted, hung_weight_n, travel } = mounted;
    let mut out = match body {
        BodyState::None => "no body".to_owned(),
        body => format!("body {}", body.name()),
    };
    if *is_ballasted && matches!(body, BodyState::Wet) {
        out += ", wheel load matched by ballast";
    }
    if let Some(weight_n) = hung_weight_n {
        out += &format!(", {weight_n} N over the pulley");
    }
    match (travel, body) {
        (Some(axis), _) => out += &format!(", its {} axis along the travel", axis.name()),
        (None, BodyState::None) => {}
        (None, _) => out += ", axis along the travel not declared",
    }
    out
}

/// Logs of other programs in a folder, as releases are: how long each is, and what it holds.
fn logs(paths: &[PathBuf]) -> Inspection {
    let (mut facts, mut findings) = (Vec::new(), Vec::new());
    facts.push((
        "logs".to_owned(),
        format!("{} of other programs; the method that reads them states what they are", paths.len()),
    ));
    for path in paths {
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        match import_run(path, None) {
            Ok(ImportedRun { log, findings: own, .. }) => {
                let rate = log.sample_rate_hz().map_or_else(String::new, |hz| format!(" at {hz:.1} Hz"));
                let channels = log.channels.iter().map(|(name, c)| format!("{name} [{}]", c.meaning.unit));
                let channels = channels.collect::<Vec<_>>().join(", ");
                facts.push((
                    name,
                    format!("{}{rate}, {:.3} s: {channels}", counted(log.len(), "sample", "samples"), log.duration_s()),
                ));
                findings.extend(own.into_iter().filter(|finding| finding.severity > Severity::Note));
            }
            Err(error) => findings.push(Finding::new(Severity::Error, "run-unreadable", error.to_string())),
        }
    }
    facts.push((
        "next".to_owned(),
        "runs = \"FOLDER\" and method = \"decay_envelope\" or \"decay_output_error\" in a [[source]] take a folder of releases".to_owned(),
    ));
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    Inspection::new("logs", facts, findings)
}

/// A run: what it was for, its channels, what happened, what is missing.
fn run(path: &Path) -> Result<Inspection, Error> {
    let log = read_run(path)?;
    let meta = &log.meta;
    let mut facts: Vec<(String, String)> = Vec::new();
    let mut fact = |name: &str, value: String| facts.push((name.to_owned(), value));
    fact("run", format!("{} of campaign \"{}\"", meta.id, meta.campaign));
    fact("method", format!("{}, role {}", named(&meta.method), meta.role.name()));
    fact("mounted", mounted(&meta.mounted));
    fact("axis", meta.carriage.axis.name().to_owned());
    if let (Some(speed), Some(direction)) = (meta.carriage.target_speed_m_s, meta.carriage.direction) {
        fact("steady part", format!("{speed} m/s {}", direction.name()));
    }
    if let Some(pair) = meta.carriage.pair {
        fact("pair", pair.to_string());
    }
    let note = if meta.note.is_empty() { String::new() } else { format!(": {}", meta.note) };
    fact("status", format!("{}{note}", meta.status.name()));
    let rate = log.sample_rate_hz().map_or_else(String::new, |hz| format!(" at {hz:.1} Hz"));
    fact("samples", format!("{}{rate}, {:.3} s", log.len(), log.duration_s()));
    if let Some(clock) = &meta.clock {
        fact(
            "board clock",
            format!("time zero is {:.6} s of the host, ± {:.1e} s", clock.host_at_zero_s, clock.standard_uncertainty_s),
        );
    }
    for (name, version) in &meta.versions {
        fact("version", format!("{name} {version}"));
    }
    for event in &log.events {
        fact(&format!("{:.3} s", event.time_s), format!("{}: {}", event.kind.name(), event.text));
    }
    if let Some(recorded) = meta.log.as_ref().filter(|_| log.doubts.is_empty()) {
        fact(
            "log",
            format!(
                "{} bytes, as they were recorded (SHA-256 {}…)",
                recorded.bytes,
                recorded.sha256.get(..8).unwrap_or_default()
            ),
        );
    }
    let gaps = log.lost.iter().map(|gap| Finding::new(Severity::Warning, "run-gap", gap.text.clone()));
    let findings = log.doubts.iter().map(Doubt::finding).chain(gaps).collect();
    let columns = log
        .channels
        .iter()
        .map(|(name, c)| ColumnFacts {
            name: name.clone(),
            unit: c.meaning.unit.clone(),
            low: c.values.iter().copied().reduce(f64::min),
            high: c.values.iter().copied().reduce(f64::max),
            distinct: c.values.iter().map(|v| v.to_bits()).collect::<std::collections::BTreeSet<_>>().len(),
            channel: Some(ChannelFacts::of(&c.meaning)),
        })
        .collect();
    Ok(Inspection { columns, ..Inspection::new("run", facts, findings) })
}
