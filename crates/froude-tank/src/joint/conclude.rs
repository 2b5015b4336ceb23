//! Uncertainty of a joint fit: scatter of runs or cycles, and what is declared.
//!
//! **Scatter.** Noise of a load cell on a rod is correlated over tenths of a second. The covariance is that of clusters, the runs left out in turn
//! (CR3), or the cycles where there are fewer than five runs: whatever the correlation within one, it counts. Few runs of unequal weight make CR3 too large in the
//! mean, and of fewer degrees of freedom than there are runs: it is divided by its mean at equal errors, and has their degrees of freedom (`froude_fit::jackknife`).
//!
//! **Declared errors.** Constants of the equation and gains of angle and load move all rows together: S·J·e with J = ∂f/∂q by differences. A prior's
//! error moves the coefficients as a shift of its value does.
//!
//! **Between runs.** Three or four runs are too few to be clusters, so their cycles are used; the run-to-run variation of the drag is then a separate variance
//! (`crate::between_runs`).
//!
//! # Source
//!
//! Bell & McCaffrey (2002) and MacKinnon, Nielsen & Webb (2023) (CR3); JCGM 100:2008 (GUM), 5.1 and G.4.

use froude_fit::budget::{Kind, OUTSIDE_95, Part, combine};
use froude_fit::faer::Mat;
use froude_fit::jackknife::{AtEqualErrors, at_equal_errors};
use froude_fit::propagate::effective_dof;
use froude_fit::{self as ls, Status};

use super::solve::{Solved, values};
use super::{DeclaredError, Equation, JointFit, Known, Problem, Unknown, part};
use crate::between_runs::{BetweenRuns, between_runs};
use crate::error::TankError;
use crate::inverted::inverted;

impl<E: Equation> Problem<'_, E> {
    /// Fits all runs together.
    pub(crate) fn fit(&self) -> Result<JointFit, TankError> {
        let Solved { beta, by_run, effective, weights } = self.solve()?;
        let condensed = self.condense(&beta, &weights, by_run, true)?;
        let fit = self.least_squares(&condensed, effective, false, &beta, None).map_err(|e| self.refused(e))?;
        let p = self.names.len();
        let mut errors = Vec::new();
        let known = self.known();
        for (k, Known { name, prior, dof, .. }) in known.iter().enumerate() {
            let moved =
                self.least_squares(&condensed, effective, false, &beta, Some(k)).map_err(|e| self.refused(e))?;
            let (there, here) = (unbounded(&moved), unbounded(&fit));
            let sensitivity = (0..p).map(|j| (there[j] - here[j]) / prior.standard).collect();
            errors.push(DeclaredError {
                name: name.clone(),
                standard: prior.standard,
                dof: *dof,
                value: None,
                sensitivity,
            });
        }
        let of_priors = errors.len();
        for (k, (input, column)) in self.inputs.iter().zip(&condensed.errors).enumerate() {
            let standard = input.declared.standard;
            let moved = |j: usize| column.iter().enumerate().map(|(i, e)| fit.sensitivity()[(j, i)] * e).sum::<f64>();
            // A value from still runs depends on this input, too.
            let by_prior = |j: usize| {
                let each = known.iter().zip(&errors[..of_priors]);
                let of = |(known, error): (&Known, &DeclaredError)| known.sensitivity_to(k) * error.sensitivity[j];
                each.map(of).sum::<f64>()
            };
            let sensitivity = (0..p).map(|j| moved(j) / standard + by_prior(j)).collect();
            let dof = input.declared.dof;
            errors.push(DeclaredError { name: input.name.clone(), standard, dof, value: None, sensitivity });
        }
        let declared: Vec<Part> = errors.iter().map(DeclaredError::part).collect();
        // The regression takes priors at their stated variance; here they are lines of their own.
        let of_prior =
            |i: usize, j: usize| declared[..of_priors].iter().map(|part| part.covariance[(i, j)]).sum::<f64>();
        let clusters = if by_run { self.runs.len() } else { self.cycles() };
        let by = if by_run { "run" } else { "cycle" };
        let told = self.at_equal_errors(&condensed.problem, &fit);
        let is_scaled = told.is_some();
        let equal = AtEqualErrors { ratio: 1.0, dof: clusters as f64 - 1.0 };
        let at_equal = told.unwrap_or_else(|| vec![equal; p]);
        let scatter = Mat::from_fn(p, p, |i, j| {
            let left = fit.covariance[(i, j)] - of_prior(i, j);
            let both = (at_equal[i].ratio * at_equal[j].ratio).sqrt();
            if i == j { left.max(0.0) / both } else { left / both }
        });
        let dof = at_equal.iter().map(|a| a.dof).collect();
        let first = Part { shared: by, dof, ..part(&format!("scatter from {by} to {by}"), Kind::A, scatter, 0.0) };
        let groups = if by_run { &[][..] } else { self.varying.as_slice() };
        let between: Vec<Option<Part>> =
            groups.iter().map(|group| self.between_runs(&condensed.problem, &fit, group)).collect();
        let has_runs = by_run || (!between.is_empty() && between.iter().all(Option::is_some));
        let first = between.iter().flatten().fold(first, |all, between| together(&all, between));
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
        Ok(JointFit {
            law: self.law.clone(),
            unknowns,
            parts,
            errors,
            sigma: self.sigma(&fitted),
            fitted,
            by,
            has_runs,
            clusters,
            is_scaled,
            samples: self.samples(),
            effective,
            delay_s: self.delay_s(&values(&fit)),
        })
    }

    /// What the load of some unknowns changes by from run to run, where their cycles are the clusters; `None` of too few runs.
    fn between_runs(&self, problem: &ls::Problem, fit: &ls::Fit, varying: &[usize]) -> Option<Part> {
        let of_cycle: Vec<usize> =
            self.runs.iter().enumerate().flat_map(|(r, run)| vec![r; run.motion.cycles.len()]).collect();
        let of_row: Vec<usize> = problem.cluster.as_deref()?.iter().map(|cycle| of_cycle[*cycle]).collect();
        let (beta, n) = (unbounded(fit), problem.n_rows());
        let sum =
            |i: usize, columns: &[usize]| -> f64 { columns.iter().map(|&j| problem.design[(i, j)] * beta[j]).sum() };
        let all: Vec<usize> = (0..beta.len()).collect();
        let part_of_run =
            |r: usize| -> Vec<f64> { (0..n).map(|i| if of_row[i] == r { sum(i, varying) } else { 0.0 }).collect() };
        let parts: Vec<Vec<f64>> =
            (0..self.runs.len()).map(part_of_run).filter(|c| c.iter().any(|x| *x != 0.0)).collect();
        let left: Vec<f64> = (0..n).map(|i| problem.response[i] - sum(i, &all)).collect();
        // Held coefficients explain no part of a load, and priors pull towards zero.
        let held = self.held().into_iter().map(|(j, _)| j);
        let about_zero = |known: Known| ls::Prior { value: 0.0, ..known.prior };
        let options = ls::Options {
            excluded: self.excluded().into_iter().chain(held).collect(),
            priors: self.known().into_iter().map(about_zero).collect(),
            ..ls::Options::default()
        };
        let left_of = |y: &[f64]| {
            let of = ls::Problem { response: y.to_vec(), ..problem.clone() };
            Some(ls::fit(&of, &options).ok()?.residuals)
        };
        let BetweenRuns { variance, dof } = between_runs(&parts, &left, left_of)?;
        let p = self.names.len();
        let moved = |c: &Vec<f64>, j: usize| (0..n).map(|i| fit.sensitivity()[(j, i)] * c[i]).sum::<f64>();
        let moves: Vec<Vec<f64>> = parts.iter().map(|c| (0..p).map(|j| moved(c, j)).collect()).collect();
        let covariance = Mat::from_fn(p, p, |i, j| variance * moves.iter().map(|m| m[i] * m[j]).sum::<f64>());
        Some(part(" and of the drag from run to run", Kind::A, covariance, dof))
    }

    /// CR3 of the fit at equal errors; `None` where that cannot be told.
    fn at_equal_errors(&self, problem: &ls::Problem, fit: &ls::Fit) -> Option<Vec<AtEqualErrors>> {
        let is = |j: usize, statuses: &[Status]| statuses.contains(&fit.coefficients[j].status);
        let all = 0..problem.n_coefficients();
        let is_held = |j: &usize| is(*j, &[Status::Fixed, Status::Excluded]);
        let (mut free, undetermined): (Vec<usize>, Vec<usize>) =
            all.filter(|j| !is_held(j)).partition(|j| !is(*j, &[Status::Undetermined]));
        let named = free.iter().filter(|j| **j < self.names.len()).count();
        // What is not determined still takes its part of the data: as many of its columns as are independent.
        for j in undetermined {
            let tried: Vec<usize> = free.iter().copied().chain([j]).collect();
            if inverted(&gram(&problem.design, 0..problem.design.nrows(), &tried)).is_some() {
                free = tried;
            }
        }
        let of = problem.cluster.as_deref()?;
        let mut from = 0;
        let mut grams = Vec::new();
        for rows in of.chunk_by(|a, b| a == b) {
            grams.push(gram(&problem.design, from..from + rows.len(), &free));
            from += rows.len();
        }
        let variance = fit.components.first()?.sigma?.powi(2);
        let priors = self.known();
        let of = |j: usize| priors.iter().map(|known| &known.prior).filter(move |prior| prior.index == j);
        let prior = |j: &usize| of(*j).map(|prior| variance / prior.standard.powi(2)).sum();
        let found = at_equal_errors(&grams, &free.iter().map(prior).collect::<Vec<f64>>(), named)?;
        // What is held has no scatter, what is not determined no interval.
        let none = AtEqualErrors { ratio: 1.0, dof: f64::INFINITY };
        let of = |j: usize| free[..named].iter().position(|k| *k == j).map_or(none, |i| found[i]);
        Some((0..self.names.len()).map(of).collect())
    }
}

/// Two scatters that are independent, as one.
fn together(first: &Part, other: &Part) -> Part {
    let variances = |j: usize| [(first, j), (other, j)].map(|(part, j)| (part.covariance[(j, j)], part.dof[j]));
    let p = first.dof.len();
    Part {
        name: if first.name.ends_with(&other.name) {
            first.name.clone()
        } else {
            format!("{}{}", first.name, other.name)
        },
        covariance: &first.covariance + &other.covariance,
        dof: (0..p).map(|j| effective_dof(&variances(j))).collect(),
        ..first.clone()
    }
}

/// XᵀX of some rows and columns.
fn gram(design: &Mat<f64>, rows: std::ops::Range<usize>, columns: &[usize]) -> Mat<f64> {
    let product = |a: usize, b: usize| rows.clone().map(|i| design[(i, columns[a])] * design[(i, columns[b])]).sum();
    Mat::from_fn(columns.len(), columns.len(), product)
}

/// Coefficients without bounds.
fn unbounded(fit: &ls::Fit) -> Vec<f64> {
    fit.coefficients.iter().map(|c| c.unconstrained.unwrap_or(0.0)).collect()
}
