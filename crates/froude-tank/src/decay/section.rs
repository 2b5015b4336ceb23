//! `[source.decay]`: a body that is displaced and let go, and the releases that are planned of it.
//!
//! ```toml
//! [source.decay]
//! axis      = "roll"
//! inertia   = { value = "0.3693 kg m^2", standard = "0.5 %" }  # dry, of all that moves, about the axis
//! buoyancy  = { value = "3.0 N", standard = "0.02 N" }         # less weight, at `radius` from the axis: the moment is B r sin φ
//! radius    = { value = "476 mm", standard = "1 mm" }          # or: stiffness = { value = "12 N m", standard = "0.3 %" }
//! noise     = "0.05 deg"                                       # of a sample; from the logs themselves where it is not declared
//! free_from = "1.01 s"
//!
//! [[source.plan]]
//! configuration = "H1LT"
//! angle         = "30 deg"                                     # of the release; displacement = "0.1 m" along an axis
//! repeats       = 5
//! duration      = "20 s"
//! ```

use std::f64::consts::PI;

use crate::decay::axis::Motion;
use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_records::run::positive_declared;
use froude_records::section::{Section, found};
use froude_records::section_values::{Asks, MOST_RUNS, at_most, count, one_of, series};
use froude_records::units::Dimension;

use super::run::{DecaySetup, DecayWindow, Restoring};
use crate::declared::{INERTIA, STIFFNESS, runs_of, uncertain};

/// Most samples of a planned release.
const MOST_SAMPLES: f64 = 1e7;

/// One block of planned releases.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayPlan {
    /// What is mounted; empty where the campaign does not say.
    pub configuration: String,
    /// Displacements from rest, m or rad.
    pub displacement: Vec<f64>,
    /// Whether they are angles.
    pub is_angle: bool,
    /// How often each is released.
    pub repeats: usize,
    /// Time held before the release, s.
    pub held_s: f64,
    /// Time free after it, s.
    pub free_s: f64,
    /// Samples a second.
    pub rate_hz: f64,
}

/// Reads `[source.decay]`.
pub(super) fn decay(s: &Section<'_>) -> Result<DecaySetup, RecordError> {
    s.only(&["axis", "inertia", "stiffness", "buoyancy", "radius", "noise", "free_from", "skip_half_cycles"])?;
    let axis = one_of(s, "axis", &Motion::NAMES, &Motion::ALL)?
        .ok_or_else(|| s.missing("axis", "state its motion: axis = \"heave\", for example"))?;
    let (inertia, like, position) = if axis.is_rotation() {
        (INERTIA, "0.4 kg m^2", Dimension::ANGLE)
    } else {
        (Dimension::MASS, "12 kg", Dimension::LENGTH)
    };
    let noise = s.positive("noise", position)?;
    let missing = || s.missing("inertia", &format!("write inertia = {{ value = \"{like}\", standard = \"0.5 %\" }}"));
    Ok(DecaySetup {
        axis,
        inertia: uncertain(positive_declared(s, "inertia", inertia)?.ok_or_else(missing)?),
        restoring: restoring(s, axis)?,
        window: DecayWindow {
            noise,
            free_from_s: s.quantity("free_from", Dimension::TIME)?,
            skip_half_cycles: s.integer("skip_half_cycles")?.map_or(0, |n| n as usize),
            ..DecayWindow::default()
        },
    })
}

fn restoring(s: &Section<'_>, axis: Motion) -> Result<Restoring, RecordError> {
    let (dimension, like) = if axis.is_rotation() { (Dimension::MOMENT, "12 N m") } else { (STIFFNESS, "180 N/m") };
    let instead =
        if axis.is_rotation() { "; or, of a buoyancy that acts at a radius, buoyancy and radius" } else { "" };
    let need = |key: &'static str, dimension, like: &str, more: &str| {
        let missing = || s.missing(key, &format!("write {key} = {{ value = \"{like}\", standard = \"0.5 %\" }}{more}"));
        positive_declared(s, key, dimension)?.map(uncertain).ok_or_else(missing)
    };
    let Some(buoyancy) = s.get("buoyancy") else {
        if let Some(radius) = s.get("radius") {
            return Err(s.wrong(
                "radius",
                radius,
                "is that of a buoyancy, which is not declared: write buoyancy = \"3.0 N\"",
            ));
        }
        return Ok(Restoring::Spring(need("stiffness", dimension, like, instead)?));
    };
    if !axis.is_rotation() {
        return Err(s.wrong(
            "buoyancy",
            buoyancy,
            "at a radius drives a rotation back, and the axis is none: declare a stiffness",
        ));
    }
    if let Some(stiffness) = s.get("stiffness") {
        return Err(s.wrong(
            "stiffness",
            stiffness,
            "stands beside buoyancy: what drives the body back is one or the other",
        ));
    }
    Ok(Restoring::Buoyancy {
        force_n: need("buoyancy", Dimension::FORCE, "3.0 N", "")?,
        radius_m: need("radius", Dimension::LENGTH, "476 mm", "")?,
    })
}

/// The releases that a source plans.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn plan(source: &Source) -> Result<Vec<DecayPlan>, RecordError> {
    // Both reductions plan alike.
    let method = source.methods.iter().find(|method| method.starts_with("decay")).map_or("", String::as_str);
    runs_of(source, method, block, |p| {
        let count = p.displacement.len() * p.repeats;
        Asks { count, samples: count as f64 * (p.held_s + p.free_s) * p.rate_hz }
    })
}

/// Reads a `[[source.plan]]` of releases.
fn block(s: &Section<'_>) -> Result<DecayPlan, RecordError> {
    s.only(&["configuration", "angle", "displacement", "repeats", "held", "duration", "rate"])?;
    let (key, value, dimension) = match (s.get("angle"), s.get("displacement")) {
        (Some(value), None) => ("angle", value, Dimension::ANGLE),
        (None, Some(value)) => ("displacement", value, Dimension::LENGTH),
        (Some(_), Some(value)) => {
            return Err(s.wrong("displacement", value, "stands beside angle: a release is from one or the other"));
        }
        (None, None) => {
            return Err(s.missing(
                "angle",
                "write what it is released from: angle = \"30 deg\" about an axis, displacement = \"0.1 m\" along one",
            ));
        }
    };
    let out = DecayPlan {
        configuration: s.text("configuration")?.unwrap_or_default().to_owned(),
        displacement: series(s, key, value, dimension)?,
        is_angle: key == "angle",
        repeats: count(s, "repeats", MOST_RUNS as u64)?.unwrap_or(1),
        held_s: s.positive("held", Dimension::TIME)?.unwrap_or(1.0),
        free_s: s.positive("duration", Dimension::TIME)?.unwrap_or(20.0),
        rate_hz: s.positive("rate", Dimension::ANGULAR_SPEED)?.unwrap_or(100.0),
    };
    let is_turned_over = |x: &f64| key == "angle" && x.abs() >= PI;
    if out.displacement.iter().any(|x| *x == 0.0 || is_turned_over(x)) {
        return Err(s.wrong(
            key,
            value,
            format!("is {}; a release is away from rest, by less than half a turn", found(value)),
        ));
    }
    let samples = (out.held_s + out.free_s) * out.rate_hz;
    if samples > MOST_SAMPLES {
        let at = s.get("duration").or_else(|| s.get("rate")).unwrap_or(value);
        return Err(s.wrong(
            "duration",
            at,
            format!("makes {samples:.0} samples of a release; {MOST_SAMPLES:.0} are the most"),
        ));
    }
    at_most(&s.place(), &[(key, out.displacement.len()), ("repeats", out.repeats)], MOST_RUNS)?;
    Ok(out)
}
