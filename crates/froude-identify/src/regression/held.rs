//! What bounds and priors hold, and what the observations say against them.

use froude_fit as fit;
use froude_fit::budget::{OUTSIDE_95, Part, combine};
use froude_fit::distribution::t_two_sided;
use froude_records::campaign::SourceKind;
use froude_records::finding::{Finding, Severity};
use froude_records::number::p_equation;

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::{CoefficientSpec, ForceLaw};
use crate::regression::known;
use crate::regression::problem::step;
use crate::regression::settings::{Scatter, Settings};
use crate::uncertainty::{Linearised, contributions, scatter};

/// Violation of a constraint, relative to the coefficients, that counts as none.
pub(crate) const VIOLATED: f64 = 1e-9;

/// Cosine above which two cuts say the same.
pub(crate) const NEARLY_PARALLEL: f64 = 0.999;

/// Chance of calling a prior contradicted that is not, over all priors of a law.
pub(crate) const PRIOR_ALARM: f64 = 0.01;

/// What the data alone say beside each prior; a warning where they contradict it: the two then have no common answer, and σ grows to cover the gap.
///
/// |prior − data|/√(u_p² + u_d²) is compared with Student's t at the degrees of freedom of u_d, Welch–Satterthwaite, the prior's being infinite.
pub(crate) fn beside_priors(
    law: &ForceLaw,
    data: &Dataset,
    settings: Settings<'_>,
    problem: &fit::Problem,
    options: &fit::Options,
    specs: &[CoefficientSpec],
) -> Result<Vec<Finding>, IdentifyError> {
    if matches!(settings.scatter, Scatter::Serial(_) | Scatter::Replicates { .. }) {
        return Ok(Vec::new());
    }
    let alone = fit::Options { priors: Vec::new(), ..options.clone() };
    let Some(free) = (!options.priors.is_empty()).then(|| fit::fit(problem, &alone).ok()).flatten() else {
        return Ok(Vec::new());
    };
    let values = step(&free);
    let at = Linearised::about(law, data, &values, &free);
    let declared = contributions(
        at,
        settings.budget,
        settings.campaign,
        settings.shared_errors,
        settings.kind != SourceKind::Cfd,
    )?;
    let known = known::parts(law, settings, problem, &free);
    let parts: Vec<Part> = std::iter::once(scatter(&free)).chain(declared).chain(known).collect();
    let mut findings = Vec::new();
    let of_law = settings.identify.prior.iter().filter(|p| p.model.as_ref().is_none_or(|model| *model == law.name));
    let stated = of_law.filter_map(|p| {
        let index = specs.iter().position(|spec| spec.name == p.coefficient)?;
        Some(fit::Prior::new(index, p.value, p.standard_uncertainty))
    });
    for prior in stated {
        let c = &free.coefficients[prior.index];
        let (Some(value), Some(_)) = (c.unconstrained, c.standard) else { continue };
        let own = combine(&parts, prior.index, OUTSIDE_95);
        let both = own.standard.hypot(prior.standard);
        let apart = (value - prior.value).abs() / both;
        let p = t_two_sided(apart, own.dof * (both / own.standard).powi(4));
        let numbers = format!(
            "{}: the data alone give {} = {value:.4} ± {:.4} {unit}, the prior is {:.4} ± {:.4} {unit}: {apart:.1} standard uncertainties apart ({})",
            law.name,
            specs[prior.index].name,
            own.standard,
            prior.value,
            prior.standard,
            p_equation(p),
            unit = specs[prior.index].unit
        );
        findings.push(if p < PRIOR_ALARM / options.priors.len() as f64 {
            let text = format!("{numbers}; the fit between them agrees with neither");
            Finding::new(Severity::Warning, "prior-contradicted", text)
        } else {
            Finding::new(Severity::Note, "prior-beside-data", numbers)
        });
    }
    Ok(findings)
}

/// Holds a fit to many inequalities by cutting planes: the most violated ones are added until none is violated.
///
/// At the solution at most as many are active as there are coefficients; thousands of nearly parallel rows at
/// once would leave the solver without digits. False when some are still violated after the last round.
pub(crate) fn hold(
    problem: &fit::Problem,
    options: &mut fit::Options,
    fitted: &mut fit::Fit,
    rows: &[fit::Constraint],
) -> Result<bool, fit::FitError> {
    for _ in 0..MOST_CUTS {
        let beta: Vec<f64> = fitted.coefficients.iter().map(|c| c.value.unwrap_or(0.0)).collect();
        let size: f64 = beta.iter().map(|b| b.abs()).sum();
        let excess = |c: &fit::Constraint| c.row.iter().zip(&beta).map(|(a, b)| a * b).sum::<f64>() - c.value;
        let mut violated: Vec<(f64, &fit::Constraint)> =
            rows.iter().map(|c| (excess(c), c)).filter(|(e, _)| *e > VIOLATED * size).collect();
        if violated.is_empty() {
            return Ok(true);
        }
        violated.sort_by(|a, b| b.0.total_cmp(&a.0));
        // One cut a round per end of the chain and sign of the velocity; parallel neighbours add nothing.
        let mut cuts: Vec<&fit::Constraint> = Vec::new();
        for (_, c) in violated {
            if cuts.iter().all(|k| cosine(&k.row, &c.row) < NEARLY_PARALLEL) {
                cuts.push(c);
            }
            if cuts.len() == 4 {
                break;
            }
        }
        options.inequalities.extend(cuts.into_iter().cloned());
        *fitted = fit::fit(problem, options)?;
    }
    Ok(false)
}

pub(crate) fn cosine(a: &[f64], b: &[f64]) -> f64 {
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(p, q)| p * q).sum::<f64>();
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
}

/// Rounds of cutting planes for the constraint that no power is delivered.
pub(crate) const MOST_CUTS: usize = 40;
