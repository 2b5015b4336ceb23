//! From what size on a table is read in chunks, and what is refused then.

use froude_records::campaign::Source;

use crate::error::IdentifyError;

/// Most clusters: each keeps a triangle for every law and load.
pub(crate) const MOST_CLUSTERS: usize = 10_000;

/// Most configurations of a body in one table.
pub(crate) const MOST_CONFIGURATIONS: usize = 10_000;

/// What a table that is read in chunks cannot be asked for, with the way out.
pub(crate) fn refusal(source: &Source, what: &str) -> IdentifyError {
    refused_above(MOST_KEPT, source, what)
}

/// Most rows that are kept in memory: with three laws of one load and their figures a row takes 0.8 kB and 0.04 ms.
pub const MOST_KEPT: usize = 200_000;

/// Rows of the sample: enough for every figure, and a rank correlation of 0.02 is two standard errors.
pub(crate) const SAMPLE: usize = 10_000;

pub(crate) fn refused_above(most: usize, source: &Source, what: &str) -> IdentifyError {
    IdentifyError::Campaign {
        place: source.input.path().display().to_string(),
        what: format!(
            "the table has more than {most} rows and is read in chunks, which does not go with {what}; do without, or give fewer rows: \
             means over steady stretches, or every tenth row"
        ),
    }
}
