//! The interval to expect of each coefficient of a forced oscillation, by the common forecast of joint fits.

use froude_records::campaign::{Identify, SensorSpec};

use super::fit::{Swing, problem};
use super::forces::Drag;
use super::motions;
use super::setup::{LOAD, OscillationRun, Setup};
use super::simulate::{Planned, Truths, simulated};
use crate::error::TankError;
use crate::joint::Problem;

pub use crate::joint::forecast::{Expected, Forecast};

/// Forecasts the fit of `drag` to the planned runs.
///
/// # Errors
///
/// [`TankError`]: runs too short for their cycles, coefficients that the plan does not determine.
pub fn forecast(
    planned: &[Planned],
    setup: &Setup,
    truth: &Truths,
    drag: &Drag,
    sensors: &[SensorSpec],
    identify: &Identify,
) -> Result<Forecast, TankError> {
    let exact = exactly(setup);
    let logged = simulated(planned, &exact, truth, &[], 0);
    let runs: Vec<OscillationRun<'_>> = logged.iter().map(super::simulate::Simulated::view).collect();
    let motions = motions(&runs, setup)?;
    let problem = problem(&runs, &motions, setup, drag, identify);
    let rates: Vec<f64> = planned.iter().map(|run| run.rate_hz).collect();
    let of_force = sensors.iter().find(|s| ["force", LOAD].contains(&s.quantity.as_str()));
    let found = crate::joint::forecast::forecast(&problem, &true_values(&problem, setup, truth), &rates, of_force)?;
    found.ok_or_else(|| {
        TankError::new(format!(
            "model {} has coefficients that the planned runs do not tell apart: plan a second frequency, a second configuration for terms of head and tail, or declare the buoyancy",
            drag.law.name
        ))
    })
}

/// Everything as declared, without errors: what the plan is linearised at.
fn exactly(setup: &Setup) -> Setup {
    let exact = |u: froude_fit::budget::Uncertain| froude_fit::budget::Uncertain::new(u.value, 0.0);
    let bodies = setup.bodies.iter().map(|body| super::Body {
        mass_kg: exact(body.mass_kg),
        buoyancy_n: body.buoyancy_n.map(exact),
        ..body.clone()
    });
    Setup {
        radius_m: exact(setup.radius_m),
        density_kg_m3: exact(setup.density_kg_m3),
        flow_relative: 0.0,
        angle_relative: 0.0,
        force_relative: 0.0,
        delay_s: setup.delay_s.map(exact),
        bodies: bodies.collect(),
        ..setup.clone()
    }
}

/// The truth in the order of the fit's coefficients.
fn true_values(joint: &Problem<'_, Swing<'_>>, setup: &Setup, truth: &Truths) -> Vec<f64> {
    let mut out: Vec<f64> =
        joint.names.iter().map(|(name, _)| truth.law.position(name).map_or(0.0, |j| truth.drag[j])).collect();
    out[0] = truth.added;
    for (i, body) in setup.bodies.iter().enumerate() {
        let buoyancy = truth.buoyancy_n[i].or_else(|| body.buoyancy_n.map(|b| b.value));
        if let Some(j) = joint.equation.buoyancy[i] {
            out[j] = buoyancy.unwrap_or(0.0);
        }
        if let Some(j) = joint.equation.mass[i] {
            out[j] = body.mass_kg.value;
        }
    }
    if let Some(j) = joint.delay_at() {
        out[j] = truth.delay_s.or_else(|| setup.delay_s.map(|d| d.value)).unwrap_or(0.0);
    }
    out
}
