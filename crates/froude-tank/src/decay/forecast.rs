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

use froude_fit::budget::{Kind, Part};
use froude_fit::faer::Mat;
use froude_records::campaign::SensorSpec;

use super::error::DecayError;
use super::fit::declared;
use super::output_error::linearised;
use super::record::LAW;
use super::releases::{Logged, exactly, names};
use super::run::{DecayRun, DecaySetup};
use crate::inverted::inverted;
use crate::joint::{DeclaredError, part};
use crate::matrix::Point;
use crate::noise::correlated;
use crate::plan::Expected;
use crate::sensors::reading;

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
    planned: &[Point],
    setup: &DecaySetup,
    truth: [f64; 3],
    sensors: &[SensorSpec],
) -> Result<Forecast, DecayError> {
    let sensor = reading(sensors, names(setup.axis), 0.0, 1.0);
    let sigma = sensor.noise.hypot(sensor.step / 12.0_f64.sqrt());
    let mut seen = *setup;
    seen.window.noise = setup.window.noise.or((sigma > 0.0).then_some(sigma));
    let logged = exactly(planned, setup, truth);
    let runs: Vec<DecayRun<'_>> = logged.iter().map(Logged::view).collect();
    let at = linearised(&runs, &seen)?;
    let p = at.parameters;
    let (mut gram, mut noise) = (Mat::<f64>::zeros(p, p), Mat::<f64>::zeros(p, p));
    for (columns, run) in at.derivatives.iter().zip(&at.used) {
        let rate_hz = planned.iter().find(|r| r.id == run.0).map_or(1.0, |r| r.condition("rate"));
        let keep = sensor.correlation_s.map_or(0.0, |time| (-1.0 / (rate_hz * time)).exp());
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
    let scatter = part("scatter", Kind::A, scatter, at.dof);
    let errors = declared(setup, at.values);
    let parts: Vec<Part> = std::iter::once(scatter).chain(errors.iter().map(DeclaredError::part)).collect();
    let (names, units) = (setup.axis.decay_names(), setup.axis.decay_units());
    let expected = (0..3).map(|j| Expected::of(LAW, (&names[j], units[j]), truth[j], &parts, j)).collect();
    Ok(Forecast { expected, peaks: at.used, left_out: at.left_out })
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
