//! `[source.steady]`: how the steady window of a tow is chosen, where its zero comes from, and how tows are driven that are planned.
//!
//! ```toml
//! [source.steady]
//! settle    = "1 s"                                  # left out after the speed became constant
//! shortest  = "2 s"                                  # of a window that is accepted
//! tolerance = "1 %"                                  # of the speed of each block about that of the window
//! block     = "0.5 s"
//! drift     = { rate = "2 mN/min", most = "10 mN" }  # of the zero between a still run and a test
//! tow       = { still = "5 s", acceleration = "0.3 m/s^2", steady = "10 s", rate = "100 Hz" }
//! ```

use froude_identify::declare::{Key, Kind, Range, Values, optional, required, usual};
use froude_records::RecordError;
use froude_records::units::Dimension;
use froude_rig::steady::Tow;

use crate::declared::REPEATS;

/// N/s.
const FORCE_RATE: Dimension = Dimension::new(1, 1, -3);

const fn positive(name: &'static str, dimension: Dimension, default: &'static str, doc: &'static str) -> Key {
    usual(name, Kind::Quantity(dimension), default, doc).within(Range::Positive)
}

const fn needed(name: &'static str, dimension: Dimension, advice: &'static str, doc: &'static str) -> Key {
    required(name, Kind::Quantity(dimension), advice, doc).within(Range::Positive)
}

/// The keys of `[source.steady]`.
pub const KEYS: &[Key] = &[
    positive("block", Dimension::TIME, "0.5 s", "the speed is averaged over blocks of this length"),
    positive(
        "tolerance",
        Dimension::ONE,
        "1 %",
        "a stretch is steady where its blocks lie within ± this of the middle of their range",
    ),
    usual(
        "settle",
        Kind::Quantity(Dimension::TIME),
        "1 s",
        "left out at the start of that stretch, and after the body has come to rest",
    )
    .within(Range::NotNegative("a time that is left out is not")),
    positive("shortest", Dimension::TIME, "2 s", "shortest window that is accepted"),
    optional(
        "drift",
        Kind::Table(&[
            needed("rate", FORCE_RATE, "write rate = \"2 mN/min\"", "as much as it may be"),
            needed("most", Dimension::FORCE, "write most = \"10 mN\"", "more than this makes a zero useless"),
        ]),
        "not declared",
        "how far the zero of the cell may drift between a still run and a test (`rate`), and how much of it is accepted (`most`)",
    ),
    usual(
        "tow",
        Kind::Table(&[
            positive("still", Dimension::TIME, "5 s", "at rest before and after"),
            positive("acceleration", Dimension::ACCELERATION, "0.3 m/s^2", "up to speed and back"),
            positive("steady", Dimension::TIME, "10 s", "at constant speed"),
            positive("rate", Dimension::ANGULAR_SPEED, "100 Hz", "samples a second"),
        ]),
        "{ still = \"5 s\", acceleration = \"0.3 m/s^2\", steady = \"10 s\", rate = \"100 Hz\" }",
        "how planned runs are driven: time at rest before and after, acceleration, time at constant speed, samples a second",
    ),
];

/// The keys of a block of a plan.
pub const PLAN: &[Key] = &[
    optional("configurations", Kind::Texts, "one unnamed body", "names of the configurations"),
    required(
        "speed",
        Kind::Axis(Dimension::SPEED),
        "write \"0.1 m/s\", a list, or { start, stop, step }",
        "speed of the tow, ahead or (below zero) astern",
    )
    .within(Range::NotZero("a tow goes somewhere, ahead or (below zero) astern")),
    usual("angle", Kind::Axis(Dimension::ONE), "0 deg", "angle between the body and the direction of the tow"),
    REPEATS,
];

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

impl SteadySpec {
    /// By the values of [`KEYS`].
    pub(super) fn of(values: &Values) -> Result<Self, RecordError> {
        let number = |values: &Values, key: &str| values.need(key, values.number(key));
        let drift = values.table("drift").map(|d| -> Result<Drift, RecordError> {
            Ok(Drift { rate_n_s: number(d, "rate")?, most_n: number(d, "most")? })
        });
        let tow = values.need("tow", values.table("tow"))?;
        Ok(Self {
            settle_s: number(values, "settle")?,
            shortest_s: number(values, "shortest")?,
            tolerance: number(values, "tolerance")?,
            block_s: number(values, "block")?,
            drift: drift.transpose()?,
            tow: Tow {
                still_s: number(tow, "still")?,
                acceleration_m_s2: number(tow, "acceleration")?,
                steady_s: number(tow, "steady")?,
                rate_hz: number(tow, "rate")?,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use froude_records::section::{Section, Source as Text, parse};

    use super::*;

    #[test]
    fn an_empty_section_is_what_is_usual() {
        let text = Text { path: std::path::Path::new("c.toml"), text: "" };
        let document = parse(text).unwrap();
        let section = Section::new(text, "source.steady", document.get_ref(), 0);
        assert_eq!(SteadySpec::of(&Values::read(&section, KEYS).unwrap()).unwrap(), SteadySpec::default());
    }
}
