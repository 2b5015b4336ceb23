//! Instrumental variables for an axis in a loop.
//!
//! In a loop the measured motion carries the noise that the command answers: regressors and residual are correlated and least
//! squares is biased. Instruments are the same regressors computed from a simulation of the loop with the last
//! parameters, which knows the reference and not the noise. Instruments, regressors and force pass the same chain;
//! parameters and simulation are repeated until they no longer change.
//!
//! # Source
//!
//! Janot, Vandanjon & Gautier (2014), *A Generic Instrumental Variable Approach for Industrial Robot Identification*, IEEE Trans.
//! Control Syst. Technol. 22, 132 (IDIM-IV).

use froude_fit::distribution::coverage_factor;
use froude_fit::stream::{Solution, reduce_columns};

use crate::servo::chain::Chain;
use crate::servo::error::ServoError;
use crate::servo::interval::{diagonal_roots, hac, over_blocks};
use crate::servo::log::ServoLog;
use crate::servo::regression::{inverse_gram, least_squares, solve};
use crate::servo::report::ServoCoefficient;
use crate::servo::rows::Rows;
use crate::servo::simulate::{Loop, Rigid, closed_loop};

/// Parameters no longer change when every one moves by less than this part.
const UNCHANGED: f64 = 1e-6;
/// Most repetitions.
const REPETITIONS: usize = 20;

/// Coefficients by instruments.
#[derive(Debug, Clone, PartialEq)]
pub struct Instrumental {
    /// Coefficients in the order of the regression.
    pub coefficients: Vec<ServoCoefficient>,
    /// Simulations made.
    pub iterations: usize,
    /// Whether parameters came to rest.
    pub was_converged: bool,
}

/// Identifies an axis in a known loop by instruments.
///
/// # Errors
///
/// [`ServoError::Missing`] without a reference or for friction that [`Rigid`] cannot hold; [`ServoError::RanAway`].
pub fn identify(log: &ServoLog, chain: &Chain, servo: &Loop) -> Result<Instrumental, ServoError> {
    let rate_hz = log.rate_hz()?;
    let reference_m = log.reference_m.as_ref().ok_or(ServoError::Missing {
        column: "the reference position",
        instead: "record it, or identify without instruments",
    })?;
    let rows = chain.rows(log)?;
    let mut values = least_squares(&rows)?.coefficients;
    let names: Vec<&str> = rows.names.iter().map(|(n, _)| n.as_str()).collect();
    let mut iterations = 0;
    let mut was_converged = false;
    let mut instruments = rows.columns.clone();
    while iterations < REPETITIONS && !was_converged {
        iterations += 1;
        let axis = Rigid::from_values(&names, &values, chain.force_per_volt_n_v).ok_or(ServoError::Missing {
            column: "a simulation of friction over position, load or Stribeck's",
            instead: "use symmetric or asymmetric friction with instruments",
        })?;
        let simulated = closed_loop(&axis, servo, reference_m, log.position_m[0], rate_hz.recip())?;
        let motion = chain.motion(&simulated.position_m, rate_hz)?;
        let regressors = chain.regressors(&motion, log.load_n.as_deref())?;
        instruments = chain.decimated(&log.time_s, &log.command_v, regressors, rate_hz)?.columns;
        let new = by_instruments(&instruments, &rows)?.0;
        was_converged = new.iter().zip(&values).all(|(a, b)| (a - b).abs() <= UNCHANGED * a.abs());
        values = new;
    }
    let coefficients = with_intervals(&instruments, &rows, chain)?;
    Ok(Instrumental { coefficients, iterations, was_converged })
}

/// `(ZᵀX)⁻¹ Zᵀy` as least squares on the projections of the regressors: coefficients, and the solution on the projections.
fn by_instruments(instruments: &[Vec<f64>], rows: &Rows) -> Result<(Vec<f64>, Solution, Vec<Vec<f64>>), ServoError> {
    let z: Vec<&[f64]> = instruments.iter().map(Vec::as_slice).collect();
    let x: Vec<&[f64]> = rows.columns.iter().map(Vec::as_slice).collect();
    let factor = reduce_columns(&z, &x)?;
    let mut projected = Vec::with_capacity(x.len());
    for k in 0..x.len() {
        let weights = factor.solve(k)?.coefficients;
        let mut column = vec![0.0; rows.force_n.len()];
        for (z, w) in instruments.iter().zip(&weights) {
            column.iter_mut().zip(z).for_each(|(c, z)| *c += w * z);
        }
        projected.push(column);
    }
    let solution = solve(&projected, &rows.force_n)?;
    Ok((solution.coefficients.clone(), solution, projected))
}

fn with_intervals(instruments: &[Vec<f64>], rows: &Rows, chain: &Chain) -> Result<Vec<ServoCoefficient>, ServoError> {
    let (values, solution, projected) = by_instruments(instruments, rows)?;
    let residuals = rows.residuals_n(&values);
    let gram = inverse_gram(&solution);
    let options = &chain.intervals;
    let (hac_std, _) = hac(&projected, &residuals, &gram, rows.rate_hz, options.hac_lag_s);
    let sigma2 = residuals.iter().map(|r| r * r).sum::<f64>() / (residuals.len() - values.len()) as f64;
    let over = over_blocks(residuals.len(), rows.rate_hz, values.len(), options, |chosen| {
        let pick = |column: &Vec<f64>| chosen.iter().map(|&i| column[i]).collect::<Vec<f64>>();
        let part = Rows {
            force_n: pick(&rows.force_n),
            columns: rows.columns.iter().map(pick).collect(),
            time_s: Vec::new(),
            ..rows.clone()
        };
        by_instruments(&instruments.iter().map(pick).collect::<Vec<_>>(), &part).ok().map(|(c, ..)| c)
    })?;
    let block_std = diagonal_roots(&over.covariance);
    let k = coverage_factor(options.confidence, over.dof);
    Ok((rows.names.iter().enumerate())
        .map(|(j, (name, unit))| {
            let std = [(sigma2 * gram[(j, j)]).sqrt(), hac_std[j], block_std[j]];
            ServoCoefficient::new(name, unit, values[j], std, k * block_std[j])
        })
        .collect())
}
