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

use froude_hydro::swing::Pivot;
use froude_identify::declare::{Key, Kind, Range, optional, required, usual};
use froude_records::run::Role;
use froude_records::units::Dimension;

use crate::declared::{CYCLES, FREQUENCY, HARMONICS, INERTIA, PERIODS, RATE, REPEATS, STILL, amplitude};

/// The keys of `[source.rotation]`.
pub const KEYS: &[Key] = &[
    required("axis", Kind::Word(&Pivot::NAMES), "state how the axis of rotation lies: \"upright\" (gravity does nothing) or \"stream\" (level, along the stream: weight and buoyancy \
             restore, and their moment is taken off)", "`upright` or `stream` (level, along the tank)"),
    optional(
        "inertia",
        Kind::Constant(INERTIA),
        "from runs in air",
        "dry, of all that moves below the torque cell; `standard` is a standard uncertainty, here and below, and a number without it counts as exact",
    )
    .within(Range::NotNegative("an inertia is not")),
    optional(
        "tare_inertia",
        Kind::Constant(INERTIA),
        "required with runs of the shaft alone",
        "the same without the body",
    )
    .within(Range::NotNegative("an inertia is not")),
    optional(
        "restoring",
        Kind::Constant(Dimension::MOMENT),
        "required about a level axis, refused about an upright one",
        "K, from the torque at rest at two angles; with a standard uncertainty it is a prior that the runs refine",
    ),
    optional(
        "delay",
        Kind::Constant(Dimension::TIME),
        "to be found",
        "of the torque behind the angle, positive where the torque is stamped late",
    ),
    CYCLES,
    HARMONICS,
];

/// Roles that a planned run may have, and their names.
pub(super) const ROLES: [Role; 3] = [Role::Test, Role::DryAir, Role::Tare];
const ROLE_NAMES: [&str; 3] = ["test", "dry_air", "tare"];

/// The keys of a block of a plan.
pub const PLAN: &[Key] = &[
    usual(
        "role",
        Kind::Word(&ROLE_NAMES),
        "test",
        "`test`; `dry_air`: the same motion in air; `tare`: the shaft without the body, in water",
    ),
    amplitude(Dimension::ANGLE, "write \"45 deg\", a list, or { start, stop, step }", "amplitude of the angle"),
    FREQUENCY,
    PERIODS,
    STILL,
    RATE,
    REPEATS,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roles_are_called_by_their_names() {
        assert_eq!(ROLES.map(Role::name), ROLE_NAMES);
    }
}
