//! One force law fitted to one source: problem, fit, combined uncertainty.

mod fitted;
pub(crate) mod fitted_weights;
mod generalised;
mod held;
mod job;
pub(crate) mod known;
mod problem;
pub(crate) mod runs;
mod settings;
pub(crate) mod uncertain;

use faer::Mat;
use froude_fit as fit;
use froude_records::campaign::{BoundKind, Identify, PriorSpec};
use froude_records::finding::{Finding, Severity};

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::{CoefficientSpec, ForceLaw};
use crate::regression::fitted::is_uneven;
use crate::regression::held::{MOST_CUTS, beside_priors, hold};
use crate::regression::job::Job;
use crate::regression::problem::step;
use crate::regression::uncertain::Uncertainty;
use crate::uncertainty::{Linearised, directions};
use crate::{dissipation, eiv};

pub(crate) use crate::regression::fitted_weights::Variance;

pub use crate::regression::fitted::ModelFit;
pub use crate::regression::settings::{Condensed, Scatter, Settings, Weight};

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
    let mut job = Job::new(law, data, settings)?;
    let mut findings = Vec::new();
    let mut options = options(law, &job.specs, settings)?;
    let (mut problem, mut fitted) = job.solve(&options, &mut findings)?;
    if settings.identify.fitted_weights {
        for _ in 0..fitted_weights::ROUNDS {
            let weights = fitted_weights::weights(&problem, &fitted);
            let Some(weights) = weights.filter(|_| settings.condensed.is_none() && !law.is_nonlinear()) else { break };
            job.weight = Some(weights);
            (problem, fitted) = job.solve(&options, &mut findings)?;
        }
    }
    if settings.identify.dissipative && law.factor_symbols().is_some() {
        let rows = dissipation::constraints(law, data, job.specs.len())?;
        if !hold(&problem, &mut options, &mut fitted, &rows).map_err(|e| job.refusal(e))? {
            findings.push(job.not_converged(&format!(
                "the constraint that it delivers no power is not met everywhere after {MOST_CUTS} rounds"
            )));
        }
    }
    let in_variables = settings.identify.errors_in_variables
        && errors_in_variables(law, data, settings, &problem, &options, &mut fitted, &mut findings)?;
    let of_rows = fitted.clone();
    let whitened = if in_variables || !options.inequalities.is_empty() {
        None
    } else {
        generalised::generalised(law, data, settings, (&problem, &options), &mut fitted)?
    };
    if fitted.report.end != fit::End::Converged {
        let end = fitted.report.end;
        findings
            .push(job.not_converged(&format!("the solver stopped early ({end:?}); its values are not the best ones")));
    }
    let coefficients = step(&fitted);
    let has_offsets = job.specs.len() > law.coefficients.len();
    if law.is_nonlinear() || (problem.weight.is_some() && !has_offsets) {
        relative_residual(law, data, &coefficients, &job.newtons, &mut fitted)?;
    }
    findings.extend(beside_priors(law, data, settings, &problem, &options, &job.specs)?);
    let at = Linearised::about(law, data, &coefficients, &fitted);
    let declared = if whitened.is_some() || settings.condensed.is_some() {
        Mat::zeros(problem.n_rows(), 0)
    } else {
        directions(at, settings.budget, settings.shared_errors)?
    };
    let plain = if generalised::has_one_group(data, settings.budget) && settings.condensed.is_none() {
        let at = step(&of_rows);
        let at = Linearised::about(law, data, &at, &of_rows);
        Some(Box::new((of_rows.clone(), directions(at, settings.budget, settings.shared_errors)?)))
    } else {
        None
    };
    let uncertainty = Uncertainty::of(law, data, settings, (&problem, &fitted), [in_variables, whitened.is_some()])?;
    let of_fit = fitted.components.iter().flat_map(|c| c.sigma.into_iter().chain([c.rss]));
    let numbers = coefficients.iter().copied().chain(of_fit).chain(uncertainty.variances()).chain(uncertainty.arms());
    if let Some(number) = numbers.into_iter().find(|x| !x.is_finite()) {
        return Err(job.no_fit(format!(
            "its numbers exceed the range of floating point ({number}): look for an absurdly large value in the table or in [identify]"
        )));
    }
    Ok(ModelFit {
        law: law.clone(),
        specs: job.specs,
        problem,
        declared,
        beside: settings.condensed.map(|condensed| condensed.beside.clone()).unwrap_or_default(),
        options,
        fit: fitted,
        whitened,
        plain,
        coefficients,
        combined: uncertainty.combined,
        covariance: uncertainty.covariance,
        covariance_kind: uncertainty.kind,
        budget: uncertainty.budget,
        in_variables,
        scatter: settings.scatter.clone(),
        findings,
    })
}

/// √(Σ r²/Σ f²) of the loads themselves: the fit knows only the response of its last linear step, and weighs rows.
fn relative_residual(
    law: &ForceLaw,
    data: &Dataset,
    coefficients: &[f64],
    newtons: &[f64],
    fitted: &mut fit::Fit,
) -> Result<(), IdentifyError> {
    let predicted = law.predict(data, &coefficients[..law.coefficients.len()])?;
    let n = data.rows;
    for (r, summary) in fitted.components.iter_mut().enumerate() {
        let observed = |i: &usize| data.observes(&law.responses[r], i % n);
        let sum = |of: &dyn Fn(usize) -> f64| (r * n..(r + 1) * n).filter(observed).map(|i| of(i).powi(2)).sum::<f64>();
        summary.relative_residual = (sum(&|i| newtons[i] - predicted[i]) / sum(&|i| newtons[i])).sqrt();
    }
    Ok(())
}

/// Replaces the fit by an orthogonal distance regression where the budget gives row errors of what the law reads.
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
    if let Some(load) = law.responses.iter().find(|load| data.observed.contains_key(*load)) {
        return Err(IdentifyError::Campaign {
            place: place(),
            what: format!(
                "errors_in_variables needs loads that were measured in every row, and {load} was not: make a source of each axis that was tested by itself (`keep`)"
            ),
        });
    }
    let has_other = options.covariance != fit::CovarianceKind::Classical;
    if has_bounds || has_more || has_other || !options.excluded.is_empty() || is_uneven(problem) {
        return Err(IdentifyError::Campaign {
            place: place(),
            what: "errors_in_variables goes with neither bounds, priors, known, fixed or excluded coefficients, dissipative, HC3, cluster, weights, nor \
                   std columns; leave one of them out. Where the terms with the errors have coefficients that are held, leave out errors_in_variables: their errors are scatter then, \
                   and move no other coefficient"
                .to_owned(),
        });
    }
    let Some(inputs) = eiv::Inputs::of_budget(law, data, settings.budget) else {
        findings.push(Finding::new(
            Severity::Warning,
            "no-input-errors",
            format!(
                "model {}: errors_in_variables was asked for, but the budget has no entry with shared = \"sample\" for speed, angle \
                 or another column that the law reads; ordinary least squares is used",
                law.name
            ),
        ));
        return Ok(false);
    };
    let has = |name: &str| inputs.names.iter().any(|other| other == name);
    if has("speed") && (has("v_x") || has("v_y")) {
        return Err(IdentifyError::Campaign {
            place: place(),
            what: "the budget has errors of rows both of speed or angle and of v_x or v_y: the one velocity is the other; state one of them".to_owned(),
        });
    }
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
    let result = eiv::regress(law, data, inputs, fit::odr::Sigma::Estimated).map_err(|source| IdentifyError::Fit {
        source_name: settings.source_name.to_owned(),
        model: law.name.clone(),
        source: Box::new(source),
    })?;
    eiv::replace(fitted, &problem.design, &problem.response, result);
    Ok(true)
}

/// The known coefficients of a law, with their places in the campaign.
pub(crate) fn known_of<'a>(identify: &'a Identify, law: &ForceLaw) -> impl Iterator<Item = (usize, &'a PriorSpec)> {
    let is_meant = move |known: &PriorSpec| known.model.as_ref().is_none_or(|model| *model == law.name);
    identify.known.iter().enumerate().filter(move |(_, known)| is_meant(known))
}

/// The priors of a law, with the covariance of those that are of one record.
///
/// # Errors
///
/// A covariance that none can be.
fn priors(
    identify: &Identify,
    law: &ForceLaw,
    position: &dyn Fn(&str) -> Option<usize>,
) -> Result<Vec<fit::Prior>, IdentifyError> {
    let is_meant = |prior: &PriorSpec| prior.model.as_ref().is_none_or(|model| *model == law.name);
    let meant = identify.prior.iter().enumerate().filter(|(_, prior)| is_meant(prior));
    let meant: Vec<(usize, &PriorSpec, usize)> =
        meant.filter_map(|(k, prior)| Some((k, prior, position(&prior.coefficient)?))).collect();
    let indices: Vec<usize> = meant.iter().map(|(.., index)| *index).collect();
    let values: Vec<f64> = meant.iter().map(|(_, prior, _)| prior.value).collect();
    let between = |a: usize, b: usize| {
        let of_records = identify.prior_covariance.get(meant[a].0).and_then(|row| row.get(meant[b].0));
        if a == b { meant[a].1.standard_uncertainty.powi(2) } else { of_records.copied().unwrap_or(0.0) }
    };
    let covariance = Mat::from_fn(meant.len(), meant.len(), between);
    fit::Prior::correlated(&indices, &values, &covariance).ok_or_else(|| IdentifyError::Campaign {
        place: format!("[identify] prior, model {}", law.name),
        what: "the records give the priors correlations that no errors can have (their covariance has a negative eigenvalue): take them from one estimate, or write standard_uncertainty"
            .to_owned(),
    })
}

/// Bounds, fixed values, exclusions, priors and constraints by name.
///
/// # Errors
///
/// See [`priors`].
fn options(law: &ForceLaw, specs: &[CoefficientSpec], settings: Settings<'_>) -> Result<fit::Options, IdentifyError> {
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
    Ok(fit::Options {
        observations: settings.condensed.map(|c| c.observations.clone()).unwrap_or_default(),
        bounds,
        priors: priors(identify, law, &position)?,
        fixed: (identify.fixed.iter().map(|(name, value)| (name, *value)))
            .chain(known_of(identify, law).map(|(_, known)| (&known.coefficient, known.value)))
            .filter_map(|(name, value)| Some((position(name)?, value)))
            .collect(),
        excluded: identify.exclude.iter().filter_map(|n| position(n)).collect(),
        covariance: settings.scatter.of_residuals(),
        ..fit::Options::default()
    })
}
