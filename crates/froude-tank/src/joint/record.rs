//! The parts of a record that follow from a joint fit alone.

use froude_fit::budget::{Kind, Part};
use froude_fit::propagate::effective_dof;
use froude_identify::record::{coefficient, status};
use froude_records::campaign::{Campaign, Source};
use froude_records::estimate::{
    Coefficient, Estimate, Frame, Measured, MethodUsed, ReferencePoint, SharedError, TypeA,
};
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

/// The scatter of `names`, the first coefficients of a budget, with the degrees of freedom of its parts together.
pub(crate) fn type_a(names: &[&str], budget: &[Part], kind: String) -> TypeA {
    let scatter: Vec<&Part> = budget.iter().filter(|part| part.kind == Kind::A).collect();
    let sum = |i: usize, j: usize| scatter.iter().map(|part| part.covariance[(i, j)]).sum::<f64>();
    let dof = |j: usize| match scatter[..] {
        [only] => only.dof[j],
        _ => effective_dof(&scatter.iter().map(|part| (part.covariance[(j, j)], part.dof[j])).collect::<Vec<_>>()),
    };
    let all = || 0..names.len();
    let matrix = all().map(|i| all().map(|j| sum(i, j)).collect()).collect();
    let dof: Vec<f64> = all().map(dof).collect();
    TypeA::of(names.iter().map(|name| (*name).to_owned()).collect(), matrix, &dof, kind)
}

/// What the scatter of a joint fit comes from, in words.
pub(crate) fn scatter_of(fit: &JointFit) -> String {
    let scaled = if fit.is_scaled { " over its mean at equal errors" } else { "" };
    let runs = if fit.by == "cycle" && fit.has_runs { ", and variation of the drag from run to run" } else { "" };
    format!("CR3{scaled}, {} {}s{runs}", fit.clusters, fit.by)
}

/// What all estimates of a source have in common; `of` is the end of the id and the name of the method, `words` what it did.
pub(crate) fn about((campaign, source): (&Campaign, &Source), of: [&str; 2], words: String) -> Estimate {
    let [id, method] = of;
    let density = campaign.fluid.density_kg_m3.map(|value| Measured::of(value, "kg/m^3"));
    Estimate {
        id: format!("{}/{id}", source.name),
        source: source.name.clone(),
        kind: source.kind.name().to_owned(),
        method: MethodUsed::of(method, words),
        frame: Frame::body(),
        point: reference_point(campaign),
        refers_to: density.map(|density| ("density".to_owned(), density)).into_iter().collect(),
        ..Estimate::default()
    }
}

/// Where on the body the campaign says that loads act.
pub(crate) fn reference_point(campaign: &Campaign) -> ReferencePoint {
    ReferencePoint::stated(campaign.body.as_ref().and_then(|body| body.reference_point.clone()))
}

/// Declared errors by key: sources of the campaign that declare them alike have them in common.
pub(crate) fn errors(errors: &[DeclaredError], campaign: &Campaign) -> IndexMap<String, SharedError> {
    let one = |error: &DeclaredError| {
        let value = error.value.map(|value| format!(" {value:e}")).unwrap_or_default();
        let key = format!("{}/{}{value} {:e}", campaign.key, error.name, error.standard);
        let slopes = error.sensitivity.iter().copied();
        (key, SharedError::declared([&error.name, &error.name], error.standard, error.dof, slopes))
    };
    errors.iter().map(one).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Two springs that are known to the same 0.5 N/m are two errors; two sources with one spring have it in common.
    #[test]
    fn errors_of_different_values_have_keys_of_their_own() {
        let campaign = Campaign { key: "tests".to_owned(), ..Campaign::default() };
        let spring = |value: f64| DeclaredError {
            name: "stiffness".to_owned(),
            standard: 0.5,
            dof: f64::INFINITY,
            value: Some(value),
            sensitivity: vec![1.0],
        };
        let keys = |all: &[f64]| errors(&all.iter().map(|value| spring(*value)).collect::<Vec<_>>(), &campaign).len();
        assert_eq!((keys(&[180.0, 90.0]), keys(&[180.0, 180.0])), (2, 1));
    }
}
