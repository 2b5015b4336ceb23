//! Coefficients that two estimates share, and E_n of two numbers.

use froude_records::comparison::CoefficientComparison;
use froude_records::estimate::{Coefficient, Estimate, Status, beside};
use froude_records::units::parse_unit;

use crate::common::{Common, Number};
use crate::compare::named::Named;

/// The text in place of E_n where two estimates come from the same observations.
pub const SAME_DATA: &str = "same data: not independent, E_n not meaningful";
/// The text in place of χ² there.
pub(super) const SAME_DATA_JOINTLY: &str = "same data: not independent, χ² not meaningful";

/// E_n and an empty note, or none and why.
pub(super) fn noted(e_n: Result<f64, String>) -> (Option<f64>, String) {
    match e_n {
        Ok(e_n) => (Some(e_n), String::new()),
        Err(why) => (None, why),
    }
}

pub(super) fn coefficient_rows(
    [a, b]: [&Named<'_>; 2],
    [first, second]: [&str; 2],
    common: &Common<'_>,
    is_same_data: bool,
) -> Vec<CoefficientComparison> {
    a.estimate
        .coefficients
        .iter()
        .filter_map(|(name, x)| b.estimate.coefficients.get(name).map(|y| (name, x, y)))
        .map(|(name, x, y)| {
            let sides = [a, b].map(|n| {
                let own = &n.estimate.coefficients[name];
                // One range is of one coefficient.
                let is_same = |e: &&Estimate| {
                    own.range_95.is_some() && e.coefficients.get(name).is_some_and(|c| c.range_95 == own.range_95)
                };
                let others = beside(&n.record.estimates, n.estimate).into_iter().filter(is_same);
                let others: Vec<Number<'_>> = others.map(|e| Number::of_coefficient(e, name)).collect();
                Number::of_coefficient(n.estimate, name).around(&others)
            });
            // Records are in SI: units of one dimension are one unit, however it is written.
            let [of_x, of_y] = [x, y].map(|c| parse_unit(&c.unit).ok().map(|unit| unit.dimension));
            let e_n = if x.unit == y.unit || (of_x.is_some() && of_x == of_y) {
                e_n([&sides[0], &sides[1]], common, [first, second], is_same_data).and_then(|e_n| {
                    not_free(x, first)
                        .or_else(|| not_free(y, second))
                        .or_else(|| held_in_both(x, y))
                        .map_or(Ok(e_n), Err)
                })
            } else {
                Err(format!("units differ: {} and {}", x.unit, y.unit))
            };
            let (e_n, note) = noted(e_n);
            CoefficientComparison {
                model: a.estimate.law.name.clone(),
                coefficient: name.clone(),
                label: x.label.clone().or_else(|| y.label.clone()),
                unit: x.unit.clone(),
                first: sides[0].stated.of(first),
                second: sides[1].stated.of(second),
                e_n,
                note,
            }
        })
        .collect()
}

/// Why two coefficients that somebody knew beforehand say nothing of each other.
fn held_in_both(x: &Coefficient, y: &Coefficient) -> Option<String> {
    [x, y].iter().all(|c| c.status == Status::Fixed).then(|| "held at a value from elsewhere in both".to_owned())
}

/// Why a coefficient is no measurement that stands by itself: a bound, whose uncertainty is that of the fit without it, or
/// a fit to a published value, which may be the other side.
pub(super) fn not_free(c: &Coefficient, id: &str) -> Option<String> {
    match c.status {
        Status::AtBound => Some(format!("at its bound in {id}")),
        Status::Prior => Some(format!("rests on a published value in {id}")),
        _ => None,
    }
}

/// Why a number has no interval, and with it no E_n.
pub(super) fn no_interval(id: &str) -> String {
    format!("{id} gives no interval, or one of the laws that its data do not contradict gives none")
}

/// E_n of two numbers, or why there is none.
pub(super) fn e_n(
    sides: [&Number<'_>; 2],
    common: &Common<'_>,
    ids: [&str; 2],
    is_same_data: bool,
) -> Result<f64, String> {
    let [Some(a), Some(b)] = sides.map(|side| side.stated.value) else { return Err("undetermined".to_owned()) };
    let without: Vec<&str> =
        sides.into_iter().zip(ids).filter(|(side, _)| side.stated.standard.is_none()).map(|(_, id)| id).collect();
    if !without.is_empty() {
        return Err(format!("no uncertainty stated by {}", without.join(" and ")));
    }
    if is_same_data {
        return Err(SAME_DATA.to_owned());
    }
    if let Some((_, id)) = sides.into_iter().zip(ids).find(|(side, _)| side.stated.is_refused) {
        return Err(no_interval(id));
    }
    let u = common.expanded_difference(sides, a - b);
    if u > 0.0 { Ok((a - b) / u) } else { Err("both uncertainties are zero".to_owned()) }
}
