//! One force law fitted to one source: problem, fit, combined uncertainty.

use faer::Mat;
use froude_fit as fit;
use froude_fit::budget::{Combined, OUTSIDE_95, Part, combine};
use froude_fit::replicates::{self, Replicates};
use froude_records::campaign::{AngleOffset, BoundKind, BudgetEntry, Identify, SourceKind};
use froude_records::finding::{Finding, Severity};

use crate::dataset::{Dataset, distinct, labels};
use crate::error::IdentifyError;
use crate::law::{CoefficientSpec, ForceLaw};
use crate::uncertainty::{Linearised, SharedError, contributions, scatter};
use crate::{dissipation, eiv};

/// Iterations of the non-linear parts (power law, angle offset); both converge quadratically.
const MOST_ITERATIONS: usize = 50;
/// Relative change of the coefficients at which they stop.
const CONVERGED: f64 = 1e-12;

/// Rounds of cutting planes for the constraint that no power is delivered.
const MOST_CUTS: usize = 40;
/// Violation of a constraint, relative to the coefficients, that counts as none.
const VIOLATED: f64 = 1e-9;
/// Cosine above which two cuts say the same.
const NEARLY_PARALLEL: f64 = 0.999;

/// Distance of a prior from what the data say, in standard uncertainties, that is no chance.
const PRIOR_CONTRADICTED_ABOVE: f64 = 3.0;

/// What the observations weigh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// All alike.
    One,
    /// By the `std_*` column of a load; all alike in a load without one.
    Std,
}

/// Where the standard uncertainties come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Scatter {
    /// The residuals: independent, one σ a load.
    Classical,
    /// The residuals: independent, of any variance.
    Hc3,
    /// The residuals, correlated in the groups of the data.
    Cluster,
    /// Replicates that the method left out in turn: all coefficients of the law, or none where nothing tells the scatter.
    Replicates {
        /// The line of the budget.
        name: String,
        /// Independent sets of them.
        sets: Vec<Replicates>,
    },
}

impl Scatter {
    /// What the residuals are asked for.
    const fn of_residuals(&self) -> fit::CovarianceKind {
        match self {
            Self::Classical | Self::Replicates { .. } => fit::CovarianceKind::Classical,
            Self::Hc3 => fit::CovarianceKind::Hc3,
            Self::Cluster => fit::CovarianceKind::Cr3,
        }
    }
}

/// What a regression needs besides its data and law.
#[derive(Debug, Clone, Copy)]
pub struct Settings<'a> {
    /// Name of the source, for messages.
    pub source_name: &'a str,
    /// What kind of source it is.
    pub kind: SourceKind,
    /// `[identify]` of the campaign.
    pub identify: &'a Identify,
    /// What the observations weigh.
    pub weight: Weight,
    /// Where the scatter comes from.
    pub scatter: &'a Scatter,
    /// The declared budget.
    pub budget: &'a [BudgetEntry],
    /// Key of the campaign that declares it; empty where none does.
    pub campaign: &'a str,
    /// Errors from subtracted tares, and those that the source's method knows.
    pub shared_errors: &'a [SharedError],
    /// Looks that an interval pays for (Bonferroni), 1 or more.
    pub looks: usize,
    /// All rows of a table that was read in chunks; then `data` holds those at the ends of its ranges.
    pub condensed: Option<&'a Condensed>,
}

/// Rows of a law that is linear in its coefficients, condensed to few with the same minimiser and sum of squares.
#[derive(Debug, Clone)]
pub struct Condensed {
    /// Triangles of `[X | y]`, one for each load, or one for each load and cluster.
    pub problem: fit::Problem,
    /// Observations of each load.
    pub observations: Vec<usize>,
}

impl<'a> Settings<'a> {
    /// Weights of the table, scatter of the residuals, nothing declared, one look.
    #[must_use]
    pub const fn new(source_name: &'a str, kind: SourceKind, identify: &'a Identify) -> Self {
        Self {
            source_name,
            kind,
            identify,
            weight: Weight::Std,
            scatter: &Scatter::Classical,
            budget: &[],
            campaign: "",
            shared_errors: &[],
            looks: 1,
            condensed: None,
        }
    }
}

/// A fitted law.
#[derive(Debug, Clone)]
pub struct ModelFit {
    /// The law.
    pub law: ForceLaw,
    /// All coefficients: those of the law, then angle offsets by setup.
    pub specs: Vec<CoefficientSpec>,
    /// The stacked problem in its final linearisation.
    pub problem: fit::Problem,
    /// The options it was fitted with.
    pub options: fit::Options,
    /// The fit.
    pub fit: fit::Fit,
    /// Coefficient values, zero where undetermined, in the order of `specs`.
    pub coefficients: Vec<f64>,
    /// Combined uncertainty per coefficient, where it has one.
    pub combined: Vec<Option<Combined>>,
    /// Combined covariance, p × p.
    pub covariance: Mat<f64>,
    /// The budget: the scatter, the declared entries, the shared errors.
    pub budget: Vec<Part>,
    /// True where errors of speed and angle were fitted too.
    pub in_variables: bool,
    /// Where its scatter comes from.
    pub scatter: Scatter,
    /// Words for that.
    pub covariance_kind: String,
    /// What was found while fitting.
    pub findings: Vec<Finding>,
}

impl ModelFit {
    /// The law's own coefficients (without angle offsets).
    #[must_use]
    pub fn law_coefficients(&self) -> &[f64] {
        &self.coefficients[..self.law.coefficients.len()]
    }

    /// Standard uncertainty of the predicted response for one row of regressors.
    ///
    /// √(xᵀCx) with C the combined covariance of the coefficients; N or N m for a `row` x in SI, as [`ForceLaw::regressors`] gives it.
    ///
    /// # Source
    ///
    /// JCGM 100:2008 (GUM), 5.2.2.
    #[must_use]
    pub fn prediction_std(&self, row: &[f64]) -> f64 {
        let mut variance = 0.0;
        for (a, x) in row.iter().enumerate() {
            for (b, y) in row.iter().enumerate() {
                variance += x * y * self.covariance[(a, b)];
            }
        }
        variance.max(0.0).sqrt()
    }
}

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

/// Logarithms of the loads, for the error model "every point has the same relative error".
fn logarithms(
    law: &ForceLaw,
    newtons: &[f64],
    data: &Dataset,
    settings: Settings<'_>,
) -> Result<Vec<f64>, IdentifyError> {
    let crate::law::Kind::PowerLaw { channel, .. } = &law.kind else { return Ok(newtons.to_vec()) };
    let v = data.values(channel).unwrap_or_default();
    newtons
        .iter()
        .zip(v)
        .enumerate()
        .map(|(i, (f, v))| {
            if f * v < 0.0 {
                Ok(f.abs().ln())
            } else {
                Err(IdentifyError::Campaign {
                    place: format!("source {:?}, model {}", settings.source_name, law.name),
                    what: format!(
                        "a fit in logarithms needs a load that opposes the motion in every row; on line {} \
                         {channel} is {v} and the load {f}: leave the row out with `keep`, or use power_law",
                        data.line.get(i).copied().unwrap_or(i + 1)
                    ),
                })
            }
        })
        .collect()
}

/// Setups whose angle offset is estimated, and the setup of each row.
struct OffsetSetups {
    names: Vec<String>,
    of_row: Vec<usize>,
}

fn offset_setups(law: &ForceLaw, data: &Dataset, identify: &Identify) -> OffsetSetups {
    let both_loads = law.responses == ["f_x", "f_y"];
    if identify.angle_offset != AngleOffset::Estimate || !both_loads {
        return OffsetSetups { names: Vec::new(), of_row: Vec::new() };
    }
    OffsetSetups { names: distinct(&data.setup), of_row: labels(&data.setup) }
}

/// The stacked, weighted linear problem at the current coefficients.
///
/// With an angle offset δ between sensor and body, f_sensor = Rᵀ(δ) f_body: the measured pair is rotated
/// back by the current δ, and the columns of dδ are (f_y, −f_x) of the current fit.
fn problem(
    law: &ForceLaw,
    data: &Dataset,
    specs: &[CoefficientSpec],
    measured: &[f64],
    weight: Option<Vec<f64>>,
    setups: &OffsetSetups,
    beta: &[f64],
) -> Result<fit::Problem, IdentifyError> {
    let n = data.rows;
    let p = law.coefficients.len();
    let mut slopes = law.regressors(data, &beta[..p])?;
    let mut current = law.predict(data, &beta[..p])?;
    if law.in_logarithms() {
        for i in 0..measured.len() {
            for j in 0..p {
                slopes[(i, j)] /= current[i];
            }
            current[i] = current[i].abs().ln();
        }
    }
    let mut design = Mat::zeros(measured.len(), specs.len());
    for i in 0..measured.len() {
        for j in 0..p {
            design[(i, j)] = slopes[(i, j)];
        }
    }
    let mut response = measured.to_vec();
    if law.is_nonlinear() {
        for i in 0..response.len() {
            let linear: f64 = (0..p).map(|j| slopes[(i, j)] * beta[j]).sum();
            response[i] += linear - current[i];
        }
    }
    if !setups.names.is_empty() {
        for i in 0..n {
            let s = setups.of_row[i];
            let (sin, cos) = beta[p + s].sin_cos();
            let (x, y) = (measured[i], measured[n + i]);
            response[i] = cos * x - sin * y;
            response[n + i] = sin * x + cos * y;
            design[(i, p + s)] = current[n + i];
            design[(n + i, p + s)] = -current[i];
            // Solved for the whole offset, so that a fixed value or a prior means the offset and not its last step.
            response[i] += beta[p + s] * design[(i, p + s)];
            response[n + i] += beta[p + s] * design[(n + i, p + s)];
        }
    }
    let component: Vec<usize> = (0..measured.len()).map(|row| row / n).collect();
    Ok(fit::Problem {
        design,
        response,
        weight,
        component,
        components: law.responses.clone(),
        cluster: data.group.as_ref().map(|g| {
            let of_row = labels(g);
            (0..measured.len()).map(|row| of_row[row % n]).collect()
        }),
        names: specs.iter().map(|s| s.name.clone()).collect(),
    })
}

/// Relative weights from `std_*` columns, scaled so that their mean is one within a response.
fn weights(law: &ForceLaw, data: &Dataset, weight: Weight) -> Result<Option<Vec<f64>>, IdentifyError> {
    let stds: Vec<Option<&[f64]>> = law.responses.iter().map(|r| data.values(&format!("std_{r}"))).collect();
    if weight == Weight::One || stds.iter().all(Option::is_none) {
        return Ok(None);
    }
    let mut out = Vec::with_capacity(stds.len() * data.rows);
    for (std, response) in stds.into_iter().zip(&law.responses) {
        let Some(std) = std else {
            out.extend(std::iter::repeat_n(1.0, data.rows));
            continue;
        };
        if let Some(i) = std.iter().position(|s| *s <= 0.0) {
            return Err(IdentifyError::Campaign {
                place: format!("model {}", law.name),
                what: format!(
                    "std_{response} on line {} is {}: a weight needs a standard deviation above zero",
                    data.line.get(i).copied().unwrap_or(i + 1),
                    std[i]
                ),
            });
        }
        // A logarithm has the relative standard deviation.
        let loads = data.values(response).unwrap_or_default();
        let weight: Vec<f64> = std
            .iter()
            .zip(loads)
            .map(|(s, f)| if law.in_logarithms() { (f / s).powi(2) } else { 1.0 / (s * s) })
            .collect();
        let mean = weight.iter().sum::<f64>() / weight.len() as f64;
        out.extend(weight.iter().map(|w| w / mean));
    }
    Ok(Some(out))
}

/// Where the iteration starts: zero for linear laws, the log–log line for the power law.
fn start(law: &ForceLaw, data: &Dataset, measured: &[f64], p: usize) -> Vec<f64> {
    let mut beta = vec![0.0; p];
    if let crate::law::Kind::PowerLaw { channel, .. } = &law.kind
        && let Some(v) = data.values(channel)
    {
        let points: Vec<(f64, f64)> = v
            .iter()
            .zip(measured)
            .filter(|(v, f)| v.abs() > 0.0 && **v * **f < 0.0)
            .map(|(v, f)| (v.abs().ln(), f.abs().ln()))
            .collect();
        let count = points.len() as f64;
        let (mx, my) =
            (points.iter().map(|p| p.0).sum::<f64>() / count, points.iter().map(|p| p.1).sum::<f64>() / count);
        let sxx: f64 = points.iter().map(|p| (p.0 - mx).powi(2)).sum();
        let sxy: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
        let n = if sxx > 0.0 { sxy / sxx } else { 2.0 };
        beta[0] = if count > 0.0 { (my - n * mx).exp() } else { 1.0 };
        beta[1] = n;
    }
    beta
}

/// The next coefficients.
fn step(fitted: &fit::Fit) -> Vec<f64> {
    fitted.coefficients.iter().map(|c| c.value.unwrap_or(0.0)).collect()
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

/// Priors that the data alone, with their budget, contradict: the two then have no common answer, and σ grows to cover
/// the gap.
fn contradicted_priors(
    law: &ForceLaw,
    data: &Dataset,
    settings: Settings<'_>,
    problem: &fit::Problem,
    options: &fit::Options,
    specs: &[CoefficientSpec],
) -> Result<Vec<Finding>, IdentifyError> {
    let alone = fit::Options { priors: Vec::new(), ..options.clone() };
    let Some(free) = (!options.priors.is_empty()).then(|| fit::fit(problem, &alone).ok()).flatten() else {
        return Ok(Vec::new());
    };
    let values = step(&free);
    let at = Linearised { law, data, coefficients: &values[..law.coefficients.len()], sensitivity: &free.sensitivity };
    let declared = contributions(
        at,
        settings.budget,
        settings.campaign,
        settings.shared_errors,
        settings.kind != SourceKind::Cfd,
    )?;
    let parts: Vec<Part> = std::iter::once(scatter(&free)).chain(declared).collect();
    let mut findings = Vec::new();
    for prior in &options.priors {
        let c = &free.coefficients[prior.index];
        let (Some(value), Some(_)) = (c.unconstrained, c.standard) else { continue };
        let standard = combine(&parts, prior.index, OUTSIDE_95).standard;
        let apart = (value - prior.value).abs() / standard.hypot(prior.standard);
        if apart > PRIOR_CONTRADICTED_ABOVE {
            findings.push(Finding::new(
                Severity::Warning,
                "prior-contradicted",
                format!(
                    "{}: the data alone give {} = {value:.4} ± {standard:.4} {unit}, the prior is {:.4} ± {:.4} {unit}: \
                     {apart:.1} standard uncertainties apart; the fit between them agrees with neither",
                    law.name,
                    specs[prior.index].name,
                    prior.value,
                    prior.standard,
                    unit = specs[prior.index].unit
                ),
            ));
        }
    }
    Ok(findings)
}

/// Holds a fit to many inequalities by cutting planes: the most violated ones are added until none is violated.
///
/// At the solution at most as many are active as there are coefficients; thousands of nearly parallel rows at
/// once would leave the solver without digits. False when some are still violated after the last round.
fn hold(
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

fn cosine(a: &[f64], b: &[f64]) -> f64 {
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(p, q)| p * q).sum::<f64>();
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
}
