//! What coefficients refer to: the volume of a configuration and the density of the water.

use froude_identify::method::MethodError;
use froude_records::campaign::{Campaign, Source};
use froude_records::table::links_of_configuration;

use crate::error::undeclared;
use crate::fluid;

/// V: the volume that an added-mass coefficient of a configuration refers to, m³.
///
/// # Errors
///
/// None is declared; the message states what to write.
pub(crate) fn volume_m3(campaign: &Campaign, source: &Source, configuration: &str) -> Result<f64, MethodError> {
    let of = if configuration.is_empty() { String::new() } else { format!(" of {configuration}") };
    let body = campaign.body.as_ref();
    let n_links = links_of_configuration(configuration).map(f64::from);
    let per_link = body.and_then(|b| b.link_volume_m3).zip(n_links).map(|(v, k)| v * k);
    per_link
        .or_else(|| body.and_then(|b| b.volumes.get(configuration).copied()))
        .or_else(|| body.and_then(|b| b.volume_m3))
        .ok_or_else(|| undeclared(&source.place, format!(
                "C_A means nothing without the volume that it refers to, and none is declared{of}: write [body] volume = \"1.1e-3 m^3\", \
                 volumes = {{ H1LT = \"…\" }}, or link_volume for HkLT (the volume per link)"
            )))
}

/// ρ of `[fluid]`, kg/m³.
///
/// # Errors
///
/// Neither density nor a temperature that water can have is declared.
pub(crate) fn density_kg_m3(campaign: &Campaign, source: &Source) -> Result<f64, MethodError> {
    let missing = |what: String| undeclared(&source.place, what);
    let density = fluid::density_kg_m3(&campaign.fluid).map_err(missing)?;
    density.ok_or_else(|| missing("the added mass needs the water: write [fluid] density, or temperature".to_owned()))
}
