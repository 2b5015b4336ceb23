//! The seam: what a method hands over is [`Reduced`], and whatever is fitted to rows passes [`fit`].
//!
//! A method knows how its runs or its table become observations, which laws they are to be fitted with, what they weigh, where their scatter
//! comes from, and which errors they share. It contains no regression, budget, interval or record: these are here, once. What it states about the
//! results (which of several is the best, whether they agree) it says afterwards.

pub(crate) mod reduced;

use froude_records::campaign::{Identify, StatedUnit};
use froude_records::finding::{Finding, Severity};
use froude_records::units::parse_unit;

use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::regression::{ModelFit, regress};
use crate::result::{NotFitted, SourceResult};
use crate::selection::{Recommendation, Score, added_terms, leave_one_out, range_block, recommend};
use crate::source::handed::TABLE;
use crate::{diagnosis, idle, record, zero};

pub use crate::seam::reduced::{Choice, Derived, Reduced, Stated};

/// Fits every law, compares and chooses, and makes the records; `progress` receives each law before it is fitted.
///
/// Observations and coefficients are in SI; the formulas are those of [`regress`] and [`recommend`].
///
/// # Errors
///
/// See [`IdentifyError`]; a law that cannot be fitted costs its own row, unless it is the last.
pub fn fit(mut reduced: Reduced, identify: &Identify, progress: &dyn Fn(&str)) -> Result<SourceResult, IdentifyError> {
    let each = |reduced: &Reduced| -> Vec<_> {
        let fitted = reduced.laws.iter().map(|law| {
            progress(&law.name);
            regress(law, &reduced.data, reduced.settings(identify)).map_err(|error| (law.name.clone(), error))
        });
        fitted.collect()
    };
    let mut fitted = each(&reduced);
    if reduced.stated.method == TABLE {
        let models: Vec<&ModelFit> = fitted.iter().filter_map(|result| result.as_ref().ok()).collect();
        let quiet = idle::mark_quiet(&models, &mut reduced.data);
        if !quiet.is_empty() {
            reduced.findings.extend(quiet);
            fitted = each(&reduced);
        }
    }
    conclude(reduced, identify, fitted)
}

/// Compares the laws that could be fitted, chooses and makes the records.
pub(crate) fn conclude(
    mut reduced: Reduced,
    identify: &Identify,
    fitted: Vec<Result<ModelFit, (String, IdentifyError)>>,
) -> Result<SourceResult, IdentifyError> {
    check_units(identify, &reduced.laws)?;
    let mut findings = std::mem::take(&mut reduced.findings);
    let (data, settings) = (&reduced.data, reduced.settings(identify));
    let (mut models, mut failed) = (Vec::new(), Vec::new());
    for result in fitted {
        match result {
            Ok(model) => {
                findings.extend(model.findings.iter().cloned());
                models.push(model);
            }
            Err(named) => failed.push(named),
        }
    }
    if models.is_empty() {
        return Err(nothing_fitted(failed, &findings));
    }
    let not_fitted: Vec<NotFitted> =
        failed.into_iter().map(|(model, error)| NotFitted { model, why: without_place(&error) }).collect();
    findings.extend(not_fitted.iter().map(|n| {
        let text = format!("model {} could not be fitted and is left out: {}", n.model, n.why);
        Finding::new(Severity::Warning, "not-fitted", text)
    }));
    let by_data = reduced.choice == Choice::Selection;
    let tests = if by_data { added_terms(&models, data, settings) } else { Vec::new() };
    findings.extend(zero::findings(&models, &reduced.beside_zero, data, settings));
    let scores: Vec<Score> = models.iter().map(|m| leave_one_out(m, data)).collect();
    let blocks = identify
        .cross_validation
        .iter()
        .flat_map(|block| models.iter().filter_map(|m| range_block(m, data, block)))
        .collect();
    let recommendation = match &reduced.choice {
        Choice::Selection => recommend(&models, data, &tests),
        Choice::Method(words) => Some(Recommendation { index: 0, not_contradicted: Vec::new(), reason: words.clone() }),
    };
    let mut estimates = Vec::new();
    for (i, model) in models.iter().enumerate() {
        let diagnostics = diagnosis::diagnostics(model, data, &scores[i])?;
        let chosen = recommendation.as_ref().filter(|r| by_data && r.index == i);
        estimates.push(record::estimate(model, &reduced, diagnostics, chosen));
    }
    if let Some(chosen) = &recommendation {
        record::with_ranges(&mut estimates, &models, data, &chosen.not_contradicted)?;
    }
    Ok(SourceResult {
        findings: findings.into_iter().map(|f| f.of_source(&reduced.source)).collect(),
        name: reduced.source,
        kind: reduced.kind,
        data: reduced.data,
        n_read: reduced.n_read,
        models,
        not_fitted,
        estimates,
        tests,
        scores,
        blocks,
        recommendation,
        validity: reduced.validity,
        files: reduced.files,
    })
}

/// Refuses a value of a coefficient in a unit that is none of its own.
fn check_units(identify: &Identify, laws: &[ForceLaw]) -> Result<(), IdentifyError> {
    for StatedUnit { coefficient, model, unit, place } in &identify.stated_units {
        for law in laws.iter().filter(|law| model.as_ref().is_none_or(|model| *model == law.name)) {
            let Some(spec) = law.coefficients.iter().find(|spec| spec.name == *coefficient) else { continue };
            // Units of a power law have an exponent that is not known before.
            if parse_unit(&spec.unit).is_ok_and(|own| own.dimension != unit.dimension) {
                let what = format!(
                    "{coefficient} of {} is in {}, and is stated in {}: write it in its unit (a standard uncertainty also in %)",
                    law.name, spec.unit, unit.text
                );
                return Err(IdentifyError::Campaign { place: place.to_string(), what });
            }
        }
    }
    Ok(())
}

/// Why an error came about, without the source and the model that it names: where it is shown, they stand beside it.
fn without_place(error: &IdentifyError) -> String {
    match error {
        IdentifyError::Fit { source, .. } => source.to_string(),
        IdentifyError::NoFit { why, .. } => why.clone(),
        IdentifyError::Campaign { what, .. } => what.clone(),
        other => other.to_string(),
    }
}

/// The error of a source without any fit: what each model says once, and what was found in the data before.
fn nothing_fitted(failed: Vec<(String, IdentifyError)>, findings: &[Finding]) -> IdentifyError {
    let mut reasons: Vec<IdentifyError> = Vec::new();
    for (_, error) in failed {
        if !reasons.iter().any(|r| without_place(r) == without_place(&error)) {
            reasons.push(error);
        }
    }
    let found: Vec<String> =
        findings.iter().filter(|f| f.severity == Severity::Error).map(|f| f.message.clone()).collect();
    match <[IdentifyError; 1]>::try_from(reasons) {
        Ok([only]) if found.is_empty() => only,
        Ok([only]) => IdentifyError::NothingFitted { reasons: vec![only], found },
        Err(reasons) => IdentifyError::NothingFitted { reasons, found },
    }
}
