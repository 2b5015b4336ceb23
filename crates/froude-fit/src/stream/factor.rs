//! The triangle of a least-squares problem, and what is solved from it.

use faer::Mat;

use super::Shape;
use super::error::StreamError;
use super::folder::Folder;

/// The triangle of `[X | Y]`: all that a least-squares fit needs of its rows.
///
/// `triangle` is `width × width`, row-major, zero below the diagonal, with
/// `RᵀR = [X | Y]ᵀ[X | Y]` up to rounding. Diagonal signs are arbitrary.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    pub(super) shape: Shape,
    pub(super) rows: u64,
    pub(super) triangle: Vec<f64>,
}

impl Factor {
    /// The factor of no rows.
    #[must_use]
    pub fn empty(shape: Shape) -> Self {
        Self { shape, rows: 0, triangle: vec![0.0; shape.width() * shape.width()] }
    }

    /// Numbers of columns.
    #[must_use]
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// Rows that went in.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Entry `(i, j)` of the triangle; column `regressors + k` belongs to response `k`.
    ///
    /// The `p × p` part and the response's first `p` entries are a small problem with
    /// the same minimiser as the large one, under any constraint and prior.
    #[must_use]
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        self.triangle[i * self.shape.width() + j]
    }

    /// Takes in the rows of another factor.
    ///
    /// # Errors
    ///
    /// [`StreamError::Refused`] when the shapes differ.
    pub fn merge(&mut self, other: &Self) -> Result<(), StreamError> {
        if self.shape != other.shape {
            return Err(StreamError::Refused(format!(
                "a factor of shape {:?} cannot be merged into one of {:?}",
                other.shape, self.shape
            )));
        }
        Folder::new(self.shape).fold_triangle(&mut self.triangle, &other.triangle);
        self.rows += other.rows;
        Ok(())
    }

    /// Sum of squared residuals of the unconstrained fit of response `k`.
    #[must_use]
    pub fn residual_squares(&self, k: usize) -> f64 {
        let p = self.shape.regressors;
        (p..self.shape.width()).map(|i| self.entry(i, p + k).powi(2)).sum()
    }

    /// Condition number, and the regressor with the largest part in the weakest direction.
    fn conditioning(&self) -> (f64, usize) {
        let p = self.shape.regressors;
        if p == 0 {
            return (1.0, 0);
        }
        let lengths = self.column_lengths();
        if let Some(zero) = lengths.iter().position(|&length| length == 0.0) {
            return (f64::INFINITY, zero);
        }
        let scaled = Mat::from_fn(p, p, |i, j| self.entry(i, j) / lengths[j]);
        let Ok(svd) = scaled.svd() else {
            return (f64::INFINITY, 0);
        };
        let singular = svd.S().column_vector();
        let (largest, smallest) = (singular[0], singular[p - 1]);
        let weakest = svd.V().col(p - 1);
        let column = (0..p).max_by(|&a, &b| weakest[a].abs().total_cmp(&weakest[b].abs())).unwrap_or(0);
        (largest / smallest, column)
    }

    /// Euclidean length of each regressor.
    fn column_lengths(&self) -> Vec<f64> {
        (0..self.shape.regressors).map(|j| (0..=j).map(|i| self.entry(i, j).powi(2)).sum::<f64>().sqrt()).collect()
    }

    fn check_response(&self, response: usize) -> Result<(), StreamError> {
        let responses = self.shape.responses;
        if response < responses {
            return Ok(());
        }
        Err(StreamError::Refused(format!("response {response} is asked for, but there are {responses}")))
    }

    /// Refuses a design that does not determine all its coefficients.
    fn check_determined(&self) -> Result<f64, StreamError> {
        let p = self.shape.regressors;
        if self.rows <= p as u64 {
            let rows = self.rows;
            let problem = format!("{rows} rows do not determine {p} coefficients and their scatter");
            return Err(StreamError::Refused(problem));
        }
        let (condition_number, column) = self.conditioning();
        // Rounding alone gives parallel columns a condition number of about 1/(p·ε).
        if condition_number < 0.1 / (p.max(1) as f64 * f64::EPSILON) {
            return Ok(condition_number);
        }
        Err(StreamError::Refused(format!(
            "the data do not determine coefficient {column}: its regressor is a combination of the others (condition number \
             {condition_number:.1e}); leave one out, or add data that excite it"
        )))
    }

    /// `R⁻¹` of the design, `p × p`, upper triangular.
    fn inverse(&self) -> Mat<f64> {
        let p = self.shape.regressors;
        let mut inverse = Mat::zeros(p, p);
        for j in 0..p {
            for i in (0..=j).rev() {
                let below: f64 = (i + 1..=j).map(|l| self.entry(i, l) * inverse[(l, j)]).sum();
                inverse[(i, j)] = (f64::from(u8::from(i == j)) - below) / self.entry(i, i);
            }
        }
        inverse
    }

    /// Back substitution: the minimiser for response `k`.
    fn minimiser(&self, k: usize) -> Vec<f64> {
        let p = self.shape.regressors;
        let mut beta = vec![0.0; p];
        for i in (0..p).rev() {
            let right: f64 = (i + 1..p).map(|j| self.entry(i, j) * beta[j]).sum();
            beta[i] = (self.entry(i, p + k) - right) / self.entry(i, i);
        }
        beta
    }

    /// Ordinary least squares of response `k`, with classical covariance.
    ///
    /// # Errors
    ///
    /// [`StreamError::Refused`]: no such response, no degree of freedom left, or parallel
    /// regressors.
    pub fn solve(&self, k: usize) -> Result<Solution, StreamError> {
        self.check_response(k)?;
        let condition_number = self.check_determined()?;
        let p = self.shape.regressors;
        let squares = self.residual_squares(k);
        let dof = self.rows as f64 - p as f64;
        let variance = squares / dof;
        let inverse = self.inverse();
        let covariance = Mat::from_fn(p, p, |i, j| {
            let shared: f64 = (i.max(j)..p).map(|l| inverse[(i, l)] * inverse[(j, l)]).sum();
            variance * shared
        });
        Ok(Solution {
            coefficients: self.minimiser(k),
            standard: (0..p).map(|j| covariance[(j, j)].sqrt()).collect(),
            covariance,
            sigma: variance.sqrt(),
            dof,
            residual_squares: squares,
            condition_number,
        })
    }
}

/// Ordinary least squares of one response.
#[derive(Debug, Clone)]
pub struct Solution {
    /// The coefficients, in the order of the regressors.
    pub coefficients: Vec<f64>,
    /// Their classical standard uncertainties.
    pub standard: Vec<f64>,
    /// Classical covariance σ²(XᵀX)⁻¹, `p × p`.
    pub covariance: Mat<f64>,
    /// Standard deviation of the residuals, `n − p` degrees of freedom.
    pub sigma: f64,
    /// Degrees of freedom, `n − p`.
    pub dof: f64,
    /// Sum of squared residuals.
    pub residual_squares: f64,
    /// Condition number of the design, its columns scaled to equal length.
    pub condition_number: f64,
}
