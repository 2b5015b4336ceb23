//! The clock and the gain of a camera, against the accelerometers of the same run.
//!
//! A camera's heave and −z̈/ω² are the same motion. Their phase in windows of four periods is a lead of the camera; a lead that grows is a skew of its clock. It is
//! reported, never repaired: the coefficients come from the accelerometers.

use froude_signal::SignalError;
use froude_signal::clock::{Alignment, align};

use super::coefficients::Used;
use super::setup::{Shows, WaveRun};

/// Periods of a window.
const PERIODS: usize = 4;

/// The camera of a run against its accelerometers, from the beginning of the window to the end of the log; `None` where it has not both.
///
/// # Errors
///
/// Those of [`align`].
#[must_use]
pub fn camera(run: &WaveRun<'_>, used: &Used) -> Option<Result<Alignment, SignalError>> {
    let position = run.camera_m.filter(|_| run.shows == Shows::Acceleration)?;
    let omega = used.wave.omega_rad_s;
    let rows = used.response.rows.start..run.time_s.len();
    let heave: Vec<f64> = run.signal[rows.clone()].iter().map(|a| -a / (omega * omega)).collect();
    Some(align(&run.time_s[rows.clone()], &heave, &position[rows], omega, PERIODS))
}
