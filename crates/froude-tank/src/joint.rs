//! The joint fit in time: what load cells show while a motor moves a body, as known motions times unknown coefficients.
//!
//! y_k(t) = known_k(t − d) + Σ x_kj(t − d) β_j + zero of the run and load + noise, the same β for all runs and loads and the delay d among them. A method states
//! its equation (`Equation`); the fit, its scatter, its budget and its forecast are common.
//!
//! **Several loads.** Those of one run are one cluster. Rows of load k count with the weight s₀√τ₀/(s_k√τ_k), s the standard deviation of what the fit leaves
//! and τ its correlation time, so that the first load keeps the weight one.
//!
//! | module           | what                                                        | source                                |
//! |------------------|-------------------------------------------------------------|---------------------------------------|
//! | `solve`          | coefficients and delay, by Gauss and Newton                 | –                                     |
//! | `conclude`       | their scatter, and what declared errors do                  | Bell & McCaffrey 2002, GUM            |
//! | [`mod@forecast`] | the intervals to expect of a plan                           | Fisher 1922                           |
//! | `findings`       | what is doubtful, whichever the equation                    | –                                     |
//! | `record`, `page` | the parts of record and page that follow from the fit alone | –                                     |

pub(crate) mod conclude;
pub(crate) mod findings;
pub mod forecast;
pub(crate) mod page;
pub(crate) mod record;
pub(crate) mod solve;

use std::ops::Range;

use froude_fit as ls;
use froude_fit::Status;
use froude_fit::budget::{Combined, Kind, Part, Shape, Uncertain};
use froude_fit::faer::Mat;
use froude_records::campaign::{BoundKind, Identify};

use crate::error::TankError;
use crate::motion::Motion;

/// Name of the delay.
pub const DELAY: &str = "delay";

/// What a load is made of, a number for each sample.
#[derive(Debug, Clone)]
pub(crate) struct Terms {
    /// What is not looked for.
    pub known: Vec<f64>,
    /// The factor of each unknown; that of the delay stays zero, it follows from the others.
    pub columns: Vec<Vec<f64>>,
}

impl Terms {
    /// Nothing yet: `n` samples, `unknowns` columns.
    pub fn zero(n: usize, unknowns: usize) -> Self {
        Self { known: vec![0.0; n], columns: vec![vec![0.0; n]; unknowns] }
    }

    /// Puts a term where its unknown stands, or takes it as `declared` times what it is.
    pub fn put(&mut self, unknown: Option<usize>, declared: f64, term: &[f64]) {
        let (column, factor) = match unknown {
            Some(j) => (&mut self.columns[j], 1.0),
            None => (&mut self.known, declared),
        };
        column.iter_mut().zip(term).for_each(|(y, x)| *y += factor * x);
    }

    /// The load, without its zero.
    pub fn load(&self, beta: &[f64]) -> Vec<f64> {
        let mut out = self.known.clone();
        for (column, b) in self.columns.iter().zip(beta) {
            out.iter_mut().zip(column).for_each(|(y, x)| *y += b * x);
        }
        out
    }
}

/// The loads on the cells, by a method's law.
pub(crate) trait Equation {
    /// Each load at samples `rows` of a run, the motion taken `delay_s` earlier than they are stamped; `moved` adds a number to a declared one, by its place
    /// among the errors of the [`Problem`].
    fn terms(
        &self,
        run: usize,
        rows: Range<usize>,
        delay_s: f64,
        moved: Option<(usize, f64)>,
    ) -> Result<Vec<Terms>, TankError>;
}

/// Where a declared error enters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Enters {
    /// A gain of a load, by its place: the cell reads (1 + e) times the true load.
    Load(usize),
    /// A gain of the motion's sensor: the true motion is φ/(1 + e).
    Motion,
    /// A constant of the equation, of this size.
    Constant(f64),
}

/// A declared number that errs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Input {
    /// What it is, in words.
    pub name: String,
    /// Value of no interest; standard uncertainty and its degrees of freedom.
    pub declared: Uncertain,
    /// Where it enters.
    pub enters: Enters,
}

/// One run as the fit takes it.
#[derive(Debug, Clone)]
pub(crate) struct Run<'a> {
    pub id: &'a str,
    pub loads: Vec<&'a [f64]>,
    pub motion: &'a Motion,
}

/// What is known of an unknown beforehand.
#[derive(Debug, Clone)]
pub(crate) struct Known {
    /// What it is, in words.
    pub name: String,
    pub prior: ls::Prior,
    /// Degrees of freedom of its standard uncertainty.
    pub dof: f64,
    /// Inputs of the problem that its value depends on, by index, with the derivatives.
    pub sensitivities: Vec<(usize, f64)>,
}

impl Known {
    pub fn declared(name: String, prior: ls::Prior) -> Self {
        Self { name, prior, dof: f64::INFINITY, sensitivities: Vec::new() }
    }

    /// The derivative of its value by an input.
    pub fn sensitivity_to(&self, input: usize) -> f64 {
        self.sensitivities.iter().filter(|(k, _)| *k == input).map(|(_, by)| by).sum()
    }
}

/// What is looked for, in which runs, and what is known beforehand.
pub(crate) struct Problem<'a, E> {
    pub equation: E,
    /// Name of the law, for messages and priors.
    pub law: String,
    pub runs: Vec<Run<'a>>,
    /// Name and unit of each unknown.
    pub names: Vec<(String, String)>,
    /// Where the fit starts.
    pub start: Vec<f64>,
    /// Where the delay stands, or else what it is, s.
    pub delay: Result<usize, f64>,
    /// Unknowns that the campaign's default bounds are about.
    pub bounded: Vec<usize>,
    /// Unknowns whose loads may change from run to run, those together that change by one fraction.
    pub varying: Vec<Vec<usize>>,
    /// Numbers that are unknowns too: declared, or found by still runs.
    pub priors: Vec<Known>,
    pub inputs: Vec<Input>,
    pub identify: &'a Identify,
}

impl<E> Problem<'_, E> {
    /// Where an unknown stands.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|(n, _)| n == name)
    }

    pub fn delay_s(&self, beta: &[f64]) -> f64 {
        self.delay.map_or_else(|held| held, |j| beta[j])
    }

    pub fn delay_at(&self) -> Option<usize> {
        self.delay.ok()
    }

    pub fn n_loads(&self) -> usize {
        self.runs.first().map_or(0, |run| run.loads.len())
    }

    /// The shortest period.
    pub fn period_s(&self) -> f64 {
        self.runs.iter().map(|run| run.motion.angle.period_s()).fold(f64::INFINITY, f64::min)
    }

    pub fn samples(&self) -> usize {
        self.n_loads() * self.runs.iter().map(|run| run.motion.count()).sum::<usize>()
    }

    /// Whole cycles of all runs.
    pub fn cycles(&self) -> usize {
        self.runs.iter().map(|run| run.motion.cycles.len()).sum()
    }

    /// Unknowns whose value the campaign states.
    pub fn held(&self) -> Vec<(usize, f64)> {
        let fixed = self.identify.fixed.iter().filter_map(|(name, value)| Some((self.position(name)?, *value)));
        fixed.collect()
    }

    /// Unknowns that the campaign takes as zero.
    pub fn excluded(&self) -> Vec<usize> {
        self.identify.exclude.iter().filter_map(|name| self.position(name)).collect()
    }

    /// What is known of the unknowns beforehand: declared numbers, still runs, and priors of the campaign.
    pub fn known(&self) -> Vec<Known> {
        // What is known enters with its uncertainty, as a prior does.
        let stated = self.identify.prior.iter().chain(&self.identify.known);
        let of_campaign = stated.filter(|p| p.model.as_ref().is_none_or(|m| *m == self.law));
        let of_campaign = of_campaign.filter_map(|p| {
            let prior = ls::Prior::new(self.position(&p.coefficient)?, p.value, p.standard_uncertainty);
            Some(Known::declared(format!("prior of {}", p.coefficient), prior))
        });
        let (held, excluded) = (self.held(), self.excluded());
        let is_free = |j: usize| !excluded.contains(&j) && held.iter().all(|(k, _)| *k != j);
        let all = self.priors.iter().cloned().chain(of_campaign);
        all.filter(|known| known.prior.standard > 0.0 && is_free(known.prior.index)).collect()
    }

    pub fn bound(&self, j: usize) -> ls::Bound {
        let named = self.identify.bounds.named.get(&self.names[j].0).copied();
        let usual = if self.bounded.contains(&j) { self.identify.bounds.default } else { BoundKind::None };
        if named.unwrap_or(usual) == BoundKind::NonNegative { ls::Bound::NON_NEGATIVE } else { ls::Bound::FREE }
    }
}

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
    /// As declared, where sources that declare another value do not have the error in common.
    pub value: Option<f64>,
    /// ∂β/∂e.
    pub sensitivity: Vec<f64>,
}

impl DeclaredError {
    /// Its line of the budget.
    #[must_use]
    pub fn part(&self) -> Part {
        let p = self.sensitivity.len();
        let moves = |j: usize| self.sensitivity[j] * self.standard;
        part(&self.name, Kind::B, Mat::from_fn(p, p, |i, j| moves(i) * moves(j)), self.dof)
    }
}

/// A line of a budget that all coefficients share.
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

/// What is left of a load of a run, in the unit of the cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// Zero of the load cell.
    pub zero: f64,
    /// The fitted load from the first sample used to the last, its zero included.
    pub load: Vec<f64>,
    /// Samples used of them.
    pub used: usize,
    /// Root mean square of measured less fitted.
    pub residual_rms: f64,
    /// τ: integrated autocorrelation time of that, samples; `None` where the run is too short to tell.
    pub correlation: Option<f64>,
}

/// Coefficients of all runs by one law.
#[derive(Debug, Clone)]
pub struct JointFit {
    /// The law.
    pub law: String,
    /// The coefficients; among them the delay, where it is not held.
    pub unknowns: Vec<Unknown>,
    /// Scatter first, then each declared error.
    pub parts: Vec<Part>,
    /// The declared errors, in the order of `parts` after the first.
    pub errors: Vec<DeclaredError>,
    /// By run, and by load.
    pub fitted: Vec<Vec<Fitted>>,
    /// What was left out in turn: `run` or `cycle`.
    pub by: &'static str,
    /// Whether the scatter includes what changes from run to run.
    pub has_runs: bool,
    /// Number of runs or cycles that were left out in turn.
    pub clusters: usize,
    /// Whether their scatter is divided by its mean at equal errors, and has its degrees of freedom.
    pub is_scaled: bool,
    /// Samples used, of all loads.
    pub samples: usize,
    /// n/τ.
    pub effective: f64,
    /// Standard deviation of a residual of each load, in the unit of the cell.
    pub sigma: Vec<f64>,
    /// The delay that the motion was taken at, s.
    pub delay_s: f64,
}

impl JointFit {
    /// The coefficient of a name.
    #[must_use]
    pub fn unknown(&self, name: &str) -> Option<&Unknown> {
        self.unknowns.iter().find(|u| u.name == name)
    }

    /// Where it stands.
    #[must_use]
    pub fn position(&self, name: &str) -> Option<usize> {
        self.unknowns.iter().position(|u| u.name == name)
    }
}

/// Correlation of two coefficients; `None` where one of them has no variance.
pub(crate) fn correlation(covariance: &froude_fit::faer::Mat<f64>, i: usize, j: usize) -> Option<f64> {
    let norm = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
    (norm > 0.0).then(|| covariance[(i, j)] / norm)
}
