//! How far a fit can be trusted: diagnostics for the record, findings for the reader.

use froude_fit as fit;
use froude_fit::distribution::t_two_sided;
use froude_records::campaign::Campaign;
use froude_records::estimate::{Diagnostics, NamedCorrelation};
use froude_records::finding::{Finding, Severity};
use froude_records::number::{p_equation, percent, plain, significant};
use froude_records::text::counted;

use crate::dataset::{Dataset, GroupedBy, distinct, unit_text};
use crate::error::IdentifyError;
use crate::law::Kind;
use crate::outlying::outlying_rows;
use crate::regression::{ModelFit, Scatter};
use crate::selection::{Score, aicc};

use crate::{dissipation, lag, lint, misfit, scatter_tests};

/// Condition number of the scaled design above which digits are lost to collinearity (Belsley, Kuh, Welsch 1980: 30).
const COLLINEAR_ABOVE: f64 = 30.0;
/// Degrees of freedom below which HC3 stands on few rows.
const FEW_DOF: f64 = 4.0;

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
        lack_of_fit_p: lack_of_fit(&model.judged(), data),
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
    let (clear, options) = model.clear_of_declared();
    let options = fit::Options { covariance: fit::CovarianceKind::Classical, ..options };
    let refitted = (model.declared.ncols() > 0).then(|| fit::fit(&clear, &options).ok()).flatten();
    match fit::select::lack_of_fit(&clear, refitted.as_ref().unwrap_or(&model.fit), &stacked) {
        Ok(tests) => {
            let read = tests.into_iter().filter(|test| !data.stated.contains(&test.component));
            read.filter_map(|t| Some((t.component, t.score.ok()?.p))).collect()
        }
        Err(_) => indexmap::IndexMap::new(),
    }
}

/// What a reader has to know about this fit.
#[must_use]
pub fn findings(model: &ModelFit, data: &Dataset, campaign: &Campaign, d: &Diagnostics) -> Vec<Finding> {
    let name = &model.law.name;
    let mut out = Vec::new();
    let judged = model.judged();
    let (outlying, rows) = outlying_rows(&judged, data);
    let scatter = scatter_tests::findings(&judged, data, &outlying);
    let is_assumed = |finding: &Finding| finding.code != "uneven-scatter" || model.is_of_one_sigma();
    out.extend(scatter.iter().map(|(_, finding)| finding.clone()).filter(is_assumed));
    out.extend(misfit::findings(&judged, data, d, (&scatter, &outlying)));
    out.extend(decided_by_one(model, data));
    out.extend(lag::findings(campaign, model, data));
    out.extend(added_mass_sign(model, data));
    out.extend(dead_bands(model));
    out.extend(rows);
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
    for (j, spec) in model.specs.iter().enumerate() {
        if let Some(bound) = model.contradicted_bound(j) {
            out.push(Finding::new(
                Severity::Warning,
                "bound-contradicted",
                format!(
                    "{name}: the data put {} beyond its bound of {bound} {} (1 % level over all bounds); the bound or the model is wrong",
                    spec.name, spec.unit
                ),
            ));
        }
    }
    out.extend(moved_out(model));
    out.extend(dominating_row(model, data));
    out.extend(negative_drag(model));
    out.extend(drag_coefficients(model, data, campaign));
    out
}

/// Coefficients that have no interval, as bounds of others move them.
fn moved_out(model: &ModelFit) -> Option<Finding> {
    let names: Vec<&str> =
        (0..model.specs.len()).filter(|j| model.is_moved_out(*j)).map(|j| model.specs[j].name.as_str()).collect();
    (!names.is_empty()).then(|| {
        let text = format!(
            "{}: the bounds of other coefficients move {} out of the interval that the data give without bounds: no interval is given; \
             a bound or the law is wrong",
            model.law.name,
            names.join(", ")
        );
        Finding::new(Severity::Warning, "moved-by-bounds", text)
    })
}

/// Leverage from which on one row decides a fit.
const DECIDES: f64 = 0.9;
/// Weight over the median one from which on it is the weight that does it.
const WEIGHS_MORE: f64 = 10.0;

/// A row whose weight alone decides a load.
fn dominating_row(model: &ModelFit, data: &Dataset) -> Vec<Finding> {
    let Some(weight) = model.problem.weight.as_ref().filter(|_| data.sample.is_none() && model.is_weighted()) else {
        return Vec::new();
    };
    let n = data.rows;
    let of_load = |(r, load): (usize, &String)| {
        let rows = r * n..(r + 1) * n;
        let mut sorted: Vec<f64> = weight[rows.clone()].iter().copied().filter(|w| *w > 0.0).collect();
        sorted.sort_by(f64::total_cmp);
        let median = *sorted.get(sorted.len() / 2)?;
        let i = rows.max_by(|a, b| model.fit.leverage[*a].total_cmp(&model.fit.leverage[*b]))?;
        let (leverage, times) = (model.fit.leverage[i], weight[i] / median);
        (leverage > DECIDES && times > WEIGHS_MORE).then(|| {
            let std = data.values(&format!("std_{load}")).map_or_else(String::new, |std| {
                format!(" (std_{load} {} {})", significant(std[i % n], 3), unit_text(data, load))
            });
            let text = format!(
                "{}, {load}: {}{std} weighs {} times the median row and alone decides the fit (leverage {}): check its standard deviation",
                model.law.name,
                data.row_name(i % n),
                significant(times, 2),
                percent(leverage)
            );
            Finding::new(Severity::Warning, "one-row-dominates", text)
        })
    };
    model.law.responses.iter().enumerate().filter_map(of_load).collect()
}

/// A row, or a group, that gives a coefficient nearly all of its scatter.
fn decided_by_one(model: &ModelFit, data: &Dataset) -> Vec<Finding> {
    let mut out = Vec::new();
    for (j, c) in model.fit.coefficients.iter().enumerate() {
        let (Some((which, part)), Some(dof)) = (c.most, c.dof) else { continue };
        let name = &model.specs[j].name;
        let numbers = format!("{}, {name}: {} degrees of freedom", model.law.name, plain(dof, 2));
        if model.is_refused(j) {
            let groups = data.group.as_ref().map(distinct).unwrap_or_default();
            let group = groups.get(which).cloned().unwrap_or_default();
            let is_in_time = data.values("time").is_some() && data.rows >= 2 * data.clusters();
            let advice = if is_in_time {
                "record runs of other motions, or model the correlation of successive rows (covariance = \"serial\")"
            } else if data.grouped_by == GroupedBy::Motion {
                "record runs of other motions"
            } else {
                "record more runs of other groups, or estimate an offset of each (group_offset = \"estimate\", covariance = \"classical\")"
            };
            let text = format!(
                "{numbers} over {}, of which {group:?} makes {} of the scatter: no interval is given below two; {advice}",
                counted(data.clusters(), data.grouped_by.word(), data.grouped_by.words()),
                percent(part)
            );
            out.push(Finding::new(Severity::Warning, "one-group-decides", text));
        } else if model.scatter == Scatter::Hc3 && dof < FEW_DOF {
            let row = data.row_name(which % data.rows);
            let text = format!(
                "{numbers}: {row} alone makes {} of the scatter; its interval is as wide as that",
                percent(part)
            );
            out.push(Finding::new(Severity::Note, "one-row-decides", text));
        }
    }
    out
}

/// Dead bands below zero: the inverse has no command for small loads.
fn dead_bands(model: &ModelFit) -> impl Iterator<Item = Finding> {
    let all = model.law.coefficients.iter().zip(model.law_coefficients());
    let below =
        all.filter(|(spec, value)| model.law.is_thruster() && spec.name.starts_with("dead_band") && **value < 0.0);
    below.map(|(spec, _)| {
        let text = format!(
            "{} is below zero, which is impossible for a thruster; possible causes are a zero load that was not subtracted, or a load that does not grow with the square of the command. The inverse has no command for small loads",
            spec.name
        );
        Finding::new(Severity::Note, "negative-dead-band", text)
    })
}

/// A load that grows with the acceleration along its own axis: an added mass below zero.
fn added_mass_sign(model: &ModelFit, data: &Dataset) -> Vec<Finding> {
    let mut out = Vec::new();
    let coefficients = model.law_coefficients();
    for (load, motion) in crate::source::models::PAIRS.into_iter().filter(|(load, _)| data.is_of_water(load)) {
        let channel = format!("{motion}_dot");
        let (Some(r), true) =
            (model.law.responses.iter().position(|l| l == load), model.law.channels().contains(&channel.as_str()))
        else {
            continue;
        };
        let (Ok(here), Ok(moved)) = (
            model.law.regressors(data, coefficients),
            model.law.regressors(&data.shifted(&channel, &vec![1.0; data.rows]), coefficients),
        ) else {
            continue;
        };
        // Of a law that is linear in the acceleration every row says the same.
        let step: Vec<f64> = (0..here.ncols()).map(|j| moved[(r * data.rows, j)] - here[(r * data.rows, j)]).collect();
        let slope: f64 = step.iter().zip(coefficients).map(|(x, c)| x * c).sum();
        let standard = model.prediction_std(&step);
        let dof = model.budget[0]
            .dof
            .iter()
            .zip(&step)
            .filter(|(_, x)| **x != 0.0)
            .map(|(dof, _)| *dof)
            .fold(f64::INFINITY, f64::min);
        let p = 0.5 * t_two_sided(slope.abs() / standard, dof);
        if standard > 0.0 && slope > 0.0 && p < scatter_tests::ALARM / model.law.responses.len() as f64 {
            let text = format!(
                "{}: {load} grows by {} per unit of {channel} ({} against zero): water resists an acceleration, so this added mass is below \
                 zero. Check the sign of {load} or of {channel}, or whether the body's own inertia was subtracted the wrong way",
                model.law.name,
                significant(slope, 3),
                p_equation(p)
            );
            out.push(Finding::new(Severity::Warning, "negative-added-mass", text));
        }
    }
    out
}

/// Drag terms of the built-in polynomials that push: the law is a fit of its range, and wrong near rest.
fn negative_drag(model: &ModelFit) -> Vec<Finding> {
    if !matches!(model.law.name.as_str(), "quadratic" | "linear_quadratic") {
        return Vec::new();
    }
    // A moment of drift may have either sign.
    let of_drag: Vec<usize> = (0..model.specs.len()).filter(|j| model.specs[*j].name.starts_with("D_")).collect();
    let level = scatter_tests::ALARM / of_drag.len().max(1) as f64;
    let mut out = Vec::new();
    for j in of_drag {
        let (Some(value), Some(combined)) = (model.fit.coefficients[j].value, model.combined[j]) else { continue };
        let p = 0.5 * t_two_sided(value.abs() / combined.standard, combined.dof);
        if value < 0.0 && p < level {
            let spec = &model.specs[j];
            let text = format!(
                "{}: {} = {value:.4} {} is below zero ({}): this term pushes the body. The law follows the data in their range and \
                 must not be used below it; compare with the power law, or write a law with another term ([[identify.model]])",
                model.law.name,
                spec.name,
                spec.unit,
                p_equation(p)
            );
            out.push(Finding::new(Severity::Warning, "negative-drag", text));
        }
    }
    out
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
