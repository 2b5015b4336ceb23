//! How a problem is to be fitted.

use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Mat, Par, Side};

use crate::error::FitError;
use crate::problem::{Problem, size};

/// Bounds, constraints, prior knowledge and kind of covariance.
#[derive(Debug, Clone)]
pub struct Options {
    /// Bounds of the coefficients: empty (all free) or one per coefficient.
    pub bounds: Vec<Bound>,
    /// Linear inequalities `row · β ≤ value`.
    pub inequalities: Vec<Constraint>,
    /// Published values taken as observations with a known standard deviation.
    pub priors: Vec<Prior>,
    /// Coefficients held at a value, taken as exact.
    pub fixed: Vec<(usize, f64)>,
    /// Coefficients held at zero.
    pub excluded: Vec<usize>,
    /// Where the standard uncertainties come from.
    pub covariance: CovarianceKind,
    /// Probability of the intervals, 0.95 by default.
    pub confidence: f64,
    /// Observations behind the rows of each component: empty, each row is one, or one number per component.
    ///
    /// `R` and `Qᵀy` of `[X | y] = Q·R` have the minimiser and the sum of squares of all their rows under any constraint and prior: such
    /// rows stand for more observations than they are. Clusters condensed one by one keep CR3; HC3 and Durbin–Watson need the rows
    /// themselves.
    pub observations: Vec<usize>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            bounds: Vec::new(),
            inequalities: Vec::new(),
            priors: Vec::new(),
            fixed: Vec::new(),
            excluded: Vec::new(),
            covariance: CovarianceKind::Classical,
            confidence: 0.95,
            observations: Vec::new(),
        }
    }
}

/// Bounds of one coefficient; infinite where there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Smallest value allowed.
    pub lower: f64,
    /// Largest value allowed.
    pub upper: f64,
}

impl Bound {
    /// Any value.
    pub const FREE: Self = Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
    /// Zero or more.
    pub const NON_NEGATIVE: Self = Self { lower: 0.0, upper: f64::INFINITY };
}

/// A linear relation between coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// Factors of the coefficients, length `p`.
    pub row: Vec<f64>,
    /// Right-hand side.
    pub value: f64,
}

/// A value known beforehand, with its standard uncertainty.
///
/// Correlated values are stated as conditionals: the second given the first, β₂ − s β₁ with the slope s = cov/u₁², and so on ([`Prior::correlated`]).
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// The coefficient.
    pub index: usize,
    /// Its published value.
    pub value: f64,
    /// Its standard uncertainty, positive, in the unit of the coefficient.
    pub standard: f64,
    /// Coefficients that it is conditioned on, with their slopes: `value` is that of the coefficient minus Σ slope · coefficient.
    pub with: Vec<(usize, f64)>,
}

/// Part of a variance by which correlated values are held apart.
const EXACT: f64 = 1e-9;

impl Prior {
    /// A value independent of all others.
    #[must_use]
    pub const fn new(index: usize, value: f64, standard: f64) -> Self {
        Self { index, value, standard, with: Vec::new() }
    }

    /// Priors of several coefficients with a joint covariance; `None` if it is not positive definite.
    ///
    /// Each prior is conditioned on those before it: Anderson (2003), *An Introduction to Multivariate Statistical Analysis*, 2.5.
    #[must_use]
    pub fn correlated(indices: &[usize], values: &[f64], covariance: &Mat<f64>) -> Option<Vec<Self>> {
        let n = indices.len();
        // Entries that go with each other exactly, as those of a body of revolution, leave a variance of zero.
        let widened = Mat::from_fn(n, n, |i, j| covariance[(i, j)] * if i == j { 1.0 + EXACT } else { 1.0 });
        let lower = widened.llt(Side::Lower).ok()?.L().to_owned();
        // Rows of L⁻¹, with the last entry 1: β_k less what those before it say.
        let mut inverse = Mat::<f64>::identity(n, n);
        solve_lower_triangular_in_place(lower.as_ref(), inverse.as_mut(), Par::Seq);
        let of = |k: usize| {
            let standard = lower[(k, k)];
            let slopes: Vec<f64> = (0..k).map(|j| -inverse[(k, j)] * standard).collect();
            let value = values[k] - slopes.iter().zip(values).map(|(s, v)| s * v).sum::<f64>();
            let with = (0..k).filter(|j| slopes[*j] != 0.0).map(|j| (indices[j], slopes[j])).collect();
            Self { index: indices[k], value, standard, with }
        };
        Some((0..n).map(of).collect())
    }
}

/// Where the standard uncertainties come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CovarianceKind {
    /// Independent errors of one σ per component.
    Classical,
    /// Independent errors of any variance (MacKinnon & White 1985, HC3).
    Hc3,
    /// Errors correlated in clusters: cluster jackknife, t with degrees of freedom of its own.
    Cr3,
}

impl Options {
    /// Bounds of coefficient `j`.
    pub(crate) fn bound(&self, j: usize) -> Bound {
        self.bounds.get(j).copied().unwrap_or(Bound::FREE)
    }

    /// The same options without bounds and inequalities.
    #[must_use]
    pub fn unconstrained(&self) -> Self {
        Self { bounds: Vec::new(), inequalities: Vec::new(), ..self.clone() }
    }

    /// Checks indices, sizes and numbers against the problem.
    ///
    /// # Errors
    ///
    /// The first thing found wrong.
    pub fn check(&self, problem: &Problem) -> Result<(), FitError> {
        let p = problem.n_coefficients();
        let of_columns = "one per column of the design";
        if !self.bounds.is_empty() {
            size("bounds", self.bounds.len(), p, of_columns)?;
        }
        for (j, bound) in self.bounds.iter().enumerate() {
            let is_fine = bound.lower <= bound.upper && bound.lower < f64::INFINITY && bound.upper > f64::NEG_INFINITY;
            if !is_fine {
                return Err(FitError::Refused(format!(
                    "bounds of {:?} are [{}, {}]; the lower must not exceed the upper",
                    problem.names[j], bound.lower, bound.upper
                )));
            }
        }
        for constraint in &self.inequalities {
            size("inequality row", constraint.row.len(), p, of_columns)?;
            for &value in constraint.row.iter().chain([&constraint.value]) {
                finite("a number of a constraint", value)?;
            }
        }
        if !(self.confidence > 0.0 && self.confidence < 1.0) {
            return Err(FitError::option("confidence", self.confidence, "between 0 and 1"));
        }
        if !self.observations.is_empty() {
            size("observations", self.observations.len(), problem.components.len(), "one per component")?;
            if self.covariance == CovarianceKind::Hc3 {
                return Err(FitError::Refused("a fit of condensed rows does not accept HC3".to_owned()));
            }
        }
        if self.covariance == CovarianceKind::Cr3 && problem.cluster.is_none() {
            return Err(FitError::NoClusters);
        }
        self.check_coefficients(problem)
    }

    fn check_coefficients(&self, problem: &Problem) -> Result<(), FitError> {
        let p = problem.n_coefficients();
        let mut said: Vec<Option<&'static str>> = vec![None; p];
        let mut say = |index: usize, option: &'static str| match said.get_mut(index) {
            None => Err(FitError::Refused(format!("{option} names coefficient {index}, but the design has {p}"))),
            Some(Some(first)) => {
                let name = &problem.names[index];
                Err(FitError::Refused(format!("coefficient {name:?} is {first} and {option} at once; choose one")))
            }
            Some(empty) => {
                *empty = Some(option);
                Ok(())
            }
        };
        for &(index, value) in &self.fixed {
            say(index, "fixed")?;
            finite("a fixed value", value)?;
            let bound = self.bound(index);
            if value < bound.lower || value > bound.upper {
                return Err(FitError::Refused(format!(
                    "coefficient {:?} is fixed at {value}, outside its bounds [{}, {}]",
                    problem.names[index], bound.lower, bound.upper
                )));
            }
        }
        for &index in &self.excluded {
            say(index, "excluded")?;
        }
        for prior in &self.priors {
            say(prior.index, "given a prior")?;
            finite("the value of a prior", prior.value)?;
            if !(prior.standard > 0.0 && prior.standard.is_finite()) {
                let must = "positive and finite (fix the coefficient to take a value as exact)";
                return Err(FitError::option("the standard uncertainty of a prior", prior.standard, must));
            }
        }
        Ok(())
    }
}

fn finite(option: &'static str, value: f64) -> Result<(), FitError> {
    if value.is_finite() { Ok(()) } else { Err(FitError::option(option, value, "finite")) }
}
