//! Version 1 of the record: read, and converted to the current one.
//!
//! It stated one covariance for scatter and budget together, axes and points in words, and not which files an estimate came from. What it did not
//! say stays unsaid: the point is not stated, no error has a key, and the whole covariance counts as the estimate's own.

use indexmap::IndexMap;
use serde::Deserialize;

use super::{
    Coefficient, DataFile, Diagnostics, Estimate, EstimateFile, Frame, Law, Measured, MethodUsed, Output, Range,
    ReferencePoint, TypeA, keyed,
};
use crate::finding::Finding;

/// Name and major version of the old record.
pub const SCHEMA: &str = "froude/estimate/1";

/// What the covariance of an old record is.
const TOGETHER: &str = "type A and B together";

#[derive(Deserialize)]
pub(crate) struct FileV1 {
    #[serde(default)]
    data: Vec<DataFile>,
    #[serde(default)]
    versions: IndexMap<String, String>,
    estimates: Vec<EstimateV1>,
    #[serde(default)]
    findings: Vec<Finding>,
}

#[derive(Deserialize, Default)]
struct LawV1 {
    version: u32,
    #[serde(default)]
    constants: IndexMap<String, Measured>,
    #[serde(default)]
    formulas: IndexMap<String, String>,
}

#[derive(Deserialize)]
struct CovarianceV1 {
    names: Vec<String>,
    matrix: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
struct EstimateV1 {
    id: String,
    source: String,
    #[serde(default)]
    kind: String,
    model: String,
    #[serde(default)]
    law: LawV1,
    #[serde(default)]
    geometry: IndexMap<String, Measured>,
    density: Option<Measured>,
    #[serde(default)]
    frame: String,
    #[serde(default)]
    reference_point: String,
    #[serde(default)]
    method: String,
    #[serde(default)]
    covariance_kind: String,
    #[serde(default)]
    dof: IndexMap<String, Option<f64>>,
    #[serde(default)]
    sigma: IndexMap<String, Measured>,
    #[serde(default)]
    n_observations: usize,
    coefficients: IndexMap<String, Coefficient>,
    covariance: Option<CovarianceV1>,
    #[serde(default)]
    undetermined: Vec<String>,
    #[serde(default)]
    validity: IndexMap<String, Range>,
    #[serde(default)]
    diagnostics: Diagnostics,
    #[serde(default)]
    recommended: bool,
    reason: Option<String>,
}

impl From<FileV1> for EstimateFile {
    fn from(file: FileV1) -> Self {
        Self {
            data: keyed(file.data),
            versions: file.versions,
            findings: file.findings,
            ..Self::of(file.estimates.into_iter().map(Estimate::from).collect())
        }
    }
}

impl From<EstimateV1> for Estimate {
    fn from(e: EstimateV1) -> Self {
        let of = |names: &[String]| {
            names.iter().map(|name| e.coefficients.get(name).and_then(|c| c.effective_dof)).collect::<Vec<_>>()
        };
        let stated = [e.covariance_kind.as_str(), TOGETHER].into_iter().filter(|text| !text.is_empty());
        let kind = stated.collect::<Vec<_>>().join("; ");
        let type_a = e.covariance.map(|c| TypeA { dof: of(&c.names), names: c.names, matrix: c.matrix, kind });
        let density = e.density.map(|density| ("density".to_owned(), density));
        let output = |formula| Output { unit: String::new(), formula: Some(formula) };
        let outputs = e.law.formulas.into_iter();
        Self {
            id: e.id,
            source: e.source,
            kind: e.kind,
            method: MethodUsed { words: e.method, ..MethodUsed::default() },
            frame: Frame { words: e.frame, ..Frame::default() },
            point: ReferencePoint { words: e.reference_point, stated: false },
            law: Law {
                name: e.model,
                version: e.law.version,
                inputs: IndexMap::new(),
                outputs: outputs.map(|(load, formula)| (load, output(formula))).collect(),
                constants: e.law.constants,
            },
            refers_to: density.into_iter().chain(e.geometry).collect(),
            n_observations: e.n_observations,
            dof: e.dof,
            sigma: e.sigma,
            coefficients: e.coefficients,
            type_a,
            undetermined: e.undetermined,
            validity: e.validity,
            diagnostics: e.diagnostics,
            recommended: e.recommended,
            reason: e.reason,
            ..Self::default()
        }
    }
}
