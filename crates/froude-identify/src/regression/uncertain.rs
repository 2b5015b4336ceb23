//! The combined uncertainty of a fitted law: scatter and budget.

use faer::Mat;
use froude_fit as fit;
use froude_fit::budget::{Combined, OUTSIDE_95, Part, combine};
use froude_fit::replicates;
use froude_records::campaign::SourceKind;

use crate::dataset::{Dataset, GroupedBy, labels};
use crate::eiv;
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::regression::known;
use crate::regression::problem::step;
use crate::regression::runs::between_runs;
use crate::regression::settings::{Scatter, Settings};
use crate::uncertainty::{Linearised, contributions, scatter};

/// Type A and type B of all coefficients of a fit.
pub(crate) struct Uncertainty {
    /// The scatter, the declared entries, the shared errors.
    pub(crate) budget: Vec<Part>,
    /// Combined uncertainty of each coefficient that has one.
    pub(crate) combined: Vec<Option<Combined>>,
    /// Combined covariance, p × p.
    pub(crate) covariance: Mat<f64>,
    /// Where the scatter comes from, in words.
    pub(crate) kind: String,
}

fn is_fixed(c: &fit::FitCoefficient) -> bool {
    c.status == fit::Status::Fixed
}

impl Uncertainty {
    /// `is_whitened`: rows that share declared errors were fitted together. `in_variables`: row errors of speed and angle are in the regression's covariance already, also where there is no scatter.
    pub(crate) fn of(
        law: &ForceLaw,
        data: &Dataset,
        settings: Settings<'_>,
        (problem, fitted): (&fit::Problem, &fit::Fit),
        [in_variables, is_whitened]: [bool; 2],
    ) -> Result<Self, IdentifyError> {
        let p = fitted.coefficients.len();
        let coefficients = step(fitted);
        let at = Linearised::about(law, data, &coefficients, fitted);
        let is_measured = settings.kind != SourceKind::Cfd;
        let mut declared = contributions(at, settings.budget, settings.campaign, settings.shared_errors, is_measured)?;
        if in_variables {
            for (part, entry) in declared.iter_mut().zip(settings.budget) {
                part.in_scatter |= eiv::is_input_error(entry, law, data);
            }
        }
        let known = known::parts(law, settings, problem, fitted);
        let is_known_elsewhere =
            |j: usize| known.iter().any(|part| part.covariance[(j, j)] > 0.0) && is_fixed(&fitted.coefficients[j]);
        let replicates = match settings.scatter {
            Scatter::Replicates { name, sets } => {
                Some(replicates::together(name, sets).filter(|part| part.dof.len() == p))
            }
            Scatter::Serial(errors) => Some(serial(data, problem, fitted, errors)),
            // Declared errors of the runs are already weights of the fit.
            Scatter::Runs if !in_variables && !is_whitened => {
                between_runs(law, data, problem, fitted).map(|runs| Some(runs.part))
            }
            Scatter::Runs | Scatter::Classical | Scatter::Hc3 | Scatter::Cluster => None,
        };
        // Where replicates, or rows in time, tell no scatter nothing does: the residuals as if they were independent are not asked.
        let is_known = |c: &fit::FitCoefficient| match &replicates {
            Some(part) => part.is_some() && c.value.is_some(),
            None => c.standard.is_some(),
        };
        let first = replicates.clone().flatten().unwrap_or_else(|| scatter(fitted));
        let budget: Vec<Part> = std::iter::once(first).chain(declared).chain(known.iter().cloned()).collect();
        let outside = OUTSIDE_95 / settings.looks.max(1) as f64;
        let combined: Vec<Option<Combined>> = fitted
            .coefficients
            .iter()
            .enumerate()
            .map(|(j, c)| (is_known(c) || is_known_elsewhere(j)).then(|| combine(&budget, j, outside)))
            .collect();
        let kind = match replicates {
            Some(_) => budget[0].name.clone(),
            None if in_variables => "model-based, errors in variables".to_owned(),
            None if is_whitened => {
                "of generalised least squares: declared errors of runs and setups weigh the rows".to_owned()
            }
            None => residuals_in_words(data, settings),
        };
        Ok(Self { covariance: covariance(&budget, &combined), budget, combined, kind })
    }

    /// How far each interval reaches.
    pub(crate) fn arms(&self) -> impl Iterator<Item = f64> {
        self.combined.iter().flatten().flat_map(|combined| combined.arms)
    }

    pub(crate) fn variances(&self) -> impl Iterator<Item = f64> {
        (0..self.combined.len()).map(|j| self.covariance[(j, j)])
    }
}

/// Rows that a run has on average, below which runs are no series.
const FEWEST_IN_RUN: usize = 4;

/// The scatter of rows that are correlated in time within each run, load by load; `None` if there are too few rows, or if loads share a coefficient.
pub(crate) fn serial(
    data: &Dataset,
    problem: &fit::Problem,
    fitted: &fit::Fit,
    errors: &fit::serial::RowErrors,
) -> Option<Part> {
    let at = step(fitted);
    let (x, p, n) = (&problem.design, fitted.coefficients.len(), data.rows);
    let left = |i: usize| problem.response[i] - (0..p).map(|j| x[(i, j)] * at[j]).sum::<f64>();
    // Runs of a row or two have no neighbours: the table is one series then.
    let of_runs = labels(&data.run);
    let runs = 1 + of_runs.iter().max().copied().unwrap_or(0);
    let run = if n < FEWEST_IN_RUN * runs { vec![0; n] } else { of_runs };
    let root = |i: usize| problem.weight.as_ref().map_or(1.0, |w| w[i]).sqrt();
    let (mut covariance, mut dof) = (Mat::zeros(p, p), vec![f64::INFINITY; p]);
    let (mut correlations, mut is_largest) = (Vec::new(), false);
    for (r, load) in problem.components.iter().enumerate() {
        let rows = problem.rows_of(r);
        let of_load: Vec<usize> = (0..p).filter(|&j| rows.iter().any(|&i| x[(i, j)] != 0.0)).collect();
        // The correlation between loads is unknown, so a shared coefficient gets no interval.
        let is_shared = |j: &usize| (0..x.nrows()).any(|i| problem.component[i] != r && x[(i, *j)] != 0.0);
        if of_load.iter().any(is_shared) {
            return None;
        }
        let design = Mat::from_fn(rows.len(), of_load.len(), |i, k| root(rows[i]) * x[(rows[i], of_load[k])]);
        let of_row = |k: usize, i: usize| fitted.sensitivity()[(of_load[k], rows[i])] / root(rows[i]);
        let sensitivity = Mat::from_fn(of_load.len(), rows.len(), of_row);
        let residual: Vec<f64> = rows.iter().map(|&i| root(i) * left(i)).collect();
        let of_rows: Vec<usize> = rows.iter().map(|i| run[i % n]).collect();
        let found = fit::serial::serial(&design, sensitivity.as_ref(), &residual, &of_rows, errors)?;
        for (a, &j) in of_load.iter().enumerate() {
            dof[j] = found.dof[a];
            for (b, &k) in of_load.iter().enumerate() {
                covariance[(j, k)] = found.covariance[(a, b)];
            }
        }
        let by = format!("{:.2}", found.correlation);
        correlations.push(if problem.components.len() > 1 { format!("{by} ({load})") } else { by });
        is_largest |= found.is_largest;
    }
    let name = format!(
        "scatter of the rows in time, correlated by {} from one to the next{}",
        correlations.join(", "),
        if is_largest { ", the most that runs of this length tell: it may be more" } else { "" }
    );
    Some(Part::scatter(name, "sample", covariance, dof))
}

/// The sum of the budget's parts. A coefficient that was not estimated has no covariance, whatever the budget says.
fn covariance(budget: &[Part], combined: &[Option<Combined>]) -> Mat<f64> {
    let p = combined.len();
    let mut sum = Mat::zeros(p, p);
    for part in budget.iter().filter(|part| !part.in_scatter) {
        sum += &part.covariance;
    }
    for j in (0..p).filter(|j| combined[*j].is_none()) {
        for k in 0..p {
            sum[(j, k)] = 0.0;
            sum[(k, j)] = 0.0;
        }
    }
    sum
}

/// What the record calls the covariance of residuals.
fn residuals_in_words(data: &Dataset, settings: Settings<'_>) -> String {
    let clusters = || data.clusters();
    let kind = match settings.scatter.of_residuals() {
        fit::CovarianceKind::Classical => "classical".to_owned(),
        fit::CovarianceKind::Hc3 => "HC3".to_owned(),
        // Without a word of the campaign the groups of a computation are its configurations.
        fit::CovarianceKind::Cr3 => match data.grouped_by {
            GroupedBy::Column if settings.identify.covariance.is_none() => {
                format!("CR3 by {} configurations", clusters())
            }
            GroupedBy::Column => format!("CR3, {} clusters", clusters()),
            by => format!("CR3 by {} {}", clusters(), by.words()),
        },
    };
    if settings.kind == SourceKind::Cfd { format!("{kind}; residuals are model error, not noise") } else { kind }
}
