//! What a job reads and asks for, and what comes out.

use std::path::{Path, PathBuf};

use froude_identify::answer::Answer;
use froude_identify::method::Method;
use froude_records::estimate::EstimateFile;
use froude_records::given_option::GivenOption;
use froude_records::outcome::Outcome;

/// What a job reads.
#[derive(Debug, Clone)]
pub enum Input {
    /// A campaign (`.toml`) or a bare table (`.csv`, `.parquet`).
    File(PathBuf),
    /// Runs of a carriage, reduced in every way that the job's method allows for them.
    Runs {
        /// Folders of runs, or runs.
        paths: Vec<PathBuf>,
        /// A campaign other than the copy that lies with them.
        campaign: Option<PathBuf>,
    },
    /// A body file or a mesh, of which added mass is computed.
    Mesh {
        /// The file.
        path: PathBuf,
        /// What is asked of it.
        options: Vec<GivenOption>,
    },
    /// Records, which are set side by side; nothing is fitted.
    Records(Vec<PathBuf>),
}

/// What to identify and where the results go.
#[derive(Debug, Clone)]
pub struct Job {
    /// What is read.
    pub input: Input,
    /// Folder of the results. Unless said, beside the input and named after it; for records then nothing is written.
    pub out: Option<PathBuf>,
    /// A sidecar for a bare table that is not beside it.
    pub sidecar: Option<PathBuf>,
    /// Models for a bare table, or instead of the campaign's.
    pub models: Vec<String>,
    /// Method for runs or a log where no campaign names one. By default: carriage drag for runs, and for a log whatever its sidecar indicates.
    pub method: Option<&'static dyn Method>,
    /// The log of a servo that the fits of another are held against.
    pub validation: Option<PathBuf>,
    /// Date for the report's title page, as text; the pipeline reads no clock.
    pub date: Option<String>,
}

impl Job {
    /// A job on a campaign or a bare table, with nothing but its input.
    #[must_use]
    pub fn new(file: impl Into<PathBuf>) -> Self {
        Self::of(Input::File(file.into()))
    }

    /// A job with nothing but its input.
    #[must_use]
    pub fn of(input: Input) -> Self {
        Self { input, out: None, sidecar: None, models: Vec::new(), method: None, validation: None, date: None }
    }

    /// Where the results will lie, as far as that is known before the input is read.
    #[must_use]
    pub fn folder(&self) -> Option<PathBuf> {
        match (&self.out, &self.input) {
            (None, Input::File(path)) => Some(default_out(path, "results")),
            (None, Input::Mesh { path, .. }) => Some(default_out(path, "added-mass")),
            (out, _) => out.clone(),
        }
    }
}

/// What came out.
#[derive(Debug)]
pub struct Identified {
    /// The record, as it stands in `estimate.json`; sources side by side are in it.
    pub file: EstimateFile,
    /// Every answer that was found, with everything that is known about its fit.
    pub sources: Vec<Answer>,
    /// All else that is told, and the files that were written where somebody asked for them.
    pub told: Outcome,
}

impl Identified {
    /// Where a file lies that was written: `estimates`, `report`, `observations`, `exports`.
    #[must_use]
    pub fn path(&self, key: &str) -> Option<&Path> {
        self.told.path(key)
    }

    /// As a verb returns it.
    #[must_use]
    pub fn outcome(self) -> Outcome {
        Outcome { findings: Some(self.file.findings.clone()), records: vec![self.file], ..self.told }
    }
}

/// The folder of results beside an input, where none is named: `tow-results` of `tow.csv`.
#[must_use]
pub fn default_out(input: &Path, what: &str) -> PathBuf {
    let stem = input.file_stem().map_or_else(|| "froude".to_owned(), |s| s.to_string_lossy().into_owned());
    input.with_file_name(format!("{stem}-{what}"))
}
