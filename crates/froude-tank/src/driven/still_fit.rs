//! Still runs: the body held at several positions shows a constant of the equation before anything moves.
//!
//! The load cell is zeroed once for a configuration, so that the mean load of its still run i is y_i = z + w_i + x(φ_i) B with one zero z; x comes from the method's
//! own equation at rest (−sin φ for the net buoyancy), w is the drift of the zero, a random walk of step d in the order of the runs. B is the slope by generalised
//! least squares with
//!
//! Ω_ij = (2 τ s²/T_i + q²/12) δ_ij + d² min(i, j),  i, j = 0, 1, …
//!
//! s and τ (s): standard deviation and integrated correlation time of the load within runs of T_i seconds, from all still runs together; q: step of the readings,
//! where the noise is smaller. The gains of load and motion are those of the runs in motion: B shifts with them by ∂B/∂g, and what is fitted with it does, too.
//!
//! **Units.** SI. **Source.** USR eq. 20 and 21, with a free zero. The degrees of freedom of a correlation time summed over w lags are n/(2w + 1): Madras & Sokal
//! (1988), J. Stat. Phys. 50, 109. Resolution: JCGM 100:2008 (GUM), F.2.2.1.

use froude_fit::autocorrelation::integrated_time_about_mean;
use froude_fit::distribution::chi_squared_upper;
use froude_fit::faer::Mat;
use froude_identify::dataset::distinct;
use froude_records::campaign::SensorSpec;
use froude_records::number::significant;
use froude_records::run::Role;
use froude_records::text::counted;

use super::method::MotorDriven;
use super::run::Run;
use super::setup::Setup;
use super::spec::{Enters, Factor, Point};
use super::still_run::{Fitted, Noise, StillFit, StillRun};
use crate::error::TankError;
use crate::inverted::inverted;

/// A still run lasts for so many correlation times of its load.
const MIN_CORRELATION_TIMES: f64 = 10.0;
/// Lags over which a correlation is summed, in both directions, per correlation time.
const LAGS: f64 = 4.0;
/// Largest standard deviation of the position of a body held still, rad or m: half a degree.
const MAX_POSITION_STD: f64 = 0.0087;
/// Least span of the factor x.
const MIN_FACTOR_SPAN: f64 = 0.02;
/// Largest difference between the rates of still runs, as a part.
const ONE_RATE: f64 = 0.01;
/// Step of differences by a gain.
const STEP: f64 = 1e-5;

/// Whether a run is still.
pub(super) fn is_still(point: &Point) -> bool {
    point.role == Role::Still
}

/// What still runs show of the constants of a setup, a fit for each configuration.
///
/// # Errors
///
/// Nobody says how the cell was zeroed; a run that moves, is too short or has another rate; one position alone.
pub fn fit_still_runs<M: MotorDriven>(runs: &[Run<'_>], setup: &Setup<M>) -> Result<Vec<StillFit>, TankError> {
    if runs.is_empty() {
        return Ok(Vec::new());
    }
    let stills = runs.iter().map(still_run::<M>).collect::<Result<Vec<_>, _>>()?;
    let noise = noise(runs, &stills)?;
    check_durations(&stills, noise)?;
    fits(&stills, noise, setup)
}

/// The same of planned runs without noise, with that of the sensor.
pub(super) fn planned<M: MotorDriven>(
    runs: &[Run<'_>],
    setup: &Setup<M>,
    sensor: Option<&SensorSpec>,
) -> Result<Vec<StillFit>, TankError> {
    let stills = runs.iter().map(still_run::<M>).collect::<Result<Vec<_>, _>>()?;
    let Some(interval_s) = one_interval_s(runs)? else { return Ok(Vec::new()) };
    let (sigma, step) = (sensor.and_then(|s| s.noise).unwrap_or(0.0), sensor.and_then(|s| s.resolution).unwrap_or(0.0));
    let keep = sensor.and_then(|s| s.correlation_s).map_or(0.0, |time| (-interval_s / time).exp());
    let correlated = (1.0 + keep) / (1.0 - keep);
    let samples: f64 = runs.iter().map(|run| run.time_s.len() as f64).sum();
    let noise = Noise {
        variance_times_s: sigma * sigma * correlated * interval_s,
        of_resolution: if sigma < step { step * step / 12.0 } else { 0.0 },
        correlated_s: correlated * interval_s,
        dof: samples / (LAGS * correlated + 1.0),
    };
    check_durations(&stills, noise)?;
    fits(&stills, noise, setup)
}

fn still_run<M: MotorDriven>(run: &Run<'_>) -> Result<StillRun, TankError> {
    let position = mean(run.motion);
    let spread = mean(&run.motion.iter().map(|x| (x - position).powi(2)).collect::<Vec<_>>()).sqrt();
    if spread > MAX_POSITION_STD {
        let motion = M::SPEC.motion;
        return Err(TankError::new(format!(
            "still run {:?} moves: the standard deviation of the {} is {} {}, and {} at most is a body held still; log each still run at one position, and cut the approach",
            run.id,
            motion.name,
            significant(spread, 2),
            motion.unit,
            MAX_POSITION_STD
        )));
    }
    let duration_s = run.time_s.last().zip(run.time_s.first()).map_or(0.0, |(b, a)| b - a);
    Ok(StillRun { point: run.point.clone(), position, load: mean(run.loads[0]), duration_s })
}

/// The interval between samples, s, which all runs share; `None` without runs.
fn one_interval_s(runs: &[Run<'_>]) -> Result<Option<f64>, TankError> {
    let interval = |run: &Run<'_>| match run.time_s {
        [first, .., last] => (last - first) / (run.time_s.len() - 1) as f64,
        _ => 0.0,
    };
    let Some(first_s) = runs.first().map(interval) else { return Ok(None) };
    match runs.iter().find(|run| (interval(run) / first_s - 1.0).abs() > ONE_RATE) {
        Some(other) => Err(TankError::new(format!(
            "still run {:?} is sampled at {} Hz and still run {:?} at {} Hz: use one rate, because the noise is estimated from all still runs together",
            other.id,
            significant(1.0 / interval(other), 3),
            runs[0].id,
            significant(1.0 / first_s, 3)
        ))),
        None => Ok(Some(first_s)),
    }
}

/// The noise within the runs, from all of them together.
fn noise(runs: &[Run<'_>], stills: &[StillRun]) -> Result<Noise, TankError> {
    let interval_s = one_interval_s(runs)?.unwrap_or(0.0);
    // One record of all runs, each about its own mean: the few products across their ends vanish in the mean.
    let of = |(run, still): (&Run<'_>, &StillRun)| run.loads[0].iter().map(|f| f - still.load).collect::<Vec<_>>();
    let left: Vec<f64> = runs.iter().zip(stills).flat_map(of).collect();
    let (n, n_run) = (left.len() as f64, left.len() as f64 / runs.len() as f64);
    let in_record = 2.0 * integrated_time_about_mean(&left);
    // Each run's mean takes part of the correlation: 2w/n of it in a window of w lags.
    let correlated = in_record / (1.0 - LAGS * in_record / n_run).max(0.5);
    let variance = left.iter().map(|x| x * x).sum::<f64>() / (n - correlated * runs.len() as f64).max(1.0);
    let steps = runs.iter().flat_map(|run| run.loads[0].windows(2).map(|pair| (pair[1] - pair[0]).abs()));
    let step = steps.filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
    if step.is_infinite() {
        return Err(TankError::new(
            "the load of the still runs does not change from sample to sample: log it with the resolution that shows its noise",
        ));
    }
    Ok(Noise {
        variance_times_s: variance * correlated * interval_s,
        of_resolution: if variance.sqrt() < step { step * step / 12.0 } else { 0.0 },
        correlated_s: correlated * interval_s,
        dof: n / (LAGS * correlated + 1.0),
    })
}

fn check_durations(stills: &[StillRun], noise: Noise) -> Result<(), TankError> {
    match stills.iter().find(|still| still.duration_s < MIN_CORRELATION_TIMES * noise.correlated_s) {
        Some(short) => Err(TankError::new(format!(
            "still run {:?} lasts {} s, and its load is correlated over {} s: hold each position for {} s at least",
            short.point.id,
            significant(short.duration_s, 3),
            significant(noise.correlated_s, 2),
            (MIN_CORRELATION_TIMES * noise.correlated_s).ceil()
        ))),
        None => Ok(()),
    }
}

fn fits<M: MotorDriven>(stills: &[StillRun], noise: Noise, setup: &Setup<M>) -> Result<Vec<StillFit>, TankError> {
    let name = |still: &StillRun| still.point.configuration.clone();
    let all = distinct(&stills.iter().map(name).collect::<Vec<_>>());
    let of = |one: &String| stills.iter().filter(|still| name(still) == *one).collect::<Vec<_>>();
    all.iter().map(|one| fit(&of(one), noise, setup)).collect()
}

fn fit<M: MotorDriven>(stills: &[&StillRun], noise: Noise, setup: &Setup<M>) -> Result<StillFit, TankError> {
    let at = |gain: f64| stills.iter().map(|still| at_rest(still, gain, setup)).collect::<Result<Vec<_>, _>>();
    let here = at(1.0)?;
    let Some(constant) = here.iter().find_map(|rest| rest.constant) else {
        return Err(TankError::new(format!(
            "the load at rest does not depend on the {}: still runs determine nothing; leave them out",
            M::SPEC.motion.name
        )));
    };
    let Some(zeroing) = setup.zeroing else {
        return Err(TankError::new(format!(
            "found {}, and nothing states how the load cell was zeroed for them: write still_runs = {{ zeroed = \"once\" }} in [source.{}] if it was zeroed once, before \
             the first of them",
            counted(stills.len(), "still run", "still runs"),
            M::SPEC.name
        )));
    };
    if let Some(known) = setup.constants[constant].known.filter(|known| known.standard <= 0.0) {
        return Err(TankError::new(format!(
            "{} is declared as exactly {} {}, and still runs also determine it: remove the declaration, or add its standard uncertainty",
            setup.constants[constant].name,
            significant(known.value, 4),
            M::SPEC.loads[0].unit
        )));
    }
    let n = stills.len();
    let x: Vec<f64> = here.iter().map(|rest| rest.factor).collect();
    let span = x.iter().copied().fold(f64::NEG_INFINITY, f64::max) - x.iter().copied().fold(f64::INFINITY, f64::min);
    if span < MIN_FACTOR_SPAN {
        return Err(TankError::new(format!(
            "{} {}: the zero of the load cell is unknown, too, so that two positions are needed at least, better on both sides of zero",
            if n == 1 { "there is one still run," } else { "all still runs have one position:" },
            stills.iter().map(|still| format!("{:?}", still.point.id)).collect::<Vec<_>>().join(", ")
        )));
    }
    let variances: Vec<f64> =
        stills.iter().map(|s| noise.variance_times_s / s.duration_s + noise.of_resolution).collect();
    let walk = |i: usize, j: usize| zeroing.drift.powi(2) * i.min(j) as f64;
    let least = f64::MIN_POSITIVE.sqrt().max(1e-18 * walk(n, n));
    let omega = Mat::from_fn(n, n, |i, j| walk(i, j) + if i == j { variances[i].max(least) } else { 0.0 });
    let refused = || TankError::new("the positions of the still runs do not determine a slope and a zero");
    let weight = inverted(&omega).ok_or_else(refused)?;
    let design = Mat::from_fn(n, 2, |i, j| if j == 0 { 1.0 } else { x[i] });
    let normal = inverted(&(design.transpose() * &weight * &design)).ok_or_else(refused)?;
    let estimator = normal * design.transpose() * &weight;
    let by = |row: usize, y: &[f64]| (0..n).map(|i| estimator[(row, i)] * y[i]).sum::<f64>();
    let along = |y: &[f64]| by(1, y);
    let measured: Vec<f64> = stills.iter().map(|still| still.load).collect();
    let without: Vec<f64> = measured.iter().zip(&here).map(|(y, rest)| y - rest.known).collect();
    let (zero, value) = (by(0, &without), along(&without));
    let residual: Vec<f64> = without.iter().zip(&x).map(|(y, x)| y - zero - value * x).collect();
    let quadratic = |of: &dyn Fn(usize, usize) -> f64| {
        let term = |i: usize, j: usize| estimator[(1, i)] * of(i, j) * estimator[(1, j)];
        (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| term(i, j)).sum::<f64>().max(0.0).sqrt()
    };
    let load = |rest: &AtRest| rest.known + value * rest.factor;
    let (above, below) = (at(1.0 + STEP)?, at(1.0 - STEP)?);
    let by_gain: Vec<f64> = above.iter().zip(&below).map(|(a, b)| (load(a) - load(b)) / (2.0 * STEP)).collect();
    let gains = setup.constants.iter().enumerate().filter_map(|(k, c)| match c.enters {
        // The cell shows (1 + e) times the load; the true motion is φ/(1 + e).
        Enters::Load(0) => Some((k, along(&measured))),
        Enters::Motion => Some((k, -along(&by_gain))),
        _ => None,
    });
    let chi = |i: usize, j: usize| residual[i] * weight[(i, j)] * residual[j];
    let chi: f64 = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| chi(i, j)).sum();
    let p = (n > 2 && variances.iter().all(|v| *v > 0.0)).then(|| chi_squared_upper(chi, (n - 2) as f64));
    let fitted = |(i, still): (usize, &&StillRun)| Fitted {
        run: (*still).clone(),
        factor: x[i],
        standard: variances[i].sqrt(),
        residual: residual[i],
    };
    Ok(StillFit {
        constant,
        value,
        noise: quadratic(&|i, j| if i == j { variances[i] } else { 0.0 }),
        drift: quadratic(&walk),
        dof: noise.dof,
        gain_sensitivities: gains.collect(),
        zero,
        runs: stills.iter().enumerate().map(fitted).collect(),
        p,
    })
}

/// The load at rest: what is known of it, and the constant that is looked for with its factor.
struct AtRest {
    known: f64,
    factor: f64,
    constant: Option<usize>,
}

fn at_rest<M: MotorDriven>(still: &StillRun, gain: f64, setup: &Setup<M>) -> Result<AtRest, TankError> {
    let values = setup.values();
    let mut out = AtRest { known: 0.0, factor: 0.0, constant: None };
    let mut add = |load: usize, factor: Factor, term: &[f64]| {
        let term = term.first().copied().unwrap_or(0.0);
        match factor {
            Factor::Constant(k) if load == 0 && term != 0.0 && setup.constants[k].unknown.is_some() => {
                (out.constant, out.factor) = (Some(k), term);
            }
            Factor::Constant(k) if load == 0 => out.known += values[k] * term,
            _ => {}
        }
    };
    setup.method.terms(&still.point, &values, &[[gain * still.position, 0.0, 0.0]], &mut add)?;
    Ok(out)
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len().max(1) as f64
}
