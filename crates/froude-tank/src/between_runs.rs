//! Run-to-run variation when the runs are too few to be clusters: a trip, the mount or the wake of the previous run changes the load of each run by a fraction γ, of variance τ².
//!
//! With c the affected load in one run, zero elsewhere, and M the projection onto the residuals of the law, ĝ = cᵀMy/cᵀc of each run is A(γ + e), A = cᵀMc′/cᵀc. The noise e has a variance v for each
//! run, estimated from the scatter between eight pieces of it, so that a slow run, whose load is small beside the noise, has little weight. τ² maximises the likelihood of ĝ with covariance Σ = A(τ² + v)Aᵀ in the
//! directions that the law does not explain; it is at least the smallest v. It has τ⁴ tr[(Σ⁻¹AAᵀ)²] degrees of freedom, at least one: the number of these directions if the noise is small. With five or more runs, their scatter already includes the variation.
//!
//! Source: Patterson & Thompson (1971), Biometrika 58, 545 (residual maximum likelihood).

use froude_fit::faer::linalg::solvers::Solve as _;
use froude_fit::faer::{Mat, Side};

/// Fewest runs that show it.
pub(crate) const FEWEST_RUNS: usize = 3;
/// Below this, the law explains every direction and the rest is rounding error.
const TAKEN: f64 = 1e-3;
/// Directions whose eigenvalue of AAᵀ is below this fraction of the largest are dropped: the law explains most of them.
const LEFT: f64 = 0.05;
/// Pieces of a run.
const PIECES: usize = 8;
/// Number of trial values of τ², and the ratio between them (2 % in τ).
const STEPS: i32 = 700;
const RATIO: f64 = 1.04;

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
    let left_of_parts = parts.iter().map(|c| left_of(c)).collect::<Option<Vec<_>>>()?;
    let a = Mat::from_fn(n, n, |r, s| dot(&parts[r], &left_of_parts[s]) / dot(&parts[r], &parts[r]));
    let found: Vec<f64> = parts.iter().map(|c| dot(c, left) / dot(c, c)).collect();
    let noise: Vec<f64> = parts.iter().zip(&found).map(|(c, g)| noise(c, left, *g)).collect();
    let is_finite =
        (0..n).all(|r| found[r].is_finite() && noise[r].is_finite() && (0..n).all(|s| a[(r, s)].is_finite()));
    if !is_finite {
        return None;
    }
    let eigen = (&a * a.transpose()).self_adjoint_eigen(Side::Lower).ok()?;
    let largest = eigen.S()[n - 1];
    let kept: Vec<usize> = (0..n).filter(|k| eigen.S()[*k] > LEFT * largest).collect();
    if largest <= TAKEN {
        return None;
    }
    let along = Mat::from_fn(kept.len(), n, |k, r| eigen.U()[(r, kept[k])]);
    let (a, g) = (&along * a, &along * Mat::from_fn(n, 1, |r, _| found[r]));
    let covariance =
        |variance: f64| &a * Mat::from_fn(n, n, |r, s| if r == s { variance + noise[r] } else { 0.0 }) * a.transpose();
    let unlikely = |variance: f64| {
        let factor = covariance(variance).llt(Side::Lower).ok()?;
        let solved = factor.solve(&g);
        let log: f64 = (0..kept.len()).map(|k| 2.0 * factor.L()[(k, k)].ln()).sum();
        Some(log + (g.transpose() * solved)[(0, 0)])
    };
    let most = found.iter().map(|g| g * g).sum::<f64>() / (LEFT * largest);
    let least = noise.iter().copied().fold(f64::INFINITY, f64::min);
    let tried =
        (0..STEPS).map(|k| most * RATIO.powi(-k)).take_while(|x| *x >= least).chain([least]).filter(|x| *x > 0.0);
    let of = tried.filter_map(|x| Some((x, unlikely(x)?)));
    let (variance, _) = of.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let part = covariance(variance).llt(Side::Lower).ok()?.solve(&(&a * a.transpose()));
    let square = &part * &part;
    // Less than one degree of freedom has no quantile to speak of.
    let dof = (variance * variance * (0..kept.len()).map(|k| square[(k, k)]).sum::<f64>()).max(1.0);
    (variance.is_finite() && dof.is_finite()).then_some(BetweenRuns { variance, dof })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Variance of the noise in ĝ of a run, from pieces of its rows.
fn noise(c: &[f64], left: &[f64], found: f64) -> f64 {
    let rows: Vec<usize> = (0..c.len()).filter(|i| c[*i] != 0.0).collect();
    let piece = rows.len().div_ceil(PIECES).max(1);
    let of_piece = |rows: &[usize]| rows.iter().map(|&i| c[i] * (left[i] - found * c[i])).sum::<f64>().powi(2);
    rows.chunks(piece).map(of_piece).sum::<f64>() / dot(c, c).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    const ROWS: usize = 400;

    /// Estimated τ of three runs with these loads, whose true τ is `part`, in noise of 0.01 N: root mean square and upper quartile over 200 seeds.
    fn found(loads: [f64; 3], part: f64) -> [f64; 2] {
        let of_seed = |seed: u64| {
            let mut rng = Pcg64::new(u128::from(seed), 3);
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let one = |r: usize, load: f64| -> Vec<f64> {
                (0..3 * ROWS).map(|i| if i / ROWS == r { load } else { 0.0 }).collect()
            };
            let parts: Vec<Vec<f64>> = loads.iter().enumerate().map(|(r, load)| one(r, *load)).collect();
            let law: Vec<f64> = (0..3 * ROWS).map(|i| loads[i / ROWS]).collect();
            let changes = [normal(), normal(), normal()].map(|z| 1.0 + part * z);
            let y: Vec<f64> = (0..3 * ROWS).map(|i| changes[i / ROWS] * law[i] + 0.01 * normal()).collect();
            // A law of one coefficient.
            let left_of = |y: &[f64]| {
                let c = dot(y, &law) / dot(&law, &law);
                Some(y.iter().zip(&law).map(|(y, x)| y - c * x).collect())
            };
            let left: Vec<f64> = left_of(&y).unwrap();
            between_runs(&parts, &left, left_of).unwrap().variance
        };
        let mut all: Vec<f64> = (0..200).map(of_seed).collect();
        all.sort_by(f64::total_cmp);
        [(all.iter().sum::<f64>() / 200.0).sqrt(), all[150].sqrt()]
    }

    /// The noise of the slow run is 5 % of its load and must not be taken for run-to-run variation.
    #[test]
    fn a_slow_run_does_not_decide_what_changes_from_run_to_run() {
        let noise_of_fast = 0.01 / (ROWS as f64).sqrt();
        let [_, alike] = found([1.0, 0.8, 0.01], 0.0);
        assert!(alike < 3.0 * noise_of_fast, "{alike}");
        for loads in [[1.0, 0.8, 0.01], [1.0, 0.9, 0.8]] {
            let [changing, _] = found(loads, 0.02);
            assert!((0.018..0.025).contains(&changing), "{loads:?}: {changing}");
        }
    }
}
