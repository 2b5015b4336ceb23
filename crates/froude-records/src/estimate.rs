//! `estimate.json`: coefficients with covariance, validity and provenance.
//!
//! This is the record that `compare`, `report`, simulators and exporters take.
//! A number that the data do not determine is `null`, never NaN and never zero.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use crate::finding::Finding;

/// Name and major version of the record, as it stands in `schema`.
pub const ESTIMATE_SCHEMA: &str = "froude/estimate/1";

/// A whole `estimate.json`.
///
/// It is serialised with a `checksum` of its content, which [`crate::json::read_estimates`] holds it against.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct EstimateFile {
    /// `froude/estimate/1`.
    pub schema: String,
    /// The files that the numbers came from.
    #[serde(default)]
    pub data: Vec<DataFile>,
    /// Program versions by name.
    #[serde(default)]
    pub versions: IndexMap<String, String>,
    /// One entry per source and model.
    pub estimates: Vec<Estimate>,
    /// What the lints found.
    #[serde(default)]
    pub findings: Vec<Finding>,
}

/// A file and its fingerprint.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DataFile {
    /// Path as the campaign names it.
    pub path: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// A number with its unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The number, in `unit`.
    pub value: f64,
    /// SI unit text, `1` for a pure number.
    pub unit: String,
}

/// A closed range with its unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// SI unit text.
    pub unit: String,
}

/// What became of a coefficient in the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Estimated, inside its bounds.
    Free,
    /// The constrained fit put it on a bound.
    AtBound,
    /// Given by the campaign or by the publication, not estimated.
    Fixed,
    /// Left out of the model by the campaign.
    Excluded,
    /// Estimated together with a published value as prior.
    Prior,
    /// The data do not determine it: the value is null.
    Undetermined,
    /// Its unconstrained interval lies wholly outside its bounds.
    BoundContradicted,
}

/// One coefficient.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Coefficient {
    /// Value in `unit`; null when undetermined.
    pub value: Option<f64>,
    /// SI unit text, `1` for a pure number.
    pub unit: String,
    /// What became of it.
    pub status: Status,
    /// Combined standard uncertainty; null when none is stated or none exists.
    #[serde(default)]
    pub standard_uncertainty: Option<f64>,
    /// Its part from the scatter of the data (GUM type A).
    #[serde(default)]
    pub type_a: Option<f64>,
    /// Its part from the declared budget (GUM type B).
    #[serde(default)]
    pub type_b: Option<f64>,
    /// 95 % interval, cut by the bounds.
    #[serde(default)]
    pub interval_95: Option<[f64; 2]>,
    /// Effective degrees of freedom of the combined uncertainty; null when infinite or none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effective_dof: Option<f64>,
}

/// The force law that the coefficients belong to.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Law {
    /// Version of the law's definition.
    pub version: u32,
    /// Constants that the coefficients mean nothing without (`v_ref`, `epsilon`, `mu_n`, …).
    #[serde(default)]
    pub constants: IndexMap<String, Measured>,
    /// User-written formulas by load (`f_y` = "…"); empty for built-in laws.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub formulas: IndexMap<String, String>,
}

/// Covariance of the estimated coefficients, in the units of their product.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Covariance {
    /// Names, in the order of the matrix.
    pub names: Vec<String>,
    /// Rows of the symmetric matrix.
    pub matrix: Vec<Vec<f64>>,
}

/// Numbers that tell how far the fit can be trusted.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Diagnostics {
    /// Condition number of the column-scaled design.
    #[serde(default)]
    pub condition_number: Option<f64>,
    /// Largest absolute correlation between two coefficients, and their names.
    #[serde(default)]
    pub largest_correlation: Option<NamedCorrelation>,
    /// Largest leverage of one observation.
    #[serde(default)]
    pub largest_leverage: Option<f64>,
    /// ‖residual‖ / ‖measured‖ by load component.
    #[serde(default)]
    pub relative_residual: IndexMap<String, f64>,
    /// Durbin–Watson statistic by load component, in run order.
    #[serde(default)]
    pub durbin_watson: IndexMap<String, f64>,
    /// Akaike's corrected criterion (sum over components).
    #[serde(default)]
    pub aicc: Option<f64>,
    /// Root mean square error of leave-one-configuration-out prediction, by component, N or N m.
    #[serde(default)]
    pub cross_validation_rmse: IndexMap<String, f64>,
    /// Why cross-validation could not be scored, where it could not.
    #[serde(default)]
    pub cross_validation_note: Option<String>,
    /// p-value of the lack-of-fit test against repeats, by component.
    #[serde(default)]
    pub lack_of_fit_p: IndexMap<String, f64>,
    /// Largest power f·v delivered to the body in the fitted range, W (≤ 0 is dissipative).
    #[serde(default)]
    pub largest_power_w: Option<f64>,
    /// Further sentences.
    #[serde(default)]
    pub notes: Vec<String>,
}

/// Correlation between two named coefficients.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NamedCorrelation {
    /// First name.
    pub first: String,
    /// Second name.
    pub second: String,
    /// Correlation, −1 to 1.
    pub value: f64,
}

/// Coefficients of one force model from one source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Unique in the file, `source/model`.
    pub id: String,
    /// Name of the source in the campaign.
    pub source: String,
    /// `tank`, `towing`, `cfd`, `potential` or `published`.
    #[serde(default)]
    pub kind: String,
    /// Force model: `f1` … `f6`, `linear_quadratic`, `power_law`, `added_mass_6x6`, or a user's name.
    pub model: String,
    /// The law itself.
    #[serde(default)]
    pub law: Law,
    /// Geometry that the coefficients refer to, by name.
    #[serde(default)]
    pub geometry: IndexMap<String, Measured>,
    /// Water density.
    #[serde(default)]
    pub density: Option<Measured>,
    /// Axes of the coefficients, in words.
    #[serde(default)]
    pub frame: String,
    /// Reference point, in words.
    #[serde(default)]
    pub reference_point: String,
    /// How the numbers were made, in words.
    #[serde(default)]
    pub method: String,
    /// `classical`, `HC3`, `CR3 by configuration`, … or `none stated`.
    #[serde(default)]
    pub covariance_kind: String,
    /// Degrees of freedom by load component.
    #[serde(default)]
    pub dof: IndexMap<String, Option<f64>>,
    /// Residual standard deviation by load component.
    #[serde(default)]
    pub sigma: IndexMap<String, Measured>,
    /// Observations used.
    #[serde(default)]
    pub n_observations: usize,
    /// The coefficients, in the order of the model.
    pub coefficients: IndexMap<String, Coefficient>,
    /// Their covariance, where one is stated.
    #[serde(default)]
    pub covariance: Option<Covariance>,
    /// Combinations that are determined although their members are not.
    #[serde(default)]
    pub undetermined: Vec<String>,
    /// Ranges of the observations: speed, angle, Re, Fr, KC, blockage, …
    #[serde(default)]
    pub validity: IndexMap<String, Range>,
    /// How far the fit can be trusted.
    #[serde(default)]
    pub diagnostics: Diagnostics,
    /// True for one estimate per source.
    #[serde(default)]
    pub recommended: bool,
    /// Why it is recommended, or why it is not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}
