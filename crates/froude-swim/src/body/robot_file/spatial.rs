//! What a robot file says for three dimensions.
//!
//! ```toml
//! [coefficients]
//! added_mass = { surge = "0.10 kg", sway = "1.65 kg", heave = "0.74 kg", roll = "2e-4 kg m^2", pitch = "2e-3 kg m^2", yaw = "4.5e-3 kg m^2", sway_yaw = "0 kg m" }
//!                                    # couplings in the order of the motions, each may be left out; or { record = …, select = … } with A11 to A66 of a module
//! [model]
//! space = "3d"                       # planar
//! heave_drag = 0.67                  # drag up and down over that across, left out: minor over major semi-axis (the area seen from above)
//! roll_drag = { linear = "1e-3 N m s/rad", quadratic = "2e-3 N m s^2/rad^2" }   # of a module; left out: none
//!
//! [[module]]
//! center_of_mass = ["0 mm", "0 mm", "5 mm"]        # ahead, to starboard, down from its centre; or how far ahead
//! center_of_buoyancy = ["0 mm", "0 mm", "-5 mm"]   # left out: at its centre
//! inertia = { roll = "1.7e-3 kg m^2", pitch = "4.8e-3 kg m^2", yaw = "4.1e-3 kg m^2" }   # about its centre of mass
//! added_mass = { … }                 # its own, in place of that of [coefficients]
//! ```

use froude_records::RecordError;
use froude_records::section::{Section, Source, found};
use froude_records::units::Dimension;
use toml::Spanned;
use toml::de::DeValue;

use super::{FromRecord, from_record};

/// N m s: a moment over an angular speed.
pub(super) const DAMPING: Dimension = Dimension::new(2, 1, -1);

/// kg m².
const INERTIA: Dimension = Dimension::new(2, 1, 0);
/// kg m.
const COUPLING: Dimension = Dimension::new(1, 1, 0);
/// Motions in the order of a matrix, with the keys of its diagonal.
pub const MOTIONS: [&str; 6] = ["surge", "sway", "heave", "roll", "pitch", "yaw"];
/// Couplings, with where they stand.
const COUPLINGS: [(&str, usize, usize); 15] = [
    ("surge_sway", 0, 1),
    ("surge_heave", 0, 2),
    ("surge_roll", 0, 3),
    ("surge_pitch", 0, 4),
    ("surge_yaw", 0, 5),
    ("sway_heave", 1, 2),
    ("sway_roll", 1, 3),
    ("sway_pitch", 1, 4),
    ("sway_yaw", 1, 5),
    ("heave_roll", 2, 3),
    ("heave_pitch", 2, 4),
    ("heave_yaw", 2, 5),
    ("roll_pitch", 3, 4),
    ("roll_yaw", 3, 5),
    ("pitch_yaw", 4, 5),
];
/// What a matrix may be short of a positive one by rounding.
const ROUNDING: f64 = 1e-9;

/// Added mass of a module.
#[derive(Debug, Clone, PartialEq)]
pub enum AddedFile {
    /// Of a record.
    Record(FromRecord),
    /// In numbers: kg, kg m, kg m², in the order of [`MOTIONS`], about its centre.
    Declared([[f64; 6]; 6]),
}

/// Drag up and down over that across.
pub(super) fn heave_drag(s: &Section<'_>) -> Result<Option<f64>, RecordError> {
    let heave_drag = s.number("heave_drag")?;
    if let (Some(value), Some(ratio)) = (s.get("heave_drag"), heave_drag)
        && !(ratio >= 0.0 && ratio.is_finite())
    {
        let problem =
            format!("is {}; expected a number of zero or more, drag up and down over that across", found(value));
        return Err(s.wrong("heave_drag", value, problem));
    }
    Ok(heave_drag)
}

/// Drag of a module about its own axis, linear and quadratic.
pub(super) fn roll_drag(s: &Section<'_>) -> Result<[f64; 2], RecordError> {
    let Some(roll) = s.section("roll_drag")? else { return Ok([0.0; 2]) };
    roll.only(&["linear", "quadratic"])?;
    let linear = not_negative(&roll, "linear", DAMPING, "drag")?;
    Ok([linear.unwrap_or(0.0), not_negative(&roll, "quadratic", INERTIA, "drag")?.unwrap_or(0.0)])
}

pub(super) fn not_negative(
    s: &Section<'_>,
    key: &'static str,
    dimension: Dimension,
    what: &str,
) -> Result<Option<f64>, RecordError> {
    let number = s.quantity(key, dimension)?;
    match (s.get(key), number) {
        (Some(value), Some(number)) if number < 0.0 => {
            Err(s.wrong(key, value, format!("is {}; {what} is zero or more", found(value))))
        }
        _ => Ok(number),
    }
}

/// A place in a module: three lengths, or how far ahead.
pub(super) fn place(s: &Section<'_>, key: &'static str, half_m: [f64; 3]) -> Result<Option<[f64; 3]>, RecordError> {
    let Some(value) = s.get(key) else { return Ok(None) };
    let length = |v| s.as_quantity_of(key, v, Dimension::LENGTH);
    let place = match value.get_ref().as_array().map(|list| &list[..]) {
        None => [length(value)?, 0.0, 0.0],
        Some([x, y, z]) => [length(x)?, length(y)?, length(z)?],
        Some(_) => {
            let problem = format!(
                "is {}; expected how far ahead it lies, \"5 mm\", or ahead, to starboard and down: [\"0 mm\", \"0 mm\", \"5 mm\"]",
                found(value)
            );
            return Err(s.wrong(key, value, problem));
        }
    };
    let directions = ["ahead", "to starboard", "down"];
    for k in 0..3 {
        if place[k].abs() > half_m[k] {
            let problem = format!(
                "is {} m {}, which lies outside of the module: from its centre it reaches {} m",
                place[k], directions[k], half_m[k]
            );
            return Err(s.wrong(key, value, problem));
        }
    }
    Ok(Some(place))
}

/// Of roll, pitch and yaw: all three, that of yaw alone, or those of a solid elliptic cylinder of its mass.
pub(super) fn inertia(s: &Section<'_>, of_cylinder: [f64; 3]) -> Result<[f64; 3], RecordError> {
    let Some(value) = s.get("inertia") else { return Ok(of_cylinder) };
    if !value.get_ref().is_table() {
        let yaw = s.positive("inertia", INERTIA)?.unwrap_or(of_cylinder[2]);
        return Ok([of_cylinder[0], of_cylinder[1], yaw]);
    }
    let all = s.as_section("inertia", value)?;
    all.only(&["roll", "pitch", "yaw"])?;
    let one = |key| {
        all.positive(key, INERTIA)?.ok_or_else(|| {
            all.missing(
                key,
                "write all three: { roll = \"1.7e-3 kg m^2\", pitch = \"4.8e-3 kg m^2\", yaw = \"4.1e-3 kg m^2\" }",
            )
        })
    };
    let found = [one("roll")?, one("pitch")?, one("yaw")?];
    triangle(s, value, found)?;
    Ok(found)
}

/// No body has one inertia above the sum of the two others.
fn triangle(s: &Section<'_>, value: &Spanned<DeValue<'_>>, all: [f64; 3]) -> Result<(), RecordError> {
    for k in 0..3 {
        let others = all[(k + 1) % 3] + all[(k + 2) % 3];
        if all[k] > others * (1.0 + ROUNDING) {
            let problem = format!(
                "has {} kg m² of {}, and the two others are {others} kg m² together: no body has one inertia above the sum of the two others",
                all[k],
                MOTIONS[3 + k]
            );
            return Err(s.wrong("inertia", value, problem));
        }
    }
    Ok(())
}

/// Added mass of a module by its table; all six motions where the model is of three dimensions, else surge may be left out and heave, roll and pitch too.
pub(super) fn added(source: Source<'_>, s: &Section<'_>, is_3d: bool) -> Result<AddedFile, RecordError> {
    if s.get("record").is_some() {
        return Ok(AddedFile::Record(from_record(source, s)?));
    }
    let advice = if is_3d {
        "three dimensions need all six, zero where there is none: { surge = \"0.1 kg\", sway = \"1.65 kg\", heave = \"0.74 kg\", roll = \"2e-4 kg m^2\", pitch = \"2e-3 kg m^2\", yaw = \"4.5e-3 kg m^2\" }, or { record = \"added-mass/estimate.json\" } of a module"
    } else {
        super::ADDED_ADVICE
    };
    let known: Vec<&'static str> = MOTIONS.into_iter().chain(COUPLINGS.map(|(key, ..)| key)).collect();
    s.only(&known)?;
    let mut all = [[0.0; 6]; 6];
    for (k, key) in MOTIONS.into_iter().enumerate() {
        let dimension = if k < 3 { Dimension::MASS } else { INERTIA };
        let is_of_the_plane = key == "sway" || key == "yaw";
        let given = if is_of_the_plane {
            s.positive(key, dimension)?
        } else {
            not_negative(s, key, dimension, "an added mass")?
        };
        all[k][k] = match given {
            Some(x) => x,
            None if is_3d || is_of_the_plane => return Err(s.missing(key, advice)),
            None => 0.0,
        };
    }
    for (key, i, j) in COUPLINGS {
        let dimension = match i / 3 + j / 3 {
            0 => Dimension::MASS,
            1 => COUPLING,
            _ => INERTIA,
        };
        let Some(x) = s.quantity(key, dimension)? else { continue };
        let most = (all[i][i] * all[j][j]).sqrt();
        if let Some(value) = s.get(key)
            && x.abs() > most * (1.0 + ROUNDING)
        {
            let problem = format!(
                "is {}, and beside {} and {} of {} and {} it is at most {most} in size: the added mass would not be positive semi-definite",
                found(value),
                MOTIONS[i],
                MOTIONS[j],
                all[i][i],
                all[j][j]
            );
            return Err(s.wrong(key, value, problem));
        }
        (all[i][j], all[j][i]) = (x, x);
    }
    if let Some(least) = negative(&all) {
        return Err(RecordError::Value {
            place: s.place(),
            key: "added_mass".to_owned(),
            problem: format!(
                "is not positive semi-definite: with its diagonal scaled to one, some motion has an inertia of {least:.3e}; check its couplings"
            ),
        });
    }
    Ok(AddedFile::Declared(all))
}

/// Where a symmetric matrix is not positive semi-definite: the pivot at which it fails, of the matrix whose diagonal is scaled to one.
#[must_use]
pub fn negative(a: &[[f64; 6]; 6]) -> Option<f64> {
    let size: [f64; 6] = std::array::from_fn(|k| a[k][k].max(0.0).sqrt());
    if let Some(k) = (0..6).find(|k| a[*k][*k].is_nan() || a[*k][*k] < 0.0) {
        return Some(a[k][k]);
    }
    // Where there is no inertia there is no coupling; a tiny one is left by rounding.
    let floor = size.iter().fold(0.0_f64, |m, s| m.max(*s)) * ROUNDING;
    let scaled = |i: usize, j: usize| a[i][j] / (size[i].max(floor) * size[j].max(floor)).max(f64::MIN_POSITIVE);
    let mut left: [[f64; 6]; 6] = std::array::from_fn(|i| std::array::from_fn(|j| scaled(i, j)));
    for k in 0..6 {
        let pivot = left[k][k];
        if pivot < -ROUNDING {
            return Some(pivot);
        }
        let column: [f64; 6] = std::array::from_fn(|i| left[i][k]);
        if pivot <= ROUNDING {
            // A motion without inertia of its own: its couplings must be none.
            if let Some(x) = column[k + 1..].iter().find(|x| x.abs() > ROUNDING.sqrt()) {
                return Some(-x.abs());
            }
            continue;
        }
        for i in k + 1..6 {
            for j in k + 1..6 {
                left[i][j] -= column[i] * column[j] / pivot;
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_that_gives_a_motion_negative_energy_is_found() {
        let mut a = [[0.0; 6]; 6];
        for (k, x) in [0.1, 1.65, 0.74, 0.0, 2e-3, 4.5e-3].into_iter().enumerate() {
            a[k][k] = x;
        }
        assert_eq!(negative(&a), None);
        (a[1][5], a[5][1]) = (0.08, 0.08);
        assert_eq!(negative(&a), None);
        // Above √(1.65 · 4.5e-3) = 0.0862 kg m.
        (a[1][5], a[5][1]) = (0.09, 0.09);
        assert!(negative(&a).is_some_and(|x| x < 0.0));
        // Three motions that are coupled pair by pair, each pair within its own limit.
        let mut b = [[0.0; 6]; 6];
        for k in 0..6 {
            b[k][k] = 1.0;
        }
        for (i, j, x) in [(0, 1, 0.9), (1, 2, 0.9), (0, 2, -0.9)] {
            (b[i][j], b[j][i]) = (x, x);
        }
        assert!(negative(&b).is_some());
    }
}
