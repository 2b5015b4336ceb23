//! Rows of the moving-block bootstrap.
//!
//! Blocks of neighbours are drawn, so that a resample keeps the correlation of the record within a block. Any start is
//! as likely as any other (overlapping blocks); the first and last rows stand in fewer blocks than the others.
//!
//! # Source
//!
//! Künsch (1989), Ann. Statist. 17, 1217.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::error::{SignalError, in_range};

/// Draws resamples of `rows` rows in blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MovingBlocks {
    rows: usize,
    block: usize,
    seed: u64,
}

impl MovingBlocks {
    /// Blocks of `block` neighbours out of `rows`.
    ///
    /// # Errors
    ///
    /// [`SignalError::OutOfRange`] when a block is empty or longer than the record.
    pub fn new(rows: usize, block: usize, seed: u64) -> Result<Self, SignalError> {
        in_range("rows in a block", block, 1, rows)?;
        Ok(Self { rows, block, seed })
    }

    /// Blocks that a record holds side by side: the number of independent pieces of evidence.
    #[must_use]
    pub fn count(&self) -> usize {
        self.rows / self.block
    }

    /// Row numbers of resample `which`, as many as the record has; each resample has a generator of its own.
    #[must_use]
    pub fn resample(&self, which: u64) -> Vec<usize> {
        let mut rng = Pcg64Mcg::seed_from_u64(self.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(which));
        let mut out = Vec::with_capacity(self.rows + self.block);
        while out.len() < self.rows {
            let start = rng.random_range(0..=self.rows - self.block);
            out.extend(start..start + self.block);
        }
        out.truncate(self.rows);
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_resample_is_made_of_whole_blocks_of_neighbours_and_can_be_drawn_again() {
        let blocks = MovingBlocks::new(100, 7, 1).unwrap();
        let rows = blocks.resample(3);
        assert_eq!(rows.len(), 100);
        assert!(rows.chunks(7).all(|b| b.windows(2).all(|w| w[1] == w[0] + 1)));
        assert_eq!(rows, blocks.resample(3));
        assert_ne!(rows, blocks.resample(4));
        assert!(MovingBlocks::new(10, 11, 1).is_err());
    }
}
