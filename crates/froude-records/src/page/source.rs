//! What a page says of one source: its estimates, its observations and curves, its budget, the contest of its models.
//!
//! **Units.** SI; angles in radians (printed in degrees). A force, a coefficient or a width carries its unit as text in the field beside it.
//! **Missing numbers.** `None` is printed as "—". A NaN or an infinity is treated like `None`; it is never printed as a number.

use super::{Curve, Point};
use crate::comparison::AddedTerms;
use crate::estimate::Estimate;

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
    pub tests: Vec<AddedTerms>,
    /// Which model is recommended and why, in a sentence or two.
    pub recommendation: String,
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
