//! The parts of a record that follow from a joint fit alone.

use froude_fit::Status as Found;
use froude_fit::faer::Mat;
use froude_records::campaign::Campaign;
use froude_records::estimate::{Coefficient, ErrorKind, SharedError, Status, TypeA};
use froude_records::number;
use indexmap::IndexMap;

use super::{DeclaredError, JointFit, Unknown};

/// The coefficients; `is_nuisance` says which of them nobody asked for.
pub(crate) fn coefficients(fit: &JointFit, is_nuisance: &dyn Fn(&str) -> bool) -> IndexMap<String, Coefficient> {
    let one = |u: &Unknown| {
        let coefficient = Coefficient {
            label: None,
            value: u.value,
            unit: u.unit.clone(),
            status: status(u.status),
            nuisance: is_nuisance(&u.name),
            standard_uncertainty: u.combined.map(|c| c.standard),
            type_a: u.combined.map(|c| c.type_a),
            type_b: u.combined.map(|c| c.type_b),
            interval_95: u.value.zip(u.combined).map(|(value, c)| c.interval(value)),
            effective_dof: u.combined.map(|c| c.dof).filter(|d| d.is_finite()),
            unconstrained: None,
            range_95: None,
        };
        (u.name.clone(), coefficient)
    };
    fit.unknowns.iter().map(one).collect()
}

/// Their scatter.
pub(crate) fn type_a(fit: &JointFit) -> TypeA {
    let (scatter, n) = (&fit.parts[0], fit.unknowns.len());
    let scaled = if fit.is_scaled { " over its mean at equal errors" } else { "" };
    let rows = |m: &Mat<f64>| (0..n).map(|i| (0..n).map(|j| m[(i, j)]).collect()).collect();
    TypeA {
        names: fit.unknowns.iter().map(|u| u.name.clone()).collect(),
        matrix: rows(&scatter.covariance),
        dof: scatter.dof.iter().map(|d| Some(*d).filter(|d| d.is_finite())).collect(),
        kind: format!(
            "CR3{scaled}, {} {}s{}",
            fit.clusters,
            fit.by,
            if fit.by == "cycle" && fit.has_runs { ", and variation of the drag from run to run" } else { "" }
        ),
    }
}

fn status(found: Found) -> Status {
    match found {
        Found::Free => Status::Free,
        Found::AtBound => Status::AtBound,
        Found::Fixed => Status::Fixed,
        Found::Excluded => Status::Excluded,
        Found::Prior => Status::Prior,
        Found::Undetermined => Status::Undetermined,
        Found::BoundContradicted => Status::BoundContradicted,
    }
}

/// Declared errors by key: sources of the campaign that declare them alike have them in common.
pub(crate) fn errors(fit: &JointFit, campaign: &Campaign) -> IndexMap<String, SharedError> {
    let one = |error: &DeclaredError| {
        let key = format!("{}/{} {:e}", campaign.key, error.name, error.standard);
        let shared = SharedError {
            name: error.name.clone(),
            quantity: error.name.clone(),
            kind: ErrorKind::B,
            covariance: vec![vec![error.standard * error.standard]],
            dof: Some(error.dof).filter(|d| d.is_finite()),
            limits: None,
            sensitivity: error.sensitivity.iter().map(|s| vec![*s]).collect(),
        };
        (key, shared)
    };
    fit.errors.iter().map(one).collect()
}

/// The budget of each coefficient, in sentences, and what the samples are worth.
pub(crate) fn notes(fit: &JointFit, unit: &str) -> Vec<String> {
    let mut out = vec![format!(
        "{} samples are worth {} (residuals correlated over {} samples); residual {} {unit}",
        number::count(fit.samples),
        number::count(fit.effective.round() as usize),
        number::significant(fit.samples as f64 / fit.effective, 2),
        number::significant(fit.sigma, 2)
    )];
    out.extend(fit.parts.iter().filter(|part| (0..fit.unknowns.len()).any(|j| part.standard(j) > 0.0)).map(|part| {
        let each =
            fit.unknowns.iter().enumerate().map(|(j, u)| format!("{} {:.2e} {}", u.name, part.standard(j), u.unit));
        format!("{} (type {}): {}", part.name, part.kind, each.collect::<Vec<_>>().join(", "))
    }));
    out
}
