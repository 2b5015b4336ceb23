//! Modes of the carriage from sweeps bare, dry and wet, and the shaper that they ask for.

use froude_identify::method::MethodError;
use froude_records::carriage::plan::Experiments;
use froude_records::run::{Declared, RunLog};

use super::experiment::response_of;
use super::resonance::{Mode, Shaper, TwoMassModes, shaper, two_mass_modes};
use super::{ResponsePoint, TuningError};

pub mod page;
pub mod record;

/// The load's mode in one state of the body.
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

/// Modes from the logs of sweeps; `rad_m` is the turn of the motor for a metre of the chain, `efficiency` that of the gear when the motor drives.
///
/// # Errors
///
/// A sweep that gives no response.
pub fn modes_of(
    logs: &[RunLog],
    rad_m: f64,
    efficiency: Option<Declared>,
    experiments: &Experiments,
) -> Result<CarriageModes, MethodError> {
    let of_state = |log: &RunLog| {
        let plant = response_of(log, rad_m, experiments)?;
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
