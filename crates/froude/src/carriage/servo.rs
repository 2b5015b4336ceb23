//! `froude carriage identify`: servo parameters with intervals, from runs of a carriage or from anyone's servo log.

use std::path::{Path, PathBuf};

use froude_carriage::axis::page::sections;
use froude_carriage::axis::{AxisModels, KINDS, of_runs, of_table};
use froude_carriage::runs::read;
use froude_records::estimate::EstimateFile;
use froude_report::document::Document;

use crate::Error;
use crate::data_files::DataFiles;
use crate::results::{self, Written};

/// What to identify.
#[derive(Debug, Clone)]
pub struct ServoJob {
    /// Folders of runs, runs, or one CSV log.
    pub input: Vec<PathBuf>,
    /// Sidecar of a CSV log that is not beside it.
    pub sidecar: Option<PathBuf>,
    /// Folder of the results; beside the input, unless said.
    pub out: Option<PathBuf>,
    /// Date for the report.
    pub date: Option<String>,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct ServoOutcome {
    /// The models.
    pub axis: AxisModels,
    /// The record: an estimate for each model.
    pub file: EstimateFile,
    /// Where record and page lie.
    pub written: Written,
}

/// Identifies whatever the input allows and writes `estimate.json` and `report.html`.
///
/// # Errors
///
/// See [`Error`].
pub fn identify(job: &ServoJob) -> Result<ServoOutcome, Error> {
    let first = job.input.first().cloned().unwrap_or_default();
    let is_table = first.extension().is_some_and(|e| e == "csv" || e == "parquet");
    let runs = if is_table { None } else { Some(read(&job.input, &KINDS, None)?) };
    let beside = || match &runs {
        Some(runs) => runs.results("servo"),
        None => first.with_file_name(format!("{}-servo", first.file_stem().unwrap_or_default().to_string_lossy())),
    };
    let out = job.out.clone().unwrap_or_else(beside);
    results::can_be_written(&out)?;
    let axis = match &runs {
        Some(runs) => of_runs(runs)?,
        None => of_table(&first, job.sidecar.as_deref())?,
    };
    let file = recorded(&axis)?;
    let html = document(&axis, &first, job.date.clone()).html()?;
    let written = results::write(&out, &file, &[], &[], &[], &html)?;
    Ok(ServoOutcome { axis, file, written })
}

/// A record of the models with the files that each comes from.
fn recorded(axis: &AxisModels) -> Result<EstimateFile, Error> {
    let named = |path: &Path| path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let mut files = DataFiles::new(&named);
    let mut estimates = Vec::new();
    for (estimate, observed) in &axis.estimates {
        let mut estimate = estimate.clone();
        estimate.data = files.keys_of(&axis.files, |role| role == *observed)?;
        estimates.push(estimate);
    }
    let findings = axis.findings.clone();
    let data = files.into_map();
    Ok(EstimateFile { data, findings, versions: results::versions(), ..EstimateFile::of(estimates) })
}

fn document(axis: &AxisModels, input: &Path, date: Option<String>) -> Document {
    Document {
        sort: "Carriage · servo parameters".to_owned(),
        title: format!("Servo identification of {}", input.display()),
        date,
        sections: sections(axis),
        findings: axis.findings.clone(),
        ..Document::default()
    }
}
