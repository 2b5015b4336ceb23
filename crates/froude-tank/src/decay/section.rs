//! `[source.decay]`: a body that is displaced and let go, and the releases that are planned of it.
//!
//! ```toml
//! [source.decay]
//! axis      = "roll"                                           # enough for frequency, damping ratio and damping per inertia
//! inertia   = { value = "0.3693 kg m^2", standard = "0.5 %" }  # dry, of all that moves, about the axis
//! buoyancy  = { value = "3.0 N", standard = "0.02 N" }         # less weight, at `radius` from the axis: the moment is B r sin φ
//! radius    = { value = "476 mm", standard = "1 mm" }          # or: stiffness = { value = "12 N m", standard = "0.3 %" }
//! noise     = "0.05 deg"                                       # of a sample; from the logs themselves where it is not declared
//! free_from = "1.01 s"
//!
//! [[source.plan]]
//! configuration = "H1LT"
//! angle         = "30 deg"                                     # of the release; displacement = "0.1 m" along an axis
//! repeats       = 5
//! duration      = "20 s"
//! ```

use std::f64::consts::PI;

use crate::decay::axis::Motion;
use froude_identify::declare::{Key, Kind, Range, Values, optional, required, usual};
use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_records::run::Role;
use froude_records::section::Section;
use froude_records::units::Dimension;
use froude_rig::decay::Release;

use super::run::{DecaySetup, DecayWindow, Known, Restoring};
use crate::declared::{INERTIA, RATE, REPEATS, STIFFNESS, uncertain};
use crate::matrix::Plan;

pub use crate::matrix::Point;

/// Most samples of a planned release.
const MOST_SAMPLES: f64 = 1e7;

const fn by_axis(along: Kind, about: Kind) -> [Kind; Motion::ALL.len()] {
    [along, along, along, about, about, about]
}

/// The keys of `[source.decay]`.
pub const KEYS: &[Key] = &[
    required(
        "axis",
        Kind::Word(&Motion::NAMES),
        "state its motion: axis = \"heave\", for example",
        "the motion: `surge`, `sway`, `heave`, `roll`, `pitch` or `yaw`",
    ),
    optional(
        "inertia",
        Kind::By("axis", &by_axis(Kind::Constant(Dimension::MASS), Kind::Constant(INERTIA))),
        "no added mass; damping is per moving inertia",
        "mass, or moment of inertia about the axis, of all that moves, dry; `standard` is a standard uncertainty, here and below, and a number without it counts as exact",
    )
    .within(Range::Positive),
    optional(
        "stiffness",
        Kind::By("axis", &by_axis(Kind::Constant(STIFFNESS), Kind::Constant(Dimension::MOMENT))),
        "required with `inertia` and without `buoyancy`",
        "all that restores the position: springs, and ρ g times the waterplane area",
    )
    .within(Range::Positive),
    optional(
        "moving_inertia",
        Kind::By("axis", &by_axis(Kind::Constant(Dimension::MASS), Kind::Constant(INERTIA))),
        "damping is per moving inertia",
        "instead of `inertia` and `stiffness`: the inertia of all that moves, added mass included",
    )
    .within(Range::Positive),
    optional(
        "buoyancy",
        Kind::Constant(Dimension::FORCE),
        "`stiffness` restores",
        "of a rotation: buoyancy less weight, at `radius` from the axis",
    )
    .within(Range::Positive),
    optional("radius", Kind::Constant(Dimension::LENGTH), "required with `buoyancy`", "where the buoyancy acts")
        .within(Range::Positive),
    optional(
        "noise",
        Kind::By("axis", &by_axis(Kind::Quantity(Dimension::LENGTH), Kind::Quantity(Dimension::ANGLE))),
        "from the logs",
        "standard deviation of a sample of the position, by which peaks are counted",
    )
    .within(Range::Positive),
    optional(
        "free_from",
        Kind::Quantity(Dimension::TIME),
        "the first passage through rest",
        "when the body is free, on the clock of the logs",
    ),
    usual("skip_half_cycles", Kind::Whole, "0", "left out after that"),
    optional(
        "amplitude",
        Kind::By("axis", &by_axis(Kind::Quantity(Dimension::LENGTH), Kind::Quantity(Dimension::ANGLE))),
        "required if the swings are unusually large or small",
        "largest swing that was observed, to a factor of two: it confirms the unit of the position",
    )
    .within(Range::Positive),
    optional(
        "period",
        Kind::Quantity(Dimension::TIME),
        "required if all times are whole numbers",
        "period that was observed, to a factor of two: it confirms the unit of the time",
    )
    .within(Range::Positive),
];

const fn lasting(name: &'static str, default: &'static str, doc: &'static str) -> Key {
    usual(name, Kind::Quantity(Dimension::TIME), default, doc).within(Range::Positive)
}

const AWAY: Range = Range::NotZero("a release is away from rest");

/// The keys of a block of a plan.
pub const PLAN: &[Key] = &[
    optional("configuration", Kind::Text, "not named", "what is mounted"),
    optional("angle", Kind::Axis(Dimension::ANGLE), "`displacement`", "what it is released from, about an axis")
        .within(AWAY),
    optional("displacement", Kind::Axis(Dimension::LENGTH), "`angle`", "what it is released from, along an axis")
        .within(AWAY),
    REPEATS,
    lasting("held", "1 s", "time held before the release"),
    lasting("duration", "20 s", "time free after it"),
    RATE,
];

/// Reads `[source.decay]`.
pub(super) fn decay(s: &Section<'_>) -> Result<DecaySetup, RecordError> {
    let values = Values::read(s, KEYS)?;
    let axis = values.need("axis", values.word("axis", &Motion::ALL))?;
    let constant = |key: &str| values.constant(key).map(uncertain);
    if constant("moving_inertia").is_some() && constant("inertia").or(constant("buoyancy")).is_some() {
        let problem =
            "already includes the added inertia; leave out inertia, buoyancy and radius, which serve to find it";
        return Err(values.wrong("moving_inertia", problem));
    }
    let setup = match constant("inertia") {
        Some(inertia) => DecaySetup { restoring: restoring(&values, axis)?, ..DecaySetup::new(axis, inertia, inertia) },
        None if constant("buoyancy").or(constant("radius")).is_some() => {
            let write = "write inertia = { value = \"0.4 kg m^2\", standard = \"0.5 %\" }, dry, about the axis; or leave out buoyancy and radius, for results of small \
                         swings per moving inertia";
            return Err(values.missing("inertia", write));
        }
        None => {
            let [stiffness, moving] = ["stiffness", "moving_inertia"].map(constant);
            if stiffness.is_some() && moving.is_some() {
                return Err(values.wrong(
                    "moving_inertia",
                    "is declared together with stiffness, which the frequency makes one too many; declare one of them",
                ));
            }
            DecaySetup::per_inertia(axis, stiffness.map(Known::Stiffness).or(moving.map(Known::MovingInertia)))
        }
    };
    Ok(DecaySetup {
        window: DecayWindow {
            noise: values.number("noise"),
            free_from_s: values.number("free_from"),
            skip_half_cycles: values.need("skip_half_cycles", values.count("skip_half_cycles"))?,
            seen: ["amplitude", "period"].map(|key| values.number(key)),
            ..DecayWindow::default()
        },
        ..setup
    })
}

fn restoring(values: &Values, axis: Motion) -> Result<Restoring, RecordError> {
    let constant = |key: &str| values.constant(key).map(uncertain);
    let missing = |key: &str, like: &str, instead: &str| {
        values.missing(key, &format!("write {key} = {{ value = \"{like}\", standard = \"0.5 %\" }}{instead}"))
    };
    let Some(force_n) = constant("buoyancy") else {
        if constant("radius").is_some() {
            let problem = "is that of a buoyancy, which is not declared: write buoyancy = \"3.0 N\"";
            return Err(values.wrong("radius", problem));
        }
        let [like, instead] = if axis.is_rotation() {
            [
                "… N m",
                "; or, of a buoyancy that acts at a radius, buoyancy and radius; or, if inertia includes the added inertia, rename it moving_inertia; or leave out inertia, for results per moving inertia",
            ]
        } else {
            [
                "… N/m",
                "; or, if inertia includes the added mass, rename it moving_inertia; or leave out inertia, for results per moving inertia",
            ]
        };
        let stiffness = constant("stiffness").ok_or_else(|| missing("stiffness", like, instead))?;
        return Ok(Restoring::Spring(stiffness));
    };
    if !axis.is_rotation() {
        let problem = "at a radius drives a rotation back, and the axis is none: declare a stiffness";
        return Err(values.wrong("buoyancy", problem));
    }
    if constant("stiffness").is_some() {
        let problem = "stands beside buoyancy: what drives the body back is one or the other";
        return Err(values.wrong("stiffness", problem));
    }
    Ok(Restoring::Buoyancy { force_n, radius_m: constant("radius").ok_or_else(|| missing("radius", "476 mm", ""))? })
}

/// The releases that a source plans.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn plan(source: &Source) -> Result<Vec<Point>, RecordError> {
    // Both reductions plan alike.
    let method = source.methods.iter().find(|method| method.starts_with("decay")).map_or("", String::as_str);
    let roles = ("", &[Role::Decay][..]);
    Plan { roles, check: consistent, ..Plan::of(PLAN, |point| (1, duration_s(point))) }.points(source, method)
}

/// How a planned release is let go.
#[must_use]
pub fn release(point: &Point) -> Release {
    let displacement = point.condition(if point.conditions.contains_key("angle") { "angle" } else { "displacement" });
    Release { displacement, held_s: point.condition("held"), free_s: point.condition("duration") }
}

/// How long it takes on the log, s.
pub(super) fn duration_s(point: &Point) -> f64 {
    point.condition("held") + point.condition("duration")
}

/// Checks the keys of a block against each other.
fn consistent(values: &Values) -> Result<(), RecordError> {
    let angle = values.numbers("angle");
    match (angle.is_empty(), values.numbers("displacement").is_empty()) {
        (false, false) => {
            let problem = "cannot be combined with angle; give one of them";
            return Err(values.wrong("displacement", problem));
        }
        (true, true) => {
            let write =
                "write what it is released from: angle = \"30 deg\" about an axis, displacement = \"0.1 m\" along one";
            return Err(values.missing("angle", write));
        }
        _ => {}
    }
    if let Some(turned) = angle.iter().find(|x| x.abs() >= PI) {
        let problem = format!("is {} deg; it must lie between -180 and 180 deg", turned.to_degrees());
        return Err(values.wrong("angle", problem));
    }
    let number = |key: &str| values.need(key, values.number(key));
    let samples = (number("held")? + number("duration")?) * number("rate")?;
    if samples > MOST_SAMPLES {
        let key = if values.is_stated("rate") && !values.is_stated("duration") { "rate" } else { "duration" };
        let problem = format!("gives {samples:.0} samples per release, limit {MOST_SAMPLES:.0}");
        return Err(values.wrong(key, problem));
    }
    Ok(())
}
