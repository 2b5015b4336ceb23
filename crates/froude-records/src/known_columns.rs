//! Columns that mean the same in every table: what they measure, and the units that people write.

use crate::units::Dimension;

/// The dimension that a known column must have; `None` for any other name.
#[must_use]
pub fn known_dimension(name: &str) -> Option<Dimension> {
    let (base, dots) = match name.strip_suffix("_dot") {
        Some(base) => (base, 1),
        None => (name, 0),
    };
    let base = base.strip_prefix("std_").unwrap_or(base);
    let base = base.strip_prefix("zero_before_").or_else(|| base.strip_prefix("zero_after_")).unwrap_or(base);
    let dimension = match base {
        "v_x" | "v_y" | "v_z" if dots == 1 => Dimension::ACCELERATION,
        "w_x" | "w_y" | "w_z" if dots == 1 => Dimension::ANGULAR_ACCELERATION,
        _ if dots == 1 => return None,
        "v_x" | "v_y" | "v_z" | "speed" => Dimension::SPEED,
        "w_x" | "w_y" | "w_z" => Dimension::ANGULAR_SPEED,
        "f_x" | "f_y" | "f_z" => Dimension::FORCE,
        "m_x" | "m_y" | "m_z" => Dimension::MOMENT,
        "angle" | "n_links" | "repeat" => Dimension::ONE,
        "temperature" => Dimension::TEMPERATURE,
        "density" => Dimension::DENSITY,
        "kinematic_viscosity" => Dimension::KINEMATIC_VISCOSITY,
        "volume" => Dimension::VOLUME,
        _ => return None,
    };
    Some(dimension)
}

/// Columns that are text whatever stands in them.
#[must_use]
pub fn is_text_column(name: &str) -> bool {
    matches!(name, "configuration" | "setup" | "run")
}

/// The usual unit of a known column, for advice.
pub(crate) fn usual_unit(name: &str) -> Option<String> {
    known_dimension(name).map(|dimension| usual_unit_for(name, dimension))
}

/// The unit that people write for a key or column of this kind, for advice.
pub(crate) fn usual_unit_for(name: &str, dimension: Dimension) -> String {
    match (name, dimension) {
        ("angle" | "std_angle" | "misalignment", Dimension::ONE) => "deg".to_owned(),
        ("salinity", Dimension::ONE) => "g/kg".to_owned(),
        (_, Dimension::TEMPERATURE) => "degC".to_owned(),
        (_, Dimension::ANGULAR_SPEED) => "rad/s".to_owned(),
        (_, Dimension::ANGULAR_ACCELERATION) => "rad/s^2".to_owned(),
        _ => dimension.to_string(),
    }
}

/// What a known column measures, and the same in words for messages.
pub(crate) fn expected(name: &str) -> Option<(Dimension, String)> {
    let dimension = known_dimension(name)?;
    let words = match (name, dimension) {
        ("angle" | "std_angle", _) => "an angle (deg)".to_owned(),
        (_, Dimension::ONE) => "a pure number (1)".to_owned(),
        (_, Dimension::ANGULAR_SPEED) => "an angular speed (rad/s)".to_owned(),
        (_, Dimension::ANGULAR_ACCELERATION) => "an angular acceleration (rad/s^2)".to_owned(),
        (_, Dimension::MOMENT) => "a moment (N m)".to_owned(),
        (_, Dimension::TEMPERATURE) => "a temperature (degC)".to_owned(),
        _ => dimension.describe(),
    };
    Some((dimension, words))
}
