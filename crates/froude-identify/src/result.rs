//! What a source gives: its observations, every law fitted to them, and the files it was read from.

use std::path::PathBuf;

use froude_records::campaign::SourceKind;
use froude_records::comparison::AddedTerms;
use froude_records::estimate::{Estimate, Range};
use froude_records::finding::Finding;
use froude_records::run::step::Step;
use indexmap::IndexMap;

use crate::dataset::Dataset;
use crate::regression::ModelFit;
use crate::selection::{BlockScore, Recommendation, Score};

/// Everything that identification found out about one source.
#[derive(Debug, Clone)]
pub struct SourceResult {
    /// Name of the source.
    pub name: String,
    /// Its kind.
    pub kind: SourceKind,
    /// The observations that were fitted.
    pub data: Dataset,
    /// Rows in the file.
    pub n_read: usize,
    /// The fitted models, in the order asked for.
    pub models: Vec<ModelFit>,
    /// Models that were asked for and could not be fitted.
    pub not_fitted: Vec<NotFitted>,
    /// Their records, in the same order.
    pub estimates: Vec<Estimate>,
    /// Each law beside the terms of the others.
    pub tests: Vec<AddedTerms>,
    /// Leave-one-configuration-out scores, in the order of the models.
    pub scores: Vec<Score>,
    /// Declared range blocks, model by model.
    pub blocks: Vec<BlockScore>,
    /// Which model, and why.
    pub recommendation: Option<Recommendation>,
    /// Ranges of the observations.
    pub validity: IndexMap<String, Range>,
    /// All findings.
    pub findings: Vec<Finding>,
    /// Files that were read.
    pub files: Vec<ReadFile>,
}

/// A file that was read for a source.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadFile {
    /// Where it lies.
    pub path: PathBuf,
    /// What it was read as: `table`, `sidecar`, `record`, or the kind of a run.
    pub role: String,
    /// What was done to its data, in order.
    pub steps: Vec<Step>,
}

impl ReadFile {
    /// A file read as `role`.
    #[must_use]
    pub fn new(path: PathBuf, role: &str) -> Self {
        Self { path, role: role.to_owned(), steps: Vec::new() }
    }
}

/// A model that was asked for and could not be fitted: it costs its own row and no other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotFitted {
    /// Name of the model.
    pub model: String,
    /// Why, and what to do.
    pub why: String,
}
