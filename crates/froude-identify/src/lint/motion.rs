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
    let has = |name: &str| table.columns.iter().any(|c| c.name == name);
    let worst = |apart: &[f64], rows: Vec<usize>| {
        rows.into_iter().rev().map(|i| (apart[i], i)).max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let speed = data.values("speed").unwrap_or_default();
    let [angles, speeds] = apart(table, rows, data);
    let mut findings = Vec::new();
    if let Some(apart) = angles {
        // At rest there is no angle.
        let worst = worst(&apart, moving(speed, AT_REST));
        if let Some((worst, row)) = worst.filter(|(worst, _)| *worst > ANGLE_CONTRADICTS_RAD) {
            findings.push(Finding::new(
                Severity::Warning,
                "angle-contradicts-velocity",
                format!(
                    "the angle column differs from atan2(-v_y, v_x) by up to {:.2} deg ({}); v_x and v_y are used{}",
                    worst.to_degrees(),
                    data.row_name(row),
                    match (has("v_x"), has("v_y")) {
                        (true, false) =>
                            " (v_y is missing and read as 0): if v_x is the speed of the carriage, name it speed",
                        (false, true) => " (v_x is missing and read as 0): give speed and angle, or both velocities",
                        _ => ": check the sign of v_y, or leave one of the two out",
                    }
                ),
            ));
        }
    }
    if let Some(apart) = speeds {
        let fastest = speed.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let worst = worst(&apart, (0..data.rows).collect());
        if let Some((worst, row)) = worst.filter(|(worst, _)| *worst > 0.01 * fastest) {
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

/// How far the stated angle of each row lies from that of its velocity, rad, and the stated speed, m/s, where a table states both. `rows` of the table are those of `data`, in its order.
pub(crate) fn apart(table: &Table, rows: &[usize], data: &Dataset) -> [Option<Vec<f64>>; 2] {
    let read = |name: &str| match &table.columns.iter().find(|c| c.name == name)?.data {
        ColumnData::Number { si, .. } => Some(si),
        ColumnData::Text(_) => None,
    };
    if read("v_x").or_else(|| read("v_y")).is_none() {
        return [None, None];
    }
    let (angle, speed) = (read("angle"), read("speed"));
    let angle_apart = |(stated, derived, row): (f64, f64, usize)| {
        // With a speed below zero the body moves the other way than its angle says; a turn more is the same angle.
        let astern = if speed.is_some_and(|u| u[row] < 0.0) { PI } else { 0.0 };
        let by = stated + astern - derived;
        (by - TAU * (by / TAU).round()).abs()
    };
    let of = |stated: &Vec<f64>, name: &str, apart: &dyn Fn((f64, f64, usize)) -> f64| -> Option<Vec<f64>> {
        Some(rows.iter().zip(data.values(name)?).map(|(&row, derived)| apart((stated[row], *derived, row))).collect())
    };
    [
        angle.and_then(|stated| of(stated, "angle", &angle_apart)),
        speed.and_then(|stated| of(stated, "speed", &|(stated, derived, _)| (stated.abs() - derived.abs()).abs())),
    ]
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
