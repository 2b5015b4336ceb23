//! `[source.forced_oscillation]`: what is declared of a body that a motor swings, and the runs that are planned of it.
//!
//! ```toml
//! [source.forced_oscillation]
//! pivot    = "stream"                                        # the axis lies along the stream, or "upright"
//! radius   = { value = "476 mm", standard = "1 mm" }
//! mass     = { H1LT = { value = "1.63 kg", standard = "5 g" }, H2LT = { value = "2.75 kg", standard = "5 g" } }
//! buoyancy = { value = "3.0 N", standard = "0.02 N" }        # leave out what is to be found
//! delay    = { value = "0 ms", standard = "5 ms" }           # of the force behind the angle; leave out what is to be found
//! cycles   = { skip = 1, used = 5, fewest = 5 }
//!
//! [[source.plan]]
//! configurations = ["H1LT", "H2LT"]
//! amplitude      = ["10 deg", "15 deg", "20 deg"]
//! frequency      = ["60 deg/s", "70 deg/s", "80 deg/s"]      # Hz is a frequency, deg/s and rad/s are angular ones
//! flow           = "0.2 m/s"
//! periods        = 7
//! ```

use froude_hydro::swing::Pivot;
use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_records::run::{Declared, FORCED_OSCILLATION, declared};
use froude_records::section::Section;
use froude_records::section_values::{MOST_RUNS, at_most, configurations, count, one_of, series};
use froude_records::units::Dimension;

use crate::declared::{ByConfiguration, Swings, cycles, runs_of};
use crate::motion::Cycles;

/// What is declared of a forced oscillation.
#[derive(Debug, Clone, PartialEq)]
pub struct OscillationSpec {
    /// How the pivot axis lies.
    pub pivot: Pivot,
    /// From it to the body's reference point, m.
    pub radius_m: Declared,
    /// All that moves below the load cell, kg.
    pub mass_kg: ByConfiguration,
    /// Buoyancy less weight, N, as far as it is known beforehand.
    pub buoyancy_n: ByConfiguration,
    /// Delay of the force behind the angle, s, as far as it is known beforehand.
    pub delay_s: Option<Declared>,
    /// Which cycles are used.
    pub cycles: Cycles,
    /// Harmonics of the angle.
    pub harmonics: usize,
}

/// One block of planned runs: every amplitude at every frequency for every configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct OscillationPlan {
    /// Configurations; one empty text where the body has only one.
    pub configurations: Vec<String>,
    /// Whether they are done in air: mass and delay alone.
    pub in_air: bool,
    /// Speeds of the stream.
    pub flow_m_s: Vec<f64>,
    /// How the body swings.
    pub swings: Swings,
}

/// Reads `[source.forced_oscillation]`.
pub(super) fn oscillation(s: &Section<'_>) -> Result<OscillationSpec, RecordError> {
    s.only(&["pivot", "radius", "mass", "buoyancy", "delay", "cycles", "harmonics"])?;
    let pivot = one_of(s, "pivot", &Pivot::NAMES, &Pivot::ALL)?.ok_or_else(|| {
        s.missing(
            "pivot",
            "state how the pivot axis lies: \"stream\" (along the stream, the body swings across it like a pendulum) or \"upright\" (the body \
             turns its heading into the stream); the two give different velocities and different added masses",
        )
    })?;
    let radius_m = declared(s, "radius", Dimension::LENGTH)?
        .ok_or_else(|| s.missing("radius", "write radius = { value = \"476 mm\", standard = \"1 mm\" }"))?;
    if let (true, Some(value)) = (radius_m.value == 0.0, s.get("radius")) {
        return Err(s.wrong("radius", value, "is zero; the body swings about a pivot that lies away from it"));
    }
    let mass_kg = ByConfiguration::read(s, "mass", Dimension::MASS)?;
    if mass_kg == ByConfiguration::default() {
        return Err(s.missing(
            "mass",
            "write mass = { value = \"1.63 kg\", standard = \"5 g\" }: all that moves below the load cell; by configuration where there are several",
        ));
    }
    Ok(OscillationSpec {
        pivot,
        radius_m,
        mass_kg,
        buoyancy_n: ByConfiguration::read(s, "buoyancy", Dimension::FORCE)?,
        delay_s: declared(s, "delay", Dimension::TIME)?,
        cycles: cycles(s)?,
        harmonics: count(s, "harmonics", 20)?.unwrap_or(3),
    })
}

/// The runs that a source plans.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn plan(source: &Source) -> Result<Vec<OscillationPlan>, RecordError> {
    runs_of(source, FORCED_OSCILLATION, block, |p| p.swings.asks(p.configurations.len() * p.flow_m_s.len()))
}

/// Reads a `[[source.plan]]` that names an amplitude.
fn block(s: &Section<'_>) -> Result<OscillationPlan, RecordError> {
    s.only(&["configurations", "medium", "amplitude", "frequency", "flow", "periods", "still", "rate", "repeats"])?;
    let swings = Swings::read(s, "10 deg")?;
    let out = OscillationPlan {
        configurations: configurations(s)?,
        in_air: one_of(s, "medium", &["water", "air"], &[false, true])?.unwrap_or(false),
        flow_m_s: s.get("flow").map_or(Ok(vec![0.0]), |v| series(s, "flow", v, Dimension::SPEED))?,
        swings,
    };
    let numbers = [
        ("configurations", out.configurations.len()),
        ("amplitude", out.swings.amplitude_rad.len()),
        ("frequency", out.swings.omega_rad_s.len()),
        ("flow", out.flow_m_s.len()),
        ("repeats", out.swings.repeats),
    ];
    at_most(s, &numbers, MOST_RUNS)?;
    Ok(out)
}
