//! Whitened residuals of one component, with the basis of what was fitted to them: what exact tests of independence and of equal variances need.

use faer::Mat;

use crate::dense::{dot, mul_vec, row, tr_mul_vec};
use crate::options::{Options, Prior};
use crate::outcome::Fit;
use crate::problem::Problem;
use crate::rank::PivotedQr;

/// Residuals of the rows of one component, over σ and times √w: of unit variance where the model holds.
#[derive(Debug, Clone)]
pub struct Residuals {
    /// Rows of the problem.
    pub rows: Vec<usize>,
    /// Whitened residuals of the fit without bounds and inequalities.
    pub residual: Vec<f64>,
    /// Their lines of an orthonormal basis of what was fitted, rows × rank.
    pub q: Mat<f64>,
}

impl Residuals {
    /// Of every component, with σ of the fit; empty for condensed rows.
    #[must_use]
    pub fn of(problem: &Problem, options: &Options, fit: &Fit) -> Vec<Self> {
        let sigma: Vec<f64> = fit.components.iter().map(|c| c.sigma.filter(|s| *s > 0.0).unwrap_or(1.0)).collect();
        Self::with(problem, options, &sigma)
    }

    /// The same with σ of each component; 1 where the rows are whitened already.
    #[must_use]
    pub fn with(problem: &Problem, options: &Options, sigma: &[f64]) -> Vec<Self> {
        if !options.observations.is_empty() {
            return Vec::new();
        }
        let n = problem.n_rows();
        let is_held = |j: &usize| options.excluded.contains(j) || options.fixed.iter().any(|(k, _)| k == j);
        let free: Vec<usize> = (0..problem.n_coefficients()).filter(|j| !is_held(j)).collect();
        let factor = |i: usize| problem.weight_of(i).sqrt() / sigma[problem.component[i]];
        let priors = &options.priors;
        let design = Mat::from_fn(n + priors.len(), free.len(), |i, k| match priors.get(i.wrapping_sub(n)) {
            Some(prior) => {
                let slope = prior.with.iter().find(|(j, _)| *j == free[k]).map_or(0.0, |(_, slope)| *slope);
                (f64::from(u8::from(prior.index == free[k])) - slope) / prior.standard
            }
            None => problem.design[(i, free[k])] * factor(i),
        });
        let of_held = |i: usize| options.fixed.iter().map(|&(j, value)| problem.design[(i, j)] * value).sum::<f64>();
        let mut response: Vec<f64> = (0..n).map(|i| (problem.response[i] - of_held(i)) * factor(i)).collect();
        let held = |j: usize| options.fixed.iter().find(|(k, _)| *k == j).map_or(0.0, |(_, value)| *value);
        let known = |prior: &Prior| prior.with.iter().map(|(j, slope)| slope * held(*j)).sum::<f64>();
        response.extend(priors.iter().map(|prior| (prior.value + known(prior)) / prior.standard));
        let qr = PivotedQr::new(design.as_ref());
        let onto = mul_vec(qr.q.as_ref(), &tr_mul_vec(qr.q.as_ref(), &response));
        (0..problem.components.len())
            .map(|c| {
                let rows = problem.rows_of(c);
                Self {
                    residual: rows.iter().map(|&i| response[i] - onto[i]).collect(),
                    q: Mat::from_fn(rows.len(), qr.rank, |i, k| qr.q[(rows[i], k)]),
                    rows,
                }
            })
            .collect()
    }

    /// Leverage of each row.
    #[must_use]
    pub fn leverage(&self) -> Vec<f64> {
        (0..self.rows.len()).map(|i| row(self.q.as_ref(), i)).map(|q| dot(&q, &q)).collect()
    }
}
