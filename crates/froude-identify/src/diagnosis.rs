//! How far a fit can be trusted: diagnostics for the record, findings for the reader.

use froude_fit as fit;
use froude_records::campaign::Campaign;
use froude_records::estimate::{Diagnostics, NamedCorrelation};
use froude_records::finding::{Finding, Severity};

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::Kind;
use crate::outlying::outlying_rows;
use crate::regression::ModelFit;
use crate::selection::{Score, aicc};
use crate::{dissipation, lint};

/// Durbin–Watson below which residuals in run order are plainly not independent (lower 1 % bound is about 1.0 for
/// 15 to 25 rows and one to two regressors: Savin and White 1977).
const SERIAL_BELOW: f64 = 1.0;
/// Condition number of the scaled design above which digits are lost to collinearity (Belsley, Kuh, Welsch 1980: 30).
const COLLINEAR_ABOVE: f64 = 30.0;
/// Rank correlation of |residual| with speed that calls the scatter uneven, in standard errors.
const UNEVEN_ABOVE_Z: f64 = 2.0;
/// Fewest observations from which the error model is judged.
pub const FEWEST_FOR_SCATTER: usize = 8;

/// The numbers for the record.
///
/// # Errors
///
/// A channel that the law needs and the data lack.
pub fn diagnostics(model: &ModelFit, data: &Dataset, score: &Score) -> Result<Diagnostics, IdentifyError> {
    let f = &model.fit;
    let has_motion = data.values("speed").is_some_and(|u| u.iter().any(|x| *x != 0.0));
    let force_law = matches!(model.law.kind, Kind::Drag { .. }) && has_motion;
    Ok(Diagnostics {
        condition_number: Some(f.condition_number).filter(|c| c.is_finite()),
        largest_correlation: f.largest_correlation.map(|(a, b, value)| NamedCorrelation {
            first: model.specs[a].name.clone(),
            second: model.specs[b].name.clone(),
            value,
        }),
        largest_leverage: f.leverage.iter().copied().reduce(f64::max).filter(|x| x.is_finite()),
        relative_residual: f
            .components
            .iter()
            .filter(|c| c.relative_residual.is_finite())
            .map(|c| (c.name.clone(), c.relative_residual))
            .collect(),
        durbin_watson: f
            .components
            .iter()
            .filter_map(|c| c.durbin_watson.filter(|d| d.is_finite()).map(|d| (c.name.clone(), d)))
            .collect(),
        aicc: aicc(model, data).filter(|a| a.is_finite()),
        cross_validation_rmse: score.rmse.iter().filter(|(_, x)| x.is_finite()).cloned().collect(),
        cross_validation_note: score.note.clone(),
        lack_of_fit_p: lack_of_fit(model, data),
        largest_power_w: if force_law {
            Some(dissipation::largest_power_w(&model.law, data, model.law_coefficients())?)
        } else {
            None
        },
        notes: Vec::new(),
    })
}

/// p-value of lack of fit against the repeats of a setting, by component.
fn lack_of_fit(model: &ModelFit, data: &Dataset) -> indexmap::IndexMap<String, f64> {
    // Repeats of a setting are looked for among rows that are kept; rows of one run are none.
    if data.sample.is_some() || model.is_in_time(data) {
        return indexmap::IndexMap::new();
    }
    let groups = lint::repeats::repeat_groups(data);
    let n = data.rows;
    let most = groups.iter().copied().max().map_or(0, |m| m + 1);
    let stacked: Vec<usize> = (0..model.problem.response.len()).map(|row| row / n * most + groups[row % n]).collect();
    match fit::select::lack_of_fit(&model.problem, &model.fit, &stacked) {
        Ok(tests) => tests.into_iter().filter_map(|t| t.score.as_ref().map(|s| (t.component.clone(), s.p))).collect(),
        Err(_) => indexmap::IndexMap::new(),
    }
}

/// What a reader has to know about this fit.
#[must_use]
pub fn findings(model: &ModelFit, data: &Dataset, campaign: &Campaign, d: &Diagnostics) -> Vec<Finding> {
    let name = &model.law.name;
    let mut out = Vec::new();
    for (component, dw) in &d.durbin_watson {
        let has_order = data.rows >= 8 && !model.is_in_time(data);
        if *dw < SERIAL_BELOW && has_order {
            out.push(Finding::new(
                Severity::Warning,
                "serial-correlation",
                format!(
                    "{name}, {component}: residuals of successive rows are correlated (Durbin–Watson {dw:.2}, 2 when independent): \
                     the stated interval assumes independence and is too narrow; use covariance = \"cluster\" over blocks of runs, \
                     or a model that follows the drift"
                ),
            ));
        }
    }
    out.extend(outlying_rows(model, data));
    out.extend(uneven_scatter(model, data));
    if let Some(c) = d.condition_number
        && c > COLLINEAR_ABOVE
        && let Some(pair) = &d.largest_correlation
    {
        out.push(Finding::new(
            Severity::Note,
            "collinear",
            format!(
                "{name}: the scaled design has condition number {c:.0}; {} and {} are correlated by {:.3}: \
                 compare predicted forces rather than single coefficients",
                pair.first, pair.second, pair.value
            ),
        ));
    }
    for (component, p) in &d.lack_of_fit_p {
        if *p < 0.01 {
            out.push(Finding::new(
                Severity::Warning,
                "lack-of-fit",
                format!("{name}, {component}: the lack of fit is larger than the scatter of repeats of the same setting (p = {p:.1e}): the model is wrong somewhere in the range"),
            ));
        }
    }
    if let Some(power) = d.largest_power_w
        && power > 0.0
    {
        out.push(Finding::new(
            Severity::Warning,
            "not-dissipative",
            format!(
                "{name}: delivers up to {power:.3e} W to the body somewhere within ± the fitted speeds; a simulation can gain \
                 energy from it. Fit with dissipative = true"
            ),
        ));
    }
    for (spec, c) in model.specs.iter().zip(&model.fit.coefficients) {
        if c.status == fit::Status::BoundContradicted {
            out.push(Finding::new(
                Severity::Warning,
                "bound-contradicted",
                format!(
                    "{name}: the data put {} outside its bounds with 95 % confidence; the bound or the model is wrong",
                    spec.name
                ),
            ));
        }
    }
    out.extend(negative_drag(model));
    out.extend(drag_coefficients(model, data, campaign));
    out
}

/// How |residual| goes with speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unevenness {
    /// Spearman's rank correlation.
    pub rho: f64,
    /// The same in standard errors, 1/√(n − 1).
    pub z: f64,
}

impl Unevenness {
    /// Of sizes of residuals and speeds, as many of both.
    pub(crate) fn of(size: &[f64], speed: &[f64]) -> Self {
        let rho = rank_correlation(size, speed);
        Self { rho, z: rho * ((size.len() - 1) as f64).sqrt() }
    }

    /// True where equal errors are not what the residuals show.
    #[must_use]
    pub fn contradicts(self) -> bool {
        self.z.abs() > UNEVEN_ABOVE_Z
    }
}

/// Rank correlation of the residuals of a load with speed; `None` below [`FEWEST_FOR_SCATTER`] rows.
///
/// With std columns a row may scatter as much as they say: what must be even is r·√w.
///
/// ρ is Spearman's rank correlation of |r|·√w with |U|, dimensionless; z = ρ·√(n − 1) is ρ in standard errors of an uncorrelated sample.
#[must_use]
pub fn unevenness(model: &ModelFit, data: &Dataset, load: &str) -> Option<Unevenness> {
    let n = data.rows;
    let speed = data.values("speed").filter(|_| n >= FEWEST_FOR_SCATTER)?;
    let r = model.law.responses.iter().position(|name| name == load)?;
    let weight = |row: usize| model.problem.weight.as_ref().map_or(1.0, |w| w[row]);
    let size: Vec<f64> = (r * n..(r + 1) * n).map(|row| model.fit.residuals[row].abs() * weight(row).sqrt()).collect();
    let speed: Vec<f64> = speed.iter().map(|u| u.abs()).collect();
    Some(Unevenness::of(&size, &speed))
}

/// Whether |residual| grows with speed.
fn uneven_scatter(model: &ModelFit, data: &Dataset) -> Vec<Finding> {
    let mut out = Vec::new();
    for component in &model.law.responses {
        let Some(found) = unevenness(model, data, component) else { continue };
        let Unevenness { rho, z } = found;
        if found.contradicts() {
            let is_weighted = model.problem.weight.is_some();
            let (assumed, advice) = match (model.law.in_logarithms(), is_weighted) {
                (true, false) => ("equal relative errors", "compare with the fit in newtons"),
                (true, true) => ("relative errors as in the std columns", "compare with the fit in newtons"),
                (false, false) => ("equal absolute errors", "use HC3, std columns, or a fit in logarithms"),
                (false, true) => ("errors as in the std columns", "check these columns, or use HC3"),
            };
            out.push(Finding::new(
                Severity::Warning,
                "uneven-scatter",
                format!(
                    "{}, {component}: |residual|{} {} with speed (rank correlation {rho:.2}, {:.1} standard errors{}): {assumed} \
                     are not what the data show; {advice}",
                    model.law.name,
                    if is_weighted { " over its std" } else { "" },
                    if rho > 0.0 { "grows" } else { "falls" },
                    z.abs(),
                    if data.sample.is_some() { format!(", in a sample of {}", data.rows) } else { String::new() },
                ),
            ));
        }
    }
    out
}

/// Spearman's rank correlation, −1 to 1, with average ranks for ties; 0 where one of them is constant.
///
/// `a` and `b` have the same length, in any units.
#[must_use]
pub fn rank_correlation(a: &[f64], b: &[f64]) -> f64 {
    let ranks = |v: &[f64]| -> Vec<f64> {
        let mut order: Vec<usize> = (0..v.len()).collect();
        order.sort_by(|&i, &j| v[i].total_cmp(&v[j]));
        let mut out = vec![0.0; v.len()];
        let mut start = 0;
        while start < order.len() {
            let mut end = start;
            while end + 1 < order.len() && v[order[end + 1]] == v[order[start]] {
                end += 1;
            }
            for &i in &order[start..=end] {
                out[i] = 0.5 * (start + end) as f64;
            }
            start = end + 1;
        }
        out
    };
    let (x, y) = (ranks(a), ranks(b));
    let mean = (a.len() as f64 - 1.0) / 2.0;
    let sxy: f64 = x.iter().zip(&y).map(|(p, q)| (p - mean) * (q - mean)).sum();
    let sxx: f64 = x.iter().map(|p| (p - mean).powi(2)).sum();
    let syy: f64 = y.iter().map(|q| (q - mean).powi(2)).sum();
    if sxx > 0.0 && syy > 0.0 { sxy / (sxx * syy).sqrt() } else { 0.0 }
}

/// Drag terms of the built-in polynomials that push: the law is a fit of its range, and wrong near rest.
fn negative_drag(model: &ModelFit) -> Vec<Finding> {
    if !matches!(model.law.name.as_str(), "quadratic" | "linear_quadratic") {
        return Vec::new();
    }
    model
        .specs
        .iter()
        .zip(&model.fit.coefficients)
        .filter_map(|(spec, c)| Some((spec, c.value?, c.interval?)))
        // A moment of drift may have either sign.
        .filter(|(spec, _, [_, high])| spec.name.starts_with("D_") && *high < 0.0)
        .map(|(spec, value, _)| {
            Finding::new(
                Severity::Warning,
                "negative-drag",
                format!(
                    "{}: {} = {value:.4} {} is below zero: this term pushes the body. The law follows the data in their range and \
                     must not be used below it; compare with the power law, or set bounds",
                    model.law.name, spec.name, spec.unit
                ),
            )
        })
        .collect()
}

/// Quadratic coefficients in N s²/m² that no body of the stated area has.
fn drag_coefficients(model: &ModelFit, data: &Dataset, campaign: &Campaign) -> Vec<Finding> {
    let area = campaign.body.as_ref().and_then(|b| b.reference_area_m2);
    let density = data.values("density").and_then(|d| d.first().copied());
    let (Some(area), Some(density)) = (area, density) else { return Vec::new() };
    model
        .specs
        .iter()
        .enumerate()
        .filter(|(j, s)| {
            s.unit == "kg/m" && (s.name == "D_x_II" || s.name.starts_with("D_d")) && model.coefficients[*j] != 0.0
        })
        .filter_map(|(j, s)| lint::drag_coefficient(&s.name, model.coefficients[j].abs(), density, area))
        .collect()
}
