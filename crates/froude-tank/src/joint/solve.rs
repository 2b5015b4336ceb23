//! The joint fit: all runs, all coefficients, in time.
//!
//! Everything but the delay is linear; the delay is linearised about its last value (Gauss and Newton), −∂f/∂t being its column. Each load of a run has a zero
//! of its own. The rows of a cycle are condensed to their triangle as soon as they are made, so that memory does not grow with the log.
//!
//! Against what is declared beforehand (buoyancy, delay, priors) the observations are weighed by their effective number n/τ, τ the integrated
//! autocorrelation time of the residuals.
//!
//! # Source
//!
//! Sokal (1997) (τ).

use std::ops::Range;

use froude_fit as ls;
use froude_fit::autocorrelation::integrated_time;
use froude_fit::faer::Mat;
use froude_fit::stream::{Accumulator, Factor, Shape, StreamError};
use froude_fit::{CovarianceKind, FEWEST_CLUSTERS, FitError};

use super::{Enters, Equation, Fitted, Problem};
use crate::error::TankError;

/// Steps of Gauss and Newton for the delay.
const MOST_STEPS: usize = 30;
/// The delay has converged when a step is below this part of the shortest period.
const SMALL: f64 = 1e-10;
/// Step of time differences, as part of the shortest period: error 1e-8 of the third derivative, rounding 1e-16/1e-4.
const TIME_STEP: f64 = 1e-4;
/// Step of differences by what is declared, as part of it.
const STEP: f64 = 1e-5;

/// Rows of the linear problem for one load, a vector for each column.
pub(crate) struct Columns {
    /// Of the coefficients.
    pub regressors: Vec<Vec<f64>>,
    /// Of the declared errors, load per standard uncertainty.
    pub errors: Vec<Vec<f64>>,
    /// The load, with what is not looked for taken off.
    pub measured: Vec<f64>,
}

/// Condensed rows of all runs, with the columns of the declared errors.
pub(crate) struct Condensed {
    pub problem: ls::Problem,
    pub errors: Vec<Vec<f64>>,
}

/// Where the steps ended.
pub(crate) struct Solved {
    pub beta: Vec<f64>,
    /// Whether runs are left out in turn; cycles otherwise.
    pub by_run: bool,
    /// n/τ.
    pub effective: f64,
    /// By load.
    pub weights: Vec<f64>,
}

impl<E: Equation> Problem<'_, E> {
    pub(crate) fn solve(&self) -> Result<Solved, TankError> {
        let mut beta = self.start.clone();
        let (mut by_run, mut effective) = (self.runs.len() >= FEWEST_CLUSTERS, self.samples() as f64);
        let mut weights = over_first(&self.sizes());
        let period_s = self.period_s();
        // Without coefficients the delay has no column: the first step holds it.
        let mut hold = true;
        for round in 0..2 {
            let mut steps = 0;
            loop {
                let condensed = self.condense(&beta, &weights, by_run, false)?;
                let next = match self.least_squares(&condensed, effective, hold, &beta, None) {
                    Err(FitError::ClusterDecides { .. }) if by_run => {
                        by_run = false;
                        continue;
                    }
                    other => values(&other.map_err(|source| self.refused(source))?),
                };
                let change = self.delay_at().map_or(0.0, |j| (next[j] - beta[j]).abs());
                let is_held = std::mem::replace(&mut hold, false);
                beta = next;
                if let Some(j) = self.delay_at() {
                    let runs_away = || {
                        TankError::new(format!(
                            "the delay of the load does not converge (last value {:.3} s, period {period_s:.2} s): check that motion and load have the same clock and the right signs, or declare the delay",
                            beta[j]
                        ))
                    };
                    if beta[j].abs() > period_s || !beta[j].is_finite() {
                        return Err(runs_away());
                    }
                    if change > SMALL * period_s || is_held {
                        steps += 1;
                        if steps > MOST_STEPS {
                            return Err(runs_away());
                        }
                        continue;
                    }
                }
                break;
            }
            if round == 0 {
                let fitted = self.fitted(&beta)?;
                effective = effective_samples(&fitted);
                weights = over_first(&self.informative(&fitted));
                // Nothing is weighed against the observations: their number decides nothing but the criterion.
                if self.known().is_empty() && self.n_loads() == 1 {
                    break;
                }
            }
        }
        Ok(Solved { beta, by_run, effective, weights })
    }

    pub(super) fn refused(&self, source: FitError) -> TankError {
        TankError::new(format!("the joint fit of {}: {source}", self.law))
    }

    fn not_summed(&self, source: StreamError) -> TankError {
        TankError::new(format!("the joint fit of {} cannot be summed: {source}", self.law))
    }

    /// Coefficients that are held or zero, bounds and priors.
    fn options(&self, effective: f64, held: Option<(usize, f64)>) -> ls::Options {
        let bounds: Vec<ls::Bound> = (0..self.names.len()).map(|j| self.bound(j)).collect();
        let held_delay = held.map(|(j, _)| j);
        let priors = self.known().into_iter().map(|known| known.prior).filter(|p| Some(p.index) != held_delay);
        ls::Options {
            bounds: if bounds.iter().all(|b| *b == ls::Bound::FREE) { Vec::new() } else { bounds },
            priors: priors.collect(),
            fixed: self.held().into_iter().filter(|(j, _)| Some(*j) != held_delay).chain(held).collect(),
            excluded: self.excluded(),
            covariance: CovarianceKind::Cr3,
            observations: vec![(effective.round() as usize).max(1)],
            ..ls::Options::default()
        }
    }

    /// The linear problem at `beta`; `moved` adds its standard uncertainty to the value of a prior.
    pub(super) fn least_squares(
        &self,
        condensed: &Condensed,
        effective: f64,
        hold_delay: bool,
        beta: &[f64],
        moved: Option<usize>,
    ) -> Result<ls::Fit, FitError> {
        let held = self.delay_at().filter(|_| hold_delay).map(|j| (j, beta[j]));
        let mut options = self.options(effective, held);
        let offsets = condensed.problem.n_coefficients() - self.names.len();
        if !options.bounds.is_empty() {
            options.bounds.extend(std::iter::repeat_n(ls::Bound::FREE, offsets));
        }
        if let Some(k) = moved {
            options.priors[k].value += options.priors[k].standard;
        }
        ls::fit(&condensed.problem, &options)
    }

    /// Each load at samples of a run, without its zero.
    fn loads(
        &self,
        run: usize,
        rows: Range<usize>,
        beta: &[f64],
        delay_s: f64,
        moved: Option<(usize, f64)>,
    ) -> Result<Vec<Vec<f64>>, TankError> {
        let terms = self.equation.terms(run, rows, delay_s, moved)?;
        Ok(terms.iter().map(|terms| terms.load(beta)).collect())
    }

    /// Root mean square of each load about its mean, over all runs.
    fn sizes(&self) -> Vec<f64> {
        let of_load = |k: usize| {
            let of_run = |run: &super::Run<'_>| {
                let used = || run.motion.cycles.iter().flat_map(|rows| &run.loads[k][rows.clone()]);
                let mean = used().sum::<f64>() / run.motion.count() as f64;
                used().map(|y| (y - mean).powi(2)).sum::<f64>()
            };
            (self.runs.iter().map(of_run).sum::<f64>() / self.samples() as f64).sqrt()
        };
        (0..self.n_loads()).map(of_load).collect()
    }

    /// Standard deviation of a residual of each load.
    pub(super) fn sigma(&self, fitted: &[Vec<Fitted>]) -> Vec<f64> {
        let of_load = |k: usize| {
            let squares: f64 = fitted.iter().map(|f| f[k].used as f64 * f[k].residual_rms.powi(2)).sum();
            let samples: usize = fitted.iter().map(|f| f[k].used).sum();
            (squares / samples as f64).sqrt()
        };
        (0..self.n_loads()).map(of_load).collect()
    }

    /// s√τ of each load: so much an independent observation of it is worth.
    fn informative(&self, fitted: &[Vec<Fitted>]) -> Vec<f64> {
        let with_time = |(k, sigma): (usize, f64)| {
            let known: Vec<f64> = fitted.iter().filter_map(|f| f[k].correlation).collect();
            let mean = known.iter().sum::<f64>() / known.len().max(1) as f64;
            sigma * mean.max(1.0).sqrt()
        };
        self.sigma(fitted).into_iter().enumerate().map(with_time).collect()
    }

    /// The triangle of each cycle, or of each run without its zeros, as rows of one small problem.
    pub(super) fn condense(
        &self,
        beta: &[f64],
        weights: &[f64],
        by_run: bool,
        with_errors: bool,
    ) -> Result<Condensed, TankError> {
        let (p, zeros) = (self.names.len(), weights.len());
        let n_errors = if with_errors { self.inputs.len() } else { 0 };
        let shape = Shape { regressors: zeros + p, responses: n_errors + 1 };
        let width = shape.width();
        let offsets = if by_run { 0 } else { self.runs.len() * zeros };
        let (mut design, mut response, mut cluster) = (Vec::new(), Vec::new(), Vec::new());
        let mut columns = vec![Vec::new(); n_errors];
        let mut clusters = 0;
        for (r, run) in self.runs.iter().enumerate() {
            let mut put = |factor: &Factor, of: usize| {
                for i in (if by_run { zeros } else { 0 })..width {
                    let mut row = vec![0.0; p + offsets];
                    for (j, x) in row[..p].iter_mut().enumerate() {
                        *x = factor.entry(i, zeros + j);
                    }
                    if !by_run {
                        (0..zeros).for_each(|k| row[p + r * zeros + k] = factor.entry(i, k));
                    }
                    design.push(row);
                    response.push(factor.entry(i, width - 1));
                    cluster.push(of);
                    for (k, column) in columns.iter_mut().enumerate() {
                        column.push(factor.entry(i, zeros + p + k));
                    }
                }
            };
            let mut whole = Factor::empty(shape);
            for rows in &run.motion.cycles {
                let factor = self.cycle(r, rows.clone(), (beta, weights), with_errors, shape)?;
                if by_run {
                    whole.merge(&factor).map_err(|e| self.not_summed(e))?;
                } else {
                    put(&factor, clusters);
                    clusters += 1;
                }
            }
            if by_run {
                put(&whole, r);
            }
        }
        let names = self.names.iter().map(|(name, _)| name.clone()).chain((0..offsets).map(|i| {
            match (self.runs[i / zeros].id, i % zeros) {
                (id, 0) => format!("zero of {id}"),
                (id, load) => format!("zero {} of {id}", load + 1),
            }
        }));
        let design = Mat::from_fn(design.len(), p + offsets, |i, j| design[i][j]);
        let mut problem = ls::Problem::single(design, response, names.collect());
        problem.cluster = Some(cluster);
        Ok(Condensed { problem, errors: columns })
    }

    /// The rows of one cycle as their triangle: ones for the zero of each load, regressors, errors, and the measured load with what is not looked for taken off.
    fn cycle(
        &self,
        r: usize,
        rows: Range<usize>,
        (beta, weights): (&[f64], &[f64]),
        with_errors: bool,
        shape: Shape,
    ) -> Result<Factor, TankError> {
        let n = rows.len();
        let mut sums = Accumulator::new(shape);
        for (k, (columns, weight)) in self.columns(r, rows, beta, with_errors)?.into_iter().zip(weights).enumerate() {
            let Columns { regressors, errors, measured } = columns;
            let zeros = (0..weights.len()).map(|of| vec![if of == k { 1.0 } else { 0.0 }; n]);
            let mut regressors: Vec<Vec<f64>> = zeros.chain(regressors).collect();
            let mut responses: Vec<Vec<f64>> = errors.into_iter().chain([measured]).collect();
            for column in regressors.iter_mut().chain(&mut responses) {
                for x in column.iter_mut() {
                    *x *= weight;
                }
            }
            let [regressors, responses] =
                [&regressors, &responses].map(|c| c.iter().map(Vec::as_slice).collect::<Vec<_>>());
            sums.push(&regressors, &responses).map_err(|e| self.not_summed(e))?;
        }
        Ok(sums.finish())
    }

    /// The linear problem of each load at `beta`, at samples of a run.
    pub(super) fn columns(
        &self,
        r: usize,
        rows: Range<usize>,
        beta: &[f64],
        with_errors: bool,
    ) -> Result<Vec<Columns>, TankError> {
        let delay_s = self.delay_s(beta);
        let terms = self.equation.terms(r, rows.clone(), delay_s, None)?;
        let mut errors = vec![Vec::new(); terms.len()];
        if with_errors {
            for k in 0..self.inputs.len() {
                let moved = self.error_columns(k, r, rows.clone(), beta, delay_s)?;
                errors.iter_mut().zip(moved).for_each(|(errors, column)| errors.push(column));
            }
        }
        let of_load = |((terms, errors), load): ((super::Terms, Vec<Vec<f64>>), &&[f64])| {
            let known = load[rows.clone()].iter().zip(&terms.known);
            Columns { measured: known.map(|(y, known)| y - known).collect(), regressors: terms.columns, errors }
        };
        let mut out: Vec<Columns> = terms.into_iter().zip(errors).zip(&self.runs[r].loads).map(of_load).collect();
        if let Some(j) = self.delay_at() {
            let h = TIME_STEP * self.period_s();
            let late = self.loads(r, rows.clone(), beta, delay_s + h, None)?;
            let early = self.loads(r, rows, beta, delay_s - h, None)?;
            for (columns, (late, early)) in out.iter_mut().zip(late.iter().zip(&early)) {
                columns.regressors[j] = late.iter().zip(early).map(|(a, b)| (a - b) / (2.0 * h)).collect();
                // About the last delay, so that the coefficient is the delay itself and takes its prior.
                let column = columns.regressors[j].iter();
                columns.measured.iter_mut().zip(column).for_each(|(y, x)| *y += delay_s * x);
            }
        }
        Ok(out)
    }

    /// ∂f/∂q times the standard uncertainty of q, of each load.
    fn error_columns(
        &self,
        k: usize,
        r: usize,
        rows: Range<usize>,
        beta: &[f64],
        delay_s: f64,
    ) -> Result<Vec<Vec<f64>>, TankError> {
        let standard = self.inputs[k].declared.standard;
        let (sign, step) = match self.inputs[k].enters {
            Enters::Load(of) => {
                let factor = |load: usize| if load == of { standard } else { 0.0 };
                let mut loads = self.loads(r, rows, beta, delay_s, None)?;
                loads.iter_mut().enumerate().for_each(|(l, load)| load.iter_mut().for_each(|f| *f *= factor(l)));
                return Ok(loads);
            }
            Enters::Motion => (-1.0, STEP),
            Enters::Constant(size) => (1.0, STEP * size),
        };
        // What is there is made by q + e, what is fitted by q.
        let [above, below] = [step, -step].map(|by| self.loads(r, rows.clone(), beta, delay_s, Some((k, by))));
        let slope = |(a, b): (&f64, &f64)| sign * standard * (a - b) / (2.0 * step);
        Ok(above?.iter().zip(&below?).map(|(a, b)| a.iter().zip(b).map(slope).collect()).collect())
    }

    /// Residuals and zeros of all runs, by load.
    pub(super) fn fitted(&self, beta: &[f64]) -> Result<Vec<Vec<Fitted>>, TankError> {
        let delay_s = self.delay_s(beta);
        (self.runs.iter().enumerate())
            .map(|(r, run)| {
                let rows = run.motion.samples();
                let loads = self.loads(r, rows.clone(), beta, delay_s, None)?;
                let of_load = |(measured, load): (&&[f64], Vec<f64>)| {
                    let away = |i: usize| measured[i] - load[i - rows.start];
                    let used = || run.motion.cycles.iter().cloned().flatten();
                    let n = run.motion.count() as f64;
                    let zero = used().map(away).sum::<f64>() / n;
                    let left: Vec<f64> = used().map(|i| away(i) - zero).collect();
                    Fitted {
                        zero,
                        used: left.len(),
                        residual_rms: (left.iter().map(|x| x * x).sum::<f64>() / n).sqrt(),
                        correlation: integrated_time(&left),
                        load: load.iter().map(|f| f + zero).collect(),
                    }
                };
                Ok(run.loads.iter().zip(loads).map(of_load).collect())
            })
            .collect()
    }
}

/// The first size over each; one where either is zero.
pub(super) fn over_first(sizes: &[f64]) -> Vec<f64> {
    let first = sizes.first().copied().unwrap_or(1.0);
    sizes.iter().map(|size| if first > 0.0 && *size > 0.0 { first / size } else { 1.0 }).collect()
}

/// Coefficients of a fit, zero where they are not determined.
pub(super) fn values(fit: &ls::Fit) -> Vec<f64> {
    fit.coefficients.iter().map(|c| c.value.unwrap_or(0.0)).collect()
}

/// n/τ of all loads of all runs; a run that is too short to tell counts with the mean τ of the others, and with one sample where none tells.
fn effective_samples(fitted: &[Vec<Fitted>]) -> f64 {
    let known: Vec<f64> = fitted.iter().flatten().filter_map(|f| f.correlation).collect();
    let mean = if known.is_empty() { f64::INFINITY } else { known.iter().sum::<f64>() / known.len() as f64 };
    fitted.iter().flatten().map(|f| (f.used as f64 / f.correlation.unwrap_or(mean).max(1.0)).max(1.0)).sum()
}
