//! Added mass of plates, prisms and cylinders, as a recommended practice prints it.
//!
//! For an estimate at the desk. The tables are older than panel methods and rounded to two or three digits; how far each lies
//! from potential flow is stated with it. A panel method is not to be checked against them: for that there is
//! [`ellipsoid`](crate::ellipsoid).
//!
//! **Setting.** One body in unbounded ideal fluid, moving without turning along the direction named.
//! **Units.** SI. A coefficient `[-]` is per mass of the table's own reference volume; an added mass over ρ has m³.
//!
//! | body | motion | function | source |
//! |------|--------|----------|--------|
//! | circular disc     | square to it        | [`circular_disc_added_mass_m3`]     | exact: Lamb 1932, §102 |
//! | rectangular plate | square to it        | [`rectangular_plate_added_mass_m3`] | DNV-RP-C205 (2010), App. D, Table D-2 |
//! | square prism      | along its length    | [`square_prism_added_mass_m3`]      | same |
//! | circular cylinder | square to its axis  | [`circular_cylinder_added_mass_m3`] | same |
//!
//! Between rows the coefficient runs linearly in the inverse of the ratio, so that a row for the endless body has its place.
//!
//! Not here: spheroids and elliptic discs, which have closed forms; cylinders moving end-on, free surface, sea bed.

use core::f64::consts::PI;

/// A ratio of lengths that a table does not cover.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{body}: {ratio_of} is {ratio}; the table goes from {least} to {most}")]
pub struct TableError {
    /// Which table.
    pub body: &'static str,
    /// What its rows go by.
    pub ratio_of: &'static str,
    /// What was asked for.
    pub ratio: f64,
    /// Its first row.
    pub least: f64,
    /// Its last row.
    pub most: f64,
}

/// A printed table of coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Table {
    /// The body.
    pub body: &'static str,
    /// What the rows go by.
    pub ratio_of: &'static str,
    /// `(ratio, coefficient)` as printed, ratios rising; the last may be infinite.
    pub rows: &'static [(f64, f64)],
}

/// Rectangular plate moving square to itself, by length over breadth `b/a`; on `π/4 a²b`.
///
/// Within 0.0005 of potential flow but for three rows: 3.00 is low by 0.0018; 8.00 and 10.00 are cut off instead of rounded
/// (0.9347, 0.9476). See the tests.
#[rustfmt::skip]
pub const RECTANGULAR_PLATE: Table = Table {
    body: "rectangular plate",
    ratio_of: "length over breadth",
    rows: &[
        (1.00, 0.579), (1.25, 0.642), (1.50, 0.690), (1.59, 0.704), (2.00, 0.757), (2.50, 0.801), (3.00, 0.830),
        (3.17, 0.840), (4.00, 0.872), (5.00, 0.897), (6.25, 0.917), (8.00, 0.934), (10.00, 0.947), (f64::INFINITY, 1.000),
    ],
};

/// Square prism moving along its length, by length over side `b/a`; on its volume `a²b`.
///
/// 7 to 13 % above potential flow. See the tests.
pub const SQUARE_PRISM: Table = Table {
    body: "square prism",
    ratio_of: "length over side",
    rows: &[(1.0, 0.68), (2.0, 0.36), (3.0, 0.24), (4.0, 0.19), (5.0, 0.15), (6.0, 0.13), (7.0, 0.11), (10.0, 0.08)],
};

/// Circular cylinder with flat ends moving square to its axis, by length over diameter `b/2a`; on its volume `πa²b`.
///
/// Within its rounding of potential flow for the two short ones; 5 and 9 diameters are 3 % above. See the tests.
pub const CIRCULAR_CYLINDER: Table = Table {
    body: "circular cylinder",
    ratio_of: "length over diameter",
    rows: &[(1.2, 0.62), (2.5, 0.78), (5.0, 0.90), (9.0, 0.96), (f64::INFINITY, 1.00)],
};

impl Table {
    /// Coefficient at a ratio \[-\], linear in the inverse ratio between rows.
    ///
    /// # Errors
    ///
    /// [`TableError`] outside the rows: nothing is extrapolated.
    pub fn coefficient(&self, ratio: f64) -> Result<f64, TableError> {
        for pair in self.rows.windows(2) {
            let [(low, at_low), (high, at_high)] = *pair else { continue };
            if (low..=high).contains(&ratio) {
                let part = (1.0 / low - 1.0 / ratio) / (1.0 / low - 1.0 / high);
                return Ok(at_low + (at_high - at_low) * part);
            }
        }
        let end = |row: Option<&(f64, f64)>| row.map_or(f64::NAN, |r| r.0);
        let (least, most) = (end(self.rows.first()), end(self.rows.last()));
        Err(TableError { body: self.body, ratio_of: self.ratio_of, ratio, least, most })
    }
}

/// Added mass over ρ of a thin circular disc moving square to itself, `8/3 a³` \[m³\]: exact.
///
/// # Source
///
/// Lamb (1932), §102. (DNV-RP-C205 prints it as 2/π of a sphere's volume.)
#[must_use]
pub fn circular_disc_added_mass_m3(radius_m: f64) -> f64 {
    8.0 / 3.0 * radius_m * radius_m * radius_m
}

/// Added mass over ρ of a thin rectangular plate moving square to itself, `C π/4 a²b` \[m³\], `a` the shorter side.
///
/// The sides may come in either order; see [`RECTANGULAR_PLATE`] for how good it is.
///
/// # Errors
///
/// [`TableError`] when a side is not a positive number.
///
/// # Source
///
/// DNV-RP-C205 (2010), App. D, Table D-2.
///
/// # Example
///
/// ```
/// # use froude_hydro::tabulated::{TableError, rectangular_plate_added_mass_m3};
/// let heave_kg = 1000.0 * rectangular_plate_added_mass_m3(0.2, 0.4)?;
/// assert!((heave_kg - 9.51).abs() < 0.01);
/// # Ok::<(), TableError>(())
/// ```
pub fn rectangular_plate_added_mass_m3(side_m: f64, other_side_m: f64) -> Result<f64, TableError> {
    let (short, long) = if side_m <= other_side_m { (side_m, other_side_m) } else { (other_side_m, side_m) };
    Ok(RECTANGULAR_PLATE.coefficient(long / short)? * PI / 4.0 * short * short * long)
}

/// Added mass over ρ of a square prism moving along its length, `C a²b` \[m³\]; length from 1 to 10 sides.
///
/// # Errors
///
/// [`TableError`] outside that range.
///
/// # Source
///
/// DNV-RP-C205 (2010), App. D, Table D-2; see [`SQUARE_PRISM`] for how good it is.
pub fn square_prism_added_mass_m3(side_m: f64, length_m: f64) -> Result<f64, TableError> {
    Ok(SQUARE_PRISM.coefficient(length_m / side_m)? * side_m * side_m * length_m)
}

/// Added mass over ρ of a circular cylinder moving square to its axis, `C πa²b` \[m³\]; length from 1.2 diameters.
///
/// # Errors
///
/// [`TableError`] for a shorter one.
///
/// # Source
///
/// DNV-RP-C205 (2010), App. D, Table D-2; see [`CIRCULAR_CYLINDER`] for how good it is.
pub fn circular_cylinder_added_mass_m3(radius_m: f64, length_m: f64) -> Result<f64, TableError> {
    Ok(CIRCULAR_CYLINDER.coefficient(0.5 * length_m / radius_m)? * PI * radius_m * radius_m * length_m)
}
