//! Inputs of the uncertainty of each coefficient.

use froude_records::estimate::Estimate;
use froude_records::page::BudgetRow;

use crate::regression::ModelFit;
use crate::uncertainty::SCATTER;

/// The budget of a fit that was made here.
pub(super) fn of_fit(model: &ModelFit) -> Vec<BudgetRow> {
    let mut out = Vec::new();
    for (j, spec) in model.specs.iter().enumerate() {
        let Some(combined) = model.combined[j] else { continue };
        for part in &model.budget {
            // Listed, so that nobody looks for it in vain; the scatter holds it already.
            let (input, contribution) = if part.in_scatter {
                (format!("{}, in the scatter", part.name), 0.0)
            } else {
                (part.name.clone(), part.standard(j))
            };
            out.push(BudgetRow {
                model: model.law.name.clone(),
                coefficient: spec.name.clone(),
                shared: if input == SCATTER { String::new() } else { part.shared.to_owned() },
                input,
                contribution,
                unit: spec.unit.clone(),
                share: if combined.standard > 0.0 { (contribution / combined.standard).powi(2) } else { 0.0 },
            });
        }
    }
    out
}

/// The same from an estimate: its scatter and every error that it names.
pub(super) fn of_estimate(estimate: &Estimate) -> Vec<BudgetRow> {
    let Some(scatter) = &estimate.type_a else { return Vec::new() };
    let mut out = Vec::new();
    for (j, name) in scatter.names.iter().enumerate() {
        let errors =
            estimate.errors.values().map(|e| (e.name.clone(), e.between(&e.sensitivity[j], &e.sensitivity[j])));
        let parts: Vec<(String, f64)> =
            std::iter::once((scatter.kind.clone(), scatter.matrix[j][j])).chain(errors).collect();
        let total: f64 = parts.iter().map(|part| part.1).sum();
        let unit = estimate.coefficients.get(name).map_or_else(String::new, |c| c.unit.clone());
        out.extend(parts.into_iter().map(|(input, variance)| BudgetRow {
            model: estimate.law.name.clone(),
            coefficient: name.clone(),
            shared: String::new(),
            input,
            contribution: variance.max(0.0).sqrt(),
            unit: unit.clone(),
            share: if total > 0.0 { variance / total } else { 0.0 },
        }));
    }
    out
}
