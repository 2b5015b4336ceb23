//! Rows that the scatter of the others does not explain.
//!
//! The residual of row i over its own standard deviation, that one from the other rows (externally studentised):
//! t = r √w / (s₍ᵢ₎ √(1 − h)), s₍ᵢ₎² = ((n − p) s² − w r²/(1 − h))/(n − p − 1). It is of Student's t with n − p − 1 degrees of freedom; of n rows one is named
//! where n P(|T| ≥ |t|) is below 1 %.
//!
//! Nothing is left out: whether a row is a mistake is in its log, not in its residual. Not asked where the scatter is uneven (large errors lie at large speeds
//! then), where rows follow each other in time, and of a sample of the rows.
//!
//! **Source.** Cook & Weisberg (1982), *Residuals and Influence in Regression*, 2.2.2.

use froude_fit::distribution::t_two_sided;
use froude_records::finding::{Finding, Severity};

use crate::dataset::Dataset;
use crate::diagnosis::{Unevenness, unevenness};
use crate::regression::ModelFit;

/// Chance of naming a row of a campaign in which all are sound.
const FALSE_ALARM: f64 = 0.01;
/// Fewest degrees of freedom of the other rows.
const FEWEST_DOF: f64 = 4.0;
/// A fit without error has no scatter to compare with.
const ROUNDING: f64 = 1e-9;

/// A row, its residual and that in standard deviations of the others.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Outlying {
    row: usize,
    residual: f64,
    t: f64,
}

/// The most outlying row of each component.
pub(crate) fn outlying_rows(model: &ModelFit, data: &Dataset) -> Vec<Finding> {
    if data.sample.is_some() || model.in_variables || model.is_in_time(data) {
        return Vec::new();
    }
    let mut out = Vec::new();
    for (r, component) in model.law.responses.iter().enumerate() {
        if unevenness(model, data, component).is_some_and(Unevenness::contradicts) {
            continue;
        }
        let Some(Outlying { row, residual, t }) = outlying(model, data.rows, r) else { continue };
        let unit = if model.law.in_logarithms() {
            ""
        } else if component.starts_with('m') {
            " N m"
        } else {
            " N"
        };
        out.push(Finding::new(
            Severity::Warning,
            "outlying-row",
            format!(
                "{}, {component}: {} lies {residual:+.3e}{unit} from the law, {:.1} standard deviations of the other rows; it is used. Look at what was \
                 recorded, and leave it out (`keep`) for a reason that you can state",
                model.law.name,
                data.row_name(row),
                t.abs()
            ),
        ));
    }
    out
}

/// The row of a component that the others explain least, if by less than chance.
fn outlying(model: &ModelFit, n: usize, r: usize) -> Option<Outlying> {
    let summary = &model.fit.components[r];
    let sigma = summary.sigma.filter(|_| summary.relative_residual > ROUNDING)?;
    let dof = summary.dof - 1.0;
    if dof < FEWEST_DOF {
        return None;
    }
    let of_row = |row: usize| {
        let i = r * n + row;
        let weight = model.problem.weight.as_ref().map_or(1.0, |w| w[i]);
        let residual = model.fit.residuals[i];
        let free = 1.0 - model.fit.leverage[i];
        // A row that alone determines a coefficient has no residual.
        let own = weight * residual * residual / free;
        let others = (summary.dof * sigma * sigma - own) / dof;
        let t = (own / others).sqrt();
        // Where nothing is left for the others, they fit without it.
        Outlying { row, residual, t: if others > 0.0 { t } else { f64::INFINITY } }
    };
    let most = (0..n).map(of_row).filter(|found| !found.t.is_nan()).max_by(|a, b| a.t.total_cmp(&b.t))?;
    (t_two_sided(most.t, dof) * (n as f64) < FALSE_ALARM).then_some(most)
}
