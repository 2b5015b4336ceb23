//! A fitted tare, subtracted with its covariance as an error that all observations share.
//!
//! A tare holds where it was taken. Straight ahead a strut only drags; at drift it
//! also pushes sideways, and that force stays in the loads of the body when the tare
//! knows nothing of it.

use std::f64::consts::{FRAC_PI_2, PI};

use froude_records::campaign::Tare;
use froude_records::estimate::{Estimate, EstimateFile};
use froude_records::finding::{Finding, Severity};
use froude_records::json::read_estimates;

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::uncertainty::SharedError;

/// Angles this far beyond those of the tare runs are still theirs, 1°: at it a round strut's side force is 2 % of its drag.
const SAME_ANGLE_RAD: f64 = PI / 180.0;
/// A part of the load that is worth a warning.
const MATTERS_ABOVE: f64 = 0.005;

/// Subtracts the tare's predicted loads from `data`.
///
/// The tare is a record made by an earlier fit; its coefficients' covariance becomes a shared error.
///
/// # Errors
///
/// An unreadable record, one with no matching estimate, or a law that the table cannot evaluate.
pub fn subtract(data: &mut Dataset, tare: &Tare) -> Result<(Option<SharedError>, Vec<Finding>), IdentifyError> {
    let file: EstimateFile = read_estimates(&tare.record)?;
    let estimate = crate::select::one_estimate(&file, tare.select.as_deref(), &tare.record)?;
    let law = ForceLaw::of_estimate(estimate, data)?;
    let complaint = |what: String| IdentifyError::Campaign { place: tare.record.display().to_string(), what };
    let values = law
        .coefficients
        .iter()
        .map(|c| {
            estimate.coefficients.get(&c.name).and_then(|c| c.value).ok_or_else(|| {
                complaint(format!("{} does not determine {}; use another model as tare", estimate.id, c.name))
            })
        })
        .collect::<Result<Vec<f64>, _>>()?;
    if let Some(missing) = law.responses.iter().find(|r| data.values(r).is_none()) {
        return Err(complaint(format!("{} gives {missing}, which the table does not measure", estimate.id)));
    }
    let predicted = law.predict(data, &values)?;
    let slopes = law.regressors(data, &values)?;
    let n = data.rows;
    let askew = beyond_its_angles(data, estimate, &law, &values)?;
    for (r, response) in law.responses.iter().enumerate() {
        if let Some(channel) = data.channels.get_mut(response) {
            for i in 0..n {
                channel.values[i] -= predicted[r * n + i];
            }
        }
    }
    let message = format!(
        "the tare of {} ({}) is subtracted{}",
        estimate.id,
        law.responses.join(", "),
        if estimate.covariance.is_some() {
            "; its covariance is an error that all observations share"
        } else {
            "; it states no uncertainty, so none is propagated"
        }
    );
    let error = estimate.covariance.as_ref().map(|covariance| {
        let columns: Vec<usize> = covariance.names.iter().filter_map(|name| law.position(name)).collect();
        SharedError {
            name: format!("tare {}", estimate.id),
            directions: law
                .responses
                .iter()
                .enumerate()
                .map(|(r, response)| {
                    let rows = (0..n).map(|i| columns.iter().map(|&j| -slopes[(r * n + i, j)]).collect()).collect();
                    (response.clone(), rows)
                })
                .collect(),
            covariance: covariance.matrix.clone(),
        }
    });
    let severity = if error.is_some() { Severity::Note } else { Severity::Warning };
    let mut findings = vec![Finding::new(severity, "tare-subtracted", message)];
    findings.extend(askew);
    Ok((error, findings))
}

/// Largest angle to the x axis at which a tare was taken, rad; `None` where nothing says.
fn reach(estimate: &Estimate, law: &ForceLaw) -> Option<f64> {
    let says_nothing_of_sides = !law.responses.iter().any(|r| r == "f_y");
    match estimate.validity.get("angle") {
        Some(range) => Some(range.low.abs().max(range.high.abs()).min(FRAC_PI_2)),
        None => says_nothing_of_sides.then_some(0.0),
    }
}

/// Rows at larger angles than those of the tare runs, and what that leaves in the loads.
fn beyond_its_angles(
    data: &Dataset,
    estimate: &Estimate,
    law: &ForceLaw,
    values: &[f64],
) -> Result<Option<Finding>, IdentifyError> {
    let (Some(angle), Some(speed), Some(reach)) = (data.values("angle"), data.values("speed"), reach(estimate, law))
    else {
        return Ok(None);
    };
    let askew = |a: f64| a.sin().abs().asin();
    let rows: Vec<usize> =
        (0..data.rows).filter(|&i| speed[i] > 0.0 && askew(angle[i]) > reach + SAME_ANGLE_RAD).collect();
    if rows.is_empty() {
        return Ok(None);
    }
    let most = rows.iter().map(|&i| askew(angle[i])).fold(0.0, f64::max);
    let taken = if reach > SAME_ANGLE_RAD {
        format!("up to {:.1} deg", reach.to_degrees())
    } else {
        "straight ahead".to_owned()
    };
    let size = match law.responses.iter().position(|r| r == "f_x") {
        Some(r) => {
            let mut ahead = data.clone();
            ahead.put("angle", vec![0.0; data.rows], froude_records::units::Dimension::ANGLE);
            ahead.velocity_from_speed_and_angle();
            let drag_n: Vec<f64> = law.predict(&ahead, values)?[r * data.rows..(r + 1) * data.rows].to_vec();
            left_in_the_loads(data, law, &rows, &drag_n)
        }
        None => Some(String::new()),
    };
    let Some(size) = size else { return Ok(None) };
    Ok(Some(Finding::new(
        Severity::Warning,
        "tare-straight-ahead",
        format!(
            "the tare {} was taken {taken} and is used at angles up to {:.1} deg, in {} of {} rows{size}; tow the strut alone at the \
             angles of the test, fit these runs with models = [\"strut\"] (f_x and f_y) and subtract that record",
            estimate.id,
            most.to_degrees(),
            rows.len(),
            data.rows
        ),
    )))
}

/// Size of what a strut that drags alike from all sides would leave, in words; `None` where it does not matter.
fn left_in_the_loads(data: &Dataset, law: &ForceLaw, rows: &[usize], drag_n: &[f64]) -> Option<String> {
    let angle = data.values("angle")?;
    // Least-squares share of the measured load: by so much the coefficients of that load are off.
    let share = |of: &dyn Fn(usize) -> f64, load: &[f64]| {
        let (mut along, mut all) = (0.0, 0.0);
        for &i in rows {
            along += of(i) * load[i];
            all += load[i] * load[i];
        }
        if all > 0.0 { (along / all).abs() } else { 0.0 }
    };
    let largest = |of: &dyn Fn(usize) -> f64| rows.iter().map(|&i| of(i).abs()).fold(0.0, f64::max);
    if let Some(side) = data.values("f_y").filter(|_| !law.responses.iter().any(|r| r == "f_y")) {
        // The drag straight ahead is negative; the same force turned against a v_y below zero points to starboard.
        let sideways = |i: usize| -drag_n[i] * angle[i].sin();
        let share = share(&sideways, side);
        return (share > MATTERS_ABOVE).then(|| {
            format!(
                "; its side force stays in f_y: of a strut that drags alike from all sides up to {:.3} N, {:.1} % of the measured f_y \
                 (and of its coefficients), of a streamlined one several times that",
                largest(&sideways),
                100.0 * share
            )
        });
    }
    let along = data.values("f_x")?;
    let missing = |i: usize| drag_n[i] * angle[i].cos() * (1.0 - angle[i].cos().abs());
    let share = share(&missing, along);
    (share > MATTERS_ABOVE).then(|| {
        format!(
            "; its drag there is another one: of a strut that drags alike from all sides by up to {:.3} N, {:.1} % of the measured f_x",
            largest(&missing),
            100.0 * share
        )
    })
}
