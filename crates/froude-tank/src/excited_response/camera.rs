//! The clock and the gain of a camera, against the accelerometers of the same run.
//!
//! A camera's heave and −z̈/ω² are the same motion. Their phase in windows of four periods is a lead of the camera; a lead that grows is a skew of its clock. It is
//! reported, never repaired: the coefficients come from the accelerometers.

use froude_signal::clock::{Alignment, align};

use super::coefficients::Used;
use super::setup::{Shows, WaveRun, not_fitted};
use super::window::up;
use crate::error::TankError;

/// Periods of a window.
const PERIODS: usize = 4;
/// The motion is compared from where it has come to this part of its largest.
const FROM: f64 = 0.5;

/// The camera of a run against its accelerometers, from where the motion has come to half of its largest to the end of the log; `None` where it has not both.
///
/// # Errors
///
/// A fit that fails.
#[must_use]
pub fn camera(run: &WaveRun<'_>, used: &Used, harmonics: usize) -> Option<Result<Alignment, TankError>> {
    let position = run.camera_m.filter(|_| run.shows == Shows::Acceleration)?;
    let omega = used.wave.omega_rad_s;
    let compared = |from_s: f64| {
        let rows = run.time_s.partition_point(|t| *t < used.wave.start_s + from_s)..run.time_s.len();
        let heave: Vec<f64> = run.signal[rows.clone()].iter().map(|a| -a / (omega * omega)).collect();
        align(&run.time_s[rows.clone()], &heave, &position[rows], omega, PERIODS)
            .map_err(|source| not_fitted(run, "heave of the camera", &source))
    };
    Some(up(run, &used.wave, harmonics, FROM).and_then(compared))
}
