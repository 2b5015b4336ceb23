//! Non-linear least squares: bounded, with parameters of single runs, and realistic intervals.
//!
//! A [`Model`] gives weighted residuals, measured less modelled, run by run; [`minimise`] looks for the [`Parameter`]s that make their sum of
//! squares least. What comes out of a simulation in time has serially correlated residuals: its intervals are made with a
//! lag, and not as if every sample were new.
//!
//! **Setting.** Parameters shared by all runs, and parameters that move one run alone (its amplitude, its phase); bounds on each; derivatives by
//! the model or by central differences.
//! **Units.** Each parameter in its own; residuals in standard deviations, or in any one unit where σ is estimated.
//!
//! | what                            | function                              | source                                            |
//! |---------------------------------|---------------------------------------|---------------------------------------------------|
//! | minimum                         | [`minimise`]                          | Moré (1978), Lect. Notes Math. 630, 105; Nielsen (1999), IMM-REP-1999-05 (damping) |
//! | end of the iteration            | [`Settings::offset`]                  | Bates & Watts (1981), Technometrics 23, 179       |
//! | parameters of single runs       | eliminated in each step               | Lovell (1963), J. Am. Stat. Assoc. 58, 993        |
//! | standard uncertainty            | [`Solution::covariance`]              | see [`Scatter`]                                   |
//!
//! **Measured.** Seven problems of NIST's, certified to eleven digits: parameters to 1e-7, standard uncertainties to 1e-6 of themselves, from both
//! starts but one; from MGH10's first start the valley is too long, and the report says so. 95 % intervals, 2,000 repetitions: with a
//! lag, one run of 1,000 rows of noise that remembers 0.75 of itself from row to row, 92.2 %: somewhat too short, as such intervals are. On a curved model, a line read on a logarithmic scale, the linear interval covers 87.8 %.
//!
//! Not here: more than one minimum (start from several places), inequalities between parameters, robust losses, second derivatives: where
//! residuals are large and the model strongly curved, steps converge slowly and the covariance is Gauss and Newton's.

mod border;
mod covariance;
mod error;
mod model;
mod point;

use border::{Damping, eliminate};
use point::{Layout, Point, Problem};

use crate::dense::dot;
use crate::report::{End, Report};

pub use crate::nonlinear::model::{Model, Parameter, Settings};
pub use covariance::{Scatter, SharedCovariance};
pub use error::NonlinearError;

/// Damping of the first step, as part of the squared length of each column.
const FIRST_DAMPING: f64 = 1e-3;
/// Beyond this damping a step is lost in rounding.
const MOST_DAMPING: f64 = 1e16;
/// A predicted decrease below this part of the sum of squares is lost in the rounding of its terms.
const ROUNDING: f64 = 1e-12;

/// Weighted residuals over the parameters are a model of one run.
impl<F: Fn(&[f64]) -> Option<Vec<f64>>> Model for F {
    fn runs(&self) -> usize {
        1
    }

    fn residuals(&self, _: usize, theta: &[f64]) -> Option<Vec<f64>> {
        self(theta)
    }
}

/// The best parameters found.
#[derive(Debug, Clone)]
pub struct Solution {
    /// One per parameter, in order.
    pub values: Vec<f64>,
    /// Residuals there, by run.
    pub residuals: Vec<Vec<f64>>,
    /// `−∂r/∂θ` there, by run: a column for each shared parameter, in order, then for each of the run's own. Zero for a fixed one by differences.
    pub columns: Vec<Vec<Vec<f64>>>,
    /// By parameter: whether it is fixed, or rests on a bound beyond which the sum of squares would fall. It is held there in every covariance.
    pub at_bound: Vec<bool>,
    /// Sum of squared residuals.
    pub sum_of_squares: f64,
    /// Residuals less the parameters that they determine.
    pub dof: usize,
    /// How it ended.
    pub report: Report,
    layout: Layout,
}

impl Solution {
    /// Standard deviation of a residual; `None` without degrees of freedom.
    #[must_use]
    pub fn sigma(&self) -> Option<f64> {
        (self.dof > 0).then(|| (self.sum_of_squares / self.dof as f64).sqrt())
    }

    fn point(&self) -> Point {
        Point {
            theta: self.values.clone(),
            residuals: self.residuals.clone(),
            columns: self.columns.clone(),
            sum: self.sum_of_squares,
        }
    }
}

/// Looks for the parameters with the least sum of squared residuals, from their starts downhill.
///
/// A step without progress is not an error: see [`Solution::report`]. Parameters that the data do not determine stay where they drift to and
/// have no standard uncertainty. The same input gives the same bits.
///
/// # Errors
///
/// [`NonlinearError`] when the parameters contradict themselves or the runs, when the model is impossible or not finite at the start, or when
/// it does not keep its lengths.
///
/// # Example
///
/// The decay of a swing, half a radian at first, with a rate of 0.2 per second:
///
/// ```
/// use froude_fit::nonlinear::{Parameter, Settings, minimise};
/// let measured = |t: f64| 0.5 * (-0.2 * t).exp();
/// let residuals = |theta: &[f64]| {
///     Some((0..20).map(f64::from).map(|t| measured(t) - theta[0] * (-theta[1] * t).exp()).collect())
/// };
/// let start = [Parameter::new("amplitude", 1.0, 0.1), Parameter::new("rate", 1.0, 0.1).within(0.0, 10.0)];
/// let found = minimise(&residuals, &start, &Settings::default())?;
/// assert!((found.values[1] - 0.2).abs() < 1e-9);
/// # Ok::<(), froude_fit::nonlinear::NonlinearError>(())
/// ```
pub fn minimise(model: &dyn Model, parameters: &[Parameter], settings: &Settings) -> Result<Solution, NonlinearError> {
    let (problem, mut here) = Problem::new(model, parameters, settings)?;
    let mut lengths = here.lengths(&problem.layout);
    let mut newton = Newton::at(&here, &problem);
    let (mut lambda, mut growth) = (FIRST_DAMPING, 2.0);
    let mut report = Report { end: End::IterationLimit, iterations: 0 };
    while report.iterations < settings.iterations {
        if newton.is_small(&here, &problem, settings) {
            report.end = End::Converged;
            break;
        }
        report.iterations += 1;
        // Moré's scaling: a parameter that once moved the model keeps its hold.
        lengths.iter_mut().zip(here.lengths(&problem.layout)).for_each(|(old, new)| *old = old.max(new));
        let holds: Vec<f64> =
            lengths.iter().zip(parameters).map(|(l, p)| if *l > 0.0 { *l } else { 1.0 / p.scale }).collect();
        let (trial, promised) = bounded_step(&here, &problem, &newton.is_held, Damping { lambda, lengths: &holds });
        let is_rounding = promised <= ROUNDING * here.sum;
        if is_rounding && growth > 2.0 && newton.size > ROUNDING * here.sum {
            // Longer steps did not help, and shorter ones predict no decrease: kinks.
            report.end = End::Stalled;
            break;
        }
        let most = if is_rounding { here.sum * (1.0 + ROUNDING) } else { here.sum };
        // A step into the impossible, or to where no derivative exists, counts as one that does not help.
        let there = problem.residuals(&trial)?.filter(|(_, sum)| *sum < most).and_then(|(residuals, sum)| {
            let columns = problem.columns(&trial, &residuals).ok()?;
            Some(Point { theta: trial, residuals, columns, sum })
        });
        if let Some(there) = there {
            let next = Newton::at(&there, &problem);
            if is_rounding && next.size >= newton.size {
                report.end = End::Converged;
                break;
            }
            let fall = here.sum - there.sum;
            let gain = fall / promised;
            lambda *= if is_rounding { 1.0 / 3.0 } else { (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0) };
            growth = 2.0;
            (here, newton) = (there, next);
            if !is_rounding && newton.is_within_offset(fall, &here, &problem, settings) {
                report.end = End::Converged;
                break;
            }
        } else if lambda > MOST_DAMPING {
            report.end = if newton.size <= ROUNDING * here.sum { End::Converged } else { End::Stalled };
            break;
        } else {
            lambda *= growth;
            growth *= 2.0;
        }
    }
    Ok(Solution {
        dof: problem.rows().saturating_sub(newton.rank),
        at_bound: newton.is_held,
        sum_of_squares: here.sum,
        values: here.theta,
        residuals: here.residuals,
        columns: here.columns,
        report,
        layout: problem.layout,
    })
}

/// The undamped step, inside the bounds that hold.
struct Newton {
    is_held: Vec<bool>,
    step: Vec<f64>,
    /// Square of what it moves the linearised model by.
    size: f64,
    rank: usize,
}

impl Newton {
    fn at(here: &Point, problem: &Problem<'_>) -> Self {
        let is_held = here.held(problem.parameters, &problem.layout);
        let eliminated = eliminate(here, &problem.layout, |j| !is_held[j], &here.residuals, None);
        let step = eliminated.step(here, &problem.layout, &here.residuals);
        let size = here.moved(&problem.layout, &step).iter().map(|m| dot(m, m)).sum();
        Self { is_held, step, size, rank: eliminated.rank() }
    }

    /// Bates and Watts' relative offset: whether squares are less than what the noise makes of them, many times over.
    fn is_within_offset(&self, squares: f64, here: &Point, problem: &Problem<'_>, settings: &Settings) -> bool {
        let dof = problem.rows().saturating_sub(self.rank) as f64;
        let noise = (here.sum - self.size).max(0.0) * self.rank as f64;
        squares * dof <= settings.offset.powi(2) * noise && dof > 0.0
    }

    /// The offset of the full step, or a step that no scale would show.
    fn is_small(&self, here: &Point, problem: &Problem<'_>, settings: &Settings) -> bool {
        self.is_within_offset(self.size, here, problem, settings)
            || self.step.iter().zip(problem.parameters).all(|(s, p)| s.abs() <= settings.step * p.scale)
    }
}

/// A damped step that stays inside the bounds, as new parameters, and the fall of the sum of squares that it promises.
///
/// A parameter that would leave is put on its bound, and the others are solved for again.
fn bounded_step(here: &Point, problem: &Problem<'_>, is_held: &[bool], damping: Damping<'_>) -> (Vec<f64>, f64) {
    let layout = &problem.layout;
    let mut pinned: Vec<Option<f64>> = here.theta.iter().zip(is_held).map(|(&at, held)| held.then_some(at)).collect();
    loop {
        let fixed: Vec<f64> = pinned.iter().zip(&here.theta).map(|(p, at)| p.map_or(0.0, |p| p - at)).collect();
        let shifted = here.moved(layout, &fixed);
        let target: Vec<Vec<f64>> =
            (here.residuals.iter().zip(&shifted)).map(|(r, s)| r.iter().zip(s).map(|(r, s)| r - s).collect()).collect();
        let free = eliminate(here, layout, |j| pinned[j].is_none(), &target, Some(damping)).step(here, layout, &target);
        let trial: Vec<f64> =
            pinned.iter().zip(&free).zip(&here.theta).map(|((p, s), at)| p.unwrap_or(at + s)).collect();
        let mut is_inside = true;
        for (j, p) in problem.parameters.iter().enumerate() {
            if !(p.lower..=p.upper).contains(&trial[j]) && pinned[j].is_none() {
                pinned[j] = Some(if trial[j] < p.lower { p.lower } else { p.upper.min(trial[j].max(p.lower)) });
                is_inside = false;
            }
        }
        if is_inside {
            let step: Vec<f64> = fixed.iter().zip(&free).map(|(a, b)| a + b).collect();
            let promised =
                (here.moved(layout, &step).iter().zip(&here.residuals)).map(|(m, r)| 2.0 * dot(m, r) - dot(m, m)).sum();
            return (trial, promised);
        }
    }
}
