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

use froude_identify::declare::{IfMissing, Key, Kind, Range};
use froude_records::units::Dimension;

use crate::declared::REPEATS;

const LENS: &[Key] = &[
    Key::new(
        "centre",
        Kind::Number,
        IfMissing::Required("write centre = 960, the pixel that the axis of the lens goes through"),
        "c, pixels",
    ),
    Key::new("radial", Kind::Number, IfMissing::Required("write radial = -2.0e-8, in 1/pixel²"), "k, 1/pixel²"),
];
const TOW: &[Key] = &[
    Key::new("travel", Kind::Quantity(Dimension::LENGTH), IfMissing::Is("0.8 m"), "way of a run")
        .within(Range::Positive),
    Key::new("still", Kind::Quantity(Dimension::TIME), IfMissing::Is("2 s"), "time at rest before and after")
        .within(Range::Positive),
    Key::new("rate", Kind::Quantity(Dimension::ANGULAR_SPEED), IfMissing::Is("50 Hz"), "frames, and samples, a second")
        .within(Range::Positive),
];

/// The keys of `[source.weight_tow]`.
pub const KEYS: &[Key] = &[
    Key::new(
        "scale",
        Kind::Constant(Dimension::LENGTH),
        IfMissing::Nothing("required for a mark in pixels"),
        "size of a pixel at the plane of the mark; its `standard` is an error that all runs share",
    )
    .within(Range::Positive),
    Key::new(
        "lens",
        Kind::Table(LENS),
        IfMissing::Nothing("none"),
        "radial distortion along the rail: x = s (u − c)(1 + k (u − c)²), `centre` c in pixels, `radial` k in 1/pixel²",
    ),
    Key::new(
        "moving_mass",
        Kind::Constant(Dimension::MASS),
        IfMissing::Nothing("none"),
        "all that moves: wagon, rod, body and the water that goes with them; the hanging weight's own mass is added. With it the drag along the rail is that of the balance; without it that of the cell, and runs that are not shown to be steady are left out",
    )
    .within(Range::Positive),
    Key::new("friction", Kind::Constant(Dimension::FORCE), IfMissing::Is("0 N"), "of pulleys and rail")
        .within(Range::NotNegative("friction is not")),
    Key::new(
        "window",
        Kind::Quantity(Dimension::LENGTH),
        IfMissing::Is("0.2 m"),
        "the last part of the way, over which speed and loads are taken",
    )
    .within(Range::Positive),
    Key::new(
        "tolerance",
        Kind::Quantity(Dimension::ONE),
        IfMissing::Is("2 %"),
        "change of the speed over it that still counts as steady",
    )
    .within(Range::Positive),
    Key::new(
        "reached",
        Kind::Quantity(Dimension::ONE),
        IfMissing::Is("50 %"),
        "part of the terminal speed that a run must have",
    )
    .within(Range::Positive),
    Key::new(
        "tow",
        Kind::Table(TOW),
        IfMissing::Is("{ travel = \"0.8 m\", still = \"2 s\", rate = \"50 Hz\" }"),
        "of planned runs: `travel`, time at rest before and after (`still`), frames a second (`rate`)",
    ),
];

/// The keys of a block of a plan.
pub const PLAN: &[Key] = &[
    Key::new("configurations", Kind::Texts, IfMissing::Nothing("one unnamed body"), "names of the configurations"),
    Key::new(
        "weight",
        Kind::Axis(Dimension::FORCE),
        IfMissing::Required("write \"100 mN\", a list, or { start, stop, step }"),
        "the hanging weight",
    )
    .within(Range::Positive),
    Key::new("angle", Kind::Axis(Dimension::ONE), IfMissing::Is("0 deg"), "angle of the body to the rail"),
    REPEATS,
];
