//! Sources side by side: E_n per coefficient, a joint χ², and predicted forces.
//!
//! Coefficients of one model are compared with those of the same model only:
//! C_f of f1 and C_f of f6 share a name and nothing else. A published value
//! without uncertainty is shown as such; it never counts as exact.
//!
//! E_n = (a − b)/√(U_a² + U_b²) with U the expanded (95 %) uncertainties, where they have no error in common
//! (ISO 13528:2022, 9.7): |E_n| ≤ 1 says that the two agree within them.
//! U = k·u with k from Student's t of the effective degrees of freedom; 1.96
//! where the record states none, and [`Comparison::coverage`] says so.
//!
//! An interval that reaches to one side, or pays for looks, has the arm that points to the other value as its U.
//!
//! Errors that two records know by one key are one error: u²(a − b) = u_a² + u_b² − 2 cov(a, b) (GUM 5.2.2), and the part that is
//! common is removed from E_n and χ² exactly. Scatter from the same observations cannot be: two fits to the same
//! table or the same runs get [`SAME_DATA`] and no number.

mod coefficients;
mod contradiction;
pub(crate) mod independence;
mod joint;
mod named;
mod prediction;
pub(crate) mod stated;
#[cfg(test)]
mod tests;
mod unmatched;

use std::collections::{BTreeMap, BTreeSet};

use coefficients::coefficient_rows;
use contradiction::{axes_not_tied, contradiction, differing_constants};
use froude_records::comparison::Comparison;
use froude_records::finding::{Finding, Severity};
pub use independence::observations;
use independence::{has_likes, have_other_tables, is_one_source, origins, same_data, same_data_finding};
use joint::joint;
use prediction::predict_forces;

use crate::common::{self, Common};
use crate::verdict::verdicts;

pub use crate::compare::named::{Named, named};
pub use coefficients::SAME_DATA;
pub use unmatched::{left_out, nothing_compared, too_many};

/// Most estimates that are set side by side: 44,850 pairs, more than anybody reads.
pub const MOST_COMPARED: usize = 300;

/// Compares every pair of estimates of the same model, and predicts forces by the recommended ones.
///
/// More than [`MOST_COMPARED`] are not compared; the only finding says so.
///
/// E_n = (a − b)/U(a − b) for each coefficient and each predicted load, χ² = dᵀ(C_a + C_b − C_ab − C_abᵀ)⁻¹d for all coefficients of a pair together;
/// both are dimensionless, values and uncertainties have the units of the records.
///
/// # Source
///
/// ISO 13528:2022, 9.7 (E_n); JCGM 100:2008 (GUM), 5.2.2 (common errors) and G.4.1 (degrees of freedom).
#[must_use]
pub fn compare(all: &[Named<'_>]) -> Comparison {
    let mut out = Comparison::default();
    if all.len() > MOST_COMPARED {
        out.findings.push(Finding::new(Severity::Warning, "not-compared", too_many(all.len())));
        return out;
    }
    let (origins, labels) = (origins(all), labels(all));
    let mut told: BTreeSet<[(&str, &str); 2]> = BTreeSet::new();
    let mut shared: BTreeMap<[(&str, &str); 2], Vec<Common<'_>>> = BTreeMap::new();
    for (i, a) in all.iter().enumerate() {
        for (j, b) in all.iter().enumerate().skip(i + 1) {
            let is_same_data = same_data([a, b], [&origins[i], &origins[j]]);
            // Matrices that are computed from one mesh are not measurements to be compared with each other.
            let is_computed = [a, b].iter().all(|n| n.estimate.n_observations == 0);
            if is_same_data && is_computed && std::ptr::eq(a.record, b.record) {
                continue;
            }
            let pair = [(a.file, a.estimate.source.as_str()), (b.file, b.estimate.source.as_str())];
            if is_same_data && !is_one_source(a, b) && told.insert(pair) {
                out.findings.push(same_data_finding(a, b));
            }
            // Two methods of one source are not independent, and each is compared with its own kind where there is one.
            if a.estimate.law.name != b.estimate.law.name || is_one_source(a, b) || has_likes(all, a, b) {
                continue;
            }
            let methods = [a, b].map(|n| n.estimate.method.name.as_str());
            // An old record does not say its method.
            let is_one_method = methods[0] == methods[1] || methods.contains(&"");
            if a.estimate.source == b.estimate.source && is_one_method && !have_other_tables([&origins[i], &origins[j]])
            {
                out.findings.extend(contradiction(a, b));
            }
            let common = Common::of(a.estimate, b.estimate);
            let ids = [labels[i].as_str(), &labels[j]];
            out.coefficients.extend(coefficient_rows([a, b], ids, &common, is_same_data));
            let has_common = a.estimate.coefficients.keys().any(|name| b.estimate.coefficients.contains_key(name));
            if has_common {
                out.joint.push(joint([a, b], ids, &common, is_same_data));
            }
            if !is_same_data {
                let of_pair = shared.entry(pair).or_default();
                if of_pair.is_empty() {
                    out.findings.extend(axes_not_tied(a.estimate, b.estimate));
                }
                of_pair.push(common);
            }
        }
    }
    out.findings.extend(shared.into_values().flat_map(|all| common::findings(&all)));
    out.findings.extend(differing_constants(all));
    predict_forces(all, &labels, &mut out);
    out.verdicts = verdicts(&out);
    out
}

/// What each estimate is called: its id, with its file where two files have it.
fn labels(all: &[Named<'_>]) -> Vec<String> {
    let mut ids: BTreeMap<&str, usize> = BTreeMap::new();
    for n in all {
        *ids.entry(&n.estimate.id).or_default() += 1;
    }
    let label = |n: &Named<'_>| {
        let id = &n.estimate.id;
        if ids[id.as_str()] > 1 { format!("{id} ({})", n.file) } else { id.clone() }
    };
    all.iter().map(label).collect()
}
