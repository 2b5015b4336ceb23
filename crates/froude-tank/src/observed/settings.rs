//! The settings of planned runs with their true law.

use froude_identify::dataset::Dataset;
use froude_identify::law::ForceLaw;
use froude_records::units::Dimension;

/// Settings and truth of planned runs.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Settings, a row per run.
    pub data: Dataset,
    /// The true law.
    pub law: ForceLaw,
    /// Its coefficients.
    pub values: Vec<f64>,
    /// Factor on the law's loads in each run \[-\], from a trip, the mount or the wake of the previous run. Empty without run-to-run variation.
    pub of_run: Vec<f64>,
}

/// Loads of the law in one row of settings at another speed and angle, N.
#[must_use]
pub fn loads_at(plan: &Plan, row: usize, speed_m_s: f64, angle_rad: f64) -> Vec<f64> {
    let mut at = plan.data.subset(&[row]);
    at.put("speed", vec![speed_m_s], Dimension::SPEED);
    at.put("angle", vec![angle_rad], Dimension::ONE);
    at.velocity_from_speed_and_angle();
    let loads = plan.law.predict(&at, &plan.values).unwrap_or_else(|_| vec![f64::NAN; plan.law.responses.len()]);
    let factor = plan.of_run.get(row).copied().unwrap_or(1.0);
    loads.into_iter().map(|f| factor * f).collect()
}
