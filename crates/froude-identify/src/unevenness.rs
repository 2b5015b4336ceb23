//! Whether residuals are as large at all speeds.

use crate::dataset::Dataset;
use crate::regression::ModelFit;

/// Rank correlation of |residual| with speed that calls the scatter uneven, in standard errors.
const UNEVEN_ABOVE_Z: f64 = 2.0;
/// Fewest observations from which the error model is judged.
pub const FEWEST_FOR_SCATTER: usize = 8;

/// How |residual| goes with speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unevenness {
    /// Spearman's rank correlation.
    pub rho: f64,
    /// The same in standard errors, 1/√(n − 1).
    pub z: f64,
}

impl Unevenness {
    /// Of sizes of residuals and speeds, as many of both.
    pub(crate) fn of(size: &[f64], speed: &[f64]) -> Self {
        let rho = rank_correlation(size, speed);
        Self { rho, z: rho * ((size.len() - 1) as f64).sqrt() }
    }

    /// True where equal errors are not what the residuals show.
    #[must_use]
    pub fn contradicts(self) -> bool {
        self.z.abs() > UNEVEN_ABOVE_Z
    }
}

/// Rank correlation of the residuals of a load with speed; `None` below [`FEWEST_FOR_SCATTER`] rows.
///
/// With std columns a row may scatter as much as they say: what must be even is r·√w.
///
/// ρ is Spearman's rank correlation of |r|·√w with |U|, dimensionless; z = ρ·√(n − 1) is ρ in standard errors of an uncorrelated sample.
#[must_use]
pub fn unevenness(model: &ModelFit, data: &Dataset, load: &str) -> Option<Unevenness> {
    let n = data.rows;
    let speed = data.values("speed").filter(|_| n >= FEWEST_FOR_SCATTER)?;
    let r = model.law.responses.iter().position(|name| name == load)?;
    let weight = |row: usize| model.problem.weight.as_ref().map_or(1.0, |w| w[row]);
    let rows: Vec<usize> = (0..n).filter(|&i| data.observes(load, i)).collect();
    let size: Vec<f64> =
        rows.iter().map(|&i| model.fit.residuals[r * n + i].abs() * weight(r * n + i).sqrt()).collect();
    let speed: Vec<f64> = rows.iter().map(|&i| speed[i].abs()).collect();
    if rows.len() < FEWEST_FOR_SCATTER {
        return None;
    }
    Some(Unevenness::of(&size, &speed))
}

/// Spearman's rank correlation, −1 to 1, with average ranks for ties; 0 where one of them is constant.
///
/// `a` and `b` have the same length, in any units.
#[must_use]
pub fn rank_correlation(a: &[f64], b: &[f64]) -> f64 {
    let ranks = |v: &[f64]| -> Vec<f64> {
        let mut order: Vec<usize> = (0..v.len()).collect();
        order.sort_by(|&i, &j| v[i].total_cmp(&v[j]));
        let mut out = vec![0.0; v.len()];
        let mut start = 0;
        while start < order.len() {
            let mut end = start;
            while end + 1 < order.len() && v[order[end + 1]] == v[order[start]] {
                end += 1;
            }
            for &i in &order[start..=end] {
                out[i] = 0.5 * (start + end) as f64;
            }
            start = end + 1;
        }
        out
    };
    let (x, y) = (ranks(a), ranks(b));
    let mean = (a.len() as f64 - 1.0) / 2.0;
    let sxy: f64 = x.iter().zip(&y).map(|(p, q)| (p - mean) * (q - mean)).sum();
    let sxx: f64 = x.iter().map(|p| (p - mean).powi(2)).sum();
    let syy: f64 = y.iter().map(|q| (q - mean).powi(2)).sum();
    if sxx > 0.0 && syy > 0.0 { sxy / (sxx * syy).sqrt() } else { 0.0 }
}
