//! What a fit returns.

use faer::{Mat, MatRef};

use crate::report::Report;

/// How a coefficient came by its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Estimated from the data.
    Free,
    /// At one of its bounds.
    AtBound,
    /// Held at a given value.
    Fixed,
    /// Held at zero.
    Excluded,
    /// Estimated from the data and a published value.
    Prior,
    /// Not determined by the data.
    Undetermined,
    /// At a bound that its unconstrained interval does not reach.
    BoundContradicted,
}

/// One coefficient of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitCoefficient {
    /// Its name.
    pub name: String,
    /// How it came by its value.
    pub status: Status,
    /// Its value under all constraints; `None` when not determined.
    pub value: Option<f64>,
    /// Standard uncertainty of the unconstrained estimate; `None` when held,
    /// not determined, or when there are no degrees of freedom.
    pub standard: Option<f64>,
    /// The t-interval of the unconstrained estimate, cut by the bounds; `None`
    /// without a standard uncertainty, or when nothing is left
    /// ([`Status::BoundContradicted`]).
    ///
    /// It is the unconstrained interval that covers as often as it says. The
    /// value may lie outside when another coefficient is held at its bound.
    pub interval: Option<[f64; 2]>,
    /// Degrees of freedom of the interval.
    pub dof: Option<f64>,
    /// The estimate without bounds and inequalities.
    pub unconstrained: Option<f64>,
    /// The row (HC3) or cluster (CR3) that tells most of its variance, and how much of it \[-\].
    pub most: Option<(usize, f64)>,
}

impl FitCoefficient {
    /// A coefficient of which the data say nothing.
    pub(crate) fn unfitted(name: &str, status: Status, value: Option<f64>) -> Self {
        Self {
            name: name.to_owned(),
            status,
            value,
            standard: None,
            interval: None,
            dof: None,
            unconstrained: None,
            most: None,
        }
    }
}

/// One response component of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct ComponentSummary {
    /// Its name.
    pub name: String,
    /// Its rows.
    pub n: usize,
    /// How many parameters its rows determine.
    pub rank: usize,
    /// `n − tr H`: rows less the parameters that they determine; a fraction
    /// where a prior or another component shares in one.
    pub dof: f64,
    /// Standard deviation of a row of weight one, from the fit without bounds
    /// and inequalities; `None` without degrees of freedom.
    pub sigma: Option<f64>,
    /// Weighted sum of squared residuals of the constrained fit.
    pub rss: f64,
    /// `√(Σ w r² / Σ w y²)`, 0 for a fit without error.
    pub relative_residual: f64,
    /// Durbin–Watson statistic of the residuals in row order; `None` below
    /// three rows or for residuals that are rounding only.
    pub durbin_watson: Option<f64>,
    /// Corrected Akaike criterion (σ counted); `None` where it is not defined
    /// (see [`crate::select::aicc`]).
    pub aicc: Option<f64>,
}

/// A determined combination of coefficients that are not determined themselves.
#[derive(Debug, Clone, PartialEq)]
pub struct Combination {
    /// `(coefficient, weight)`, in coefficient order; the first weight is 1.
    pub weights: Vec<(usize, f64)>,
    /// `Σ weight · coefficient`.
    pub value: f64,
    /// Its standard uncertainty.
    pub standard: Option<f64>,
    /// Degrees of freedom of that.
    pub dof: Option<f64>,
}

/// How well a constrained fit meets its optimality conditions.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimality {
    /// Largest violation, relative to the response.
    pub kkt: f64,
    /// Inequalities of the options that hold with equality.
    pub active_inequalities: Vec<usize>,
}

/// The result of [`crate::fit`].
#[derive(Debug, Clone)]
pub struct Fit {
    /// One per column of the design.
    pub coefficients: Vec<FitCoefficient>,
    /// Covariance of the unconstrained estimate, `p × p`; rows and columns are
    /// zero for coefficients that are held or not determined, NaN never.
    pub covariance: Mat<f64>,
    /// The pair of coefficients with the largest correlation, and that.
    pub largest_correlation: Option<(usize, usize, f64)>,
    /// One per component.
    pub components: Vec<ComponentSummary>,
    /// `X β` of the constrained fit, length `n`.
    pub fitted: Vec<f64>,
    /// `y − X β`, length `n`.
    pub residuals: Vec<f64>,
    /// Diagonal of the hat matrix of the unconstrained fit, length `n`.
    pub leverage: Vec<f64>,
    /// Largest over smallest singular value of the column-scaled free design;
    /// infinite when it is rank-deficient, 1 when nothing is free.
    pub condition_number: f64,
    /// What is determined of the coefficients that are not.
    pub undetermined: Vec<Combination>,
    /// `∂β/∂y` transposed, `n × p`, one row per data row. Stored so because faer pads every column to 64 bytes.
    pub sensitivity_by_row: Mat<f64>,
    /// How well the bounds and inequalities are met; `None` without any.
    pub optimality: Option<Optimality>,
    /// How the iterations ended.
    pub report: Report,
    /// Some minimiser, also where coefficients are not determined.
    pub(crate) minimiser: Vec<f64>,
    /// Null vectors.
    pub(crate) null_columns: Vec<Vec<f64>>,
}

/// A row may have this part of its terms along a null vector and still be determined.
const ALONG_NULL: f64 = 1e-8;

impl Fit {
    /// `∂β/∂y`, `p × n`, of the unconstrained estimate; zero rows like the
    /// covariance. The way of input errors into coefficients: [`crate::propagate`].
    #[must_use]
    pub fn sensitivity(&self) -> MatRef<'_, f64> {
        self.sensitivity_by_row.transpose()
    }

    /// The response `row · β`, also where only combinations are determined;
    /// `None` when the data do not determine it or the length is not `p`.
    #[must_use]
    pub fn predict(&self, row: &[f64]) -> Option<f64> {
        let is_determined = |null: &Vec<f64>| {
            let terms = row.iter().zip(null).map(|(x, null)| x * null);
            let (sum, size) = terms.fold((0.0_f64, 0.0), |(sum, size), term| (sum + term, size + term.abs()));
            sum.abs() <= ALONG_NULL * size
        };
        (row.len() == self.minimiser.len() && self.null_columns.iter().all(is_determined))
            .then(|| crate::dense::dot(row, &self.minimiser))
    }
}
