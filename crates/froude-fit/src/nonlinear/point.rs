//! A model at one set of parameters: residuals, and their derivatives.

use super::error::NonlinearError;
use crate::dense::dot;
use crate::nonlinear::model::{Model, Parameter, Settings};

/// A difference step is never below this part of the parameter, where rounding would eat it.
const SMALLEST_STEP: f64 = 1e-11;

/// Which parameters move which run.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    /// Those that move all runs.
    pub shared: Vec<usize>,
    /// By run: those that move it alone.
    pub own: Vec<Vec<usize>>,
}

impl Layout {
    fn new(parameters: &[Parameter], runs: usize) -> Self {
        let mut out = Self { shared: Vec::new(), own: vec![Vec::new(); runs] };
        for (j, parameter) in parameters.iter().enumerate() {
            parameter.run.map_or(&mut out.shared, |run| &mut out.own[run]).push(j);
        }
        out
    }

    /// Those that move a run: the shared ones, then its own.
    pub(super) fn moving(&self, run: usize) -> impl Iterator<Item = usize> + '_ {
        self.shared.iter().chain(&self.own[run]).copied()
    }
}

/// A model, its parameters, and how many residuals each run has: checked.
pub(super) struct Problem<'a> {
    model: &'a dyn Model,
    pub parameters: &'a [Parameter],
    settings: &'a Settings,
    pub layout: Layout,
    rows: Vec<usize>,
}

/// Residuals and columns `−∂r/∂θ`, both by run; columns in the order of [`Layout::moving`].
#[derive(Debug, Clone)]
pub(super) struct Point {
    pub theta: Vec<f64>,
    pub residuals: Vec<Vec<f64>>,
    pub columns: Vec<Vec<Vec<f64>>>,
    pub sum: f64,
}

impl<'a> Problem<'a> {
    /// The problem and the model at its start.
    pub(super) fn new(
        model: &'a dyn Model,
        parameters: &'a [Parameter],
        settings: &'a Settings,
    ) -> Result<(Self, Point), NonlinearError> {
        let runs = model.runs();
        check(parameters, runs)?;
        settings.check()?;
        let theta: Vec<f64> = parameters.iter().map(|p| p.start).collect();
        let mut residuals = Vec::with_capacity(runs);
        for run in 0..runs {
            let impossible = || format!("the model of run {run} is impossible at the start; start elsewhere");
            let r = model.residuals(run, &theta).ok_or_else(|| NonlinearError(impossible()))?;
            if r.is_empty() {
                return Err(NonlinearError(format!("run {run} has no residuals; leave it out")));
            }
            if let Some(row) = r.iter().position(|r| !(r * r).is_finite()) {
                return Err(NonlinearError(format!(
                    "residual {row} of run {run} is {} at the start; it and its square must be finite",
                    r[row]
                )));
            }
            residuals.push(r);
        }
        let rows: Vec<usize> = residuals.iter().map(Vec::len).collect();
        let (n, free) = (rows.iter().sum::<usize>(), parameters.iter().filter(|p| p.lower < p.upper).count());
        if n < free {
            return Err(NonlinearError(format!(
                "{n} residuals cannot determine {free} free parameters; add data or fix some"
            )));
        }
        let problem = Self { model, parameters, settings, layout: Layout::new(parameters, runs), rows };
        let columns = problem.columns(&theta, &residuals)?;
        let sum = residuals.iter().map(|r| dot(r, r)).sum();
        Ok((problem, Point { theta, residuals, columns, sum }))
    }

    /// Residuals of all runs.
    pub(super) fn rows(&self) -> usize {
        self.rows.iter().sum()
    }

    /// Residuals of a run; `None` where the model is impossible or says nothing finite.
    fn residuals_of(&self, run: usize, theta: &[f64]) -> Result<Option<Vec<f64>>, NonlinearError> {
        let Some(r) = self.model.residuals(run, theta) else {
            return Ok(None);
        };
        if r.len() != self.rows[run] {
            return Err(wrong_size("residuals", run, r.len(), self.rows[run]));
        }
        Ok(Some(r).filter(|r| r.iter().all(|r| r.is_finite())))
    }

    /// Residuals of all runs and their sum of squares, likewise.
    pub(super) fn residuals(&self, theta: &[f64]) -> Result<Option<(Vec<Vec<f64>>, f64)>, NonlinearError> {
        let mut out = Vec::with_capacity(self.rows.len());
        for run in 0..self.rows.len() {
            match self.residuals_of(run, theta)? {
                Some(r) => out.push(r),
                None => return Ok(None),
            }
        }
        let sum: f64 = out.iter().map(|r| dot(r, r)).sum();
        Ok(Some((out, sum)).filter(|_| sum.is_finite()))
    }

    /// `−∂r/∂θ` by run.
    pub(super) fn columns(&self, theta: &[f64], residuals: &[Vec<f64>]) -> Result<Vec<Vec<Vec<f64>>>, NonlinearError> {
        (0..self.rows.len()).map(|run| self.columns_of(run, theta, &residuals[run])).collect()
    }

    fn columns_of(&self, run: usize, theta: &[f64], here: &[f64]) -> Result<Vec<Vec<f64>>, NonlinearError> {
        let given = self.model.derivatives(run, theta);
        if let Some(given) = &given
            && given.len() != theta.len()
        {
            let (found, expected) = (given.len(), theta.len());
            return Err(wrong_size("columns of derivatives", run, found, expected));
        }
        let column = |j: usize| {
            let column = match &given {
                Some(given) if given[j].len() != here.len() => {
                    return Err(wrong_size("a column of derivatives", run, given[j].len(), here.len()));
                }
                Some(given) => Some(given[j].iter().map(|d| -d).collect()),
                None => self.difference(run, theta, j, here)?,
            };
            column
                .filter(|c: &Vec<f64>| c.iter().all(|c| c.is_finite()))
                .ok_or_else(|| {
                    NonlinearError(format!(
                        "the derivative of run {run} with respect to {:?} does not exist at the start; start further from where the model \
                         is impossible, or make the parameter's scale smaller",
                        self.parameters[j].name
                    ))
                })
        };
        self.layout.moving(run).map(column).collect()
    }

    /// Central difference; at a bound, or beside the impossible, from one side with three points.
    fn difference(
        &self,
        run: usize,
        theta: &[f64],
        j: usize,
        here: &[f64],
    ) -> Result<Option<Vec<f64>>, NonlinearError> {
        let Parameter { scale, lower, upper, .. } = self.parameters[j];
        if lower == upper {
            return Ok(Some(vec![0.0; here.len()]));
        }
        let h = (self.settings.difference * scale).max(SMALLEST_STEP * theta[j].abs());
        let mut moved = theta.to_vec();
        let mut at = |by: f64| {
            moved[j] = theta[j] + by;
            if (lower..=upper).contains(&moved[j]) { self.residuals_of(run, &moved) } else { Ok(None) }
        };
        let one_sided = |near: &[f64], far: Option<Vec<f64>>, h: f64| -> Vec<f64> {
            match far {
                Some(far) => (0..here.len()).map(|i| (3.0 * here[i] - 4.0 * near[i] + far[i]) / (2.0 * h)).collect(),
                None => (0..here.len()).map(|i| (here[i] - near[i]) / h).collect(),
            }
        };
        let width = (theta[j] + h) - (theta[j] - h);
        Ok(match (at(h)?, at(-h)?) {
            (Some(up), Some(down)) => Some(up.iter().zip(&down).map(|(u, d)| (d - u) / width).collect()),
            (Some(up), None) => Some(one_sided(&up, at(2.0 * h)?, h)),
            (None, Some(down)) => Some(one_sided(&down, at(-2.0 * h)?, -h)),
            (None, None) => None,
        })
    }
}

impl Point {
    /// Which parameters stay where they are: fixed, or at a bound with the sum of squares falling only beyond it.
    pub(super) fn held(&self, parameters: &[Parameter], layout: &Layout) -> Vec<bool> {
        let gradient = self.gradient(layout);
        (parameters.iter().zip(&self.theta).zip(gradient))
            .map(|((p, &at), gradient)| (at <= p.lower && gradient >= 0.0) || (at >= p.upper && gradient <= 0.0))
            .zip(parameters)
            .map(|(is_held, p)| is_held || p.lower == p.upper)
            .collect()
    }

    /// Gradient of half the sum of squares: `−Cᵀ r`.
    pub(super) fn gradient(&self, layout: &Layout) -> Vec<f64> {
        let mut out = vec![0.0; self.theta.len()];
        for run in 0..self.residuals.len() {
            for (k, j) in layout.moving(run).enumerate() {
                out[j] -= dot(&self.columns[run][k], &self.residuals[run]);
            }
        }
        out
    }

    /// Lengths of the columns over all runs.
    pub(super) fn lengths(&self, layout: &Layout) -> Vec<f64> {
        let mut out = vec![0.0; self.theta.len()];
        for run in 0..self.residuals.len() {
            for (k, j) in layout.moving(run).enumerate() {
                out[j] += dot(&self.columns[run][k], &self.columns[run][k]);
            }
        }
        out.into_iter().map(f64::sqrt).collect()
    }

    /// What a step moves the linearised model by, by run.
    pub(super) fn moved(&self, layout: &Layout, step: &[f64]) -> Vec<Vec<f64>> {
        (0..self.residuals.len())
            .map(|run| {
                let mut out = vec![0.0; self.residuals[run].len()];
                for (k, j) in layout.moving(run).enumerate() {
                    out.iter_mut().zip(&self.columns[run][k]).for_each(|(out, c)| *out += c * step[j]);
                }
                out
            })
            .collect()
    }
}

/// Refuses parameters that contradict themselves or the runs.
fn check(parameters: &[Parameter], runs: usize) -> Result<(), NonlinearError> {
    let refuse = |problem: String| Err(NonlinearError(problem));
    if parameters.is_empty() {
        return refuse("no parameters are given; name at least one".to_owned());
    }
    if runs == 0 {
        return refuse("the model has no runs; give at least one".to_owned());
    }
    let mut seen = std::collections::BTreeMap::new();
    for (second, Parameter { name, start, scale, lower, upper, run }) in parameters.iter().enumerate() {
        if let Some(first) = seen.insert(name, second) {
            return refuse(format!("parameter {name:?} is named twice (parameters {first} and {second}); rename one"));
        }
        if !start.is_finite() {
            return refuse(format!("start of {name:?} is {start}; it must be finite"));
        }
        if !(scale.is_finite() && *scale > 0.0) {
            return refuse(format!("scale of {name:?} is {scale}; it must be positive and finite"));
        }
        if lower.is_nan() || upper.is_nan() || lower > upper {
            return refuse(format!("bounds of {name:?} are [{lower}, {upper}]; the lower must not exceed the upper"));
        }
        if !(lower..=upper).contains(&start) {
            return refuse(format!(
                "{name:?} starts at {start}, outside its bounds [{lower}, {upper}]; start inside or widen them"
            ));
        }
        if let Some(run) = run.filter(|&run| run >= runs) {
            return refuse(format!("{name:?} belongs to run {run}, but the model has {runs}"));
        }
    }
    Ok(())
}

fn wrong_size(what: &str, run: usize, found: usize, expected: usize) -> NonlinearError {
    NonlinearError(format!("{what} of run {run}: {found} entries where {expected} are needed"))
}
