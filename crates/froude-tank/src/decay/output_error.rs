//! The equation of motion fitted to the whole of each release.
//!
//! Unknown are D_I and D_II of all releases, and for each its own A, its position and speed at the first sample used, and its rest position; the
//! answer has the mean of A. (With one A for all, a release that swings a little faster is out of phase with the fit, and that looks like damping:
//! 3 % of A from release to release made D_I 3 % too large and its interval cover 83 %.) With one release or two A is one, and the scatter is that
//! of the samples. The sum of squares of position less simulated position is made least (Gauss and Newton with derivatives along the motion; start
//! from the envelope). No
//! linearisation, no small damping: what is left is noise where the law holds.
//!
//! **Source.** Ljung (1999), System Identification, 4.3 and 7.2 (output error).

use froude_fit::End;
use froude_fit::budget::jackknife;
use froude_fit::faer::Mat;
use froude_fit::nonlinear::{Model, Parameter, Scatter as Noise, Settings, Solution, minimise};
use froude_records::text::counted;

use super::error::DecayError;
use super::findings;
use super::fit::{DecayFit, Method, RunSummary, Scatter, declared};
use super::local::Quartic;
use super::motion::Motion;
use super::pool::EIGHT_OVER_3_PI;
use super::run::{DecayRun, DecaySetup};
use super::swings::Swings;
use crate::decay::reduced::{FEWEST_RUNS, Reduced};

/// A, D_I, D_II.
const SOUGHT: usize = 3;
/// Of a release: position and speed at its first sample, rest position.
const START: usize = 3;
/// Runs whose scatter is known well enough by leaving out each.
const ENOUGH_RUNS: usize = 5;
/// A natural step of a parameter, as part of what it is compared with.
const NATURAL: f64 = 0.01;

/// The releases as the solver sees them. θ is A where it is shared, D_I, D_II, then of each release its A where that is its own, and its start.
#[derive(Clone, Copy)]
struct Releases<'a> {
    runs: &'a [(DecayRun<'a>, Swings)],
    inertia: f64,
    stiffness: f64,
    /// Whether that is the slope of a sine.
    is_pendulum: bool,
    /// Whether each release has an added mass of its own.
    has_own: bool,
}

impl<'a> Releases<'a> {
    fn of(reduced: &'a Reduced<'a>, setup: &DecaySetup) -> Self {
        Self {
            runs: &reduced.runs,
            inertia: setup.inertia.value,
            stiffness: setup.restoring.stiffness(),
            is_pendulum: setup.restoring.is_pendulum(),
            has_own: reduced.runs.len() >= FEWEST_RUNS,
        }
    }

    /// How many parameters all releases share.
    fn shared(&self) -> usize {
        SOUGHT - usize::from(self.has_own)
    }

    /// Where the added mass of a run stands, where D_I does (D_II follows), and where the run's start does.
    fn places(&self, run: usize) -> [usize; 3] {
        let own = self.shared() + (START + usize::from(self.has_own)) * run;
        if self.has_own { [own, 0, own + 1] } else { [0, 1, own] }
    }

    /// A (the mean over the releases), D_I and D_II.
    fn sought(&self, theta: &[f64]) -> [f64; SOUGHT] {
        let n = self.runs.len();
        let added = (0..n).map(|run| theta[self.places(run)[0]]).sum::<f64>() / n as f64;
        let damping = self.places(0)[1];
        [added, theta[damping], theta[damping + 1]]
    }

    /// Position and speed of a run at its first sample, and its rest position.
    fn start(&self, run: usize, theta: &[f64]) -> [f64; START] {
        std::array::from_fn(|k| theta[self.places(run)[2] + k])
    }

    /// Motion and start of a run; `None` without inertia.
    fn motion(&self, run: usize, theta: &[f64]) -> Option<(Motion, [f64; 2])> {
        let [added, damping, _] = self.places(run);
        let moving = self.inertia + theta[added];
        let [q, v, rest] = self.start(run, theta);
        (moving > 0.0).then(|| {
            let motion = Motion {
                omega2: self.stiffness / moving,
                linear: theta[damping] / moving,
                quadratic: theta[damping + 1] / moving,
                coulomb: 0.0,
                rest,
                is_pendulum: self.is_pendulum,
            };
            (motion, [q, v])
        })
    }

    /// Measured positions of a run, and their times.
    fn measured(&self, run: usize) -> (&[f64], &[f64]) {
        let (run, swings) = &self.runs[run];
        let [first, end] = swings.samples;
        (&run.position[first..end], &run.time_s[first..end])
    }
}

impl Model for Releases<'_> {
    fn runs(&self) -> usize {
        self.runs.len()
    }

    fn residuals(&self, run: usize, theta: &[f64]) -> Option<Vec<f64>> {
        let (motion, start) = self.motion(run, theta)?;
        let (measured, time_s) = self.measured(run);
        let path = motion.path(start, time_s)?;
        Some(measured.iter().zip(path).map(|(q, [simulated, _])| q - simulated).collect())
    }

    fn derivatives(&self, run: usize, theta: &[f64]) -> Option<Vec<Vec<f64>>> {
        let (motion, start) = self.motion(run, theta)?;
        let (_, time_s) = self.measured(run);
        let path = motion.path_and_derivatives(start, time_s)?;
        let [added, damping, own] = self.places(run);
        let moving = self.inertia + theta[added];
        let column = |of: &dyn Fn(&[f64; 6]) -> f64| path.iter().map(|(_, by)| -of(by)).collect::<Vec<f64>>();
        let Motion { omega2, linear, quadratic, .. } = motion;
        let mut out = vec![Vec::new(); theta.len()];
        out[added] = column(&|by| -(omega2 * by[0] + linear * by[1] + quadratic * by[2]) / moving);
        out[damping] = column(&|by| by[1] / moving);
        out[damping + 1] = column(&|by| by[2] / moving);
        for (k, which) in [4, 5, 3].into_iter().enumerate() {
            out[own + k] = column(&|by| by[which]);
        }
        Some(out)
    }
}

/// Added mass and damping by fitting the equation of motion.
///
/// Releases of any length; those with fewer than two peaks are left out with a finding.
///
/// # Errors
///
/// [`DecayError`]: as for the envelope, and where the search does not start.
pub fn output_error(runs: &[DecayRun<'_>], setup: &DecaySetup) -> Result<DecayFit, DecayError> {
    let reduced = Reduced::of(runs, setup, Method::OutputError)?;
    let model = Releases::of(&reduced, setup);
    let parameters = start(&reduced, setup, &model);
    let found = minimise(&model, &parameters, &Settings::default()).map_err(|e| DecayError::of_fit(&e.to_string()))?;
    let values = model.sought(&found.values);
    let summary = |(i, (run, swings)): (usize, &(DecayRun<'_>, Swings))| {
        let [first, end] = swings.samples;
        let [q, v, rest] = model.start(i, &found.values);
        let residuals = &found.residuals[i];
        let [period_s, by_period] = swings.period_and_added(setup);
        RunSummary {
            id: run.id.to_owned(),
            samples: end - first,
            half_cycles: swings.half_cycles(),
            from_s: run.time_s[first],
            start: [q, v],
            rest,
            turns: swings.about(rest),
            period_s,
            added: if model.has_own { found.values[model.places(i)[0]] } else { by_period },
            noise: swings.noise,
            residual_rms: (residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len() as f64).sqrt(),
            fitted: run.position[first..end].iter().zip(residuals).map(|(q, r)| q - r).collect(),
        }
    };
    let mut fit = DecayFit {
        method: Method::OutputError,
        axis: setup.axis,
        names: setup.names(),
        values,
        type_a: scatter(&model, &parameters, &found),
        inertia: setup.inertia,
        restoring: setup.restoring,
        errors: declared(setup, values),
        range: reduced.range((setup.restoring.stiffness() / (setup.inertia.value + values[0])).sqrt()),
        rows: reduced.rows(setup, values),
        runs: reduced.runs.iter().enumerate().map(summary).collect(),
        findings: Vec::new(),
    };
    reach_of_releases(&mut fit, &reduced);
    fit.findings = findings::common(&reduced, &fit, setup);
    fit.findings.extend(findings::of_residuals(&fit, &found.residuals, &reduced));
    if found.report.end != End::Converged {
        fit.findings.push(findings::not_converged(found.report));
    }
    Ok(fit)
}

/// A release that is used before its first passage reaches further and goes faster there than any half cycle after it.
fn reach_of_releases(fit: &mut DecayFit, reduced: &Reduced<'_>) {
    for (summary, (run, swings)) in fit.runs.iter().zip(&reduced.runs) {
        if summary.from_s >= swings.passages[0].time_s - run.step_s() {
            continue;
        }
        let [furthest, fastest] = [&mut fit.range.amplitude[1], &mut fit.range.speed[1]];
        let time_s = &run.time_s[swings.samples[0]..swings.samples[1]];
        for (pair, t) in summary.fitted.windows(2).zip(time_s.windows(2)) {
            *furthest = furthest.max((pair[0] - summary.rest).abs());
            *fastest = fastest.max((pair[1] - pair[0]).abs() / (t[1] - t[0]));
        }
    }
}

/// The fit of releases at its end, for a plan.
pub(super) struct Linearised {
    /// A, D_I and D_II there.
    pub values: [f64; SOUGHT],
    /// How many parameters there are.
    pub parameters: usize,
    /// Derivatives of each used release's samples by each parameter; empty by those of others.
    pub derivatives: Vec<Vec<Vec<f64>>>,
    /// A, D_I and D_II by the parameters: A is a mean where each release has its own.
    pub sought: [Vec<f64>; SOUGHT],
    /// Degrees of freedom of the scatter that the fit will state.
    pub dof: f64,
    /// Releases used, each with its peaks.
    pub used: Vec<(String, usize)>,
    /// The others.
    pub left_out: Vec<DecayError>,
}

/// The same fit, linearised where it ends.
pub(super) fn linearised(runs: &[DecayRun<'_>], setup: &DecaySetup) -> Result<Linearised, DecayError> {
    let reduced = Reduced::of(runs, setup, Method::OutputError)?;
    let model = Releases::of(&reduced, setup);
    let parameters = start(&reduced, setup, &model);
    let found = minimise(&model, &parameters, &Settings::default()).map_err(|e| DecayError::of_fit(&e.to_string()))?;
    let n = model.runs.len();
    let grown = || DecayError::of_fit("the motion of the truth grows beyond all numbers");
    let derivatives = (0..n).map(|run| model.derivatives(run, &found.values).ok_or_else(grown));
    let mut sought: [Vec<f64>; SOUGHT] = std::array::from_fn(|_| vec![0.0; parameters.len()]);
    let share = if model.has_own { 1.0 / n as f64 } else { 1.0 };
    for run in 0..if model.has_own { n } else { 1 } {
        sought[0][model.places(run)[0]] = share;
    }
    let damping = model.places(0)[1];
    sought[1][damping] = 1.0;
    sought[2][damping + 1] = 1.0;
    let samples: usize = (0..n).map(|run| model.measured(run).0.len()).sum();
    Ok(Linearised {
        values: model.sought(&found.values),
        parameters: parameters.len(),
        derivatives: derivatives.collect::<Result<_, _>>()?,
        sought,
        dof: if model.has_own { n as f64 - 1.0 } else { samples as f64 - parameters.len() as f64 },
        used: reduced.runs.iter().map(|(run, swings)| (run.id.to_owned(), swings.turns.len())).collect(),
        left_out: reduced.left_out.clone(),
    })
}

/// Where the search starts: the coefficients of the first stage, and each release as its first samples show it.
fn start(reduced: &Reduced<'_>, setup: &DecaySetup, model: &Releases<'_>) -> Vec<Parameter> {
    let [added, linear, quadratic] = reduced.start(setup);
    let moving = setup.inertia.value + added;
    let omega = (setup.restoring.stiffness() / moving).sqrt();
    let speed = reduced.range(omega).speed[1];
    let [name_a, name_i, name_ii] = setup.names();
    let mut out = vec![
        Parameter::new(name_i, linear, NATURAL * moving * omega),
        Parameter::new(name_ii, quadratic, NATURAL * moving * omega / (EIGHT_OVER_3_PI * speed)),
    ];
    if !model.has_own {
        out.insert(0, Parameter::new(name_a.as_str(), added, NATURAL * moving));
    }
    for (i, (run, swings)) in model.runs.iter().enumerate() {
        let [first, end] = swings.samples;
        let from_s = run.time_s[first];
        let half_s = 0.75 / omega;
        let (time_s, position) = (&run.time_s[first..end], &run.position[first..end]);
        let [q, v] = Quartic::about(time_s, position, from_s + half_s, half_s)
            .map_or([swings.passages[0].position, swings.passages[0].slope], |near| near.value_and_slope(from_s));
        let reach = NATURAL * swings.amplitude(0);
        if model.has_own {
            out.push(Parameter::new(format!("{name_a} of release {}", i + 1), added, NATURAL * moving).of_run(i));
        }
        out.push(Parameter::new(format!("position of release {}", i + 1), q, reach).of_run(i));
        out.push(Parameter::new(format!("speed of release {}", i + 1), v, reach * omega).of_run(i));
        out.push(Parameter::new(format!("rest of release {}", i + 1), swings.rest, reach).of_run(i));
    }
    out
}

/// Type A: over releases where there are enough, each left out in truth; else over the samples with their correlation. Of three or four releases the scatter of damping is no less than the latter: releases that happen to agree say little of
/// their scatter, and the noise of their samples is known far better.
fn scatter(model: &Releases<'_>, parameters: &[Parameter], found: &Solution) -> Option<Scatter> {
    let n = model.runs.len();
    if !model.has_own {
        return of_samples(model, found);
    }
    let (covariance, dof) = jackknife(n, |g| without(model, parameters, found, g))?;
    let own = Scatter { covariance, dof: [dof; 3], kind: format!("jackknife over {n} runs"), shared: "run" };
    Some(match of_samples(model, found).filter(|_| n < ENOUGH_RUNS) {
        Some(samples) => own.at_least(&samples),
        None => own,
    })
}

/// What the samples alone make of the coefficients; not a number for A where each release has its own.
fn of_samples(model: &Releases<'_>, found: &Solution) -> Option<Scatter> {
    let covariance = found.covariance(Noise::Serial { lag: None }).ok()?;
    let mut matrix = Mat::from_fn(SOUGHT, SOUGHT, |_, _| f64::NAN);
    let first = usize::from(model.has_own);
    for i in first..SOUGHT {
        for j in first..SOUGHT {
            matrix[(i, j)] = covariance.covariance(i - first, j - first)?;
        }
    }
    let lag = covariance.lag.unwrap_or(0);
    let kind = format!("samples of {}, correlated over {lag} of them", counted(model.runs.len(), "run", "runs"));
    Some(Scatter { covariance: matrix, dof: [covariance.dof; 3], kind, shared: "sample" })
}

/// What is sought without a release.
fn without(model: &Releases<'_>, parameters: &[Parameter], found: &Solution, left_out: usize) -> Option<Vec<f64>> {
    let kept: Vec<usize> = (0..model.runs.len()).filter(|i| *i != left_out).collect();
    let runs: Vec<_> = kept.iter().map(|&i| model.runs[i].clone()).collect();
    let started = |index: usize| Parameter { start: found.values[index], ..parameters[index].clone() };
    let mut of_rest: Vec<Parameter> = (0..model.shared()).map(started).collect();
    let own = START + usize::from(model.has_own);
    for (i, old) in kept.into_iter().enumerate() {
        of_rest.extend((0..own).map(|k| started(model.shared() + own * old + k).of_run(i)));
    }
    let rest = Releases { runs: &runs, ..*model };
    minimise(&rest, &of_rest, &Settings::default()).ok().map(|s| rest.sought(&s.values).to_vec())
}
