//! Lack of fit against the scatter of repeats.

use std::collections::BTreeMap;

use super::ComponentScore;
use crate::distribution::f_upper;
use crate::error::FitError;
use crate::outcome::Fit;
use crate::problem::{Problem, size};

/// Residuals of a model against the scatter of repeated settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LackOfFit {
    /// Degrees of freedom of lack of fit and of pure error.
    pub dof: [f64; 2],
    /// Sum of squares of lack of fit over its degrees of freedom, over pure variance.
    pub f: f64,
    /// Probability of an F this large when the model is right.
    pub p: f64,
}

/// Compares the residuals of a fit with the scatter of repeats, per component.
///
/// `settings` has an entry per row; rows of one component with equal entry
/// are repeats of one setting. Rows of one setting must have equal designs:
/// their scatter is then no model's fault.
///
/// # Errors
///
/// [`FitError::Refused`] when `settings` has not an entry per row of the problem.
///
/// # Source
///
/// Draper & Smith (1998), *Applied Regression Analysis*, 2.1.
pub fn lack_of_fit(
    problem: &Problem,
    fit: &Fit,
    settings: &[usize],
) -> Result<Vec<ComponentScore<LackOfFit>>, FitError> {
    let n = problem.n_rows();
    size("settings", settings.len(), n, "one per row of the design")?;
    size("residuals", fit.residuals.len(), n, "one per row of the design")?;
    Ok(fit
        .components
        .iter()
        .enumerate()
        .map(|(c, component)| {
            let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
            for i in problem.rows_of(c) {
                groups.entry(settings[i]).or_default().push(i);
            }
            let pure: f64 = groups.values().map(|rows| scatter(problem, rows)).sum();
            let pure_dof = (component.n - groups.len()) as f64;
            let lack_dof = component.dof - pure_dof;
            let not = |reason: &str| Err(reason.to_owned());
            let score = if pure_dof < 0.5 {
                not("no setting was repeated")
            } else if lack_dof < 0.5 {
                not("the model has as many coefficients as there are settings")
            } else if pure == 0.0 {
                not("the repeats are identical: copies, or resolution too coarse")
            } else {
                let f = ((component.rss - pure).max(0.0) / lack_dof) / (pure / pure_dof);
                Ok(LackOfFit { dof: [lack_dof, pure_dof], f, p: f_upper(f, lack_dof, pure_dof) })
            };
            ComponentScore { component: component.name.clone(), score }
        })
        .collect())
}

/// Weighted sum of squares about the weighted mean.
fn scatter(problem: &Problem, rows: &[usize]) -> f64 {
    let total: f64 = rows.iter().map(|&i| problem.weight_of(i)).sum();
    let mean = rows.iter().map(|&i| problem.weight_of(i) * problem.response[i]).sum::<f64>() / total;
    rows.iter().map(|&i| problem.weight_of(i) * (problem.response[i] - mean).powi(2)).sum()
}
