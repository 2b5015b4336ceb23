//! A tare at other angles than its own.
//!
//! Straight ahead a strut only drags; at drift it also pushes sideways, and that force
//! stays in the loads of the body when the tare does not contain it.

use std::f64::consts::{FRAC_PI_2, PI};

use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::lint::motion::moving;
use crate::tare::size::size;
use crate::validity::{AT_REST, OFF_AXIS, off_axis};

/// Angles this far beyond those of the tare runs are still theirs, 1°: at it a round strut's side force is 2 % of its drag.
pub(super) const SAME_ANGLE_RAD: f64 = PI / 180.0;

/// Largest angle to the x axis at which a tare was taken, rad; `None` where nothing says.
fn reach(estimate: &Estimate, gives_f_y: bool) -> Option<f64> {
    if let Some(range) = estimate.validity.get(OFF_AXIS) {
        return Some(range.high);
    }
    // A record from elsewhere states the ends of its angles alone: 0 and ±180° are a tare towed both ways, or turned all round.
    let Some(range) = estimate.validity.get("angle") else { return (!gives_f_y).then_some(0.0) };
    let ends = [range.low, range.high].map(|angle| angle.sin().abs().asin()).into_iter().fold(0.0, f64::max);
    let largest = range.low.abs().max(range.high.abs());
    Some(if gives_f_y && ends <= SAME_ANGLE_RAD { largest.min(FRAC_PI_2) } else { ends })
}

/// Rows at larger angles than those of the tare runs, and what that leaves in the loads.
pub(super) fn beyond_its_angles(
    data: &Dataset,
    estimate: &Estimate,
    law: &ForceLaw,
    values: &[f64],
    predicted: &[f64],
) -> Result<Option<Finding>, IdentifyError> {
    let gives = |load: &str| law.responses.iter().position(|r| r == load);
    let (Some(angle), Some(speed), Some(reach)) =
        (data.values("angle"), data.values("speed"), reach(estimate, gives("f_y").is_some()))
    else {
        return Ok(None);
    };
    let askew = |i: usize| off_axis(data.velocity_m_s(i));
    let beyond = |reach: f64| -> Vec<usize> {
        moving(speed, AT_REST).into_iter().filter(|&i| askew(i) > reach + SAME_ANGLE_RAD).collect()
    };
    // Of a load that the law does not give, the tare contains nothing at any angle.
    let stays_in = |load: &str| data.values(load).filter(|_| gives(load).is_none());
    let (side, moment) = (stays_in("f_y"), stays_in("m_z"));
    let rows = beyond(if side.is_some() || moment.is_some() { 0.0 } else { reach });
    if rows.is_empty() {
        return Ok(None);
    }
    let mut left = Vec::new();
    if let Some(r) = gives("f_x") {
        let mut ahead = data.clone();
        ahead.put("angle", vec![0.0; data.rows], froude_records::units::Dimension::ANGLE);
        ahead.velocity_from_speed_and_angle();
        let drag_n = &law.predict(&ahead, values)?[r * data.rows..(r + 1) * data.rows];
        if let Some(side) = side {
            // The drag straight ahead is negative; the same force turned against a v_y below zero points to starboard.
            let stays_n = |i: usize| -drag_n[i] * angle[i].sin();
            left.extend(size(&rows, &stays_n, side).map(|(most_n, percent)| {
                format!(
                    "its side force stays in f_y, mostly in a coefficient of u v: up to {most_n:.3} N ({percent:.1} % of the measured f_y) for a strut whose drag is the same from all sides, several times that for a streamlined one"
                )
            }));
        }
        if let (Some(q), Some(side)) = (gives("f_y"), data.values("f_y")) {
            let stays_n = |i: usize| -drag_n[i] * angle[i].sin() - predicted[q * data.rows + i];
            left.extend(size(&beyond(reach), &stays_n, side).map(|(most_n, percent)| {
                format!(
                    "its side force differs there: for a strut whose drag is the same from all sides, by up to {most_n:.3} N, {percent:.1} % \
                     of the measured f_y"
                )
            }));
        }
        if let Some(along) = data.values("f_x") {
            let stays_n = |i: usize| drag_n[i] * angle[i].cos() - predicted[r * data.rows + i];
            left.extend(size(&beyond(reach), &stays_n, along).map(|(most_n, percent)| {
                format!(
                    "its drag differs there: for a strut whose drag is the same from all sides, by up to {most_n:.3} N, {percent:.1} % of the \
                     measured f_x"
                )
            }));
        }
        if moment.is_some() && (side.is_none() || !left.is_empty()) {
            left.push("its moment, side force times lever, stays in m_z".to_owned());
        }
        if left.is_empty() {
            return Ok(None);
        }
    }
    let taken = if reach <= SAME_ANGLE_RAD {
        "was taken straight ahead".to_owned()
    } else {
        let without: Vec<&str> =
            [("f_y", side), ("m_z", moment)].into_iter().filter_map(|(load, stays)| stays.map(|_| load)).collect();
        let without = if without.is_empty() { String::new() } else { format!(" without {}", without.join(", ")) };
        format!("was taken up to {:.1} deg{without}", reach.to_degrees())
    };
    let most = rows.iter().map(|&i| askew(i)).fold(0.0, f64::max);
    let left: String = left.iter().map(|text| format!("; {text}")).collect();
    Ok(Some(Finding::new(
        Severity::Warning,
        "tare-straight-ahead",
        format!(
            "the tare {} {taken} and is used at angles up to {:.1} deg, in {} of {} rows{left}; tow the strut alone at the \
             angles of the test, fit these runs with models = [\"strut\"] (f_x and f_y) and subtract that record",
            estimate.id,
            most.to_degrees(),
            rows.len(),
            data.rows
        ),
    )))
}
