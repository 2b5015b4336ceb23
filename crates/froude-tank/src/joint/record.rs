//! The parts of a record that follow from a joint fit alone.

use froude_fit::Status as Found;
use froude_fit::budget::{Combined, Part};
use froude_fit::faer::Mat;
use froude_records::campaign::Campaign;
use froude_records::estimate::{Coefficient, ErrorKind, SharedError, Status, TypeA};
use froude_records::number;
use indexmap::IndexMap;

use super::{DeclaredError, JointFit, Unknown};
use crate::channel::Channel;
use crate::motion::Cycles;

/// The coefficients; `is_nuisance` says which of them nobody asked for.
pub(crate) fn coefficients(fit: &JointFit, is_nuisance: &dyn Fn(&str) -> bool) -> IndexMap<String, Coefficient> {
    let one = |u: &Unknown| {
        let nuisance = is_nuisance(&u.name);
        (u.name.clone(), Coefficient { nuisance, ..coefficient(u.value, &u.unit, status(u.status), u.combined) })
    };
    fit.unknowns.iter().map(one).collect()
}

/// A coefficient as a record has it.
pub(crate) fn coefficient(value: Option<f64>, unit: &str, status: Status, combined: Option<Combined>) -> Coefficient {
    Coefficient {
        label: None,
        value,
        unit: unit.to_owned(),
        status,
        nuisance: false,
        standard_uncertainty: combined.map(|c| c.standard),
        type_a: combined.map(|c| c.type_a),
        type_b: combined.map(|c| c.type_b),
        interval_95: value.zip(combined).map(|(value, c)| c.interval(value)),
        effective_dof: combined.map(|c| c.dof).filter(|d| d.is_finite()),
        unconstrained: None,
        range_95: None,
    }
}

/// A declared error of one quantity as a record has it.
pub(crate) fn shared_error(name: &str, standard: f64, dof: f64, sensitivity: &[f64]) -> SharedError {
    SharedError {
        name: name.to_owned(),
        quantity: name.to_owned(),
        kind: ErrorKind::B,
        covariance: vec![vec![standard * standard]],
        dof: Some(dof).filter(|d| d.is_finite()),
        limits: None,
        sensitivity: sensitivity.iter().map(|s| vec![*s]).collect(),
    }
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
        (key, shared_error(&error.name, error.standard, error.dof, &error.sensitivity))
    };
    fit.errors.iter().map(one).collect()
}

/// The budget of each coefficient, in sentences, and what the samples are worth.
pub(crate) fn notes(fit: &JointFit, loads: &[Channel]) -> Vec<String> {
    let left = |(load, sigma): (&Channel, &f64)| {
        let of = if loads.len() == 1 { String::new() } else { format!(" of the {}", load.name) };
        format!("residual{of} {} {}", number::significant(*sigma, 2), load.unit)
    };
    let left: Vec<String> = loads.iter().zip(&fit.sigma).map(left).collect();
    let mut out = vec![format!(
        "{} samples are worth {} (residuals correlated over {} samples); {}",
        number::count(fit.samples),
        number::count(fit.effective.round() as usize),
        number::significant(fit.samples as f64 / fit.effective, 2),
        left.join(", ")
    )];
    let named: Vec<(&str, &str)> = fit.unknowns.iter().map(|u| (u.name.as_str(), u.unit.as_str())).collect();
    out.extend(by_part(&fit.parts, &named, 2));
    out
}

/// The standard uncertainties of coefficients, with their units, by error.
pub(crate) fn by_part(parts: &[Part], named: &[(&str, &str)], digits: usize) -> Vec<String> {
    let is_there = |part: &&Part| (0..named.len()).any(|j| part.standard(j) > 0.0);
    let one = |part: &Part| {
        let each = named.iter().enumerate();
        let each = each.map(|(j, (name, unit))| format!("{name} {:.digits$e} {unit}", part.standard(j)));
        format!("{} (type {}): {}", part.name, part.kind, each.collect::<Vec<_>>().join(", "))
    };
    parts.iter().filter(is_there).map(one).collect()
}

/// What a joint fit did; `held` is how the rig stands.
pub(crate) fn words(
    fit: &JointFit,
    cycles: Cycles,
    harmonics: usize,
    (motion, loads): (&Channel, &[Channel]),
    held: &str,
) -> String {
    let loads: Vec<&str> = loads.iter().map(|load| load.name).collect();
    let used = cycles.used.map_or_else(|| "all that follow".to_owned(), |n| n.to_string());
    format!(
        "cycles of each run: {} of start-up left out, {used} used; {} by {harmonics} harmonics of a fitted frequency; motion taken {} ms before the stamp of the {}; zero of each run \
         fitted; {held}",
        cycles.skip,
        motion.name,
        number::plain(1e3 * fit.delay_s, 4),
        loads.join(" and ")
    )
}
