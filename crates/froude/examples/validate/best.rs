//! The best tests of a fault: their 80 % points, given what they do not know.
//!
//! | of | knows | source |
//! | --- | --- | --- |
//! | [`known`] | the direction of the fault, and σ | Neyman & Pearson (1933) |
//! | [`one_row`] | neither the row nor σ | Ferguson (1961), 4th Berkeley Symp. 1, 253 |
//! | [`of_covariance`] | the covariance of the errors under the fault, neither σ nor the coefficients | King (1987), Econometric Reviews 6, 169 |

use froude::fit::distribution::{coverage_factor, normal_quantile};
use froude::fit::faer::linalg::solvers::Solve;
use froude::fit::faer::{Mat, Side};
use rand_pcg::Pcg64;

use crate::coverage::normal;

/// Normal quantile of the power that a point is of.
const OF_POWER: f64 = 0.841_621_233_572_914;
/// Draws behind a point.
const DRAWS: usize = 40_000;

/// Standard uncertainties of a known direction that are found in 80 % at a level to one side.
pub fn known(level_one_side: f64) -> f64 {
    normal_quantile(1.0 - level_one_side) + OF_POWER
}

/// Standard deviations of one row of `n` that the largest studentised residual finds in 80 %: `dof` of the residuals, `free` the mean of √(1 − h).
pub fn one_row(level: f64, n: f64, dof: f64, free: f64) -> f64 {
    let mut rng = Pcg64::new(1, 4000);
    let of_others = dof - 1.0;
    let passes = coverage_factor(1.0 - level / n, of_others);
    let mut needed: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let squares: f64 = (0..of_others as usize).map(|_| normal(&mut rng).powi(2)).sum();
            passes * (squares / of_others).sqrt() - normal(&mut rng)
        })
        .collect();
    needed.sort_by(f64::total_cmp);
    needed[DRAWS * 4 / 5] / free
}

/// Share of tables that the point-optimal invariant test finds at a level, of errors with a covariance beside the columns of a design.
///
/// Its statistic is the ratio of the sums of squares that generalised and ordinary least squares leave.
pub fn of_covariance(design: &Mat<f64>, covariance: &Mat<f64>, level: f64) -> Option<f64> {
    let n = design.nrows();
    let left = |inverse: &Mat<f64>| -> Option<Mat<f64>> {
        let weighted = inverse * design;
        let normal = design.transpose() * &weighted;
        Some(inverse - &weighted * normal.llt(Side::Lower).ok()?.solve(weighted.transpose()))
    };
    let factor = covariance.llt(Side::Lower).ok()?;
    let (general, ordinary) = (left(&factor.solve(Mat::<f64>::identity(n, n)))?, left(&Mat::identity(n, n))?);
    let ratios = |l: &dyn Fn(&Mat<f64>) -> Mat<f64>, stream: u128| -> Vec<f64> {
        let mut rng = Pcg64::new(1, stream);
        let of = |a: &Mat<f64>, e: &Mat<f64>| (e.transpose() * (a * e))[(0, 0)];
        let mut out: Vec<f64> = (0..DRAWS)
            .map(|_| l(&Mat::from_fn(n, 1, |_, _| normal(&mut rng))))
            .map(|e| of(&general, &e) / of(&ordinary, &e))
            .collect();
        out.sort_by(f64::total_cmp);
        out
    };
    let sound = ratios(&|z| z.clone(), 4001);
    let faulty = ratios(&|z| factor.L() * z, 4002);
    let passes = sound[(level * DRAWS as f64) as usize];
    Some(faulty.iter().filter(|ratio| **ratio < passes).count() as f64 / DRAWS as f64)
}
