//! The interval to expect of each coefficient of a plan, by the common forecast of joint fits.

use froude_fit::budget::Uncertain;
use froude_records::campaign::{Identify, SensorSpec};

use super::fit::{motions, problem};
use super::method::MotorDriven;
use super::run::Run;
use super::setup::Setup;
use super::stills::{Noise, Slope, Still, is_still, slopes};
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
    let (at_rest, runs): (Vec<Run<'_>>, Vec<Run<'_>>) =
        logged.iter().map(Simulated::view).partition(|run| is_still(&run.point));
    let mut setup = setup.clone();
    setup.slopes = at_rest_of(twin, &at_rest, &setup, sensors)?;
    let setup = &setup;
    let motions = motions(&runs, setup, &[])?;
    let problem = problem(&runs, &motions, setup, identify)?;
    let beta: Vec<f64> = problem.names.iter().map(|(name, _)| twin.truth.value(name, setup)).collect();
    let moved = twin.planned.iter().filter(|run| !is_still(&run.point));
    let rates: Vec<f64> = moved.map(|run| run.rate_hz).collect();
    let found = crate::joint::forecast::forecast(&problem, &beta, &rates, &sensors_of::<M>(sensors))?;
    found.ok_or_else(|| TankError::new(format!("{}: {}", problem.law, M::SPEC.unplanned)))
}

/// What the planned still runs will show.
///
/// # Errors
///
/// [`TankError`]: fewer than two positions.
pub fn still<M: MotorDriven>(twin: &Twin<M>, sensors: &[SensorSpec]) -> Result<Vec<Slope>, TankError> {
    let exact = Twin { planned: twin.planned.clone(), setup: exactly(&twin.setup), truth: twin.truth.clone() };
    let logged = exact.simulated(&[], 0)?;
    let runs: Vec<Run<'_>> = logged.iter().map(Simulated::view).filter(|run| is_still(&run.point)).collect();
    at_rest_of(twin, &runs, &twin.setup, sensors)
}

/// What still runs without noise show, with that of the sensor.
fn at_rest_of<M: MotorDriven>(
    twin: &Twin<M>,
    runs: &[Run<'_>],
    setup: &Setup<M>,
    sensors: &[SensorSpec],
) -> Result<Vec<Slope>, TankError> {
    let Some(rate_hz) = twin.planned.iter().find(|run| is_still(&run.point)).map(|run| run.rate_hz) else {
        return Ok(Vec::new());
    };
    let stills = runs.iter().map(Still::of).collect::<Result<Vec<_>, _>>()?;
    let samples = runs.iter().map(|run| run.time_s.len() as f64).sum();
    let sensor = sensors_of::<M>(sensors).first().copied().flatten();
    slopes(&stills, Noise::of_sensor(sensor, rate_hz, samples), setup)
}

/// Everything as declared, without errors: what the plan is linearised at.
fn exactly<M: MotorDriven>(setup: &Setup<M>) -> Setup<M> {
    let mut out = setup.clone();
    for constant in &mut out.constants {
        constant.known = constant.known.map(|known| Uncertain::new(known.value, 0.0));
    }
    out
}
