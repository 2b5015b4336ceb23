//! The water around a body.

use froude_hydro::fluid::Water as AtRest;
use froude_records::campaign::{Campaign, Fluid};

use crate::error::AddedMassError;
use crate::options::Asked;

/// The water that a campaign states.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Water {
    fluid: Fluid,
    /// Whether a file states it.
    is_campaign: bool,
}

impl Water {
    /// That of a campaign.
    #[must_use]
    pub fn of(campaign: &Campaign) -> Self {
        Self { fluid: campaign.fluid.clone(), is_campaign: !campaign.key.is_empty() }
    }

    /// The density that is asked for, else the campaign's, else that of the body file, kg/m³.
    pub(super) fn density_kg_m3(&self, asked: &Asked, of_file: Option<f64>) -> Result<f64, AddedMassError> {
        let stated = match (self.fluid.density_kg_m3, self.fluid.temperature_degc) {
            (None, Some(t)) => Some(AtRest::at(t, self.fluid.salinity_g_kg.unwrap_or(0.0))?.density_kg_m3),
            (stated, _) => stated,
        };
        let advice = if self.is_campaign {
            "density = \"1025 kg/m^3\" in [fluid] of the campaign"
        } else {
            "--density \"1025 kg/m^3\", or [fluid] density in the body file"
        };
        let none = || AddedMassError::input(&asked.input, format!("no density of the water; write {advice}"));
        asked.density_kg_m3.or(stated).or(of_file).ok_or_else(none)
    }
}
