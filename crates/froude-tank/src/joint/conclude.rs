//! Uncertainty of a joint fit: scatter of runs or cycles, and what is declared.
//!
//! **Scatter.** Noise of a load cell on a rod is correlated over tenths of a second. The covariance is that of clusters, the runs left out in turn
//! (CR3), or the cycles where there are fewer than five runs: whatever the correlation within one, it counts. Few runs of unequal weight make CR3 too large in the
//! mean, and of fewer degrees of freedom than there are runs: it is divided by its mean at equal errors, and has their degrees of freedom (`froude_fit::jackknife`).
//!
//! **Declared errors.** Constants of the equation and gains of angle and load move all rows together: S·J·e with J = ∂f/∂q by differences. A prior's
//! error moves the coefficients as a shift of its value does.
//!
//! # Source
//!
//! Bell & McCaffrey (2002) and MacKinnon, Nielsen & Webb (2023) (CR3); JCGM 100:2008 (GUM), 5.1 and G.4.

use froude_fit::budget::{Kind, OUTSIDE_95, Part, Shape, combine};
use froude_fit::faer::Mat;
use froude_fit::jackknife::{AtEqualErrors, at_equal_errors};
use froude_fit::{self as ls, Status};

use super::solve::{Solved, values};
use super::{DeclaredError, Equation, JointFit, Problem, Unknown};

impl<E: Equation> Problem<'_, E> {
    /// Fits all runs together.
    pub(crate) fn fit(&self) -> Result<JointFit, E::Error> {
        let Solved { beta, by_run, effective } = self.solve()?;
        let condensed = self.condense(&beta, by_run, true)?;
        let fit = self.least_squares(&condensed, effective, false, &beta, None).map_err(|e| self.refused(e))?;
        let p = self.names.len();
        let mut errors = Vec::new();
        for (k, (name, prior)) in self.known().into_iter().enumerate() {
            let moved =
                self.least_squares(&condensed, effective, false, &beta, Some(k)).map_err(|e| self.refused(e))?;
            let (there, here) = (unbounded(&moved), unbounded(&fit));
            let sensitivity = (0..p).map(|j| (there[j] - here[j]) / prior.standard).collect();
            errors.push(DeclaredError { name, standard: prior.standard, dof: f64::INFINITY, sensitivity });
        }
        let of_priors = errors.len();
        for (input, column) in self.inputs.iter().zip(&condensed.errors) {
            let standard = input.declared.standard;
            let moved = |j: usize| column.iter().enumerate().map(|(i, e)| fit.sensitivity[(j, i)] * e).sum::<f64>();
            let sensitivity = (0..p).map(|j| moved(j) / standard).collect();
            errors.push(DeclaredError { name: input.name.clone(), standard, dof: input.declared.dof, sensitivity });
        }
        let declared: Vec<Part> = errors.iter().map(part_of).collect();
        // The regression takes priors at their stated variance; here they are lines of their own.
        let of_prior =
            |i: usize, j: usize| declared[..of_priors].iter().map(|part| part.covariance[(i, j)]).sum::<f64>();
        let clusters = if by_run { self.runs.len() } else { self.cycles() };
        let by = if by_run { "run" } else { "cycle" };
        let at_equal = self.at_equal_errors(&condensed.problem, &fit);
        let ratio = |j: usize| at_equal[j].ratio.sqrt();
        let scatter = Mat::from_fn(p, p, |i, j| {
            let left = fit.covariance[(i, j)] - of_prior(i, j);
            if i == j { left.max(0.0) / at_equal[j].ratio } else { left / (ratio(i) * ratio(j)) }
        });
        let dof = at_equal.iter().map(|a| a.dof).collect();
        let first = Part { shared: by, dof, ..part(&format!("scatter from {by} to {by}"), Kind::A, scatter, 0.0) };
        let parts: Vec<Part> = std::iter::once(first).chain(declared).collect();
        let unknowns = (self.names.iter().zip(&fit.coefficients).enumerate())
            .map(|(j, ((name, unit), c))| Unknown {
                name: name.clone(),
                unit: unit.clone(),
                value: c.value,
                status: c.status,
                combined: c.standard.map(|_| combine(&parts, j, OUTSIDE_95)),
            })
            .collect();
        let fitted = self.fitted(&values(&fit))?;
        let squares: f64 = fitted.iter().map(|f| f.used as f64 * f.residual_rms.powi(2)).sum();
        let samples = self.samples();
        Ok(JointFit {
            law: self.law.clone(),
            unknowns,
            parts,
            errors,
            fitted,
            by,
            clusters,
            samples,
            effective,
            sigma: (squares / samples as f64).sqrt(),
            delay_s: self.delay_s(&values(&fit)),
        })
    }

    /// CR3 of the fit at equal errors; what it leaves undetermined, or holds, has that of equal clusters.
    fn at_equal_errors(&self, problem: &ls::Problem, fit: &ls::Fit) -> Vec<AtEqualErrors> {
        let all = problem.n_coefficients();
        let priors = self.known();
        let is_free =
            |j: &usize| !matches!(fit.coefficients[*j].status, Status::Fixed | Status::Excluded | Status::Undetermined);
        let free: Vec<usize> = (0..all).filter(is_free).collect();
        let of = problem.cluster.as_deref().unwrap_or_default();
        let grams: Vec<Mat<f64>> = (of.chunk_by(|a, b| a == b))
            .scan(0, |from, rows| {
                *from += rows.len();
                Some(problem.design.subrows(*from - rows.len(), rows.len()))
            })
            .map(|x| {
                Mat::from_fn(free.len(), free.len(), |a, b| {
                    (0..x.nrows()).map(|i| x[(i, free[a])] * x[(i, free[b])]).sum()
                })
            })
            .collect();
        let variance = fit.components.first().and_then(|c| c.sigma).unwrap_or(0.0).powi(2);
        let prior =
            |j: &usize| priors.iter().filter(|(_, p)| p.index == *j).map(|(_, p)| variance / p.standard.powi(2)).sum();
        let found = at_equal_errors(&grams, &free.iter().map(prior).collect::<Vec<f64>>());
        let equal = AtEqualErrors { ratio: 1.0, dof: grams.len() as f64 - 1.0 };
        let place = |j: usize| free.iter().position(|k| *k == j);
        (0..self.names.len()).map(|j| found.as_ref().zip(place(j)).map_or(equal, |(found, i)| found[i])).collect()
    }
}

/// A line of the budget that all coefficients share.
pub(crate) fn part(name: &str, kind: Kind, covariance: Mat<f64>, dof: f64) -> Part {
    let p = covariance.nrows();
    Part {
        name: name.to_owned(),
        shared: "campaign",
        kind,
        covariance,
        dof: vec![dof; p],
        shape: Shape::Normal,
        in_scatter: false,
        origin: None,
    }
}

fn part_of(error: &DeclaredError) -> Part {
    let p = error.sensitivity.len();
    let moves = |j: usize| error.sensitivity[j] * error.standard;
    part(&error.name, Kind::B, Mat::from_fn(p, p, |i, j| moves(i) * moves(j)), error.dof)
}

/// Coefficients without bounds.
fn unbounded(fit: &ls::Fit) -> Vec<f64> {
    fit.coefficients.iter().map(|c| c.unconstrained.unwrap_or(0.0)).collect()
}
