//! One record, one report.

use froude_fit::diagnostics::condition_number;
use froude_fit::faer::Mat;

use crate::servo::chain::{Chain, Rows};
use crate::servo::error::ServoError;
use crate::servo::interval::{Spread, Whiteness, spread, whiteness};
use crate::servo::log::ServoLog;
use crate::servo::regression::least_squares;

/// One identified coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct ServoCoefficient {
    /// `M`, `F_v`, `F_c+`, `offset`…
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Value.
    pub value: f64,
    /// Standard deviation if residuals were white. They are not: see [`ServoReport::whiteness`].
    pub classical_std: f64,
    /// Standard deviation by HAC.
    pub hac_std: f64,
    /// Standard deviation over moving blocks.
    pub block_std: f64,
    /// Interval from the blocks at the chain's confidence.
    pub interval: [f64; 2],
}

/// What a record says about an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct ServoReport {
    /// Coefficients in the order of the regression.
    pub coefficients: Vec<ServoCoefficient>,
    /// Rows of the regression.
    pub n_rows: usize,
    /// Their rate, Hz.
    pub rate_hz: f64,
    /// Rate of the record, Hz.
    pub record_rate_hz: f64,
    /// `‖force − model‖/‖force‖`.
    pub relative_force_error: f64,
    /// Standard deviation of the residuals, N.
    pub sigma_n: f64,
    /// Condition number of the regressors in SI units; `None` when they are dependent.
    pub condition_number: Option<f64>,
    /// Whether residuals are white; `None` when there are none.
    pub whiteness: Option<Whiteness>,
    /// Standard deviations and how they were made.
    pub spread: Spread,
    /// Residuals, N, row by row.
    pub residuals_n: Vec<f64>,
    /// The rows themselves.
    pub rows: Rows,
    /// What a reader must know before using the numbers.
    pub findings: Vec<String>,
}

impl ServoReport {
    /// The coefficient of that name.
    #[must_use]
    pub fn coefficient(&self, name: &str) -> Option<&ServoCoefficient> {
        self.coefficients.iter().find(|c| c.name == name)
    }

    /// Values in the order of the regression.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.coefficients.iter().map(|c| c.value).collect()
    }
}

/// Identifies a rigid axis from one record.
///
/// # Errors
///
/// [`ServoError`]: see its variants.
///
/// # Example
///
/// An axis of 6 kg with friction, driven by two tones:
///
/// ```
/// use froude_identify::servo::{Chain, Friction, ServoLog, identify_servo};
/// let time_s: Vec<f64> = (0..20_000).map(|i| 1e-3 * f64::from(i)).collect();
/// let position_m = time_s.iter().map(|t| 0.2 * (1.3 * t).sin() + 0.1 * (3.1 * t).sin()).collect();
/// let command_v = time_s
///     .iter()
///     .map(|t| {
///         let v = 0.26 * (1.3 * t).cos() + 0.31 * (3.1 * t).cos();
///         let a = -0.338 * (1.3 * t).sin() - 0.961 * (3.1 * t).sin();
///         (6.0 * a + 2.0 * v + 2.5 * v.signum()) / 6.0
///     })
///     .collect();
/// let log = ServoLog { time_s, position_m, command_v, ..ServoLog::default() };
/// let report = identify_servo(&log, &Chain::new(6.0, Friction::symmetric()))?;
/// let mass_kg = report.coefficient("M").map_or(f64::NAN, |c| c.value);
/// assert!((mass_kg - 6.0).abs() < 0.01);
/// # Ok::<(), froude_identify::servo::ServoError>(())
/// ```
pub fn identify_servo(columns: &ServoLog, chain: &Chain) -> Result<ServoReport, ServoError> {
    let rows = chain.rows(columns)?;
    let mut report = of_rows(rows, chain)?;
    report.record_rate_hz = columns.rate_hz()?;
    Ok(report)
}

/// As [`identify_servo`], from rows that are already there.
///
/// # Errors
///
/// [`ServoError`].
pub fn of_rows(rows: Rows, chain: &Chain) -> Result<ServoReport, ServoError> {
    let solution = least_squares(&rows)?;
    let spread = spread(&rows, &solution, &chain.intervals)?;
    let residuals_n = rows.residuals_n(&solution.coefficients);
    let whiteness = whiteness(&residuals_n, rows.rate_hz);
    let design = Mat::from_fn(rows.force_n.len(), rows.columns.len(), |i, j| rows.columns[j][i]);
    let coefficients: Vec<ServoCoefficient> = (rows.names.iter().enumerate())
        .map(|(j, (name, unit))| {
            let value = solution.coefficients[j];
            let half = spread.coverage_factor * spread.blocks[j];
            ServoCoefficient {
                name: name.clone(),
                unit,
                value,
                classical_std: spread.classical[j],
                hac_std: spread.hac[j],
                block_std: spread.blocks[j],
                interval: [value - half, value + half],
            }
        })
        .collect();
    Ok(ServoReport {
        findings: findings(&coefficients, whiteness.as_ref(), &spread),
        n_rows: rows.force_n.len(),
        rate_hz: rows.rate_hz,
        record_rate_hz: rows.rate_hz,
        relative_force_error: rows.relative_error(&solution.coefficients),
        sigma_n: solution.sigma,
        condition_number: condition_number(design.as_ref()).map(|(high, low)| high / low),
        coefficients,
        whiteness,
        spread,
        residuals_n,
        rows,
    })
}

fn findings(coefficients: &[ServoCoefficient], whiteness: Option<&Whiteness>, spread: &Spread) -> Vec<String> {
    let mut out = Vec::new();
    if let Some(w) = whiteness.filter(|w| !w.is_white()) {
        let worst = coefficients.iter().map(|c| c.block_std / c.classical_std).fold(0.0, f64::max);
        out.push(format!(
            "residuals are not white (r1 = {:.2}, Ljung-Box({}) = {:.0}): classical standard deviations are up to {worst:.1} times \
             too small; the intervals are those of blocks of {:.1} s",
            w.r1, w.lags, w.ljung_box, spread.block_s
        ));
    }
    for c in coefficients {
        let must_resist = c.name == "M" || c.name.starts_with("F_") && c.name != "F_s";
        if must_resist && c.interval[1] < 0.0 {
            out.push(format!(
                "{} = {:.4} {} is negative: check the sign of position or command",
                c.name, c.value, c.unit
            ));
        }
    }
    out
}
