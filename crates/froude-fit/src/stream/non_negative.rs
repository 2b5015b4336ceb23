//! Least squares with some coefficients held at zero or above.

use super::reference::least_squares;
use super::{Factor, StreamError};

/// The fit under bounds at zero.
#[derive(Debug, Clone, PartialEq)]
pub struct NonNegative {
    /// The coefficients; those at the bound are exactly zero.
    pub coefficients: Vec<f64>,
    /// True where the bound holds the coefficient at zero.
    pub is_at_bound: Vec<bool>,
    /// Sum of squared residuals.
    pub residual_squares: f64,
    /// Changes of the active set.
    pub iterations: usize,
}

impl Factor {
    /// Least squares of response `k` with `β_j ≥ 0` wherever `is_bounded[j]`.
    ///
    /// The triangle is a `p × p` problem with the same minimiser as the `n × p` one,
    /// so the rows are not needed again. Each step solves it on the free columns by
    /// Householder QR.
    ///
    /// # Errors
    ///
    /// Those of [`Factor::solve`], [`StreamError::Shape`] when `is_bounded` is not `p`
    /// long, and [`StreamError::NotConverged`] (never seen).
    ///
    /// # Source
    ///
    /// Lawson & Hanson (1974), *Solving Least Squares Problems*, chapter 23.
    pub fn solve_non_negative(&self, k: usize, is_bounded: &[bool]) -> Result<NonNegative, StreamError> {
        self.check_response(k)?;
        let p = self.shape.regressors;
        if is_bounded.len() != p {
            return Err(StreamError::Shape { what: "bounds", found: is_bounded.len(), expected: p });
        }
        self.check_determined()?;
        let lengths = self.column_lengths();
        let target: Vec<f64> = (0..p).map(|i| self.entry(i, p + k)).collect();
        let size = target.iter().map(|d| d * d).sum::<f64>().sqrt();
        // A gradient below the rounding of its own sum is zero.
        let zero = 10.0 * p as f64 * f64::EPSILON * size;

        let mut is_free: Vec<bool> = is_bounded.iter().map(|bounded| !bounded).collect();
        let mut beta = vec![0.0; p];
        self.minimise_on(&is_free, &target, &mut beta);
        let limit = 30 * (p + 1);
        let mut iterations = 0;
        let mut refused = vec![false; p];
        loop {
            let gradient = self.gradient(&target, &beta);
            let steepest = (0..p)
                .filter(|&j| !is_free[j] && !refused[j] && gradient[j] > zero * lengths[j])
                .max_by(|&a, &b| (gradient[a] / lengths[a]).total_cmp(&(gradient[b] / lengths[b])));
            let Some(entering) = steepest else { break };
            is_free[entering] = true;
            let mut trial = vec![0.0; p];
            self.minimise_on(&is_free, &target, &mut trial);
            if trial[entering] <= 0.0 {
                // The gradient was rounding: leave it at the bound.
                is_free[entering] = false;
                refused[entering] = true;
                continue;
            }
            refused.fill(false);
            loop {
                iterations += 1;
                if iterations > limit {
                    return Err(StreamError::NotConverged { iterations });
                }
                // Go towards the trial until the first coefficient meets zero.
                let first = (0..p)
                    .filter(|&j| is_free[j] && is_bounded[j] && trial[j] <= 0.0)
                    .map(|j| (beta[j] / (beta[j] - trial[j]), j))
                    .min_by(|a, b| a.0.total_cmp(&b.0));
                let Some((step, leaving)) = first else {
                    beta = trial;
                    break;
                };
                for j in 0..p {
                    beta[j] += step * (trial[j] - beta[j]);
                    if is_bounded[j] && is_free[j] && (j == leaving || beta[j] <= 0.0) {
                        is_free[j] = false;
                        beta[j] = 0.0;
                    }
                }
                trial.fill(0.0);
                self.minimise_on(&is_free, &target, &mut trial);
            }
        }
        let misfit: f64 = (0..p)
            .map(|i| {
                let fitted: f64 = (i..p).map(|j| self.entry(i, j) * beta[j]).sum();
                (target[i] - fitted).powi(2)
            })
            .sum();
        Ok(NonNegative {
            coefficients: beta,
            is_at_bound: is_free.iter().map(|free| !free).collect(),
            residual_squares: self.residual_squares(k) + misfit,
            iterations,
        })
    }

    /// `Rᵀ(d − Rβ)`: half the descent of the squares along each coefficient.
    fn gradient(&self, target: &[f64], beta: &[f64]) -> Vec<f64> {
        let p = beta.len();
        let residual: Vec<f64> =
            (0..p).map(|i| target[i] - (i..p).map(|j| self.entry(i, j) * beta[j]).sum::<f64>()).collect();
        (0..p).map(|j| (0..=j).map(|i| self.entry(i, j) * residual[i]).sum()).collect()
    }

    /// Least squares on the free columns; the other coefficients become zero.
    fn minimise_on(&self, is_free: &[bool], target: &[f64], beta: &mut [f64]) {
        let p = beta.len();
        let free: Vec<usize> = (0..p).filter(|&j| is_free[j]).collect();
        let mut matrix = Vec::with_capacity(p * (free.len() + 1));
        for (i, d) in target.iter().enumerate() {
            matrix.extend(free.iter().map(|&j| self.entry(i, j)));
            matrix.push(*d);
        }
        beta.fill(0.0);
        for (j, value) in free.iter().zip(least_squares(&mut matrix, p, free.len())) {
            beta[*j] = value;
        }
    }
}
