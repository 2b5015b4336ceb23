//! The contest of the laws, load by load.

use froude_records::page::SelectionRow;

use crate::dataset::unit_text;
use crate::regression::ModelFit;
use crate::result::SourceResult;
use crate::selection::aicc_of;

/// A row for each law and load; none where one fit has nothing to be chosen from.
pub(super) fn rows(source: &SourceResult) -> Vec<SelectionRow> {
    // One fit has nothing to be chosen from.
    if source.models.iter().all(|model| model.combined.iter().all(Option::is_none)) {
        return Vec::new();
    }
    let behind = |model: &ModelFit, load: &str| {
        let best = source.models.iter().filter_map(|m| aicc_of(m, &source.data, load)).fold(f64::INFINITY, f64::min);
        aicc_of(model, &source.data, load)
            .map(|a| a - best)
            .ok_or_else(|| "no AICc: an exact fit, or too few observations".to_owned())
    };
    let mut out = Vec::new();
    for (i, model) in source.models.iter().enumerate() {
        let diagnostics = &source.estimates[i].diagnostics;
        for (r, component) in model.fit.components.iter().enumerate() {
            let rmse = diagnostics.cross_validation_rmse.get(&component.name).copied();
            out.push(SelectionRow {
                model: model.law.name.clone(),
                component: component.name.clone(),
                n_coefficients: component.rank,
                sigma: model.sigma_of_rows(r).unwrap_or(f64::NAN),
                unit: if model.law.in_logarithms() { "1".to_owned() } else { unit_text(&source.data, &component.name) },
                relative_residual: component.relative_residual,
                delta_aicc: behind(model, &component.name),
                cross_validation: rmse
                    .ok_or_else(|| source.scores[i].note.clone().unwrap_or_else(|| "not possible".to_owned())),
                range_blocks: source
                    .blocks
                    .iter()
                    .filter(|b| b.model == model.law.name)
                    .flat_map(|b| {
                        b.rmse
                            .iter()
                            .filter(|(c, ..)| *c == component.name)
                            .map(|(_, error, _)| (b.block.clone(), *error))
                    })
                    .collect(),
                lack_of_fit_p: diagnostics.lack_of_fit_p.get(&component.name).copied(),
            });
        }
    }
    out
}
