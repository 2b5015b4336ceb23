//! One fit of one or several logs, with what the law is not linear in: the delay of the command, Stribeck's speed, friction in proportion to the load.
//!
//! These are found by Gauss and Newton's steps: the rows are made where the model is linearised, a column says what each of them changes, and the solution
//! says by how much to move. At the end the columns are still there, so that the intervals of all coefficients include what is not known of them.
//!
//! **Delay.** The force at `t` is that of the command at `t − delay`, by straight lines between its samples. A command that is held until the next sample acts half a
//! step late on average, one that is continuous at once. The column is the slope of the force; a log whose motion has one frequency cannot tell it from inertia and viscous
//! friction. If the estimate is compatible with a delay between 0 and a step, and less certain than that (a standard uncertainty of h/√12), this is used instead.
//!
//! **Source.** Gautier & Poignet (2001), Control Eng. Pract. 9, 1361 (rows and parallel filters); Bates & Watts (1988), *Nonlinear regression analysis*, 2.2 (the steps).

use froude_records::number::{plain, significant};

use crate::servo::chain::{At, Chain, Delay, OF_LOAD, Prepared, delay_unknown, is_delay_known};
use crate::servo::coordinate::{DELAY, STRIBECK_SPEED};
use crate::servo::error::ServoError;
use crate::servo::log::ServoLog;
use crate::servo::regression::least_squares;
use crate::servo::report::{RigidFit, ServoReport, joined, of_logs};
use crate::servo::rows::Rows;

/// Most steps, and the part of a unit below which a step has settled.
const STEPS: usize = 40;
const SETTLED: f64 = 1e-4;
/// Longest step of the delay, in steps of the log: commands are nearly straight over a few.
const LONGEST: f64 = 5.0;
/// Trial values of Stribeck's speed, between these parts of the largest speed.
const STRIBECK_PARTS: [f64; 2] = [0.01, 0.5];
const STRIBECK_TRIALS: i32 = 12;
/// Identifies a rigid axis from one record.
///
/// # Errors
///
/// [`ServoError`]: see its variants.
///
/// # Example
///
/// An axis of 6 kg with friction, driven by two tones:
///
/// ```
/// use froude_carriage::servo::{Chain, Friction, ServoLog, identify_servo};
/// let time_s: Vec<f64> = (0..20_000).map(|i| 1e-3 * f64::from(i)).collect();
/// let position_m = time_s.iter().map(|t| 0.2 * (1.3 * t).sin() + 0.1 * (3.1 * t).sin()).collect();
/// let command_v = time_s
///     .iter()
///     .map(|t| {
///         let v = 0.26 * (1.3 * t).cos() + 0.31 * (3.1 * t).cos();
///         let a = -0.338 * (1.3 * t).sin() - 0.961 * (3.1 * t).sin();
///         (6.0 * a + 2.0 * v + 2.5 * v.signum()) / 6.0
///     })
///     .collect();
/// let log = ServoLog { time_s, position_m, command_v };
/// let report = identify_servo(&log, &Chain::new(6.0, Friction::symmetric()))?;
/// let mass_kg = report.fit.coefficient("M").map_or(f64::NAN, |c| c.value);
/// assert!((mass_kg - 6.0).abs() < 0.01);
/// # Ok::<(), froude_carriage::servo::ServoError>(())
/// ```
pub fn identify_servo(columns: &ServoLog, chain: &Chain) -> Result<ServoReport, ServoError> {
    identify_logs(std::slice::from_ref(columns), chain)
}

/// Identifies an axis from logs of it, in one fit.
///
/// # Errors
///
/// [`ServoError`]: see its variants.
pub fn identify_logs(logs: &[ServoLog], chain: &Chain) -> Result<ServoReport, ServoError> {
    of_prepared(&prepared(logs, chain)?, chain)
}

/// Stretches of each log.
type Stretches = [Vec<Prepared>];

fn prepared(logs: &[ServoLog], chain: &Chain) -> Result<Vec<Vec<Prepared>>, ServoError> {
    logs.iter().map(|log| chain.prepared(log)).collect()
}

fn of_prepared(logs: &Stretches, chain: &Chain) -> Result<ServoReport, ServoError> {
    let step_s = logs.first().and_then(|log| log.first()).map_or(1.0, |stretch| stretch.rate_hz.recip());
    let (mut report, found, is_settled) = match at_solution(logs, chain) {
        Ok(fit) if !(chain.delay.is_estimated && is_undetermined(&fit.0, step_s)) => fit,
        Err(error) if !(chain.delay.is_estimated && matches!(error, ServoError::Fit(_) | ServoError::Dependent)) => {
            return Err(error);
        }
        _ => {
            let delay = Delay { at_s: 0.5 * step_s, is_estimated: false, changes: Vec::new() };
            let chain = changing(logs, &Chain { delay, ..chain.clone() }, step_s / 12.0_f64.sqrt())?;
            let mut report = of_prepared(logs, &chain)?;
            report.fit.findings.push(delay_unknown(step_s));
            return Ok(report);
        }
    };
    if !is_settled {
        report.fit.findings.push(format!(
            "the fit did not converge in {STEPS} iterations; use a simpler friction law, or declare delay and stribeck_speed"
        ));
    }
    report.fit.findings.extend(doubts(&report, step_s, found.friction.fitted_stribeck.is_some()));
    Ok(report)
}

/// The fit where its model is linear in its solution, the chain there, and whether the steps came to an end.
fn at_solution(logs: &Stretches, chain: &Chain) -> Result<(ServoReport, Chain, bool), ServoError> {
    let (rows, found, is_settled) = settled(logs, &started(logs, chain)?)?;
    let mut report = of_logs(rows, &found)?;
    for c in &mut report.fit.coefficients {
        let at = match c.name.as_str() {
            DELAY => found.delay.at_s,
            STRIBECK_SPEED => found.friction.stribeck_speed_m_s.unwrap_or(0.0),
            _ => continue,
        };
        c.value += at;
        c.interval = c.interval.map(|end| end + at);
    }
    Ok((report, found, is_settled))
}

/// The same chain with a declared delay that has a standard uncertainty: what that changes in each coefficient.
///
/// # Errors
///
/// [`ServoError`].
pub fn uncertain(logs: &[ServoLog], chain: &Chain, standard_s: f64) -> Result<Chain, ServoError> {
    changing(&prepared(logs, chain)?, chain, standard_s)
}

fn changing(logs: &Stretches, chain: &Chain, standard_s: f64) -> Result<Chain, ServoError> {
    let at = |late_s: f64| -> Result<Vec<f64>, ServoError> {
        let delay = Delay { at_s: chain.delay.at_s + late_s, is_estimated: false, changes: Vec::new() };
        let (rows, found, _) = settled(logs, &started(logs, &Chain { delay, ..chain.clone() })?)?;
        let (rows, _) = joined(rows)?;
        let mut coefficients = least_squares(&rows)?.coefficients;
        // The column of Stribeck's speed says by how much it differs from where the model is linearised.
        for ((name, _), c) in rows.names.iter().zip(&mut coefficients) {
            if name == STRIBECK_SPEED {
                *c += found.friction.stribeck_speed_m_s.unwrap_or(0.0);
            }
        }
        Ok(coefficients)
    };
    let (early, late) = (at(-standard_s)?, at(standard_s)?);
    let changes = early.iter().zip(&late).map(|(early, late)| 0.5 * (late - early)).collect();
    Ok(Chain { delay: Delay { changes: vec![changes], ..chain.delay.clone() }, ..chain.clone() })
}

/// Whether the fit knows less of the delay than that it lies within a step.
fn is_undetermined(report: &ServoReport, step_s: f64) -> bool {
    let place = report.rows.names.iter().position(|(name, _)| name == DELAY);
    let found = place.and_then(|j| Some((report.fit.coefficients.get(j)?, report.rows.columns.get(j)?)));
    let Some((c, column)) = found else { return true };
    let part = report.fit.sigma_n / (c.classical_std * column.iter().map(|x| x * x).sum::<f64>().sqrt());
    !is_delay_known(c.value, c.block_std.max(c.hac_std), part, step_s)
}

/// What is doubtful of delay and terms of friction.
fn doubts(report: &ServoReport, step_s: f64, is_stribeck: bool) -> Vec<String> {
    let fit = &report.fit;
    let mut out = Vec::new();
    out.extend(lag(fit, step_s));
    let extra = ["F_s", if is_stribeck { STRIBECK_SPEED } else { OF_LOAD }];
    for c in extra.iter().filter_map(|name| fit.coefficient(name)) {
        if !(c.interval[0] > 0.0 || c.interval[1] < 0.0) {
            out.push(format!(
                "{} is not determined by these logs: its interval contains zero, or it has none. They do not support this law of friction; use friction = \"coulomb\"{}",
                c.name,
                if c.name == OF_LOAD { "" } else { ", or move more slowly" }
            ));
        }
    }
    out
}

/// A motion that is ahead of its command, or later than a held command explains.
pub(crate) fn lag(fit: &RigidFit, step_s: f64) -> Option<String> {
    let c = fit.coefficient(DELAY)?;
    let [low, high] = c.interval;
    if high < 0.0 {
        Some(format!(
            "the force precedes its command by {} ms: position and command have different clocks, or the position is filtered and late",
            significant(-1e3 * c.value, 3)
        ))
    } else if low > step_s {
        let [low, high] = [low, high].map(|end| significant(end, 3));
        Some(format!(
            "the motion lags the command by {} s, 95 % interval [{low}, {high}], more than the step of {} s for which a command may be held: the position or speed is filtered, the clocks differ, or the drive is slow. The fit \
             includes this delay; methods that do not include it give a wrong inertia",
            significant(c.value, 2),
            plain(step_s, 3)
        ))
    } else {
        None
    }
}

/// A chain with a first value of Stribeck's speed, the best of some.
fn started(logs: &Stretches, chain: &Chain) -> Result<Chain, ServoError> {
    if chain.friction.fitted_stribeck.is_none() || chain.friction.stribeck_speed_m_s.is_some() {
        return Ok(chain.clone());
    }
    let motions = logs.iter().flatten().filter_map(|stretch| stretch.motion.as_ref().ok());
    let fastest = motions.flat_map(|motion| &motion.velocity_m_s).fold(0.0_f64, |most, v| most.max(v.abs()));
    let [least, most] = STRIBECK_PARTS;
    let mut best: Option<(f64, Chain)> = None;
    for k in 0..STRIBECK_TRIALS {
        let part = least * (most / least).powf(f64::from(k) / f64::from(STRIBECK_TRIALS - 1));
        let mut chain = chain.clone();
        chain.friction.stribeck_speed_m_s = Some(part * fastest);
        let (rows, _) = joined(rows_of(logs, &chain)?)?;
        let Ok(solution) = least_squares(&rows) else { continue };
        let error = rows.relative_error(&solution.coefficients);
        if best.as_ref().is_none_or(|(least, _)| error < *least) {
            best = Some((error, chain));
        }
    }
    best.map(|(_, chain)| chain).ok_or(ServoError::Dependent)
}

fn rows_of(logs: &Stretches, chain: &Chain) -> Result<Vec<Rows>, ServoError> {
    logs.iter().map(|stretches| chain.rows_of(stretches)).collect()
}

/// Rows where the model is linear in its solution, the chain that made them, and whether the steps came to an end.
fn settled(logs: &Stretches, chain: &Chain) -> Result<(Vec<Rows>, Chain, bool), ServoError> {
    let mut chain = chain.clone();
    let mut rows = rows_of(logs, &chain)?;
    if !(chain.delay.is_estimated || chain.friction.is_of_load || chain.friction.fitted_stribeck.is_some()) {
        return Ok((rows, chain, true));
    }
    let step_s = logs.first().and_then(|log| log.first()).map_or(1.0, |stretch| stretch.rate_hz.recip());
    for _ in 0..STEPS {
        let (all, _) = joined(rows)?;
        let solution = least_squares(&all)?;
        let value = |name: &str| {
            all.names.iter().position(|(own, _)| own == name).and_then(|j| solution.coefficients.get(j)).copied()
        };
        let mut moved = 0.0_f64;
        if let Some(late_s) = value(DELAY) {
            let late_s = late_s.clamp(-LONGEST * step_s, LONGEST * step_s);
            // Beyond what is dropped at the ends there is no command.
            chain.delay.at_s = (chain.delay.at_s + late_s).clamp(-chain.trim_s, chain.trim_s);
            moved = moved.max((late_s / step_s).abs());
        }
        if let (Some(height), Some(speed)) = (value("F_s"), chain.friction.stribeck_speed_m_s)
            && let Some(before) = &mut chain.friction.fitted_stribeck
        {
            let change = value(STRIBECK_SPEED).unwrap_or(0.0).clamp(-0.5 * speed, speed);
            moved = moved.max((change / speed).abs()).max(((height - *before) / height).abs());
            (*before, chain.friction.stribeck_speed_m_s) = (height, Some(speed + change));
        }
        if chain.friction.is_of_load {
            let names = chain.load.terms.iter().flat_map(|(formula, _)| &formula.coefficients);
            let load: Vec<f64> = names.map(|(name, _)| value(name).unwrap_or(0.0)).collect();
            let of_load = value(OF_LOAD).unwrap_or(0.0);
            let size = load.iter().fold(f64::MIN_POSITIVE, |most, k| most.max(k.abs()));
            let before = chain.at.load.iter().chain(std::iter::repeat(&f64::INFINITY));
            let change = load.iter().zip(before).fold(0.0_f64, |most, (k, before)| most.max((k - before).abs() / size));
            let is_first = value(OF_LOAD).is_none();
            moved = moved.max(change).max((of_load - chain.at.of_load).abs()).max(f64::from(u8::from(is_first)));
            chain.at = At { load, of_load };
        }
        rows = rows_of(logs, &chain)?;
        if moved <= SETTLED {
            return Ok((rows, chain, true));
        }
    }
    Ok((rows, chain, false))
}
