//! A fitted law as an estimate record.

use froude_fit as fit;
use froude_records::campaign::Source;
use froude_records::estimate::{Coefficient, Covariance, Diagnostics, Estimate, Law, Measured, Range, Status};
use indexmap::IndexMap;

use crate::dataset::{Dataset, unit_text};
use crate::law::{Kind, REFERENCE_SPEED_M_S, geometry_of};
use crate::regression::ModelFit;

/// The record of one fitted model.
#[must_use]
pub fn estimate(
    model: &ModelFit,
    data: &Dataset,
    source: &Source,
    validity: &IndexMap<String, Range>,
    diagnostics: Diagnostics,
    recommended: bool,
    reason: Option<String>,
) -> Estimate {
    let mut constants = IndexMap::new();
    let mut geometry = IndexMap::new();
    match &model.law.kind {
        Kind::Drag { body, .. } => {
            constants.insert("v_ref".to_owned(), Measured { value: REFERENCE_SPEED_M_S, unit: "m/s".to_owned() });
            geometry = geometry_of(body);
        }
        Kind::PowerLaw { .. } => {
            constants.insert("U_ref".to_owned(), Measured { value: REFERENCE_SPEED_M_S, unit: "m/s".to_owned() });
        }
        Kind::Formulas(_) => {}
    }
    let density = data
        .values("density")
        .map(|d| Measured { value: d.iter().sum::<f64>() / d.len() as f64, unit: "kg/m^3".to_owned() });
    let in_logarithms = model.law.in_logarithms();
    Estimate {
        id: format!("{}/{}", source.name, model.law.name),
        source: source.name.clone(),
        kind: source.kind.name().to_owned(),
        model: model.law.name.clone(),
        law: Law { version: 1, constants, formulas: model.law.texts.clone() },
        geometry,
        density,
        frame: "body axes: x forward, y to starboard, z down; loads of the fluid on the body".to_owned(),
        reference_point: String::new(),
        method: method(model),
        covariance_kind: model.covariance_kind.clone(),
        dof: model.fit.components.iter().map(|c| (c.name.clone(), Some(c.dof))).collect(),
        sigma: model
            .fit
            .components
            .iter()
            .filter_map(|c| {
                let unit = if in_logarithms { "1".to_owned() } else { unit_text(data, &c.name) };
                c.sigma.map(|value| (c.name.clone(), Measured { value, unit }))
            })
            .collect(),
        n_observations: data.rows,
        coefficients: coefficients(model),
        covariance: covariance(model),
        undetermined: combinations(model),
        validity: validity.clone(),
        diagnostics,
        recommended,
        reason,
    }
}

fn method(model: &ModelFit) -> String {
    let is_weighted = model.problem.weight.is_some();
    let base = if model.law.in_logarithms() {
        if is_weighted { "least squares of logarithms" } else { "least squares of logarithms (equal relative errors)" }
    } else if model.law.is_nonlinear() {
        if is_weighted {
            "non-linear least squares (Gauss–Newton)"
        } else {
            "non-linear least squares (Gauss–Newton, equal absolute errors)"
        }
    } else {
        "linear least squares by orthogonal factorisation"
    };
    let mut out = base.to_owned();
    if model.in_variables {
        "orthogonal distance regression: speed and angle are uncertain too (σ by restricted maximum likelihood)"
            .clone_into(&mut out);
    }
    if model.options.bounds.iter().any(|b| b.lower == 0.0) {
        out += ", non-negative";
    }
    if !model.options.inequalities.is_empty() {
        out += ", under the constraint that it delivers no power";
    }
    if !model.options.priors.is_empty() {
        out += ", with published values as prior";
    }
    if let fit::Loss::Huber { k } = model.options.loss {
        out += &format!(", Huber loss with k = {k}");
    }
    if model.problem.weight.is_some() {
        out += ", weighted by the table's standard deviations";
    }
    if model.specs.len() > model.law.coefficients.len() {
        out += ", with an angle offset per setup";
    }
    out
}

fn coefficients(model: &ModelFit) -> IndexMap<String, Coefficient> {
    model
        .specs
        .iter()
        .enumerate()
        .map(|(j, spec)| {
            let fitted = &model.fit.coefficients[j];
            let status = match fitted.status {
                fit::Status::Free => Status::Free,
                fit::Status::AtBound => Status::AtBound,
                fit::Status::Fixed => Status::Fixed,
                fit::Status::Excluded => Status::Excluded,
                fit::Status::Prior => Status::Prior,
                fit::Status::Undetermined => Status::Undetermined,
                fit::Status::BoundContradicted => Status::BoundContradicted,
            };
            let combined = model.combined[j];
            // The interval is the unconstrained one, widened by the budget, cut by the bounds.
            let centre = fitted.unconstrained;
            let interval_95 = match (combined, centre) {
                (Some(c), Some(u)) => {
                    let [low, high] = c.interval(u);
                    let bound = model.options.bounds.get(j).copied().unwrap_or(fit::Bound::FREE);
                    let (low, high) = (low.max(bound.lower), high.min(bound.upper));
                    (low <= high).then_some([low, high])
                }
                _ => None,
            };
            let status = if combined.is_some() && interval_95.is_none() { Status::BoundContradicted } else { status };
            let coefficient = Coefficient {
                value: fitted.value.map(|_| model.coefficients[j]),
                unit: spec.unit.clone(),
                status,
                standard_uncertainty: combined.map(|c| c.standard),
                type_a: combined.map(|c| c.type_a),
                type_b: combined.map(|c| c.type_b),
                interval_95,
                effective_dof: combined.map(|c| c.dof).filter(|d| d.is_finite()),
            };
            (spec.name.clone(), coefficient)
        })
        .collect()
}

/// Covariance over the coefficients that have an uncertainty.
fn covariance(model: &ModelFit) -> Option<Covariance> {
    let there: Vec<usize> = (0..model.specs.len()).filter(|&j| model.combined[j].is_some()).collect();
    (!there.is_empty()).then(|| Covariance {
        names: there.iter().map(|&j| model.specs[j].name.clone()).collect(),
        matrix: there.iter().map(|&a| there.iter().map(|&b| model.covariance[(a, b)]).collect()).collect(),
    })
}

/// The determined combinations of undetermined coefficients, named by their physical factors where these explain them.
fn combinations(model: &ModelFit) -> Vec<String> {
    let symbols = model.law.factor_symbols();
    model
        .fit
        .undetermined
        .iter()
        .map(|combination| {
            let terms: Vec<String> = combination
                .weights
                .iter()
                .map(|&(j, w)| {
                    let name = &model.specs[j].name;
                    match &symbols {
                        Some(symbols) => format!("{}*{name}", symbols[j]),
                        None => format!("{w:.6}*{name}"),
                    }
                })
                .collect();
            terms.join(" + ").replace("+ -", "- ")
        })
        .collect()
}
