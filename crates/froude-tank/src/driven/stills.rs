//! Still runs: the body held fast at several positions, which show a constant of the equation before anything moves.
//!
//! The cell is zeroed once for all of them, so that the mean load of still run i is y_i = z + x(φ_i) B with one zero z; x comes from the method's own equation at
//! rest (−sin φ for the net buoyancy). B is the slope, weighted by 1/u_i²,
//!
//! u_i² = 2 τ s²/T_i + d²,  u²(B) = 1/Σ (x_i − x̄)²/u_i²,
//!
//! s and τ (s) being the standard deviation and the integrated correlation time of the load within runs of T_i seconds, d what the zero drifts by from run to run. The gains of
//! load and motion are those of the runs in motion: B moves with them, ∂B/∂g, and so does what is fitted with it.
//!
//! **Units.** SI. **Source.** USR eq. 20 and 21, with one zero for the set; weighted least squares. The degrees of freedom of a correlation time summed over w lags
//! are n/(2w + 1): Madras & Sokal (1988), J. Stat. Phys. 50, 109.

pub(crate) mod page;

use froude_fit::autocorrelation::integrated_time_about_mean;
use froude_fit::distribution::chi_squared_upper;
use froude_identify::dataset::distinct;
use froude_records::campaign::SensorSpec;
use froude_records::number::significant;
use froude_records::run::Role;
use froude_records::text::counted;

use super::method::MotorDriven;
use super::run::Run;
use super::setup::Setup;
use super::spec::{Enters, Factor, Point};
use crate::error::TankError;

/// A still run lasts for so many correlation times of its load.
const LONG: f64 = 10.0;
/// Lags over which a correlation is summed, in both directions, per correlation time.
const LAGS: f64 = 4.0;
/// Largest standard deviation of the position of a body held fast, rad or m.
const AT_REST: f64 = 0.0087;
/// Least span of the factor x.
const APART: f64 = 0.02;
/// Least standard uncertainty, as a part of the value: runs without noise determine it as well as numbers can.
const EXACT: f64 = 1e-9;
/// Step of differences by a gain.
const STEP: f64 = 1e-5;

/// How the load cell was zeroed for the still runs of a campaign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zeroed {
    /// Standard deviation of what the zero drifts by from one still run to the next, in the unit of the load.
    pub drift: f64,
}

/// Whether the runs are still.
pub(super) fn is_still(point: &Point) -> bool {
    point.role == Role::Still
}

/// Noise of the load at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Variance of a mean over one second: a mean over T seconds has 1/T of it.
    pub variance_s: f64,
    /// Its degrees of freedom.
    pub dof: f64,
}

impl Noise {
    /// That of a sensor in runs of so many samples.
    pub(super) fn of_sensor(sensor: Option<&SensorSpec>, rate_hz: f64, samples: f64) -> Self {
        let sigma = sensor.and_then(|sensor| sensor.noise).unwrap_or(0.0);
        let keep = sensor.and_then(|s| s.correlation_s).map_or(0.0, |time| (-1.0 / (rate_hz * time)).exp());
        let correlated = (1.0 + keep) / (1.0 - keep);
        Self { variance_s: sigma * sigma * correlated / rate_hz, dof: samples / (LAGS * correlated + 1.0) }
    }
}

/// A still run.
#[derive(Debug, Clone, PartialEq)]
pub struct Still {
    /// What it is.
    pub point: Point,
    /// Mean of the motion, rad or m.
    pub position: f64,
    /// Mean of the first load.
    pub load: f64,
    /// How long it lasts, s.
    pub duration_s: f64,
}

impl Still {
    pub(super) fn of(run: &Run<'_>) -> Result<Self, TankError> {
        let position = mean(run.motion);
        let spread = mean(&run.motion.iter().map(|x| (x - position).powi(2)).collect::<Vec<_>>()).sqrt();
        if spread > AT_REST {
            return Err(TankError::new(format!(
                "still run {:?} moves: the standard deviation of its position is {}; a still run is one log of the body held fast at one position, \
                 without the way there",
                run.id,
                significant(spread, 2)
            )));
        }
        let duration_s = run.time_s.last().zip(run.time_s.first()).map_or(0.0, |(b, a)| b - a);
        Ok(Self { point: run.point.clone(), position, load: mean(run.loads[0]), duration_s })
    }
}

/// What the still runs of one configuration show.
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    /// The constant, by its place.
    pub constant: usize,
    /// Its value.
    pub value: f64,
    /// What the noise and the drift of the zero each do to it.
    pub noise: f64,
    /// See `noise`.
    pub drift: f64,
    /// Degrees of freedom of both.
    pub dof: f64,
    /// Constants that are gains, by their place, with what B moves by.
    pub moves: Vec<(usize, f64)>,
    /// The zero of the cell.
    pub zero: f64,
    /// The runs, with the factor x of each and what is left of its load.
    pub runs: Vec<(Still, f64, f64)>,
    /// Standard uncertainty of each mean.
    pub standards: Vec<f64>,
    /// Probability of residuals as large as these, where there are more runs than unknowns.
    pub p: Option<f64>,
}

impl Slope {
    /// From noise and drift together.
    #[must_use]
    pub fn standard(&self) -> f64 {
        self.noise.hypot(self.drift).max(EXACT * self.value.abs()).max(f64::MIN_POSITIVE.sqrt())
    }
}

/// What still runs show of the constants of a setup.
///
/// # Errors
///
/// Those of [`stills`] and [`slopes`]; a cell of which nobody says how it was zeroed.
pub fn shown<M: MotorDriven>(runs: &[Run<'_>], setup: &Setup<M>) -> Result<Vec<Slope>, TankError> {
    if runs.is_empty() {
        return Ok(Vec::new());
    }
    let (stills, noise) = stills(runs)?;
    slopes(&stills, noise, setup)
}

/// The still runs, and the noise that they share.
///
/// # Errors
///
/// A run that moves, is too short to show its noise, or has another rate.
pub fn stills(runs: &[Run<'_>]) -> Result<(Vec<Still>, Noise), TankError> {
    let all = runs.iter().map(Still::of).collect::<Result<Vec<_>, _>>()?;
    let interval = |still: &Still, run: &Run<'_>| still.duration_s / (run.time_s.len().max(2) - 1) as f64;
    let intervals: Vec<f64> = all.iter().zip(runs).map(|(still, run)| interval(still, run)).collect();
    let interval_s = intervals.iter().sum::<f64>() / intervals.len() as f64;
    if let Some(i) = intervals.iter().position(|s| (s / interval_s - 1.0).abs() > 0.01) {
        return Err(TankError::new(format!(
            "still run {:?} has {} samples a second and the others have not: log the still runs of a source at one rate, they show one noise",
            runs[i].id,
            significant(1.0 / intervals[i], 3)
        )));
    }
    // One record of all runs, each about its own mean: the few products across their ends vanish in the mean.
    let of = |(run, still): (&Run<'_>, &Still)| run.loads[0].iter().map(|f| f - still.load).collect::<Vec<_>>();
    let left: Vec<f64> = runs.iter().zip(&all).flat_map(of).collect();
    let (n, n_run) = (left.len() as f64, left.len() as f64 / runs.len() as f64);
    let in_record = 2.0 * integrated_time_about_mean(&left);
    // Each run's mean takes part of the correlation: 2w/n of it in a window of w lags.
    let correlated = in_record / (1.0 - LAGS * in_record / n_run).max(0.5);
    let correlated_s = correlated * interval_s;
    if let Some(i) = all.iter().position(|still| still.duration_s < LONG * correlated_s) {
        return Err(TankError::new(format!(
            "still run {:?} lasts {} s, and its load is correlated over {} s: hold each position for {} s at least",
            runs[i].id,
            significant(all[i].duration_s, 3),
            significant(correlated_s, 2),
            (LONG * correlated_s).ceil()
        )));
    }
    let variance = left.iter().map(|x| x * x).sum::<f64>() / (n - correlated * runs.len() as f64);
    Ok((all, Noise { variance_s: variance * correlated_s, dof: n / (LAGS * correlated + 1.0) }))
}

/// What the still runs of each configuration show.
///
/// # Errors
///
/// Fewer than two positions, a load at rest that no constant explains.
pub fn slopes<M: MotorDriven>(stills: &[Still], noise: Noise, setup: &Setup<M>) -> Result<Vec<Slope>, TankError> {
    let Some(zeroed) = setup.zeroed else {
        return Err(TankError::new(format!(
            "{}, and nobody says how the load cell was zeroed for them: write stills = {{ zeroed = \"once\" }} in [source.{}] if it was zeroed once, before the first of them",
            counted(stills.len(), "still run is there", "still runs are there"),
            M::SPEC.name
        )));
    };
    let name = |still: &Still| still.point.configuration.clone();
    let all = distinct(&stills.iter().map(name).collect::<Vec<_>>());
    let of = |one: &String| stills.iter().filter(|still| name(still) == *one).collect::<Vec<_>>();
    all.iter().map(|one| slope(&of(one), noise, zeroed, setup)).collect()
}

fn slope<M: MotorDriven>(
    stills: &[&Still],
    noise: Noise,
    zeroed: Zeroed,
    setup: &Setup<M>,
) -> Result<Slope, TankError> {
    let at = |gain: f64| stills.iter().map(|still| at_rest(still, gain, setup)).collect::<Result<Vec<_>, _>>();
    let here = at(1.0)?;
    let Some(constant) = here.iter().find_map(|rest| rest.constant) else {
        return Err(TankError::new("the load at rest does not depend on the position: still runs determine nothing"));
    };
    if let Some(known) = setup.constants[constant].known.filter(|known| known.standard <= 0.0) {
        return Err(TankError::new(format!(
            "{} is declared as exactly {} and still runs determine it, too: leave it out, or write its standard uncertainty",
            setup.constants[constant].name,
            significant(known.value, 4)
        )));
    }
    let x: Vec<f64> = here.iter().map(|rest| rest.factor).collect();
    let span = x.iter().copied().fold(f64::NEG_INFINITY, f64::max) - x.iter().copied().fold(f64::INFINITY, f64::min);
    if span < APART {
        return Err(TankError::new(format!(
            "the still runs {} stand at one position: the zero of the load cell is unknown, so two positions at least are needed, better one on each side",
            stills.iter().map(|still| format!("{:?}", still.point.id)).collect::<Vec<_>>().join(", ")
        )));
    }
    let of_noise: Vec<f64> = stills.iter().map(|still| (noise.variance_s / still.duration_s).sqrt()).collect();
    let standards: Vec<f64> = of_noise.iter().map(|u| u.hypot(zeroed.drift)).collect();
    // Exact data weigh alike.
    let weight: Vec<f64> = standards.iter().map(|u| if *u > 0.0 { u.powi(-2) } else { 1.0 }).collect();
    let sum = weight.iter().sum::<f64>();
    let mean_of = |v: &[f64]| v.iter().zip(&weight).map(|(v, w)| v * w).sum::<f64>() / sum;
    let about: Vec<f64> = x.iter().map(|v| v - mean_of(&x)).collect();
    let power: f64 = about.iter().zip(&weight).map(|(v, w)| w * v * v).sum();
    let by_slope: Vec<f64> = about.iter().zip(&weight).map(|(v, w)| w * v / power).collect();
    let along = |y: &[f64]| by_slope.iter().zip(y).map(|(k, y)| k * y).sum::<f64>();
    let measured: Vec<f64> = stills.iter().map(|still| still.load).collect();
    let without: Vec<f64> = measured.iter().zip(&here).map(|(y, rest)| y - rest.known).collect();
    let value = along(&without);
    let zero = mean_of(&without) - value * mean_of(&x);
    let left: Vec<f64> = without.iter().zip(&x).map(|(y, x)| y - zero - value * x).collect();
    let spread = |u: &[f64]| by_slope.iter().zip(u).map(|(k, u)| (k * u).powi(2)).sum::<f64>().sqrt();
    let (above, below) = (at(1.0 + STEP)?, at(1.0 - STEP)?);
    let load = |rest: &AtRest| rest.known + value * rest.factor;
    let by_gain: Vec<f64> = above.iter().zip(&below).map(|(a, b)| (load(a) - load(b)) / (2.0 * STEP)).collect();
    let gains = setup.constants.iter().enumerate().filter_map(|(k, c)| match c.enters {
        // The cell shows (1 + e) times the load; the true motion is φ/(1 + e).
        Enters::Load(0) => Some((k, along(&measured))),
        Enters::Motion => Some((k, -along(&by_gain))),
        _ => None,
    });
    let (moves, free) = (gains.collect(), stills.len() - 2);
    let chi: f64 = left.iter().zip(&weight).map(|(r, w)| w * r * r).sum();
    let p = (free > 0 && standards.iter().all(|u| *u > 0.0)).then(|| chi_squared_upper(chi, free as f64));
    Ok(Slope {
        constant,
        value,
        noise: spread(&of_noise),
        drift: spread(&vec![zeroed.drift; stills.len()]),
        dof: noise.dof,
        moves,
        zero,
        runs: stills.iter().zip(x).zip(left).map(|((still, x), left)| ((*still).clone(), x, left)).collect(),
        standards,
        p,
    })
}

/// The load at rest: what is known of it, and the constant that the still runs look for with its factor.
struct AtRest {
    known: f64,
    factor: f64,
    constant: Option<usize>,
}

fn at_rest<M: MotorDriven>(still: &Still, gain: f64, setup: &Setup<M>) -> Result<AtRest, TankError> {
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
