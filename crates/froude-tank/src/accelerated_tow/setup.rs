//! What a campaign declares of an accelerated tow: body, rig and water.

use crate::names::ACCELERATED_TOW;
use froude_identify::method::MethodError;
use froude_records::campaign::{Campaign, Source};
use froude_records::run::Declared;

use super::section::{self, AcceleratedTowSpec};
use crate::declared::{gain as gain_of, needed};
use crate::error::undeclared;
use crate::logs;
use crate::reference;

/// What is declared of body and rig.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// `x` or `y`.
    pub axis: String,
    /// Length of the windows, s.
    pub window_s: f64,
    /// Delay of the force behind the motion, s.
    pub delay_s: Declared,
    /// ρ, kg/m³.
    pub density_kg_m3: f64,
    /// Gain error of the force, as part of it.
    pub force_relative: f64,
    /// Gain error of position and speed, as part of them.
    pub motion_relative: f64,
    /// The configurations.
    pub bodies: Vec<Body>,
}

/// A configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Its name; empty where there is one without.
    pub name: String,
    /// V, m³.
    pub volume_m3: f64,
    /// m: all that moves below the cell, kg; `None` where runs in air show it.
    pub mass_kg: Option<Declared>,
}

/// `[source.accelerated_tow]`.
///
/// # Errors
///
/// It is not there, or cannot be read.
pub fn declared(source: &Source) -> Result<AcceleratedTowSpec, MethodError> {
    let what = "nothing is declared of the body that speeds up: write [source.accelerated_tow] with axis and mass";
    needed(source, ACCELERATED_TOW, section::accelerated_tow, what)
}

pub(super) fn no_mass(source: &Source, setup: &Setup) -> MethodError {
    let without = setup.bodies.iter().filter(|body| body.mass_kg.is_none());
    let names: Vec<&str> = without
        .map(|body| if body.name.is_empty() { "runs that state no configuration" } else { &body.name })
        .collect();
    let what = format!(
        "the mass below the load cell is not known of {}: write mass = {{ value = \"1.63 kg\", standard = \"5 g\" }} in [source.accelerated_tow], for each configuration where they differ, \
         or log runs of each in air (role = \"dry_air\")",
        names.join(", ")
    );
    undeclared(&source.place, what)
}

/// Quantities of the budget that are the rig's, and no channel of the rows.
const OF_RIG: [&str; 3] = ["force", "position", "speed"];

/// The source without the errors that the rows have in them.
#[must_use]
pub fn without_rig(source: &Source) -> Source {
    let mut own = source.clone();
    own.uncertainty.retain(|entry| !OF_RIG.contains(&entry.quantity.as_str()));
    own
}

/// Everything that the campaign declares, for the configurations that there are.
///
/// # Errors
///
/// What is missing, and what to write.
pub fn setup_of(
    campaign: &Campaign,
    source: &Source,
    spec: &AcceleratedTowSpec,
    configurations: &[String],
) -> Result<Setup, MethodError> {
    let mut out = Setup {
        axis: spec.axis.name().to_owned(),
        window_s: spec.window_s,
        delay_s: spec.delay_s.unwrap_or(Declared::exact(0.0)),
        density_kg_m3: reference::density_kg_m3(campaign, source)?,
        force_relative: 0.0,
        motion_relative: 0.0,
        bodies: Vec::new(),
    };
    for name in configurations {
        out.bodies.push(Body {
            name: name.clone(),
            volume_m3: reference::volume_m3(campaign, source, name)?,
            mass_kg: spec.mass_kg.of(name),
        });
    }
    for entry in source.uncertainty.iter().filter(|entry| OF_RIG.contains(&entry.quantity.as_str())) {
        logs::is_of_all_runs(entry)?;
        let gain = if entry.quantity == "force" { &mut out.force_relative } else { &mut out.motion_relative };
        *gain = gain_of(entry, "the zero of each run is taken off")?;
    }
    Ok(out)
}
