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

use std::f64::consts::TAU;

use froude_hydro::swing::Pivot;
use indexmap::IndexMap;
use toml::Spanned;
use toml::de::DeValue;

use crate::error::RecordError;
use crate::run::Declared;
use crate::run::sidecar::{declared, declared_value};
use crate::section::{Section, found};
use crate::section_values::{at_most, count, one_of, series};
use crate::units::Dimension;

/// Most runs that one block of a plan makes.
pub(crate) const MOST_RUNS: usize = 10_000;
/// Most periods of a run.
pub(crate) const MOST_PERIODS: u64 = 100_000;

/// A number that each configuration has, or all have alike.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ByConfiguration {
    /// Of all that are not named.
    pub all: Option<Declared>,
    /// By configuration.
    pub named: IndexMap<String, Declared>,
}

impl ByConfiguration {
    /// That of a configuration.
    #[must_use]
    pub fn of(&self, configuration: &str) -> Option<Declared> {
        self.named.get(configuration).copied().or(self.all)
    }
}

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
    /// Whole cycles left out after the motion has begun.
    pub skip: usize,
    /// Whole cycles used after those; `None` for all.
    pub used: Option<usize>,
    /// Fewest whole cycles.
    pub fewest: usize,
    /// Harmonics of the angle.
    pub harmonics: usize,
}

/// One block of planned runs: every amplitude at every frequency for every configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct OscillationPlan {
    /// Configurations; one empty text where the body has only one.
    pub configurations: Vec<String>,
    /// Amplitudes of the angle.
    pub amplitude_rad: Vec<f64>,
    /// Angular frequencies.
    pub omega_rad_s: Vec<f64>,
    /// Whether they are done in air: mass and delay alone.
    pub in_air: bool,
    /// Speeds of the stream.
    pub flow_m_s: Vec<f64>,
    /// Periods of each run, start-up included.
    pub periods: f64,
    /// Time at rest before each.
    pub still_s: f64,
    /// Samples a second.
    pub rate_hz: f64,
    /// How often each is run.
    pub repeats: usize,
}

/// Reads `[source.forced_oscillation]`.
pub(crate) fn oscillation(s: &Section<'_>) -> Result<OscillationSpec, RecordError> {
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
    let mass_kg = by_configuration(s, "mass", Dimension::MASS)?.unwrap_or_default();
    if mass_kg == ByConfiguration::default() {
        return Err(s.missing(
            "mass",
            "write mass = { value = \"1.63 kg\", standard = \"5 g\" }: all that moves below the load cell; by configuration where there are several",
        ));
    }
    let (skip, used, fewest) = cycles(s)?;
    Ok(OscillationSpec {
        pivot,
        radius_m,
        mass_kg,
        buoyancy_n: by_configuration(s, "buoyancy", Dimension::FORCE)?.unwrap_or_default(),
        delay_s: declared(s, "delay", Dimension::TIME)?,
        skip,
        used,
        fewest,
        harmonics: count(s, "harmonics", 20)?.unwrap_or(3),
    })
}

/// `cycles`: whole ones left out, used (`None` for all), and fewest.
pub(crate) fn cycles(s: &Section<'_>) -> Result<(usize, Option<usize>, usize), RecordError> {
    let Some(cycles) = s.section("cycles")? else { return Ok((1, None, 5)) };
    cycles.only(&["skip", "used", "fewest"])?;
    let number =
        |key: &'static str| -> Result<Option<usize>, RecordError> { Ok(cycles.integer(key)?.map(|n| n as usize)) };
    Ok((number("skip")?.unwrap_or(1), number("used")?, number("fewest")?.unwrap_or(5)))
}

/// One number for all, or a table with one for each configuration.
pub(crate) fn by_configuration(
    s: &Section<'_>,
    key: &'static str,
    dimension: Dimension,
) -> Result<Option<ByConfiguration>, RecordError> {
    let Some(value) = s.get(key) else { return Ok(None) };
    let table = value.get_ref().as_table().map(|_| s.as_section(key, value)).transpose()?;
    let Some(table) = table.filter(|table| table.get("value").is_none()) else {
        return Ok(Some(ByConfiguration { all: declared(s, key, dimension)?, named: IndexMap::new() }));
    };
    let mut named = IndexMap::new();
    for (configuration, _, value) in table.entries() {
        let number = declared_value(&table, configuration, value, dimension)?;
        named.insert(configuration.to_owned(), number);
    }
    Ok(Some(ByConfiguration { all: None, named }))
}

/// Reads a `[[source.plan]]` that names an amplitude.
pub(crate) fn oscillation_plan(s: &Section<'_>) -> Result<OscillationPlan, RecordError> {
    s.only(&["configurations", "medium", "amplitude", "frequency", "flow", "periods", "still", "rate", "repeats"])?;
    let need = |key: &'static str, example: &str| s.get(key).ok_or_else(|| s.missing(key, example));
    let amplitude = need("amplitude", "write \"10 deg\", a list, or { start, stop, step }")?;
    let frequency = need("frequency", "write \"0.2 Hz\" or \"70 deg/s\", a list, or { start, stop, step }")?;
    let mut configurations = s.texts("configurations")?;
    if configurations.is_empty() {
        configurations.push(String::new());
    }
    let out = OscillationPlan {
        configurations,
        amplitude_rad: series(s, "amplitude", amplitude, Dimension::ANGLE)?,
        omega_rad_s: angular(s, frequency)?,
        in_air: one_of(s, "medium", &["water", "air"], &[false, true])?.unwrap_or(false),
        flow_m_s: s.get("flow").map_or(Ok(vec![0.0]), |v| series(s, "flow", v, Dimension::SPEED))?,
        periods: count(s, "periods", MOST_PERIODS)?.unwrap_or(7) as f64,
        still_s: s.quantity("still", Dimension::TIME)?.unwrap_or(1.0),
        rate_hz: s.positive("rate", Dimension::ANGULAR_SPEED)?.unwrap_or(100.0),
        repeats: count(s, "repeats", MOST_RUNS as u64)?.unwrap_or(1),
    };
    for (key, value, numbers) in
        [("amplitude", amplitude, &out.amplitude_rad), ("frequency", frequency, &out.omega_rad_s)]
    {
        if numbers.iter().any(|x| *x <= 0.0) {
            return Err(s.wrong(key, value, format!("is {}; all must be larger than zero", found(value))));
        }
    }
    let numbers = [
        ("configurations", out.configurations.len()),
        ("amplitude", out.amplitude_rad.len()),
        ("frequency", out.omega_rad_s.len()),
        ("flow", out.flow_m_s.len()),
        ("repeats", out.repeats),
    ];
    at_most(s, &numbers, MOST_RUNS)?;
    Ok(out)
}

/// Frequencies as angular ones: a number of Hz counts periods, any other unit of the kind counts radians.
pub(crate) fn angular<'a>(s: &Section<'a>, value: &'a Spanned<DeValue<'a>>) -> Result<Vec<f64>, RecordError> {
    let is_hertz = |v: &Spanned<DeValue<'_>>| v.get_ref().as_str().is_some_and(|text| text.trim_end().ends_with("Hz"));
    let bare = |v: &Spanned<DeValue<'_>>| {
        v.get_ref().as_str().is_some_and(|text| text.contains("1/s") || text.contains("s^-1"))
    };
    let parts: Vec<&Spanned<DeValue<'_>>> = match (value.get_ref().as_array(), value.get_ref().as_table()) {
        (Some(list), _) => list.iter().collect(),
        (_, Some(table)) => table.values().collect(),
        _ => vec![value],
    };
    if parts.iter().any(|v| bare(v)) {
        return Err(s.wrong(
            "frequency",
            value,
            "is in 1/s, which says neither periods nor radians; write Hz, or rad/s",
        ));
    }
    let hertz = parts.iter().filter(|v| is_hertz(v)).count();
    if hertz > 0 && hertz < parts.len() {
        return Err(s.wrong("frequency", value, "is partly in Hz and partly an angular frequency; write one of them"));
    }
    let factor = if hertz > 0 { TAU } else { 1.0 };
    Ok(series(s, "frequency", value, Dimension::ANGULAR_SPEED)?.into_iter().map(|x| factor * x).collect())
}
