//! `[source.steady]`: how the steady window of a tow is chosen, where its zero comes from, and how tows are driven that are planned.
//!
//! ```toml
//! [source.steady]
//! settle    = "1 s"                                  # left out after the speed became constant
//! shortest  = "2 s"                                  # a shorter window is none
//! tolerance = "1 %"                                  # of the speed of each block about that of the window
//! block     = "0.5 s"
//! drift     = { rate = "2 mN/min", most = "10 mN" }  # of the zero between a still run and a test
//! tow       = { still = "5 s", acceleration = "0.3 m/s^2", steady = "10 s", rate = "100 Hz" }
//! ```

use crate::names::STEADY;
use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_records::section::Section;
use froude_records::units::Dimension;
use froude_rig::steady::Tow;

/// N/s.
const FORCE_RATE: Dimension = Dimension::new(1, 1, -3);

/// How steady tows are reduced, and how planned ones are driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadySpec {
    /// Left out after the speed became constant, s.
    pub settle_s: f64,
    /// Shortest window, s.
    pub shortest_s: f64,
    /// Largest difference between the speed of a block and that of the window, as part of it.
    pub tolerance: f64,
    /// Length of a block, s.
    pub block_s: f64,
    /// How the zero of the sensor drifts.
    pub drift: Option<Drift>,
    /// How planned tows are driven.
    pub tow: Tow,
}

/// Drift of a zero between a still run and a test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// As much as it may be, N/s.
    pub rate_n_s: f64,
    /// More than this makes a zero useless, N.
    pub most_n: f64,
}

impl Default for SteadySpec {
    fn default() -> Self {
        let tow = Tow { still_s: 5.0, acceleration_m_s2: 0.3, steady_s: 10.0, rate_hz: 100.0 };
        Self { settle_s: 1.0, shortest_s: 2.0, tolerance: 0.01, block_s: 0.5, drift: None, tow }
    }
}

/// What a source says of it, or what is usual.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn declared(source: &Source) -> Result<SteadySpec, RecordError> {
    source.section(STEADY)?.map_or_else(|| Ok(SteadySpec::default()), |s| steady(&s))
}

/// Reads `[source.steady]`.
fn steady(s: &Section<'_>) -> Result<SteadySpec, RecordError> {
    s.only(&["settle", "shortest", "tolerance", "block", "drift", "tow"])?;
    let usual = SteadySpec::default();
    let drift = s.section("drift")?.map(|d| -> Result<Drift, RecordError> {
        d.only(&["rate", "most"])?;
        let need = |key: &'static str, dimension, like: &str| {
            d.positive(key, dimension)?.ok_or_else(|| d.missing(key, &format!("write {key} = \"{like}\"")))
        };
        Ok(Drift { rate_n_s: need("rate", FORCE_RATE, "2 mN/min")?, most_n: need("most", Dimension::FORCE, "10 mN")? })
    });
    let tow = match s.section("tow")? {
        None => usual.tow,
        Some(t) => {
            t.only(&["still", "acceleration", "steady", "rate"])?;
            Tow {
                still_s: t.positive("still", Dimension::TIME)?.unwrap_or(usual.tow.still_s),
                acceleration_m_s2: t
                    .positive("acceleration", Dimension::ACCELERATION)?
                    .unwrap_or(usual.tow.acceleration_m_s2),
                steady_s: t.positive("steady", Dimension::TIME)?.unwrap_or(usual.tow.steady_s),
                rate_hz: t.positive("rate", Dimension::ANGULAR_SPEED)?.unwrap_or(usual.tow.rate_hz),
            }
        }
    };
    let out = SteadySpec {
        settle_s: s.quantity("settle", Dimension::TIME)?.unwrap_or(usual.settle_s),
        shortest_s: s.positive("shortest", Dimension::TIME)?.unwrap_or(usual.shortest_s),
        tolerance: s.positive("tolerance", Dimension::ONE)?.unwrap_or(usual.tolerance),
        block_s: s.positive("block", Dimension::TIME)?.unwrap_or(usual.block_s),
        drift: drift.transpose()?,
        tow,
    };
    if let (true, Some(value)) = (out.settle_s < 0.0, s.get("settle")) {
        return Err(s.wrong("settle", value, "is negative; a time that is left out is not"));
    }
    Ok(out)
}
