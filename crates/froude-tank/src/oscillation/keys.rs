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

use froude_hydro::swing::Pivot;
use froude_identify::declare::{Key, Kind, Range, optional, required, usual};
use froude_records::units::Dimension;

use crate::declared::{CYCLES, FREQUENCY, HARMONICS, PERIODS, RATE, REPEATS, STILL, amplitude};

/// The keys of `[source.forced_oscillation]`.
pub const KEYS: &[Key] = &[
    required("pivot", Kind::Word(&Pivot::NAMES), "state how the pivot axis lies: \"stream\" (along the stream, the body swings across it like a pendulum) or \"upright\" (the body \
             turns its heading into the stream); the two give different velocities and different added masses", "`stream` or `upright`"),
    required(
        "radius",
        Kind::Constant(Dimension::LENGTH),
        "write radius = { value = \"476 mm\", standard = \"1 mm\" }",
        "from the pivot axis to the body's reference point; `standard` is a standard uncertainty, here and below, and a number without it counts as exact",
    )
    .within(Range::NotZero("the body swings about a pivot that lies away from it")),
    required(
        "mass",
        Kind::PerConfiguration(Dimension::MASS),
        "write mass = { value = \"1.63 kg\", standard = \"5 g\" }: all that moves below the load cell; by configuration where there are several",
        "all that moves below the load cell: one number, or one for each configuration",
    )
    .within(Range::NotNegative("a mass is not")),
    optional(
        "buoyancy",
        Kind::PerConfiguration(Dimension::FORCE),
        "to be found",
        "buoyancy less weight, upwards positive, as far as it is known beforehand",
    ),
    optional(
        "delay",
        Kind::Constant(Dimension::TIME),
        "to be found",
        "delay of the force relative to the angle, positive if the force is stamped late",
    ),
    CYCLES,
    HARMONICS,
];

/// The keys of a block of a plan.
pub const PLAN: &[Key] = &[
    optional(
        "configurations",
        Kind::Texts,
        "one unnamed body",
        "names of the configurations, as in `mass` and `buoyancy`",
    ),
    usual("medium", Kind::Word(&["water", "air"]), "water", "`water`, or `air`, which determines only mass and delay"),
    usual("flow", Kind::Axis(Dimension::SPEED), "0 m/s", "speed of the stream"),
    amplitude(Dimension::ANGLE, "write \"10 deg\", a list, or { start, stop, step }", "amplitude of the angle"),
    FREQUENCY,
    PERIODS,
    STILL,
    RATE,
    REPEATS,
];
