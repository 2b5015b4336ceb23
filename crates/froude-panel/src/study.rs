//! Matrices of similar meshes put together: every entry with its numerical uncertainty.

use crate::convergence::{Converged, converged};
use crate::problem::Solution;

/// Noise of an entry as part of √(A_ii A_jj), of the plain solver and of the fast one.
const NOISE: [f64; 2] = [1e-12, 5e-7];
/// Noise of an entry that is zero, as part of √(s_i s_j), s = V for forces and V L²/4 for moments.
const ZERO: f64 = 1e-12;

/// Orders of a diagonal entry that say that edges or a thin side are not resolved yet. Then no entry's change from mesh to mesh can be trusted
/// to be small, whatever its own order: a flat disc's surge erred by 13 of its uncertainty while its order was 1.99 and that of others 0.7.
pub const SLOW: core::ops::RangeInclusive<f64> = 0.2..=1.4;
/// Least uncertainty of an extrapolated value then, as part of what extrapolation subtracts. On the bodies of `examples/coverage`, a third of
/// which show such an order, coverage stays and the median of U over the error grows from 8.2 to 9.5 at most.
const UNRESOLVED: f64 = 0.5;

/// Size of a body (of one part of a chain), for entries that are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// Volume, m³.
    pub volume_m3: f64,
    /// Length, m.
    pub length_m: f64,
}

/// Entry by entry, part by part as in [`Solution::matrix`], symmetric.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Columns of six a part.
    pub entries: Vec<Vec<Converged>>,
    /// Largest |A_ij − A_ji| of the finest mesh as part of √(A_ii A_jj): a flag of a mesh that is too coarse.
    pub asymmetry: f64,
}

/// From the solutions of similar meshes, coarsest first, with their cell sizes in any unit.
///
/// # Panics
///
/// With fewer than two solutions, or another number of sizes.
#[must_use]
pub fn study(sizes: &[f64], solutions: &[Solution], size: Size) -> Study {
    assert!(sizes.len() == solutions.len() && sizes.len() >= 2, "two meshes at least, a size each");
    let finest = &solutions[solutions.len() - 1].matrix;
    let noise = NOISE[usize::from(solutions.iter().any(|s| s.report.iterations > 0))];
    let own = |i: usize| {
        let reach_m = if i % 6 < 3 { 1.0 } else { 0.5 * size.length_m };
        size.volume_m3 * reach_m * reach_m
    };
    let root = |i: usize, j: usize| (finest[i][i] * finest[j][j]).abs().sqrt();
    let entry = |i: usize, j: usize| {
        let values: Vec<f64> = solutions.iter().map(|s| 0.5 * (s.matrix[i][j] + s.matrix[j][i])).collect();
        converged(sizes, &values, noise * root(i, j) + ZERO * (own(i) * own(j)).sqrt())
    };
    let n = finest.len();
    let mut entries: Vec<Vec<Converged>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
    if (0..n).any(|i| entries[i][i].order.is_some_and(|p| SLOW.contains(&p))) {
        for c in entries.iter_mut().flatten() {
            let off = (c.fine.value - c.extrapolated.value).abs();
            c.extrapolated.uncertainty = c.extrapolated.uncertainty.max(UNRESOLVED * off);
        }
    }
    let apart = |i: usize, j: usize| {
        // A part that hardly resists (the roll of a round body) shows rounding only.
        let of = root(i, j).max(1e-6 * (own(i) * own(j)).sqrt());
        (finest[i][j] - finest[j][i]).abs() / of
    };
    let pairs = (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
    Study { entries, asymmetry: pairs.map(|(i, j)| apart(i, j)).fold(0.0, f64::max) }
}
