//! The interval to expect of each coefficient of a plan, by the common forecast of joint fits.

use froude_fit::budget::Uncertain;
use froude_records::campaign::{Identify, SensorSpec};

use super::fit::{motions, problem};
use super::matrix::Planned;
use super::method::MotorDriven;
use super::run::Run;
use super::setup::Setup;
use super::still_fit::{self, is_still};
use super::still_run::StillFit;
use super::twin::{Simulated, Twin};
use crate::error::TankError;

pub use crate::joint::forecast::{Expected, Forecast};

/// The sensor of each load, as `[[simulate.sensor]]` states it.
pub(super) fn sensors_of<M: MotorDriven>(sensors: &[SensorSpec]) -> Vec<Option<&SensorSpec>> {
    M::SPEC.loads.iter().map(|load| load.sensor(sensors)).collect()
}

/// Forecasts the fit of `setup` to the runs of a twin.
///
/// # Errors
///
/// [`TankError`]: runs too short for their cycles, coefficients that the plan does not determine.
pub fn forecast<M: MotorDriven>(
    twin: &Twin<M>,
    setup: &Setup<M>,
    sensors: &[SensorSpec],
    identify: &Identify,
) -> Result<Forecast, TankError> {
    let exact = Twin { planned: twin.planned.clone(), setup: exactly(setup), truth: twin.truth.clone() };
    let logged = exact.simulated(&[], 0)?;
    let runs: Vec<Run<'_>> = logged.iter().map(Simulated::view).filter(|run| !is_still(&run.point)).collect();
    let setup = &Setup { still_fits: planned_still_fits(twin, sensors)?, ..setup.clone() };
    let motions = motions(&runs, setup, &[])?;
    let problem = problem(&runs, &motions, setup, identify)?;
    let beta: Vec<f64> = problem.names.iter().map(|(name, _)| twin.truth.value(name, setup)).collect();
    let moved = twin.planned.iter().filter(|run| !is_still(&run.point));
    let rates: Vec<f64> = moved.map(|run| run.rate_hz).collect();
    let found = crate::joint::forecast::forecast(&problem, &beta, &rates, &sensors_of::<M>(sensors))?;
    found.ok_or_else(|| TankError::new(format!("{}: {}", problem.law, M::SPEC.unplanned)))
}

/// What the planned still runs will show of the constants.
///
/// # Errors
///
/// [`TankError`]: still runs that a fit refuses.
pub fn planned_still_fits<M: MotorDriven>(twin: &Twin<M>, sensors: &[SensorSpec]) -> Result<Vec<StillFit>, TankError> {
    let planned: Vec<Planned> = twin.planned.iter().filter(|run| is_still(&run.point)).cloned().collect();
    let exact = Twin { planned, setup: exactly(&twin.setup), truth: twin.truth.clone() };
    let logged = exact.simulated(&[], 0)?;
    let runs: Vec<Run<'_>> = logged.iter().map(Simulated::view).collect();
    still_fit::planned(&runs, &twin.setup, sensors_of::<M>(sensors).first().copied().flatten())
}

/// Everything as declared, without errors: what the plan is linearised at.
fn exactly<M: MotorDriven>(setup: &Setup<M>) -> Setup<M> {
    let mut out = setup.clone();
    for constant in &mut out.constants {
        constant.known = constant.known.map(|known| Uncertain::new(known.value, 0.0));
    }
    out
}
