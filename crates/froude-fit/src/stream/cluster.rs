//! Cluster-robust covariance from one pass: a triangle for each cluster.

use std::collections::BTreeMap;

use faer::Mat;
use faer::prelude::*;

use super::in_memory::columns_of;
use super::{Accumulator, Factor, Shape, StreamError, check_finite, check_lengths};

/// Fewest clusters for which a cluster-robust covariance is given.
const FEWEST_CLUSTERS: usize = 5;

/// Which cluster-robust covariance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClusterKind {
    /// Scores as they are, times `G/(G−1)·(n−1)/(n−p)`: too small with few clusters.
    Cr1,
    /// The cluster jackknife: `(G−1)/G` times the sum over clusters of what leaving
    /// each out does to the coefficients, squared.
    Cr3,
}

/// Rows taken in chunk after chunk, each row in a cluster (a run, a stretch of time).
///
/// Keeps one triangle of `(p+q)²` numbers for each cluster. Any order of rows is
/// right; it is fast when a cluster's rows come together, since each change of
/// cluster costs a few microseconds.
#[derive(Debug)]
pub struct ClusterAccumulator {
    current: Option<u64>,
    pub(super) rows: Accumulator,
    factors: ClusterFactors,
    taken: u64,
}

impl ClusterAccumulator {
    /// An accumulator without rows, for at most `limit` clusters.
    ///
    /// It takes at most `8·(p+q)²·limit` bytes.
    #[must_use]
    pub fn new(shape: Shape, limit: usize) -> Self {
        Self {
            current: None,
            rows: Accumulator::new(shape),
            factors: ClusterFactors { shape, limit, by_cluster: BTreeMap::new() },
            taken: 0,
        }
    }

    /// Takes a chunk of rows: each regressor, then each response, as a column, and the
    /// cluster of every row.
    ///
    /// # Errors
    ///
    /// Those of [`Accumulator::push`], and [`StreamError::TooManyClusters`].
    pub fn push(&mut self, clusters: &[u64], regressors: &[&[f64]], responses: &[&[f64]]) -> Result<(), StreamError> {
        let columns = columns_of(self.factors.shape, regressors, responses)?;
        let rows = check_lengths(&columns)?;
        if clusters.len() != rows {
            return Err(StreamError::Shape { what: "clusters of rows", found: clusters.len(), expected: rows });
        }
        check_finite(&columns, 0..rows, self.taken)?;
        let mut start = 0;
        for run in clusters.chunk_by(|a, b| a == b) {
            if self.current != Some(run[0]) {
                self.close()?;
                self.current = Some(run[0]);
            }
            self.rows.take(&columns, start..start + run.len());
            start += run.len();
        }
        self.taken += rows as u64;
        Ok(())
    }

    fn close(&mut self) -> Result<(), StreamError> {
        match self.current.take() {
            None => Ok(()),
            Some(cluster) => self.factors.add(cluster, &self.rows.flush()),
        }
    }

    /// The triangles of all clusters.
    ///
    /// # Errors
    ///
    /// [`StreamError::TooManyClusters`].
    pub fn finish(mut self) -> Result<ClusterFactors, StreamError> {
        self.close()?;
        Ok(self.factors)
    }
}

/// A triangle for each cluster.
#[derive(Debug, Clone, PartialEq)]
pub struct ClusterFactors {
    pub(super) shape: Shape,
    limit: usize,
    by_cluster: BTreeMap<u64, Factor>,
}

impl ClusterFactors {
    /// How many clusters have rows.
    #[must_use]
    pub fn count(&self) -> usize {
        self.by_cluster.len()
    }

    /// The clusters and their factors, in order of cluster.
    pub fn iter(&self) -> impl Iterator<Item = (u64, &Factor)> {
        self.by_cluster.iter().map(|(&cluster, factor)| (cluster, factor))
    }

    /// Takes in rows of one cluster.
    fn add(&mut self, cluster: u64, factor: &Factor) -> Result<(), StreamError> {
        if let Some(known) = self.by_cluster.get_mut(&cluster) {
            return known.merge(factor);
        }
        if self.by_cluster.len() >= self.limit {
            return Err(StreamError::TooManyClusters { cluster, limit: self.limit });
        }
        self.by_cluster.insert(cluster, factor.clone());
        Ok(())
    }

    /// Takes in the clusters of other rows; a cluster may be in both.
    ///
    /// # Errors
    ///
    /// [`StreamError::Merge`] when the shapes differ, [`StreamError::TooManyClusters`].
    pub fn merge(&mut self, other: &Self) -> Result<(), StreamError> {
        if self.shape != other.shape {
            return Err(StreamError::Merge { found: other.shape, expected: self.shape });
        }
        other.iter().try_for_each(|(cluster, factor)| self.add(cluster, factor))
    }

    /// The factor of all rows, clusters merged in order.
    ///
    /// # Errors
    ///
    /// Never, in practice: all shapes are equal.
    pub fn total(&self) -> Result<Factor, StreamError> {
        let mut total = Factor::empty(self.shape);
        for factor in self.by_cluster.values() {
            total.merge(factor)?;
        }
        Ok(total)
    }

    /// Cluster-robust covariance of the coefficients of response `k`, `p × p`.
    ///
    /// With `R` the triangle of all rows and `R_g` that of cluster `g`, the cluster's
    /// score in the orthonormal basis is `s_g = A_gᵀ(d_g − R_g β)`, `A_g = R_g R⁻¹`; CR3
    /// puts `(I − A_gᵀA_g)⁻¹ s_g` in its place, which is exactly what `(I − H_gg)⁻¹` on
    /// the residuals gives. Covariance `c·R⁻¹ (Σ s_g s_gᵀ) R⁻ᵀ` with `c` as in [`ClusterKind`].
    ///
    /// # Errors
    ///
    /// Those of [`Factor::solve`]; [`StreamError::TooFewClusters`] below five;
    /// [`StreamError::ClusterDecides`] (CR3) when one cluster alone determines a
    /// coefficient.
    ///
    /// # Source
    ///
    /// Bell & McCaffrey (2002), Survey Methodology 28, 169; CV1 and CV3 of MacKinnon,
    /// Nielsen & Webb (2023), J. Econometrics 232, 272.
    pub fn covariance(&self, k: usize, kind: ClusterKind) -> Result<ClusterCovariance, StreamError> {
        let clusters = self.count();
        if clusters < FEWEST_CLUSTERS {
            return Err(StreamError::TooFewClusters { found: clusters, needed: FEWEST_CLUSTERS });
        }
        let total = self.total()?;
        let solution = total.solve(k)?;
        let p = self.shape.regressors;
        let inverse = total.inverse();
        let mut meat = Mat::<f64>::zeros(p, p);
        for (cluster, factor) in self.iter() {
            let whitened = factor.times_upper(&inverse);
            let residual = factor.residual(k, &solution.coefficients);
            let mut score = whitened.transpose() * &residual;
            if kind == ClusterKind::Cr3 {
                let rest = Mat::<f64>::identity(p, p) - whitened.transpose() * &whitened;
                // I − A_gᵀA_g is what the other clusters know, in the orthonormal basis.
                let known = rest.self_adjoint_eigenvalues(faer::Side::Lower);
                let least = known.ok().and_then(|values| values.first().copied());
                if least.is_none_or(|least| least < 1e3 * p as f64 * f64::EPSILON) {
                    return Err(StreamError::ClusterDecides { cluster });
                }
                let Ok(cholesky) = rest.llt(faer::Side::Lower) else {
                    return Err(StreamError::ClusterDecides { cluster });
                };
                cholesky.solve_in_place(&mut score);
            }
            meat += &score * score.transpose();
        }
        let (g, n) = (clusters as f64, total.rows() as f64);
        let factor = match kind {
            ClusterKind::Cr1 => g / (g - 1.0) * (n - 1.0) / (n - p as f64),
            ClusterKind::Cr3 => (g - 1.0) / g,
        };
        let covariance = faer::Scale(factor) * (&inverse * &meat * inverse.transpose());
        Ok(ClusterCovariance {
            standard: (0..p).map(|j| covariance[(j, j)].sqrt()).collect(),
            covariance,
            coefficients: solution.coefficients,
            dof: g - 1.0,
            clusters,
        })
    }
}

impl Factor {
    /// `R_g·U` for an upper triangular `U`, `p × p`: what the cluster's rows give.
    ///
    /// The rows of `R_g` below `p` are zero in these columns.
    fn times_upper(&self, upper: &Mat<f64>) -> Mat<f64> {
        let p = self.shape.regressors;
        Mat::from_fn(p, p, |i, j| (i..=j).map(|l| self.entry(i, l) * upper[(l, j)]).sum())
    }

    /// `d_g − R_g β`, the first `p` entries: the rest is orthogonal to the regressors.
    fn residual(&self, k: usize, beta: &[f64]) -> Mat<f64> {
        let p = self.shape.regressors;
        Mat::from_fn(p, 1, |i, _| {
            let fitted: f64 = (i..p).map(|j| self.entry(i, j) * beta[j]).sum();
            self.entry(i, p + k) - fitted
        })
    }
}

/// A cluster-robust covariance.
#[derive(Debug, Clone)]
pub struct ClusterCovariance {
    /// The coefficients, in the order of the regressors.
    pub coefficients: Vec<f64>,
    /// Their cluster-robust standard uncertainties.
    pub standard: Vec<f64>,
    /// Their covariance, `p × p`.
    pub covariance: Mat<f64>,
    /// Degrees of freedom of the t-interval, `G − 1`.
    pub dof: f64,
    /// How many clusters there are, `G`.
    pub clusters: usize,
}
