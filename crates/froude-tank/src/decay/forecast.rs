//! The interval to expect of each coefficient by output error, before a day in the tank is paid for.
//!
//! The planned releases are let go without noise on the twin and fitted; with J the derivatives of every used sample by every parameter there (the start and rest
//! of each release among them), and Ω the covariance of the sensor's noise,
//!
//! C = (JᵀJ)⁻¹ Jᵀ Ω J (JᵀJ)⁻¹,  Ω_ij = σ² e^{−|t_i − t_j|/τ_c},
//!
//! σ² with s²/12 of a sensor of step s; then what is declared, as the fit propagates it.
//!
//! **Units.** Those of the coefficients.
//!
//! # Source
//!
//! Fisher information of a non-linear model at its truth, Ljung (1999), ch. 9; JCGM 100:2008 (GUM), 5.2.

use froude_fit::budget::{Kind, Uncertain};
use froude_fit::faer::Mat;
use froude_records::campaign::SensorSpec;

use super::error::DecayError;
use super::output_error::linearised;
use super::record::LAW;
use super::releases::{Logged, Planned, sensor_of, simulated};
use super::run::{DecayRun, DecaySetup, Restoring};
use crate::inverted::inverted;
use crate::joint::conclude::part;
use crate::noise::correlated;
use crate::plan::Expected;

/// What a plan will determine.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// The coefficients.
    pub expected: Vec<Expected>,
    /// Peaks of each release that the fit uses, by its name.
    pub peaks: Vec<(String, usize)>,
    /// Releases that show too little, each with the reason.
    pub left_out: Vec<DecayError>,
}

/// Forecasts the output error of the planned releases.
///
/// # Errors
///
/// [`DecayError`]: releases that show too few peaks, coefficients that they do not determine.
pub fn forecast(
    planned: &[Planned],
    setup: &DecaySetup,
    truth: [f64; 3],
    sensors: &[SensorSpec],
) -> Result<Forecast, DecayError> {
    let sensor = sensor_of(sensors, setup.axis);
    let of = |part: Option<f64>| part.unwrap_or(0.0);
    let sigma = of(sensor.and_then(|s| s.noise)).hypot(of(sensor.and_then(|s| s.resolution)) / 12.0_f64.sqrt());
    let mut exact = exactly(setup);
    exact.window.noise = setup.window.noise.or((sigma > 0.0).then_some(sigma));
    let logged = simulated(planned, &exact, truth, &[], 0);
    let runs: Vec<DecayRun<'_>> = logged.iter().map(Logged::view).collect();
    let at = linearised(&runs, &exact)?;
    let p = at.parameters;
    let (mut gram, mut noise) = (Mat::<f64>::zeros(p, p), Mat::<f64>::zeros(p, p));
    for (columns, run) in at.derivatives.iter().zip(&at.used) {
        let rate_hz = planned.iter().find(|r| r.id == run.0).map_or(1.0, |r| r.rate_hz);
        let keep = sensor.and_then(|s| s.correlation_s).map_or(0.0, |time| (-1.0 / (rate_hz * time)).exp());
        let smoothed: Vec<Vec<f64>> = columns.iter().map(|x| correlated(x, keep)).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let own: Vec<usize> = (0..p).filter(|&i| !columns[i].is_empty()).collect();
        for &i in &own {
            for &j in &own {
                gram[(i, j)] += dot(&columns[i], &columns[j]);
                noise[(i, j)] += sigma * sigma * dot(&columns[i], &smoothed[j]);
            }
        }
    }
    let undetermined = || DecayError::undetermined("added mass, linear and quadratic damping");
    let inverse = inverted(&gram).ok_or_else(undetermined)?;
    let reach = Mat::from_fn(3, p, |i, j| at.sought[i][j]) * inverse;
    let scatter = &reach * noise * reach.transpose();
    let values = at.values;
    let [by_inertia, by_stiffness] = super::fit::DecayFit::by_declared(setup, values);
    let declared = |name: &str, by: [f64; 3], u: Uncertain| {
        part(name, Kind::B, Mat::from_fn(3, 3, |i, j| by[i] * by[j] * u.standard * u.standard), u.dof)
    };
    let mut parts = vec![part("scatter", Kind::A, scatter, at.dof), declared("dry inertia", by_inertia, setup.inertia)];
    for (name, u, by) in setup.restoring.parts() {
        parts.push(declared(name, by_stiffness.map(|d| d * by), u));
    }
    let (names, units) = (setup.axis.decay_names(), setup.axis.decay_units());
    let expected = (0..3).map(|j| Expected::of(LAW, (&names[j], units[j]), truth[j], &parts, j)).collect();
    Ok(Forecast { expected, peaks: at.used, left_out: at.left_out })
}

/// Everything as declared, without errors: what the plan is linearised at.
fn exactly(setup: &DecaySetup) -> DecaySetup {
    let exact = |u: Uncertain| Uncertain::new(u.value, 0.0);
    let restoring = match setup.restoring {
        Restoring::Spring(c) => Restoring::Spring(exact(c)),
        Restoring::Buoyancy { force_n, radius_m } => {
            Restoring::Buoyancy { force_n: exact(force_n), radius_m: exact(radius_m) }
        }
    };
    DecaySetup { inertia: exact(setup.inertia), restoring, ..*setup }
}

/// The peaks that a release shows, whether they are enough or not.
#[must_use]
pub fn peaks_of(found: &Forecast, id: &str) -> usize {
    let used = found.peaks.iter().find(|(run, _)| run == id).map(|(_, peaks)| *peaks);
    let left_out = found.left_out.iter().find_map(|why| match why {
        DecayError::Release { run, peaks, .. } if run == id => *peaks,
        _ => None,
    });
    used.or(left_out).unwrap_or(0)
}
