//! The equation of motion fitted to the whole of each release.
//!
//! Unknown are A, D_I and D_II of each release, its position and speed at the first sample used and its rest position; the answer is the mean over
//! the releases. One fit to all of them would be out of phase with each where A is not quite the same in all (3 % of it from release to release made
//! D_I 3 % too large and its interval cover 83 %). With one release or two there is one fit, and the scatter is that of the samples. The sum of squares of
//! position less simulated position is made least (Gauss and Newton with derivatives along the motion; start from the envelope). No
//! linearisation, no small damping: what is left is noise where the law holds.
//!
//! **Source.** Ljung (1999), System Identification, 4.3 and 7.2 (output error).

use froude_fit::End;
use froude_fit::budget::jackknife;
use froude_fit::faer::Mat;
use froude_fit::nonlinear::{Model, Parameter, Scatter as Noise, Settings, Solution, minimise};
use froude_records::text::counted;

use super::envelope::{FEWEST_RUNS, Reduced};
use super::error::DecayError;
use super::findings;
use super::fit::{DecayFit, Method, RunSummary, Scatter};
use super::local::Quartic;
use super::motion::Motion;
use super::pool::EIGHT_OVER_3_PI;
use super::run::{DecayRun, DecaySetup};
use super::swings::Swings;

/// Shared parameters: A, D_I, D_II.
const SHARED: usize = 3;
/// Those of a release: position and speed at its first sample, rest position.
const OWN: usize = 3;
/// A natural step of a parameter, as part of what it is compared with.
const NATURAL: f64 = 0.01;

/// The releases as the solver sees them.
#[derive(Clone, Copy)]
struct Releases<'a> {
    runs: &'a [(DecayRun<'a>, Swings)],
    inertia: f64,
    stiffness: f64,
}

impl Releases<'_> {
    /// Motion and start of a run; `None` without inertia.
    fn motion(&self, run: usize, theta: &[f64]) -> Option<(Motion, [f64; 2])> {
        let [added, linear, quadratic] = [theta[0], theta[1], theta[2]];
        let moving = self.inertia + added;
        let [q, v, rest] = std::array::from_fn(|k| theta[SHARED + OWN * run + k]);
        (moving > 0.0).then(|| {
            let motion = Motion {
                omega2: self.stiffness / moving,
                linear: linear / moving,
                quadratic: quadratic / moving,
                coulomb: 0.0,
                rest,
            };
            (motion, [q, v])
        })
    }

    /// Measured positions of a run.
    fn measured(&self, run: usize) -> (&[f64], f64) {
        let (run, swings) = &self.runs[run];
        let [first, end] = swings.samples;
        (&run.position[first..end], run.step_s())
    }
}

impl Model for Releases<'_> {
    fn runs(&self) -> usize {
        self.runs.len()
    }

    fn residuals(&self, run: usize, theta: &[f64]) -> Option<Vec<f64>> {
        let (motion, start) = self.motion(run, theta)?;
        let (measured, step_s) = self.measured(run);
        let path = motion.path(start, step_s, measured.len())?;
        Some(measured.iter().zip(path).map(|(q, [simulated, _])| q - simulated).collect())
    }

    fn derivatives(&self, run: usize, theta: &[f64]) -> Option<Vec<Vec<f64>>> {
        let (motion, start) = self.motion(run, theta)?;
        let (measured, step_s) = self.measured(run);
        let path = motion.path_and_derivatives(start, step_s, measured.len())?;
        let moving = self.inertia + theta[0];
        let column = |of: &dyn Fn(&[f64; 6]) -> f64| path.iter().map(|(_, by)| -of(by)).collect::<Vec<f64>>();
        let Motion { omega2, linear, quadratic, .. } = motion;
        let mut out = vec![Vec::new(); theta.len()];
        out[0] = column(&|by| -(omega2 * by[0] + linear * by[1] + quadratic * by[2]) / moving);
        out[1] = column(&|by| by[1] / moving);
        out[2] = column(&|by| by[2] / moving);
        for (k, which) in [4, 5, 3].into_iter().enumerate() {
            out[SHARED + OWN * run + k] = column(&|by| by[which]);
        }
        Some(out)
    }
}

/// Added mass and damping by fitting the equation of motion.
///
/// Releases of any length; those without three half cycles are left out with a finding.
///
/// # Errors
///
/// [`DecayError`]: as for the envelope, and [`DecayError::Fit`] where the search does not start.
pub fn output_error(runs: &[DecayRun<'_>], setup: &DecaySetup) -> Result<DecayFit, DecayError> {
    let reduced = Reduced::of(runs, setup)?;
    let n = reduced.runs.len();
    // Each release by itself: with one added mass for all, a release that swings a little faster would be out of phase, and that looks like damping.
    let groups: Vec<[usize; 2]> = if n >= FEWEST_RUNS { (0..n).map(|i| [i, i + 1]).collect() } else { vec![[0, n]] };
    let found = groups.iter().map(|group| solve(&reduced, setup, *group)).collect::<Result<Vec<Solution>, _>>()?;
    let values = std::array::from_fn(|j| found.iter().map(|s| s.values[j]).sum::<f64>() / found.len() as f64);
    let [by_inertia, by_stiffness] = DecayFit::by_declared(setup, values);
    let residuals: Vec<Vec<f64>> = found.iter().flat_map(|s| s.residuals.iter().cloned()).collect();
    let own: Vec<f64> = found.iter().flat_map(|s| s.values[SHARED..].iter().copied()).collect();
    let summary = |(i, (run, swings)): (usize, &(DecayRun<'_>, Swings))| {
        let [first, end] = swings.samples;
        let [q, v, rest] = std::array::from_fn(|k| own[OWN * i + k]);
        let residuals = &residuals[i];
        RunSummary {
            id: run.id.to_owned(),
            samples: end - first,
            half_cycles: swings.half_cycles(),
            from_s: run.time_s[first],
            start: [q, v],
            rest,
            noise: swings.noise,
            residual_rms: (residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len() as f64).sqrt(),
        }
    };
    let mut range = reduced.range();
    range.period_s = std::f64::consts::TAU / (setup.stiffness.value / (setup.inertia.value + values[0])).sqrt();
    let mut fit = DecayFit {
        method: Method::OutputError,
        axis: setup.axis,
        names: setup.axis.names(),
        values,
        type_a: scatter(&found, n),
        inertia: setup.inertia,
        stiffness: setup.stiffness,
        by_inertia,
        by_stiffness,
        range,
        rows: reduced.rows(setup),
        runs: reduced.runs.iter().enumerate().map(summary).collect(),
        findings: Vec::new(),
    };
    fit.findings = findings::common(&reduced, &fit, setup);
    fit.findings.extend(findings::of_residuals(&fit, &residuals, &reduced));
    let unsettled = found.iter().map(|s| s.report).find(|report| report.end != End::Converged);
    fit.findings.extend(unsettled.map(findings::not_converged));
    Ok(fit)
}

/// Some releases fitted together.
fn solve(reduced: &Reduced<'_>, setup: &DecaySetup, [from, to]: [usize; 2]) -> Result<Solution, DecayError> {
    let runs = &reduced.runs[from..to];
    let model = Releases { runs, inertia: setup.inertia.value, stiffness: setup.stiffness.value };
    let parameters = start(reduced, setup, runs);
    minimise(&model, &parameters, &Settings::default()).map_err(|e| DecayError::Fit(e.to_string()))
}

/// Where the search starts: the envelope's coefficients, and each release as its first samples show it.
fn start(reduced: &Reduced<'_>, setup: &DecaySetup, runs: &[(DecayRun<'_>, Swings)]) -> Vec<Parameter> {
    let [added, linear, quadratic] = reduced.pooled.values;
    let omega = reduced.pooled.omega_n;
    let moving = setup.stiffness.value / (omega * omega);
    let speed = reduced.range().speed[1];
    let [name_a, name_i, name_ii] = setup.axis.names();
    let mut out = vec![
        Parameter::new(name_a, added, NATURAL * moving),
        Parameter::new(name_i, linear, NATURAL * moving * omega),
        Parameter::new(name_ii, quadratic, NATURAL * moving * omega / (EIGHT_OVER_3_PI * speed)),
    ];
    for (i, (run, swings)) in runs.iter().enumerate() {
        let [first, end] = swings.samples;
        let from_s = run.time_s[first];
        let half_s = 0.75 / omega;
        let (time_s, position) = (&run.time_s[first..end], &run.position[first..end]);
        let [q, v] = Quartic::about(time_s, position, from_s + half_s, half_s)
            .map_or([swings.passages[0].position, swings.passages[0].slope], |near| near.value_and_slope(from_s));
        let reach = NATURAL * swings.amplitude(0);
        out.push(Parameter::new(format!("position of release {}", i + 1), q, reach).of_run(i));
        out.push(Parameter::new(format!("speed of release {}", i + 1), v, reach * omega).of_run(i));
        out.push(Parameter::new(format!("rest of release {}", i + 1), swings.rest, reach).of_run(i));
    }
    out
}

/// Type A: over releases where there are enough, else over the samples with their correlation.
fn scatter(found: &[Solution], n: usize) -> Option<Scatter> {
    if n >= FEWEST_RUNS {
        let mean = |j: usize, g: usize| {
            let others = found.iter().enumerate().filter(|(i, _)| *i != g).map(|(_, s)| s.values[j]);
            others.sum::<f64>() / (n - 1) as f64
        };
        let (covariance, dof) = jackknife(n, |g| Some((0..SHARED).map(|j| mean(j, g)).collect()))?;
        return Some(Scatter { covariance, dof: [dof; 3], kind: format!("jackknife over {n} runs"), shared: "run" });
    }
    let covariance = found.first()?.covariance(Noise::Serial { lag: None }).ok()?;
    let mut matrix = Mat::zeros(SHARED, SHARED);
    for i in 0..SHARED {
        for j in 0..SHARED {
            matrix[(i, j)] = covariance.covariance(i, j)?;
        }
    }
    let lag = covariance.lag.unwrap_or(0);
    let kind = format!("samples of {}, correlated over {lag} of them", counted(n, "run", "runs"));
    Some(Scatter { covariance: matrix, dof: [covariance.dof; 3], kind, shared: "sample" })
}
