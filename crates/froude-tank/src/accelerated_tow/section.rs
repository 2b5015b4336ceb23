//! `[source.accelerated_tow]`: what is declared of a body that is towed up to speed and down again, and the runs that are planned of it.
//!
//! ```toml
//! [source.accelerated_tow]
//! axis   = "x"                                                # of the body, along the travel
//! mass   = { value = "1.63 kg", standard = "5 g" }            # all that moves below the load cell; leave out where runs in air show it
//! delay  = { value = "0 ms", standard = "2 ms" }              # of the force behind the motion
//! window = "0.4 s"                                            # of the weighted means
//!
//! [[source.plan]]
//! configurations = ["H1LT"]
//! speed        = ["0.2 m/s", "0.4 m/s"]
//! acceleration = ["0.2 m/s^2", "0.4 m/s^2"]
//! steady       = "4 s"
//! ```

use crate::names::ACCELERATED_TOW;
use froude_identify::declare::ByConfiguration;
use froude_records::RecordError;
use froude_records::campaign::{BodyAxis, Source};
use froude_records::run::{Declared, declared};
use froude_records::section::Section;
use froude_records::section_values::{Asks, MOST_RUNS, at_most, configurations, count, one_of, series};
use froude_records::units::Dimension;

use crate::declared::runs_of;

/// What is declared of an accelerated tow.
#[derive(Debug, Clone, PartialEq)]
pub struct AcceleratedTowSpec {
    /// The axis of the body that lies along the travel.
    pub axis: BodyAxis,
    /// All that moves below the load cell, kg.
    pub mass_kg: ByConfiguration,
    /// Delay of the force behind the motion, s.
    pub delay_s: Option<Declared>,
    /// Length of the windows that motion and force are weighted over, s.
    pub window_s: f64,
}

/// One block of planned runs: every acceleration to every speed for every configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct AcceleratedPlan {
    /// Configurations; one empty text where the body has only one.
    pub configurations: Vec<String>,
    /// Speeds that are reached, m/s.
    pub speed_m_s: Vec<f64>,
    /// Accelerations up to them and back to rest, m/s².
    pub acceleration_m_s2: Vec<f64>,
    /// Time at the speed, s.
    pub steady_s: f64,
    /// Time at rest before and after, s.
    pub still_s: f64,
    /// Samples a second.
    pub rate_hz: f64,
    /// Whether they are done in air: the mass alone.
    pub in_air: bool,
    /// How often each is run.
    pub repeats: usize,
}

/// Reads `[source.accelerated_tow]`.
pub(super) fn accelerated_tow(s: &Section<'_>) -> Result<AcceleratedTowSpec, RecordError> {
    s.only(&["axis", "mass", "delay", "window"])?;
    let axis = one_of(s, "axis", &["x", "y"], &[BodyAxis::X, BodyAxis::Y])?.ok_or_else(|| {
        s.missing(
            "axis",
            "state which axis of the body lies along the travel: \"x\" (forward) or \"y\" (to starboard); drag and added mass are those along it",
        )
    })?;
    let mass = s.get("mass").map(|value| ByConfiguration::read(s, "mass", value, Dimension::MASS)).transpose()?;
    let mass_kg = mass.unwrap_or_default();
    let wrong = mass_kg.all.iter().chain(mass_kg.named.values()).find(|m| m.value <= 0.0);
    if let (Some(mass), Some(value)) = (wrong, s.get("mass")) {
        return Err(s.wrong("mass", value, format!("is {} kg; a mass is larger than zero", mass.value)));
    }
    Ok(AcceleratedTowSpec {
        axis,
        mass_kg,
        delay_s: declared(s, "delay", Dimension::TIME)?,
        window_s: s.positive("window", Dimension::TIME)?.unwrap_or(0.4),
    })
}

/// The runs that a source plans.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn plan(source: &Source) -> Result<Vec<AcceleratedPlan>, RecordError> {
    runs_of(source, ACCELERATED_TOW, block, |p| {
        let count = p.configurations.len() * p.speed_m_s.len() * p.acceleration_m_s2.len() * p.repeats;
        let fastest = p.speed_m_s.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let slowest = p.acceleration_m_s2.iter().fold(f64::INFINITY, |least, a| a.min(least));
        let lasts_s = p.steady_s + 2.0 * p.still_s + 2.0 * fastest / slowest;
        Asks { count, samples: count as f64 * lasts_s * p.rate_hz }
    })
}

/// Reads a `[[source.plan]]` of accelerations.
fn block(s: &Section<'_>) -> Result<AcceleratedPlan, RecordError> {
    s.only(&["configurations", "medium", "speed", "acceleration", "steady", "still", "rate", "repeats"])?;
    let need = |key: &'static str, example: &str| s.get(key).ok_or_else(|| s.missing(key, example));
    let speed = need("speed", "write \"0.3 m/s\", a list, or { start, stop, step }")?;
    let acceleration = need("acceleration", "write \"0.2 m/s^2\", a list, or { start, stop, step }")?;
    let out = AcceleratedPlan {
        configurations: configurations(s)?,
        speed_m_s: series(s, "speed", speed, Dimension::SPEED)?,
        acceleration_m_s2: series(s, "acceleration", acceleration, Dimension::ACCELERATION)?,
        steady_s: s.positive("steady", Dimension::TIME)?.unwrap_or(4.0),
        still_s: s.positive("still", Dimension::TIME)?.unwrap_or(5.0),
        rate_hz: s.positive("rate", Dimension::ANGULAR_SPEED)?.unwrap_or(100.0),
        in_air: one_of(s, "medium", &["water", "air"], &[false, true])?.unwrap_or(false),
        repeats: count(s, "repeats", MOST_RUNS as u64)?.unwrap_or(1),
    };
    if out.speed_m_s.contains(&0.0) {
        return Err(s.wrong("speed", speed, "is zero; a tow goes somewhere, ahead or (below zero) astern"));
    }
    if out.acceleration_m_s2.iter().any(|a| *a <= 0.0) {
        return Err(s.wrong("acceleration", acceleration, "must be larger than zero; the sign is that of the speed"));
    }
    let numbers = [
        ("configurations", out.configurations.len()),
        ("speed", out.speed_m_s.len()),
        ("acceleration", out.acceleration_m_s2.len()),
        ("repeats", out.repeats),
    ];
    at_most(&s.place(), &numbers, MOST_RUNS)?;
    Ok(out)
}
