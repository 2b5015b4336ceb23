//! A law fitted to observations, and how it was fitted.

use std::borrow::Cow;

use faer::Mat;
use froude_fit as fit;
use froude_fit::budget::{Combined, Part, rounded_dof};
use froude_fit::distribution::t_two_sided;
use froude_records::finding::Finding;

use crate::dataset::{Dataset, GroupedBy};
use crate::law::{CoefficientSpec, ForceLaw};
use crate::regression::generalised::Whitened;
use crate::regression::runs;
use crate::regression::settings::Scatter;
use crate::uncertainty::coverage_factor;

/// Fewest degrees of freedom of an interval by clusters; two equal ones less one would have one.
const FEWEST_CLUSTER_DOF: f64 = 2.0 - 1e-6;
/// Standard uncertainties by which a value lies outside of an interval by rounding.
const ROUNDING: f64 = 1e-9;
/// Chance of calling a bound contradicted that holds, over all bounds of a law.
const BOUND_ALARM: f64 = 0.01;

fn is_group(shared: &str) -> bool {
    matches!(shared, "run" | "setup")
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
    /// Columns of the other laws on its rows, where these are condensed.
    pub beside: Vec<(String, Mat<f64>)>,
    /// Effect of each declared shared error on its rows, one column per error.
    pub declared: Mat<f64>,
    /// The options it was fitted with.
    pub options: fit::Options,
    /// The fit.
    pub fit: fit::Fit,
    /// The problem with rows whitened by declared errors that runs or setups share, where it was fitted so.
    pub whitened: Option<Whitened>,
    /// The same by least squares, with its declared errors, where all rows share every declared error of runs or setups.
    pub plain: Option<Box<(fit::Fit, Mat<f64>)>>,
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
    /// The fit for the tests of rows and law: that by least squares where all rows share every declared error of runs or setups, which is then one of the campaign.
    #[must_use]
    pub fn judged(&self) -> Cow<'_, Self> {
        let Some((fit, declared)) = self.plain.as_deref() else { return Cow::Borrowed(self) };
        let of_all =
            |part: &Part| Part { shared: if is_group(part.shared) { "campaign" } else { part.shared }, ..part.clone() };
        Cow::Owned(Self {
            fit: fit.clone(),
            declared: declared.clone(),
            whitened: None,
            plain: None,
            budget: self.budget.iter().map(of_all).collect(),
            ..self.clone()
        })
    }

    /// Whether errors that rows of a run or a setup share are declared.
    #[must_use]
    pub fn declares_groups(&self) -> bool {
        self.budget.iter().any(|part| part.kind.is_type_b() && !part.in_scatter && is_group(part.shared))
    }

    /// The law's own coefficients (without angle offsets).
    #[must_use]
    pub fn law_coefficients(&self) -> &[f64] {
        &self.coefficients[..self.law.coefficients.len()]
    }

    /// Whether the interval of a coefficient is refused: of clusters that give it less than two degrees of freedom, where one of them decides.
    #[must_use]
    pub fn is_refused(&self, j: usize) -> bool {
        self.scatter == Scatter::Cluster && self.fit.coefficients[j].dof.is_some_and(|dof| dof < FEWEST_CLUSTER_DOF)
    }

    /// Which bound the data put a coefficient outside of; at most 1 % of laws whose coefficients lie within all of theirs have one.
    #[must_use]
    pub fn contradicted_bound(&self, j: usize) -> Option<f64> {
        let bounds = &self.options.bounds;
        let count =
            bounds.iter().map(|b| usize::from(b.lower.is_finite()) + usize::from(b.upper.is_finite())).sum::<usize>();
        let (bound, combined) = (bounds.get(j)?, self.combined[j]?);
        let free = self.fit.coefficients[j].unconstrained?;
        let beyond = if free < bound.lower { bound.lower } else { bound.upper };
        let is_outside = free < bound.lower || free > bound.upper;
        let p = 0.5 * t_two_sided((free - beyond).abs() / combined.standard, combined.dof);
        (is_outside && p < BOUND_ALARM / count.max(1) as f64).then_some(beyond)
    }

    /// Whether the bounds of others move a coefficient out of its own interval, which is that of the fit without bounds: the interval does not belong to the value.
    #[must_use]
    pub fn is_moved_out(&self, j: usize) -> bool {
        let fitted = &self.fit.coefficients[j];
        let (Some(c), Some(free), Some(value)) = (self.combined[j], fitted.unconstrained, fitted.value) else {
            return false;
        };
        let [low, high] = c.interval(free);
        let rounding = ROUNDING * c.standard;
        fitted.status == fit::Status::Free && (value < low - rounding || value > high + rounding)
    }

    /// The problem with one more coefficient per declared shared error, known to be zero within its standard uncertainty.
    #[must_use]
    pub fn clear_of_declared(&self) -> (fit::Problem, fit::Options) {
        let (n, p, k) = (self.problem.n_rows(), self.problem.n_coefficients(), self.declared.ncols());
        let mut options = self.options.unconstrained();
        if k == 0 || self.declared.nrows() != n {
            return (self.problem.clone(), options);
        }
        options.priors.extend((0..k).map(|error| fit::Prior::new(p + error, 0.0, 1.0)));
        let entry = |i: usize, j: usize| if j < p { self.problem.design[(i, j)] } else { self.declared[(i, j - p)] };
        let mut names = self.problem.names.clone();
        names.extend((0..k).map(|error| format!("declared error {error}")));
        (fit::Problem { design: Mat::from_fn(n, p + k, entry), names, ..self.problem.clone() }, options)
    }

    /// Whether some rows weigh more than others.
    #[must_use]
    pub fn is_weighted(&self) -> bool {
        is_uneven(&self.problem)
    }

    /// Standard deviation of a row of each load about the law, in the unit of the load (of a fit in logarithms, a part of it).
    ///
    /// Of weighted rows the root of their mean variance, σ √(Σ (1/w)/n): σ itself is that of a row of weight 1, and there may be no such row.
    #[must_use]
    pub fn sigma_of_rows(&self, load: usize) -> Option<f64> {
        let sigma = self.fit.components[load].sigma?;
        let Some(weight) = &self.problem.weight else { return Some(sigma) };
        let rows = self.problem.rows_of(load).into_iter();
        let (sum, n) = rows.fold((0.0, 0.0), |(sum, n), i| (sum + 1.0 / weight[i], n + 1.0));
        Some(sigma * (sum / n).sqrt())
    }

    /// √a, √b and the degrees of freedom of each load, if the rows are runs of equal weight and the intervals include this scatter.
    #[must_use]
    pub(crate) fn run_scatter(&self, data: &Dataset) -> Option<Vec<[f64; 3]>> {
        let is_of_runs = self.budget.first().is_some_and(|part| part.name.starts_with(runs::NAME));
        let runs = (is_of_runs && self.problem.weight.is_none())
            .then(|| runs::between_runs(&self.law, data, &self.problem, &self.fit))?;
        runs.map(|runs| runs.loads)
    }

    /// Whether its rows follow each other in time, and its scatter knows.
    #[must_use]
    pub fn is_in_time(&self, data: &Dataset) -> bool {
        match self.scatter {
            Scatter::Serial(_) => true,
            Scatter::Cluster => {
                matches!(data.grouped_by, GroupedBy::Run | GroupedBy::Motion) && data.rows >= 2 * data.clusters()
            }
            Scatter::Classical | Scatter::Runs | Scatter::Hc3 | Scatter::Replicates { .. } => false,
        }
    }

    /// Whether its intervals assume that the rows of a load scatter alike.
    #[must_use]
    pub fn is_of_one_sigma(&self) -> bool {
        match self.scatter {
            Scatter::Classical => true,
            Scatter::Runs => !self.budget.first().is_some_and(|part| part.name.starts_with(runs::NAME)),
            Scatter::Hc3 | Scatter::Cluster | Scatter::Serial(_) | Scatter::Replicates { .. } => false,
        }
    }

    /// How far the 95 % band of a predicted response reaches below and above it, for one row of regressors; `scatter_dof` are those of [`Self::scatter_dof`].
    ///
    /// k u with Student's t at the Welch–Satterthwaite degrees of freedom of all parts of the budget; N or N m.
    ///
    /// # Source
    ///
    /// JCGM 100:2008 (GUM), G.4.1.
    #[must_use]
    pub fn arms(&self, row: &[f64], scatter_dof: f64) -> [f64; 2] {
        // A law of one coefficient has the interval of that, with looks and errors to one side.
        if let ([slope], Some(Some(combined))) = (row, self.combined.first()) {
            let [below, above] = combined.arms.map(|arm| arm * slope.abs());
            return if *slope < 0.0 { [above, below] } else { [below, above] };
        }
        let standard = self.prediction_std(row);
        let touched = |part: &Part| {
            let of = row.iter().zip(&part.dof).filter(|(x, _)| **x != 0.0).map(|(_, dof)| *dof);
            of.fold(f64::INFINITY, f64::min)
        };
        let entries = self.budget.iter().enumerate().filter(|(_, part)| !part.in_scatter).map(|(k, part)| {
            let dof = if k == 0 { scatter_dof } else { touched(part) };
            ((spread(&part.covariance, row).powi(2), dof), part.kind)
        });
        let half = coverage_factor(rounded_dof(entries)) * standard;
        [half, half]
    }

    /// Degrees of freedom of the scatter of a load: the fewest among the coefficients that its rows of regressors touch.
    #[must_use]
    pub fn scatter_dof(&self, slopes: &Mat<f64>, rows: std::ops::Range<usize>) -> f64 {
        let touches = |j: usize| rows.clone().any(|row| slopes[(row, j)] != 0.0);
        (0..slopes.ncols()).filter(|&j| touches(j)).map(|j| self.budget[0].dof[j]).fold(f64::INFINITY, f64::min)
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
        spread(&self.covariance, row)
    }
}

/// Whether some observations of a problem weigh more than others.
pub(crate) fn is_uneven(problem: &fit::Problem) -> bool {
    let weighs = |w: &Vec<f64>| w.iter().filter(|w| **w > 0.0).any(|w| (w - 1.0).abs() > 1e-12);
    problem.weight.as_ref().is_some_and(weighs)
}

/// √(xᵀCx) of the coefficients that x belongs to.
fn spread(covariance: &Mat<f64>, x: &[f64]) -> f64 {
    let of = |(a, p): (usize, &f64)| x.iter().enumerate().map(|(b, q)| p * q * covariance[(a, b)]).sum::<f64>();
    x.iter().enumerate().map(of).sum::<f64>().max(0.0).sqrt()
}
