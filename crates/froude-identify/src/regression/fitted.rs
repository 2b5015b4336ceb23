//! A law fitted to observations, and how it was fitted.

use faer::Mat;
use froude_fit as fit;
use froude_fit::budget::{Combined, Part};
use froude_fit::replicates::Replicates;
use froude_records::campaign::{BudgetEntry, Identify, SourceKind};
use froude_records::finding::Finding;

use crate::dataset::Dataset;
use crate::law::{CoefficientSpec, ForceLaw};
use crate::uncertainty::SharedError;

/// What the observations weigh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// All alike.
    One,
    /// By the `std_*` column of a load; all alike in a load without one.
    Std,
}

/// Where the standard uncertainties come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Scatter {
    /// The residuals: independent, one σ a load.
    Classical,
    /// The residuals: independent, of any variance.
    Hc3,
    /// The residuals, correlated in the groups of the data.
    Cluster,
    /// The residuals, correlated in time within each run, with errors of rows that come about so ([`fit::serial`]); for one load.
    Serial(fit::serial::RowErrors),
    /// Replicates that the method left out in turn: all coefficients of the law, or none where nothing tells the scatter.
    Replicates {
        /// The line of the budget.
        name: String,
        /// Independent sets of them.
        sets: Vec<Replicates>,
    },
}

impl Scatter {
    /// What the residuals are asked for.
    pub(crate) const fn of_residuals(&self) -> fit::CovarianceKind {
        match self {
            Self::Classical | Self::Serial(_) | Self::Replicates { .. } => fit::CovarianceKind::Classical,
            Self::Hc3 => fit::CovarianceKind::Hc3,
            Self::Cluster => fit::CovarianceKind::Cr3,
        }
    }
}

/// What a regression needs besides its data and law.
#[derive(Debug, Clone, Copy)]
pub struct Settings<'a> {
    /// Name of the source, for messages.
    pub source_name: &'a str,
    /// What kind of source it is.
    pub kind: SourceKind,
    /// `[identify]` of the campaign.
    pub identify: &'a Identify,
    /// What the observations weigh.
    pub weight: Weight,
    /// Where the scatter comes from.
    pub scatter: &'a Scatter,
    /// The declared budget.
    pub budget: &'a [BudgetEntry],
    /// Key of the campaign that declares it; empty where none does.
    pub campaign: &'a str,
    /// Errors from subtracted tares, and those that the source's method knows.
    pub shared_errors: &'a [SharedError],
    /// Looks that an interval pays for (Bonferroni), 1 or more.
    pub looks: usize,
    /// All rows of a table that was read in chunks; then `data` holds those at the ends of its ranges.
    pub condensed: Option<&'a Condensed>,
}

/// Rows of a law that is linear in its coefficients, condensed to few with the same minimiser and sum of squares.
#[derive(Debug, Clone)]
pub struct Condensed {
    /// Triangles of `[X | y]`, one for each load, or one for each load and cluster.
    pub problem: fit::Problem,
    /// Observations of each load.
    pub observations: Vec<usize>,
}

impl<'a> Settings<'a> {
    /// Weights of the table, scatter of the residuals, nothing declared, one look.
    #[must_use]
    pub const fn new(source_name: &'a str, kind: SourceKind, identify: &'a Identify) -> Self {
        Self {
            source_name,
            kind,
            identify,
            weight: Weight::Std,
            scatter: &Scatter::Classical,
            budget: &[],
            campaign: "",
            shared_errors: &[],
            looks: 1,
            condensed: None,
        }
    }
}

/// A fitted law.
#[derive(Debug, Clone)]
pub struct ModelFit {
    /// The law.
    pub law: ForceLaw,
    /// All coefficients: those of the law, then angle offsets by setup.
    pub specs: Vec<CoefficientSpec>,
    /// The stacked problem in its final linearisation.
    pub problem: fit::Problem,
    /// The options it was fitted with.
    pub options: fit::Options,
    /// The fit.
    pub fit: fit::Fit,
    /// Coefficient values, zero where undetermined, in the order of `specs`.
    pub coefficients: Vec<f64>,
    /// Combined uncertainty per coefficient, where it has one.
    pub combined: Vec<Option<Combined>>,
    /// Combined covariance, p × p.
    pub covariance: Mat<f64>,
    /// The budget: the scatter, the declared entries, the shared errors.
    pub budget: Vec<Part>,
    /// True where errors of speed and angle were fitted too.
    pub in_variables: bool,
    /// Where its scatter comes from.
    pub scatter: Scatter,
    /// Words for that.
    pub covariance_kind: String,
    /// What was found while fitting.
    pub findings: Vec<Finding>,
}

impl ModelFit {
    /// The law's own coefficients (without angle offsets).
    #[must_use]
    pub fn law_coefficients(&self) -> &[f64] {
        &self.coefficients[..self.law.coefficients.len()]
    }

    /// Whether its rows follow each other in time, and its scatter knows.
    #[must_use]
    pub fn is_in_time(&self, data: &Dataset) -> bool {
        match self.scatter {
            Scatter::Serial(_) => true,
            Scatter::Cluster => data.group.as_ref() == Some(&data.run) && data.rows >= 2 * data.clusters(),
            Scatter::Classical | Scatter::Hc3 | Scatter::Replicates { .. } => false,
        }
    }

    /// Standard uncertainty of the predicted response for one row of regressors.
    ///
    /// √(xᵀCx) with C the combined covariance of the coefficients; N or N m for a `row` x in SI, as [`ForceLaw::regressors`] gives it.
    ///
    /// # Source
    ///
    /// JCGM 100:2008 (GUM), 5.2.2.
    #[must_use]
    pub fn prediction_std(&self, row: &[f64]) -> f64 {
        let mut variance = 0.0;
        for (a, x) in row.iter().enumerate() {
            for (b, y) in row.iter().enumerate() {
                variance += x * y * self.covariance[(a, b)];
            }
        }
        variance.max(0.0).sqrt()
    }
}
