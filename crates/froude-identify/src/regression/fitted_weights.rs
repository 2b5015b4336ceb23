//! Weights from a variance that is fitted to the residuals: σ² = a + b f², f the fitted load.
//!
//! A transducer errs by a part of its range and by a part of what it shows. The squares of the residuals over 1 − h have that mean; a and b, neither below zero, are fitted to
//! them as to numbers whose deviation goes with their mean (a χ² of one degree of freedom), and the loads again with the weights 1/σ². What the model of the variance misses is
//! left to HC3 with degrees of freedom of its own: an interval never stands on a and b.
//!
//! # Source
//!
//! Carroll & Ruppert (1988), *Transformation and Weighting in Regression*, 2 and 3; Romano & Wolf (2017), J. Econometrics 197, 1: weighted least squares with HC variances.

use froude_fit as fit;
use froude_fit::faer::Mat;

/// Rounds of weights and fits.
pub(crate) const ROUNDS: usize = 3;
/// Steps of the variance's own fit.
const STEPS: usize = 30;
/// Least variance, as part of the mean one: a row without error would decide everything.
const LEAST: f64 = 1e-3;

/// A weight for each row that is an observation, of mean one within its load; `None` where a load has no scatter.
pub(crate) fn weights(problem: &fit::Problem, fitted: &fit::Fit) -> Option<Vec<f64>> {
    let mut out = vec![0.0; problem.n_rows()];
    for c in 0..problem.components.len() {
        let rows = problem.rows_of(c);
        let square = |i: usize| fitted.residuals[i].powi(2) / (1.0 - fitted.leverage[i]).max(LEAST);
        let squares: Vec<f64> = rows.iter().map(|&i| square(i)).collect();
        let loads: Vec<f64> = rows.iter().map(|&i| fitted.fitted[i].powi(2)).collect();
        let of_load = Variance::of(&squares, &loads)?;
        let variance: Vec<f64> = loads.iter().map(|f| of_load.at(*f)).collect();
        let mean = variance.iter().map(|v| 1.0 / v).sum::<f64>() / rows.len() as f64;
        for (&i, v) in rows.iter().zip(&variance) {
            out[i] = 1.0 / (v * mean);
        }
    }
    Some(out)
}

/// The variance of a row, a + b f², and no less than a part of the mean one.
pub(crate) struct Variance {
    a: f64,
    b: f64,
    least: f64,
}

impl Variance {
    /// At the square of a fitted load.
    pub(crate) fn at(&self, load: f64) -> f64 {
        (self.a + self.b * load).max(self.least)
    }

    /// From squares of residuals and of fitted loads; `None` where there is no scatter.
    pub(crate) fn of(squares: &[f64], loads: &[f64]) -> Option<Self> {
        let n = squares.len() as f64;
        let mean = squares.iter().sum::<f64>() / n;
        if !(mean > 0.0 && mean.is_finite()) {
            return None;
        }
        let size = (loads.iter().sum::<f64>() / n).max(f64::MIN_POSITIVE);
        let design = Mat::from_fn(squares.len(), 2, |i, j| if j == 0 { 1.0 } else { loads[i] / size });
        let mut out = Self { a: mean, b: 0.0, least: LEAST * mean };
        let mut variance = vec![mean; squares.len()];
        let options = fit::Options { bounds: vec![fit::Bound::NON_NEGATIVE; 2], ..fit::Options::default() };
        for _ in 0..STEPS {
            let problem = fit::Problem {
                weight: Some(variance.iter().map(|v| (mean / v).powi(2)).collect()),
                ..fit::Problem::single(design.clone(), squares.to_vec(), vec!["a".to_owned(), "b".to_owned()])
            };
            let found = fit::fit(&problem, &options).ok()?;
            let [a, b] = [0, 1].map(|k| found.coefficients[k].value.unwrap_or(0.0));
            out = Self { a, b: b / size, ..out };
            let next: Vec<f64> = loads.iter().map(|f| out.at(*f)).collect();
            let change = next.iter().zip(&variance).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
            variance = next;
            if change < 1e-4 {
                break;
            }
        }
        Some(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares that are their own mean: a and b come back.
    #[test]
    fn a_variance_without_scatter_is_found() {
        let loads: Vec<f64> = (1..30).map(|i| f64::from(i * i)).collect();
        let squares: Vec<f64> = loads.iter().map(|f| 0.5 + 0.02 * f).collect();
        let found = Variance::of(&squares, &loads).unwrap();
        for (load, expected) in loads.iter().zip(&squares) {
            assert!((found.at(*load) / expected - 1.0).abs() < 1e-6, "{} {expected}", found.at(*load));
        }
        assert!(Variance::of(&[0.0; 4], &[1.0; 4]).is_none());
    }
}
