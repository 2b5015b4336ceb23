//! The interval to expect of each coefficient of a rotation, by the common forecast of joint fits.

use froude_fit::budget::Uncertain;
use froude_records::campaign::{Identify, SensorSpec};

use super::fit::{INERTIA, LAMBDAS, RESTORING, RESTORING_IN_AIR, TARES, problem};
use super::motions;
use super::setup::{RotationRun, Setup};
use super::simulate::{Planned, Simulated, Truths, simulated};
use crate::error::TankError;
use crate::joint::DELAY;

pub use crate::joint::forecast::{Expected, Forecast};

/// Forecasts the fit to the planned runs.
///
/// # Errors
///
/// [`TankError`]: runs too short for their cycles, coefficients that the plan does not determine.
pub fn forecast(
    planned: &[Planned],
    setup: &Setup,
    truth: &Truths,
    sensors: &[SensorSpec],
    identify: &Identify,
) -> Result<Forecast, TankError> {
    let logged = simulated(planned, &exactly(setup), truth, &[], 0);
    let runs: Vec<RotationRun<'_>> = logged.iter().map(Simulated::view).collect();
    let motions = motions(&runs, setup)?;
    let problem = problem(&runs, &motions, setup, identify)?;
    let beta: Vec<f64> = problem.names.iter().map(|(name, _)| true_value(name, setup, truth)).collect();
    let rates: Vec<f64> = planned.iter().map(|run| run.rate_hz).collect();
    let of_torque = sensors.iter().find(|s| s.quantity == "torque");
    crate::joint::forecast::forecast(&problem, &beta, &rates, of_torque)?.ok_or_else(|| {
        TankError::new(
            "the planned runs do not tell lambda_1, lambda_2 and lambda_3 apart; plan a second amplitude or frequency, and runs in water (role = \"test\")",
        )
    })
}

/// Everything as declared, without errors: what the plan is linearised at.
fn exactly(setup: &Setup) -> Setup {
    let exact = |known: Option<Uncertain>| known.map(|k| Uncertain::new(k.value, 0.0));
    Setup {
        inertia_kg_m2: exact(setup.inertia_kg_m2),
        tare_inertia_kg_m2: exact(setup.tare_inertia_kg_m2),
        restoring_n_m: exact(setup.restoring_n_m),
        delay_s: exact(setup.delay_s),
        angle_relative: 0.0,
        torque_relative: 0.0,
        ..setup.clone()
    }
}

/// The truth of a coefficient of the fit.
#[must_use]
pub fn true_value(name: &str, setup: &Setup, truth: &Truths) -> f64 {
    let either = |stated: Option<f64>, known: Option<Uncertain>| stated.or(known.map(|k| k.value)).unwrap_or(0.0);
    let of = |names: [&str; 3], values: [f64; 3]| names.iter().position(|n| *n == name).map(|j| values[j]);
    if let Some(value) = of(LAMBDAS, truth.lambdas).or_else(|| of(TARES, truth.shaft)) {
        return value;
    }
    match name {
        INERTIA => either(truth.inertia_kg_m2, setup.inertia_kg_m2),
        RESTORING => either(truth.restoring_n_m, setup.restoring_n_m),
        RESTORING_IN_AIR => truth.restoring_in_air_n_m,
        DELAY => either(truth.delay_s, setup.delay_s),
        _ => 0.0,
    }
}
