//! How a law is fitted: how the observations are weighted, where their scatter comes from, what is declared of them.

use faer::Mat;
use froude_fit as fit;
use froude_fit::replicates::Replicates;
use froude_records::campaign::{BudgetEntry, Identify, SourceKind};

use crate::uncertainty::SharedError;

/// How the observations are weighted.
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
    /// The residuals: independent, each row a run that errs by a part of its load beside one σ.
    Runs,
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
    /// The covariance to be estimated from the residuals.
    pub(crate) const fn of_residuals(&self) -> fit::CovarianceKind {
        match self {
            Self::Classical | Self::Runs | Self::Serial(_) | Self::Replicates { .. } => fit::CovarianceKind::Classical,
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
    /// How the observations are weighted.
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
    /// Columns of the other laws on the rows of the problem, by name.
    pub beside: Vec<(String, Mat<f64>)>,
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
