//! Why a file of another program gives no added mass.

use std::fmt::Display;

/// Why an added mass cannot be put into a file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FileError(pub(super) String);

impl FileError {
    /// A scale of the file that is not positive.
    pub(super) fn scale(what: &str, value: f64) -> Self {
        Self(format!("{what} is {value}; it must be finite and above 0"))
    }

    /// None, or more than a file holds.
    pub(super) fn body_count(count: impl Display) -> Self {
        Self(format!("{count} bodies; a file holds 1 to {MOST_BODIES}"))
    }
}

/// Most bodies of a file: a file of NetCDF-3 is smaller than 2 GiB.
pub(super) const MOST_BODIES: usize = 999;
