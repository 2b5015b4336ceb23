//! `[source.weight_tow]`: a wagon that a hanging weight pulls along a rail, filmed by a camera, and the runs that are planned of it.
//!
//! ```toml
//! [source.weight_tow]
//! scale       = { value = "1.2 mm", standard = "1 %" }     # of a pixel, at the mark; not needed for positions in metres
//! lens        = { centre = 960, radial = -2.0e-8 }         # x ← (x − centre)(1 + radial (x − centre)²), pixels
//! moving_mass = { value = "4 kg", standard = "0.1 kg" }    # body, rod, wagon, and the water that goes with them
//! friction    = { value = "20 mN", standard = "5 mN" }     # of pulleys and rail
//! window      = "0.2 m"                                    # the last part of the way
//! tolerance   = "2 %"                                      # change of speed over it that still counts as steady
//! reached     = "50 %"                                     # of the terminal speed, for a balance
//! tow         = { travel = "0.8 m", still = "2 s", rate = "50 Hz" }
//!
//! [[source.plan]]
//! configurations = ["H1LT"]
//! weight = ["50 mN", "100 mN"]
//! angle  = { start = "3 deg", stop = "39 deg", step = "3 deg" }
//! ```

use crate::error::RecordError;
use crate::run::Declared;
use crate::run::sidecar::declared;
use crate::section::Section;
use crate::section_values::{at_most, count, series};
use crate::units::Dimension;

/// Most runs that one block of a plan makes.
const MOST_RUNS: usize = 10_000;

/// What is declared of rig and camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightTowSpec {
    /// Size of a pixel at the plane of the mark, m.
    pub scale_m: Option<Declared>,
    /// The camera's lens.
    pub lens: Option<Lens>,
    /// All that moves with the wagon, and its water, kg.
    pub moving_mass_kg: Option<Declared>,
    /// Of pulleys and rail, N.
    pub friction_n: Declared,
    /// The last part of the way, m, that speed and loads are taken over.
    pub window_m: f64,
    /// Change of the speed over it that counts as steady, as part of the speed.
    pub tolerance: f64,
    /// Part of the terminal speed that a balanced run must have reached.
    pub reached: f64,
    /// Way of a planned run, m.
    pub travel_m: f64,
    /// Its time at rest before and after, s.
    pub still_s: f64,
    /// Its frames, and samples, a second.
    pub rate_hz: f64,
}

/// Radial distortion along the rail: x ← (x − c)(1 + k (x − c)²).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// c, pixels.
    pub centre_px: f64,
    /// k, 1/pixel².
    pub radial: f64,
}

/// One block of planned runs: every weight at every angle for every configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightPlan {
    /// Configurations; one empty text where the body has only one.
    pub configurations: Vec<String>,
    /// Weights, N.
    pub weight_n: Vec<f64>,
    /// Angles of attack.
    pub angle_rad: Vec<f64>,
    /// How often each is run.
    pub repeats: usize,
}

/// Reads `[source.weight_tow]`.
pub(crate) fn weight_tow(s: &Section<'_>) -> Result<WeightTowSpec, RecordError> {
    s.only(&["scale", "lens", "moving_mass", "friction", "window", "tolerance", "reached", "tow"])?;
    let lens = s.section("lens")?.map(|l| -> Result<Lens, RecordError> {
        l.only(&["centre", "radial"])?;
        let need = |key: &'static str, like: &str| l.number(key)?.ok_or_else(|| l.missing(key, like));
        Ok(Lens {
            centre_px: need("centre", "write centre = 960, the pixel that the axis of the lens goes through")?,
            radial: need("radial", "write radial = -2.0e-8, in 1/pixel²")?,
        })
    });
    let positive = |key: &'static str, dimension| -> Result<Option<Declared>, RecordError> {
        let found = declared(s, key, dimension)?;
        match (found, s.get(key)) {
            (Some(number), Some(value)) if number.value <= 0.0 => Err(s.wrong(key, value, "must be larger than zero")),
            _ => Ok(found),
        }
    };
    let friction = declared(s, "friction", Dimension::FORCE)?;
    if let (Some(number), Some(value)) = (friction.filter(|f| f.value < 0.0), s.get("friction")) {
        return Err(s.wrong("friction", value, format!("is {} N; friction is not negative", number.value)));
    }
    let tow = s.section("tow")?;
    if let Some(tow) = &tow {
        tow.only(&["travel", "still", "rate"])?;
    }
    let of_tow = |key: &'static str, dimension, usual: f64| -> Result<f64, RecordError> {
        Ok(tow.as_ref().map(|t| t.positive(key, dimension)).transpose()?.flatten().unwrap_or(usual))
    };
    Ok(WeightTowSpec {
        scale_m: positive("scale", Dimension::LENGTH)?,
        lens: lens.transpose()?,
        moving_mass_kg: positive("moving_mass", Dimension::MASS)?,
        friction_n: friction.unwrap_or(Declared::exact(0.0)),
        window_m: s.positive("window", Dimension::LENGTH)?.unwrap_or(0.2),
        tolerance: s.positive("tolerance", Dimension::ONE)?.unwrap_or(0.02),
        reached: s.positive("reached", Dimension::ONE)?.unwrap_or(0.5),
        travel_m: of_tow("travel", Dimension::LENGTH, 0.8)?,
        still_s: of_tow("still", Dimension::TIME, 2.0)?,
        rate_hz: of_tow("rate", Dimension::ANGULAR_SPEED, 50.0)?,
    })
}

/// Reads a `[[source.plan]]` of weights.
pub(crate) fn weight_plan(s: &Section<'_>) -> Result<WeightPlan, RecordError> {
    s.only(&["configurations", "weight", "angle", "repeats"])?;
    let weight =
        s.get("weight").ok_or_else(|| s.missing("weight", "write \"100 mN\", a list, or { start, stop, step }"))?;
    let mut configurations = s.texts("configurations")?;
    if configurations.is_empty() {
        configurations.push(String::new());
    }
    let out = WeightPlan {
        configurations,
        weight_n: series(s, "weight", weight, Dimension::FORCE)?,
        angle_rad: s.get("angle").map_or(Ok(vec![0.0]), |v| series(s, "angle", v, Dimension::ONE))?,
        repeats: count(s, "repeats", MOST_RUNS as u64)?.unwrap_or(1),
    };
    if out.weight_n.iter().any(|w| *w <= 0.0) {
        return Err(s.wrong("weight", weight, "must be larger than zero"));
    }
    let numbers = [
        ("configurations", out.configurations.len()),
        ("weight", out.weight_n.len()),
        ("angle", out.angle_rad.len()),
        ("repeats", out.repeats),
    ];
    at_most(s, &numbers, MOST_RUNS)?;
    Ok(out)
}
