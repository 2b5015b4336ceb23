//! Equation 5 of the carriage paper as it stands.
//!
//! Position is smoothed by a Gaussian, differentiated twice, and the torque regressed on acceleration, speed and its sign by
//! ordinary least squares, sample by sample, symmetric friction without an offset. The paper states neither the width of
//! the Gaussian nor whether the torque was smoothed; here the width is the caller's, and the torque is smoothed alike, since
//! smoothing one side only moves the coefficients. This is the yardstick; [`identify_servo`](crate::servo::identify_servo) is the method.
//!
//! # Source
//!
//! "A Low Cost, Sensor-less Drag Force Estimation Methodology via Measuring of Motor Currents", eq. 5 and IV.A.

use froude_signal::{differences, gaussian};

use crate::servo::chain::{Chain, Motion};
use crate::servo::error::ServoError;
use crate::servo::friction::Friction;
use crate::servo::interval::IntervalOptions;
use crate::servo::log::ServoLog;
use crate::servo::report::{ServoReport, of_rows};
use crate::servo::rows::Rows;

/// Equation 5, forces at the chain: `M`, `F_v`, `F_c`. `smoothing_s` is the standard deviation of the Gaussian, s.
///
/// [`MotorSide`](crate::servo::motor::MotorSide) turns them into `J_eff`, `B_eff`, `C_eff`.
///
/// # Errors
///
/// [`ServoError`].
pub fn identify(log: &ServoLog, force_per_volt_n_v: f64, smoothing_s: f64) -> Result<ServoReport, ServoError> {
    let rate_hz = log.rate_hz()?;
    let width = smoothing_s * rate_hz;
    let position_m = gaussian::smooth(&log.position_m, width)?;
    let velocity_m_s = differences::central(&position_m, rate_hz.recip())?;
    let acceleration_m_s2 = differences::central(&velocity_m_s, rate_hz.recip())?;
    let motion = Motion { position_m, velocity_m_s, acceleration_m_s2 };
    // The resamples of a full-rate record need not be many: the spread of a spread.
    let intervals = IntervalOptions { resamples: 200, ..IntervalOptions::default() };
    let chain = Chain { decimation: 1, trim_s: 0.0, intervals, ..Chain::new(force_per_volt_n_v, Friction::default()) };
    let regressors = chain.regressors(&motion, None)?;
    let (names, columns) = regressors.into_iter().map(|r| ((r.name, r.unit), r.values)).unzip();
    let force_n: Vec<f64> = log.command_v.iter().map(|u| force_per_volt_n_v * u).collect();
    let rows =
        Rows { rate_hz, time_s: log.time_s.clone(), force_n: gaussian::smooth(&force_n, width)?, names, columns };
    of_rows(rows, &chain)
}
