//! Why a record cannot be filtered.

/// Why a record cannot be filtered; each message states what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SignalError {
    /// A corner frequency outside what the rate can hold.
    #[error("corner {corner_hz} Hz is not between 0 and half the rate ({rate_hz} Hz); lower it or sample faster")]
    Corner {
        /// Asked for.
        corner_hz: f64,
        /// Sampling rate.
        rate_hz: f64,
    },

    /// A whole number that must lie in a range.
    #[error("{what} is {found}; it must lie between {low} and {high}")]
    OutOfRange {
        /// Order, window, factor…
        what: &'static str,
        /// What was given.
        found: usize,
        /// Smallest.
        low: usize,
        /// Largest.
        high: usize,
    },

    /// A number that must be positive and finite.
    #[error("{what} is {found}; it must be positive and finite")]
    NotPositive {
        /// What it is.
        what: &'static str,
        /// What was given.
        found: f64,
    },

    /// A record shorter than the filter needs.
    #[error("{what} needs more than {needed} samples, the record has {found}; record longer or filter less")]
    TooShort {
        /// Which filter.
        what: &'static str,
        /// Its length at the ends.
        needed: usize,
        /// Length of the record.
        found: usize,
    },

    /// Two records that should be equally long.
    #[error("{what} has {found} samples where the first record has {expected}")]
    Length {
        /// The second one.
        what: &'static str,
        /// Its length.
        found: usize,
        /// Length of the first.
        expected: usize,
    },

    /// Times that do not increase.
    #[error("time {index} is not later than the one before it; sort the samples, or delete doubled ones")]
    NotIncreasing {
        /// Index from 0.
        index: usize,
    },

    /// A record in which no period is found.
    #[error(
        "no period is found in {length_s} s of the record (best guess {periods:.2} periods); record several periods, or take the part in which it oscillates"
    )]
    NoPeriod {
        /// Length of the record.
        length_s: f64,
        /// Periods at the frequency where the search ended.
        periods: f64,
    },

    /// A record with a sample that is NaN or infinite.
    #[error("sample {index} is not finite; leave gaps out before filtering")]
    NotFinite {
        /// Index from 0.
        index: usize,
    },
}

/// Refuses a record with a NaN or an infinity: a recursive filter would smear it over everything after it.
pub(crate) fn all_finite(record: &[f64]) -> Result<(), SignalError> {
    match record.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(SignalError::NotFinite { index }),
        None => Ok(()),
    }
}

/// `value` when it lies in `low..=high`.
pub(crate) fn in_range(what: &'static str, found: usize, low: usize, high: usize) -> Result<usize, SignalError> {
    if (low..=high).contains(&found) { Ok(found) } else { Err(SignalError::OutOfRange { what, found, low, high }) }
}

/// `value` when it is positive and finite.
pub(crate) fn positive(what: &'static str, found: f64) -> Result<f64, SignalError> {
    if found.is_finite() && found > 0.0 { Ok(found) } else { Err(SignalError::NotPositive { what, found }) }
}
