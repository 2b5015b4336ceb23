//! Rows that come chunk after chunk.

use std::ops::Range;

use super::kernel::Ahead;

use super::error::StreamError;
use super::factor::Factor;
use super::folder::Folder;
use super::in_memory::columns_of;
use super::{BLOCKS_PER_SEGMENT, Shape, check_finite, check_lengths};

/// Rows taken in chunk after chunk.
///
/// Keeps one block of rows and two triangles, whatever comes. The cut into
/// chunks does not change the result, not even in the last bit.
#[derive(Debug)]
pub struct Accumulator {
    folder: Folder,
    /// Rows waiting in the block.
    waiting: usize,
    /// Blocks in the segment so far.
    blocks: usize,
    segment: Vec<f64>,
    total: Factor,
}

impl Accumulator {
    /// An accumulator without rows.
    #[must_use]
    pub fn new(shape: Shape) -> Self {
        Self {
            folder: Folder::new(shape),
            waiting: 0,
            blocks: 0,
            segment: vec![0.0; shape.width() * shape.width()],
            total: Factor::empty(shape),
        }
    }

    /// Rows taken so far.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.total.rows
    }

    /// Takes a chunk of rows: each regressor, then each response, as a column.
    ///
    /// # Errors
    ///
    /// [`StreamError::Refused`] of a wrong number of values, and [`StreamError::NotFinite`]
    /// with the row counted over all chunks. After an error nothing of the chunk has
    /// been taken.
    pub fn push(&mut self, regressors: &[&[f64]], responses: &[&[f64]]) -> Result<(), StreamError> {
        let columns = columns_of(self.total.shape, regressors, responses)?;
        let rows = check_lengths(&columns)?;
        check_finite(&columns, 0..rows, self.total.rows)?;
        self.take(&columns, 0..rows);
        Ok(())
    }

    /// Takes checked rows.
    pub(super) fn take(&mut self, columns: &[&[f64]], rows: Range<usize>) {
        let shape = self.total.shape;
        let mut next = rows.start;
        while next < rows.end {
            let n = (rows.end - next).min(shape.block_rows() - self.waiting);
            for (j, column) in columns.iter().enumerate() {
                self.folder.put(j, self.waiting, &column[next..next + n]);
            }
            self.waiting += n;
            next += n;
            if self.waiting == shape.block_rows() {
                self.fold();
                if self.blocks == BLOCKS_PER_SEGMENT {
                    self.close_segment();
                }
            }
        }
        self.total.rows += rows.len() as u64;
    }

    pub(super) fn fold(&mut self) {
        // The entries were checked when they came.
        let _ = self.folder.fold(&mut self.segment, self.waiting, Ahead::nothing());
        self.waiting = 0;
        self.blocks += 1;
    }

    fn close_segment(&mut self) {
        self.folder.fold_triangle(&mut self.total.triangle, &self.segment);
        self.segment.fill(0.0);
        self.blocks = 0;
    }

    /// The factor of all rows taken.
    #[must_use]
    pub fn finish(mut self) -> Factor {
        self.flush()
    }

    /// The factor of all rows taken; starts again without rows.
    pub(super) fn flush(&mut self) -> Factor {
        self.fold();
        self.close_segment();
        let shape = self.total.shape;
        std::mem::replace(&mut self.total, Factor::empty(shape))
    }
}
