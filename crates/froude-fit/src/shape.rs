//! The estimate of one block under its bounds and inequalities.

use crate::block::Block;
use crate::bounded::{Side, bounded_least_squares};
use crate::constrained::{Inequality, constrained};
use crate::error::FitError;
use crate::estimate::Estimate;
use crate::report::Report;

/// A block's constrained estimate, in scaled units.
#[derive(Debug, Clone)]
pub(crate) struct Shaped {
    /// Scaled coefficients.
    pub beta: Vec<f64>,
    /// Bound that holds for each.
    pub at_bound: Vec<Option<Side>>,
    /// Inequalities that hold with equality, local indices.
    pub active_inequalities: Vec<usize>,
    /// Largest violation of the optimality conditions.
    pub kkt: f64,
    /// How it ended.
    pub report: Report,
}

/// What a constraint stands for.
#[derive(Debug, Clone, Copy)]
enum Tag {
    Bound(usize, Side),
    Inequality(usize),
}

pub(crate) fn shape(block: &Block, estimate: &Estimate) -> Result<Shaped, FitError> {
    let (design, response) = (estimate.design.as_ref(), &estimate.response);
    if block.inequalities.is_empty() {
        let found = bounded_least_squares(design, response, &block.lower, &block.upper);
        return Ok(Shaped {
            beta: found.x,
            at_bound: found.active,
            active_inequalities: Vec::new(),
            kkt: found.kkt,
            report: found.report,
        });
    }
    let (constraints, tags) = constraints_of(block);
    let found = constrained(design, response, &constraints)?;
    let mut beta = found.x;
    let mut at_bound = vec![None; beta.len()];
    let mut active_inequalities = Vec::new();
    for k in found.active {
        match tags[k] {
            Tag::Bound(l, side) => {
                at_bound[l] = Some(side);
                beta[l] = match side {
                    Side::Lower => block.lower[l],
                    Side::Upper => block.upper[l],
                };
            }
            Tag::Inequality(k) => active_inequalities.push(k),
        }
    }
    Ok(Shaped { beta, at_bound, active_inequalities, kkt: found.kkt, report: found.report })
}

/// Bounds and inequalities as constraints of unit length, with what each stands for.
fn constraints_of(block: &Block) -> (Vec<Inequality>, Vec<Tag>) {
    let mut all: Vec<(Inequality, Tag)> = Vec::new();
    for l in 0..block.columns.len() {
        let mut unit = vec![0.0; block.columns.len()];
        if block.upper[l].is_finite() {
            unit[l] = 1.0;
            all.push(((unit.clone(), block.upper[l]), Tag::Bound(l, Side::Upper)));
        }
        if block.lower[l].is_finite() {
            unit[l] = -1.0;
            all.push(((unit, -block.lower[l]), Tag::Bound(l, Side::Lower)));
        }
    }
    all.extend(block.inequalities.iter().enumerate().map(|(k, row)| (row.clone(), Tag::Inequality(k))));
    all.into_iter().unzip()
}
