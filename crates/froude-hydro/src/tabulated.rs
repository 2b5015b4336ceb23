//! Added mass of a circular cylinder, as a recommended practice prints it.
//!
//! For a quick estimate. The table is older than panel methods and rounded to two digits: within its rounding of
//! potential flow for short cylinders, 3 % above it at 5 and 9 diameters (see the tests). A panel method is not to be
//! checked against it: for that there is [`ellipsoid`](crate::ellipsoid).
//!
//! **Setting.** One cylinder with flat ends in unbounded ideal fluid, moving normal to its axis without turning.
//! **Units.** SI; an added mass over ρ has m³.
//!
//! Not here: cylinders moving end-on, free surface, sea bed.

use core::f64::consts::PI;

/// `(length over diameter, coefficient)` as printed, per mass of the volume `πa²b`.
const PRINTED: [(f64, f64); 5] = [(1.2, 0.62), (2.5, 0.78), (5.0, 0.90), (9.0, 0.96), (f64::INFINITY, 1.00)];

/// Added mass over ρ of a circular cylinder moving normal to its axis, `C πa²b` \[m³\].
///
/// Between rows the coefficient is interpolated linearly in the inverse ratio, so that the row of the infinite cylinder has its
/// place. `None` below 1.2 diameters: nothing is extrapolated.
///
/// # Source
///
/// DNV-RP-C205 (2010), App. D, Table D-2.
#[must_use]
pub fn circular_cylinder_added_mass_m3(radius_m: f64, length_m: f64) -> Option<f64> {
    let ratio = 0.5 * length_m / radius_m;
    let ends = PRINTED.windows(2).find(|ends| (ends[0].0..=ends[1].0).contains(&ratio))?;
    let [(low, at_low), (high, at_high)] = [ends[0], ends[1]];
    let part = (1.0 / low - 1.0 / ratio) / (1.0 / low - 1.0 / high);
    Some((at_low + (at_high - at_low) * part) * PI * radius_m * radius_m * length_m)
}
