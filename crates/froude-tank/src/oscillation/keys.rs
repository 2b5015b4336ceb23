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
//! still_runs = { zeroed = "once", drift = "5 mN" }           # required with still runs
//!
//! [[source.plan]]
//! configurations = ["H1LT", "H2LT"]
//! amplitude      = ["10 deg", "15 deg", "20 deg"]
//! frequency      = ["60 deg/s", "70 deg/s", "80 deg/s"]      # Hz is a frequency, deg/s and rad/s are angular ones
//! flow           = "0.2 m/s"
//! periods        = 7
//!
//! [[source.plan]]
//! configurations = ["H1LT", "H2LT"]
//! medium         = "still"                                   # held still in water, at these angles
//! angle          = ["20 deg", "-20 deg", "10 deg", "-10 deg"]
//! hold           = "60 s"
//! ```

use froude_hydro::swing::Pivot;
use froude_identify::declare::{IfMissing, Key, Kind, Range, Values, optional, required, usual};
use froude_records::RecordError;
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
    optional(
        "still_runs",
        Kind::Table(&[
            required("zeroed", Kind::Word(&ZEROED), "write zeroed = \"once\" if the load cell was zeroed once for each configuration, before its first still run", "when the load cell was zeroed"),
            usual("drift", Kind::Quantity(Dimension::FORCE), "0 N", "standard deviation of the change of the zero from one still run to the next")
                .within(Range::NotNegative("a standard deviation is not")),
        ]),
        "required with still runs",
        "`zeroed`: must be `once` for each configuration, before its first still run; zeroing before each run (`each run`) removes the signal and is refused. `drift`: standard deviation of the change of the zero from one still run to the next, in the order of their names; without it the zero counts as constant",
    ),
];

/// How a load cell may have been zeroed for still runs.
pub(super) const ZEROED: [&str; 2] = ["once", "each run"];

/// Of a key that runs in motion must have.
const OF_MOTION: IfMissing = IfMissing::Nothing("required, except for still runs");

/// The keys of a block of a plan.
pub const PLAN: &[Key] = &[
    optional(
        "configurations",
        Kind::Texts,
        "one unnamed body",
        "names of the configurations, as in `mass` and `buoyancy`",
    ),
    usual(
        "medium",
        Kind::Word(&["water", "air", "still"]),
        "water",
        "`water` or `air` (which determines only mass and delay) for runs in motion; `still` for the body held still in water",
    ),
    usual("flow", Kind::Axis(Dimension::SPEED), "0 m/s", "speed of the stream"),
    Key { default: OF_MOTION, ..amplitude(Dimension::ANGLE, "", "amplitude of the angle") },
    Key { default: OF_MOTION, ..FREQUENCY },
    optional(
        "angle",
        Kind::Axis(Dimension::ANGLE),
        "required for still runs, not allowed otherwise",
        "angles at which the body is held; alternate the sides, so that a drift of the zero does not lie along the slope",
    ),
    usual("hold", Kind::Quantity(Dimension::TIME), "60 s", "length of a still run").within(Range::Positive),
    PERIODS,
    STILL,
    RATE,
    REPEATS,
];

/// Refuses a block of a plan that mixes runs at rest with runs in motion.
pub(super) fn check_plan(values: &Values) -> Result<(), RecordError> {
    let is_still = values.word("medium", &[false, false, true]).unwrap_or(false);
    let (moved, still): (&[(&str, &str)], _) =
        (&[("amplitude", "10 deg"), ("frequency", "70 deg/s")], ("angle", "-10 deg"));
    if is_still {
        if let Some((key, _)) = moved.iter().find(|(key, _)| values.is_stated(key)) {
            return Err(values.wrong(key, "does not apply to medium = \"still\"; leave it out, or give the runs in motion a [[source.plan]] of their own"));
        }
        if values.numbers(still.0).is_empty() {
            return Err(values.missing(still.0, "write the angles at which the body is held, on both sides in turn: angle = [\"20 deg\", \"-20 deg\", \"10 deg\", \"-10 deg\"]"));
        }
        return Ok(());
    }
    if let Some((key, write)) = moved.iter().find(|(key, _)| values.numbers(key).is_empty()) {
        return Err(values.missing(key, &format!("write {key} = \"{write}\", a list, or {{ start, stop, step }}")));
    }
    if values.is_stated(still.0) {
        return Err(values.wrong(still.0, "applies only to still runs: write medium = \"still\", or leave it out"));
    }
    Ok(())
}
