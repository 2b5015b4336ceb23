//! What two estimates say that cannot both be so, or that is not tied to one axis, one density, one constant.

use froude_records::estimate::{CHAIN, Estimate, Status};
use froude_records::finding::{Finding, Severity};

use super::independence::is_one_source;
use crate::compare::named::Named;

/// Two records of the same source and model that say different things, with what looks like a slip.
pub(super) fn contradiction(a: &Named<'_>, b: &Named<'_>) -> Option<Finding> {
    // What one of them holds and the other fits is another fit; published values are held in both.
    let is_held = |name: &str| {
        let of = |n: &Named<'_>| n.estimate.coefficients.get(name).is_some_and(|c| c.status == Status::Fixed);
        of(a) != of(b)
    };
    let value =
        |n: &Named<'_>, name: &str| n.estimate.coefficients.get(name).filter(|_| !is_held(name)).and_then(|c| c.value);
    let differing: Vec<(&String, f64, f64)> = a
        .estimate
        .coefficients
        .keys()
        .filter_map(|name| Some((name, value(a, name)?, value(b, name)?)))
        .filter(|(name, x, y)| {
            // What rounding leaves of a number that is nearly zero is small against its uncertainty.
            let standard = |n: &Named<'_>| n.estimate.coefficients[*name].standard_uncertainty.unwrap_or(0.0);
            let rounding = (1e-9 * x.abs().max(y.abs())).max(1e-3 * standard(a).min(standard(b)));
            (x - y).abs() > rounding
        })
        .collect();
    if differing.is_empty() {
        return None;
    }
    let mut slips = Vec::new();
    for (i, (p, p_a, p_b)) in differing.iter().enumerate() {
        for (q, q_a, q_b) in &differing[i + 1..] {
            if p_a == q_b && q_a == p_b {
                slips.push(format!("the values of {p} and {q} are exchanged ({p_a} and {q_a})"));
            }
        }
        if digits_exchanged(*p_a, *p_b) {
            slips.push(format!("{p}: {p_a} and {p_b} differ by two exchanged digits"));
        }
    }
    let list: Vec<String> = differing.iter().map(|(n, x, y)| format!("{n} {x} against {y}")).collect();
    let slips = if slips.is_empty() { String::new() } else { format!("; {}", slips.join("; ")) };
    Some(
        Finding::new(
            Severity::Error,
            "contradiction",
            format!(
                "{} states different values for the same fit in {} and {}: {}{slips}",
                a.estimate.id,
                a.file,
                b.file,
                list.join(", ")
            ),
        )
        .of_source(&a.estimate.source),
    )
}

/// True where the decimal digits of two numbers differ by one exchange of two digits.
fn digits_exchanged(a: f64, b: f64) -> bool {
    let (x, y) = (format!("{a}"), format!("{b}"));
    let (x, y) = (x.as_bytes(), y.as_bytes());
    if x.len() != y.len() {
        return false;
    }
    let wrong: Vec<usize> = (0..x.len()).filter(|&i| x[i] != y[i]).collect();
    matches!(wrong.as_slice(), [i, j] if x[*i] == y[*j] && x[*j] == y[*i])
}

/// Relative difference of density that a dimensional coefficient shows: a tenth of fresh against sea water.
const DENSITY_MATTERS: f64 = 0.002;

/// Densities of two estimates that differ, where the coefficients depend on them.
pub(super) fn density_differs(a: &Estimate, b: &Estimate) -> Option<Finding> {
    let (x, y) = (a.density()?, b.density()?);
    let has_dimension = |e: &Estimate| e.coefficients.values().any(|c| c.unit.contains("kg") || c.unit.contains('N'));
    ((x.value - y.value).abs() > DENSITY_MATTERS * x.value && (has_dimension(a) || has_dimension(b))).then(|| {
        Finding::new(
            Severity::Warning,
            "density-differs",
            format!(
                "{} was measured in water of {} {}, {} in {} {}: coefficients with kg or N in their unit, and the forces that they give, depend on \
                 the density; scale one of them before comparing",
                a.id, x.value, x.unit, b.id, y.value, y.unit
            ),
        )
    })
}

/// Forces of a carriage, which has no axis of the body, beside those in body axes.
pub(super) fn axes_not_tied(a: &Estimate, b: &Estimate) -> Option<Finding> {
    let (chain, body) = match [a, b].map(|e| e.frame.name == CHAIN) {
        [true, false] => (a, b),
        [false, true] => (b, a),
        _ => return None,
    };
    Some(Finding::new(
        Severity::Warning,
        "axes-not-tied",
        format!(
            "{} is along the chain of its carriage, {} in body axes: their f_x are compared as if the body had been towed along its x \
             axis; if it was towed across it, they are two different forces. Declare it by travel = \"x\" (or \"y\") in [body] of the carriage's campaign; of runs that are driven already, in \
             a campaign that `froude carriage drag --campaign` names",
            chain.id, body.id
        ),
    ))
}

/// Half of the interval of a measure of the body: the volume of a mesh has one.
fn half_width(of: &Named<'_>, key: &str) -> f64 {
    let interval = of.estimate.derived.get(key).and_then(|derived| derived.interval_95);
    interval.map_or(0.0, |[low, high]| 0.5 * (high - low))
}

/// Geometry or density that differ between estimates of one model: coefficients then mean different things.
pub(super) fn differing_constants(all: &[Named<'_>]) -> Vec<Finding> {
    let mut out: Vec<Finding> = Vec::new();
    for (i, a) in all.iter().enumerate() {
        for b in &all[i + 1..] {
            if a.estimate.law.name != b.estimate.law.name || is_one_source(a, b) {
                continue;
            }
            out.extend(density_differs(a.estimate, b.estimate));
            for (key, x) in a.estimate.refers_to.iter().filter(|(key, _)| *key != "density") {
                if let Some(y) = b.estimate.refers_to.get(key)
                    && (x.value - y.value).abs() > 1e-9 * x.value.abs() + half_width(a, key) + half_width(b, key)
                {
                    out.push(Finding::new(
                        Severity::Warning,
                        "geometry-differs",
                        format!(
                            "{} and {} refer to different bodies ({key} {} {} and {} {}): compare their forces, not their coefficients",
                            a.estimate.id, b.estimate.id, x.value, x.unit, y.value, y.unit
                        ),
                    ));
                }
            }
        }
    }
    out
}
