//! Columns in memory, factored segment by segment on several threads.

use std::ops::Range;

use rayon::prelude::*;

use super::error::StreamError;
use super::factor::Factor;
use super::folder::Folder;
use super::kernel::Ahead;
use super::{Shape, check_count, check_finite, check_lengths};

/// How many blocks before its turn a block is asked for.
const BLOCKS_AHEAD: usize = 4;

/// Reduces columns in memory, on the threads of the current `rayon` pool.
///
/// `regressors` and `responses` are columns of equal length. The result does not
/// depend on the number of threads; it is that of
/// [`Accumulator`](super::Accumulator), bit for bit.
///
/// # Errors
///
/// [`StreamError::Refused`] of columns of other lengths, and [`StreamError::NotFinite`] with the first bad entry.
pub fn reduce_columns(regressors: &[&[f64]], responses: &[&[f64]]) -> Result<Factor, StreamError> {
    let shape = Shape { regressors: regressors.len(), responses: responses.len() };
    let columns = columns_of(shape, regressors, responses)?;
    let n = check_lengths(&columns)?;
    InMemory { shape, n, columns: &columns }.reduce()
}

/// Columns in memory, cut into segments of rows that are factored by themselves.
struct InMemory<'a> {
    pub(super) shape: Shape,
    n: usize,
    columns: &'a [&'a [f64]],
}

impl InMemory<'_> {
    fn rows_of(&self, segment: usize) -> Range<usize> {
        let start = segment * self.shape.segment_rows();
        start..self.n.min(start + self.shape.segment_rows())
    }

    /// The rows of every block of a segment, in order.
    fn blocks(&self, segment: usize) -> impl Iterator<Item = Range<usize>> {
        let (rows, step) = (self.rows_of(segment), self.shape.block_rows());
        let end = rows.end;
        rows.step_by(step).map(move |start| start..end.min(start + step))
    }

    /// What is needed some blocks after `rows`: near enough to be still in the cache then, far enough
    /// to have arrived.
    fn ahead(&self, rows: &Range<usize>) -> Ahead<'_> {
        let on = BLOCKS_AHEAD * self.shape.block_rows();
        Ahead::new(self.columns, self.n.min(rows.start + on)..self.n.min(rows.end + on))
    }

    /// Writes rows into the folder's block.
    fn fill(&self, folder: &mut Folder, rows: &Range<usize>) {
        for (j, column) in self.columns.iter().enumerate() {
            folder.put(j, 0, &column[rows.clone()]);
        }
    }

    /// The triangle of a segment.
    fn reflect(&self, segment: usize, folder: &mut Folder) -> Result<Vec<f64>, StreamError> {
        let width = self.shape.width();
        let mut triangle = vec![0.0; width * width];
        for rows in self.blocks(segment) {
            self.fill(folder, &rows);
            if !folder.fold(&mut triangle, rows.len(), self.ahead(&rows)) {
                check_finite(self.columns, rows, 0)?;
            }
        }
        Ok(triangle)
    }

    /// Segments factored by themselves, then merged in order.
    fn reduce(&self) -> Result<Factor, StreamError> {
        let mut total = Factor::empty(self.shape);
        if self.n == 0 {
            return Ok(total);
        }
        let mut folder = Folder::new(self.shape);
        let first = self.reflect(0, &mut folder)?;
        folder.fold_triangle(&mut total.triangle, &first);
        let triangles: Vec<Result<Vec<f64>, StreamError>> = (1..self.n.div_ceil(self.shape.segment_rows()))
            .into_par_iter()
            .map_init(|| Folder::new(self.shape), |folder, segment| self.reflect(segment, folder))
            .collect();
        for triangle in triangles {
            folder.fold_triangle(&mut total.triangle, &triangle?);
        }
        total.rows = self.n as u64;
        Ok(total)
    }
}

pub(super) fn columns_of<'a>(
    shape: Shape,
    regressors: &[&'a [f64]],
    responses: &[&'a [f64]],
) -> Result<Vec<&'a [f64]>, StreamError> {
    check_count("regressors", regressors.len(), shape.regressors)?;
    check_count("responses", responses.len(), shape.responses)?;
    Ok(regressors.iter().chain(responses).copied().collect())
}
