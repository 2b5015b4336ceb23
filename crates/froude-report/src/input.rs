//! What a report is made from.
//!
//! The report computes no physics and fits nothing: everything it prints stands
//! in these records. All of them have public fields and a `Default`, so that a
//! caller fills in what it has and leaves the rest.
//!
//! **Units.** SI; angles in radians (printed in degrees). A force, a
//! coefficient or a width carries its unit as text in the field beside it.
//! **Missing numbers.** `None` is printed as "—". A NaN or an infinity is
//! treated like `None`; it is never printed as a number.

use froude_records::comparison::{Comparison, NestedTest};
use froude_records::estimate::{DataFile, Estimate};
use froude_records::finding::Finding;
use froude_records::page::DocumentSection;
use indexmap::IndexMap;

/// A whole report, from the title to the hashes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// Title on the first line, usually the campaign's name.
    pub title: String,
    /// Second line: body, facility, customer.
    pub subtitle: String,
    /// Date as text; the report reads no clock.
    pub date: Option<String>,
    /// Paragraphs of the method section.
    pub method: Vec<String>,
    /// What methods state about the runs that they reduced together, before the sections of their results.
    pub blocks: Vec<DocumentSection>,
    /// One section per source that was fitted.
    pub sources: Vec<SourceSection>,
    /// Published estimates shown beside the fitted ones; their `kind` is `published`.
    pub published: Vec<Estimate>,
    /// What the lints found, over the whole campaign.
    pub findings: Vec<Finding>,
    /// The files that the numbers came from.
    pub data: Vec<InputFile>,
    /// Program versions by name.
    pub versions: IndexMap<String, String>,
    /// What to cite, one entry per work.
    pub citations: Vec<String>,
    /// Sources side by side, when there is more than one; its findings are said below its tables.
    pub comparison: Option<Comparison>,
}

/// A file, its fingerprint, and what was taken from it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct InputFile {
    /// Path as the campaign names it.
    pub path: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// Rows in the file.
    pub n_rows: Option<usize>,
    /// Rows that entered a fit, after `keep` and after identical copies were dropped.
    pub n_used: Option<usize>,
    /// The source that reads it.
    pub source: Option<String>,
}

impl From<DataFile> for InputFile {
    fn from(file: DataFile) -> Self {
        Self { path: file.path, sha256: file.sha256, ..Self::default() }
    }
}

/// Everything about one source.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SourceSection {
    /// Name of the source in the campaign.
    pub name: String,
    /// `tank`, `towing`, `cfd`, `potential`.
    pub kind: String,
    /// Facts for the head of the section, `(name, value)` as they shall be read.
    pub facts: Vec<(String, String)>,
    /// One estimate per model; the one with `recommended` set is shown in the summary.
    pub estimates: Vec<Estimate>,
    /// Observations with the prediction of the recommended model.
    pub points: Vec<Point>,
    /// How many observations `points` were drawn from by chance; `None` where they are all.
    pub sample_of: Option<usize>,
    /// Model lines to be drawn through the observations.
    pub curves: Vec<Curve>,
    /// Contributions to the uncertainty of each coefficient.
    pub budget: Vec<BudgetRow>,
    /// The contest of the models, one row per model and load component.
    pub selection: Vec<SelectionRow>,
    /// Models that were asked for and could not be fitted, each with the reason.
    pub not_fitted: Vec<(String, String)>,
    /// F tests between nested models.
    pub tests: Vec<NestedTest>,
    /// Which model is recommended and why, in a sentence or two.
    pub recommendation: String,
}

/// One steady observation.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Point {
    /// Configuration (`H1LT`, …); empty when there is only one.
    pub configuration: String,
    /// Load component: `f_x`, `m_z`, …
    pub component: String,
    /// Unit of `measured`, `standard` and `fitted`.
    pub unit: String,
    /// Speed through the water.
    pub speed_m_s: f64,
    /// Angle `atan2(−v_y, v_x)`.
    pub angle_rad: f64,
    /// Another abscissa, for loads that do not go with speed or angle (a rotor's rate).
    pub other: Option<Abscissa>,
    /// The measured load.
    pub measured: f64,
    /// Its standard uncertainty, where one is known.
    pub standard: Option<f64>,
    /// What the recommended model gives there.
    pub fitted: f64,
}

/// A named abscissa.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Abscissa {
    /// Name of the channel, e.g. `w_z`.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// Its value, in `unit`.
    pub value: f64,
}

/// What a curve runs against, and what is held on it.
#[derive(Debug, Clone, PartialEq)]
pub enum Against {
    /// `x` is the speed \[m/s\] at this angle.
    Speed {
        /// Angle held on the curve.
        angle_rad: f64,
    },
    /// `x` is the angle \[rad\] at this speed.
    Angle {
        /// Speed held on the curve.
        speed_m_s: f64,
    },
    /// `x` is another channel, in `unit`.
    Other {
        /// Name of the channel, as in [`Abscissa::quantity`].
        quantity: String,
        /// Its unit.
        unit: String,
    },
}

/// A model line with its 95 % band.
///
/// `x`, `y`, `low` and `high` have one entry per place on the line; an empty
/// `low` or `high` means that no band is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Configuration, as in [`Point::configuration`].
    pub configuration: String,
    /// Load component, as in [`Point::component`].
    pub component: String,
    /// Unit of `y`, `low` and `high`.
    pub unit: String,
    /// The model that it belongs to; lines of the recommended model are drawn
    /// solid, others dashed and without band.
    pub model: String,
    /// What `x` is.
    pub against: Against,
    /// Abscissae, rising.
    pub x: Vec<f64>,
    /// Loads.
    pub y: Vec<f64>,
    /// Lower edge of the 95 % band.
    pub low: Vec<f64>,
    /// Upper edge of the 95 % band.
    pub high: Vec<f64>,
}

/// One input's part in the uncertainty of one coefficient.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BudgetRow {
    /// Model of the coefficient.
    pub model: String,
    /// The coefficient.
    pub coefficient: String,
    /// The input: `scatter`, `f_x calibration`, `speed`, …
    pub input: String,
    /// `sample`, `run`, `setup`, `campaign`; empty for the scatter itself.
    pub shared: String,
    /// Standard uncertainty of the coefficient from this input alone, in `unit`.
    pub contribution: f64,
    /// Unit of the coefficient.
    pub unit: String,
    /// Part of the coefficient's variance, 0 to 1.
    pub share: f64,
}

/// One model's standing in one load component.
#[derive(Debug, Clone, PartialEq)]
pub struct SelectionRow {
    /// The model.
    pub model: String,
    /// Load component.
    pub component: String,
    /// Coefficients estimated in this component.
    pub n_coefficients: usize,
    /// Residual standard deviation, in `unit`.
    pub sigma: f64,
    /// Unit of `sigma` and of the prediction errors.
    pub unit: String,
    /// ‖residual‖ / ‖measured‖, 1 = 100 %.
    pub relative_residual: f64,
    /// AICc in this load above that of the best model of it; or why it has none.
    pub delta_aicc: Result<f64, String>,
    /// Root mean square error of leave-one-configuration-out prediction, in
    /// `unit`; or why it cannot be scored.
    pub cross_validation: Result<f64, String>,
    /// Root mean square prediction error in `unit` outside each declared
    /// training range, `(range in words, error)`.
    pub range_blocks: Vec<(String, f64)>,
    /// p-value of the lack-of-fit test against repeats.
    pub lack_of_fit_p: Option<f64>,
}

impl Default for SelectionRow {
    fn default() -> Self {
        Self {
            model: String::new(),
            component: String::new(),
            n_coefficients: 0,
            sigma: f64::NAN,
            unit: String::new(),
            relative_residual: f64::NAN,
            delta_aicc: Err("not asked for".to_owned()),
            cross_validation: Err("not asked for".to_owned()),
            range_blocks: Vec::new(),
            lack_of_fit_p: None,
        }
    }
}

/// Why a report could not be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The drawing library refused a figure.
    #[error("figure {figure:?} could not be drawn: {reason}")]
    Figure {
        /// Title of the figure.
        figure: String,
        /// What the drawing library said.
        reason: String,
    },
}
