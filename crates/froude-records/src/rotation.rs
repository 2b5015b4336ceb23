//! `[source.rotation]`: what is declared of a body that a motor turns to and fro about its own centre, and the runs that are planned of it.
//!
//! ```toml
//! [source.rotation]
//! axis      = "upright"                                              # or "stream": the axis lies level, and the weight restores
//! inertia   = { value = "3.4e-3 kg m^2", standard = "1e-5 kg m^2" }  # dry, of all below the torque cell; runs in air find it too
//! tare_inertia = "2e-4 kg m^2"                                       # of it without the body; needed where there are runs of the role tare
//! restoring = { value = "2 mN m", standard = "0.2 mN m" }            # K of K sin θ; axis = "stream" only
//! delay     = { value = "0 ms", standard = "5 ms" }                  # of the torque behind the angle; leave out what is to be found
//! cycles    = { skip = 1, used = 5, fewest = 5 }
//!
//! [[source.plan]]
//! role      = "test"                                                 # or dry_air, tare
//! amplitude = ["30 deg", "45 deg", "60 deg"]
//! frequency = ["60 deg/s", "70 deg/s", "80 deg/s"]                   # Hz is a frequency, deg/s and rad/s are angular ones
//! periods   = 7
//! ```

use froude_hydro::swing::Pivot;

use crate::carriage_toml::INERTIA;
use crate::error::RecordError;
use crate::oscillation::{MOST_PERIODS, MOST_RUNS, angular, cycles};
use crate::run::sidecar::declared;
use crate::run::{Declared, Role};
use crate::section::{Section, found};
use crate::section_values::{at_most, count, one_of, series};
use crate::units::Dimension;

/// What is declared of a rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationSpec {
    /// How the axis lies.
    pub axis: Pivot,
    /// J of all that moves below the torque cell, kg m², as far as it is known beforehand.
    pub inertia_kg_m2: Option<Declared>,
    /// J of it without the body, kg m².
    pub tare_inertia_kg_m2: Option<Declared>,
    /// K of the restoring moment K sin θ in water, N m.
    pub restoring_n_m: Option<Declared>,
    /// Delay of the torque behind the angle, s, as far as it is known beforehand.
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

/// One block of planned runs: every amplitude at every frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct RotationPlan {
    /// [`Role::Test`], [`Role::DryAir`] or [`Role::Tare`].
    pub role: Role,
    /// Amplitudes of the angle.
    pub amplitude_rad: Vec<f64>,
    /// Angular frequencies.
    pub omega_rad_s: Vec<f64>,
    /// Periods of each run, start-up included.
    pub periods: f64,
    /// Time at rest before each.
    pub still_s: f64,
    /// Samples a second.
    pub rate_hz: f64,
    /// How often each is run.
    pub repeats: usize,
}

/// Reads `[source.rotation]`.
pub(crate) fn rotation(s: &Section<'_>) -> Result<RotationSpec, RecordError> {
    s.only(&["axis", "inertia", "tare_inertia", "restoring", "delay", "cycles", "harmonics"])?;
    let axis = one_of(s, "axis", &Pivot::NAMES, &Pivot::ALL)?.ok_or_else(|| {
        s.missing(
            "axis",
            "state how the axis of rotation lies: \"upright\" (gravity does nothing) or \"stream\" (level, along the stream: weight and buoyancy \
             restore, and their moment is taken off)",
        )
    })?;
    let restoring_n_m = declared(s, "restoring", Dimension::MOMENT)?;
    match (axis, s.get("restoring")) {
        (Pivot::Upright, Some(value)) => {
            let problem = "about an upright axis gravity restores nothing; leave it out, or write axis = \"stream\"";
            return Err(s.wrong("restoring", value, problem));
        }
        (Pivot::Stream, None) => {
            return Err(s.missing(
                "restoring",
                "about a level axis weight and buoyancy give a moment K sin θ, in phase with the added inertia: declare K, restoring = { value = \"2 mN m\", standard = \
                 \"0.2 mN m\" }, from the torque at rest at two angles; \"0 N m\" where the body is trimmed",
            ));
        }
        _ => {}
    }
    let inertia = |key: &'static str| -> Result<Option<Declared>, RecordError> {
        let number = declared(s, key, INERTIA)?;
        match (number, s.get(key)) {
            (Some(number), Some(value)) if number.value < 0.0 => {
                Err(s.wrong(key, value, "is negative; an inertia is not"))
            }
            _ => Ok(number),
        }
    };
    let (skip, used, fewest) = cycles(s)?;
    Ok(RotationSpec {
        axis,
        inertia_kg_m2: inertia("inertia")?,
        tare_inertia_kg_m2: inertia("tare_inertia")?,
        restoring_n_m,
        delay_s: declared(s, "delay", Dimension::TIME)?,
        skip,
        used,
        fewest,
        harmonics: count(s, "harmonics", 20)?.unwrap_or(3),
    })
}

/// Reads a `[[source.plan]]` of rotations.
pub(crate) fn rotation_plan(s: &Section<'_>) -> Result<RotationPlan, RecordError> {
    s.only(&["role", "amplitude", "frequency", "periods", "still", "rate", "repeats"])?;
    let need = |key: &'static str, example: &str| s.get(key).ok_or_else(|| s.missing(key, example));
    let amplitude = need("amplitude", "write \"45 deg\", a list, or { start, stop, step }")?;
    let frequency = need("frequency", "write \"0.2 Hz\" or \"70 deg/s\", a list, or { start, stop, step }")?;
    let roles = [Role::Test, Role::DryAir, Role::Tare];
    let out = RotationPlan {
        role: one_of(s, "role", &roles.map(Role::name), &roles)?.unwrap_or(Role::Test),
        amplitude_rad: series(s, "amplitude", amplitude, Dimension::ANGLE)?,
        omega_rad_s: angular(s, frequency)?,
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
    let numbers =
        [("amplitude", out.amplitude_rad.len()), ("frequency", out.omega_rad_s.len()), ("repeats", out.repeats)];
    at_most(s, &numbers, MOST_RUNS)?;
    Ok(out)
}
