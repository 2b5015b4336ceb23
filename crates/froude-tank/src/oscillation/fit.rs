//! The joint fit: all runs, all coefficients, in time.
//!
//! Everything but the delay is linear; the delay is linearised about its last value (Gauss and Newton), −∂f/∂t being its column. Each run has a zero
//! of its own. The rows of a cycle are condensed to their triangle as soon as they are made, so that memory does not grow with the log.
//!
//! **Scatter.** Noise of a load cell on a rod is correlated over tenths of a second. The covariance is that of clusters, the runs left out in turn
//! (CR3), or the cycles where there are fewer than five runs: whatever the correlation within one, it counts. Against what is declared beforehand
//! (buoyancy, delay, priors) the observations are weighed by their effective number n/τ, τ the integrated autocorrelation time of the residuals.
//!
//! **Declared errors.** Radius, mass, density, flow, and the gains of angle and force move all rows together: S·J·e with J = ∂f/∂q by differences.
//!
//! # Source
//!
//! Bell & McCaffrey (2002) and MacKinnon, Nielsen & Webb (2023) (CR3); Sokal (1997) (τ); JCGM 100:2008 (GUM), 5.1 and G.4.

use froude_fit as ls;
use froude_fit::autocorrelation::integrated_time;
use froude_fit::budget::{Combined, Kind, OUTSIDE_95, Part, Shape as PartShape, combine};
use froude_fit::faer::Mat;
use froude_fit::stream::{Accumulator, Factor, Shape};
use froude_fit::{CovarianceKind, FEWEST_CLUSTERS, FitError, Status};
use froude_hydro::swing::{Medium, Pivot};
use froude_records::campaign::{BoundKind, Identify};

use super::error::OscillationError;
use super::forces::{Drag, Terms, Values};
use super::motion::Motion;
use super::setup::{OscillationRun, Setup};

/// Name of the added-mass coefficient.
pub const ADDED: &str = "C_A";
/// Name of the delay.
pub const DELAY: &str = "delay";
/// Start of the names of masses that runs in air determine.
pub const MASS: &str = "m";
/// Start of the names of net buoyancies.
pub const BUOYANCY: &str = "B_buoyancy";

/// Steps of Gauss and Newton for the delay.
const MOST_STEPS: usize = 30;
/// The delay has converged when a step is below this part of the shortest period.
const SMALL: f64 = 1e-10;
/// Step of time differences, as part of the shortest period: error 1e-8 of the third derivative, rounding 1e-16/1e-4.
const TIME_STEP: f64 = 1e-4;
/// Step of differences by what is declared, as part of it.
const STEP: f64 = 1e-5;

/// A coefficient that is looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknown {
    /// Its name.
    pub name: String,
    /// SI unit text.
    pub unit: String,
    /// Its value; `None` where the runs do not determine it.
    pub value: Option<f64>,
    /// What became of it.
    pub status: Status,
    /// Its uncertainty; `None` where it has none.
    pub combined: Option<Combined>,
}

/// An error that all runs share, and what it does.
#[derive(Debug, Clone, PartialEq)]
pub struct DeclaredError {
    /// What errs, in words: `radius`, `mass of H1LT`.
    pub name: String,
    /// Its standard uncertainty, SI; of a gain, as part of it.
    pub standard: f64,
    /// Degrees of freedom of that.
    pub dof: f64,
    /// ∂β/∂e.
    pub sensitivity: Vec<f64>,
}

/// What is left of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// Zero of the load cell, N.
    pub zero_n: f64,
    /// The fitted force from the first sample used to the last, N, its zero included.
    pub force_n: Vec<f64>,
    /// Samples used of them.
    pub used: usize,
    /// Root mean square of measured less fitted, N.
    pub residual_rms_n: f64,
    /// τ: integrated autocorrelation time of that, samples; `None` where the run is too short to tell.
    pub correlation: Option<f64>,
}

/// Coefficients of all runs by one drag law.
#[derive(Debug, Clone)]
pub struct OscillationFit {
    /// The drag law.
    pub law: String,
    /// C_A, the drag coefficients, the buoyancies, the delay.
    pub unknowns: Vec<Unknown>,
    /// Scatter first, then each declared error.
    pub parts: Vec<Part>,
    /// The declared errors, in the order of `parts` after the first.
    pub errors: Vec<DeclaredError>,
    /// By run.
    pub fitted: Vec<Fitted>,
    /// What was left out in turn: `run` or `cycle`.
    pub by: &'static str,
    /// How many of them.
    pub clusters: usize,
    /// Samples used.
    pub samples: usize,
    /// n/τ.
    pub effective: f64,
    /// Standard deviation of a residual, N.
    pub sigma_n: f64,
    /// The delay that the motion was taken at, s.
    pub delay_s: f64,
}

impl OscillationFit {
    /// The coefficient of a name.
    #[must_use]
    pub fn unknown(&self, name: &str) -> Option<&Unknown> {
        self.unknowns.iter().find(|u| u.name == name)
    }
}

/// Fits a drag law, added mass, buoyancy and delay to all runs together.
///
/// `motions` belongs to `runs`, one each. Bounds, fixed values, exclusions and priors of `identify` act by the coefficient's name.
///
/// # Errors
///
/// [`OscillationError`]: impossible declarations, a law that cannot be used, what the least squares refuse, a delay that runs away.
pub fn fit(
    runs: &[OscillationRun<'_>],
    motions: &[Motion],
    setup: &Setup,
    drag: &Drag,
    identify: &Identify,
) -> Result<OscillationFit, OscillationError> {
    setup.check()?;
    if !runs.iter().any(|run| run.medium == Medium::Water) {
        return Err(OscillationError::NoRuns);
    }
    Joint::new(runs, motions, setup, drag, identify).solve()
}

/// The problem: what is known of it before the first step.
pub(super) struct Joint<'a> {
    runs: &'a [OscillationRun<'a>],
    motions: &'a [Motion],
    setup: &'a Setup,
    drag: &'a Drag,
    identify: &'a Identify,
    pub(super) names: Vec<(String, String)>,
    /// Where the buoyancy of each body stands, if it has one.
    pub(super) buoyancy: Vec<Option<usize>>,
    /// Where the mass of each body stands, if runs in air look for it.
    pub(super) mass: Vec<Option<usize>>,
    pub(super) delay: Option<usize>,
    period_s: f64,
    samples: usize,
}

/// Rows of the linear problem, a vector for each column.
pub(super) struct Columns {
    /// Of the coefficients.
    pub regressors: Vec<Vec<f64>>,
    /// Of the declared errors, N per standard uncertainty.
    pub errors: Vec<Vec<f64>>,
    /// The force, with what is not looked for taken off.
    pub measured: Vec<f64>,
}

/// Condensed rows of all runs, with the columns of the declared errors.
struct Condensed {
    problem: ls::Problem,
    errors: Vec<Vec<f64>>,
}

impl<'a> Joint<'a> {
    pub(super) fn new(
        runs: &'a [OscillationRun<'a>],
        motions: &'a [Motion],
        setup: &'a Setup,
        drag: &'a Drag,
        identify: &'a Identify,
    ) -> Self {
        let mut names = vec![(ADDED.to_owned(), "1".to_owned())];
        names.extend(drag.coefficients().map(|(name, unit)| (name.to_owned(), unit.to_owned())));
        let wet = |body: usize| runs.iter().any(|run| run.body == body && run.medium == Medium::Water);
        let mut buoyancy = Vec::new();
        for (i, body) in setup.bodies.iter().enumerate() {
            let is_unknown = setup.pivot == Pivot::Stream && wet(i) && body.buoyancy_n.is_none_or(|b| b.standard > 0.0);
            buoyancy.push(is_unknown.then_some(names.len()));
            if is_unknown {
                let name = if body.name.is_empty() { BUOYANCY.to_owned() } else { format!("{BUOYANCY}_{}", body.name) };
                names.push((name, "N".to_owned()));
            }
        }
        let in_air = |body: usize| runs.iter().any(|run| run.body == body && run.medium == Medium::Air);
        let mut mass = Vec::new();
        for (i, body) in setup.bodies.iter().enumerate() {
            mass.push(in_air(i).then_some(names.len()));
            if in_air(i) {
                let name = if body.name.is_empty() { MASS.to_owned() } else { format!("{MASS}_{}", body.name) };
                names.push((name, "kg".to_owned()));
            }
        }
        let delay = setup.delay_s.is_none_or(|d| d.standard > 0.0).then_some(names.len());
        if delay.is_some() {
            names.push((DELAY.to_owned(), "s".to_owned()));
        }
        let period_s = motions.iter().map(|m| m.angle.period_s()).fold(f64::INFINITY, f64::min);
        let samples = motions.iter().map(Motion::count).sum();
        Self { runs, motions, setup, drag, identify, names, buoyancy, mass, delay, period_s, samples }
    }

    fn solve(&self) -> Result<OscillationFit, OscillationError> {
        let mut beta = vec![0.0; self.names.len()];
        if let (Some(j), Some(prior)) = (self.delay, self.setup.delay_s) {
            beta[j] = prior.value;
        }
        for (body, j) in self.setup.bodies.iter().zip(&self.mass) {
            if let Some(j) = j {
                beta[*j] = body.mass_kg.value;
            }
        }
        let by_run = self.runs.len() >= FEWEST_CLUSTERS;
        let (mut by_run, mut effective) = (by_run, self.samples as f64);
        // Without coefficients the delay has no column: the first step holds it.
        let mut hold = true;
        for round in 0..2 {
            let mut steps = 0;
            loop {
                let condensed = self.condense(&beta, by_run, &[])?;
                let next = match self.least_squares(&condensed, effective, hold, &beta, None) {
                    Err(FitError::ClusterDecides { .. }) if by_run => {
                        by_run = false;
                        continue;
                    }
                    other => values(&other.map_err(|source| self.refused(source))?),
                };
                let change = self.delay.map_or(0.0, |j| (next[j] - beta[j]).abs());
                let is_held = std::mem::replace(&mut hold, false);
                beta = next;
                if let Some(j) = self.delay {
                    if beta[j].abs() > self.period_s || !beta[j].is_finite() {
                        return Err(OscillationError::Delay { delay_s: beta[j], period_s: self.period_s });
                    }
                    if change > SMALL * self.period_s || is_held {
                        steps += 1;
                        if steps > MOST_STEPS {
                            return Err(OscillationError::Delay { delay_s: beta[j], period_s: self.period_s });
                        }
                        continue;
                    }
                }
                break;
            }
            if round == 0 {
                let fitted = self.fitted(&beta)?;
                let next = effective_samples(&fitted);
                // Nothing is weighed against the observations: their number decides nothing but the criterion.
                effective = next;
                if !self.has_priors() {
                    break;
                }
            }
        }
        self.conclude(&beta, by_run, effective)
    }

    fn has_priors(&self) -> bool {
        !self.priors().is_empty()
    }

    /// Coefficients that are held or zero, bounds and priors, by name.
    fn options(&self, effective: f64, held: &[(usize, f64)]) -> ls::Options {
        let position = |name: &str| self.names.iter().position(|(n, _)| n == name);
        let is_drag = 1..=self.drag.columns.len();
        let bound = |(j, (name, _)): (usize, &(String, String))| {
            let named = self.identify.bounds.named.get(name).copied();
            let kind =
                named.unwrap_or(if is_drag.contains(&j) { self.identify.bounds.default } else { BoundKind::None });
            if kind == BoundKind::NonNegative { ls::Bound::NON_NEGATIVE } else { ls::Bound::FREE }
        };
        let fixed: Vec<(usize, f64)> = (self.identify.fixed.iter())
            .filter_map(|(name, value)| Some((position(name)?, *value)))
            .chain(held.iter().copied())
            .collect();
        let excluded: Vec<usize> = self.identify.exclude.iter().filter_map(|name| position(name)).collect();
        let is_free = |j: usize| !excluded.contains(&j) && fixed.iter().all(|(k, _)| *k != j);
        let bounds: Vec<ls::Bound> = self.names.iter().enumerate().map(bound).collect();
        ls::Options {
            bounds: if bounds.iter().all(|b| *b == ls::Bound::FREE) { Vec::new() } else { bounds },
            priors: self.priors().into_iter().map(|(_, p)| p).filter(|p| is_free(p.index)).collect(),
            fixed,
            excluded,
            covariance: CovarianceKind::Cr3,
            observations: vec![(effective.round() as usize).max(1)],
            ..ls::Options::default()
        }
    }

    /// What is known beforehand, with its name.
    pub(super) fn priors(&self) -> Vec<(String, ls::Prior)> {
        let mut out = Vec::new();
        let mut put = |name: String, index: Option<usize>, known: Option<froude_fit::budget::Uncertain>| {
            if let (Some(index), Some(known)) = (index, known.filter(|known| known.standard > 0.0)) {
                out.push((name, ls::Prior { index, value: known.value, standard: known.standard }));
            }
        };
        for (i, body) in self.setup.bodies.iter().enumerate() {
            put(of_body("buoyancy", &body.name), self.buoyancy[i], body.buoyancy_n);
            put(of_body("mass", &body.name), self.mass[i], Some(body.mass_kg));
        }
        put("delay".to_owned(), self.delay, self.setup.delay_s);
        for prior in self.identify.prior.iter().filter(|p| p.model.as_ref().is_none_or(|m| *m == self.drag.law.name)) {
            let index = self.names.iter().position(|(name, _)| *name == prior.coefficient);
            let known = froude_fit::budget::Uncertain::new(prior.value, prior.standard_uncertainty);
            put(format!("prior of {}", prior.coefficient), index, Some(known));
        }
        out
    }

    fn least_squares(
        &self,
        condensed: &Condensed,
        effective: f64,
        hold_delay: bool,
        beta: &[f64],
        moved: Option<usize>,
    ) -> Result<ls::Fit, FitError> {
        let held: Vec<(usize, f64)> = self.delay.filter(|_| hold_delay).map(|j| (j, beta[j])).into_iter().collect();
        let mut options = self.options(effective, &held);
        let offsets = condensed.problem.n_coefficients() - self.names.len();
        if !options.bounds.is_empty() {
            options.bounds.extend(std::iter::repeat_n(ls::Bound::FREE, offsets));
        }
        if let Some(k) = moved {
            options.priors[k].value += options.priors[k].standard;
        }
        ls::fit(&condensed.problem, &options)
    }

    fn refused(&self, source: FitError) -> OscillationError {
        OscillationError::Fit { model: self.drag.law.name.clone(), source }
    }

    /// Buoyancy of a body at `beta`: looked for, or declared, or none.
    fn buoyancy_n(&self, body: usize, beta: &[f64]) -> f64 {
        let declared = || self.setup.bodies[body].buoyancy_n.map_or(0.0, |b| b.value);
        self.buoyancy[body].map_or_else(declared, |j| beta[j])
    }

    /// Mass of a body at `beta`, with what of it is moved: looked for, or declared.
    fn mass_kg(&self, body: usize, beta: &[f64], values: &Values) -> f64 {
        self.mass[body].map_or(values.mass_kg[body], |j| beta[j])
    }

    fn delay_s(&self, beta: &[f64]) -> f64 {
        self.delay.map_or_else(|| self.setup.delay_s.map_or(0.0, |d| d.value), |j| beta[j])
    }

    /// The force on the cell at samples of a run, without its zero.
    fn force(
        &self,
        run: usize,
        rows: std::ops::Range<usize>,
        beta: &[f64],
        delay_s: f64,
        values: &Values,
    ) -> Result<Vec<f64>, OscillationError> {
        let body = self.runs[run].body;
        let terms = Terms::of(&self.runs[run], &self.motions[run], rows, delay_s, (self.setup, values, self.drag))?;
        let drag = &beta[1..=self.drag.columns.len()];
        Ok(terms.force(self.mass_kg(body, beta, values), beta[0], drag, self.buoyancy_n(body, beta)))
    }

    /// The triangle of each cycle, or of each run without its zero, as rows of one small problem.
    fn condense(&self, beta: &[f64], by_run: bool, errors: &[Input]) -> Result<Condensed, OscillationError> {
        let p = self.names.len();
        let shape = Shape { regressors: 1 + p, responses: errors.len() + 1 };
        let width = shape.width();
        let offsets = if by_run { 0 } else { self.runs.len() };
        let (mut design, mut response, mut cluster) = (Vec::new(), Vec::new(), Vec::new());
        let mut columns = vec![Vec::new(); errors.len()];
        let mut clusters = 0;
        for (r, motion) in self.motions.iter().enumerate() {
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
            for rows in &motion.cycles {
                let factor = self.cycle(r, rows.clone(), beta, errors, shape)?;
                if by_run {
                    whole.merge(&factor).map_err(|e| self.refused_stream(&e))?;
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

    fn refused_stream(&self, error: &froude_fit::stream::StreamError) -> OscillationError {
        OscillationError::Law { model: self.drag.law.name.clone(), why: format!("cannot be summed: {error}") }
    }

    /// The rows of one cycle as their triangle: ones, regressors, errors, and the measured force with what is not looked for taken off.
    fn cycle(
        &self,
        r: usize,
        rows: std::ops::Range<usize>,
        beta: &[f64],
        errors: &[Input],
        shape: Shape,
    ) -> Result<Factor, OscillationError> {
        let ones = vec![1.0; rows.len()];
        let Columns { regressors, errors, measured } = self.columns(r, rows, beta, errors)?;
        let regressors: Vec<&[f64]> =
            std::iter::once(ones.as_slice()).chain(regressors.iter().map(Vec::as_slice)).collect();
        let responses: Vec<&[f64]> = errors.iter().chain([&measured]).map(Vec::as_slice).collect();
        let mut sums = Accumulator::new(shape);
        sums.push(&regressors, &responses).map_err(|e| self.refused_stream(&e))?;
        Ok(sums.finish())
    }

    /// The linear problem at `beta`, at samples of a run.
    pub(super) fn columns(
        &self,
        r: usize,
        rows: std::ops::Range<usize>,
        beta: &[f64],
        errors: &[Input],
    ) -> Result<Columns, OscillationError> {
        let run = &self.runs[r];
        let values = Values::of(self.setup);
        let delay_s = self.delay_s(beta);
        let context = (self.setup, &values, self.drag);
        let terms = Terms::of(run, &self.motions[r], rows.clone(), delay_s, context)?;
        let n = rows.len();
        let mut regressors = vec![vec![0.0; n]; self.names.len()];
        regressors[0].clone_from(&terms.added);
        for (column, drag) in regressors[1..].iter_mut().zip(&terms.drag) {
            column.clone_from(drag);
        }
        let mut measured: Vec<f64> = run.force_n[rows.clone()].to_vec();
        if let Some(j) = self.mass[run.body] {
            regressors[j].clone_from(&terms.mass);
        } else {
            measured.iter_mut().zip(&terms.mass).for_each(|(y, mass)| *y -= values.mass_kg[run.body] * mass);
        }
        match self.buoyancy[run.body] {
            Some(j) if run.medium == Medium::Water => regressors[j].clone_from(&terms.buoyancy),
            Some(_) => {}
            None => {
                let declared = self.buoyancy_n(run.body, beta);
                measured.iter_mut().zip(&terms.buoyancy).for_each(|(y, x)| *y -= declared * x);
            }
        }
        if let Some(j) = self.delay {
            let h = TIME_STEP * self.period_s;
            let late = self.force(r, rows.clone(), beta, delay_s + h, &values)?;
            let early = self.force(r, rows.clone(), beta, delay_s - h, &values)?;
            regressors[j] = late.iter().zip(&early).map(|(a, b)| (a - b) / (2.0 * h)).collect();
            // About the last delay, so that the coefficient is the delay itself and takes its prior.
            measured.iter_mut().zip(&regressors[j]).for_each(|(y, x)| *y += delay_s * x);
        }
        let errors = errors.iter().map(|e| self.error_column(*e, r, rows.clone(), beta, delay_s, &values));
        Ok(Columns { regressors, errors: errors.collect::<Result<_, _>>()?, measured })
    }

    /// ∂f/∂q times the standard uncertainty of q.
    fn error_column(
        &self,
        input: Input,
        r: usize,
        rows: std::ops::Range<usize>,
        beta: &[f64],
        delay_s: f64,
        values: &Values,
    ) -> Result<Vec<f64>, OscillationError> {
        let standard = input.standard(self.setup);
        if input == Input::Force {
            // The cell reads (1 + e) of what is there.
            let force = self.force(r, rows, beta, delay_s, values)?;
            return Ok(force.into_iter().map(|f| standard * f).collect());
        }
        let step = input.step(values);
        let at = |by: f64| self.force(r, rows.clone(), beta, delay_s, &input.moved(values, by));
        let (above, below) = (at(step)?, at(-step)?);
        // What is there is made by q + e, what is fitted by q. A gain of the angle is the sensor's: what is there is made by φ/(1 + e).
        let sign = if input == Input::Angle { -1.0 } else { 1.0 };
        Ok(above.iter().zip(&below).map(|(a, b)| sign * standard * (a - b) / (2.0 * step)).collect())
    }

    /// Residuals and zeros of all runs.
    fn fitted(&self, beta: &[f64]) -> Result<Vec<Fitted>, OscillationError> {
        let values = Values::of(self.setup);
        let delay_s = self.delay_s(beta);
        (0..self.runs.len())
            .map(|r| {
                let rows = self.motions[r].samples();
                let force = self.force(r, rows.clone(), beta, delay_s, &values)?;
                let first = rows.start;
                let away = |i: usize| self.runs[r].force_n[i] - force[i - first];
                let used = || self.motions[r].cycles.iter().cloned().flatten();
                let n = self.motions[r].count() as f64;
                let zero_n = used().map(away).sum::<f64>() / n;
                let left: Vec<f64> = used().map(|i| away(i) - zero_n).collect();
                Ok(Fitted {
                    zero_n,
                    residual_rms_n: (left.iter().map(|x| x * x).sum::<f64>() / n).sqrt(),
                    correlation: integrated_time(&left),
                    used: left.len(),
                    force_n: force.iter().map(|f| f + zero_n).collect(),
                })
            })
            .collect()
    }

    fn conclude(&self, beta: &[f64], by_run: bool, effective: f64) -> Result<OscillationFit, OscillationError> {
        let inputs = Input::all(self.setup, self.runs);
        let condensed = self.condense(beta, by_run, &inputs)?;
        let fit = self.least_squares(&condensed, effective, false, beta, None).map_err(|e| self.refused(e))?;
        let p = self.names.len();
        let mut errors = Vec::new();
        // A prior's error moves the coefficients as a shift of its value does.
        let priors = self.priors();
        let used = self.options(effective, &[]).priors;
        for (k, prior) in used.iter().enumerate() {
            let moved = self.least_squares(&condensed, effective, false, beta, Some(k)).map_err(|e| self.refused(e))?;
            let (there, here) = (unbounded(&moved), unbounded(&fit));
            let name =
                priors.iter().find(|(_, p)| p.index == prior.index).map_or_else(String::new, |(name, _)| name.clone());
            let sensitivity = (0..p).map(|j| (there[j] - here[j]) / prior.standard).collect();
            errors.push(DeclaredError { name, standard: prior.standard, dof: f64::INFINITY, sensitivity });
        }
        let of_priors = errors.len();
        for (input, column) in inputs.iter().zip(&condensed.errors) {
            let standard = input.standard(self.setup);
            let moved = |j: usize| column.iter().enumerate().map(|(i, e)| fit.sensitivity[(j, i)] * e).sum::<f64>();
            let sensitivity = (0..p).map(|j| moved(j) / standard).collect();
            errors.push(DeclaredError {
                name: input.name(self.setup),
                standard,
                dof: input.dof(self.setup),
                sensitivity,
            });
        }
        let part_of = |error: &DeclaredError| {
            let move_of = |j: usize| error.sensitivity[j] * error.standard;
            Part {
                name: error.name.clone(),
                shared: "campaign",
                kind: Kind::B,
                covariance: Mat::from_fn(p, p, |i, j| move_of(i) * move_of(j)),
                dof: vec![error.dof; p],
                shape: PartShape::Normal,
                in_scatter: false,
                origin: None,
            }
        };
        let declared: Vec<Part> = errors.iter().map(part_of).collect();
        // The regression takes priors at their stated variance; here they are lines of their own.
        let of_prior =
            |i: usize, j: usize| declared[..of_priors].iter().map(|part| part.covariance[(i, j)]).sum::<f64>();
        let scatter = Mat::from_fn(p, p, |i, j| {
            let left = fit.covariance[(i, j)] - of_prior(i, j);
            if i == j { left.max(0.0) } else { left }
        });
        let clusters = if by_run { self.runs.len() } else { self.motions.iter().map(|m| m.cycles.len()).sum() };
        let by = if by_run { "run" } else { "cycle" };
        let first = Part {
            name: format!("scatter from {by} to {by}"),
            shared: by,
            kind: Kind::A,
            covariance: scatter,
            dof: vec![clusters as f64 - 1.0; p],
            shape: PartShape::Normal,
            in_scatter: false,
            origin: None,
        };
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
        let squares: f64 = fitted.iter().map(|f| f.used as f64 * f.residual_rms_n.powi(2)).sum();
        Ok(OscillationFit {
            law: self.drag.law.name.clone(),
            unknowns,
            parts,
            errors,
            fitted,
            by,
            clusters,
            samples: self.samples,
            effective,
            sigma_n: (squares / self.samples as f64).sqrt(),
            delay_s: self.delay_s(&values(&fit)),
        })
    }
}

/// Coefficients of a fit, zero where they are not determined.
fn values(fit: &ls::Fit) -> Vec<f64> {
    fit.coefficients.iter().map(|c| c.value.unwrap_or(0.0)).collect()
}

/// The same without bounds.
fn unbounded(fit: &ls::Fit) -> Vec<f64> {
    fit.coefficients.iter().map(|c| c.unconstrained.unwrap_or(0.0)).collect()
}

/// n/τ of all runs; a run that is too short to tell counts with the mean τ of the others, and with one sample where none tells.
fn effective_samples(fitted: &[Fitted]) -> f64 {
    let known: Vec<f64> = fitted.iter().filter_map(|f| f.correlation).collect();
    let mean = if known.is_empty() { f64::INFINITY } else { known.iter().sum::<f64>() / known.len() as f64 };
    fitted.iter().map(|f| (f.used as f64 / f.correlation.unwrap_or(mean).max(1.0)).max(1.0)).sum()
}

fn of_body(what: &str, body: &str) -> String {
    if body.is_empty() { what.to_owned() } else { format!("{what} of {body}") }
}

/// A declared number that errs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Input {
    Radius,
    Mass(usize),
    Density,
    Flow,
    Angle,
    Force,
}

impl Input {
    /// Those with an uncertainty.
    pub(super) fn all(setup: &Setup, runs: &[OscillationRun<'_>]) -> Vec<Self> {
        let bodies = 0..setup.bodies.len();
        let in_air = |b: usize| runs.iter().any(|run| run.body == b && run.medium == Medium::Air);
        let masses = bodies.filter(|&b| runs.iter().any(|run| run.body == b) && !in_air(b)).map(Self::Mass);
        [Self::Radius, Self::Density, Self::Flow, Self::Angle, Self::Force]
            .into_iter()
            .chain(masses)
            .filter(|input| input.standard(setup) > 0.0)
            .collect()
    }

    fn standard(self, setup: &Setup) -> f64 {
        match self {
            Self::Radius => setup.radius_m.standard,
            Self::Mass(b) => setup.bodies[b].mass_kg.standard,
            Self::Density => setup.density_kg_m3.standard,
            Self::Flow => setup.flow_relative,
            Self::Angle => setup.angle_relative,
            Self::Force => setup.force_relative,
        }
    }

    pub(super) fn dof(self, setup: &Setup) -> f64 {
        match self {
            Self::Radius => setup.radius_m.dof,
            Self::Mass(b) => setup.bodies[b].mass_kg.dof,
            _ => f64::INFINITY,
        }
    }

    pub(super) fn name(self, setup: &Setup) -> String {
        match self {
            Self::Radius => "radius".to_owned(),
            Self::Mass(b) => of_body("mass", &setup.bodies[b].name),
            Self::Density => "density".to_owned(),
            Self::Flow => "speed of the stream".to_owned(),
            Self::Angle => "gain of the angle".to_owned(),
            Self::Force => "gain of the force".to_owned(),
        }
    }

    /// A small step of it, SI.
    fn step(self, values: &Values) -> f64 {
        match self {
            Self::Radius => STEP * values.radius_m.abs(),
            Self::Density => STEP * values.density_kg_m3,
            // Linear, or of size one.
            _ => STEP,
        }
    }

    fn moved(self, values: &Values, by: f64) -> Values {
        let mut out = values.clone();
        match self {
            Self::Radius => out.radius_m += by,
            Self::Mass(b) => out.mass_kg[b] += by,
            Self::Density => out.density_kg_m3 += by,
            Self::Flow => out.flow_factor += by,
            Self::Angle => out.angle_factor += by,
            Self::Force => {}
        }
        out
    }
}
