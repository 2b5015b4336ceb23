//! Whether a law is wrong somewhere in the range of its rows, asked in two ways at half the level each.
//!
//! **Against repeats of a setting:** F of what the law leaves of their means over their scatter; it sees any error of the law, and few of any one.
//!
//! **Against a bend:** Tukey's one degree of freedom, r·v/(|v| s) of Student's t, v being what the law leaves of f √|f|, and f the fitted load. Where the load is the square of a speed,
//! f √|f| is its cube: the next term. It needs no repeats, and sees an error that is smooth in the load.
//!
//! **Source.** Cook & Weisberg (1982), 2.3; Tukey (1949), Biometrics 5, 232 (given the fitted loads the residuals are independent of them, so that t is exact for normal errors of
//! one size); Ramsey (1969), J. Royal Stat. Soc. B 31, 350.

use froude_fit as fit;
use froude_fit::distribution::t_two_sided;
use froude_fit::residuals::Residuals;
use froude_records::estimate::Diagnostics;
use froude_records::finding::{Finding, Severity};
use froude_records::number::p_equation;

use crate::dataset::Dataset;
use crate::regression::{ModelFit, Scatter};
use crate::scatter_tests::{ALARM, declares_groups};

/// Fewest rows that a bend is looked for in.
const FEWEST_ROWS: usize = 8;
/// What the law leaves of a bend that it has itself is rounding.
const ROUNDING: f64 = 1e-6;

/// The loads that a law does not describe; `outlying` names those with a row that lies apart, which bends a fit.
pub(crate) fn findings(
    model: &ModelFit,
    data: &Dataset,
    diagnostics: &Diagnostics,
    outlying: &[(String, usize)],
) -> Vec<Finding> {
    // Errors that rows of a run or a setup share are no misfit.
    if declares_groups(model) {
        return Vec::new();
    }
    let bends = bends(model, data);
    let loads = model.law.responses.len() as f64;
    let mut out = Vec::new();
    for load in &model.law.responses {
        let of_repeats = diagnostics.lack_of_fit_p.get(load).copied();
        let of_bend = bends.iter().find(|(of, _)| of == load && !outlying.iter().any(|(apart, _)| apart == load));
        let level = ALARM / loads / if of_repeats.is_some() && of_bend.is_some() { 2.0 } else { 1.0 };
        let said = if let Some(p) = of_repeats.filter(|p| *p < level) {
            format!("the lack of fit is larger than the scatter of repeats of the same setting ({})", p_equation(p))
        } else if let Some((_, p)) = of_bend.filter(|(_, p)| *p < level) {
            format!("the residuals bend with the fitted load ({})", p_equation(*p))
        } else {
            continue;
        };
        let text = format!("{}, {load}: {said}: the model is wrong somewhere in the range", model.law.name);
        out.push(Finding::new(Severity::Warning, "lack-of-fit", text));
    }
    out
}

/// The loads in which a bend can be looked for, each with p of its t.
fn bends(model: &ModelFit, data: &Dataset) -> Vec<(String, f64)> {
    let is_plain = matches!(model.scatter, Scatter::Classical)
        && model.whitened.is_none()
        && !model.in_variables
        && !model.law.in_logarithms()
        && model.options.loss == fit::Loss::Squares
        && data.sample.is_none();
    let Ok(fitted) = model.law.predict(data, model.law_coefficients()) else { return Vec::new() };
    if !is_plain {
        return Vec::new();
    }
    let residuals = Residuals::of(&model.problem, &model.options, &model.fit);
    let named = model.law.responses.iter().zip(&residuals).zip(&model.fit.components);
    named
        .filter(|(_, component)| {
            component.sigma.is_some_and(|sigma| sigma > 0.0 && component.relative_residual > ROUNDING)
        })
        .filter_map(|((load, residuals), _)| Some((load.clone(), bend(model, residuals, &fitted)?)))
        .collect()
}

/// p of the bend of one load.
fn bend(model: &ModelFit, residuals: &Residuals, fitted: &[f64]) -> Option<f64> {
    let Residuals { rows, residual, q } = residuals;
    let dof = rows.len() as f64 - residuals.leverage().iter().sum::<f64>() - 1.0;
    if rows.len() < FEWEST_ROWS || dof < 1.0 {
        return None;
    }
    let weight = |row: usize| model.problem.weight.as_ref().map_or(1.0, |w| w[row]);
    let z: Vec<f64> = rows.iter().map(|&row| fitted[row] * fitted[row].abs().sqrt() * weight(row).sqrt()).collect();
    let onto: Vec<f64> = (0..q.ncols()).map(|k| z.iter().enumerate().map(|(i, z)| q[(i, k)] * z).sum()).collect();
    let left = |i: usize| z[i] - onto.iter().enumerate().map(|(k, c)| q[(i, k)] * c).sum::<f64>();
    let v: Vec<f64> = (0..z.len()).map(left).collect();
    let squares = |of: &[f64]| of.iter().map(|x| x * x).sum::<f64>();
    let (own, all) = (squares(&v), squares(residual));
    if own <= ROUNDING * squares(&z) {
        return None;
    }
    let along = v.iter().zip(residual).map(|(v, r)| v * r).sum::<f64>().powi(2) / own;
    let rest = (all - along).max(0.0);
    Some(t_two_sided((along * dof / rest).sqrt(), dof))
}
