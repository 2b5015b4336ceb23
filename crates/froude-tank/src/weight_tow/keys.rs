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

use froude_identify::declare::{Key, Kind, Range, Values, optional, required, usual};
use froude_records::RecordError;
use froude_records::run::Declared as Number;
use froude_records::units::Dimension;

use super::track::Lens;
use crate::declared::REPEATS;

const LENS: &[Key] = &[
    required(
        "centre",
        Kind::Number,
        "write centre = 960, the pixel that the axis of the lens goes through",
        "c, pixels",
    ),
    required("radial", Kind::Number, "write radial = -2.0e-8, in 1/pixel²", "k, 1/pixel²"),
];
const TOW: &[Key] = &[
    usual("travel", Kind::Quantity(Dimension::LENGTH), "0.8 m", "travel of a run").within(Range::Positive),
    usual("still", Kind::Quantity(Dimension::TIME), "2 s", "time at rest before and after").within(Range::Positive),
    usual("rate", Kind::Quantity(Dimension::ANGULAR_SPEED), "50 Hz", "frames, and samples, a second")
        .within(Range::Positive),
];

/// The keys of `[source.weight_tow]`.
pub const KEYS: &[Key] = &[
    optional(
        "scale",
        Kind::Constant(Dimension::LENGTH),
        "required for a mark in pixels",
        "size of a pixel at the plane of the mark; its `standard` is an error that all runs share",
    )
    .within(Range::Positive),
    optional(
        "lens",
        Kind::Table(LENS),
        "none",
        "radial distortion along the rail: x = s (u − c)(1 + k (u − c)²), `centre` c in pixels, `radial` k in 1/pixel²",
    ),
    optional(
        "moving_mass",
        Kind::Constant(Dimension::MASS),
        "none",
        "all that moves: wagon, rod, body and the water that goes with them; the hanging weight's own mass is added. With it the drag along the rail is that of the balance; without it that of the cell, and runs that are not shown to be steady are left out",
    )
    .within(Range::Positive),
    usual("friction", Kind::Constant(Dimension::FORCE), "0 N", "of pulleys and rail")
        .within(Range::NotNegative("friction is not")),
    usual(
        "window",
        Kind::Quantity(Dimension::LENGTH),
        "0.2 m",
        "the last part of the way, over which speed and loads are taken",
    )
    .within(Range::Positive),
    usual("tolerance", Kind::Quantity(Dimension::ONE), "2 %", "speed change over the window that still counts as steady")
    .within(Range::Positive),
    usual("reached", Kind::Quantity(Dimension::ONE), "50 %", "part of the terminal speed that a run must have")
    .within(Range::Positive),
    usual(
        "tow",
        Kind::Table(TOW),
        "{ travel = \"0.8 m\", still = \"2 s\", rate = \"50 Hz\" }",
        "of planned runs: `travel`, time at rest before and after (`still`), frames a second (`rate`)",
    ),
];

/// The keys of a block of a plan.
pub const PLAN: &[Key] = &[
    optional("configurations", Kind::Texts, "one unnamed body", "names of the configurations"),
    required(
        "weight",
        Kind::Axis(Dimension::FORCE),
        "write \"100 mN\", a list, or { start, stop, step }",
        "the hanging weight",
    )
    .within(Range::Positive),
    usual("angle", Kind::Axis(Dimension::ONE), "0 deg", "angle of the body to the rail"),
    REPEATS,
];

/// What is declared of rig and camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightTow {
    /// Size of a pixel at the plane of the mark, m.
    pub scale_m: Option<Number>,
    /// The camera's lens.
    pub lens: Option<Lens>,
    /// All that moves with the wagon, and its water, kg.
    pub moving_mass_kg: Option<Number>,
    /// Of pulleys and rail, N.
    pub friction_n: Number,
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
    /// Whether the budget has an error of the angle, which the balance lacks.
    pub has_angle_error: bool,
    /// Errors of the track, m, which take the place of those that it shows: of a run that is only planned.
    pub noise_m: Option<f64>,
}

/// Size of a pixel of a twin whose campaign declares none, m.
pub(super) const USUAL_SCALE_M: f64 = 1.2e-3;

impl WeightTow {
    /// Size of a pixel, m: a twin logs a mark whatever is declared.
    pub(super) fn pixel_m(&self) -> f64 {
        self.scale_m.map_or(USUAL_SCALE_M, |scale| scale.value)
    }

    pub(super) fn of(values: &Values) -> Result<Self, RecordError> {
        let number = |values: &Values, key: &str| values.need(key, values.number(key));
        let lens = values.table("lens").map(|l| -> Result<Lens, RecordError> {
            Ok(Lens { centre_px: number(l, "centre")?, radial: number(l, "radial")? })
        });
        let tow = values.need("tow", values.table("tow"))?;
        Ok(Self {
            scale_m: values.constant("scale"),
            lens: lens.transpose()?,
            moving_mass_kg: values.constant("moving_mass"),
            friction_n: values.need("friction", values.constant("friction"))?,
            window_m: number(values, "window")?,
            tolerance: number(values, "tolerance")?,
            reached: number(values, "reached")?,
            travel_m: number(tow, "travel")?,
            still_s: number(tow, "still")?,
            rate_hz: number(tow, "rate")?,
            has_angle_error: false,
            noise_m: None,
        })
    }
}
