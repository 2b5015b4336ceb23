//! `estimate.json`: coefficients with covariance, validity and provenance.
//!
//! This is the record that `compare`, `report`, simulators and exporters take.
//! A number that the data do not determine is `null`, never NaN and never zero.
//!
//! An estimate is whole by itself: its scatter is [`Estimate::type_a`], every other error stands in [`Estimate::errors`] with a key, and
//! `Cov(β) = type_a + Σ S·C·Sᵀ`. Two estimates that name one key share that error: its part in the covariance between them is `S_a·C·S_bᵀ`.
//! Keys that begin with [`OWN`] are of one estimate alone.
//! Records of version 1 are read and lifted ([`v1`]).

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use crate::comparison::Comparison;
use crate::finding::Finding;
use crate::number::finite;
use crate::run::step::Step;

pub use crate::measured::Measured;

mod units;
pub mod v1;
pub mod words;

pub(crate) use units::{BadUnit, to_si};

/// Name and major version of the record, as it stands in `schema`.
pub const ESTIMATE_SCHEMA: &str = "froude/estimate/2";

/// Start of the key of an error that no other estimate can have.
pub const OWN: &str = "own/";

/// A whole `estimate.json`.
///
/// It is serialised with a `checksum` of its content, which [`crate::json::read_estimates`] checks it against.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
pub struct EstimateFile {
    /// `froude/estimate/2`; a record of version 1 is lifted to it when it is read.
    pub schema: String,
    /// The files that the numbers came from, by a short key.
    #[serde(default)]
    pub data: IndexMap<String, DataFile>,
    /// Program versions by name.
    #[serde(default)]
    pub versions: IndexMap<String, String>,
    /// One entry per source and model or method.
    pub estimates: Vec<Estimate>,
    /// Estimates side by side, where there was more than one source.
    pub comparison: Option<Comparison>,
    /// What the lints found.
    #[serde(default)]
    pub findings: Vec<Finding>,
}

/// A file and its fingerprint.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DataFile {
    /// Path as the campaign names it.
    pub path: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// What it was read as: `campaign`, `table`, `sidecar`, `record`, `mesh`, or the kind of a run (`wet`, `dry`, …).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub role: Option<String>,
    /// What was done to its data, in order; empty where that is not stated, or nothing was done.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<Step>,
}

/// Scatter of a row that is a run: its variance is `constant`² + (`part` · load)².
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunScatter {
    /// What is the same at every load.
    pub constant: Measured,
    /// Fraction of the load, 1.
    pub part: f64,
    /// Degrees of freedom of that variance at the largest load of the rows.
    pub dof: Option<f64>,
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

impl Range {
    /// From the smallest value to the largest.
    pub fn of([low, high]: [f64; 2], unit: impl Into<String>) -> Self {
        Self { low, high, unit: unit.into() }
    }

    /// Widens it to hold these as well.
    pub fn include(&mut self, [low, high]: [f64; 2]) {
        (self.low, self.high) = (self.low.min(low), self.high.max(high));
    }
}

/// What became of a coefficient in the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Estimated, inside its bounds.
    #[default]
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
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Coefficient {
    /// What a paper or a trade calls it, where that is another name than the record's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// Value in `unit`; null when undetermined.
    pub value: Option<f64>,
    /// Estimate without bounds and inequalities, about which the covariance is stated; null where it is the value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unconstrained: Option<f64>,
    /// SI unit text, `1` for a pure number.
    pub unit: String,
    /// What became of it.
    pub status: Status,
    /// True for what the fit needs and nobody asks for: an offset of an angle, a rest position.
    #[serde(default, skip_serializing_if = "is_false")]
    pub nuisance: bool,
    /// Combined standard uncertainty; null when none is stated or none exists.
    pub standard_uncertainty: Option<f64>,
    /// Its part from the scatter of the data (GUM type A).
    pub type_a: Option<f64>,
    /// Its part from the declared budget (GUM type B).
    pub type_b: Option<f64>,
    /// 95 % interval if the law is true, cut by the bounds.
    pub interval_95: Option<[f64; 2]>,
    /// Envelope of its 95 % intervals over all laws of the source that contain it and that the data do not contradict; absent if no laws were compared, this law is contradicted, the value is held, or one of the intervals is missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range_95: Option<[f64; 2]>,
    /// Effective degrees of freedom of the combined uncertainty; null when infinite or none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effective_dof: Option<f64>,
}

impl Coefficient {
    /// A value and its status, without an uncertainty.
    pub fn of(value: Option<f64>, unit: impl Into<String>, status: Status) -> Self {
        Self { value, unit: unit.into(), status, ..Self::default() }
    }
}

/// The law that the coefficients belong to.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Law {
    /// `f1` … `f6`, `quadratic`, `linear_quadratic`, `power_law`, `added_mass_6x6`, or a user's name.
    pub name: String,
    /// Version of the law's definition.
    #[serde(default)]
    pub version: u32,
    /// Units of the motion that it reads, by channel.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub inputs: IndexMap<String, String>,
    /// What it gives, by load; a built-in law has no formula, its name says it.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub outputs: IndexMap<String, Output>,
    /// Constants that the coefficients mean nothing without (`v_ref`, `epsilon`, `mu_n`, …).
    #[serde(default)]
    pub constants: IndexMap<String, Measured>,
}

impl Law {
    /// Version 1 of a law that reads these channels, each with its unit, and gives no load yet.
    pub fn of<T: Into<String>, U: Into<String>>(
        name: impl Into<String>,
        inputs: impl IntoIterator<Item = (T, U)>,
    ) -> Self {
        let inputs = inputs.into_iter().map(|(channel, unit)| (channel.into(), unit.into())).collect();
        Self { name: name.into(), version: 1, inputs, ..Self::default() }
    }

    /// The law with one more load, in `unit`.
    #[must_use]
    pub fn giving(mut self, load: impl Into<String>, unit: impl Into<String>, formula: Option<String>) -> Self {
        self.outputs.insert(load.into(), Output { unit: unit.into(), formula });
        self
    }

    /// Formulas by load; empty for built-in laws.
    #[must_use]
    pub fn formulas(&self) -> IndexMap<String, String> {
        let of = |(load, output): (&String, &Output)| Some((load.clone(), output.formula.clone()?));
        self.outputs.iter().filter_map(of).collect()
    }
}

/// A load that a law gives.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Output {
    /// SI unit text; empty where an old record did not say it.
    #[serde(default)]
    pub unit: String,
    /// `-D_x_II*v_x*abs(v_x)`; null for a built-in law.
    pub formula: Option<String>,
}

/// Covariance of the estimated coefficients, in the units of their product.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    /// Names, in the order of the matrix.
    pub names: Vec<String>,
    /// Rows of the symmetric matrix.
    pub matrix: Vec<Vec<f64>>,
}

/// What the scatter of the observations makes of the coefficients.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TypeA {
    /// Names, in the order of the matrix and of the rows of every sensitivity.
    pub names: Vec<String>,
    /// Rows of the symmetric covariance matrix, in the units of the coefficients' products.
    pub matrix: Vec<Vec<f64>>,
    /// Degrees of freedom of each coefficient's standard uncertainty; null when infinite or not stated.
    pub dof: Vec<Option<f64>>,
    /// `classical`, `HC3`, `jackknife over pairs`, …
    pub kind: String,
}

impl TypeA {
    /// A scatter of this `kind`; infinite degrees of freedom are written as null.
    pub fn of(names: Vec<String>, matrix: Vec<Vec<f64>>, dof: &[f64], kind: impl Into<String>) -> Self {
        let dof = dof.iter().map(|d| finite(Some(*d))).collect();
        Self { names, matrix, dof, kind: kind.into() }
    }
}

/// An error beside the scatter: a calibration, a tare, a constant of the rig. The file holds it by its key.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SharedError {
    /// What errs, in words.
    pub name: String,
    /// The quantity that errs: a column, `force_per_volt`, a tare's coefficients.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub quantity: String,
    /// How it was evaluated.
    pub kind: ErrorKind,
    /// Covariance C of the error, q × q.
    pub covariance: Vec<Vec<f64>>,
    /// Degrees of freedom of it; null when infinite.
    pub dof: Option<f64>,
    /// Limits of an error of one component that is uniform between them; null where it is normal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<[f64; 2]>,
    /// S = ∂β/∂e, a row per name of `type_a`, a column per component of the error.
    pub sensitivity: Vec<Vec<f64>>,
}

/// How an error was evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ErrorKind {
    /// By anything but scatter: a certificate, a data sheet, another fit (GUM type B).
    B,
    /// The mesh, the step, the iteration of a computation.
    #[serde(rename = "numerical")]
    Numerical,
    /// What went into a computation.
    #[serde(rename = "input")]
    Input,
    /// The law itself, or the model of turbulence behind a computation.
    #[serde(rename = "model_form")]
    ModelForm,
}

impl ErrorKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::B, Self::Numerical, Self::Input, Self::ModelForm];
    /// What files call them, in the same order.
    pub const NAMES: [&'static str; 4] = ["B", "numerical", "input", "model_form"];
}

/// Axes of the coefficients.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Frame {
    /// `body`, `chain`, …; empty where it is not stated.
    pub name: String,
    /// Where its axes point, in words, `x`, `y`, `z` in turn; empty where it is not stated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub axes: Vec<String>,
    /// All of it in words.
    #[serde(default)]
    pub words: String,
}

impl Frame {
    /// SNAME axes of a body.
    #[must_use]
    pub fn body() -> Self {
        Self {
            name: "body".to_owned(),
            axes: ["forward", "starboard", "down"].map(str::to_owned).to_vec(),
            words: "body axes: x forward, y to starboard, z down; loads of the fluid on the body".to_owned(),
        }
    }

    /// That of a carriage where nobody has said which axis of the body lies along its travel.
    #[must_use]
    pub fn chain() -> Self {
        Self {
            name: CHAIN.to_owned(),
            axes: Vec::new(),
            words: "x along the chain; f_x of the fluid on the body".to_owned(),
        }
    }
}

/// Name of [`Frame::chain`].
pub const CHAIN: &str = "chain";

/// The point that moments are about.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ReferencePoint {
    /// In words; empty where nobody named it.
    pub words: String,
    /// Whether somebody stated it, or it is taken for granted.
    pub stated: bool,
}

impl ReferencePoint {
    /// The point that somebody stated in words, if anybody did.
    #[must_use]
    pub fn stated(words: Option<String>) -> Self {
        Self { stated: words.is_some(), words: words.unwrap_or_default() }
    }
}

/// What the signs mean.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Signs(pub String);

impl Default for Signs {
    fn default() -> Self {
        Self("load of the fluid on the body; velocity of the body through the water".to_owned())
    }
}

/// How a body was held.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Attitude {
    /// The body axis along the travel: `x`, `y` or `z`.
    pub travel: String,
}

/// The method that made an estimate.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct MethodUsed {
    /// `table`, `fsm`, `mcd`, `free_decay_envelope`, …; empty where an old record did not say it.
    pub name: String,
    /// Version of the method.
    pub version: u32,
    /// How the numbers were made, in words.
    pub words: String,
}

impl MethodUsed {
    /// Version 1 of a method.
    pub fn of(name: impl Into<String>, words: impl Into<String>) -> Self {
        Self { name: name.into(), version: 1, words: words.into() }
    }
}

/// Independent groups behind the scatter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Clusters {
    /// What a group is: `pair`, `configuration`, `run`.
    pub by: String,
    /// How many there are.
    pub n: usize,
}

impl Clusters {
    /// `n` groups, each a `by`.
    pub fn of(by: impl Into<String>, n: usize) -> Self {
        Self { by: by.into(), n }
    }
}

/// A number made from coefficients, outside the covariance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Derived {
    /// `2*D_x_II/(density*area)`, of coefficients and of what they refer to.
    pub formula: String,
    /// Its value; null where it has none.
    pub value: Option<f64>,
    /// SI unit text.
    pub unit: String,
    /// Combined standard uncertainty.
    pub standard_uncertainty: Option<f64>,
    /// 95 % interval.
    pub interval_95: Option<[f64; 2]>,
}

impl Derived {
    /// A number without an uncertainty.
    pub fn of(formula: impl Into<String>, value: Option<f64>, unit: impl Into<String>) -> Self {
        Self { formula: formula.into(), value, unit: unit.into(), standard_uncertainty: None, interval_95: None }
    }
}

/// What the intervals are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Probability inside.
    pub level: f64,
    /// Looks that they pay for (Bonferroni), 1 or more.
    pub looks: usize,
    /// What they are of: `coefficient`, `mesh` (panels and facets), `excitation` (the coefficients for this motion alone).
    pub of: String,
}

impl Default for Interval {
    fn default() -> Self {
        Self { level: 0.95, looks: 1, of: "coefficient".to_owned() }
    }
}

/// Numbers that tell how far the fit can be trusted.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Diagnostics {
    /// Condition number of the column-scaled design.
    pub condition_number: Option<f64>,
    /// Largest absolute correlation between two coefficients, and their names.
    pub largest_correlation: Option<NamedCorrelation>,
    /// Largest leverage of one observation.
    pub largest_leverage: Option<f64>,
    /// ‖residual‖ / ‖measured‖ by load component.
    pub relative_residual: IndexMap<String, f64>,
    /// Durbin–Watson statistic by load component, in run order.
    pub durbin_watson: IndexMap<String, f64>,
    /// Akaike's corrected criterion (sum over components).
    pub aicc: Option<f64>,
    /// Root mean square error of leave-one-configuration-out prediction, by component, N or N m.
    pub cross_validation_rmse: IndexMap<String, f64>,
    /// Why cross-validation could not be scored, where it could not.
    pub cross_validation_note: Option<String>,
    /// p-value of the lack-of-fit test against repeats, by component.
    pub lack_of_fit_p: IndexMap<String, f64>,
    /// Largest power f·v delivered to the body in the fitted range, W (≤ 0 is dissipative).
    pub largest_power_w: Option<f64>,
    /// Further sentences.
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

/// Coefficients of one law from one source, by one method.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Estimate {
    /// Unique in the file, `source/model`.
    pub id: String,
    /// Name of the source in the campaign.
    pub source: String,
    /// `tank`, `towing`, `cfd`, `potential` or `published`.
    #[serde(default)]
    pub kind: String,
    /// The method that made it.
    #[serde(default)]
    pub method: MethodUsed,
    /// Axes of the coefficients.
    #[serde(default)]
    pub frame: Frame,
    /// The point that moments are about.
    #[serde(default)]
    pub point: ReferencePoint,
    /// What the signs mean.
    #[serde(default)]
    pub signs: Signs,
    /// How the body was held; null where nobody declared it.
    pub attitude: Option<Attitude>,
    /// The law.
    pub law: Law,
    /// What the coefficients refer to: `density`, `area`, `volume`, the body's measures.
    #[serde(default)]
    pub refers_to: IndexMap<String, Measured>,
    /// Keys of the files that its observations came from.
    #[serde(default)]
    pub data: Vec<String>,
    /// Degrees of freedom by load component.
    #[serde(default)]
    pub dof: IndexMap<String, Option<f64>>,
    /// Residual standard deviation by load component.
    #[serde(default)]
    pub sigma: IndexMap<String, Measured>,
    /// Run-to-run scatter by load component, if the rows are runs; absent otherwise.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub run_scatter: IndexMap<String, RunScatter>,
    /// Observations used.
    #[serde(default, rename = "n")]
    pub n_observations: usize,
    /// Independent groups behind its scatter, where there are such.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clusters: Option<Clusters>,
    /// The coefficients, in the order of the model.
    pub coefficients: IndexMap<String, Coefficient>,
    /// Numbers made from them.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub derived: IndexMap<String, Derived>,
    /// Their covariance from scatter alone; null where none is stated.
    pub type_a: Option<TypeA>,
    /// All other errors, by key. An error of another estimate with the same key is the same error.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub errors: IndexMap<String, SharedError>,
    /// What the intervals are.
    #[serde(default)]
    pub interval: Interval,
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
    /// Ids of all estimates of its source, in this file, whose laws the data do not contradict: the band of a force is the envelope of theirs, and the range of a coefficient that of its
    /// intervals in them. Empty where no laws were compared.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_contradicted: Vec<String>,
}

impl Estimate {
    /// Density of the water that they refer to.
    #[must_use]
    pub fn density(&self) -> Option<&Measured> {
        self.refers_to.get("density")
    }

    /// The derived numbers in the form of coefficients, for tables of both.
    #[must_use]
    pub fn derived_coefficients(&self) -> IndexMap<String, Coefficient> {
        let of = |number: &Derived| Coefficient {
            standard_uncertainty: number.standard_uncertainty,
            interval_95: number.interval_95,
            ..Coefficient::of(number.value, &number.unit, Status::Free)
        };
        self.derived.iter().map(|(name, number)| (name.clone(), of(number))).collect()
    }

    /// Kind of the covariance, or that there is none.
    #[must_use]
    pub fn covariance_kind(&self) -> &str {
        self.type_a.as_ref().map_or("none stated", |a| &a.kind)
    }

    /// The coefficients of a record of clusters that have a standard uncertainty and no interval: one cluster decides them.
    #[must_use]
    pub fn without_interval(&self) -> Vec<&str> {
        if self.clusters.is_none() {
            return Vec::new();
        }
        let is_refused = |c: &Coefficient| {
            matches!(c.status, Status::Free | Status::Prior)
                && c.interval_95.is_none()
                && c.standard_uncertainty.is_some_and(|u| u > 0.0)
        };
        self.coefficients.iter().filter(|(_, c)| is_refused(c)).map(|(name, _)| name.as_str()).collect()
    }

    /// Covariance of the coefficients: scatter and all other errors.
    #[must_use]
    pub fn covariance(&self) -> Option<Covariance> {
        let own = self.type_a.as_ref()?;
        let mut matrix = own.matrix.clone();
        for error in self.errors.values() {
            for (row, s) in matrix.iter_mut().zip(&error.sensitivity) {
                for (sum, t) in row.iter_mut().zip(&error.sensitivity) {
                    *sum += error.between(s, t);
                }
            }
        }
        Some(Covariance { names: own.names.clone(), matrix })
    }
}

impl SharedError {
    /// An error of one quantity, declared by its standard uncertainty; `slopes` is ∂β/∂e. Infinite degrees of freedom are written as null.
    pub fn declared(
        [name, quantity]: [&str; 2],
        standard: f64,
        dof: f64,
        slopes: impl IntoIterator<Item = f64>,
    ) -> Self {
        Self {
            name: name.to_owned(),
            quantity: quantity.to_owned(),
            kind: ErrorKind::B,
            covariance: vec![vec![standard * standard]],
            dof: finite(Some(dof)),
            limits: None,
            sensitivity: slopes.into_iter().map(|s| vec![s]).collect(),
        }
    }

    /// `s·C·tᵀ`: the covariance that this error makes between two numbers that go with it as `s` and `t`.
    #[must_use]
    pub fn between(&self, s: &[f64], t: &[f64]) -> f64 {
        let of_row = |row: &Vec<f64>| row.iter().zip(t).map(|(c, t)| c * t).sum::<f64>();
        self.covariance.iter().zip(s).map(|(row, s)| s * of_row(row)).sum()
    }
}

impl EstimateFile {
    /// A record of this version, without files and findings yet.
    #[must_use]
    pub fn of(estimates: Vec<Estimate>) -> Self {
        Self { schema: ESTIMATE_SCHEMA.to_owned(), estimates, ..Self::default() }
    }
}

/// Of all estimates of a file, the others of one's source whose laws the data do not contradict.
#[must_use]
pub fn beside<'a>(all: impl IntoIterator<Item = &'a Estimate>, estimate: &Estimate) -> Vec<&'a Estimate> {
    all.into_iter().filter(|e| e.id != estimate.id && estimate.not_contradicted.contains(&e.id)).collect()
}

/// Files by short keys, `d1`, `d2`, ….
#[must_use]
pub fn keyed(files: Vec<DataFile>) -> IndexMap<String, DataFile> {
    files.into_iter().enumerate().map(|(i, file)| (format!("d{}", i + 1), file)).collect()
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_false(value: &bool) -> bool {
    !value
}
