//! A checksum for each column of a Parquet table that we write: SHA-256 over its header and its cells, in the footer's
//! metadata.
//!
//! Parquet's own checksums are of pages; names, types and counts stand in headers and in a footer that nothing protects. These
//! sums are of what is read in the end, so they hold whatever lies between.

use sha2::{Digest as _, Sha256};

use crate::hash::hexadecimal;
use crate::raw_column::Raw;

/// Key in the footer's metadata: the sums of all columns, in their order, with spaces between.
pub(crate) const KEY: &str = "froude.sha256";

/// Sum of a column as it stands in the file: its header, and its numbers or texts before units and signs are applied.
pub(crate) struct Sum(Sha256);

impl Sum {
    /// Of a column without cells.
    pub(crate) fn new(header: &str) -> Self {
        let mut sum = Self(Sha256::new());
        sum.text(header);
        sum
    }

    fn text(&mut self, text: &str) {
        self.0.update((text.len() as u64).to_le_bytes());
        self.0.update(text.as_bytes());
    }

    /// Takes cells in.
    pub(crate) fn add(&mut self, cells: &Raw) {
        match cells {
            Raw::Texts(texts) => {
                for cell in texts {
                    self.text(cell);
                }
            }
            Raw::Numbers(numbers) => {
                // In pieces: a call for each number would cost more than its hash.
                let mut piece = Vec::with_capacity(8 * 512);
                for numbers in numbers.chunks(512) {
                    piece.clear();
                    for number in numbers {
                        piece.extend_from_slice(&number.to_le_bytes());
                    }
                    self.0.update(&piece);
                }
            }
        }
    }

    /// Hexadecimal.
    pub(crate) fn finish(self) -> String {
        hexadecimal(&self.0.finalize())
    }
}
