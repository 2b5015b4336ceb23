//! Which force law is recommended, and which others the data do not contradict.
//!
//! Recommended is the simplest law that the data do not contradict: the one with the fewest coefficients, of equals that with the smallest AICc. Candidates are the laws whose
//! coefficients are all determined.
//!
//! A law is contradicted where the terms of another law, added to it, are not zero ([`added_terms`]): the smallest p, times the number of tests, is below
//! 0.5 %. Loads that the law gives and loads that it lacks are counted separately. A true law is contradicted in at most 0.5 % of tables, whatever the others are.
//!
//! So the true law, where it is among the candidates, is among those that are not contradicted: the envelope of their bands holds the load, and the envelope of their intervals of a
//! coefficient (its range) the coefficient, in no less than 94.5 % of tables, whichever of them is recommended. A law whose bounds the data contradict (1 % over its bounds) is ruled out too:
//! with bounds it is 93.5 %. The interval of one law holds if that law is true, and depends on no other.
//!
//! Laws are compared load by load. One that says nothing of a load says that it is zero: where that is contradicted it is not recommended, and still has its part in the envelopes of the loads that
//! it gives.
//!
//! # Source
//!
//! Berk, Brown, Buja, Zhang & Zhao (2013), Valid post-selection inference, Ann. Stat. 41, 802: why the intervals of a law that the same data chose do not hold.

mod added;
mod scores;

use froude_fit as fit;
use froude_records::comparison::AddedTerms;
use froude_records::number::p_equation;
use froude_records::text::counted;

use crate::dataset::Dataset;
use crate::law::Kind;
use crate::regression::ModelFit;

pub use added::added_terms;
pub(crate) use added::widened;
pub use scores::{BlockScore, Score, leave_one_out, range_block};

/// Chance of contradicting a law that is true, over all laws and loads that it is compared with.
const CONTRADICTED_BELOW: f64 = 0.005;
/// What the selection says.
#[derive(Debug, Clone, PartialEq)]
pub struct Recommendation {
    /// Index of the recommended law.
    pub index: usize,
    /// Indices of all laws that the data do not contradict in the loads that they give; the recommended one is among them unless they contradict each.
    pub not_contradicted: Vec<usize>,
    /// Why, with numbers.
    pub reason: String,
}

/// AICc of a fit in the units of its loads; a fit in logarithms is carried over by its Jacobian.
///
/// With weights w the likelihood has a factor ∏√w. Fits of loads and of their logarithms weigh the same `std_*` column
/// differently, and would not be comparable without it.
///
/// n ln(RSS/n) + 2K + 2K(K+1)/(n − K − 1) per load, summed over the loads; K counts σ. The Jacobian adds 2 Σ ln|F|, F in N or N m. Only differences
/// between models of the same rows have a meaning; below 2 they are no evidence. `None` for an exact fit, or n ≤ K + 1.
///
/// # Source
///
/// Hurvich & Tsai (1989), Biometrika 76; Burnham & Anderson (2002), section 2.6.
#[must_use]
pub fn aicc(model: &ModelFit, data: &Dataset) -> Option<f64> {
    model.law.responses.iter().map(|load| aicc_of(model, data, load)).sum()
}

/// The part of one load in [`aicc`]; `None` also where the model does not explain it.
#[must_use]
pub fn aicc_of(model: &ModelFit, data: &Dataset, load: &str) -> Option<f64> {
    let r = model.law.responses.iter().position(|response| response == load)?;
    let n = data.rows;
    let of_weights: f64 =
        model.problem.weight.iter().flat_map(|w| &w[r * n..(r + 1) * n]).filter(|w| **w > 0.0).map(|w| w.ln()).sum();
    let base = model.fit.components[r].aicc? - of_weights;
    if !model.law.in_logarithms() {
        return Some(base);
    }
    let loads = data.values(load)?;
    let jacobian: f64 = (0..n).filter(|&i| data.observes(load, i)).map(|i| loads[i].abs().ln()).sum();
    Some(base + 2.0 * jacobian)
}

/// The simplest law that the data do not contradict.
///
/// `tests` are those of [`added_terms`]. `None` without a law.
#[must_use]
pub fn recommend(models: &[ModelFit], data: &Dataset, tests: &[AddedTerms]) -> Option<Recommendation> {
    models.first()?;
    if let [only] = models {
        let reason = format!("{} is the only law fitted", only.law.name);
        return Some(Recommendation { index: 0, not_contradicted: vec![0], reason });
    }
    let is_determined = |i: &usize| models[*i].fit.coefficients.iter().all(|c| c.status != fit::Status::Undetermined);
    let (candidates, undetermined): (Vec<usize>, Vec<usize>) = (0..models.len()).partition(is_determined);
    let aicc: Vec<Option<f64>> = models.iter().map(|m| aicc(m, data)).collect();
    let loads = |i: usize| models[i].law.responses.len();
    let is_held = |c: &&fit::FitCoefficient| matches!(c.status, fit::Status::Fixed | fit::Status::Excluded);
    let size = |i: usize| {
        let of_law = &models[i].fit.coefficients[..models[i].law.coefficients.len()];
        of_law.len() - of_law.iter().filter(is_held).count()
    };
    // The tests ignore bounds, so a law whose bounds the data contradict is ruled out here.
    let is_out_of_bounds = |i: usize| (0..models[i].specs.len()).any(|j| models[i].contradicted_bound(j).is_some());
    let of_aicc = |i: usize| aicc[i].unwrap_or(f64::INFINITY);
    let most = candidates.iter().map(|i| loads(*i)).max().unwrap_or(0);
    let whole: Vec<usize> = candidates.iter().copied().filter(|i| loads(*i) == most).collect();
    let gives = |i: usize, t: &AddedTerms| models[i].law.responses.contains(&t.component);
    let against: Vec<[Option<&AddedTerms>; 2]> = (0..models.len())
        .map(|i| {
            let own = |t: &&AddedTerms| t.law == models[i].law.name;
            [true, false].map(|given| contradiction(tests.iter().filter(own).filter(|t| gives(i, t) == given)))
        })
        .collect();
    let left: Vec<usize> =
        candidates.iter().copied().filter(|i| against[*i][0].is_none() && !is_out_of_bounds(*i)).collect();
    let key = |i: usize| (size(i), std::cmp::Reverse(loads(i)), of_aicc(i));
    let by_key = |a: &usize, b: &usize| key(*a).partial_cmp(&key(*b)).unwrap_or(std::cmp::Ordering::Equal);
    // A built-in power law has one load, and claims nothing about the others.
    let says_zero = |i: usize| loads(i) < most && matches!(models[i].law.kind, Kind::PowerLaw { .. });
    let right: Vec<usize> = left.iter().copied().filter(|i| against[*i][1].is_none() && !says_zero(*i)).collect();
    let simplest = right.iter().copied().min_by(by_key);
    let best = || whole.iter().copied().min_by(|a, b| of_aicc(*a).total_cmp(&of_aicc(*b)));
    let chosen = simplest.or_else(best).unwrap_or(0);
    let name = &models[chosen].law.name;
    let named = |of: &[usize]| of.iter().map(|i| models[*i].law.name.as_str()).collect::<Vec<_>>().join(", ");
    let mut reason = if candidates.is_empty() {
        format!("the data determine none of the laws; {name} is the first of them")
    } else if simplest.is_none() {
        let what = if whole.len() < candidates.len() { " that gives all loads" } else { "" };
        format!("the data contradict every law compared{what}; {name} has the smallest AICc")
    } else {
        let is_equal = |i: &&usize| (size(**i), loads(**i)) == (size(chosen), loads(chosen));
        let equals = right.iter().filter(is_equal).count();
        let of = counted(size(chosen), "coefficient", "coefficients");
        let of_equals = format!(" (smallest AICc of those with {of})");
        let of_equals = if equals > 1 { of_equals.as_str() } else { "" };
        format!("{name} is the simplest law that the data do not contradict{of_equals}")
    };
    let (others, partly): (Vec<usize>, Vec<usize>) =
        left.iter().copied().filter(|i| *i != chosen).partition(|i| right.contains(i));
    if !others.is_empty() {
        reason += &format!("; also not contradicted: {}", named(&others));
    }
    if !partly.is_empty() {
        reason += &format!("; not contradicted in the loads that they give: {}", named(&partly));
    }
    let contradicted: Vec<String> = (candidates.iter().filter(|i| !left.contains(i)))
        .filter_map(|i| {
            let of =
                |t: &AddedTerms| format!("{} by the terms of {} in {} ({})", t.law, t.of, t.component, p_equation(t.p));
            let by_bound = || format!("{} by its bounds", models[*i].law.name);
            against[*i][0].map(of).or_else(|| is_out_of_bounds(*i).then(by_bound))
        })
        .collect();
    if !contradicted.is_empty() {
        reason += &format!("; contradicted: {}", contradicted.join(", "));
    }
    if !undetermined.is_empty() && !candidates.is_empty() {
        reason += &format!("; not compared because some coefficients are not determined: {}", named(&undetermined));
    }
    if models.iter().any(|m| m.in_variables) {
        reason += "; judged by ordinary least squares, before errors of the regressors are fitted";
    }
    Some(Recommendation { index: chosen, not_contradicted: left, reason })
}

/// What contradicts a law, at the level shared by all of its tests.
fn contradiction<'a>(tests: impl Iterator<Item = &'a AddedTerms>) -> Option<&'a AddedTerms> {
    let own: Vec<&AddedTerms> = tests.collect();
    let least = own.iter().copied().min_by(|a, b| a.p.total_cmp(&b.p))?;
    (least.p * (own.len() as f64) < CONTRADICTED_BELOW).then_some(least)
}
