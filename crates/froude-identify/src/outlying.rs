//! Rows that the scatter of the others does not explain.
//!
//! The residual of row i over its own standard deviation, that one from the other rows (externally studentised):
//! t = r √w / (s₍ᵢ₎ √(1 − h)), s₍ᵢ₎² = ((n − p) s² − w r²/(1 − h))/(n − p − 1). It is of Student's t with n − p − 1 degrees of freedom; of n rows one is named
//! where n P(|T| ≥ |t|) is below 0.4 % over the loads of the law.
//!
//! Nothing is left out: whether a row is a mistake is in its log, not in its residual. A slip at a large speed makes the scatter look uneven, so a row is
//! named where the scatter is even without it, and not where it is uneven even so (large errors lie at large speeds then). Not asked where rows follow each
//! other in time, of a sample of the rows, and where σ is not that of the squares: with errors in variables, Huber's loss, and constraints that hold.
//!
//! **Source.** Cook & Weisberg (1982), *Residuals and Influence in Regression*, 2.2.2.

use froude_fit::distribution::t_two_sided;
use froude_records::finding::{Finding, Severity};
use froude_records::number::{plain, significant};

use crate::dataset::{Dataset, unit_text};
use crate::diagnosis::{FEWEST_FOR_SCATTER, Unevenness};
use crate::regression::ModelFit;

/// Chance of naming a row where all are sound, over all loads of a law.
const FALSE_ALARM: f64 = 0.004;
/// Fewest degrees of freedom of the other rows.
const FEWEST_DOF: f64 = 4.0;
/// A fit without error has no scatter to compare with.
const ROUNDING: f64 = 1e-9;

/// Nearer to 1 than this a row alone determines a coefficient, and has no residual.
const ALONE: f64 = 1e-8;

/// A row, its residual and that in standard deviations of the others.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Outlying {
    row: usize,
    residual: f64,
    t: f64,
}

/// The most outlying row of each component that has one, beside component and row.
pub(crate) fn outlying_rows(model: &ModelFit, data: &Dataset) -> (Vec<(String, usize)>, Vec<Finding>) {
    if data.sample.is_some() || model.in_variables || model.is_in_time(data) {
        return (Vec::new(), Vec::new());
    }
    let (mut loads, mut out) = (Vec::new(), Vec::new());
    for (r, component) in model.law.responses.iter().enumerate() {
        let Some(found) = outlying(model, data.rows, r) else { continue };
        if uneven_without(model, data, r, found).is_some_and(Unevenness::contradicts) {
            continue;
        }
        let Outlying { row, residual, t } = found;
        loads.push((component.clone(), row));
        let unit = if model.law.in_logarithms() { String::new() } else { format!(" {}", unit_text(data, component)) };
        let at = data.values("speed").map_or_else(String::new, |v| format!(" ({} m/s)", plain(v[row].abs(), 4)));
        out.push(Finding::new(
            Severity::Warning,
            "outlying-row",
            format!(
                "{}, {component}: {}{at} lies {}{unit} from the law, {t:.1} standard deviations of the other rows; it is used. Look at what was \
                 recorded, and leave it out (`keep`) for a reason that you can state",
                model.law.name,
                data.row_name(row),
                significant(residual, 3),
            ),
        ));
    }
    (loads, out)
}

/// The row of a component that the others explain least, if by less than chance.
fn outlying(model: &ModelFit, n: usize, r: usize) -> Option<Outlying> {
    let summary = &model.fit.components[r];
    let sigma = summary.sigma.filter(|_| summary.relative_residual > ROUNDING)?;
    let squares = summary.dof * sigma * sigma;
    let dof = summary.dof - 1.0;
    if dof < FEWEST_DOF || (squares / summary.rss - 1.0).abs() > ROUNDING.sqrt() {
        return None;
    }
    let of_row = |row: usize| {
        let i = r * n + row;
        let weight = model.problem.weight.as_ref().map_or(1.0, |w| w[i]);
        let (residual, free) = (model.fit.residuals[i], 1.0 - model.fit.leverage[i]);
        let own = weight * residual * residual / free;
        // Where nothing is left for the others, they fit without it.
        let t = (own * dof / (squares - own).max(ROUNDING * squares)).sqrt();
        (free > ALONE).then_some(Outlying { row, residual, t })
    };
    let most = (0..n).filter_map(of_row).filter(|found| !found.t.is_nan()).max_by(|a, b| a.t.total_cmp(&b.t))?;
    let loads = model.law.responses.len() as f64;
    (t_two_sided(most.t, dof) * n as f64 * loads < FALSE_ALARM).then_some(most)
}

/// How the residuals go with speed in the fit without a row: `r_i + x_i S_k r_k/(1 − h_k)`.
fn uneven_without(model: &ModelFit, data: &Dataset, r: usize, found: Outlying) -> Option<Unevenness> {
    let n = data.rows;
    let speed = data.values("speed").filter(|_| n > FEWEST_FOR_SCATTER)?;
    let k = r * n + found.row;
    let pull = found.residual / (1.0 - model.fit.leverage[k]);
    let moved = |i: usize| {
        (0..model.problem.design.ncols())
            .map(|j| model.problem.design[(i, j)] * model.fit.sensitivity[(j, k)] * pull)
            .sum::<f64>()
    };
    let weight = |i: usize| model.problem.weight.as_ref().map_or(1.0, |w| w[i]);
    let load = &model.law.responses[r];
    let others: Vec<usize> = (0..n).filter(|row| *row != found.row && data.observes(load, *row)).collect();
    let size = |row: &usize| {
        let i = r * n + row;
        (model.fit.residuals[i] + moved(i)).abs() * weight(i).sqrt()
    };
    Some(Unevenness::of(
        &others.iter().map(size).collect::<Vec<_>>(),
        &others.iter().map(|row| speed[*row].abs()).collect::<Vec<_>>(),
    ))
}
