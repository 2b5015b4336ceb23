//! Refinement of a rigid axis by the output error of its simulation in the loop.
//!
//! Parameters are moved until the simulated loop gives the recorded command (the force) best. In a stiff loop position
//! follows the reference whatever the parameters are, and only the force tells them; that is why the residual is that of the
//! force. The result depends on the loop: a gain that is not the true one moves the parameters.
//!
//! # Source
//!
//! Gautier, Janot & Vandanjon (2013), *A New Closed-Loop Output Error Method for Parameter Identification of Robot Dynamics*, IEEE
//! Trans. Control Syst. Technol. 21, 428 (DIDIM: the residual is the force's).

use froude_fit::Report;
use froude_fit::nonlinear::{NonlinearError, Parameter, Settings, minimise};

use crate::servo::chain::Chain;
use crate::servo::error::ServoError;
use crate::servo::log::ServoLog;
use crate::servo::report::{ServoReport, identify_servo, of_rows};
use crate::servo::rows::{Rows, norm};
use crate::servo::simulate::{Loop, Rigid, closed_loop};

/// The search: differences wide against the kinks of reversals; the end within a thousandth of a standard deviation.
const SEARCH: Settings = Settings { difference: 1e-3, offset: 1e-3, step: 1e-10, iterations: 50 };

/// Coefficients that make the simulated loop give the recorded force.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputError {
    /// Coefficients with intervals; error and whiteness are those of the simulated force.
    pub report: ServoReport,
    /// How the iteration ended.
    pub end: Report,
}

/// Refines the least-squares result of a chain.
///
/// # Errors
///
/// [`ServoError::Missing`] without a reference or for friction that [`Rigid`] cannot hold; [`ServoError::RanAway`].
pub fn refine(log: &ServoLog, chain: &Chain, servo: &Loop) -> Result<OutputError, ServoError> {
    let rate_hz = log.rate_hz()?;
    let reference_m = log.reference_m.as_ref().ok_or(ServoError::Missing {
        column: "the reference position",
        instead: "record it, or identify without the loop",
    })?;
    let start = identify_servo(log, chain)?;
    let names: Vec<&str> = start.coefficients.iter().map(|c| c.name.as_str()).collect();
    let force = |command_v: &[f64]| -> Result<Vec<f64>, ServoError> {
        let force_n: Vec<f64> = command_v.iter().map(|u| chain.force_per_volt_n_v * u).collect();
        Ok(chain.decimated(&log.time_s, &force_n, Vec::new(), rate_hz)?.force_n)
    };
    let measured_n = force(&log.command_v)?;
    let residuals = |values: &[f64]| {
        let axis = Rigid::from_values(&names, values, chain.force_per_volt_n_v).ok_or(ServoError::Missing {
            column: "a simulation of friction over position, load or Stribeck's",
            instead: "use symmetric or asymmetric friction in the loop",
        })?;
        let simulated = closed_loop(&axis, servo, reference_m, log.position_m[0], rate_hz.recip())?;
        let simulated_n = force(&simulated.command_v)?;
        Ok(measured_n.iter().zip(&simulated_n).map(|(m, s)| m - s).collect())
    };
    let values = start.values();
    // A natural step: a tenth of a coefficient, or of the Coulomb force for an offset near zero.
    let typical = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let parameters: Vec<Parameter> = (names.iter().zip(&values))
        .map(|(name, v)| Parameter::new(*name, *v, 0.1 * v.abs().max(1e-3 * typical)))
        .collect();
    let fitted = match minimise(&|values: &[f64]| residuals(values).ok(), &parameters, &SEARCH) {
        // The simulation knows better why it cannot start.
        Err(NonlinearError::Impossible { .. }) => {
            return Err(residuals(&values).err().unwrap_or(ServoError::Dependent));
        }
        fitted => fitted?,
    };
    // The linearised model: force = residual + Σ column · parameter.
    let (residuals_n, columns) = (&fitted.residuals[0], &fitted.columns[0]);
    let mut force_n = residuals_n.clone();
    for (column, p) in columns.iter().zip(&fitted.values) {
        force_n.iter_mut().zip(column).for_each(|(f, c)| *f += c * p);
    }
    let rows = Rows { force_n, columns: columns.clone(), ..start.rows.clone() };
    let mut report = of_rows(rows, chain)?;
    report.relative_force_error = norm(residuals_n) / norm(&measured_n);
    report.record_rate_hz = rate_hz;
    Ok(OutputError { report, end: fitted.report })
}
