//! Blocks of rows folded into a triangle.

use super::kernel::{Ahead, absorb, clear_from, groups_per_block, put};
use froude_lanes::{LANES, Lane, Level};

use super::Shape;

/// Memory for folding blocks into triangles of one shape.
pub(super) struct Folder {
    pub(super) shape: Shape,
    level: Level,
    block: Vec<Lane>,
    scratch: Vec<f64>,
}

impl Folder {
    pub(super) fn new(shape: Shape) -> Self {
        let (width, level) = (shape.width(), Level::detect());
        Self { shape, level, block: vec![Lane::ZERO; width * groups_per_block(width)], scratch: vec![0.0; 2 * width] }
    }

    pub(super) fn put(&mut self, column: usize, row: usize, values: &[f64]) {
        put(&mut self.block, self.shape.width(), column, row, values);
    }

    /// Folds the first `rows` rows of the block into `triangle`.
    ///
    /// False when an entry was not finite, or its square was not.
    #[must_use]
    pub(super) fn fold(&mut self, triangle: &mut [f64], rows: usize, ahead: Ahead<'_>) -> bool {
        let width = self.shape.width();
        if rows == 0 || width == 0 {
            return true;
        }
        let used = rows.div_ceil(LANES) * width;
        clear_from(&mut self.block[..used], width, rows);
        absorb(self.level, triangle, &mut self.block[..used], &mut self.scratch, ahead);
        // A bad entry spoils all columns to its right, hence always the last.
        triangle.last().is_none_or(|last| last.is_finite())
    }

    /// Folds another triangle in, a block of its rows after the other.
    pub(super) fn fold_triangle(&mut self, triangle: &mut [f64], other: &[f64]) {
        let width = self.shape.width();
        if width == 0 {
            return;
        }
        let block_rows = self.shape.block_rows();
        for first in (0..width).step_by(block_rows) {
            let rows = (width - first).min(block_rows);
            for j in 0..width {
                for i in 0..rows {
                    self.put(j, i, &[other[(first + i) * width + j]]);
                }
            }
            // Both triangles are finite: each was checked when it was made.
            let _ = self.fold(triangle, rows, Ahead::nothing());
        }
    }
}

impl std::fmt::Debug for Folder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Folder").field("shape", &self.shape).finish_non_exhaustive()
    }
}
