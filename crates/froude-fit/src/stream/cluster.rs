//! What a cluster-robust covariance needs of its rows, from one pass: a triangle for each cluster.

use std::collections::BTreeMap;

use super::in_memory::columns_of;
use super::{Accumulator, Factor, Shape, StreamError, check_count, check_finite, check_lengths};

/// Rows taken in chunk after chunk, each row in a cluster (a run, a stretch of time).
///
/// Keeps one triangle of `(p+q)²` numbers for each cluster. Any order of rows is
/// right; it is fast when a cluster's rows come together, since each change of
/// cluster costs a few microseconds.
#[derive(Debug)]
pub struct ClusterAccumulator {
    shape: Shape,
    limit: usize,
    current: Option<u64>,
    rows: Accumulator,
    factors: BTreeMap<u64, Factor>,
    taken: u64,
}

impl ClusterAccumulator {
    /// An accumulator without rows, for at most `limit` clusters.
    ///
    /// It takes at most `8·(p+q)²·limit` bytes.
    #[must_use]
    pub fn new(shape: Shape, limit: usize) -> Self {
        Self { shape, limit, current: None, rows: Accumulator::new(shape), factors: BTreeMap::new(), taken: 0 }
    }

    /// Takes a chunk of rows: each regressor, then each response, as a column, and the
    /// cluster of every row.
    ///
    /// # Errors
    ///
    /// Those of [`Accumulator::push`], and [`StreamError::Refused`] of too many clusters.
    pub fn push(&mut self, clusters: &[u64], regressors: &[&[f64]], responses: &[&[f64]]) -> Result<(), StreamError> {
        let columns = columns_of(self.shape, regressors, responses)?;
        let rows = check_lengths(&columns)?;
        check_count("clusters of rows", clusters.len(), rows)?;
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
        let Some(cluster) = self.current.take() else { return Ok(()) };
        let factor = self.rows.flush();
        if let Some(known) = self.factors.get_mut(&cluster) {
            return known.merge(&factor);
        }
        if self.factors.len() >= self.limit {
            return Err(StreamError::Refused(format!(
                "cluster {cluster} is one more than the limit of {}: each keeps a triangle of its own; raise the limit, or use longer clusters",
                self.limit
            )));
        }
        self.factors.insert(cluster, factor);
        Ok(())
    }

    /// The clusters and the triangles of their rows.
    ///
    /// # Errors
    ///
    /// [`StreamError::Refused`]: too many clusters.
    pub fn finish(mut self) -> Result<BTreeMap<u64, Factor>, StreamError> {
        self.close()?;
        Ok(self.factors)
    }
}
