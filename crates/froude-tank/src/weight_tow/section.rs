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

use crate::names::WEIGHT_TOW;
use froude_records::RecordError;
use froude_records::campaign::{PlanBlock, Source};
use froude_records::run::{Declared, declared};
use froude_records::section::Section;
use froude_records::section_values::{Asks, MOST_RUNS, at_most, configurations, count, series};
use froude_records::units::Dimension;

use crate::declared::{above_zero, runs_of};

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

/// Reads `[source.weight_tow]`.
pub(super) fn weight_tow(s: &Section<'_>) -> Result<WeightTowSpec, RecordError> {
    s.only(&["scale", "lens", "moving_mass", "friction", "window", "tolerance", "reached", "tow"])?;
    let lens = s.section("lens")?.map(|l| -> Result<Lens, RecordError> {
        l.only(&["centre", "radial"])?;
        let need = |key: &'static str, like: &str| l.number(key)?.ok_or_else(|| l.missing(key, like));
        Ok(Lens {
            centre_px: need("centre", "write centre = 960, the pixel that the axis of the lens goes through")?,
            radial: need("radial", "write radial = -2.0e-8, in 1/pixel²")?,
        })
    });
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
        scale_m: above_zero(s, "scale", Dimension::LENGTH)?,
        lens: lens.transpose()?,
        moving_mass_kg: above_zero(s, "moving_mass", Dimension::MASS)?,
        friction_n: friction.unwrap_or(Declared::exact(0.0)),
        window_m: s.positive("window", Dimension::LENGTH)?.unwrap_or(0.2),
        tolerance: s.positive("tolerance", Dimension::ONE)?.unwrap_or(0.02),
        reached: s.positive("reached", Dimension::ONE)?.unwrap_or(0.5),
        travel_m: of_tow("travel", Dimension::LENGTH, 0.8)?,
        still_s: of_tow("still", Dimension::TIME, 2.0)?,
        rate_hz: of_tow("rate", Dimension::ANGULAR_SPEED, 50.0)?,
    })
}

/// The runs that a source plans: every weight at every angle for every configuration. A weight, N, stands where the speed of a table's plan does.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn plan(source: &Source) -> Result<Vec<PlanBlock>, RecordError> {
    runs_of(source, WEIGHT_TOW, block, |p| Asks {
        count: p.configurations.len() * p.speed_m_s.len() * p.angle_rad.len() * p.repeats,
        samples: 0.0,
    })
}

/// Reads a `[[source.plan]]` of weights.
fn block(s: &Section<'_>) -> Result<PlanBlock, RecordError> {
    s.only(&["configurations", "weight", "angle", "repeats"])?;
    let weight =
        s.get("weight").ok_or_else(|| s.missing("weight", "write \"100 mN\", a list, or { start, stop, step }"))?;
    let out = PlanBlock {
        configurations: configurations(s)?,
        speed_m_s: series(s, "weight", weight, Dimension::FORCE)?,
        angle_rad: s.get("angle").map_or(Ok(vec![0.0]), |v| series(s, "angle", v, Dimension::ONE))?,
        pitch_rad: vec![0.0],
        repeats: count(s, "repeats", MOST_RUNS as u64)?.unwrap_or(1),
    };
    if out.speed_m_s.iter().any(|w| *w <= 0.0) {
        return Err(s.wrong("weight", weight, "must be larger than zero"));
    }
    let numbers = [
        ("configurations", out.configurations.len()),
        ("weight", out.speed_m_s.len()),
        ("angle", out.angle_rad.len()),
        ("repeats", out.repeats),
    ];
    at_most(&s.place(), &numbers, MOST_RUNS)?;
    Ok(out)
}
