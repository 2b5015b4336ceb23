//! The keys of `[rig]` and `[carriage]`.

use froude_records::declare::{IfMissing, Key, Kind, Range, optional, required, usual};
use froude_records::run::{AMPLIFIER, Axis, TORQUE_CONSTANT};
use froude_records::units::Dimension;

use super::{Directions, Order};

/// V s, of the derivative gain: radians are pure numbers.
const VOLT_SECOND: Dimension = Dimension { m: 2, kg: 1, s: -2, k: 0, a: -1 };
/// V/s, of the integral gain.
const VOLT_PER_SECOND: Dimension = Dimension { m: 2, kg: 1, s: -4, k: 0, a: -1 };
/// kg m².
const INERTIA: Dimension = Dimension::new(2, 1, 0);
/// N m s.
const VISCOUS: Dimension = Dimension::new(2, 1, -1);
/// N s²/m² = kg/m.
const DRAG: Dimension = Dimension::new(-1, 1, 0);
/// N/V.
const FORCE_PER_VOLT: Dimension = Dimension { m: -1, kg: 0, s: 1, k: 0, a: 1 };
/// N/A.
const FORCE_PER_AMPERE: Dimension = Dimension { m: 1, kg: 1, s: -2, k: 0, a: -1 };
/// m/s³.
const JERK: Dimension = Dimension::new(1, 0, -3);

/// A quantity larger than zero.
const fn positive(name: &'static str, dimension: Dimension, instead: &'static str, doc: &'static str) -> Key {
    optional(name, Kind::Quantity(dimension), instead, doc).within(Range::Positive)
}

/// The same, which must be there.
const fn limit(name: &'static str, dimension: Dimension, write: &'static str, doc: &'static str) -> Key {
    required(name, Kind::Quantity(dimension), write, doc).within(Range::Positive)
}

/// A declared constant.
const fn constant(name: &'static str, dimension: Dimension, instead: &'static str, doc: &'static str) -> Key {
    optional(name, Kind::Constant(dimension), instead, doc).within(Range::Positive)
}

/// The same, which must be there.
const fn required_constant(name: &'static str, dimension: Dimension, write: &'static str, doc: &'static str) -> Key {
    required(name, Kind::Constant(dimension), write, doc).within(Range::Positive)
}

const fn part(name: &'static str, instead: IfMissing, what: &'static str) -> Key {
    Key::new(name, Kind::Quantity(Dimension::ONE), instead, what).within(Range::Part(what))
}

const fn gain(name: &'static str, dimension: Dimension, write: &'static str, doc: &'static str) -> Key {
    required(name, Kind::Quantity(dimension), write, doc).within(Range::NotNegative("a gain is not"))
}

/// Keys of `[rig]`.
pub const RIG: &[Key] = &[
    required(
        "kind",
        Kind::Word(&["twin", "serial", "logs"]),
        "write kind = \"twin\" or kind = \"serial\", or kind = \"logs\" for runs that another program recorded",
        "`twin` (simulated), `serial` (a board) or `logs` (runs that another program recorded)",
    ),
    optional("seed", Kind::Whole, "required for a twin", "the same seed gives the same runs"),
    optional("port", Kind::Text, "required for a board", "serial port: \"/dev/ttyUSB0\""),
    optional("baud", Kind::Count(100_000_000), "3_000_000", "baud rate of the port"),
    usual("log_rate", Kind::Quantity(Dimension::ANGULAR_SPEED), "4 kHz", "samples a second in the files")
        .within(Range::Positive),
    optional("y", Kind::Table(AXIS), "required, but for logs", "the long axis"),
    optional("x", Kind::Table(AXIS), "none", "the short axis"),
    optional("force_sensor", Kind::Table(FORCE_SENSOR), "none", "the force sensor"),
    optional(
        "twin",
        Kind::Named(&[], &Kind::Either(&[Kind::AnyQuantity, Kind::Named(&[], &Kind::AnyQuantity)])),
        "the twin's own",
        "true values of the twin",
    ),
    constant("force_per_volt", FORCE_PER_VOLT, "required for logs", "force along the rail for a volt of the command"),
    constant("force_per_ampere", FORCE_PER_AMPERE, "force_per_volt", "the same for an ampere of the motor's current"),
    part(
        "position_standard",
        IfMissing::Nothing("required for logs"),
        "the standard uncertainty of a length along the rail",
    ),
    optional("ballasted", Kind::Flag, "required for logs", "whether the wheels carry the same load wet and dry"),
    constant("strut_drag", DRAG, "no strut", "drag of a strut that goes into the water with the body"),
];

/// Keys of `[rig.y]` and `[rig.x]`.
pub const AXIS: &[Key] = &[
    required(
        "travel",
        Kind::List(&Kind::Quantity(Dimension::LENGTH)),
        "write the hard stops, travel = [\"0 m\", \"5 m\"]",
        "the two hard stops: [\"-0.05 m\", \"4.95 m\"]",
    ),
    limit("speed_limit", Dimension::SPEED, "write the largest speed, \"0.7 m/s\", for example", "largest speed"),
    positive("unhomed_speed_limit", Dimension::SPEED, "0.018 m/s", "largest speed until the axis knows where it is"),
    limit(
        "acceleration_limit",
        Dimension::ACCELERATION,
        "write \"1 m/s^2\", for example",
        "largest acceleration, also of a controlled stop",
    ),
    limit(
        "command_limit",
        Dimension::VOLTAGE,
        "write the amplifier's input range, \"10 V\", for example",
        "input range of the amplifier",
    ),
    limit(
        "current_limit",
        Dimension::CURRENT,
        "write the motor's peak current, \"3.5 A\", for example",
        "peak current of the motor",
    ),
    positive("continuous_current_limit", Dimension::CURRENT, "half the peak", "continuous current of the motor"),
    positive("thermal_time", Dimension::TIME, "20 s", "thermal time constant of the winding"),
    positive("following_error_limit", Dimension::LENGTH, "10 mm", "following error"),
    required_constant(
        "torque_constant",
        TORQUE_CONSTANT,
        "write torque_constant = { value = \"26.7e-3 N m/A\", standard = \"1 %\" }, for example",
        "torque of the motor for a current",
    ),
    required_constant(
        "amplifier",
        AMPLIFIER,
        "write amplifier = { value = \"0.352 A/V\", standard = \"1 %\" }, for example",
        "current of the amplifier for a command",
    ),
    required_constant(
        "gear_ratio",
        Dimension::ONE,
        "write gear_ratio = { value = \"34.97 1\", standard = \"1 %\" }, for example",
        "turns of the motor for one of the sprocket",
    ),
    required_constant(
        "sprocket_radius",
        Dimension::LENGTH,
        "write sprocket_radius = { value = \"55 mm\", standard = \"1 %\" }, for example",
        "radius of the sprocket",
    ),
    required(
        "counts_per_revolution",
        Kind::Number,
        "write 4000 for 1000 lines decoded fourfold, per turn of the motor",
        "per turn of the motor, decoded fourfold; negative where it counts backwards",
    )
    .within(Range::NotZero("write 4000 for 1000 lines decoded fourfold, -4000 where the encoder counts backwards")),
    constant("efficiency", Dimension::ONE, "not declared", "of the gear when the motor drives"),
    constant("efficiency_backward", Dimension::ONE, "not declared", "of the gear when the load drives"),
    constant("inertia", INERTIA, "not identified yet", "J_eff, at the motor's shaft"),
    constant("viscous_friction", VISCOUS, "0", "B_eff, at the motor's shaft"),
    constant("coulomb_friction", Dimension::MOMENT, "not identified yet", "C_eff, at the motor's shaft"),
    required(
        "controller",
        Kind::Table(CONTROLLER),
        "write the gains: proportional, derivative and integral, in V and rad",
        "the position loop over the motor's angle",
    ),
];

/// Keys of `[rig.y.controller]`.
pub const CONTROLLER: &[Key] = &[
    gain("proportional", Dimension::VOLTAGE, "write proportional = \"2 V/rad\", for example", "V/rad"),
    gain("derivative", VOLT_SECOND, "write derivative = \"0.2 V s/rad\", for example", "V s/rad"),
    gain("integral", VOLT_PER_SECOND, "write integral = \"2 V/(rad s)\", for example", "V/(rad s)"),
    positive("derivative_filter", Dimension::ANGULAR_SPEED, "300 Hz", "corner of the derivative's filter"),
    positive("shaped_mode", Dimension::ANGULAR_SPEED, "no shaping", "the load mode that the reference leaves alone"),
    optional("shaped_damping", Kind::Quantity(Dimension::ONE), "0", "damping ratio of that mode"),
    usual("robust_shaper", Kind::Flag, "false", "ZVD (three impulses) instead of ZV (two)"),
];

/// Keys of `[rig.force_sensor]`.
pub const FORCE_SENSOR: &[Key] = &[
    positive("range", Dimension::FORCE, "of the twin 125 N", "largest force"),
    positive("resolution", Dimension::FORCE, "of the twin 1/48 N", "step of its reading"),
    positive("noise", Dimension::FORCE, "of the twin 0.05 N", "standard deviation of its noise"),
    positive("drift", Dimension::FORCE, "0.2 N in the budget", "half-width of its slow drift, taken as uniform"),
    part("gain_standard", IfMissing::Nothing("1 %, with a note"), "the standard uncertainty of its gain"),
];

/// Most repeats of a run.
const REPEATS: Key = usual("repeats", Kind::Count(10_000), "1", "how often each is run");

const SPEEDS: Key = required(
    "speeds",
    Kind::Axis(Dimension::SPEED),
    "write speeds = [\"0.05 m/s\", \"0.15 m/s\"], or { start, stop, step }",
    "speeds",
)
.within(Range::Positive);

/// Keys of `[carriage]`.
pub const CARRIAGE: &[Key] = &[
    usual("axis", Kind::Word(&Axis::NAMES), "y", "the axis that tows"),
    SPEEDS,
    REPEATS,
    usual(
        "order",
        Kind::Word(&Order::NAMES),
        "ABBA",
        "order of dry (A) and wet (B) runs; in ABBA a linear drift cancels",
    ),
    usual("directions", Kind::Word(&Directions::NAMES), "forward", "`both`: forward and backward in turn"),
    limit(
        "distance",
        Dimension::LENGTH,
        "write the travel of a run with its ramps, \"2.2 m\", for example",
        "travel of a run, ramps included",
    ),
    optional("start", Kind::Quantity(Dimension::LENGTH), "chosen by the pre-flight", "where a forward run begins"),
    limit(
        "acceleration",
        Dimension::ACCELERATION,
        "write that of the ramps, \"0.6 m/s^2\", for example",
        "acceleration of the ramps",
    ),
    positive("jerk", JERK, "a trapezoid of speed", "jerk of the ramps"),
    optional(
        "settling",
        Kind::Either(&[Kind::Quantity(Dimension::TIME), Kind::Table(SETTLING)]),
        "none",
        "wait between runs: \"60 s\", or { dry = \"5 s\", wet = \"120 s\" }",
    ),
    usual(
        "still",
        Kind::Quantity(Dimension::TIME),
        "0 s",
        "still window before and after each run, for the zero of the sensor",
    )
    .within(Range::NotNegative("a time that passes is not")),
    optional("warm_up", Kind::Table(WARM_UP), "none", "motion before the first run that counts"),
    optional("friction_sweep", Kind::Table(&[SPEEDS, REPEATS]), "none", "dry sweep over position and speed, both ways"),
    optional("calibration", Kind::Table(CALIBRATION), "none", "known weights over the pulley"),
    optional("excitation", Kind::Table(EXCITATION), "none", "square pulses that excite the servo"),
    usual("ballasted", Kind::Flag, "false", "whether wet runs carry ballast that restores the dry wheel load"),
    part("stop_when", IfMissing::Nothing("all runs are made"), "the relative half-width of D_d's 95 % interval"),
    positive("expected_drag", DRAG, "not stated", "D_d to be expected, for the detectability of each speed"),
    positive(
        "expected_scatter",
        Dimension::FORCE,
        "friction repeats within 2 %",
        "standard deviation of one wet-minus-dry difference, as an earlier campaign on this rig showed it",
    ),
    optional("expected_scatter_dof", Kind::Count(10_000), "exactly known", "degrees of freedom of `expected_scatter`"),
    constant("strut_drag", DRAG, "no strut", "drag of a strut that goes into the water with the body"),
];

/// Keys of `settling`, where dry and wet runs differ.
pub const SETTLING: &[Key] = &[
    positive("dry", Dimension::TIME, "none", "between dry runs"),
    positive("wet", Dimension::TIME, "none", "between wet runs, until the water is still"),
];

const WARM_UP: &[Key] = &[
    limit("duration", Dimension::TIME, "write how long, \"10 min\", for example", "how long"),
    limit("speed", Dimension::SPEED, "write how fast, \"0.3 m/s\", for example", "how fast"),
];

const CALIBRATION: &[Key] = &[
    required(
        "weights",
        Kind::Axis(Dimension::FORCE),
        "write the weights as forces, [\"9.81 N\", \"19.62 N\"], for example",
        "the weights, as forces",
    )
    .within(Range::Positive),
    positive("standard", Dimension::FORCE, "exact", "standard uncertainty of each"),
    constant(
        "pulley_loss",
        Dimension::ONE,
        "measured, else 1 % ± 0.6 %",
        "what the pulley takes, as part of the weight",
    ),
    limit(
        "speed",
        Dimension::SPEED,
        "write how fast they are lifted, \"0.1 m/s\", for example",
        "how fast they are lifted",
    ),
    REPEATS,
    optional("start", Kind::Quantity(Dimension::LENGTH), "that of the tows", "where lifting begins"),
    positive("distance", Dimension::LENGTH, "that of the tows", "way of each lift"),
    optional(
        "floor",
        Kind::Quantity(Dimension::LENGTH),
        "none",
        "coordinate at which a falling weight reaches the floor: below it the cord is slack",
    ),
];

const EXCITATION: &[Key] = &[
    limit("amplitude", Dimension::VOLTAGE, "write amplitude = \"2 V\", for example", "amplitude of the pulses"),
    limit("period", Dimension::TIME, "write period = \"1 s\", for example", "period of the pulses"),
    part("duty", IfMissing::Required("write duty = \"60 %\", for example"), "the part of a period that is on"),
    limit("duration", Dimension::TIME, "write duration = \"20 s\", for example", "how long"),
];
