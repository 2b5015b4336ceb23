//! Sensors of a twin of runs: what `[[simulate.sensor]]` states is simulated, or refused.

use froude_identify::method::MethodError;
use froude_records::campaign::{Campaign, SensorSpec};
use froude_rig::steady::Reading;

use crate::error::undeclared;

/// Channels of one kind: the names of their quantity, and what their twin simulates.
pub(crate) struct Senses<'a> {
    names: Vec<&'a str>,
    has_memory: bool,
}

impl<'a> Senses<'a> {
    /// A sensor with noise that may be correlated, a bias and a resolution.
    pub(crate) fn with_memory(names: impl IntoIterator<Item = &'a str>) -> Self {
        Self { names: names.into_iter().collect(), has_memory: true }
    }

    /// A sensor with white noise and a resolution.
    pub(crate) fn white(name: &'a str) -> Self {
        Self { names: vec![name], has_memory: false }
    }
}

/// How a channel of `[[simulate.sensor]]` is read, with a zero and a gain of its own.
pub(crate) fn reading(sensors: &[SensorSpec], names: &[&str], zero: f64, gain: f64) -> Reading {
    of_sensor(sensors.iter().find(|s| names.contains(&s.quantity.as_str())), zero, gain)
}

/// The same of a sensor that was found.
pub(crate) fn of_sensor(sensor: Option<&SensorSpec>, zero: f64, gain: f64) -> Reading {
    let of = |value: fn(&SensorSpec) -> Option<f64>| sensor.and_then(value).unwrap_or(0.0);
    Reading {
        noise: of(|s| s.noise),
        correlation_s: sensor.and_then(|s| s.correlation_s),
        step: of(|s| s.resolution),
        zero: zero + of(|s| s.bias),
        drift_per_s: 0.0,
        gain,
    }
}

/// Seed and sensors of the twin of a method whose channels are `senses`.
///
/// # Errors
///
/// A key that the twin does not simulate; in a campaign of one source also a quantity that it does not have.
pub(crate) fn seed_and_sensors<'a>(
    campaign: &'a Campaign,
    senses: &[Senses<'_>],
) -> Result<(u64, &'a [SensorSpec]), MethodError> {
    let Some(simulate) = &campaign.simulate else { return Ok((0, &[])) };
    if simulate.misalignment_rad.is_some() {
        let what = "misalignment applies to simulated tables only, not to simulated runs: leave it out";
        return Err(undeclared(campaign.path.display(), what));
    }
    for sensor in &simulate.sensors {
        let refuse = |what: String| {
            let place = sensor.place.as_ref().map_or_else(|| "[[simulate.sensor]]".to_owned(), ToString::to_string);
            Err(undeclared(place, what))
        };
        let quantity = sensor.quantity.as_str();
        let Some(sense) = senses.iter().find(|sense| sense.names.contains(&quantity)) else {
            // Those of another source may be meant.
            if campaign.sources.len() > 1 {
                continue;
            }
            let names: Vec<&str> = senses.iter().flat_map(|sense| sense.names.iter().copied()).collect();
            return refuse(format!(
                "quantity = {quantity:?} is not simulated by this twin: it has {}",
                names.join(", ")
            ));
        };
        let keys = [
            ("drift", sensor.drift.is_some()),
            ("bias", sensor.bias.is_some() && !sense.has_memory),
            ("correlation", sensor.correlation_s.is_some() && !sense.has_memory),
        ];
        if let Some((key, _)) = keys.into_iter().find(|(_, is_there)| *is_there) {
            let has = if sense.has_memory { "noise, correlation, resolution and bias" } else { "noise and resolution" };
            return refuse(format!("{key} is not simulated here: the twin has {has} for {quantity}; leave {key} out"));
        }
    }
    Ok((simulate.seed, &simulate.sensors))
}
