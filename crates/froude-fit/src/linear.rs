//! The linear fit: from a problem to coefficients with their uncertainty.
//!
//! 1. Check, then split into blocks that share no coefficient (`block`).
//! 2. Per block: estimate by pivoted QR, σ of each component (`estimate`);
//!    covariance (`covariance`); what is determined (`determined`);
//!    the estimate under bounds and inequalities (`shape`).
//! 3. Put the blocks together.
//!
//! The value of a coefficient is that of the constrained fit; its standard
//! uncertainty, its interval, σ and the sensitivity are those of the fit without
//! bounds and inequalities, whose intervals cover as often as they say. The
//! interval is then cut by the bounds.

use faer::Mat;

use crate::block::{Block, blocks};
use crate::covariance::{Core, core};
use crate::dense::{dot, mul, mul_vec, row};
use crate::determined::Indeterminacy;
use crate::diagnostics::{condition_number, durbin_watson};
use crate::distribution::coverage_factor;
use crate::error::FitError;
use crate::estimate::{Estimate, estimate};
use crate::options::Options;
use crate::outcome::{Combination, ComponentSummary, Fit, FitCoefficient, Optimality, Status};
use crate::problem::Problem;
use crate::report::{End, Report};
use crate::shape::{Shaped, shape};

/// Residuals below this part of the response are rounding.
const ROUNDING: f64 = 1e-12;

/// Fits a linear model.
///
/// # Errors
///
/// [`FitError`] when the problem or an option is not usable, when constraints
/// contradict each other, or when the covariance asked for cannot be given.
/// Coefficients that the data do not determine are no error: they come back as
/// [`Status::Undetermined`] without a value.
///
/// # Example
///
/// Drag grows with the square of the speed; one coefficient, three points:
///
/// ```
/// use faer::Mat;
/// use froude_fit::{Options, Problem, fit};
///
/// let square_m2_s2 = [1.0, 4.0, 9.0];
/// let design = Mat::from_fn(3, 1, |i, _| square_m2_s2[i]);
/// let drag_n = vec![2.1, 7.9, 18.0];
/// let fit = fit(
///     &Problem::single(design, drag_n, vec!["k".into()]),
///     &Options::default(),
/// )?;
/// let k = fit.coefficients[0].value.unwrap_or(f64::NAN);
/// assert!((k - (2.1 + 4.0 * 7.9 + 9.0 * 18.0) / 98.0).abs() < 1e-14);
/// # Ok::<(), froude_fit::FitError>(())
/// ```
pub fn fit(problem: &Problem, options: &Options) -> Result<Fit, FitError> {
    problem.check()?;
    options.check(problem)?;
    let mut parts = blocks(problem, options)?
        .into_iter()
        .map(|block| Part::new(problem, options, block))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(assemble(problem, options, &mut parts))
}

/// A fitted block.
struct Part {
    block: Block,
    estimate: Estimate,
    core: Core,
    /// From `Qᵀ b` to the block's coefficients in the problem's units, columns × rank.
    lift: Mat<f64>,
    indeterminacy: Indeterminacy,
    shaped: Option<Shaped>,
}

impl Part {
    fn new(problem: &Problem, options: &Options, block: Block) -> Result<Self, FitError> {
        let estimate = estimate(&block);
        let core = core(problem, &block, &estimate, options.covariance)?;
        let mut lift = estimate.qr.lift();
        for l in 0..block.columns.len() {
            for k in 0..lift.ncols() {
                lift[(l, k)] /= block.scale[l];
            }
        }
        let indeterminacy = Indeterminacy::new(estimate.qr.null_space().as_ref());
        let shaped = if block.is_constrained() { Some(shape(&block, &estimate)?) } else { None };
        Ok(Self { block, estimate, core, lift, indeterminacy, shaped })
    }

    /// Estimate without bounds and inequalities, in the problem's units.
    fn unconstrained(&self) -> Vec<f64> {
        self.unscale(&self.estimate.gamma)
    }

    fn unscale(&self, beta: &[f64]) -> Vec<f64> {
        beta.iter().zip(&self.block.scale).map(|(b, s)| b / s).collect()
    }

    /// Estimate under all constraints, in the problem's units.
    fn constrained(&self, options: &Options) -> Vec<f64> {
        let Some(shaped) = &self.shaped else {
            return self.unconstrained();
        };
        let mut beta = self.unscale(&shaped.beta);
        for (l, side) in shaped.at_bound.iter().enumerate() {
            // The bound itself, not the bound scaled there and back.
            let bound = options.bound(self.block.columns[l]);
            match side {
                Some(crate::bounded::Side::Lower) => beta[l] = bound.lower,
                Some(crate::bounded::Side::Upper) => beta[l] = bound.upper,
                None => beta[l] = beta[l].max(bound.lower).min(bound.upper),
            }
        }
        beta
    }

    /// Degrees of freedom of `Σ_l a_l β_l`, where `a` comes as its row of the lift.
    ///
    /// Those of a robust variance, else Welch–Satterthwaite over the components; priors count as exactly known.
    fn dof_of(&self, lifted: &[f64]) -> f64 {
        if let Some(robust) = self.core.freedom.of(lifted) {
            let total = dot(lifted, &mul_vec(self.core.covariance.as_ref(), lifted));
            // A fit without scatter has the degrees of freedom that one would have.
            return robust.dof * if robust.scatter > 0.0 { (total / robust.scatter).powi(2) } else { 1.0 };
        }
        if self.block.components.len() == 1 && self.estimate.n_priors == 0 {
            return self.estimate.dof[0];
        }
        let n_priors = self.estimate.n_priors;
        let q = &self.estimate.qr.q;
        let mut total = 0.0;
        let mut share = vec![0.0; self.block.components.len()];
        for i in 0..q.nrows() {
            let part = dot(lifted, &row(q.as_ref(), i)).powi(2);
            if i < n_priors {
                total += part;
            } else {
                let c = self.block.row_component[i - n_priors];
                let part = part * self.core.dispersion[c].unwrap_or(f64::NAN);
                share[c] += part;
                total += part;
            }
        }
        let sum: f64 = share
            .iter()
            .zip(&self.estimate.dof)
            .filter(|(share, _)| **share > 0.0)
            .map(|(share, dof)| share * share / dof)
            .sum();
        if sum > 0.0 { total * total / sum } else { f64::INFINITY }
    }

    /// Standard uncertainty and degrees of freedom of a combination.
    fn spread(&self, factors: &[(usize, f64)]) -> (Option<f64>, Option<f64>) {
        let mut lifted = vec![0.0; self.lift.ncols()];
        for &(l, factor) in factors {
            for (k, lifted) in lifted.iter_mut().enumerate() {
                *lifted += factor * self.lift[(l, k)];
            }
        }
        let variance = dot(&lifted, &mul_vec(self.core.covariance.as_ref(), &lifted));
        if !variance.is_finite() {
            return (None, None);
        }
        let dof = self.dof_of(&lifted);
        if dof.is_nan() || dof <= 0.0 {
            return (None, None);
        }
        (Some(variance.max(0.0).sqrt()), Some(dof))
    }

    /// `∂β/∂y` of the block in the problem's units, rows × columns.
    fn sensitivity(&mut self, problem: &Problem) -> Mat<f64> {
        // Of many rows it is as large as the design, and nothing else reads it.
        let influence = std::mem::replace(&mut self.core.influence, Mat::zeros(0, 0));
        let mut s = mul(influence.as_ref(), self.lift.transpose());
        drop(influence);
        for (k, &i) in self.block.rows.iter().enumerate() {
            let factor = problem.weight_of(i).sqrt() / self.estimate.whitening[self.block.row_component[k]];
            for l in 0..s.ncols() {
                s[(k, l)] *= factor;
            }
        }
        s
    }
}

fn assemble(problem: &Problem, options: &Options, parts: &mut [Part]) -> Fit {
    let n = problem.n_rows();
    let p = problem.n_coefficients();
    let mut minimiser = vec![0.0; p];
    for &(j, value) in &options.fixed {
        minimiser[j] = value;
    }
    let mut coefficients = held_coefficients(problem, options);
    let mut covariance = Mat::zeros(p, p);
    let mut sensitivity_by_row = Mat::zeros(n, p);
    let mut leverage = vec![0.0; n];
    let mut undetermined = Vec::new();
    let mut null_columns: Vec<Vec<f64>> = Vec::new();
    let mut report = Report { end: End::Converged, iterations: 0 };
    let mut optimality: Option<Optimality> = None;
    for part in parts.iter_mut() {
        let s = part.sensitivity(problem);
        let block = &part.block;
        let value = part.constrained(options);
        for (l, &j) in block.columns.iter().enumerate() {
            minimiser[j] = value[l];
            coefficients[j] = coefficient(problem, options, part, l, value[l]);
        }
        let of_block = mul(mul(part.lift.as_ref(), part.core.covariance.as_ref()).as_ref(), part.lift.transpose());
        let is_known: Vec<bool> = block.columns.iter().map(|&j| coefficients[j].standard.is_some()).collect();
        for (l, &j) in block.columns.iter().enumerate() {
            for (m, &k) in block.columns.iter().enumerate() {
                if is_known[l] && is_known[m] {
                    // The mean of both halves: symmetric to the last bit.
                    covariance[(j, k)] = 0.5 * (of_block[(l, m)] + of_block[(m, l)]);
                }
            }
            if part.indeterminacy.determined[l] {
                for (k, &i) in block.rows.iter().enumerate() {
                    sensitivity_by_row[(i, j)] = s[(k, l)];
                }
            }
        }
        let n_priors = part.estimate.n_priors;
        for (k, &i) in block.rows.iter().enumerate() {
            let q = row(part.estimate.qr.q.as_ref(), n_priors + k);
            leverage[i] = dot(&q, &q);
        }
        undetermined.extend(combinations(part, &value));
        for k in 0..part.indeterminacy.null.ncols() {
            let mut column = vec![0.0; p];
            for (l, &j) in block.columns.iter().enumerate() {
                // Rounding must not tie a determined coefficient to the null space.
                if !part.indeterminacy.determined[l] {
                    column[j] = part.indeterminacy.null[(l, k)] / block.scale[l];
                }
            }
            null_columns.push(column);
        }
        report = report.merge(part.estimate.report);
        if let Some(shaped) = &part.shaped {
            report = report.merge(shaped.report);
            let all = optimality.get_or_insert_with(|| Optimality { kkt: 0.0, active_inequalities: Vec::new() });
            all.kkt = all.kkt.max(shaped.kkt);
            all.active_inequalities.extend(shaped.active_inequalities.iter().map(|&k| block.inequality_index[k]));
        }
    }
    if let Some(all) = &mut optimality {
        all.active_inequalities.sort_unstable();
    }
    let fitted = mul_vec(problem.design.as_ref(), &minimiser);
    let residuals: Vec<f64> = problem.response.iter().zip(&fitted).map(|(y, f)| y - f).collect();
    let components = components(problem, options, parts, &residuals);
    Fit {
        condition_number: overall_condition(parts),
        coefficients,
        largest_correlation: largest_correlation(&covariance),
        covariance,
        components,
        fitted,
        residuals,
        leverage,
        undetermined,
        sensitivity_by_row,
        optimality,
        report,
        minimiser,
        null_columns,
    }
}

fn held_coefficients(problem: &Problem, options: &Options) -> Vec<FitCoefficient> {
    let mut out: Vec<FitCoefficient> =
        problem.names.iter().map(|name| FitCoefficient::unfitted(name, Status::Excluded, Some(0.0))).collect();
    for &(j, value) in &options.fixed {
        out[j].status = Status::Fixed;
        out[j].value = Some(value);
    }
    out
}

fn coefficient(problem: &Problem, options: &Options, part: &Part, l: usize, value: f64) -> FitCoefficient {
    let j = part.block.columns[l];
    let name = &problem.names[j];
    if !part.indeterminacy.determined[l] {
        return FitCoefficient::unfitted(name, Status::Undetermined, None);
    }
    let free = part.estimate.gamma[l] / part.block.scale[l];
    let (standard, dof) = part.spread(&[(l, 1.0)]);
    let bound = options.bound(j);
    let is_at_bound = part.shaped.as_ref().is_some_and(|s| s.at_bound[l].is_some());
    let mut status = if is_at_bound {
        Status::AtBound
    } else if options.priors.iter().any(|prior| prior.index == j) {
        Status::Prior
    } else {
        Status::Free
    };
    let interval = standard.zip(dof).and_then(|(standard, dof)| {
        let half = coverage_factor(options.confidence, dof) * standard;
        let cut = [(free - half).max(bound.lower), (free + half).min(bound.upper)];
        (cut[0] <= cut[1]).then_some(cut)
    });
    if standard.is_some() && interval.is_none() {
        status = Status::BoundContradicted;
    }
    let lifted = row(part.lift.as_ref(), l);
    FitCoefficient {
        name: name.clone(),
        status,
        value: Some(value),
        standard,
        interval,
        dof,
        unconstrained: Some(free),
        most: part.core.freedom.of(&lifted).and_then(|robust| robust.most),
    }
}

fn combinations(part: &Part, value: &[f64]) -> Vec<Combination> {
    part.indeterminacy
        .combinations()
        .iter()
        .map(|terms| {
            let first = terms[0].1 * part.block.scale[terms[0].0];
            let local: Vec<(usize, f64)> =
                terms.iter().map(|&(l, factor)| (l, factor * part.block.scale[l] / first)).collect();
            let (standard, dof) = part.spread(&local);
            Combination {
                value: local.iter().map(|&(l, w)| w * value[l]).sum(),
                weights: local.iter().map(|&(l, w)| (part.block.columns[l], w)).collect(),
                standard,
                dof,
            }
        })
        .collect()
}

fn components(problem: &Problem, options: &Options, parts: &[Part], residuals: &[f64]) -> Vec<ComponentSummary> {
    let mut out: Vec<Option<ComponentSummary>> = vec![None; problem.components.len()];
    for part in parts {
        for (k, &c) in part.block.components.iter().enumerate() {
            out[c] = Some(component(problem, options, part, k, residuals));
        }
    }
    out.into_iter().flatten().collect()
}

fn component(problem: &Problem, options: &Options, part: &Part, k: usize, residuals: &[f64]) -> ComponentSummary {
    let c = part.block.components[k];
    let rows = problem.rows_of(c);
    let weighted: Vec<f64> = rows.iter().map(|&i| problem.weight_of(i).sqrt() * residuals[i]).collect();
    let size: f64 = rows.iter().map(|&i| problem.weight_of(i) * problem.response[i] * problem.response[i]).sum();
    let rss = dot(&weighted, &weighted);
    let is_condensed = !options.observations.is_empty();
    let n = if is_condensed { options.observations[c] } else { rows.len() };
    let dof = part.estimate.dof[k];
    let is_rounding = rss <= ROUNDING * ROUNDING * size;
    let is_single = part.block.components.len() == 1;
    let durbin_watson = if n < 3 || is_rounding || is_condensed { None } else { durbin_watson(&weighted) };
    let aicc = if is_rounding { None } else { crate::select::aicc(n, rss, n as f64 - dof).ok() };
    ComponentSummary {
        name: problem.components[c].clone(),
        n,
        rank: if is_single { part.estimate.qr.rank } else { (n as f64 - dof).round() as usize },
        dof,
        sigma: part.estimate.sigma[k],
        rss,
        relative_residual: match (rss, size) {
            (0.0, _) => 0.0,
            (rss, size) => (rss / size).sqrt(),
        },
        durbin_watson,
        aicc,
    }
}

/// Over all blocks together: they share no coefficient.
fn overall_condition(parts: &[Part]) -> f64 {
    let mut largest = 0.0_f64;
    let mut smallest = f64::INFINITY;
    for part in parts {
        if part.estimate.qr.n_columns() == 0 {
            continue;
        }
        match condition_number(part.block.design.as_ref()) {
            Some((high, low)) => {
                largest = largest.max(high);
                smallest = smallest.min(low);
            }
            None => return f64::INFINITY,
        }
    }
    if smallest.is_infinite() { 1.0 } else { largest / smallest }
}

/// The pair of coefficients with the largest correlation, and that.
fn largest_correlation(covariance: &Mat<f64>) -> Option<(usize, usize, f64)> {
    let p = covariance.nrows();
    let mut largest: Option<(usize, usize, f64)> = None;
    for i in 0..p {
        for j in i + 1..p {
            let size = covariance[(i, i)].sqrt() * covariance[(j, j)].sqrt();
            let r = if size > 0.0 { (covariance[(i, j)] / size).clamp(-1.0, 1.0) } else { 0.0 };
            if r != 0.0 && largest.is_none_or(|(_, _, best)| r.abs() > best.abs()) {
                largest = Some((i, j, r));
            }
        }
    }
    largest
}
