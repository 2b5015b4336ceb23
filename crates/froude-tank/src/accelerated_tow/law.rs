//! A drag law with a term of the acceleration: f = f_D(v) − C_A ρ V v̇ along one axis.
//!
//! **Source.** USR eq. 15 and 16: μ = C_A ρ V with the reference volume V, which the record carries.

use froude_identify::dataset::Dataset;
use froude_identify::law::ForceLaw;
use froude_identify::method::MethodError;
use froude_identify::source::laws;
use froude_records::campaign::{Campaign, Source};
use froude_records::units::Dimension;
use indexmap::IndexMap;

use crate::error::TankError;

/// The drag law where none is asked for.
const DEFAULT_LAW: &str = "linear_quadratic";

/// Names of load, speed and added-mass coefficient along an axis.
#[must_use]
pub fn names(axis: &str) -> [String; 4] {
    [format!("f_{axis}"), format!("v_{axis}"), format!("v_{axis}_dot"), format!("C_A{axis}")]
}

/// The laws that a source asks for, over the channels of `data`.
///
/// # Errors
///
/// An unknown law, or one that is not written as a formula of the load along the axis.
pub fn asked(campaign: &Campaign, source: &Source, data: &Dataset, axis: &str) -> Result<Vec<ForceLaw>, MethodError> {
    let mut asking = source.clone();
    let identify = &campaign.identify;
    if source.models.is_empty() && identify.models.is_empty() && identify.user_models.is_empty() {
        asking.models = vec![DEFAULT_LAW.to_owned()];
    }
    laws(campaign, &asking, data)?.iter().map(|law| with_acceleration(law, data, axis)).collect()
}

/// The law with − C_A ρ V v̇ behind its formula; one that has a term of the acceleration already keeps its own.
///
/// # Errors
///
/// A law that is not written as a formula.
pub fn with_acceleration(law: &ForceLaw, data: &Dataset, axis: &str) -> Result<ForceLaw, MethodError> {
    let [load, _, acceleration, added] = names(axis);
    let refused = || {
        MethodError::refused(TankError::new(format!(
            "the law {} is not written as a formula of the load along {axis}; an accelerated tow takes quadratic, linear_quadratic, or a law of [[identify.model]]",
            law.name
        )))
    };
    let at = law.responses.iter().position(|r| *r == load).ok_or_else(refused)?;
    let (_, text) = law.texts.get_index(at).ok_or_else(refused)?;
    if text.contains(&acceleration) {
        return Ok(law.clone());
    }
    let text = format!("{text} - {added}*density*volume*{acceleration}");
    Ok(law.rewritten(&format!("added_mass_{}", law.name), &IndexMap::from([(load, text)]), data)?)
}

/// Channels that the laws read, a row each, SI; all vectors have one length.
#[derive(Default)]
pub struct Channels {
    /// Runs.
    pub run: Vec<String>,
    /// Configurations.
    pub configuration: Vec<String>,
    /// Speed along the axis, m/s.
    pub speed_m_s: Vec<f64>,
    /// Acceleration along it, m/s².
    pub acceleration_m_s2: Vec<f64>,
    /// Load of the water on the body along it, N.
    pub load_n: Vec<f64>,
    /// Reference volume, m³.
    pub volume_m3: Vec<f64>,
    /// Density of the water, kg/m³.
    pub density_kg_m3: f64,
}

/// The rows as a data set.
#[must_use]
pub fn data(channels: Channels, axis: &str) -> Dataset {
    let n = channels.run.len();
    let [load, speed, acceleration, _] = names(axis);
    let mut out = Dataset { rows: n, ..Dataset::default() };
    out.configuration = channels.configuration.into();
    out.setup = out.configuration.clone();
    out.run = channels.run.into();
    out.line = (1..=n).collect();
    let across = if axis == "x" { "v_y" } else { "v_x" };
    out.put(&speed, channels.speed_m_s, Dimension::SPEED);
    out.put(across, vec![0.0; n], Dimension::SPEED);
    out.put(&acceleration, channels.acceleration_m_s2, Dimension::ACCELERATION);
    out.put("density", vec![channels.density_kg_m3; n], Dimension::DENSITY);
    out.put("volume", channels.volume_m3, Dimension::VOLUME);
    out.put(&load, channels.load_n, Dimension::FORCE);
    out.speed_and_angle_from_velocity();
    out
}
