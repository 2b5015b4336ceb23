//! `froude carriage calibrate`: force per volt from known weights over a pulley, and polarity from the jogs.

use std::path::{Path, PathBuf};

use froude_carriage::drag::calibration::{Calibration, Jog as Verdict, jog as judged, record};
use froude_carriage::drag::{DragRun, DragSetup};
use froude_carriage::source::files_of;
use froude_identify::compare::{compare, named as named_in};
use froude_records::estimate::{Estimate, EstimateFile};
use froude_records::finding::{Finding, Severity};
use froude_records::number;
use froude_records::page::{DocumentSection, TextTable};
use froude_records::run::{Role, RunLog};
use froude_records::text::counted;
use froude_records::units::Dimension;

use froude_carriage::reduction::{calibration_of, declared_weight_relative, setup_of, weights_key};
use froude_carriage::runs::{Runs, for_drag, read};
use froude_report::document::Document;
use froude_report::verdict::verdict_words;

use crate::Error;
use crate::data_files::DataFiles;
use crate::results::{self, Written};

/// What a jog showed.
#[derive(Debug, Clone, PartialEq)]
pub struct Jog {
    /// The run.
    pub id: String,
    /// Mean command while it moved, V.
    pub command_v: f64,
    /// How far it went, m.
    pub way_m: f64,
    /// Whether it went where the command pushed.
    pub verdict: Verdict,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct CalibrationOutcome {
    /// Force per volt, where weights were hung.
    pub calibration: Option<Calibration>,
    /// Ideal force per volt of the declared constants.
    pub ideal_force_per_volt_n: f64,
    /// Jogs.
    pub jogs: Vec<Jog>,
    /// What is doubtful.
    pub findings: Vec<Finding>,
    /// The record: the force per volt as calibrated, and beside it as declared; empty without a calibration.
    pub file: EstimateFile,
    /// Where record and page lie; `None` without a calibration.
    pub written: Option<Written>,
}

/// State code of an exciting axis in a log (`froude_control::status::Phase`).
const EXCITING: f64 = 4.0;

impl CalibrationOutcome {
    /// What is doubtful, that of the comparison with what is declared too.
    #[must_use]
    pub fn file_findings(&self) -> &[Finding] {
        if self.calibration.is_some() { &self.file.findings } else { &self.findings }
    }
}

/// What to calibrate.
#[derive(Debug, Clone, Default)]
pub struct CalibrationJob {
    /// Folders of runs, or runs.
    pub runs: Vec<PathBuf>,
    /// A campaign other than the copy that lies with the runs.
    pub campaign: Option<PathBuf>,
    /// Folder of the results; beside the runs, unless said.
    pub out: Option<PathBuf>,
    /// Date for the report.
    pub date: Option<String>,
}

/// Reads calibration runs and jogs; where they calibrate, writes `estimate.json` and `report.html`.
///
/// # Errors
///
/// See [`Error`].
pub fn calibrate(job: &CalibrationJob) -> Result<CalibrationOutcome, Error> {
    let paths = &job.runs;
    let runs = read(paths, &[Role::Calibration, Role::Jog], job.campaign.as_deref())?;
    let out = job.out.clone().unwrap_or_else(|| runs.results("calibration"));
    if let Some(chosen) = &job.out {
        results::can_be_written(chosen)?;
    }
    let constants = runs.logs.iter().find_map(|log| log.meta.moving_axis());
    let setup = setup_of(runs.campaign.as_ref(), constants);
    let hung: Vec<DragRun<'_>> =
        runs.logs.iter().map(for_drag).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    let (calibration, why_not) = calibration_of(&hung, runs.campaign.as_ref(), &setup);
    let jogs: Vec<Jog> = runs.logs.iter().filter(|l| l.meta.role == Role::Jog).map(jog).collect::<Result<_, _>>()?;
    let mut findings = runs.findings.clone();
    findings.extend(why_not);
    for jog in jogs.iter().filter(|j| j.verdict != Verdict::Right) {
        let text = match jog.verdict {
            Verdict::NoMotion { largest_v } => {
                format!("{}: up to {largest_v:.2} V did not move the axis; raise the jog above breakaway", jog.id)
            }
            _ => format!(
                "{}: {:.2} V moved the axis {:.2} mm the other way: motor or encoder is wired in reverse; swap the encoder's channels \
                 or make counts_per_revolution negative",
                jog.id,
                jog.command_v,
                1e3 * jog.way_m
            ),
        };
        findings.push(Finding::new(Severity::Error, "polarity", text));
    }
    if calibration.is_none() && paths.iter().all(|p| p.is_file()) {
        let text = format!(
            "{} named and read; the folder {} may hold others",
            counted(paths.len(), "run was", "runs were"),
            runs.folder.display()
        );
        findings.push(Finding::new(Severity::Note, "single-runs", text));
    }
    if calibration.is_none() {
        findings.push(Finding::new(
            Severity::Warning,
            "not-calibrated",
            "no D_d from motor currents is stated better than the declared gear efficiency and K_T allow; hang known weights over a \
             pulley and drive both ways ([carriage.calibration])"
                .to_owned(),
        ));
    }
    let mut outcome = CalibrationOutcome {
        calibration,
        ideal_force_per_volt_n: setup.ideal_force_per_volt_n,
        jogs,
        findings,
        file: EstimateFile::of(Vec::new()),
        written: None,
    };
    if let Some(calibration) = &outcome.calibration {
        outcome.file = recorded(calibration, &setup, &runs, &outcome.findings)?;
        let html = document(&outcome, calibration, &setup.name, job.date.clone()).html()?;
        outcome.written = Some(results::write(&out, &outcome.file, &[], &[], &[], &html)?);
    }
    Ok(outcome)
}

/// The calibration beside what is declared of the drive, with the files that it comes from.
fn recorded(c: &Calibration, setup: &DragSetup, runs: &Runs, findings: &[Finding]) -> Result<EstimateFile, Error> {
    let campaign = runs.campaign.as_ref();
    let named = |path: &Path| path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let mut files = DataFiles::new(&named);
    let mut calibrated = record::calibrated(&setup.name, c, declared_weight_relative(campaign), weights_key(campaign));
    calibrated.data = files.keys_of(&files_of(runs), |role| role == Role::Calibration.name())?;
    let file = EstimateFile {
        data: files.into_map(),
        versions: results::versions(),
        ..EstimateFile::of(vec![calibrated, record::declared(&setup.name, setup)])
    };
    let mut comparison = compare(&named_in(&[("this calibration".to_owned(), file.clone())]));
    let mut findings = findings.to_vec();
    findings.append(&mut comparison.findings);
    Ok(EstimateFile { comparison: Some(comparison), findings, ..file })
}

/// The page: what was found, beside what was declared, and the jogs.
fn document(outcome: &CalibrationOutcome, c: &Calibration, name: &str, date: Option<String>) -> Document {
    let k = c.force_per_volt.force_per_volt_n;
    let mut paragraphs = vec![format!(
        "The drive gives {} N per volt of its command, 95 % interval {} N/V, from {}; {} left out.",
        number::short_form(k.value, k.standard),
        number::interval(c.interval_95),
        counted(c.used, "driving run", "driving runs"),
        counted(
            c.overhauled,
            "run in which the weight drove the gear was",
            "runs in which the weight drove the gear were"
        )
    )];
    paragraphs.extend(c.notes.iter().cloned());
    let comparison = outcome.file.comparison.iter();
    paragraphs.extend(comparison.flat_map(|c| c.verdicts.iter().map(|v| format!("{}.", verdict_words(v)))));
    let row = |estimate: &Estimate| {
        let coefficient = &estimate.coefficients["force_per_volt"];
        let text = |x: Option<f64>| x.map_or_else(|| number::MISSING.to_owned(), |x| number::significant(x, 4));
        vec![
            estimate.method.words.clone(),
            text(coefficient.value),
            text(coefficient.standard_uncertainty),
            coefficient.interval_95.map_or_else(|| number::MISSING.to_owned(), number::interval),
        ]
    };
    let force = TextTable {
        caption: "Force per volt of the command, driving forward.".to_owned(),
        head: ["from", "force per volt [N/V]", "standard uncertainty [N/V]", "95 % interval [N/V]"]
            .map(str::to_owned)
            .to_vec(),
        rows: outcome.file.estimates.iter().map(row).collect(),
    };
    let jogs = outcome.jogs.iter().map(|j| {
        vec![j.id.clone(), number::plain(j.command_v, 3), number::plain(1e3 * j.way_m, 3), polarity(&j.verdict)]
    });
    let mut tables = vec![force];
    if !outcome.jogs.is_empty() {
        tables.push(TextTable {
            caption: "Jogs.".to_owned(),
            head: ["run", "mean command [V]", "distance [mm]", "polarity"].map(str::to_owned).to_vec(),
            rows: jogs.collect(),
        });
    }
    Document {
        sort: "Carriage · calibration".to_owned(),
        title: "Force per volt".to_owned(),
        subtitle: name.to_owned(),
        date,
        sections: vec![DocumentSection { title: "Calibration".to_owned(), paragraphs, tables, charts: Vec::new() }],
        findings: outcome.file.findings.clone(),
    }
}

/// What a jog showed, in words.
#[must_use]
pub fn polarity(verdict: &Verdict) -> String {
    match verdict {
        Verdict::Right => "right".to_owned(),
        Verdict::Reversed { after_m } => format!("REVERSED, seen after {:.2} mm", 1e3 * after_m),
        Verdict::NoMotion { .. } => "not known: it did not move".to_owned(),
    }
}

fn jog(log: &RunLog) -> Result<Jog, Error> {
    let axis = log.meta.carriage.axis.name();
    let position = log.channel(&format!("{axis}/position"), Dimension::LENGTH)?;
    let command = log.channel(&format!("{axis}/command"), Dimension::VOLTAGE)?;
    let state = log.channel(&format!("{axis}/state"), Dimension::ONE)?;
    // Only while the loop is open: what holds before and brakes after pushes the other way.
    let first = state.iter().position(|s| *s == EXCITING).unwrap_or(0);
    let end = state.iter().rposition(|s| *s == EXCITING).map_or(first, |i| i + 1);
    let (position, command) = (&position[first..end], &command[first..end]);
    let way_m = position.last().zip(position.first()).map_or(0.0, |(last, first)| last - first);
    Ok(Jog {
        id: log.meta.id.clone(),
        command_v: command.iter().sum::<f64>() / command.len().max(1) as f64,
        way_m,
        verdict: judged(position, command),
    })
}
