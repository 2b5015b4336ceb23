//! The channels of a weight-driven run.

use froude_records::units::Dimension;

use crate::channel::Channel;

const WAY: Channel = Channel {
    dimension: Dimension::LENGTH,
    unit: "m",
    shown: "m",
    along: "the wagon's way along the rail, either way",
    column: ("position", "sensor", "", 6),
    ..Channel::GENERAL
};
const LOAD: Channel = Channel {
    dimension: Dimension::FORCE,
    unit: "N",
    shown: "N",
    along: "the water on the body, along its axes",
    zero: 0.2,
    ..Channel::GENERAL
};
pub(super) const MARK: Channel = Channel {
    name: "mark",
    dimension: Dimension::ONE,
    unit: "1",
    column: ("mark", "sensor", "   # pixels along the rail", 4),
    ..WAY
};
/// Of the mark or the wagon, the first that a log has.
pub(super) const WAYS: &[Channel] = &[MARK, Channel { name: "y/position", ..WAY }, Channel { name: "position", ..WAY }];
pub(super) const LOADS: &[Channel] = &[
    Channel { name: "f_x", column: ("f_x", "body", "", 6), ..LOAD },
    Channel { name: "f_y", column: ("f_y", "body", "", 6), ..LOAD },
];
