//! A fitted tare, subtracted with its covariance as an error that all observations share.

use froude_records::campaign::Tare;
use froude_records::estimate::EstimateFile;
use froude_records::finding::{Finding, Severity};
use froude_records::json::read_estimates;

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::uncertainty::SharedError;

/// Subtracts the tare's predicted loads from `data`.
///
/// The tare is a record made by an earlier fit; its coefficients' covariance becomes a shared error.
///
/// # Errors
///
/// An unreadable record, one with no matching estimate, or a law that the table cannot evaluate.
pub fn subtract(data: &mut Dataset, tare: &Tare) -> Result<(Option<SharedError>, Finding), IdentifyError> {
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
    Ok((error, Finding::new(severity, "tare-subtracted", message)))
}
