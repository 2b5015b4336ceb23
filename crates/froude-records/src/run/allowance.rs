//! How much a run may unpack to and hold, by the size of its file.

use std::path::Path;

use crate::error::RecordError;

/// What any run may unpack to, however small its file.
const FREE: u64 = 256 << 20;

/// Beyond that: as many times its file. Runs pack to a fifth, a run at rest to a fiftieth; zeros to a thirty-thousandth.
const TIMES: u64 = 200;

/// Most numbers of a run in memory, all its channels together: 2 GiB.
const MOST_NUMBERS: u64 = 1 << 28;

/// What is left of the bytes that a run may unpack to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Allowance {
    limit: u64,
    taken: u64,
}

impl Allowance {
    pub fn of(file_bytes: u64) -> Self {
        Self { limit: FREE.max(file_bytes.saturating_mul(TIMES)), taken: 0 }
    }

    /// Takes the bytes of a chunk.
    ///
    /// # Errors
    ///
    /// [`RecordError::TooLarge`] where the run unpacks to more than its file can mean.
    pub fn take(&mut self, path: &Path, bytes: usize) -> Result<(), RecordError> {
        self.taken = self.taken.saturating_add(bytes as u64);
        if self.taken > self.limit {
            return Err(RecordError::too_large(
                path,
                self.taken,
                self.limit,
                "the chunks of a run of this size, unpacked",
            ));
        }
        Ok(())
    }
}

/// Whether a run of so many ticks and channels is held in memory.
///
/// # Errors
///
/// [`RecordError::TooLarge`].
pub(crate) fn holds(path: &Path, ticks: usize, channels: usize) -> Result<(), RecordError> {
    let numbers = (ticks as u64).saturating_mul(channels as u64 + 1);
    if numbers > MOST_NUMBERS {
        return Err(RecordError::too_large(path, 8 * numbers, 8 * MOST_NUMBERS, "the channels of a run in memory"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_unpacks_to_what_its_file_can_mean_and_not_to_a_byte_more() {
        for (file, limit) in [(0, 256 << 20), (1 << 20, 256 << 20), (10_000_000, 2_000_000_000)] {
            let path = Path::new("run.mcap");
            let mut allowance = Allowance::of(file);
            assert_eq!(allowance.take(path, limit - 1), Ok(()), "under");
            assert_eq!(allowance.take(path, 1), Ok(()), "at");
            let over = allowance.take(path, 1).unwrap_err().to_string();
            let told = format!(
                "run.mcap has {} bytes; the limit for the chunks of a run of this size, unpacked is {limit}",
                limit + 1
            );
            assert_eq!(over, told, "over");
        }
    }

    #[test]
    fn a_run_of_more_numbers_than_memory_should_hold_is_refused() {
        let path = Path::new("run.mcap");
        assert_eq!(holds(path, (1 << 28) - 1, 0), Ok(()));
        assert_eq!(holds(path, 1 << 20, 255), Ok(()));
        assert!(holds(path, 1 << 20, 256).is_err());
    }
}
