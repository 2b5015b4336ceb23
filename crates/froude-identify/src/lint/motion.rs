//! Motions that contradict each other.

use std::f64::consts::{PI, TAU};

use froude_records::finding::{Finding, Severity};
use froude_records::table::{ColumnData, Table};

use crate::dataset::Dataset;
use crate::law::ForceLaw;

/// An angle that differs from that of the velocity by more says something else, 1°.
pub(crate) const ANGLE_CONTRADICTS_RAD: f64 = std::f64::consts::PI / 180.0;

/// Rows slower than this part of the fastest are at rest: the angle of their velocity is that of noise.
pub(crate) const AT_REST: f64 = 0.05;

/// Speed and angle beside v_x and v_y that say something else: the velocity is used.
///
/// `rows` of the table are those of `data`, in its order.
#[must_use]
pub fn motion_contradictions(table: &Table, rows: &[usize], data: &Dataset) -> Vec<Finding> {
    let read = |name: &str| -> Option<Vec<f64>> {
        table.columns.iter().find(|c| c.name == name).and_then(|c| match &c.data {
            ColumnData::Number { si, .. } => Some(rows.iter().map(|&i| si[i]).collect()),
            ColumnData::Text(_) => None,
        })
    };
    let mut findings = Vec::new();
    let has_velocity = read("v_x").is_some() || read("v_y").is_some();
    if has_velocity && let (Some(stated), Some(derived)) = (read("angle"), data.values("angle")) {
        // At rest there is no angle; a turn more is the same one.
        let speed = data.values("speed").unwrap_or_default();
        let moving = moving(speed, AT_REST);
        let stated_speed = read("speed");
        let apart = |i: usize| angles_apart(stated[i], stated_speed.as_ref().map(|u| u[i]), derived[i]);
        let worst = moving.into_iter().rev().map(|i| (apart(i), i)).max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((worst, row)) = worst.filter(|(worst, _)| *worst > ANGLE_CONTRADICTS_RAD) {
            findings.push(Finding::new(
                Severity::Warning,
                "angle-contradicts-velocity",
                format!(
                    "the angle column differs from atan2(-v_y, v_x) by up to {:.2} deg ({}); v_x and v_y are used{}",
                    worst.to_degrees(),
                    data.row_name(row),
                    match (read("v_x"), read("v_y")) {
                        (Some(_), None) =>
                            " (v_y is missing and read as 0): if v_x is the speed of the carriage, name it speed",
                        (None, Some(_)) => " (v_x is missing and read as 0): give speed and angle, or both velocities",
                        _ => ": check the sign of v_y, or leave one of the two out",
                    }
                ),
            ));
        }
    }
    if has_velocity && let (Some(stated), Some(derived)) = (read("speed"), data.values("speed")) {
        let apart = |i: usize| speeds_apart(stated[i], derived[i]);
        let worst = (0..data.rows).rev().map(|i| (apart(i), i)).max_by(|a, b| a.0.total_cmp(&b.0));
        let scale = derived.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if let Some((worst, row)) = worst.filter(|(worst, _)| *worst > 0.01 * scale) {
            findings.push(Finding::new(
                Severity::Warning,
                "speed-contradicts-velocity",
                format!(
                    "the speed column differs from |v| by up to {worst:.3e} m/s ({}); v_x and v_y are used",
                    data.row_name(row)
                ),
            ));
        }
    }
    findings
}

/// How far a stated angle lies from that of the velocity, rad.
pub(crate) fn angles_apart(stated: f64, stated_speed: Option<f64>, derived: f64) -> f64 {
    // With a speed below zero the body moves the other way than its angle says.
    let astern = if stated_speed.is_some_and(|u| u < 0.0) { PI } else { 0.0 };
    let by = stated + astern - derived;
    (by - TAU * (by / TAU).round()).abs()
}

/// How far a stated speed lies from that of the velocity, m/s.
pub(crate) fn speeds_apart(stated: f64, derived: f64) -> f64 {
    (stated.abs() - derived.abs()).abs()
}

/// Rows that move faster than a part of the fastest; a speed below zero goes astern.
pub(crate) fn moving(speed: &[f64], part: f64) -> Vec<usize> {
    let fastest = speed.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    (0..speed.len()).filter(|&i| speed[i].abs() > part * fastest).collect()
}

/// Loads with the velocity along or about the same axis.
pub(crate) const ALONG: [(&str, &str); 6] =
    [("f_x", "v_x"), ("f_y", "v_y"), ("f_z", "v_z"), ("m_x", "w_x"), ("m_y", "w_y"), ("m_z", "w_z")];

/// Channels of the motion itself and of what it moves through: a load that goes with these alone is a resistance.
pub(crate) const OF_RESISTANCE: [&str; 14] = [
    "speed",
    "angle",
    "v_x",
    "v_y",
    "v_z",
    "w_x",
    "w_y",
    "w_z",
    "density",
    "kinematic_viscosity",
    "temperature",
    "n_links",
    "depth",
    "volume",
];

/// Whether some law explains a load by more than motion: a propeller, an acceleration, a rudder may point along it.
pub(crate) fn has_other_cause(load: &str, laws: &[ForceLaw]) -> bool {
    let of_load = laws.iter().filter(|law| law.responses.iter().any(|r| r == load));
    of_load.flat_map(ForceLaw::channels).any(|channel| !OF_RESISTANCE.contains(&channel))
}
