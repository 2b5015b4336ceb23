//! A fitted tare, subtracted with its covariance as an error that all observations share.
//!
//! A tare holds where it was taken: at other angles ([`angles`]), speeds or in another fluid ([`setting`]) something of it stays in the
//! loads of the body, and is said with its size.

mod angles;
mod setting;
mod size;

use angles::beyond_its_angles;
use froude_fit::budget::Kind;
use froude_fit::faer::Mat;
use froude_records::campaign::Tare;
use froude_records::estimate::{Estimate, EstimateFile, OWN};
use froude_records::finding::{Finding, Severity};
use froude_records::hash::short_key;
use froude_records::json::read_estimates;
use setting::{Use, own_errors};

use crate::compare::independence::data_of;
use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::uncertainty::SharedError;

/// Subtracts the tare's predicted loads from `data`.
///
/// The tare is a record made by an earlier fit; its coefficients' covariance becomes a shared error. Of a table that has it removed already the loads
/// stay, and the shared error is the same: what was removed wrongly is missing in every row alike.
///
/// y ← y − X_T β_T in N or N m, and C_B ← C_B + S X_T C_T X_Tᵀ Sᵀ: all rows share the error of the tare.
///
/// # Errors
///
/// An unreadable record, one with no matching estimate, or a law that the table cannot evaluate.
///
/// # Source
///
/// JCGM 100:2008 (GUM), 5.2.2 and F.1.2 (a common error correlates all rows).
pub fn subtract(data: &mut Dataset, tare: &Tare) -> Result<(Vec<SharedError>, Vec<Finding>), IdentifyError> {
    let file: EstimateFile = read_estimates(&tare.record)?;
    let estimate = crate::select::one_estimate(&file, tare.select.as_deref(), &tare.record)?;
    let law = ForceLaw::of_estimate(estimate, data)?;
    let complaint = |what: String| IdentifyError::Campaign { place: tare.record.display().to_string(), what };
    let unknown =
        |name: &str| complaint(format!("{} does not determine {name}; use another model as tare", estimate.id));
    let values = law.values_of(estimate).map_err(unknown)?;
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
    for (r, response) in law.responses.iter().enumerate().filter(|_| !tare.is_removed) {
        if let Some(channel) = data.channels.get_mut(response) {
            for i in 0..n {
                channel.values[i] -= predicted[r * n + i];
            }
        }
    }
    let (code, done) = if tare.is_removed {
        ("tare-removed-before", "was removed from the table before and is not subtracted again")
    } else {
        ("tare-subtracted", "is subtracted")
    };
    let message = format!(
        "the tare of {} ({}) {done}{}",
        estimate.id,
        law.responses.join(", "),
        if estimate.type_a.is_some() {
            "; its covariance is an error that all observations share"
        } else {
            "; it states no uncertainty, so none is propagated"
        }
    );
    let errors = errors(&file, estimate, &law, &slopes);
    let severity = if estimate.type_a.is_some() { Severity::Note } else { Severity::Warning };
    let mut findings = vec![Finding::new(severity, code, message)];
    findings.extend(misfits);
    Ok((errors, findings))
}

/// The errors of a tare as errors that all observations share: its scatter, known by the files that it came from, and what it has from
/// elsewhere under the same keys.
fn errors(file: &EstimateFile, estimate: &Estimate, law: &ForceLaw, slopes: &Mat<f64>) -> Vec<SharedError> {
    let Some(scatter) = &estimate.type_a else { return Vec::new() };
    let columns: Vec<Option<usize>> = scatter.names.iter().map(|name| law.position(name)).collect();
    let n = slopes.nrows() / law.responses.len().max(1);
    // ∂load/∂e of one row: −Σ_j ∂f/∂β_j · S_jk.
    let row = |at: usize, sensitivity: &dyn Fn(usize, usize) -> f64, q: usize| -> Vec<f64> {
        let of = |k: usize| {
            columns.iter().enumerate().filter_map(move |(j, c)| c.map(|c| -slopes[(at, c)] * sensitivity(j, k)))
        };
        (0..q).map(|k| of(k).sum()).collect()
    };
    let directions = |sensitivity: &dyn Fn(usize, usize) -> f64, q: usize| {
        let of = |(r, load): (usize, &String)| (load.clone(), (0..n).map(|i| row(r * n + i, sensitivity, q)).collect());
        law.responses.iter().enumerate().map(of).collect()
    };
    let own = SharedError {
        name: format!("tare {}", estimate.id),
        key: Some(format!("tare/{}", origin(file, estimate))),
        kind: Kind::B,
        quantity: format!("coefficients of {}", estimate.id),
        shared: "campaign",
        directions: directions(&|j, k| if j == k { 1.0 } else { 0.0 }, columns.len()),
        covariance: scatter.matrix.clone(),
        dof: scatter.dof.iter().flatten().copied().fold(f64::INFINITY, f64::min),
        limits: None,
        is_of_each_row: false,
    };
    let others = estimate.errors.iter().map(|(key, error)| SharedError {
        name: format!("tare {}: {}", estimate.id, error.name),
        key: Some(if key.starts_with(OWN) { format!("tare/{}/{key}", origin(file, estimate)) } else { key.clone() }),
        kind: Kind::B,
        quantity: error.quantity.clone(),
        shared: "campaign",
        directions: directions(&|j, k| error.sensitivity[j][k], error.covariance.len()),
        covariance: error.covariance.clone(),
        dof: error.dof.unwrap_or(f64::INFINITY),
        limits: error.limits,
        is_of_each_row: false,
    });
    std::iter::once(own).chain(others).collect()
}

/// What an estimate came from: the same numbers made of the same files are one tare, wherever their record lies.
fn origin(file: &EstimateFile, estimate: &Estimate) -> String {
    let mut of: Vec<String> = data_of(file, estimate).map(|data| data.sha256.clone()).collect();
    if of.is_empty() {
        // An old record does not say which of its files an estimate came from.
        of = file.data.values().map(|data| data.sha256.clone()).collect();
    }
    of.sort_unstable();
    of.push(estimate.id.clone());
    of.extend(estimate.coefficients.values().map(|c| format!("{:?}", c.value)));
    short_key(of.join(" ").as_bytes())
}
