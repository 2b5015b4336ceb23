//! F tests of a model within a more general one.

use super::{ComponentScore, Score};
use crate::distribution::f_upper;
use crate::error::FitError;
use crate::linear::fit;
use crate::options::{Constraint, CovarianceKind, Loss, Options};
use crate::problem::Problem;

/// An F test of linear restrictions on one component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NestedTest {
    /// `((RSS_restricted − RSS)/q) / (RSS/dof)`.
    pub f: f64,
    /// `q` restrictions, and the degrees of freedom of the general model.
    pub dof: [f64; 2],
    /// Probability of an F this large when the restrictions are true.
    pub p: f64,
}

/// Tests whether `restrictions` may be imposed on a model, per component.
///
/// Both fits are least squares with the equalities, priors and held
/// coefficients of `options`, without its bounds and inequalities: on bounds F
/// has not its distribution. A component that the restrictions do not touch is
/// not scorable.
///
/// # Errors
///
/// As [`fit`].
pub fn nested_tests(
    problem: &Problem,
    options: &Options,
    restrictions: &[Constraint],
) -> Result<Vec<ComponentScore<NestedTest>>, FitError> {
    let general = Options { loss: Loss::Squares, covariance: CovarianceKind::Classical, ..options.unconstrained() };
    let mut restricted = general.clone();
    restricted.equalities.extend_from_slice(restrictions);
    let full = fit(problem, &general)?;
    let small = fit(problem, &restricted)?;
    Ok(full
        .components
        .iter()
        .zip(&small.components)
        .map(|(full, small)| {
            let q = small.dof - full.dof;
            let score = if (q - q.round()).abs() > 1e-6 {
                not_scorable("a prior or another component shares its coefficients")
            } else if q < 0.5 {
                not_scorable("the restrictions do not touch this component")
            } else if full.dof < 0.5 {
                not_scorable("the general model leaves no degrees of freedom")
            } else if full.rss == 0.0 && small.rss == 0.0 {
                not_scorable("both models fit without error")
            } else {
                let q = q.round();
                let f = ((small.rss - full.rss).max(0.0) / q) / (full.rss / full.dof);
                Score::Scored(NestedTest { f, dof: [q, full.dof], p: f_upper(f, q, full.dof) })
            };
            ComponentScore { component: full.name.clone(), score }
        })
        .collect())
}

fn not_scorable(reason: &str) -> Score<NestedTest> {
    Score::NotScorable { reason: reason.to_owned() }
}
