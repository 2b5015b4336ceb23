//! What an experiment on the loop logged: the response of the drive from a sweep, the limit cycle of a relay.

use froude_identify::method::MethodError;
use froude_records::run::RunLog;
use froude_records::units::Dimension;
use froude_rig::carriage::plan::{
    RELAY_HEIGHT, RELAY_HYSTERESIS, SWEEP_AMPLITUDE, SWEEP_DURATION, SWEEP_FROM, SWEEP_SPEED, SWEEP_TO,
};

use super::relay::{LimitCycle, limit_cycle};
use super::response::{Sweep, plant_response};
use super::{ResponsePoint, TuningError};
use crate::runs::EXCITING;

/// Points of a measured response.
const POINTS: usize = 70;

/// Columns of the moving axis in its own units: command, motor angle, and the rows of the excitation.
struct Excited {
    rate_hz: f64,
    command_v: Vec<f64>,
    angle_rad: Vec<f64>,
    /// First and last row of the excitation.
    rows: std::ops::Range<usize>,
}

/// `rad_m`: turn of the motor for a metre of the chain; `speed_m_s`: the reference below a sweep, `None` where the loop is open.
fn excited(log: &RunLog, rad_m: f64, speed_m_s: Option<f64>) -> Result<Excited, MethodError> {
    let name = log.meta.carriage.axis.name();
    let column = |what: &str, dimension| log.channel(&format!("{name}/{what}"), dimension);
    let state = column("state", Dimension::ONE)?;
    let reference = column("reference_velocity", Dimension::SPEED)?;
    let is_on = |i: usize| state[i] == EXCITING && speed_m_s.is_none_or(|v| (reference[i] - v).abs() <= 1e-6);
    let first = (0..state.len()).find(|&i| is_on(i)).unwrap_or(0);
    let end = (first..state.len()).rfind(|&i| is_on(i)).map_or(first, |i| i + 1);
    Ok(Excited {
        rate_hz: log.sample_rate_hz().unwrap_or(0.0),
        command_v: column("command", Dimension::VOLTAGE)?.to_vec(),
        angle_rad: column("position", Dimension::LENGTH)?.iter().map(|y| y * rad_m).collect(),
        rows: first..end,
    })
}

/// A constant that the log must state.
fn constant(log: &RunLog, name: &str) -> Result<f64, MethodError> {
    let what = || {
        format!(
            "the run does not state `{name}`, and without it the experiment cannot be read; Froude records it where it drives the experiment, \
             of another program's log it belongs into [constants] of the sidecar"
        )
    };
    log.meta.constants.get(name).map(|c| c.value).ok_or_else(|| MethodError::input(&log.path, what()))
}

/// Response of the drive from the log of a sweep; `rad_m` is the turn of the motor for a metre of the chain.
///
/// # Errors
///
/// A channel or a constant that is missing, or a sweep that gives no response.
pub fn response_of(log: &RunLog, rad_m: f64) -> Result<Vec<ResponsePoint>, MethodError> {
    let columns = excited(log, rad_m, Some(constant(log, SWEEP_SPEED)?))?;
    let rows = columns.rows.clone();
    let sweep = Sweep {
        rate_hz: columns.rate_hz,
        from_hz: constant(log, SWEEP_FROM)?,
        to_hz: constant(log, SWEEP_TO)?,
        duration_s: constant(log, SWEEP_DURATION)?,
        volts: constant(log, SWEEP_AMPLITUDE)?,
        command_v: &columns.command_v[rows.clone()],
        angle_rad: &columns.angle_rad[rows],
    };
    plant_response(&sweep, POINTS).map_err(MethodError::refused)
}

/// The limit cycle in the log of a relay; of a motion that is none, why it is not.
///
/// # Errors
///
/// A channel or a constant that is missing.
pub fn cycle_of(log: &RunLog, rad_m: f64) -> Result<Result<LimitCycle, TuningError>, MethodError> {
    let columns = excited(log, rad_m, None)?;
    let (height_v, hysteresis_m) = (constant(log, RELAY_HEIGHT)?, constant(log, RELAY_HYSTERESIS)?);
    let rows = columns.rows.clone();
    let (command_v, angle_rad) = (&columns.command_v[rows.clone()], &columns.angle_rad[rows]);
    Ok(limit_cycle(columns.rate_hz, height_v, hysteresis_m * rad_m, command_v, angle_rad))
}
