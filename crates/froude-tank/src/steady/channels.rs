//! The channels of a steady tow.

use froude_records::units::Dimension;

use crate::channel::Channel;

const SPEED: Channel = Channel {
    name: "speed",
    dimension: Dimension::SPEED,
    unit: "m/s",
    shown: "m/s",
    along: "the body's way through the water",
    column: ("speed", "body", "", 7),
    ..Channel::GENERAL
};
/// Of speed and position, the first that a log has.
pub(super) const WAYS: &[Channel] = &[
    SPEED,
    Channel { name: "position", dimension: Dimension::LENGTH, unit: "m", shown: "m", ..SPEED },
    Channel { name: "y/position", dimension: Dimension::LENGTH, unit: "m", shown: "m", ..SPEED },
];

const fn load(name: &'static str, dimension: Dimension, unit: &'static str) -> Channel {
    let (along, column) = ("the water on the body, along its axes", (name, "body", "", 6));
    Channel { name, dimension, unit, shown: unit, along, column, zero: 0.2, ..Channel::GENERAL }
}
/// Loads that a log may have.
pub(super) const LOADS: &[Channel] = &[
    load("f_x", Dimension::FORCE, "N"),
    load("f_y", Dimension::FORCE, "N"),
    load("f_z", Dimension::FORCE, "N"),
    load("m_x", Dimension::MOMENT, "N m"),
    load("m_y", Dimension::MOMENT, "N m"),
    load("m_z", Dimension::MOMENT, "N m"),
];
