//! Gains from experiments on the loop: as configured, as shaped on the measured response, and Ziegler–Nichols' for comparison.

use froude_identify::method::MethodError;
use froude_records::run::{Role, RunLog};

use super::candidate::Candidate;
use super::experiment::{cycle_of, response_of};
use super::gains::{Demand, shaped_on_response, ziegler_nichols};
use super::relay::LimitCycle;
use super::{LoopGains, ResponsePoint, TuningError};
use crate::tuning::bench::{Bench, ConfiguredLoop};

pub mod page;
pub mod record;

/// What tuning found.
#[derive(Debug, Clone)]
pub struct Tuned {
    /// The drive's response.
    pub plant: Vec<ResponsePoint>,
    /// The relay's limit cycle, where it made one.
    pub cycle: Result<LimitCycle, TuningError>,
    /// As configured, as proposed, Ziegler–Nichols.
    pub candidates: Vec<Candidate>,
    /// Which of them to use.
    pub recommended: Option<usize>,
    /// Measured band, Hz.
    pub band_hz: [f64; 2],
    /// Why no gains could be shaped on the response.
    pub unshaped: Option<TuningError>,
}

/// Names of the candidates.
pub(super) const CONFIGURED: &str = "as configured";
pub(super) const SHAPED: &str = "tuned on the response";
pub(super) const BY_CYCLE: &str = "Ziegler–Nichols (1942)";

/// Gains from the logs of a relay and a sweep.
///
/// # Errors
///
/// No sweep, or one that gives no response; a log without a channel or a constant that it needs.
pub fn tuned(logs: &[RunLog], of: ConfiguredLoop<'_>) -> Result<Tuned, MethodError> {
    let rad_m = of.axis.drive.gear_ratio / of.axis.drive.sprocket_radius_m;
    let log = |role: Role| logs.iter().find(|log| log.meta.role == role);
    let too_few = |what| TuningError::too_few(what, 0, 1, "drive one");
    let sweep = log(Role::Sweep).ok_or_else(|| MethodError::refused(too_few("sweeps")))?;
    let plant = response_of(sweep, rad_m)?;
    let cycle = log(Role::Relay).map_or(Ok(Err(too_few("relay runs"))), |log| cycle_of(log, rad_m))?;
    let bench = Bench::new(of, &plant);
    let load_hz = bench.heaviest().map_or(f64::INFINITY, |m| m.load.frequency_hz);
    let configured = of.axis.gains;
    let mut candidates = vec![bench.candidate(
        CONFIGURED,
        LoopGains {
            proportional_v_rad: configured.proportional_v_rad,
            derivative_v_s_rad: configured.derivative_v_s_rad,
            integral_v_rad_s: configured.integral_v_rad_s,
            derivative_filter_hz: configured.derivative_filter_hz,
            tick_s: bench.encoder.tick_s,
        },
    )];
    let mut unshaped = None;
    match shaped_on_response(&plant, load_hz, &Demand::default(), &bench.encoder) {
        Ok(gains) => candidates.push(bench.candidate(SHAPED, gains)),
        Err(error) => unshaped = Some(error),
    }
    if let Ok(cycle) = &cycle {
        candidates.push(bench.candidate(BY_CYCLE, ziegler_nichols(cycle, bench.encoder.tick_s)));
    }
    // What was shaped, then what is there already; Ziegler–Nichols' is for comparison.
    let recommended = [1, 0]
        .into_iter()
        .find(|&i| candidates.get(i).is_some_and(|c| c.objections.is_empty()) && (i == 0 || unshaped.is_none()));
    let band_hz = [plant[0].frequency_hz, plant[plant.len() - 1].frequency_hz];
    Ok(Tuned { plant, cycle, candidates, recommended, band_hz, unshaped })
}
