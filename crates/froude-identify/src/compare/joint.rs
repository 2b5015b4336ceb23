//! χ² of whole coefficient vectors.

use faer::Mat;
use faer::linalg::solvers::Solve;
use froude_fit::distribution::f_upper;
use froude_records::comparison::JointComparison;
use froude_records::estimate::{Estimate, Status, beside};

use super::coefficients::{SAME_DATA_JOINTLY, no_interval, not_free};
use crate::common::Common;
use crate::compare::named::Named;

/// χ² of two estimates of one law, or of the law that agrees best among those that the data of both sources do not contradict.
pub(super) fn joint(
    [a, b]: [&Named<'_>; 2],
    ids: [&str; 2],
    common: &Common<'_>,
    is_same_data: bool,
) -> JointComparison {
    let mut out = of_law([a, b], ids, common, is_same_data);
    for first in beside(&a.record.estimates, a.estimate) {
        let others = beside(&b.record.estimates, b.estimate);
        let is_alike = |e: &&Estimate| e.law.name == first.law.name;
        // χ² of fewer loads is another question.
        let gives_all = a.estimate.law.outputs.keys().all(|load| first.law.outputs.contains_key(load));
        let Some(second) = others.into_iter().find(is_alike).filter(|_| gives_all) else { continue };
        let (of_a, of_b) = (Named { estimate: first, ..*a }, Named { estimate: second, ..*b });
        let other = of_law([&of_a, &of_b], ids, &Common::of(first, second), is_same_data);
        if other.p.zip(out.p).is_some_and(|(other, own)| other > own) {
            let note = format!("by {}, the law that agrees best of those that the data do not contradict", other.model);
            out = JointComparison { model: out.model, note, ..other };
        }
    }
    out
}

/// χ² = dᵀC⁻¹d over the coefficients that both estimate, C = C_a + C_b less what common errors make of the covariance between them.
fn of_law(
    [a, b]: [&Named<'_>; 2],
    [first, second]: [&str; 2],
    common: &Common<'_>,
    is_same_data: bool,
) -> JointComparison {
    let result = (|| {
        let (ca, cb) = (a.estimate.covariance(), b.estimate.covariance());
        let (Some(ca), Some(cb)) = (&ca, &cb) else {
            let without: Vec<&str> =
                [(&ca, first), (&cb, second)].into_iter().filter(|(c, _)| c.is_none()).map(|(_, id)| id).collect();
            return Err(format!("no covariance matrix stated by {}", without.join(" and ")));
        };
        if is_same_data {
            return Err(SAME_DATA_JOINTLY.to_owned());
        }
        // What is held at a value from elsewhere on both sides is no estimate that agrees or not.
        let is_held = |of: &Named<'_>, name: &String| {
            of.estimate.coefficients.get(name).is_some_and(|c| c.status == Status::Fixed)
        };
        let is_of_both = |name: &&String| cb.names.contains(name) && !(is_held(a, name) && is_held(b, name));
        let names: Vec<&String> = ca.names.iter().filter(is_of_both).collect();
        for (n, id) in [(a, first), (b, second)] {
            let mut constrained = names.iter().filter_map(|name| n.estimate.coefficients.get(*name));
            if let Some(why) = constrained.find_map(|c| not_free(c, id)) {
                return Err(format!("a coefficient is {why}: χ² is for estimates that are free"));
            }
            if n.estimate.without_interval().iter().any(|refused| names.iter().any(|name| name == refused)) {
                return Err(no_interval(id));
            }
        }
        if names.is_empty() {
            return Err("no coefficient is estimated by both".to_owned());
        }
        let value = |e: &Estimate, n: &str| e.coefficients.get(n).and_then(|c| c.value).unwrap_or(f64::NAN);
        let at = |c: &froude_records::estimate::Covariance, p: &str, q: &str| {
            let i = c.names.iter().position(|n| n == p);
            let j = c.names.iter().position(|n| n == q);
            i.zip(j).and_then(|(i, j)| c.matrix.get(i).and_then(|r| r.get(j)).copied()).unwrap_or(f64::NAN)
        };
        let m = names.len();
        let cross = |p: &str, q: &str| common.covariance([p, q]) + common.covariance([q, p]);
        let sum = Mat::from_fn(m, m, |i, j| {
            at(ca, names[i], names[j]) + at(cb, names[i], names[j]) - cross(names[i], names[j])
        });
        // Scaled to unit diagonal: the coefficients' sizes differ by orders of magnitude.
        let scale: Vec<f64> = (0..m).map(|i| sum[(i, i)].sqrt()).collect();
        let correlation = Mat::from_fn(m, m, |i, j| sum[(i, j)] / (scale[i] * scale[j]));
        let d = Mat::from_fn(m, 1, |i, _| (value(a.estimate, names[i]) - value(b.estimate, names[i])) / scale[i]);
        let solved = correlation
            .llt(faer::Side::Lower)
            .map_err(|_| "the joint covariance is not positive definite".to_owned())?
            .solve(&d);
        let chi2: f64 = (0..m).map(|i| d[(i, 0)] * solved[(i, 0)]).sum();
        if !chi2.is_finite() {
            return Err("a covariance is not finite".to_owned());
        }
        let dof = if common.is_empty() {
            least_dof([a, b], &names)
        } else {
            common.least_dof([a.estimate, b.estimate], &names)
        };
        Ok((chi2, m, probability(chi2, m, dof)))
    })();
    let (model, first, second) = (a.estimate.law.name.clone(), first.to_owned(), second.to_owned());
    match result {
        Ok((chi_squared, dof, p)) => JointComparison {
            chi_squared: Some(chi_squared),
            dof: Some(dof),
            p: Some(p),
            note: String::new(),
            model,
            first,
            second,
        },
        Err(note) => JointComparison { note, model, first, second, ..JointComparison::default() },
    }
}

/// Fewest degrees of freedom that one of the coefficients has; infinite where none are stated.
fn least_dof(sides: [&Named<'_>; 2], names: &[&String]) -> f64 {
    sides
        .iter()
        .flat_map(|n| names.iter().filter_map(|name| n.estimate.coefficients.get(*name)?.effective_dof))
        .fold(f64::INFINITY, f64::min)
}

/// Probability of a χ² as large, for covariances known with ν degrees of freedom: χ²/m is taken as F(m, ν), as Hotelling's
/// T² is but for its factor (ν − m + 1)/ν.
fn probability(chi2: f64, m: usize, dof: f64) -> f64 {
    f_upper(chi2 / m as f64, m as f64, dof)
}
