//! `[source.rotation]`: what is declared of a body that a motor turns to and fro about its own centre, and the runs that are planned of it.
//!
//! ```toml
//! [source.rotation]
//! axis      = "upright"                                              # or "stream": the axis lies level, and the weight restores
//! inertia   = { value = "3.4e-3 kg m^2", standard = "1e-5 kg m^2" }  # dry, of all below the torque cell; runs in air find it too
//! tare_inertia = "2e-4 kg m^2"                                       # of it without the body; needed where there are runs of the role tare
//! restoring = { value = "2 mN m", standard = "0.2 mN m" }            # K of K sin θ; axis = "stream" only
//! delay     = { value = "0 ms", standard = "5 ms" }                  # of the torque behind the angle; leave out what is to be found
//! cycles    = { skip = 1, used = 5, fewest = 5 }
//!
//! [[source.plan]]
//! role      = "test"                                                 # or dry_air, tare
//! amplitude = ["30 deg", "45 deg", "60 deg"]
//! frequency = ["60 deg/s", "70 deg/s", "80 deg/s"]                   # Hz is a frequency, deg/s and rad/s are angular ones
//! periods   = 7
//! ```

use froude_fit::budget::Uncertain;
use froude_hydro::swing::Pivot;
use froude_identify::declare::{IfMissing, Key, Kind, Range, Values};
use froude_identify::method::MethodError;
use froude_records::RecordError;
use froude_records::campaign::{Campaign, Source};
use froude_records::run::{ROTATION, Role};
use froude_records::section::Section;
use froude_records::section_values::MOST_RUNS;
use froude_records::units::Dimension;

use super::setup::Setup;
use crate::declared::{
    CYCLES, FREQUENCY, HARMONICS, INERTIA, PERIODS, RATE, REPEATS, STILL, Swings, amplitude, cycles, gain as gain_of,
    needed, runs_of, uncertain,
};
use crate::error::undeclared;
use crate::fluid::density_kg_m3;
use crate::logs;

/// One block of planned runs: every amplitude at every frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct RotationPlan {
    /// [`Role::Test`], [`Role::DryAir`] or [`Role::Tare`].
    pub role: Role,
    /// How the body turns.
    pub swings: Swings,
}

/// The keys of `[source.rotation]`.
pub const KEYS: &[Key] = &[
    Key::new(
        "axis",
        Kind::Word(&Pivot::NAMES),
        IfMissing::Required(
            "state how the axis of rotation lies: \"upright\" (gravity does nothing) or \"stream\" (level, along the stream: weight and buoyancy \
             restore, and their moment is taken off)",
        ),
        "`upright` or `stream` (level, along the tank)",
    ),
    Key::new(
        "inertia",
        Kind::Constant(INERTIA),
        IfMissing::Nothing("from runs in air"),
        "dry, of all that moves below the torque cell; `standard` is a standard uncertainty, here and below, and a number without it counts as exact",
    )
    .within(Range::NotNegative("an inertia is not")),
    Key::new(
        "tare_inertia",
        Kind::Constant(INERTIA),
        IfMissing::Nothing("required with runs of the shaft alone"),
        "the same without the body",
    )
    .within(Range::NotNegative("an inertia is not")),
    Key::new(
        "restoring",
        Kind::Constant(Dimension::MOMENT),
        IfMissing::Nothing("required about a level axis, refused about an upright one"),
        "K, from the torque at rest at two angles; with a standard uncertainty it is known beforehand and improved by the runs",
    ),
    Key::new(
        "delay",
        Kind::Constant(Dimension::TIME),
        IfMissing::Nothing("to be found"),
        "of the torque behind the angle, positive where the torque is stamped late",
    ),
    CYCLES,
    HARMONICS,
];

/// Roles that a planned run may have, and their names.
const ROLES: [Role; 3] = [Role::Test, Role::DryAir, Role::Tare];
const ROLE_NAMES: [&str; 3] = ["test", "dry_air", "tare"];

/// The keys of a block of a plan.
pub const PLAN: &[Key] = &[
    Key::new(
        "role",
        Kind::Word(&ROLE_NAMES),
        IfMissing::Is("test"),
        "`test`; `dry_air`: the same motion in air; `tare`: the shaft without the body, in water",
    ),
    amplitude("write \"45 deg\", a list, or { start, stop, step }"),
    FREQUENCY,
    PERIODS,
    STILL,
    RATE,
    REPEATS,
];

/// Reads `[source.rotation]`; what other sections say of water, link and errors is not in it.
pub(super) fn rotation(s: &Section<'_>) -> Result<Setup, RecordError> {
    let values = Values::read(s, KEYS)?;
    let axis = values.need("axis", values.word("axis", &Pivot::ALL))?;
    let restoring = values.constant("restoring");
    match (axis, restoring) {
        (Pivot::Upright, Some(_)) => {
            let problem = "stands with an upright axis, about which gravity restores nothing; leave it out, or write axis = \"stream\"";
            return Err(values.wrong("restoring", problem));
        }
        (Pivot::Stream, None) => {
            return Err(values.missing(
                "restoring",
                "about a level axis weight and buoyancy give a moment K sin θ, in phase with the added inertia: declare K, restoring = { value = \"2 mN m\", standard = \
                 \"0.2 mN m\" }, from the torque at rest at two angles; \"0 N m\" where the body is trimmed",
            ));
        }
        _ => {}
    }
    Ok(Setup {
        axis,
        tare_inertia_kg_m2: values.constant("tare_inertia").map(uncertain),
        restoring_n_m: restoring.map(uncertain),
        delay_s: values.constant("delay").map(uncertain),
        cycles: cycles(&values)?,
        harmonics: values.need("harmonics", values.count("harmonics"))?,
        ..Setup::new(values.constant("inertia").map(uncertain))
    })
}

/// Everything that the campaign declares.
///
/// # Errors
///
/// No `[source.rotation]`, or one that cannot be read; a budget entry of a quantity that this method does not have, or that is no part of it.
pub fn setup_of(campaign: &Campaign, source: &Source) -> Result<Setup, MethodError> {
    let what = "nothing is declared of the body that turns: write [source.rotation] with axis and inertia";
    let mut out = needed(source, ROTATION, rotation, what)?;
    let density = density_kg_m3(&campaign.fluid).map_err(|what| undeclared(&source.place, what))?;
    out.density_kg_m3 = density.map(|value| Uncertain::new(value, 0.0));
    out.link = campaign.body.as_ref().and_then(|b| b.link);
    for entry in &source.uncertainty {
        logs::is_of_all_runs(entry)?;
        let gain = match entry.quantity.as_str() {
            "density" => {
                if let Some(density) = &mut out.density_kg_m3 {
                    density.standard = if entry.relative { entry.standard * density.value } else { entry.standard };
                }
                continue;
            }
            "angle" => &mut out.angle_relative,
            "torque" => &mut out.torque_relative,
            other => {
                let what = format!(
                    "quantity = {other:?} is none that a rotation has: it has torque, angle and density; inertia, restoring moment and delay take their standard \
                     uncertainties in [source.rotation]"
                );
                return Err(undeclared(&entry.place, what));
            }
        };
        *gain = gain_of(entry, "the zero of each run is fitted")?;
    }
    Ok(out)
}

/// The runs that a source plans.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn plan(source: &Source) -> Result<Vec<RotationPlan>, RecordError> {
    runs_of(source, ROTATION, block, |p| p.swings.asks(1))
}

/// Reads a `[[source.plan]]` of rotations.
fn block(s: &Section<'_>) -> Result<RotationPlan, RecordError> {
    let values = Values::read(s, PLAN)?;
    values.at_most(MOST_RUNS)?;
    Ok(RotationPlan { role: values.need("role", values.word("role", &ROLES))?, swings: Swings::of(&values)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roles_are_called_by_their_names() {
        assert_eq!(ROLES.map(Role::name), ROLE_NAMES);
    }
}
