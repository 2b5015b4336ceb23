//! `[source.sway]`: what is declared of a body that a planar motion mechanism moves sideways, and the runs that are planned of it.
//!
//! ```toml
//! [source.sway]
//! mass   = { value = "46.5 kg", standard = "0.05 kg" }     # of all that moves below the load cell
//! x_g    = { value = "12 mm", standard = "2 mm" }          # its centre of gravity, forward of the reference point
//! length = "1.8 m"                                         # for the nondimensional coefficients
//! delay  = { value = "0 ms", standard = "2 ms" }           # of the loads behind the motion; leave out what is to be found
//!
//! [[source.plan]]
//! amplitude = "80 mm"
//! frequency = ["0.1 Hz", "0.15 Hz", "0.2 Hz", "0.25 Hz", "0.3 Hz"]
//! speed     = "1 m/s"
//! ```

use froude_identify::declare::{Key, Kind, Range, optional, required, usual};
use froude_records::units::Dimension;

use crate::declared::{CYCLES, FREQUENCY, HARMONICS, PERIODS, RATE, REPEATS, STILL, amplitude};

/// The keys of `[source.sway]`.
pub const KEYS: &[Key] = &[
    required(
        "mass",
        Kind::Constant(Dimension::MASS),
        "write mass = { value = \"46.5 kg\", standard = \"0.05 kg\" }: of all that moves below the load cell, with the water that the hull encloses",
        "of all that moves below the load cell, with the water that the hull encloses; runs in air need the same water in it; `standard` is a standard uncertainty, here and below, and a number without it counts as exact",
    )
    .within(Range::NotNegative("a mass is not")),
    required(
        "x_g",
        Kind::Constant(Dimension::LENGTH),
        "write x_g = { value = \"12 mm\", standard = \"2 mm\" }: the centre of gravity forward of the reference point, \"0 mm\" if they coincide",
        "centre of gravity of that mass, forward of the reference point of the moment",
    ),
    optional(
        "length",
        Kind::Quantity(Dimension::LENGTH),
        "no nondimensional coefficients",
        "L of the nondimensional coefficients and of the reduced frequency ωL/U",
    )
    .within(Range::Positive),
    optional(
        "delay",
        Kind::Constant(Dimension::TIME),
        "to be found",
        "of the loads behind the motion, positive where they are stamped late",
    ),
    CYCLES,
    HARMONICS,
];

/// The keys of a block of a plan.
pub const PLAN: &[Key] = &[
    usual(
        "medium",
        Kind::Word(&["water", "air"]),
        "water",
        "`water`, or `air`: the same motion in air, which determines mass and delay",
    ),
    usual("speed", Kind::Axis(Dimension::SPEED), "0 m/s", "speed forward, through the water"),
    amplitude(Dimension::LENGTH, "write \"80 mm\", a list, or { start, stop, step }", "amplitude of the sway"),
    FREQUENCY,
    PERIODS,
    STILL,
    RATE,
    REPEATS,
];
