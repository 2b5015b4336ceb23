//! The estimate of one block under its bounds and inequalities.

use crate::block::Block;
use crate::bounded::{Side, bounded_least_squares};
use crate::constrained::{Inequality, constrained};
use crate::dense::{mul_vec, norm};
use crate::error::FitError;
use crate::estimate::{Estimate, huber_weights};
use crate::options::Loss;
use crate::report::{End, Report};

/// Iterations of Huber's weights under constraints.
const WEIGHT_ITERATIONS: usize = 200;

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

pub(crate) fn shape(block: &Block, estimate: &Estimate, loss: Loss) -> Result<Shaped, FitError> {
    let Loss::Huber { k } = loss else {
        return solve(block, estimate, &vec![1.0; estimate.residual.len()]);
    };
    let mut weight = estimate.loss_weight.clone();
    let mut previous: Option<Vec<f64>> = None;
    let mut iterations = 0;
    loop {
        iterations += 1;
        let mut shaped = solve(block, estimate, &weight)?;
        let residual: Vec<f64> = mul_vec(estimate.design.as_ref(), &shaped.beta)
            .iter()
            .zip(&estimate.response)
            .map(|(f, y)| y - f)
            .collect();
        let change = previous
            .as_ref()
            .map_or(f64::INFINITY, |old| shaped.beta.iter().zip(old).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max));
        let is_done = change <= 1e-11 * norm(&shaped.beta);
        if is_done || iterations == WEIGHT_ITERATIONS {
            shaped.report = shaped
                .report
                .merge(Report { end: if is_done { End::Converged } else { End::IterationLimit }, iterations });
            return Ok(shaped);
        }
        weight = huber_weights(&residual, estimate.n_priors, k);
        previous = Some(shaped.beta);
    }
}

fn solve(block: &Block, estimate: &Estimate, weight: &[f64]) -> Result<Shaped, FitError> {
    let mut design = estimate.design.clone();
    let mut response = estimate.response.clone();
    for i in 0..response.len() {
        if weight[i] != 1.0 {
            let root = weight[i].sqrt();
            response[i] *= root;
            for l in 0..design.ncols() {
                design[(i, l)] *= root;
            }
        }
    }
    if block.inequalities.is_empty() {
        let found = bounded_least_squares(design.as_ref(), &response, &block.lower, &block.upper);
        return Ok(Shaped {
            beta: found.x,
            at_bound: found.active,
            active_inequalities: Vec::new(),
            kkt: found.kkt,
            report: found.report,
        });
    }
    let (constraints, tags) = constraints_of(block);
    let found = constrained(design.as_ref(), &response, &constraints)?;
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
