//! A fitted tare, subtracted with its covariance as an error that all observations share.
//!
//! A tare holds where it was taken: at other angles ([`angles`]), speeds or in another fluid ([`setting`]) something of it stays in the
//! loads of the body, and is said with its size.

mod angles;
mod setting;

use froude_records::campaign::Tare;
use froude_records::estimate::EstimateFile;
use froude_records::finding::{Finding, Severity};
use froude_records::json::read_estimates;

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::uncertainty::SharedError;
use angles::beyond_its_angles;
use setting::{Use, own_errors};

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
    let used = Use { data, estimate, law: &law, predicted: &predicted };
    let mut misfits: Vec<Finding> = [
        own_errors(&file, estimate),
        used.along_the_chain(),
        used.other_fluid(),
        used.other_speeds(),
        used.other_way(),
        used.pushes(),
        used.smaller_angles(),
    ]
    .into_iter()
    .flatten()
    .collect();
    misfits.extend(beyond_its_angles(data, estimate, &law, &values, &predicted)?);
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
            shared: "campaign",
            dof: covariance
                .names
                .iter()
                .filter_map(|name| estimate.coefficients.get(name)?.effective_dof)
                .fold(f64::INFINITY, f64::min),
            limits: None,
            is_of_each_row: false,
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
    findings.extend(misfits);
    Ok((error, findings))
}

/// Largest force that stays in a measured load, N, and its share of the load over all rows, Σ|f stays|/Σf², %: by no more than that a
/// coefficient of that load is off. `None` where it does not matter.
fn size(rows: &[usize], stays_n: &dyn Fn(usize) -> f64, load_n: &[f64]) -> Option<(f64, f64)> {
    let all: f64 = load_n.iter().map(|f| f * f).sum();
    let (mut along, mut most_n) = (0.0, 0.0_f64);
    for &i in rows {
        along += (stays_n(i) * load_n[i]).abs();
        most_n = most_n.max(stays_n(i).abs());
    }
    let share = if all > 0.0 { along / all } else { 0.0 };
    (share > MATTERS_ABOVE).then_some((most_n, 100.0 * share))
}
