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

use froude_identify::declare::{ByConfiguration, Key, Kind, Range, Values, optional, required, usual};
use froude_records::RecordError;
use froude_records::campaign::{BodyAxis, Source};
use froude_records::run::{Declared, Role};
use froude_records::section::Section;
use froude_records::units::Dimension;
use froude_rig::accelerated_tow::Profile;

use crate::declared::REPEATS;
use crate::matrix::{Plan, Point};
use crate::names::ACCELERATED_TOW;

/// The keys of `[source.accelerated_tow]`.
pub const KEYS: &[Key] = &[
    required(
        "axis",
        Kind::Word(&["x", "y"]),
        "state which axis of the body lies along the travel: \"x\" (forward) or \"y\" (to starboard); drag and added mass are those along it",
        "the axis of the body that lies along the travel, `x` or `y`: drag and added mass are those along it",
    ),
    optional(
        "mass",
        Kind::PerConfiguration(Dimension::MASS),
        "by runs in air",
        "all that moves below the load cell; one number, or one for each configuration. Runs of the role `dry_air` determine it instead and override what is declared",
    )
    .within(Range::Positive),
    optional(
        "delay",
        Kind::Constant(Dimension::TIME),
        "none taken",
        "delay of the force relative to the motion, from filters and samplers in one channel only. Its `standard` is in the budget",
    ),
    usual(
        "window",
        Kind::Quantity(Dimension::TIME),
        "0.4 s",
        "length of the windows that motion and force are weighted over",
    )
    .within(Range::Positive),
];

/// The keys of a block of a plan.
pub const PLAN: &[Key] = &[
    optional("configurations", Kind::Texts, "one unnamed body", "names of the configurations, as in `mass`"),
    usual("medium", Kind::Word(&["water", "air"]), "water", "`water`, or `air`, which determines the mass alone"),
    required(
        "speed",
        Kind::Axis(Dimension::SPEED),
        "write \"0.3 m/s\", a list, or { start, stop, step }",
        "speed that is reached, ahead or (below zero) astern",
    )
    .within(Range::NotZero("a tow goes somewhere, ahead or (below zero) astern")),
    required(
        "acceleration",
        Kind::Axis(Dimension::ACCELERATION),
        "write \"0.2 m/s^2\", a list, or { start, stop, step }",
        "up to it and back to rest; its sign is that of the speed",
    )
    .within(Range::Positive),
    usual("steady", Kind::Quantity(Dimension::TIME), "4 s", "time at the speed").within(Range::Positive),
    usual("still", Kind::Quantity(Dimension::TIME), "5 s", "time at rest before and after").within(Range::Positive),
    usual("rate", Kind::Quantity(Dimension::ANGULAR_SPEED), "100 Hz", "sampling rate of the log")
        .within(Range::Positive),
    REPEATS,
];

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

/// Reads `[source.accelerated_tow]`.
pub(super) fn accelerated_tow(s: &Section<'_>) -> Result<AcceleratedTowSpec, RecordError> {
    let values = Values::read(s, KEYS)?;
    Ok(AcceleratedTowSpec {
        axis: values.need("axis", values.word("axis", &[BodyAxis::X, BodyAxis::Y]))?,
        mass_kg: values.by_configuration("mass"),
        delay_s: values.constant("delay"),
        window_s: values.need("window", values.number("window"))?,
    })
}

/// The runs that a source plans.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn plan(source: &Source) -> Result<Vec<Point>, RecordError> {
    let roles = ("medium", &[Role::Test, Role::DryAir][..]);
    Plan { roles, ..Plan::of(PLAN, |point| (1, profile(point).duration_s())) }.points(source, ACCELERATED_TOW)
}

/// How a planned run moves.
#[must_use]
pub fn profile(point: &Point) -> Profile {
    let [speed_m_s, acceleration_m_s2] = ["speed", "acceleration"].map(|name| point.condition(name));
    let [steady_s, still_s] = ["steady", "still"].map(|name| point.condition(name));
    Profile { speed_m_s, acceleration_m_s2, steady_s, still_s }
}
