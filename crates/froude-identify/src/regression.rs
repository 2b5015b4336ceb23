//! One force law fitted to one source: problem, fit, combined uncertainty.

mod fitted;
mod held;
mod problem;

use faer::Mat;
use froude_fit as fit;
use froude_fit::budget::{Combined, OUTSIDE_95, Part, combine};
use froude_fit::replicates;
use froude_records::campaign::{BoundKind, SourceKind};
use froude_records::finding::{Finding, Severity};

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::{CoefficientSpec, ForceLaw};
use crate::regression::held::{MOST_CUTS, contradicted_priors, hold};
use crate::regression::problem::{logarithms, offset_setups, problem, start, step, weights};
use crate::uncertainty::{Linearised, contributions, scatter};
use crate::{dissipation, eiv};

pub use crate::regression::fitted::{Condensed, ModelFit, Scatter, Settings, Weight};

/// Iterations of the non-linear parts (power law, angle offset); both converge quadratically.
const MOST_ITERATIONS: usize = 50;
/// Relative change of the coefficients at which they stop.
const CONVERGED: f64 = 1e-12;

/// Fits `law` to `data`.
///
/// Least squares of each load by orthogonal factorisation, weighted, bounded and constrained as [`Settings`] states; covariance = type A of the scatter + type B of the
/// budget. Channels, coefficients and residuals are in SI.
///
/// # Errors
///
/// What the law, the fit or the budget finds wrong.
///
/// # Source
///
/// Golub & Van Loan, Matrix Computations, ch. 5 (factorisation); JCGM 100:2008 (GUM), 5.2 and G.4.1 (budget); MacKinnon & White (1985) (HC3);
/// Bell & McCaffrey (2002) (CR3).
pub fn regress(law: &ForceLaw, data: &Dataset, settings: Settings<'_>) -> Result<ModelFit, IdentifyError> {
    let newtons = law.measured(data)?;
    let no_fit = |why: String| IdentifyError::NoFit {
        source_name: settings.source_name.to_owned(),
        model: law.name.clone(),
        why,
    };
    let refuse = |source: fit::FitError| match source {
        fit::FitError::DesignNotFinite { .. } | fit::FitError::ResponseNotFinite { .. } if law.is_nonlinear() => {
            no_fit(ran_away(law, data, &newtons))
        }
        source => IdentifyError::Fit {
            source_name: settings.source_name.to_owned(),
            model: law.name.clone(),
            source: Box::new(source),
        },
    };
    let measured = if law.in_logarithms() { logarithms(law, &newtons, data, settings)? } else { newtons.clone() };
    let setups = offset_setups(law, data, settings.identify);
    let mut specs = law.coefficients.clone();
    specs.extend(setups.names.iter().map(|s| CoefficientSpec {
        name: format!("angle_offset{}{s}", if s.is_empty() { "" } else { "_" }),
        unit: "rad".to_owned(),
    }));
    let mut findings = Vec::new();
    let mut options = options(law, &specs, settings);
    let mut beta = start(law, data, &newtons, specs.len());
    let iterate = law.is_nonlinear() || !setups.names.is_empty();
    let weight = weights(law, data, settings.weight)?;
    let mut problem = match settings.condensed {
        Some(condensed) => condensed.problem.clone(),
        None => problem(law, data, &specs, &measured, weight.clone(), &setups, &beta)?,
    };
    let mut fitted = fit::fit(&problem, &options).map_err(refuse)?;
    if iterate {
        let mut converged = false;
        for _ in 0..MOST_ITERATIONS {
            let next = step(&fitted);
            let change = next.iter().zip(&beta).map(|(a, b)| (a - b).abs() / (a.abs() + 1e-9)).fold(0.0, f64::max);
            beta = next;
            problem = self::problem(law, data, &specs, &measured, weight.clone(), &setups, &beta)?;
            fitted = fit::fit(&problem, &options).map_err(refuse)?;
            if change < CONVERGED {
                converged = true;
                break;
            }
        }
        if !converged {
            findings.push(Finding::new(
                Severity::Warning,
                "not-converged",
                format!("model {}: the iteration did not converge within {MOST_ITERATIONS} steps", law.name),
            ));
        }
    }
    if settings.identify.dissipative && law.factor_symbols().is_some() {
        let rows = dissipation::constraints(law, data, specs.len())?;
        if !hold(&problem, &mut options, &mut fitted, &rows).map_err(refuse)? {
            findings.push(Finding::new(
                Severity::Warning,
                "not-converged",
                format!(
                    "model {}: the constraint that it delivers no power is not met everywhere after {MOST_CUTS} rounds",
                    law.name
                ),
            ));
        }
    }
    let mut in_variables = false;
    if settings.identify.errors_in_variables {
        in_variables = errors_in_variables(law, data, settings, &problem, &options, &mut fitted, &mut findings)?;
    }
    if fitted.report.end != fit::End::Converged {
        findings.push(Finding::new(
            Severity::Warning,
            "not-converged",
            format!(
                "model {}: the solver stopped early ({:?}); its values are not the best ones",
                law.name, fitted.report.end
            ),
        ));
    }
    let coefficients = step(&fitted);
    if law.is_nonlinear() {
        relative_residual(law, data, &coefficients, &newtons, &problem, &mut fitted)?;
    }
    findings.extend(contradicted_priors(law, data, settings, &problem, &options, &specs)?);
    let mut contributions = contributions(
        Linearised {
            law,
            data,
            coefficients: &coefficients[..law.coefficients.len()],
            sensitivity: &fitted.sensitivity,
        },
        settings.budget,
        settings.campaign,
        settings.shared_errors,
        settings.kind != SourceKind::Cfd,
    )?;
    if in_variables {
        // Row errors of speed and angle are in the regression's covariance already, also where there is no scatter.
        for (part, entry) in contributions.iter_mut().zip(settings.budget) {
            part.in_scatter |= eiv::is_input_error(entry);
        }
    }
    let replicates = match settings.scatter {
        Scatter::Replicates { name, sets } => {
            Some(replicates::together(name, sets).filter(|part| part.dof.len() == specs.len()))
        }
        Scatter::Classical | Scatter::Hc3 | Scatter::Cluster => None,
    };
    // Where replicates tell no scatter nothing does: the residuals of one of them are not asked.
    let is_known = |c: &fit::FitCoefficient| match &replicates {
        Some(part) => part.is_some() && c.value.is_some(),
        None => c.standard.is_some(),
    };
    let first = replicates.clone().flatten().unwrap_or_else(|| scatter(&fitted));
    let budget: Vec<Part> = std::iter::once(first).chain(contributions).collect();
    let outside = OUTSIDE_95 / settings.looks.max(1) as f64;
    let combined: Vec<Option<Combined>> = fitted
        .coefficients
        .iter()
        .enumerate()
        .map(|(j, c)| is_known(c).then(|| combine(&budget, j, outside)))
        .collect();
    let mut covariance = Mat::zeros(specs.len(), specs.len());
    for part in budget.iter().filter(|part| !part.in_scatter) {
        covariance += &part.covariance;
    }
    // A coefficient that was not estimated has no covariance, whatever the budget says.
    for j in 0..specs.len() {
        if combined[j].is_none() {
            for k in 0..specs.len() {
                covariance[(j, k)] = 0.0;
                covariance[(k, j)] = 0.0;
            }
        }
    }
    let of_fit = fitted.components.iter().flat_map(|c| c.sigma.into_iter().chain([c.rss]));
    let variances = (0..specs.len()).map(|j| covariance[(j, j)]);
    if let Some(number) = coefficients.iter().copied().chain(of_fit).chain(variances).find(|x| !x.is_finite()) {
        return Err(no_fit(format!(
            "its numbers exceed the range of floating point ({number}): look for an absurdly large value in the table or in [identify]"
        )));
    }
    Ok(ModelFit {
        law: law.clone(),
        specs,
        problem,
        options,
        fit: fitted,
        coefficients,
        combined,
        covariance,
        covariance_kind: match replicates {
            Some(_) => budget[0].name.clone(),
            None if in_variables => "model-based, errors in variables".to_owned(),
            None => residuals_in_words(data, settings),
        },
        budget,
        in_variables,
        scatter: settings.scatter.clone(),
        findings,
    })
}

/// Why the iteration of a power law left all bounds.
fn ran_away(law: &ForceLaw, data: &Dataset, newtons: &[f64]) -> String {
    let crate::law::Kind::PowerLaw { channel, .. } = &law.kind else {
        return "its iteration exceeds the range of floating point".to_owned();
    };
    let speeds = data.values(channel).unwrap_or_default();
    let moving = speeds.iter().filter(|v| **v != 0.0).count();
    let opposed = speeds.iter().zip(newtons).filter(|(v, f)| **v * **f < 0.0).count();
    let load = law.responses.first().map_or("the load", String::as_str);
    if 2 * opposed < moving {
        return format!(
            "{load} opposes {channel} in {opposed} of the {moving} rows that move, and a power law is a resistance: check the sign of \
             {load}, or leave this law out"
        );
    }
    format!(
        "its iteration diverges: exponent and factor of {load} are not determined by these rows; use speeds further apart, or a law with a given \
         exponent (quadratic)"
    )
}

/// √(Σ w r²/Σ w f²) of the loads themselves: the fit knows only the response of its last linear step.
fn relative_residual(
    law: &ForceLaw,
    data: &Dataset,
    coefficients: &[f64],
    newtons: &[f64],
    problem: &fit::Problem,
    fitted: &mut fit::Fit,
) -> Result<(), IdentifyError> {
    let predicted = law.predict(data, &coefficients[..law.coefficients.len()])?;
    let n = data.rows;
    for (r, summary) in fitted.components.iter_mut().enumerate() {
        // The weights of logarithms are relative ones.
        let weight = |i: usize| match &problem.weight {
            Some(w) if law.in_logarithms() => w[i] / newtons[i].powi(2),
            Some(w) => w[i],
            None => 1.0,
        };
        let sum = |of: &dyn Fn(usize) -> f64| (r * n..(r + 1) * n).map(|i| weight(i) * of(i).powi(2)).sum::<f64>();
        summary.relative_residual = (sum(&|i| newtons[i] - predicted[i]) / sum(&|i| newtons[i])).sqrt();
    }
    Ok(())
}

/// Replaces the fit by an orthogonal distance regression where the budget gives row errors of speed or angle.
fn errors_in_variables(
    law: &ForceLaw,
    data: &Dataset,
    settings: Settings<'_>,
    problem: &fit::Problem,
    options: &fit::Options,
    fitted: &mut fit::Fit,
    findings: &mut Vec<Finding>,
) -> Result<bool, IdentifyError> {
    let place = || format!("source {:?}, model {}", settings.source_name, law.name);
    let has_bounds = options.bounds.iter().any(|b| b.lower.is_finite() || b.upper.is_finite());
    let has_more = !options.inequalities.is_empty() || !options.priors.is_empty() || !options.fixed.is_empty();
    let has_other = options.loss != fit::Loss::Squares || options.covariance != fit::CovarianceKind::Classical;
    if has_bounds || has_more || has_other || !options.excluded.is_empty() || problem.weight.is_some() {
        return Err(IdentifyError::Campaign {
            place: place(),
            what: "errors_in_variables goes with neither bounds, priors, fixed or excluded coefficients, dissipative, Huber, HC3, cluster, nor \
                   std columns; leave one of them out"
                .to_owned(),
        });
    }
    let Some(standard) = eiv::input_standard(data, settings.budget) else {
        findings.push(Finding::new(
            Severity::Warning,
            "no-input-errors",
            format!(
                "model {}: errors_in_variables was asked for, but the budget has no entry for speed or angle with shared = \
                 \"sample\"; ordinary least squares is used",
                law.name
            ),
        ));
        return Ok(false);
    };
    if law.is_nonlinear() || fitted.coefficients.len() != law.coefficients.len() {
        findings.push(Finding::new(
            Severity::Warning,
            "no-input-errors",
            format!(
                "model {}: errors in variables are fitted for laws that are linear in their coefficients, without angle offsets; \
                 ordinary least squares is used",
                law.name
            ),
        ));
        return Ok(false);
    }
    let result =
        eiv::regress(law, data, standard, fit::odr::Sigma::Estimated).map_err(|source| IdentifyError::Fit {
            source_name: settings.source_name.to_owned(),
            model: law.name.clone(),
            source: Box::new(source),
        })?;
    eiv::replace(fitted, &problem.design, &problem.response, result);
    Ok(true)
}

/// What the record calls the covariance of residuals.
fn residuals_in_words(data: &Dataset, settings: Settings<'_>) -> String {
    let clusters = || data.clusters();
    let kind = match settings.scatter.of_residuals() {
        fit::CovarianceKind::Classical => "classical".to_owned(),
        fit::CovarianceKind::Hc3 => "HC3".to_owned(),
        fit::CovarianceKind::Cr3 if settings.identify.covariance.is_some() => format!("CR3, {} clusters", clusters()),
        fit::CovarianceKind::Cr3 => format!("CR3 by {} configurations", clusters()),
    };
    if settings.kind == SourceKind::Cfd { format!("{kind}; residuals are model error, not noise") } else { kind }
}

/// Bounds, fixed values, exclusions, priors and constraints by name.
fn options(law: &ForceLaw, specs: &[CoefficientSpec], settings: Settings<'_>) -> fit::Options {
    let identify = settings.identify;
    let position = |name: &str| specs.iter().position(|s| s.name == name);
    let is_drag = law.factor_symbols().is_some();
    let bounds = specs
        .iter()
        .enumerate()
        .map(|(j, spec)| {
            let kind = identify.bounds.named.get(&spec.name).copied().unwrap_or(
                // The default is meant for drag coefficients; offsets and users' derivatives may have any sign.
                if is_drag && j < law.coefficients.len() { identify.bounds.default } else { BoundKind::None },
            );
            match kind {
                BoundKind::NonNegative => fit::Bound::NON_NEGATIVE,
                BoundKind::None => fit::Bound::FREE,
            }
        })
        .collect();
    fit::Options {
        observations: settings.condensed.map(|c| c.observations.clone()).unwrap_or_default(),
        bounds,
        priors: identify
            .prior
            .iter()
            .filter(|p| p.model.as_ref().is_none_or(|m| m == &law.name))
            .filter_map(|p| {
                position(&p.coefficient).map(|index| fit::Prior {
                    index,
                    value: p.value,
                    standard: p.standard_uncertainty,
                })
            })
            .collect(),
        fixed: identify.fixed.iter().filter_map(|(n, v)| position(n).map(|j| (j, *v))).collect(),
        excluded: identify.exclude.iter().filter_map(|n| position(n)).collect(),
        loss: identify.huber.map_or(fit::Loss::Squares, |k| fit::Loss::Huber { k }),
        covariance: settings.scatter.of_residuals(),
        ..fit::Options::default()
    }
}
