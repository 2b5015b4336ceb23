//! The water of a campaign.

use froude_hydro::fluid::Water;
use froude_records::campaign::Fluid;

/// Density, kg/m³, as declared or by the temperature; `None` where neither is.
///
/// # Errors
///
/// Water that the formulas do not cover, in words.
pub(crate) fn density_kg_m3(fluid: &Fluid) -> Result<Option<f64>, String> {
    match (fluid.density_kg_m3, fluid.temperature_degc) {
        (Some(density), _) => Ok(Some(density)),
        (None, Some(t)) => {
            let water = Water::at(t, fluid.salinity_g_kg.unwrap_or(0.0)).map_err(|e| format!("[fluid]: {e}"))?;
            Ok(Some(water.density_kg_m3))
        }
        (None, None) => Ok(None),
    }
}
