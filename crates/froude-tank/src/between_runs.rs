//! Run-to-run variation when the runs are too few to be clusters: a trip, the mount or the wake of the previous run changes the load of each run by a fraction γ, of variance τ².
//!
//! With c the affected load in one run, zero elsewhere, and M the projection onto the residuals of the law, ĝ = cᵀMy/cᵀc of each run is A γ, A = cᵀMc′/cᵀc, so that τ² = |ĝ|²/tr K with K = AᵀA and
//! (tr K)²/tr K² degrees of freedom (Satterthwaite). The noise within the runs is in it too. Of five and more runs it is in their scatter.

use froude_fit::faer::Mat;

/// Fewest runs that show it.
pub(crate) const FEWEST_RUNS: usize = 3;
/// The law takes so much of it that the rest is rounding.
const TAKEN: f64 = 1e-3;

/// τ² and its degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BetweenRuns {
    pub variance: f64,
    pub dof: f64,
}

/// Variance between runs. `parts` are the loads c of the runs, `left` the residuals of the law, and `left_of` returns the residuals for any load. `None` if there are too few runs or the law absorbs the variation.
pub(crate) fn between_runs(
    parts: &[Vec<f64>],
    left: &[f64],
    left_of: impl Fn(&[f64]) -> Option<Vec<f64>>,
) -> Option<BetweenRuns> {
    let n = parts.len();
    if n < FEWEST_RUNS {
        return None;
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let left_of_parts = parts.iter().map(|c| left_of(c)).collect::<Option<Vec<_>>>()?;
    let a = Mat::from_fn(n, n, |r, s| dot(&parts[r], &left_of_parts[s]) / dot(&parts[r], &parts[r]));
    let k = a.transpose() * &a;
    let trace: f64 = (0..n).map(|r| k[(r, r)]).sum();
    let of_square: f64 = (0..n).flat_map(|r| (0..n).map(move |s| (r, s))).map(|at| k[at] * k[at]).sum();
    let found: f64 = parts.iter().map(|c| (dot(c, left) / dot(c, c)).powi(2)).sum();
    let is_left = trace > TAKEN && found.is_finite();
    is_left.then(|| BetweenRuns { variance: found / trace, dof: trace * trace / of_square })
}
