//! Modes of the carriage from sweeps bare, dry and wet, and the shaper that they ask for.

use froude_identify::method::MethodError;
use froude_records::run::{Declared, RunLog};

use super::experiment::response_of;
use super::resonance::{Mode, Shaper, TwoMassModes, shaper, two_mass_modes};
use super::{ResponsePoint, TuningError};

pub mod page;
pub mod record;

/// The load mode in one state of the body.
#[derive(Debug, Clone)]
pub struct StateModes {
    /// `none`, `dry`, `wet`.
    pub body: String,
    /// The drive's response.
    pub plant: Vec<ResponsePoint>,
    /// Both modes.
    pub modes: Result<TwoMassModes, TuningError>,
}

/// What the resonance experiment found.
#[derive(Debug, Clone)]
pub struct CarriageModes {
    /// By state of the body.
    pub states: Vec<StateModes>,
    /// Declared efficiency of the gear when the motor drives.
    pub efficiency: Option<Declared>,
    /// Mode to shape for, Hz, and its damping: the middle of dry and wet.
    pub proposed: Option<(f64, f64)>,
    /// The robust shaper for it.
    pub shaper: Option<Shaper>,
}

/// Modes from the logs of sweeps; the rig that they state has the turn of the motor for a metre of the chain, and the gear's efficiency.
///
/// # Errors
///
/// A log that states no rig; a sweep that gives no response.
pub fn modes_of(logs: &[RunLog]) -> Result<CarriageModes, MethodError> {
    let axis = |log: &RunLog| {
        let what = "the run does not state the rig that it was driven on: its gear and its sprocket are needed";
        log.meta.moving_axis().copied().ok_or_else(|| MethodError::input(&log.path, what))
    };
    let efficiency = match logs.first() {
        Some(first) => axis(first)?.efficiency_forward,
        None => None,
    };
    let of_state = |log: &RunLog| {
        let constants = axis(log)?;
        let plant = response_of(log, constants.gear_ratio.value / constants.sprocket_radius_m.value)?;
        let modes = two_mass_modes(&plant);
        Ok(StateModes { body: log.meta.mounted.body.name().to_owned(), plant, modes })
    };
    let states = logs.iter().map(of_state).collect::<Result<Vec<_>, MethodError>>()?;
    let towed: Vec<&TwoMassModes> =
        states.iter().filter(|s| s.body != "none").filter_map(|s| s.modes.as_ref().ok()).collect();
    let proposed = (!towed.is_empty()).then(|| {
        let n = towed.len() as f64;
        // The geometric middle: equally wrong for both, relatively.
        let ln_hz = towed.iter().map(|m| m.load.frequency_hz.ln()).sum::<f64>() / n;
        (ln_hz.exp(), towed.iter().map(|m| m.load.damping).sum::<f64>() / n)
    });
    let shaper = proposed.and_then(|(frequency_hz, damping)| {
        let middle = towed.first()?.load;
        Some(shaper(&Mode { frequency_hz, damping, ..middle }, true))
    });
    Ok(CarriageModes { states, efficiency, proposed, shaper })
}
