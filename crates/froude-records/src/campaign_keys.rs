//! The keys of a campaign, but for what belongs to its methods and to the carriage.

use froude_hydro::drag_curves::Shape;

use crate::body::LINK;
use crate::body_axis::BodyAxis;
use crate::campaign::{Shared, SourceKind};
use crate::declare::{Key, Kind, Range, optional, required, usual};
use crate::estimate::ErrorKind;
use crate::units::Dimension;

const fn positive(name: &'static str, dimension: Dimension, doc: &'static str) -> Key {
    optional(name, Kind::Quantity(dimension), "not declared", doc).within(Range::Positive)
}

/// Keys of the file.
pub const ROOT: &[Key] = &[
    required("schema", Kind::Count(1), "write schema = 1", "version of the format"),
    required("name", Kind::Text, "write name = \"what this campaign is\"", "title"),
    optional("cite", Kind::Texts, "none", "works that a report on it has to cite"),
    optional("fluid", Kind::Table(FLUID), "from columns of the table", "the water"),
    optional("body", Kind::Table(BODY), "not declared", "the body: lengths, areas, volumes"),
    optional("tank", Kind::Table(TANK), "unbounded water", "the tank"),
    optional("constants", Kind::Named(&[], &Kind::Any), "none", "known numbers that formulas name, each with its unit"),
    optional("source", Kind::List(&Kind::Table(SOURCE)), "none", "where observations and records come from"),
    optional("identify", Kind::Table(IDENTIFY), "its defaults", "how to fit, for all sources"),
    optional("simulate", Kind::Table(SIMULATE), "nothing is simulated", "how to simulate observations"),
    optional("rig", Kind::Named(&[], &Kind::Any), "nothing is driven", "what drives the carriage"),
    optional("carriage", Kind::Named(&[], &Kind::Any), "nothing is driven", "what the carriage is to do"),
];

/// Keys of `[fluid]`.
pub const FLUID: &[Key] = &[
    optional(
        "density",
        Kind::Constant(Dimension::DENSITY),
        "the table's column, else from temperature and salinity",
        "density, exact or as { value, standard }; for air, declare the viscosity too",
    )
    .within(Range::Positive),
    optional(
        "kinematic_viscosity",
        Kind::Quantity(Dimension::KINEMATIC_VISCOSITY),
        "the table's column, else from temperature",
        "kinematic viscosity, for Reynolds numbers",
    )
    .within(Range::Positive),
    optional(
        "temperature",
        Kind::Quantity(Dimension::TEMPERATURE),
        "none",
        "temperature, 0 to 40 degC; used only where the table has no column of it",
    ),
    optional("salinity", Kind::Quantity(Dimension::ONE), "0 g/kg", "absolute salinity, 0 to 42 g/kg"),
];

/// Keys of `[body]`.
pub const BODY: &[Key] = &[
    optional("reference_point", Kind::Text, "not named", "in words, what velocities are of and moments about"),
    optional("link", Kind::Table(LINK), "none", "a link of a snake robot, which the laws f1 to f6 need"),
    positive("head_side_area", Dimension::AREA, "A_yH, for the laws f1 to f6"),
    positive("tail_side_area", Dimension::AREA, "A_yT, for the laws f1 to f6"),
    positive("reference_length", Dimension::LENGTH, "length of Reynolds, Froude and KC numbers"),
    optional(
        "reference_area",
        Kind::Constant(Dimension::AREA),
        "that of a sphere follows from `reference_length`",
        "frontal area, of C_D and blockage, exact or as { value, standard }",
    )
    .within(Range::Positive),
    optional(
        "shape",
        Kind::Word(&Shape::NAMES),
        "no published drag is drawn",
        "`sphere`, `cylinder` or `plate` across the stream, `spheroid` along it: C_D is drawn beside its published drag, Re being on `reference_length`",
    ),
    optional(
        "travel",
        Kind::Word(&BodyAxis::NAMES),
        "x is along the travel",
        "the body axis along the travel of a carriage",
    ),
    positive("volume", Dimension::VOLUME, "displaced volume, the reference of added mass"),
    optional(
        "volumes",
        Kind::Named(&[], &Kind::Quantity(Dimension::VOLUME)),
        "not declared",
        "displaced volume of each configuration: { H1LT = \"1.893e-3 m^3\" }",
    ),
    positive("link_volume", Dimension::VOLUME, "displaced volume of one link"),
];

/// Keys of `[tank]`.
pub const TANK: &[Key] = &[
    positive("width", Dimension::LENGTH, "width of the water"),
    positive("depth", Dimension::LENGTH, "depth of the water"),
    positive("submergence", Dimension::LENGTH, "depth of the body's axis below the surface"),
];

/// Keys of `[[source]]`, but for the sections of its methods.
pub const SOURCE: &[Key] = &[
    required("name", Kind::Text, "write name = \"circulation tank\", for example", "its name, unique in the campaign"),
    required(
        "kind",
        Kind::Word(&SourceKind::NAMES),
        "write kind = \"tank\", \"towing\", \"cfd\", \"potential\" or \"published\"",
        "what it is",
    ),
    usual(
        "role",
        Kind::Word(&["fit", "validation"]),
        "fit",
        "whether laws are fitted to its table (fit), or those of the other sources are tested on it (validation)",
    ),
    optional("table", Kind::Text, "another of the five inputs", "a table of observations (.csv, .parquet)"),
    optional("record", Kind::Text, "another of the five inputs", "an estimate.json"),
    optional("runs", Kind::Text, "another of the five inputs", "a folder of runs"),
    optional("cases", Kind::Text, "another of the five inputs", "a folder of computed flows"),
    optional("mesh", Kind::Text, "another of the five inputs", "a surface mesh, or a body file"),
    optional("select", Kind::Text, "the recommended estimate", "source/model, which estimate of the record"),
    optional("sidecar", Kind::Text, "the one beside the table", "sidecar of the table"),
    optional(
        "method",
        Kind::Texts,
        "those of the carriage that the runs allow",
        "how its runs are reduced, a name or a list",
    ),
    optional("models", Kind::Texts, "those of [identify]", "force models for this source"),
    optional(
        "keep",
        Kind::Text,
        "all rows",
        "which rows are used, clauses joined by and: \"angle <= 39 deg and configuration == H1LT\"",
    ),
    optional("group", Kind::Text, "none", "a column whose values belong together (clusters, cross-validation)"),
    optional(
        "actuator",
        Kind::Texts,
        "none",
        "loads that an actuator exerts, and not the water: thrust, a joint's torque",
    ),
    optional("uncertainty", Kind::List(&Kind::Table(UNCERTAINTY)), "none", "an entry of the sensor budget"),
    optional("tare", Kind::Table(TARE), "none", "a fitted tare that is subtracted"),
    optional("plan", Kind::List(&Kind::Any), "nothing is planned", "a block of the run matrix"),
    optional("added_mass", Kind::Named(&[], &Kind::Any), "its defaults", "what is asked of a mesh"),
    optional("decay", Kind::Named(&[], &Kind::Any), "none", "the oscillating body of a free decay"),
    optional("cfd", Kind::Named(&[], &Kind::Any), "none", "how the flow is computed"),
];

/// Keys of `[[source.uncertainty]]`.
pub const UNCERTAINTY: &[Key] = &[
    required(
        "quantity",
        Kind::Text,
        "name the uncertain column: f_x, speed, angle, density, …",
        "what is uncertain: a load, speed, angle, density, …",
    ),
    required(
        "standard",
        Kind::AnyQuantity,
        "write the standard uncertainty with its unit: \"0.01 N\" or \"0.5 %\"",
        "standard uncertainty (not an expanded one), in the unit of the quantity or in per cent of it",
    ),
    required(
        "shared",
        Kind::Word(&Shared::NAMES),
        "state what shares the error: \"sample\", \"run\", \"setup\" or \"campaign\"",
        "what shares one error: shared errors do not average down",
    ),
    optional("dof", Kind::Number, "infinite", "degrees of freedom of `standard`").within(Range::Positive),
    optional("name", Kind::Text, "the quantity", "its name in the budget table"),
    usual(
        "kind",
        Kind::Word(&ErrorKind::NAMES),
        "B",
        "how it was evaluated: `numerical` (mesh, iterations), `input` (of a computation), `model_form` (the model itself), or `B`",
    ),
];

/// Keys of `[source.tare]`.
pub const TARE: &[Key] = &[
    required("record", Kind::Text, "name the estimate.json of the tare", "the estimate.json of the tare"),
    optional("select", Kind::Text, "the recommended estimate", "source/model in it"),
    usual(
        "removed",
        Kind::Flag,
        "false",
        "whether the table already has it removed; then only its uncertainty is included",
    ),
];

/// Most repeats of a row.
const MOST_REPEATS: u64 = 10_000;

const CONFIGURATIONS: Key = optional("configurations", Kind::Texts, "one unnamed body", "names of the configurations");
const SPEED: Key =
    required("speed", Kind::Axis(Dimension::SPEED), "write \"0.1 m/s\", a list, or { start, stop, step }", "speed");
const ANGLE: Key = usual("angle", Kind::Axis(Dimension::ANGLE), "0 deg", "angle of the velocity");

/// Keys of `[[source.plan]]` of a table, and of runs each of which is a row.
pub const ROWS: &[Key] =
    &[CONFIGURATIONS, SPEED, ANGLE, usual("repeats", Kind::Count(MOST_REPEATS), "1", "how often each setting is run")];

/// Keys of `[[source.plan]]` of computed cases: a computation that is repeated says nothing new.
pub const CASES: &[Key] = &[
    CONFIGURATIONS,
    SPEED,
    ANGLE,
    usual("pitch", Kind::Axis(Dimension::ANGLE), "0 deg", "angle of the velocity out of the horizontal plane"),
];

/// Bounds of a coefficient.
const BOUND: Kind = Kind::Word(&["none", "free", "non-negative"]);

/// Keys of `[identify]`.
pub const IDENTIFY: &[Key] = &[
    optional(
        "models",
        Kind::Texts,
        "quadratic, linear_quadratic and power_law, or the models below",
        "force models: f1 to f6, quadratic, linear_quadratic, power_law, power_law_log, strut, or names of models below",
    ),
    optional(
        "bounds",
        Kind::Either(&[BOUND, Kind::Named(&[], &BOUND)]),
        "none",
        "bounds of coefficients: one for all of f1 to f6, or a table { default = \"non-negative\", C_XY_I = \"free\" }",
    ),
    optional(
        "fixed",
        Kind::Named(&[], &Kind::Coefficient),
        "none",
        "coefficients held at a value that is taken as exact: { C_d_I = \"0 m/s\" }",
    ),
    optional("exclude", Kind::Texts, "none", "coefficients left out"),
    optional(
        "prior",
        Kind::List(&Kind::Table(PRIOR)),
        "none",
        "a coefficient that is known beforehand, and improved by the rows",
    ),
    optional(
        "known",
        Kind::List(&Kind::Table(PRIOR)),
        "none",
        "a coefficient held at its value, whose uncertainty is an error that all rows share",
    ),
    optional(
        "covariance",
        Kind::Word(&COVARIANCES),
        "by the data",
        "covariance of the coefficients; `serial`: successive rows are correlated",
    ),
    usual(
        "weights",
        Kind::Word(&["std", "fitted"]),
        "std",
        "`fitted`: weights from a variance that is fitted to the residuals",
    ),
    usual(
        "group_offset",
        Kind::Word(&["ignore", "estimate"]),
        "ignore",
        "`estimate`: an offset of each group in each load, beside the law",
    ),
    optional(
        "cross_validation",
        Kind::List(&Kind::Table(RANGE_BLOCK)),
        "none",
        "a range of a column: rows inside are fitted, rows outside predicted",
    ),
    usual(
        "angle_offset",
        Kind::Word(&["ignore", "estimate"]),
        "ignore",
        "`estimate`: one angle between sensor and body per setup",
    ),
    usual("dissipative", Kind::Flag, "false", "whether the fit is constrained to deliver no power"),
    optional(
        "model",
        Kind::List(&Kind::Named(MODEL, &Kind::Text)),
        "none",
        "a model of your own: a formula for each load, f_y = \"Y_v*v + Y_vav*v*abs(v)\"",
    ),
    usual(
        "errors_in_variables",
        Kind::Flag,
        "false",
        "whether speed and angle are uncertain too, as the budget states of each sample",
    ),
];

/// Covariances that a campaign may choose.
pub(crate) const COVARIANCES: [&str; 4] = ["classical", "HC3", "cluster", "serial"];

/// Keys of `[[identify.prior]]` and `[[identify.known]]`: value and uncertainty, or an entry of a record.
pub const PRIOR: &[Key] = &[
    required("coefficient", Kind::Text, "name the coefficient", "the coefficient"),
    optional("model", Kind::Text, "all that have the coefficient", "the model"),
    optional("value", Kind::Coefficient, "that of a record", "its value"),
    optional(
        "standard_uncertainty",
        Kind::Coefficient,
        "that of a record",
        "its standard uncertainty, also in per cent of the value",
    ),
    optional(
        "record",
        Kind::Text,
        "value and standard_uncertainty",
        "an estimate.json that value and uncertainty are taken from",
    ),
    optional("select", Kind::Text, "the recommended estimate", "source/model in the record"),
    optional("entry", Kind::Text, "value and standard_uncertainty", "coefficient of the record: \"A66\""),
    positive("volume", Dimension::VOLUME, "reference volume V of C_A = A/(ρV), where the entry is a mass"),
    positive(
        "model_form",
        Dimension::ONE,
        "added to the uncertainty in quadrature, as a fraction of the value: how far an ideal fluid is from a real one",
    ),
];

/// Keys of `[[identify.cross_validation]]`.
pub const RANGE_BLOCK: &[Key] = &[
    required("column", Kind::Text, "name the column of the range", "the column"),
    optional("low", Kind::AnyQuantity, "open", "smallest value fitted to"),
    optional("high", Kind::AnyQuantity, "open", "largest value fitted to"),
];

/// Keys of `[[identify.model]]`, beside its formulas.
pub const MODEL: &[Key] = &[required("name", Kind::Text, "write name = \"sway\", for example", "its name")];

/// Keys of `[simulate]`: the truth is an estimate of a record, or a model with coefficients.
pub const SIMULATE: &[Key] = &[
    required(
        "seed",
        Kind::Whole,
        "write seed = 1, for example; the same seed gives the same table",
        "the same seed gives the same table",
    ),
    optional("record", Kind::Text, "model and coefficients", "an estimate.json that is the truth"),
    optional("select", Kind::Text, "the recommended estimate", "source/model in the record"),
    optional("model", Kind::Text, "record", "force model of the coefficients"),
    optional("coefficients", Kind::Named(&[], &Kind::Coefficient), "record", "the true coefficients"),
    optional("misalignment", Kind::Quantity(Dimension::ANGLE), "none", "angle between sensor and body"),
    optional("sensor", Kind::List(&Kind::Table(SENSOR)), "no noise", "a sensor"),
];

/// Keys of `[[simulate.sensor]]`.
pub const SENSOR: &[Key] = &[
    required("quantity", Kind::Text, "name the measured column: f_x, f_y, speed, angle", "the column that it makes"),
    optional("noise", Kind::AnyQuantity, "none", "standard deviation of its noise"),
    optional("resolution", Kind::AnyQuantity, "none", "step of its reading"),
    optional("drift", Kind::AnyQuantity, "none", "standard deviation of a linear drift over one setup"),
    optional("bias", Kind::AnyQuantity, "none", "constant error"),
    positive("correlation", Dimension::TIME, "time over which its noise is correlated"),
];
