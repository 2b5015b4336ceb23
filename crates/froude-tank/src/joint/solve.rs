//! The joint fit: all runs, all coefficients, in time.
//!
//! Everything but the delay is linear; the delay is linearised about its last value (Gauss and Newton), −∂f/∂t being its column. Each run has a zero
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

/// Rows of the linear problem, a vector for each column.
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
}

impl<E: Equation> Problem<'_, E> {
    pub(crate) fn solve(&self) -> Result<Solved, TankError> {
        let mut beta = self.start.clone();
        let (mut by_run, mut effective) = (self.runs.len() >= FEWEST_CLUSTERS, self.samples() as f64);
        let period_s = self.period_s();
        // Without coefficients the delay has no column: the first step holds it.
        let mut hold = true;
        for round in 0..2 {
            let mut steps = 0;
            loop {
                let condensed = self.condense(&beta, by_run, false)?;
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
                            "the delay of the load does not converge (last value {:.3} s, period {period_s:.2} s): check that angle and load are of one clock and of the right sign, or declare the delay",
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
                effective = effective_samples(&self.fitted(&beta)?);
                // Nothing is weighed against the observations: their number decides nothing but the criterion.
                if self.known().is_empty() {
                    break;
                }
            }
        }
        Ok(Solved { beta, by_run, effective })
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
        let priors = self.known().into_iter().map(|(_, prior)| prior).filter(|p| Some(p.index) != held_delay);
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

    /// The load at samples of a run, without its zero.
    fn load(&self, run: usize, rows: Range<usize>, beta: &[f64], delay_s: f64) -> Result<Vec<f64>, TankError> {
        Ok(self.equation.terms(run, rows, delay_s, None)?.load(beta))
    }

    /// The triangle of each cycle, or of each run without its zero, as rows of one small problem.
    pub(super) fn condense(&self, beta: &[f64], by_run: bool, with_errors: bool) -> Result<Condensed, TankError> {
        let p = self.names.len();
        let n_errors = if with_errors { self.inputs.len() } else { 0 };
        let shape = Shape { regressors: 1 + p, responses: n_errors + 1 };
        let width = shape.width();
        let offsets = if by_run { 0 } else { self.runs.len() };
        let (mut design, mut response, mut cluster) = (Vec::new(), Vec::new(), Vec::new());
        let mut columns = vec![Vec::new(); n_errors];
        let mut clusters = 0;
        for (r, run) in self.runs.iter().enumerate() {
            let mut put = |factor: &Factor, of: usize| {
                for i in usize::from(by_run)..width {
                    let mut row = vec![0.0; p + offsets];
                    for (j, x) in row[..p].iter_mut().enumerate() {
                        *x = factor.entry(i, 1 + j);
                    }
                    if !by_run {
                        row[p + r] = factor.entry(i, 0);
                    }
                    design.push(row);
                    response.push(factor.entry(i, width - 1));
                    cluster.push(of);
                    for (k, column) in columns.iter_mut().enumerate() {
                        column.push(factor.entry(i, 1 + p + k));
                    }
                }
            };
            let mut whole = Factor::empty(shape);
            for rows in &run.motion.cycles {
                let factor = self.cycle(r, rows.clone(), beta, with_errors, shape)?;
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
        let names = self
            .names
            .iter()
            .map(|(name, _)| name.clone())
            .chain((0..offsets).map(|r| format!("zero of {}", self.runs[r].id)));
        let design = Mat::from_fn(design.len(), p + offsets, |i, j| design[i][j]);
        let mut problem = ls::Problem::single(design, response, names.collect());
        problem.cluster = Some(cluster);
        Ok(Condensed { problem, errors: columns })
    }

    /// The rows of one cycle as their triangle: ones, regressors, errors, and the measured load with what is not looked for taken off.
    fn cycle(
        &self,
        r: usize,
        rows: Range<usize>,
        beta: &[f64],
        with_errors: bool,
        shape: Shape,
    ) -> Result<Factor, TankError> {
        let ones = vec![1.0; rows.len()];
        let Columns { regressors, errors, measured } = self.columns(r, rows, beta, with_errors)?;
        let regressors: Vec<&[f64]> =
            std::iter::once(ones.as_slice()).chain(regressors.iter().map(Vec::as_slice)).collect();
        let responses: Vec<&[f64]> = errors.iter().chain([&measured]).map(Vec::as_slice).collect();
        let mut sums = Accumulator::new(shape);
        sums.push(&regressors, &responses).map_err(|e| self.not_summed(e))?;
        Ok(sums.finish())
    }

    /// The linear problem at `beta`, at samples of a run.
    pub(super) fn columns(
        &self,
        r: usize,
        rows: Range<usize>,
        beta: &[f64],
        with_errors: bool,
    ) -> Result<Columns, TankError> {
        let delay_s = self.delay_s(beta);
        let terms = self.equation.terms(r, rows.clone(), delay_s, None)?;
        let mut measured: Vec<f64> = self.runs[r].load[rows.clone()].to_vec();
        measured.iter_mut().zip(&terms.known).for_each(|(y, known)| *y -= known);
        let mut errors = Vec::new();
        if with_errors {
            for k in 0..self.inputs.len() {
                errors.push(self.error_column(k, r, rows.clone(), beta, delay_s)?);
            }
        }
        let mut regressors = terms.columns;
        if let Some(j) = self.delay_at() {
            let h = TIME_STEP * self.period_s();
            let late = self.load(r, rows.clone(), beta, delay_s + h)?;
            let early = self.load(r, rows, beta, delay_s - h)?;
            regressors[j] = late.iter().zip(&early).map(|(a, b)| (a - b) / (2.0 * h)).collect();
            // About the last delay, so that the coefficient is the delay itself and takes its prior.
            measured.iter_mut().zip(&regressors[j]).for_each(|(y, x)| *y += delay_s * x);
        }
        Ok(Columns { regressors, errors, measured })
    }

    /// ∂f/∂q times the standard uncertainty of q.
    fn error_column(
        &self,
        k: usize,
        r: usize,
        rows: Range<usize>,
        beta: &[f64],
        delay_s: f64,
    ) -> Result<Vec<f64>, TankError> {
        let standard = self.inputs[k].declared.standard;
        let (sign, step) = match self.inputs[k].enters {
            Enters::Load => {
                let load = self.load(r, rows, beta, delay_s)?;
                return Ok(load.into_iter().map(|f| standard * f).collect());
            }
            Enters::Angle => (-1.0, STEP),
            Enters::Constant(size) => (1.0, STEP * size),
        };
        let at = |by: f64| -> Result<Vec<f64>, TankError> {
            Ok(self.equation.terms(r, rows.clone(), delay_s, Some((k, by)))?.load(beta))
        };
        // What is there is made by q + e, what is fitted by q.
        let (above, below) = (at(step)?, at(-step)?);
        Ok(above.iter().zip(&below).map(|(a, b)| sign * standard * (a - b) / (2.0 * step)).collect())
    }

    /// Residuals and zeros of all runs.
    pub(super) fn fitted(&self, beta: &[f64]) -> Result<Vec<Fitted>, TankError> {
        let delay_s = self.delay_s(beta);
        (self.runs.iter().enumerate())
            .map(|(r, run)| {
                let rows = run.motion.samples();
                let load = self.load(r, rows.clone(), beta, delay_s)?;
                let away = |i: usize| run.load[i] - load[i - rows.start];
                let used = || run.motion.cycles.iter().cloned().flatten();
                let n = run.motion.count() as f64;
                let zero = used().map(away).sum::<f64>() / n;
                let left: Vec<f64> = used().map(|i| away(i) - zero).collect();
                Ok(Fitted {
                    zero,
                    used: left.len(),
                    residual_rms: (left.iter().map(|x| x * x).sum::<f64>() / n).sqrt(),
                    correlation: integrated_time(&left),
                    load: load.iter().map(|f| f + zero).collect(),
                })
            })
            .collect()
    }
}

/// Coefficients of a fit, zero where they are not determined.
pub(super) fn values(fit: &ls::Fit) -> Vec<f64> {
    fit.coefficients.iter().map(|c| c.value.unwrap_or(0.0)).collect()
}

/// n/τ of all runs; a run that is too short to tell counts with the mean τ of the others, and with one sample where none tells.
fn effective_samples(fitted: &[Fitted]) -> f64 {
    let known: Vec<f64> = fitted.iter().filter_map(|f| f.correlation).collect();
    let mean = if known.is_empty() { f64::INFINITY } else { known.iter().sum::<f64>() / known.len() as f64 };
    fitted.iter().map(|f| (f.used as f64 / f.correlation.unwrap_or(mean).max(1.0)).max(1.0)).sum()
}
